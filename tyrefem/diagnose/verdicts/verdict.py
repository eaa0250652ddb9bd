"""From fitted sets to a verdict: identified, confounded, unexplained or no gap."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tyrefem.brief import Brief
from tyrefem.diagnose.fitting.fits import FittedSet
from tyrefem.diagnose.fitting.materiality import Movement, Movements
from tyrefem.diagnose.fitting.pulls import improbable_pulls
from tyrefem.diagnose.fitting.selection import ScoredSet
from tyrefem.diagnose.numbers import parameter_name, percent
from tyrefem.diagnose.settings import DEFAULT, DiagnosisSettings
from tyrefem.diagnose.unknowns.candidates import Candidate, Members

IDENTIFIED, CONFOUNDED, UNEXPLAINED, NO_GAP = "identified", "confounded", "unexplained", "no gap"
#: More is wrong than effects explain, but some effects act whatever else is wrong.
PARTLY = "partly identified"
#: Largest number of sets in a reason.
SHOWN = 8
#: Sets below this probability are not examined for effects that move no reading.
LEAST = 0.01


@dataclass(frozen=True)
class RankedSet(Brief):
    """A set of effects with its ``score`` = ln(prior x evidence), its ``probability`` and its fit, if there is one.

    ``outside``: a cause outside the catalogue; ``outside_held_out``: how it predicts the held-out runs, see `held_out`.
    """

    members: Members
    score: float
    probability: float
    fit: FittedSet | None
    outside: bool = False
    outside_held_out: float = math.nan

    def _title(self) -> str:
        return f"{self.key}: {self.probability:.3g}"

    def ranked(self, score: float, probability: float) -> RankedSet:
        """The set with another score and probability. `replace` is slow for thousands of sets."""
        return RankedSet(self.members, score, probability, self.fit, self.outside, self.outside_held_out)

    @property
    def held_out(self) -> float:
        """ln p(held-out data | fitted data, set); NaN if the set was not fitted, or no run is held out."""
        return self.outside_held_out if self.outside else math.nan if self.fit is None else self.fit.held_out

    @property
    def words(self) -> str:
        """The set as a subject of "predict": "hot-road predicts", "heat of unknown origin predicts"."""
        if self.outside:
            return "heat of unknown origin predicts"
        return f"{self.key if self.members else 'the study without any effect'} predicts"

    @property
    def key(self) -> str:
        """The keys of the members, or "no effect", or "not in the catalogue"."""
        if self.outside:
            return "not in the catalogue"
        return " + ".join(sorted(member.key for member in self.members)) or "no effect"


@dataclass(frozen=True)
class Judgement(Brief):
    """The verdict, the sets in order of probability, and the reasons as sentences.

    ``named``: candidate key -> probability that it acts. ``credible``: the sets with 99 % joint probability, and a set
    that predicts the held-out runs clearly better. ``doubts``: reasons against the best set, as whole sentences.
    """

    verdict: str
    ranking: tuple[RankedSet, ...]
    named: dict[str, float]
    credible: tuple[RankedSet, ...]
    reasons: tuple[str, ...]
    doubts: tuple[str, ...] = ()

    @property
    def best(self) -> RankedSet:
        """The most probable set."""
        return self.ranking[0]

    @property
    def probability(self) -> float:
        """Probability that all members of the best set act, alone or with other effects."""
        return probability(self.ranking)

    def revised(self, verdict: str, reasons: tuple[str, ...], doubts: tuple[str, ...]) -> Judgement:
        """The same sets with another verdict."""
        return replace(self, verdict=verdict, reasons=reasons, doubts=doubts)


def ranked(
    scored: Sequence[ScoredSet], outside: float | None = None, outside_held_out: float = math.nan
) -> tuple[RankedSet, ...]:
    """Sets with their probabilities, best first.

    ``outside``: score of a cause outside the catalogue. ``outside_held_out``: ln p(held-out data | fitted data) of it.
    """
    rows = [(entry.score, entry.members, entry.fit, False) for entry in scored]
    if outside is not None:
        rows.append((outside, (), None, True))
    top = max(score for score, *_ in rows)
    total = sum(math.exp(score - top) for score, *_ in rows)
    sets = [
        RankedSet(
            members, score, math.exp(score - top) / total, fit, is_outside, outside_held_out if is_outside else math.nan
        )
        for score, members, fit, is_outside in rows
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
    """Joint probability of the best set and of all its supersets."""
    best = ranking[0]
    keys = {member.key for member in best.members}
    if not keys or best.outside:
        return best.probability
    return sum(entry.probability for entry in ranking if keys <= {member.key for member in entry.members})


def certain_members(judgement: Judgement, settings: DiagnosisSettings) -> Members:
    """The members of the most probable set that act with at least 95 % probability, alone or with others."""
    least = settings.named_probability
    return tuple(member for member in judgement.best.members if judgement.named.get(member.key, 0.0) >= least)


def rejection(key: str, fit: FittedSet, settings: DiagnosisSettings) -> str:
    """The reason why a fitted set is no explanation of the data; empty if there is none. ``key``: name of the set."""
    if fit.p_value < settings.rejected_p:
        left = f"leaves a misfit that noise gives with probability {fit.p_value:.1g}"
        return f"the best set ({key}) {left}: another effect is missing"
    if improbable := improbable_pulls(key, fit, settings):
        return improbable
    if fit.held_out_p < settings.rejected_p:
        return f"the held-out runs reject {key} (probability {fit.held_out_p:.1g})"
    return ""


def better_on_held_out(ranking: Sequence[RankedSet], fit: FittedSet, margin: float) -> tuple[RankedSet, float] | None:
    """The set that predicts the held-out runs best, and its lead over ``fit`` in nats, if that exceeds ``margin``."""
    others = [
        (entry, entry.held_out - fit.held_out)
        for entry in ranking
        if math.isfinite(entry.held_out - fit.held_out) and entry.held_out - fit.held_out > margin
    ]
    return max(others, key=lambda pair: pair[1]) if others else None


def without_immaterial(
    ranking: Sequence[RankedSet], movements_of: Callable[[FittedSet], Movements], floor: float
) -> tuple[tuple[RankedSet, ...], dict[Candidate, Movement]]:
    """Sets ranked again, and the effects left out: those that move no reading by more than ``floor`` (K).

    The probability of a set with such an effect goes to the set without it: as far as readings can tell, the two say
    the same.
    """
    rows, left_out = list(ranking), dict[Candidate, Movement]()
    examined: list[FittedSet] = []

    def is_left(row: RankedSet) -> bool:
        probable = row.fit is not None and bool(row.members) and row.probability > LEAST
        return probable and all(row.fit is not fit for fit in examined)

    while True:
        entry = next((row for row in rows if is_left(row)), None)
        if entry is None or entry.fit is None:
            return tuple(rows), left_out
        examined.append(entry.fit)
        small = {member: move for member, move in movements_of(entry.fit).items() if abs(move.kelvin) <= floor}
        if not small:
            continue
        left_out |= small
        part = tuple(member for member in entry.members if member not in small)
        rows.remove(entry)
        known = next((row for row in rows if not row.outside and set(row.members) == set(part)), None)
        if known is None:
            rows.append(replace(entry, members=part, fit=None))
        else:
            score = float(np.logaddexp(known.score, entry.score))
            rows[rows.index(known)] = replace(known, score=score, probability=known.probability + entry.probability)
        rows.append(replace(entry, score=-math.inf, probability=0.0))
        rows.sort(key=lambda row: -row.score)


def _bounded(fit: FittedSet) -> list[str]:
    """Effect and parameter of every amplitude on a bound."""
    amplitudes = [(member, unknown) for member in fit.members for unknown in member.amplitudes]
    bounded = [(member, unknown) for member, unknown in amplitudes if unknown.key in fit.at_bound]
    return [f"{member.key} ({parameter_name(unknown)})" for member, unknown in bounded]


def _against_outside(
    ranking: Sequence[RankedSet], fit_of: Callable[[Members], FittedSet | None], settings: DiagnosisSettings
) -> RankedSet | None:
    """The set of effects that the data cannot tell from the leading heat of unknown origin; None if there is none.

    Noise explains its misfit, and the held-out runs speak neither against it nor clearly for the heat.
    """
    leading, *others = ranking
    entry = next((each for each in others if not each.outside), None)
    if entry is None or not entry.members or leading.probability >= settings.challenged_probability:
        return None
    fit = entry.fit or fit_of(entry.members)
    if fit is None or rejection(entry.key, fit, settings):
        return None
    lead = leading.held_out - fit.held_out
    return None if lead > settings.held_out_margin else entry


def judge(
    ranking: Sequence[RankedSet],
    fit_of: Callable[[Members], FittedSet | None],
    settings: DiagnosisSettings = DEFAULT,
) -> Judgement:
    """The verdict on sets ranked by probability.

    - *unexplained*: heat of unknown origin has at least 90 % probability, or is most probable and no effects stand
      against it; or the best set leaves a misfit that noise cannot explain, needs improbable corrections, or is
      rejected by the held-out runs; or these are predicted clearly better without any effect, or by heat of unknown
      origin.
    - *no gap*: the empty set is most probable.
    - *identified*: the best set acts with at least 95 % probability, and alone with at least 50 %; no best value of an
      amplitude lies beyond a bound; no other set predicts the held-out runs clearly better; its fit has converged.
    - *confounded*: all other cases.
    """
    best = ranking[0]
    credible, mass = [], 0.0
    for entry in ranking:
        credible.append(entry)
        mass += entry.probability
        if mass >= settings.credible_mass:
            break
    named = inclusion(ranking)
    fit = best.fit or fit_of(best.members)
    reasons: list[str] = []

    def verdict(name: str, doubt: str = "") -> Judgement:
        doubts = (f"{doubt[0].upper()}{doubt[1:]}.",) if doubt else ()
        reasons.extend([doubt] if doubt else [])
        return Judgement(name, tuple(ranking), named, tuple(credible), tuple(reasons), doubts)

    if best.outside:
        if against := _against_outside(ranking, fit_of, settings):
            reasons.append(f"these sensors and runs cannot tell {against.key} from a cause outside the catalogue")
            return verdict(CONFOUNDED)
        reasons.append("heat of unknown origin explains the data better than any set of effects in the catalogue")
        return verdict(UNEXPLAINED)
    if fit is not None:
        if doubt := rejection(best.key, fit, settings):
            return verdict(UNEXPLAINED, doubt)
        if better := better_on_held_out(ranking, fit, settings.held_out_margin):
            other, lead = better
            doubt = f"{other.words} the held-out runs better than {best.key}, by {lead:.0f} nats"
            if other.outside or not other.members:
                return verdict(UNEXPLAINED, doubt)
            credible += [] if other in credible else [other]
            return verdict(CONFOUNDED, doubt)
    if not best.members:
        reasons.append("noise and the uncertainty of base numbers and sensors explain the deviation")
        return verdict(NO_GAP)
    if fit is not None and fit.at_bound:
        reasons.append("the best value lies beyond a physical bound: " + ", ".join(_bounded(fit)))
        return verdict(CONFOUNDED)
    if fit is not None and not fit.settled:
        return verdict(CONFOUNDED, f"the fit of {best.key} has not converged, so its probability is not certain")
    sure = probability(ranking)
    if sure >= settings.named_probability and best.probability >= settings.alone_probability:
        reasons.append(f"{best.key} is missing with {percent(sure)} probability, summed over all sets of effects")
        return verdict(IDENTIFIED)
    more = f"; and {len(credible) - SHOWN} more" if len(credible) > SHOWN else ""
    shown = "; ".join(entry.key for entry in credible[:SHOWN])
    reasons.append(f"these sensors and runs cannot distinguish: {shown}{more}")
    return verdict(CONFOUNDED)
