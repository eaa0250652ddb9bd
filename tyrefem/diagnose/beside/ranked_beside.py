"""Sets of effects ranked again beside a discrepancy model: the leading ones are fitted with its unknowns."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.special import expit

from tyrefem.brief import Brief
from tyrefem.diagnose.beside.discrepancy import (
    ENERGY,
    HEAT,
    NONE,
    READINGS,
    Discrepancy,
    beside_law,
    discrepancies,
    without,
)
from tyrefem.diagnose.beside.robustness import Robustness, UnderDiscrepancy, shares
from tyrefem.diagnose.data.residuals import Residuals
from tyrefem.diagnose.fitting.fits import FittedSet, continued, first_fits, fitted_beside, linear_about, state_beside
from tyrefem.diagnose.fitting.gauss_newton import FitState, initial_state
from tyrefem.diagnose.fitting.selection import ScoredSet, SelectionProblem
from tyrefem.diagnose.unknowns.candidates import Candidate, Members, separate
from tyrefem.mechanics.strain_laws import strain_laws

#: A set whose linear estimate is this far below the best is not fitted beside a discrepancy, nats.
FAR = 60.0
#: A fit with half waves beyond so many prior standard deviations asks for wider priors; fits that are continued there.
STRAIN, RENEWED = 2.5, 2
#: A strain law whose fits keep a misfit above this times the number of readings is not searched for further sets.
NEAR = 10.0
#: A model is probable enough for further fits from this probability on.
PROBABLE = 1e-3
#: Beside a discrepancy of this size noise explains the misfit, so that no larger one is tried.
USUAL_P = 0.01
#: Sizes of missing heat whose evidence is this far below the best one's do not count in the average, nats.
NEGLIGIBLE = 12.0


@dataclass(eq=False)
class RankedBeside(Brief):
    """Sets beside one discrepancy model: those fitted beside it, and estimates ln(prior) + ln evidence of others.

    ``open``: effects that may be named; if there are any, of the sets with all of them only the best one is fitted.
    ``left_out``: effects that do not compete.
    """

    problem: SelectionProblem
    discrepancy: Discrepancy
    open: Members = ()
    left_out: Members = ()
    fits: dict[Members, FittedSet] = field(default_factory=dict)
    estimates: dict[Members, float] = field(default_factory=dict)
    _here: Residuals | None = None

    def _title(self) -> str:
        return f"{self.discrepancy.name}, {len(self.fits)} fits"

    @property
    def residuals(self) -> Residuals:
        """The residuals beside the discrepancy; with sensitivities to effects at the best fit if they were taken."""
        return self._here or self._at_origin

    @functools.cached_property
    def candidates(self) -> Members:
        """The effects that compete: those that the discrepancy does not allow for by itself."""
        further = set(self.discrepancy.further)
        competing = (each for each in self.problem.candidates if each not in self.left_out)
        return tuple(each for each in competing if not further & set(each.unknowns))

    @functools.cached_property
    def _at_origin(self) -> Residuals:
        of = self.discrepancy
        return self.problem.residuals.beside(of.nuisance, of.shared_error, of.offset)

    @property
    def best(self) -> FittedSet:
        """The fitted set with the highest score."""
        return self.fits[max(self.fits, key=self.score)]

    @property
    def strained(self) -> bool:
        """Whether the best fit needs much more of the discrepancy than its prior expects."""
        fit, nuisance = self.best, set(self.discrepancy.nuisance)
        return any(abs(fit.values[unknown]) > STRAIN * unknown.sd for unknown in fit.unknowns if unknown in nuisance)

    @property
    def far(self) -> bool:
        """Whether the fits lie far from the study, where sensitivities differ from those at x = 0: priors are wide."""
        return bool(self.discrepancy.nuisance) and self.discrepancy.width > 1.0 and self.discrepancy.size == 0.0

    @property
    def near(self) -> bool:
        """Whether some fit is so near the data that other sets may explain them; else the discrepancy is refuted."""
        fit = min(self.fits.values(), key=lambda fit: fit.misfit)
        return fit.misfit < NEAR * fit.readings

    def score(self, members: Members) -> float:
        """ln(prior) + ln evidence of a fitted set."""
        return self.problem.prior(members) + self.fits[members].log_evidence

    @property
    def p_value(self) -> float:
        """Largest probability of the misfit of a fitted set."""
        return max((fit.p_value for fit in self.fits.values()), default=0.0)

    def begin(self, fits: Mapping[Members, FittedSet], most: int | None = None) -> None:
        """Fit the leading sets beside the discrepancy, from their fits without it; no effect first.

        ``most``: largest number of leading sets; default: as in the settings.
        """
        residuals, problem = self.residuals, self.problem
        estimates = {
            members: problem.prior(members) + evidence(state_beside(residuals, fit), residuals.log_det)
            for members, fit in fits.items()
            if set(members) <= set(self.candidates)
        }
        # Without the discrepancy, the fit of no effect may have distorted base numbers.
        linear = residuals.linear(residuals.fitted)
        computed = {number: residuals.computed[number] for number in residuals.fitted}
        origin = initial_state(linear, computed, (), residuals.settings)
        of_origin = problem.prior(()) + evidence(origin, residuals.log_det)
        from_origin = of_origin > estimates.get((), -math.inf)
        estimates[()] = max(of_origin, estimates.get((), -math.inf))
        ahead = sorted(estimates, key=lambda members: -estimates[members])
        near = [members for members in ahead if estimates[members] > estimates[ahead[0]] - FAR]
        chosen = self._deciding(near)[: most or residuals.settings.beside_sets]
        if () in near and () not in chosen:
            chosen.append(())
        restarted = [()] if from_origin and () in chosen else []
        self._take(
            fitted_beside(
                problem.predictions,
                [(fits[members], residuals) for members in chosen if members not in restarted],
                problem._count,
            )
        )
        self._take(first_fits(residuals, problem.predictions, restarted, None, problem._count))
        self.estimates |= {members: value for members, value in estimates.items() if members not in self.fits}
        if self.far and self._here is None:
            self._renew()
        self._estimate()
        if self.p_value <= USUAL_P:
            self._continue_ended(parts=False)

    def _renew(self) -> None:
        """Continue the best fits with sensitivities at their points; take those of all effects at the best one."""
        problem = self.problem
        leading = sorted(self.fits, key=self.score)[-RENEWED:]
        self._take(
            continued(self.residuals, problem.predictions, [self.fits[part] for part in leading], problem._count)
        )
        unknowns = [unknown for each in self.candidates for unknown in (*each.amplitudes, *each.presence)]
        point = problem.ordered(self.best.members), tuple(unknowns), self.best.state.current_values
        numbers = self.residuals.fitted
        (columns,) = problem.predictions.jacobians([point], numbers, problem._count)
        sensitive = self.residuals.sensitivities.with_columns(unknowns, dict(zip(numbers, columns, strict=True)))
        self._here = replace(self.residuals, sensitivities=sensitive)

    def further(self) -> None:
        """Fit the best estimated sets and estimate from them: twice, and once more if a better one was found last.

        Rivals of the best set are then continued; if one of them gets ahead, once more.
        """
        self._search()
        leading = self.best.members
        if self._continue_ended() and self.best.members != leading:
            self._search()

    def _continue_ended(self, *, parts: bool = True) -> bool:
        """Continue fits that ended on their way: the best one, no effect, and the best one's parts.

        A set that is far from its own best point does not show that the data ask for another effect. The parts begin
        where the best fit ends; the best fit without a member counts as one. True if there were any.
        """
        best = self.best
        to_end = {self.problem.ordered(best.members), ()}
        ended = self._hidden_rivals() if parts else []
        for member in best.members if parts else ():
            to_end.add(max((members for members in self.fits if member not in members), key=self.score, default=()))
            part = self.fits.get(tuple(each for each in self.problem.ordered(best.members) if each != member))
            if not member.presence and (part is None or not _good(part)):
                ended.append(best.without([member]))
        # A part that begins where the best fit ends needs no second start.
        to_end -= {self.problem.ordered(fit.members) for fit in ended}
        ended += [self.fits[members] for members in to_end if members in self.fits and not _good(self.fits[members])]
        if not ended:
            return False
        self._take(continued(self.residuals, self.problem.predictions, ended, self.problem._count))
        self._estimate()
        return True

    def _hidden_rivals(self) -> list[FittedSet]:
        """Starts for sets near the best one whose own fits ended far from their best points.

        A leading fit shows it: without one of its effects, its linear model predicts a score that is more than
        ``near_score`` above that of the set's own fit.
        """
        settings, top = self.problem.settings, max(map(self.score, self.fits))
        starts: dict[Members, tuple[float, FittedSet]] = {}
        for members, fit in self.fits.items():
            if self.score(members) < top - settings.far_score or fit is self.best:
                continue
            for member in members:
                part = tuple(each for each in members if each != member)
                if (known := self.fits.get(part)) is None or _good(known):
                    continue
                value = self.problem.prior(part) + _without(fit, member, self.residuals.log_det)
                promising = value > max(self.score(part) + settings.near_score, top - settings.leading_score)
                if promising and value > starts.get(part, (-math.inf,))[0]:
                    starts[part] = value, fit.without([member])
        return [start for _, start in starts.values()]

    def _search(self) -> None:
        settings, top = self.problem.settings, -math.inf
        for again in range(3):
            before, top = top, max(map(self.score, self.fits))
            if again == 2 and top == before:
                return
            ahead = [
                members
                for members, value in sorted(self.estimates.items(), key=lambda item: -item[1])
                if value > top - settings.near_score and self._start(members) is not None
            ]
            near = self._deciding(ahead)[: settings.beside_sets]
            if not near:
                return
            starts = {members: start for members in near if (start := self._start(members)) is not None}
            self._take(first_fits(self.residuals, self.problem.predictions, near, starts, self.problem._count))
            self._estimate()

    def _deciding(self, ahead: Sequence[Members]) -> list[Members]:
        """The sets that can change whether the open effects are named; ``ahead``: best first."""
        every = [members for members in ahead if self.open and set(self.open) <= set(members)]
        return [members for members in ahead if members not in every[1:]]

    def _take(self, fits: Sequence[FittedSet]) -> None:
        for fit in fits:
            members = self.problem.ordered(fit.members)
            known = self.fits.get(members)
            # A fit beside a law far from the data may end worse than it began.
            if known is None or fit.log_evidence > known.log_evidence:
                self.fits[members] = fit
            self.estimates.pop(members, None)

    def _start(self, members: Members) -> FittedSet | None:
        """The best fit of a part of a set; else the best one that has more effects, without these."""
        return _nearest({part: fit for part, fit in self.fits.items() if part != members}, members, self.score)

    def _estimate(self) -> None:
        """Estimate sets with one effect more or less than a good fit, in the linear model about it."""
        top, settings = max(map(self.score, self.fits)), self.problem.settings
        for members, fit in self.fits.items():
            if self.score(members) < top - settings.far_score:
                continue
            for member in members:
                part = tuple(each for each in members if each != member)
                value = self.problem.prior(part) + _without(fit, member, self.residuals.log_det)
                self._better(part, value)
            if len(members) < settings.largest:
                self._extend(members, fit)

    def _extend(self, members: Members, fit: FittedSet) -> None:
        problem = self.problem
        others = [each for each in self.candidates if separate(each, members)]
        unknowns = [unknown for each in others for unknown in (*each.amplitudes, *each.presence)]
        about = linear_about(self.residuals, fit, unknowns)
        of_part = about.log_evidence(())
        for candidate in others:
            more = problem.ordered((*members, candidate))
            gain = about.log_evidence((candidate,)) - of_part + problem.prior(more) - problem.prior(members)
            self._better(more, self.score(members) + gain)

    def _better(self, members: Members, value: float) -> None:
        members = self.problem.ordered(members)
        if members not in self.fits:
            self.estimates[members] = max(value, self.estimates.get(members, -math.inf))

    def allowed(self) -> dict[Candidate, tuple[float, float, float]]:
        """Effects that the discrepancy allows for by itself -> probability, x and its sd at the best fit.

        The odds that such an effect acts are its prior odds times the prior density over the posterior density of its
        amplitude at zero (Dickey 1971). x is linear, with the effect's sensitivities at zero.
        """
        of, fit = self.discrepancy, self.best
        shared = of.shared_error
        effects = {each.amplitudes[0]: each for each in self.problem.candidates if len(each.amplitudes) == 1}
        if shared is None or not any(unknown in effects for unknown in of.further):
            return {}
        mean, sd = shared.coefficients(fit.state.r, fit.state.J, fit.state.posterior.covariance)
        allowed = {}
        for unknown, c, s in zip(of.further, mean, np.maximum(sd, 1e-9), strict=False):
            if (candidate := effects.get(unknown)) is not None:
                odds = self.problem.prior((candidate,)) - self.problem.prior(())
                probability = float(expit(odds + math.log(s) + (c / s) ** 2 / 2))
                allowed[candidate] = probability, float(c) * unknown.sd, float(s) * unknown.sd
        return allowed

    def scored(self) -> list[ScoredSet]:
        """All sets, best first; estimates stay below the best fit."""
        rows = [ScoredSet(self.score(members), members, fit) for members, fit in self.fits.items()]
        highest = max(row.score for row in rows)
        rows += [ScoredSet(min(value, highest), members, None) for members, value in self.estimates.items()]
        return sorted(rows, key=lambda row: -row.score)


def evidence(state: FitState, log_det: float) -> float:
    """ln evidence of the linear model of a state."""
    data = state.r + state.J @ state.x
    return state.posterior.log_evidence - float(data @ data) / 2 - log_det


def _without(fit: FittedSet, member: Candidate, log_det: float) -> float:
    """ln evidence of a fitted set without a member, in the linear model about the fit."""
    kept = [place for place, unknown in enumerate(fit.unknowns) if unknown not in member.unknowns]
    if member.presence or len(kept) == len(fit.unknowns):
        return -math.inf
    state = fit.state
    x = np.where(np.isin(np.arange(len(fit.unknowns)), kept), 0.0, state.x)
    part = replace(
        state,
        unknowns=tuple(state.unknowns[place] for place in kept),
        x=state.x[kept],
        r=state.r + state.J @ x,
        J=state.J[:, kept],
    )
    part = replace(part, posterior=part.fitted())
    return evidence(part, log_det)


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
        before = () if in_full else _so_far(problem, alone, ranked).open(settings.named_probability)
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
            elif _total(beside.scored()) > _total(known[0].scored()):
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
            math.log(settings.right_model) + _total(alone),
            *(math.log(share) + _score(sizes) for sizes in ranked.values()),
        ]
        models = [
            replace(model, probability=probability) for model, probability in zip(models, shares(scores), strict=True)
        ]
        ordered = tuple(sorted(models, key=lambda model: -model.probability))
        return Robustness(ordered, log_evidence=float(np.logaddexp.reduce(scores)))

    first = result()
    if not explained:
        return _with_held_out(problem, first)
    probable = {model.name for model in first.models if model.probability > PROBABLE}
    unfinished = [beside for name, sizes in ranked.items() if name in probable or not certain for beside in sizes]
    for beside in unfinished:
        beside.further()
    return _with_held_out(problem, result() if unfinished else first)


def _without_errors(chosen: list[RankedBeside], tried: Sequence[RankedBeside]) -> list[RankedBeside]:
    """A discrepancy with errors of the readings, or the best one without them if its sets explain the data better.

    Before the search the errors stand in for an effect that no set had yet.
    """
    alone = [beside for beside in tried if not beside.discrepancy.size]
    if not alone or not all(beside.discrepancy.size for beside in chosen):
        return chosen
    best = max(alone, key=lambda beside: _total(beside.scored()))
    best.further()
    return [best] if _total(best.scored()) > _total(chosen[0].scored()) else chosen


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
        beside = RankedBeside(problem, left, left_out=(member,), _here=here)
        beside.begin(leading.fits)
        beside.further()
        held_out[member.key] = max(fit.held_out for fit in beside.fits.values())
    return replace(robust, models=(replace(leading, held_out_without=held_out), *robust.models[1:]))


def _score(sizes: Sequence[RankedBeside]) -> float:
    """ln evidence of a discrepancy of several sizes, over all sets with their priors."""
    _, _, rows = averaged(sizes)
    return _total(rows)


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
    scores = [_total(alone), *map(_score, ranked.values())]
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


def beside_strain_laws(problem: SelectionProblem, robust: Robustness, fits: Sequence[FittedSet]) -> Robustness:
    """The sets of some fits, and those with one effect more or less, ranked again beside every other strain law.

    The fits are without a discrepancy. A law that the study cannot run, or that needs further inputs, is not tried; one
    that presses the tyre on the road does so in linear motion.
    """
    residuals, evaluations = problem.residuals, problem.predictions.evaluations
    largest = max([fit.members for fit in fits], key=len)
    named = problem.ordered(largest)
    numbers = range(len(residuals.runs))
    tried, untried = [], []
    for name, law in strain_laws().items():
        if name == residuals.study.card.mechanics.strain or not law.compared:
            continue
        answers = evaluations.of("change_by_law", [(number, name) for number in numbers])
        if not all(np.isfinite(change).all() for change in answers):
            untried.append(name)
            continue
        beside = RankedBeside(problem, beside_law(residuals, name, answers), named)
        beside.begin({problem.ordered(fit.members): fit for fit in fits})
        if beside.near:
            beside.further()
        law_sets = under(beside.discrepancy, beside.residuals, beside.scored())
        tried.append(replace(law_sets, probability=math.nan))
    return replace(robust, laws=tuple(tried), untried=tuple(untried))


def fit_beside(problem: SelectionProblem, model: UnderDiscrepancy, fit: FittedSet) -> FittedSet:
    """The fit of a set beside a model; ``fit``: its fit without a discrepancy.

    It is continued with new sensitivities if it has not converged and noise does not explain its misfit. Effects that
    the model allows for by itself are fitted as effects, and not allowed for a second time.
    """
    known = model.fits.get(problem.ordered(fit.members))
    if model.residuals is None or (known is not None and _good(known)):
        return known or fit
    members = tuple(member for member in fit.members if member in model.allowed)
    others = problem.ordered(tuple(member for member in fit.members if member not in members))
    start = _nearest(model.fits, others, lambda part: model.fits[part].log_evidence)
    here, joining, predictions = model.residuals, members, problem.predictions
    if members and model.discrepancy is not None:
        left = without(model.discrepancy, [member.amplitudes[0] for member in members])
        here = replace(here, shared_error=left.shared_error)
    if start is None or not set(others) <= set(start.members):
        start, joining = fit, ()
    first = known
    if first is None:
        (first,) = fitted_beside(predictions, [(start, here)], problem._count, joining)
    if _good(first) or not first.worth_continuing:
        return first
    (further,) = continued(here, predictions, [first], problem._count)
    return max(first, further, key=lambda each: each.log_evidence)


def _good(fit: FittedSet) -> bool:
    return fit.converged or fit.p_value > USUAL_P


def _nearest(
    fits: Mapping[Members, FittedSet], members: Members, score: Callable[[Members], float]
) -> FittedSet | None:
    """The fit of a set, else the best one of a part of it, else the best one with further effects, without these."""
    if members in fits:
        return fits[members]
    if parts := [part for part in fits if set(part) < set(members)]:
        return fits[max(parts, key=score)]
    wholes = [whole for whole in fits if set(members) < set(whole)]
    # Without an effect that has no amplitude all sensitivities are other ones.
    wholes = [whole for whole in wholes if not any(each.presence for each in whole if each not in members)]
    if not wholes:
        return None
    whole = fits[max(wholes, key=score)]
    return whole.without([each for each in whole.members if each not in members])


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
    leading = max(sizes, key=lambda beside: _total(beside.scored()))
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


def _total(scored: Sequence[ScoredSet]) -> float:
    """ln of the sum over the sets."""
    return float(np.logaddexp.reduce([entry.score for entry in scored]))


def under(model: Discrepancy, residuals: Residuals, scored: Sequence[ScoredSet]) -> UnderDiscrepancy:
    """The sets beside a model, still without the model's probability."""
    total = _total(scored)
    named: dict[str, float] = {}
    values: dict[str, tuple[float, float]] = {}
    for entry in scored:
        for member in entry.members:
            named[member.key] = named.get(member.key, 0.0) + math.exp(entry.score - total)
            if entry.fit is not None:
                values |= {
                    unknown.key: (entry.fit.values[unknown], entry.fit.sd[unknown])
                    for unknown in member.unknowns
                    if unknown in entry.fit.values and unknown.key not in values
                }
    named = dict(sorted(named.items(), key=lambda item: -item[1]))
    fits = {entry.members: entry.fit for entry in scored if entry.fit is not None}
    return UnderDiscrepancy(model.name, model.size, model.words, 0.0, named, scored[0].members, values, fits, residuals)
