"""Sets of effects ranked beside every discrepancy model: which of them act whatever else is wrong."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from tyrefem.diagnose.beside.discrepancy import (
    ENERGY,
    HEAT,
    NONE,
    READINGS,
    Discrepancy,
    discrepancies,
    with_films_and_gauges,
    without,
)
from tyrefem.diagnose.beside.ranked_beside import USUAL_P, RankedBeside, evidence
from tyrefem.diagnose.beside.robustness import Robustness, UnderDiscrepancy, shares
from tyrefem.diagnose.data.residuals import Residuals
from tyrefem.diagnose.fitting.fits import FittedSet, state_beside
from tyrefem.diagnose.fitting.selection import ScoredSet, SelectionProblem
from tyrefem.diagnose.unknowns.candidates import Members

#: A model is probable enough for further fits from this probability on.
PROBABLE = 1e-3
#: Sizes of missing heat whose evidence is this far below the best one's do not count in the average, nats.
NEGLIGIBLE = 12.0


def robustness(
    problem: SelectionProblem, scored: Sequence[ScoredSet], *, certain: bool, explained: bool = True
) -> Robustness:
    """Sets of effects beside every discrepancy model.

    The leading sets, and no effect, are fitted together with the model's unknowns; others are judged in the linear
    model about these fits. Of the sizes of a discrepancy of the readings the most probable one counts; over those of
    missing heat evidence is averaged.

    Parameters
    ----------
    scored : the sets without a discrepancy. certain : True: improbable models get no further fits.
    explained : False: no set explains the data, so the models matter for effects that act beside all that the data do
        not exclude. Another strain energy is tried first, in full: of the models it is the likeliest to be wrong. The
        others begin with two fits, no effect and the leading set, and go on if the data do not exclude them: then only
        with sets that can change the probabilities of effects that act beside the models before.
    """
    settings = problem.settings
    fits = {problem.ordered(entry.members): entry.fit for entry in scored if entry.fit is not None}
    # Every model is judged by evidence, whatever the criterion of the search.
    alone = sorted(
        (
            entry if entry.fit is None else entry._replace(score=problem.prior(entry.members) + entry.fit.log_evidence)
            for entry in scored
        ),
        key=lambda entry: -entry.score,
    )
    ranked: dict[str, list[RankedBeside]] = {}
    for name, sizes in _by_cost(problem, fits, explained=explained).items():
        in_full = explained or name == ENERGY
        before = () if in_full else _so_far(problem, alone, ranked).open(settings.challenged_probability)
        tried = []
        for discrepancy in sizes:
            known = ranked.get(name, [])
            if known and name != HEAT and not _further(known[0], discrepancy):
                continue
            beside = RankedBeside(problem, discrepancy, before)
            beside.begin(fits, None if in_full else 1)
            tried.append(beside)
            if not known or name == HEAT:
                ranked[name] = [*known, beside]
            elif total(beside.scored()) > total(known[0].scored()):
                ranked[name] = [beside]
        if explained:
            continue
        counts = bool(before) and name in {model.name for model in _so_far(problem, alone, ranked).counted}
        for beside in ranked[name] if in_full or counts else ():
            if not in_full:
                beside.begin(fits)
            beside.further()
        if in_full or counts:
            ranked[name] = _without_errors(ranked[name], tried)
    share = (1 - settings.right_model) / max(len(ranked), 1)

    def result() -> Robustness:
        models = [under(Discrepancy(NONE, 0.0), problem.residuals, alone), *map(_under, ranked.values())]
        scores = [
            math.log(settings.right_model) + total(alone),
            *(math.log(share) + _score(sizes) for sizes in ranked.values()),
        ]
        models = [
            replace(model, probability=probability) for model, probability in zip(models, shares(scores), strict=True)
        ]
        ordered = tuple(sorted(models, key=lambda model: -model.probability))
        return Robustness(ordered, log_evidence=float(np.logaddexp.reduce(scores)))

    robust = result()
    if explained:
        probable = {model.name for model in robust.models if model.probability > PROBABLE}
        unfinished = [beside for name, sizes in ranked.items() if name in probable or not certain for beside in sizes]
        for beside in unfinished:
            beside.further()
        robust = result() if unfinished else robust
    if ENERGY in ranked and (fuller := _with_gauges(problem, ranked[ENERGY][0], robust)):
        ranked[fuller.discrepancy.words] = [fuller]
        robust = result()
    return _with_held_out(problem, robust)


def _with_gauges(problem: SelectionProblem, energy: RankedBeside, robust: Robustness) -> RankedBeside | None:
    """Sets beside another strain energy with other gauges and speed laws of films, too, which half waves may hide.

    A tread that is thinner than stated was read as a worn one, or as slip. None where the model as it is leads, where
    no effect may be named, or where the strain energy has them already.
    """
    may_be_named = robust.open(problem.settings.challenged_probability)
    fuller = with_films_and_gauges(problem.residuals, energy.discrepancy)
    if fuller is None or not may_be_named or robust.models[0].name == NONE:
        return None
    here = None if energy.renewed is None else replace(energy.renewed, shared_error=fuller.shared_error)
    beside = RankedBeside(problem, fuller, may_be_named, renewed=here)
    beside.begin(energy.fits)
    beside.further()
    return beside


def _without_errors(chosen: list[RankedBeside], tried: Sequence[RankedBeside]) -> list[RankedBeside]:
    """A discrepancy with errors of the readings, or the best one without them if its sets explain the data better.

    Before the search the errors stand in for an effect that no set had yet.
    """
    alone = [beside for beside in tried if not beside.discrepancy.size]
    if not alone or not all(beside.discrepancy.size for beside in chosen):
        return chosen
    best = max(alone, key=lambda beside: total(beside.scored()))
    best.further()
    return [best] if total(best.scored()) > total(chosen[0].scored()) else chosen


def _with_held_out(problem: SelectionProblem, robust: Robustness) -> Robustness:
    """With ln p of the held-out runs beside the most probable model without an effect that it allows for by itself.

    For each such effect that acts with the probability of a name beside every model, the leading sets are ranked again
    where neither the model nor a set has it.
    """
    leading = robust.models[0]
    candidates = robust.robust(leading.allowed, problem.settings.named_probability)
    if leading.discrepancy is None or leading.residuals is None or not candidates or not problem.residuals.held_out:
        return robust
    held_out = {}
    for member in candidates:
        left = without(leading.discrepancy, member.amplitudes)
        here = replace(leading.residuals, shared_error=left.shared_error)
        beside = RankedBeside(problem, left, left_out=(member,), renewed=here)
        beside.begin(leading.fits)
        beside.further()
        held_out[member.key] = max(fit.held_out for fit in beside.fits.values())
    return replace(robust, models=(replace(leading, held_out_without=held_out), *robust.models[1:]))


def _score(sizes: Sequence[RankedBeside]) -> float:
    """ln evidence of a discrepancy of several sizes, over all sets with their priors."""
    _, _, rows = averaged(sizes)
    return total(rows)


def _under(sizes: Sequence[RankedBeside]) -> UnderDiscrepancy:
    """The sets beside a discrepancy of several sizes, and the effects that it allows for by itself."""
    model = under(*averaged(sizes))
    beside = next(each for each in sizes if each.discrepancy.size == model.size)
    allowed = beside.allowed()
    named = {**model.named, **{each.key: probability for each, (probability, _, _) in allowed.items()}}
    values = {each.amplitudes[0].key: (x, sd) for each, (_, x, sd) in allowed.items()}
    return replace(
        model,
        named=dict(sorted(named.items(), key=lambda item: -item[1])),
        values={**model.values, **values},
        discrepancy=beside.discrepancy,
        allowed=tuple(allowed),
    )


def _so_far(
    problem: SelectionProblem, alone: Sequence[ScoredSet], ranked: Mapping[str, Sequence[RankedBeside]]
) -> Robustness:
    """The models so far, equally probable before the data; ``alone``: the sets without one."""
    scores = [total(alone), *map(_score, ranked.values())]
    models = [under(Discrepancy(NONE, 0.0), problem.residuals, alone), *map(_under, ranked.values())]
    likely = (replace(model, probability=share) for model, share in zip(models, shares(scores), strict=True))
    return Robustness(tuple(sorted(likely, key=lambda model: -model.probability)))


def _further(known: RankedBeside, discrepancy: Discrepancy) -> bool:
    """Whether to try a discrepancy beside the best one of its name: with more that differs, or with errors of the
    readings."""
    same_width = discrepancy.width == known.discrepancy.width
    if known.p_value > USUAL_P:
        return known.strained and not same_width and discrepancy.size == known.discrepancy.size
    return discrepancy.size == 0.0 or same_width


def _by_cost(
    problem: SelectionProblem, fits: Mapping[Members, FittedSet], *, explained: bool
) -> dict[str, list[Discrepancy]]:
    """The models by name with their sizes, those without further unknowns first, or last if no set explains the data.

    Of correlated readings there is only the size that explains the fits best; of missing heat those that come near it.
    """
    every = sorted(discrepancies(problem.residuals), key=lambda each: bool(each.nuisance) == explained)
    models: dict[str, list[Discrepancy]] = {}
    for each in every:
        models.setdefault(each.name, []).append(each)

    def best(discrepancy: Discrepancy) -> float:
        residuals = RankedBeside(problem, discrepancy).residuals
        return max(
            problem.prior(members) + evidence(state_beside(residuals, fit), residuals.log_det)
            for members, fit in fits.items()
        )

    for name in {HEAT, READINGS} & set(models):
        values = [best(discrepancy) for discrepancy in models[name]]
        least = max(values) - (NEGLIGIBLE if name == HEAT else 0.0)
        models[name] = [size for size, value in zip(models[name], values, strict=True) if value >= least]
    return models


def averaged(sizes: Sequence[RankedBeside]) -> tuple[Discrepancy, Residuals, list[ScoredSet]]:
    """Sets beside one discrepancy of several equally probable sizes: their scores by the average of the evidences.

    Sizes that are left out count as no evidence. Discrepancy, residuals and fits are those of the most probable size.
    """
    leading = max(sizes, key=lambda beside: total(beside.scored()))
    if leading.discrepancy.name != HEAT:
        return leading.discrepancy, leading.residuals, leading.scored()
    count = math.log(len(leading.problem.settings.heat_widths))
    scores: dict[Members, list[float]] = {}
    for beside in sizes:
        for row in beside.scored():
            scores.setdefault(row.members, []).append(row.score)
    rows = [
        ScoredSet(float(np.logaddexp.reduce(values)) - count, members, leading.fits.get(members))
        for members, values in scores.items()
    ]
    return leading.discrepancy, leading.residuals, sorted(rows, key=lambda row: -row.score)


def total(scored: Sequence[ScoredSet]) -> float:
    """ln of the sum over the sets."""
    return float(np.logaddexp.reduce([entry.score for entry in scored]))


def under(model: Discrepancy, residuals: Residuals, scored: Sequence[ScoredSet]) -> UnderDiscrepancy:
    """The sets beside a model, still without the model's probability."""
    whole = total(scored)
    named: dict[str, float] = {}
    values: dict[str, tuple[float, float]] = {}
    totals: dict[str, tuple[float, float]] = {}
    for entry in scored:
        for member in entry.members:
            named[member.key] = named.get(member.key, 0.0) + math.exp(entry.score - whole)
            if entry.fit is not None:
                new = [each for each in member.unknowns if each in entry.fit.values and each.key not in values]
                values |= {each.key: (entry.fit.values[each], entry.fit.sd[each]) for each in new}
                totals |= {each.key: entry.fit.total(each) for each in new}
    named = dict(sorted(named.items(), key=lambda item: -item[1]))
    fits = {entry.members: entry.fit for entry in scored if entry.fit is not None}
    best = scored[0].members
    return UnderDiscrepancy(
        model.name, model.size, model.words, 0.0, named, best, values, fits, residuals, totals=totals
    )
