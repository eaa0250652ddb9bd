"""Which effects may be missing, and how probable every set of them is before any data.

The catalogue holds the shipped effects and the user's own.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from tyrefem.brief import Brief
from tyrefem.diagnose.settings import DEFAULT
from tyrefem.diagnose.unknowns import Choice, Unknown, of_effect
from tyrefem.effects import catalogue
from tyrefem.effects.effect import Effect
from tyrefem.inputs.study import StudyData


@dataclass(frozen=True)
class Candidate(Brief):
    """An effect that may be missing: one variant of one entry of the catalogue.

    ``unknowns``: its amplitudes first, then the parameters that only shape it.
    """

    name: str
    choice: Choice
    unknowns: tuple[Unknown, ...]

    def _title(self) -> str:
        return self.key

    @property
    def key(self) -> str:
        """Name with its variant."""
        shown = ", ".join(value for _, value in self.choice)
        return f"{self.name} ({shown})" if shown else self.name

    @property
    def effect(self) -> type[Effect]:
        """The entry of the catalogue."""
        return catalogue()[self.name]

    @property
    def amplitudes(self) -> tuple[Unknown, ...]:
        """The unknowns that make the effect."""
        return tuple(unknown for unknown in self.unknowns if unknown.parameter and unknown.parameter.prior.amplitude)

    @property
    def presence(self) -> tuple[Unknown, ...]:
        """The unknown of an effect that is there or not, with nothing in between."""
        return tuple(unknown for unknown in self.unknowns if unknown.fixed)

    @property
    def shapes(self) -> tuple[Unknown, ...]:
        """The unknowns that only shape it."""
        return tuple(
            unknown for unknown in self.unknowns if unknown.parameter and not unknown.parameter.prior.amplitude
        )


#: A set of effects.
Members = tuple[Candidate, ...]
#: Which effects a study may lack.
CandidateSpace = Callable[[StudyData], tuple[Candidate, ...]]


def catalogue_candidates(study: StudyData) -> tuple[Candidate, ...]:
    """Every effect and variant of the catalogue that has a meaning in the study and is not in it already."""
    present = {(effect.name, tuple(effect.choice.items())) for effect in study.card.effects}
    candidates = []
    for name, effect in catalogue().items():
        if effect.calibration or name in study.card.diagnosis.exclude or effect.refusal(study) is not None:
            continue
        for variant in effect.variants(study):
            choice = tuple(variant.items())
            if (name, choice) not in present:
                candidates.append(Candidate(name, choice, of_effect(effect, choice)))
    return tuple(candidates)


class SetPrior:
    """ln of the prior probability of a set.

    No effect: 1 - ``expected``. A set of n: ``expected`` x ``shares[n - 1]``, shared evenly by all sets of n different
    effects, and an effect's share by its variants. This is what corrects for the number of candidates tried.
    """

    def __init__(
        self, candidates: Sequence[Candidate], expected: float, shares: Sequence[float] = DEFAULT.size_shares
    ) -> None:
        self.expected, self.shares = expected, shares
        names = [candidate.name for candidate in candidates]
        self._variants = {name: names.count(name) for name in names}
        self.effects = len(self._variants)

    def __call__(self, members: Members) -> float:
        n = len(members)
        if n == 0:
            return math.log(1 - self.expected)
        size = math.log(self.expected * self.shares[n - 1]) - math.log(math.comb(max(self.effects, n), n))
        return size - sum(math.log(self._variants[member.name]) for member in members)
