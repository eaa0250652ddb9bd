"""Which sets of effects to consider, how probable each is before any data, and which the data favour at first sight."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence

from tyrefem.diagnose.evidence import Linear, Members
from tyrefem.diagnose.unknowns import Candidate

#: Probability of one, two, three effects, given that there are any (estimate).
SIZES = (0.75, 0.22, 0.03)
#: So many sets of every size are carried to the next.
BEAM = 30


class Prior:
    """ln of the prior probability of a set.

    No effect: 1 - ``expected``. A set of n: ``expected`` x SIZES[n - 1], shared evenly by all sets of n different
    effects, and an effect's share by its variants. This is what corrects for the number of candidates tried.
    """

    def __init__(self, candidates: Sequence[Candidate], expected: float) -> None:
        self.expected = expected
        names = [one.name for one in candidates]
        self._variants = {name: names.count(name) for name in names}
        self.effects = len(self._variants)

    def __call__(self, members: Members) -> float:
        n = len(members)
        if n == 0:
            return math.log(1 - self.expected)
        size = math.log(self.expected * SIZES[n - 1]) - math.log(math.comb(max(self.effects, n), n))
        return size - sum(math.log(self._variants[one.name]) for one in members)


def screened(
    linear: Linear, candidates: Sequence[Candidate], prior: Callable[[Members], float], largest: int = 3
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
            best = sorted(pairs, key=lambda one: -one[0])[:BEAM]
            triples = {
                frozenset((*pair, third)): (*pair, third)
                for _, pair in best
                for third in ordered
                if third.name not in (one.name for one in pair)
            }
            found += [score(members) for members in triples.values()]
    return sorted(found, key=lambda one: -one[0])
