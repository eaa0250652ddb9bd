"""How a verdict depends on the priors of effects: each prior three times as large, and a third."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.diagnose.beside.discrepancy import NONE
from tyrefem.diagnose.beside.robustness import Robustness, UnderDiscrepancy
from tyrefem.diagnose.data.residuals import Residuals
from tyrefem.diagnose.fitting.fits import FittedSet, linear_about
from tyrefem.diagnose.inference.evidence import posterior
from tyrefem.diagnose.numbers import percent
from tyrefem.diagnose.unknowns.candidates import Members
from tyrefem.diagnose.unknowns.unknown import Unknown
from tyrefem.diagnose.verdicts.partly import beside_discrepancies
from tyrefem.diagnose.verdicts.verdict import IDENTIFIED, PARTLY, Judgement, RankedSet, judge, probability

Array = NDArray[np.float64]
#: Factors on a prior.
FACTORS = (1 / 3, 3.0)
#: The priors that are changed: probability that the effect acts; standard deviation of its amplitudes.
PROBABILITY, AMPLITUDE = "probability", "amplitude"
#: Names of the two alternatives without an effect.
NO_EFFECT, OUTSIDE = "no effect", "not in the catalogue"
#: Effects of sets above this probability are examined, and so many of them; sets without a fit that are this far
#: below the best (nats) are not examined.
LEAST, MOST, FAR = 0.01, 8, 12.0


@dataclass(frozen=True)
class PriorChange(Brief):
    """The verdict with another prior of one effect.

    Parameters
    ----------
    effect : name of the effect (all variants and runs), or "no effect", or "not in the catalogue".
    prior : "probability" or "amplitude".
    factor : on the prior probability, or on the standard deviations of the amplitudes.
    verdict, best : the verdict and the named effects, or the most probable set if none is named.
    share : probability that the members of the most probable set act; of partly identified effects the smallest over
        the discrepancy models. decides : the verdict or its names change.
    """

    effect: str
    prior: str
    factor: float
    verdict: str
    best: str
    share: float
    decides: bool

    def _title(self) -> str:
        return f"{self.prior} of {self.effect} x {self.factor:.2g}: {self.verdict}, {self.best}"


def prior_sensitivity(
    judgement: Judgement,
    residuals: Residuals,
    null: FittedSet,
    best: FittedSet,
    robustness: Robustness | None = None,
    *,
    law_replaced: bool = False,
) -> tuple[PriorChange, ...]:
    """The verdicts that the priors of the leading effects decide; cheap, as nothing is simulated.

    A factor f on the prior probability of an effect, all its variants together, multiplies the odds of every set that
    contains it by f. Another standard deviation of its amplitudes changes the Gaussian evidence of these sets, see
    `evidence_change`. The verdict follows from the sets ranked again. Beside a discrepancy model, or another strain
    law that was tried, the odds of the effect change in the same way; the model's own probability stays. Laws that were
    not tried, and heat of unknown origin by itself if it was not fitted, do not count.

    Parameters
    ----------
    judgement : the verdict. residuals : measured minus computed. null, best : fits of no effect and of the best set.
    robustness : effects beside discrepancy models. law_replaced : another strain law stands in place of the study's.
    """
    ranking = judgement.ranking
    fits = [null, best]
    acting: Members = ()
    if judgement.verdict == PARTLY and robustness is not None:
        # The best fit is one beside a discrepancy.
        fits = [null, *(fit for model in robustness.models if model.name == NONE for fit in model.fits.values())]
        acting = best.members
    known = {frozenset(fit.members): fit for fit in fits}

    def verdict(entries: Sequence[RankedSet], models: Robustness | None) -> tuple[Judgement, str, float]:
        judged = judge(entries, lambda members: known.get(frozenset(members)), residuals.settings)
        members: Members = ()
        if models is not None:
            heat = models.heat
            revision = beside_discrepancies(judged, models, residuals.settings, law_replaced=law_replaced, heat=heat)
            judged = judged.revised(revision.verdict, revision.reasons, revision.doubts)
            members = revision.members
        if judged.verdict != PARTLY or models is None:
            return judged, judged.best.key, probability(judged.ranking)
        least = min(models.least(member.key) for member in members)
        return judged, " + ".join(sorted(member.key for member in members)), min(least, 1.0)

    before, name, _ = verdict(ranking, robustness)
    changes = []
    for effect, prior, factor, shifts, models in _variants(ranking, residuals, null, robustness, acting):
        again, named, share = verdict(_shifted(ranking, shifts), models)
        decides = (again.verdict, named) != (before.verdict, name)
        shown = again.verdict if decides else judgement.verdict
        changes.append(PriorChange(effect, prior, factor, shown, named, share, decides))
    return tuple(changes)


def prior_words(changes: Sequence[PriorChange], verdict: str, names: Collection[str] = ()) -> tuple[str, ...]:
    """One sentence on every prior that decides the verdict; empty if none does.

    A name rests on a prior only if it is lost with another one. ``names``: keys of the effects that the verdict names.
    """
    subjects = {NO_EFFECT: "the prior of no effect", OUTSIDE: "the prior of causes outside the catalogue"}
    sentences: dict[str, list[str]] = {}
    for change in (change for change in changes if change.decides):
        prior = subjects.get(change.effect, f"the prior of {change.effect}")
        sentences.setdefault(_consequence(change, verdict, names).format(prior=prior), []).append(change_words(change))
    return tuple(f"{sentence}: {'; '.join(clauses)}." for sentence, clauses in sentences.items())


def _consequence(change: PriorChange, verdict: str, names: Collection[str]) -> str:
    """What another prior does to the verdict or its names."""
    if verdict not in (IDENTIFIED, PARTLY):
        return "This verdict rests on {prior}"
    after = set(change.best.split(" + "))
    if change.verdict not in (IDENTIFIED, PARTLY) or not set(names) <= after:
        return "This name rests on {prior}"
    if after > set(names):
        return "More would be named with another value of {prior}"
    return "The verdict rests on {prior}, but the name does not"


def change_words(change: PriorChange) -> str:
    """The change of a prior and what follows from it.

    >>> change_words(PriorChange("hot-road", PROBABILITY, 1 / 3, "confounded", "hot-road", 0.8, True))
    'with a third of its probability before the data, confounded (most probable: hot-road, 80 %)'
    """
    size = "a third of" if change.factor < 1 else f"{change.factor:g} times"
    what = "its probability before the data" if change.prior == PROBABILITY else "its usual size"
    named = change.verdict in (IDENTIFIED, PARTLY)
    role = "" if named else "most probable: "
    return f"with {size} {what}, {change.verdict} ({role}{change.best}, {percent(change.share)})"


def evidence_change(fit_unknowns: Sequence[Unknown], J: Array, data: Array, changed: Mapping[Unknown, float]) -> float:
    """Change of ln evidence of d = J x + e if the prior sd of some unknowns is multiplied by factors.

    For one unknown without bounds with g = J^T J, b = J^T d: the difference of
    b^2 / (2 (g + 1/s^2)) - ln(1 + s^2 g) / 2 at both s.

    >>> x = Unknown("x", 1.0)
    >>> round(evidence_change([x], np.array([[2.0]]), np.array([3.0]), {x: 3.0}), 4)   # 36 x 9/74 - 36/10 - ln(37/5)/2
    -0.2224
    """
    gram, overlap = J.T @ J, J.T @ data
    sd, low, high = (np.array([getattr(unknown, name) for unknown in fit_unknowns]) for name in ("sd", "low", "high"))
    factor = np.array([changed.get(unknown, 1.0) for unknown in fit_unknowns])
    wider, stated = (posterior(gram, overlap, s, low, high).log_evidence for s in (sd * factor, sd))
    return wider - stated


# -- the changed priors ----------------------------------------------------------------------------------------------

_Variant = tuple[str, str, float, Mapping[int, float], Robustness | None]


def _variants(
    ranking: Sequence[RankedSet],
    residuals: Residuals,
    null: FittedSet,
    robustness: Robustness | None,
    acting: Members = (),
) -> list[_Variant]:
    """(effect, prior, factor, number of the set -> change of its score, effects beside discrepancy models)."""
    variants: list[_Variant] = []
    for name in leading_effects(ranking, acting):
        members = [[each for each in entry.members if each.name == name] for entry in ranking]
        with_it = [number for number, of_name in enumerate(members) if of_name]
        top = ranking[0].score
        near = [number for number in with_it if ranking[number].fit is not None or ranking[number].score > top - FAR]
        amplitudes = [unknown for number in near for each in members[number] for unknown in each.amplitudes]
        for factor in FACTORS:
            shift = math.log(factor)
            beside = _beside(robustness, name, functools.partial(_alike, shift=shift))
            variants.append((name, PROBABILITY, factor, dict.fromkeys(with_it, shift), beside))
        for factor in FACTORS if amplitudes else ():
            changed = dict.fromkeys(amplitudes, factor)
            shifts = {number: _shift(ranking, number, residuals, null, changed) for number in near}
            # Sets far below the best change as the best set with the effect does.
            shifts = dict.fromkeys(with_it, shifts[near[0]]) | shifts
            beside = _beside(robustness, name, functools.partial(_shift_beside, name=name, changed=changed))
            variants.append((name, AMPLITUDE, factor, shifts, beside))
    for key in (NO_EFFECT, OUTSIDE):
        places = [number for number, entry in enumerate(ranking) if entry.key == key]
        odds = [(factor, dict.fromkeys(places, math.log(factor))) for factor in (FACTORS if places else ())]
        variants += [(key, PROBABILITY, factor, shifts, robustness) for factor, shifts in odds]
    return variants


def leading_effects(ranking: Sequence[RankedSet], acting: Members = ()) -> tuple[str, ...]:
    """Names of the effects of the most probable set and of all sets above 1 %, at most eight.

    ``acting``: partly identified effects, which come first; no set needs them where heat of unknown origin leads.

    The variants of an effect, and its forms in single runs, share a prior.
    """
    sets = [entry for number, entry in enumerate(ranking) if number == 0 or entry.probability >= LEAST]
    members = (*acting, *(member for entry in sets for member in entry.members))
    return tuple(dict.fromkeys(member.name for member in members))[:MOST]


def _shift(
    ranking: Sequence[RankedSet],
    number: int,
    residuals: Residuals,
    null: FittedSet,
    changed: Mapping[Unknown, float],
) -> float:
    """Change of a set's ln evidence; without a fit in the linear model about its largest fitted subset."""
    entry = ranking[number]
    if entry.fit is not None:
        fit = entry.fit
        return evidence_change(fit.unknowns, fit.linear.jacobian, fit.linear.data, changed)
    wanted = set(entry.members)
    parts = [other.fit for other in ranking if other.fit is not None and set(other.members) < wanted]
    part = max(parts, key=lambda fit: (len(fit.members), fit.log_evidence), default=null)
    further = [member for member in entry.members if member not in part.members]
    amplitudes = [unknown for member in further for unknown in member.amplitudes]
    presence = [unknown for member in further for unknown in member.presence]
    linear = linear_about(residuals, part, (*amplitudes, *presence))
    free = (*part.unknowns, *amplitudes)
    J, present = linear.jacobian[:, : len(free)], linear.jacobian[:, len(free) :].sum(axis=1)
    return evidence_change(free, J, linear.data - present, changed)


