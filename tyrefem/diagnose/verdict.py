"""From fitted sets to a verdict: identified, confounded, unexplained or no gap."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from tyrefem.brief import Brief
from tyrefem.diagnose.evidence import Members
from tyrefem.diagnose.fitted import Explained
from tyrefem.diagnose.settings import DEFAULT, DiagnosisSettings

IDENTIFIED, CONFOUNDED, UNEXPLAINED, NO_GAP = "identified", "confounded", "unexplained", "no gap"
#: So many sets are named in a reason.
SHOWN = 8


@dataclass(frozen=True)
class Standing(Brief):
    """A set of effects and how it stands: ``score`` = ln(prior x evidence), ``probability``, the fit if any."""

    members: Members
    score: float
    probability: float
    explained: Explained | None
    unexplained: bool = False

    def _title(self) -> str:
        return f"{self.key}: {self.probability:.3g}"

    @property
    def key(self) -> str:
        """The set in words."""
        if self.unexplained:
            return "not in the catalogue"
        return " + ".join(sorted(one.key for one in self.members)) or "no effect"


@dataclass(frozen=True)
class Judgement(Brief):
    """The verdict, the sets in order of probability, and the reasons in sentences.

    ``named``: candidate key -> probability that it is part of the truth. ``credible``: the sets that make up 99 %.
    """

    verdict: str
    standings: tuple[Standing, ...]
    named: dict[str, float]
    credible: tuple[Standing, ...]
    reasons: tuple[str, ...]

    @property
    def best(self) -> Standing:
        """The most probable set."""
        return self.standings[0]

    @property
    def probability(self) -> float:
        """Probability that all of the best set is part of the truth, whatever else is."""
        return probability(self.standings)


def standings(
    scores: Sequence[tuple[float, Members, Explained | None]], unknown: float | None = None
) -> tuple[Standing, ...]:
    """Sets with their probabilities, best first; ``unknown``: score of a cause outside the catalogue."""
    rows = [(score, members, explained, False) for score, members, explained in scores]
    if unknown is not None:
        rows.append((unknown, (), None, True))
    top = max(score for score, *_ in rows)
    total = sum(math.exp(score - top) for score, *_ in rows)
    found = [
        Standing(members, score, math.exp(score - top) / total, explained, outside)
        for score, members, explained, outside in rows
    ]
    return tuple(sorted(found, key=lambda one: -one.score))


def inclusion(ranked: Sequence[Standing]) -> dict[str, float]:
    """Candidate -> probability that it is part of the truth."""
    found: dict[str, float] = {}
    for one in ranked:
        for member in one.members:
            found[member.key] = found.get(member.key, 0.0) + one.probability
    return dict(sorted(found.items(), key=lambda item: -item[1]))


def probability(ranked: Sequence[Standing]) -> float:
    """Joint probability of the best set and of all sets that hold it."""
    best = ranked[0]
    own = {one.key for one in best.members}
    if not own or best.unexplained:
        return best.probability
    return sum(one.probability for one in ranked if own <= {member.key for member in one.members})


def judge(
    ranked: Sequence[Standing],
    explained: Callable[[Members], Explained | None],
    settings: DiagnosisSettings = DEFAULT,
) -> Judgement:
    """The verdict on sets ranked by probability.

    A set is *identified* when it is part of the truth with at least 90 % and all of it with at least 50 % probability,
    no amplitude is pressed against a bound, the misfit is one that noise makes, and the held-out runs do not reject
    it. Without such a set: *no gap* if no effect is the most probable,
    *unexplained* if the cause is outside the catalogue or the best set does not fit, else *confounded*.
    """
    best = ranked[0]
    credible, mass = [], 0.0
    for one in ranked:
        credible.append(one)
        mass += one.probability
        if mass >= settings.credible:
            break
    named = inclusion(ranked)
    fit = best.explained or explained(best.members)
    reasons: list[str] = []

    def verdict(name: str) -> Judgement:
        return Judgement(name, tuple(ranked), named, tuple(credible), tuple(reasons))

    if best.unexplained:
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
    sure = probability(ranked)
    if sure >= settings.sure and best.probability >= settings.whole:
        reasons.append(f"{best.key} is missing with {100 * sure:.1f} % probability, by all sets of effects tried")
        return verdict(IDENTIFIED)
    more = f"; and {len(credible) - SHOWN} more" if len(credible) > SHOWN else ""
    shown = "; ".join(one.key for one in credible[:SHOWN])
    reasons.append(f"these sensors and runs cannot tell apart: {shown}{more}")
    return verdict(CONFOUNDED)
