"""The search: forward selection with the full model, each fit being the point from which the next sets are judged.

Which sets of effects to consider, how probable each is before any data, and which the data favour at first sight.
"""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Callable, Iterable, Sequence

import numpy as np

from tyrefem.diagnose.evidence import Linear, Members
from tyrefem.diagnose.fit import polished, refined
from tyrefem.diagnose.fitted import Explained
from tyrefem.diagnose.linearised import Gap
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns import Candidate, Unknown


class Prior:
    """ln of the prior probability of a set.

    No effect: 1 - ``expected``. A set of n: ``expected`` x ``shares``[n - 1], shared evenly by all sets of n different
    effects, and an effect's share by its variants. This is what corrects for the number of candidates tried.
    """

    def __init__(
        self, candidates: Sequence[Candidate], expected: float, shares: Sequence[float] = DiagnosisSettings.size_shares
    ) -> None:
        self.expected, self.shares = expected, shares
        names = [one.name for one in candidates]
        self._variants = {name: names.count(name) for name in names}
        self.effects = len(self._variants)

    def __call__(self, members: Members) -> float:
        n = len(members)
        if n == 0:
            return math.log(1 - self.expected)
        size = math.log(self.expected * self.shares[n - 1]) - math.log(math.comb(max(self.effects, n), n))
        return size - sum(math.log(self._variants[one.name]) for one in members)


def screened(
    linear: Linear, candidates: Sequence[Candidate], prior: Callable[[Members], float], largest: int = 3, beam: int = 30
) -> list[tuple[float, Members]]:
    """Sets up to ``largest`` effects with ln(prior x evidence) in the linear model, best first; the empty set included.

    All single effects and all pairs are tried; triples grow out of the best pairs.
    """
    ordered = list(candidates)
    found: list[tuple[float, Members]] = [(prior(()) + linear.log_evidence(()), ())]

    def score(members: Members) -> tuple[float, Members]:
        return prior(members) + linear.log_evidence(members), members

    singles = [score((one,)) for one in ordered]
    found += singles
    if largest >= 2:
        pairs = [score(pair) for pair in itertools.combinations(ordered, 2) if pair[0].name != pair[1].name]
        found += pairs
        if largest >= 3:
            best = sorted(pairs, key=lambda one: -one[0])[:beam]
            triples = {
                frozenset((*pair, third)): (*pair, third)
                for _, pair in best
                for third in ordered
                if third.name not in (one.name for one in pair)
            }
            found += [score(members) for members in triples.values()]
    return sorted(found, key=lambda one: -one[0])


Scored = tuple[float, Members, Explained | None]


class _Search:
    """Sets fitted so far, and estimates for all others."""

    def __init__(self, gap: Gap, candidates: Sequence[Candidate], prior: Prior, largest: int, tick: Tick) -> None:
        self.settings = gap.settings
        self.gap, self.candidates, self.prior, self.largest, self.tick = gap, candidates, prior, largest, tick
        self.order = {one: number for number, one in enumerate(candidates)}
        self.done: dict[Members, Explained] = {}
        #: Set -> how often its fit was carried on.
        self.polished: Counter[Members] = Counter()
        self.linear = gap.linear(gap.fitted)
        #: Set -> (estimate of ln(prior x evidence), whether it was judged from the fit of a part).
        self.estimate: dict[Members, tuple[float, bool]] = {
            self.sorted(members): (score + self.linear.constant, False)
            for score, members in screened(self.linear, candidates, prior, min(largest, 2), self.settings.beam)
        }

    def _count(self) -> None:
        if self.tick is not None:
            self.tick("simulating")

    def sorted(self, members: Iterable[Candidate]) -> Members:
        return tuple(sorted(members, key=self.order.__getitem__))

    def score(self, members: Members) -> float:
        return self.prior(members) + self.done[members].log_evidence

    @property
    def top(self) -> float:
        return max(self.score(members) for members in self.done)

    def fit(self, sets: Iterable[Members]) -> None:
        wanted = [members for members in dict.fromkeys(sets) if members not in self.done]
        for one in refined(self.gap, wanted, self._count, self._starts(wanted)):
            self.done[self.sorted(one.members)] = one
        # From a fit that has converged, the sets that add to it are judged once more.
        for members in dict.fromkeys((*wanted, *self._polish())):
            if members and len(members) < self.largest and self.score(members) > self.top - self.settings.far:
                self._extend(members)

    def _starts(self, sets: Sequence[Members]) -> dict[Members, Explained]:
        """For every set the best of its parts that nearly explains the data, if any."""
        ahead = [members for members in sorted(self.done, key=self.score, reverse=True) if self.done[members].close]
        found = {members: [part for part in ahead if set(part) < set(members)][:1] for members in sets}
        return {members: self.done[parts[0]] for members, parts in found.items() if parts}

    def _polish(self) -> list[Members]:
        """Carry the leading fits on to convergence: their numbers decide. Returns which."""
        carried: list[Members] = []
        for _ in range(self.settings.carried_sets * self.settings.carried_times):
            ahead = sorted(self.done, key=self.score, reverse=True)
            left = [
                members
                for members in ahead[: self.settings.carried_sets]
                if self.score(members) > self.top - self.settings.far and self._worth_carrying(members)
            ]
            if not left:
                break
            for one in polished(self.gap, [self.done[members] for members in left], self._count):
                self.done[self.sorted(one.members)] = one
            self.polished.update(left)
            carried += left
        return carried

    def _worth_carrying(self, members: Members) -> bool:
        one, often = self.done[members], self.polished[members]
        if one.finished or often >= self.settings.carried_times:
            return False
        if often or not self.singles:
            return one.misfit < (self.settings.doubted if often else self.settings.none_carried) * one.readings
        # The first steps of a strong effect may still be far off; what the linear model promises counts.
        return -2 * one.log_evidence < self.settings.lost * one.readings

    @property
    def singles(self) -> list[Members]:
        """What was fitted, but for no effect."""
        return [members for members in self.done if members]

    def extend_none(self) -> None:
        """Judge all single effects and pairs in the linear model about the fit of no effect."""
        one = self.done[()]
        unknowns = [unknown for each in self.candidates for unknown in (*each.amplitudes, *each.presence)]
        about = _about(self.gap, one, unknowns)
        own = self.prior(()) + about.log_evidence(())
        for score, members in screened(about, self.candidates, self.prior, min(self.largest, 2), self.settings.beam):
            if members:
                self.estimate[self.sorted(members)] = (self.score(()) + score - own, True)

    def _extend(self, members: Members) -> None:
        """Judge every set that adds one effect, in the linear model about the fit."""
        one = self.done[members]
        taken = {member.name for member in members}
        others = [each for each in self.candidates if each.name not in taken]
        unknowns = [unknown for each in others for unknown in (*each.amplitudes, *each.presence)]
        about = _about(self.gap, one, unknowns)
        own = about.log_evidence(())
        for each in others:
            more = self.sorted((*members, each))
            gain = about.log_evidence((each,)) - own + self.prior(more) - self.prior(members)
            known = self.estimate.get(more, (0.0, False))
            value = self.score(members) + gain
            # Judged from two parts, the better one counts.
            self.estimate[more] = (max(value, known[0]) if known[1] else value, True)

    def promising(self) -> list[Members]:
        top = self.top
        found = [
            (value, members)
            for members, (value, judged) in self.estimate.items()
            if members not in self.done and value > top - (self.settings.near if judged else self.settings.far)
        ]
        # A pair judged from afar waits until its parts have been fitted and it can be judged from there.
        found = [(value, members) for value, members in found if len(members) < 2 or self.estimate[members][1]]
        return [members for _, members in sorted(found, key=lambda one: -one[0])]


