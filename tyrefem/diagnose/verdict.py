"""From fitted sets to a verdict: identified, confounded, unexplained or no gap."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from tyrefem.brief import Brief
from tyrefem.diagnose.candidates import Members
from tyrefem.diagnose.fits import FittedSet
from tyrefem.diagnose.selection import ScoredSet
from tyrefem.diagnose.settings import DEFAULT, DiagnosisSettings

IDENTIFIED, CONFOUNDED, UNEXPLAINED, NO_GAP = "identified", "confounded", "unexplained", "no gap"
#: So many sets are named in a reason.
SHOWN = 8


@dataclass(frozen=True)
class RankedSet(Brief):
    """A set of effects and how it stands: ``score`` = ln(prior x evidence), ``probability``, the fit if any."""

    members: Members
    score: float
    probability: float
    fit: FittedSet | None
    outside: bool = False

    def _title(self) -> str:
        return f"{self.key}: {self.probability:.3g}"

    @property
    def key(self) -> str:
        """The set in words."""
        if self.outside:
            return "not in the catalogue"
        return " + ".join(sorted(member.key for member in self.members)) or "no effect"


@dataclass(frozen=True)
class Judgement(Brief):
    """The verdict, the sets in order of probability, and the reasons in sentences.

    ``named``: candidate key -> probability that it acts. ``credible``: the sets that make up 99 %.
    """

    verdict: str
    ranking: tuple[RankedSet, ...]
    named: dict[str, float]
    credible: tuple[RankedSet, ...]
    reasons: tuple[str, ...]

    @property
    def best(self) -> RankedSet:
        """The most probable set."""
        return self.ranking[0]

    @property
    def probability(self) -> float:
        """Probability that all of the best set acts, whatever else does."""
        return probability(self.ranking)


def ranked(scored: Sequence[ScoredSet], outside: float | None = None) -> tuple[RankedSet, ...]:
    """Sets with their probabilities, best first; ``outside``: score of a cause outside the catalogue."""
    rows = [(entry.score, entry.members, entry.fit, False) for entry in scored]
    if outside is not None:
        rows.append((outside, (), None, True))
    top = max(score for score, *_ in rows)
    total = sum(math.exp(score - top) for score, *_ in rows)
    sets = [
        RankedSet(members, score, math.exp(score - top) / total, fit, elsewhere)
        for score, members, fit, elsewhere in rows
    ]
    return tuple(sorted(sets, key=lambda entry: -entry.score))


def inclusion(ranking: Sequence[RankedSet]) -> dict[str, float]:
    """Candidate -> probability that it acts."""
    shares: dict[str, float] = {}
    for entry in ranking:
        for member in entry.members:
            shares[member.key] = shares.get(member.key, 0.0) + entry.probability
    return dict(sorted(shares.items(), key=lambda item: -item[1]))


def probability(ranking: Sequence[RankedSet]) -> float:
    """Joint probability of the best set and of all sets that hold it."""
    best = ranking[0]
    keys = {member.key for member in best.members}
    if not keys or best.outside:
        return best.probability
    return sum(entry.probability for entry in ranking if keys <= {member.key for member in entry.members})


def judge(
    ranking: Sequence[RankedSet],
    fit_of: Callable[[Members], FittedSet | None],
    settings: DiagnosisSettings = DEFAULT,
) -> Judgement:
    """The verdict on sets ranked by probability.

    A set is *identified* when it acts with at least 90 % probability, and alone with at least 50 %,
    no amplitude is pressed against a bound, the misfit is one that noise makes, and the held-out runs do not reject
    it. Without such a set: *no gap* if no effect is the most probable,
    *unexplained* if the cause is outside the catalogue or the best set does not fit, else *confounded*.
    """
    best = ranking[0]
    credible, mass = [], 0.0
    for entry in ranking:
        credible.append(entry)
        mass += entry.probability
        if mass >= settings.credible:
            break
    named = inclusion(ranking)
    fit = best.fit or fit_of(best.members)
    reasons: list[str] = []

    def verdict(name: str) -> Judgement:
        return Judgement(name, tuple(ranking), named, tuple(credible), tuple(reasons))

    if best.outside:
        reasons.append("heat of unknown origin explains the data better than any set of effects in the catalogue")
        return verdict(UNEXPLAINED)
    if fit is not None and fit.p_value < settings.improbable:
        reasons.append(
            f"the best set ({best.key}) leaves a misfit that noise makes with probability {fit.p_value:.1g}: "
            "something else is missing"
        )
        return verdict(UNEXPLAINED)
    if not best.members:
        reasons.append("noise and the uncertainty of base numbers and sensors account for the disagreement")
        return verdict(NO_GAP)
    if fit is not None and fit.held_out_p < settings.improbable:
        reasons.append(f"the held-out runs reject {best.key} (probability {fit.held_out_p:.1g})")
        return verdict(UNEXPLAINED)
    if fit is not None and fit.at_bound:
        reasons.append("the data want it beyond a bound that physics sets: " + ", ".join(fit.at_bound))
        return verdict(CONFOUNDED)
    sure = probability(ranking)
    if sure >= settings.sure and best.probability >= settings.whole:
        reasons.append(f"{best.key} is missing with {100 * sure:.1f} % probability, by all sets of effects tried")
        return verdict(IDENTIFIED)
    more = f"; and {len(credible) - SHOWN} more" if len(credible) > SHOWN else ""
    shown = "; ".join(entry.key for entry in credible[:SHOWN])
    reasons.append(f"these sensors and runs cannot tell apart: {shown}{more}")
    return verdict(CONFOUNDED)