def _shifted(ranking: Sequence[RankedSet], shifts: Mapping[int, float]) -> tuple[RankedSet, ...]:
    """The sets with changed scores, ranked again."""
    scores = np.array([entry.score + shifts.get(number, 0.0) for number, entry in enumerate(ranking)])
    shares = np.exp(scores - scores.max())
    shares /= shares.sum()
    order = np.argsort(-scores, kind="stable")
    return tuple(ranking[number].ranked(float(scores[number]), float(shares[number])) for number in order)


def _beside(
    robustness: Robustness | None, name: str, shift_of: Callable[[UnderDiscrepancy], float]
) -> Robustness | None:
    """The effects beside discrepancy models and strain laws; ``shift_of``: model -> change of ln odds of one effect."""
    if robustness is None:
        return None

    def shifted(model: UnderDiscrepancy) -> UnderDiscrepancy:
        forms = f"{name} (", f"{name} in "  # a name may have spaces
        of_effect = {key: share for key, share in model.named.items() if key == name or key.startswith(forms)}
        acts, odds = min(sum(of_effect.values()), 1.0), math.exp(min(shift_of(model), 700.0))
        total = 1 - acts + acts * odds
        named = {key: min(share * odds / total, 1.0) for key, share in of_effect.items()}
        return replace(model, named={**model.named, **named})

    models, laws = (tuple(map(shifted, each)) for each in (robustness.models, robustness.laws))
    return replace(robustness, models=models, laws=laws)


def _alike(_: UnderDiscrepancy, shift: float) -> float:
    """The same change of ln odds beside every model."""
    return shift


def _shift_beside(model: UnderDiscrepancy, name: str, changed: Mapping[Unknown, float]) -> float:
    """Change of ln evidence of the best fitted set with the effect beside a discrepancy model; 0 without such a fit."""
    fits = [fit for members, fit in model.fits.items() if any(each.name == name for each in members)]
    if not fits:
        return 0.0
    fit = max(fits, key=lambda each: each.log_evidence)
    return evidence_change(fit.unknowns, fit.linear.jacobian, fit.linear.data, changed)