Tick = Callable[[str], None] | None


def search(
    gap: Gap,
    candidates: Sequence[Candidate],
    prior: Prior,
    *,
    largest: int = 3,
    tick: Tick = None,
    outside: Callable[[Explained], float] | None = None,
) -> list[Scored]:
    """Sets with ln(prior x evidence of the fitted runs), best first; with the fit where there was one.

    No effect is fitted first. Where it nearly explains the data, all effects and pairs are judged in the linear model
    about that fit, else in that of the study as it is, and the most promising effects are fitted with the full model.
    From every good fit, each effect that could be added is judged in the linear model about it, and the promising sets
    are fitted in turn. At the end every part of the best set has been fitted too (the backward check). ``outside``:
    score of a cause outside the catalogue, given the fit of no effect; when it is far ahead the search ends.
    """
    found = _Search(gap, candidates, prior, largest, tick)
    found.fit([()])
    singles = sorted(
        (members for members in found.estimate if len(members) == 1), key=lambda members: -found.estimate[members][0]
    )
    pairs = sorted(
        (members for members in found.estimate if len(members) == 2), key=lambda members: -found.estimate[members][0]
    )
    # Two effects that hide each other may both look weak alone: the parts of the best pair are tried as well.
    ahead = [(one,) for one in (pairs[0] if pairs else ())]
    if found.done[()].close:
        found.extend_none()
    else:
        found.fit([*singles[: gap.settings.singles], *ahead])
    batches = 0
    unknown = outside(found.done[()]) if outside else -np.inf
    while len(found.done) < gap.settings.most_sets and not (
        batches >= largest and unknown > found.top + gap.settings.hopeless
    ):
        batches += 1
        promising = found.promising()[: gap.settings.batch]
        if not promising:
            best = max(found.done, key=found.score)
            parts = [part for size in range(1, len(best)) for part in itertools.combinations(best, size)]
            missing = [part for part in parts if part not in found.done]
            if not missing:
                break
            promising = missing
        found.fit(promising)
    scored: list[Scored] = [(found.score(members), members, one) for members, one in found.done.items()]
    scored += [(value, members, None) for members, (value, _) in found.estimate.items() if members not in found.done]
    top, near = found.top, gap.settings.near
    # A set that was only judged from afar may not stand above the best that was fitted.
    return sorted(
        ((score if one is not None else min(score, top - near), members, one) for score, members, one in scored),
        key=lambda one: -one[0],
    )


def _about(gap: Gap, one: Explained, unknowns: Sequence[Unknown]) -> Linear:
    """The linear model about a fit, with the columns of further unknowns as at x = 0."""
    columns = [gap.unknowns.index(unknown) for unknown in unknowns]
    further = np.vstack([gap.whitened[i][:, columns] for i in gap.fitted])
    return Linear(
        (*one.unknowns, *unknowns),
        len(one.unknowns),
        one.data,
        np.hstack([one.jacobian, further]),
    )
