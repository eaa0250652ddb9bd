"""The effects that may be missing, and the prior probability of every set of effects.

The catalogue holds the shipped effects and the user's effects.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

from tyrefem.brief import Brief
from tyrefem.diagnose.settings import DEFAULT
from tyrefem.diagnose.unknowns import Choice, Unknown, of_effect, with_values
from tyrefem.effects import catalogue
from tyrefem.effects.effect import Effect
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData


@dataclass(frozen=True)
class Candidate(Brief):
    """An effect that may be missing: one variant of one entry of the catalogue.

    ``unknowns``: the amplitudes, then the shape parameters.
    """

    name: str
    choice: Choice
    unknowns: tuple[Unknown, ...]

    def _title(self) -> str:
        return self.key

    @property
    def key(self) -> str:
        """Name and variant."""
        shown = ", ".join(value for _, value in self.choice)
        return f"{self.name} ({shown})" if shown else self.name

    @property
    def effect(self) -> type[Effect]:
        """The entry of the catalogue."""
        return catalogue()[self.name]

    @property
    def amplitudes(self) -> tuple[Unknown, ...]:
        """The unknowns that are the size of the effect; at 0 the effect is absent."""
        return tuple(unknown for unknown in self.unknowns if unknown.parameter and unknown.parameter.prior.amplitude)

    @property
    def presence(self) -> tuple[Unknown, ...]:
        """The unknown of an effect without amplitude: x = 1 if the effect is present, 0 if it is absent."""
        return tuple(unknown for unknown in self.unknowns if unknown.fixed)

    @property
    def shapes(self) -> tuple[Unknown, ...]:
        """The unknowns that are shape parameters."""
        return tuple(
            unknown for unknown in self.unknowns if unknown.parameter and not unknown.parameter.prior.amplitude
        )


#: A set of effects.
Members = tuple[Candidate, ...]
#: Function of a study: the effects that it may lack.
CandidateSpace = Callable[[StudyData], tuple[Candidate, ...]]


def catalogue_candidates(study: StudyData) -> tuple[Candidate, ...]:
    """Every effect and variant of the catalogue that applies to the study and is not in it."""
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


def possible(study: StudyData, candidates: Sequence[Candidate]) -> tuple[Members, tuple[str, ...]]:
    """The candidates with which the study can be built, and a note on each of the others."""
    kept, notes = [], []
    for candidate in candidates:
        try:
            with_values(study, {unknown: unknown.step for unknown in (*candidate.amplitudes, *candidate.presence)})
        except InputError as error:
            notes.append(f"{candidate.key} was left out, because the study cannot have it: {error.message}")
        else:
            kept.append(candidate)
    return tuple(kept), tuple(notes)


def simulated(candidates: Sequence[Candidate], without: Collection[Unknown]) -> tuple[Members, tuple[str, ...]]:
    """The candidates whose readings could be computed, and a note on those with an unknown in ``without``."""
    failed = [candidate for candidate in candidates if not set(candidate.unknowns).isdisjoint(without)]
    notes = (f"{candidate.key} was left out, because no tyre with it could be simulated" for candidate in failed)
    return tuple(candidate for candidate in candidates if candidate not in failed), tuple(notes)


class SetPrior:
    """ln of the prior probability of a set.

    No effect: 1 - ``expected``. Sets of n effects: ``expected`` x ``shares[n - 1]``, shared evenly by all sets of n
    different effects. The share of an effect is shared evenly by its variants. The prior corrects for the number of
    candidates.
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
