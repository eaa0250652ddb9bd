"""The effects that may be missing, and the prior probability of every set of effects.

The catalogue holds the shipped effects and the user's effects.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from tyrefem.brief import Brief
from tyrefem.diagnose.settings import DEFAULT
from tyrefem.diagnose.unknowns.unknown import Choice, Unknown, of_effect, with_values
from tyrefem.effects import catalogue
from tyrefem.effects.effect import Effect
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData


@dataclass(frozen=True)
class Candidate(Brief):
    """An effect that may be missing: one variant of one entry of the catalogue.

    ``unknowns``: the amplitudes, then the shape parameters. ``runs``: the measured runs in which the effect acts;
    empty: all.
    """

    name: str
    choice: Choice
    unknowns: tuple[Unknown, ...]
    runs: tuple[str, ...] = ()

    def __hash__(self) -> int:
        return hash((self.name, self.choice, self.runs))

    def _title(self) -> str:
        return self.key

    @cached_property
    def key(self) -> str:
        """Name, variant and runs."""
        return key_of(self.name, dict(self.choice), self.runs)

    def in_runs(self, runs: Sequence[str]) -> Candidate:
        """The same effect in some measured runs only."""
        return replace(self, unknowns=tuple(unknown.in_runs(runs) for unknown in self.unknowns), runs=tuple(runs))

    @property
    def effect(self) -> type[Effect]:
        """The entry of the catalogue."""
        return catalogue()[self.name]

    @cached_property
    def amplitudes(self) -> tuple[Unknown, ...]:
        """The unknowns that are the size of the effect; at 0 the effect is absent."""
        return tuple(unknown for unknown in self.unknowns if unknown.parameter and unknown.parameter.prior.amplitude)

    @cached_property
    def presence(self) -> tuple[Unknown, ...]:
        """The unknown of an effect without amplitude: x = 1 if the effect is present, 0 if it is absent."""
        return tuple(unknown for unknown in self.unknowns if unknown.fixed)

    @cached_property
    def shapes(self) -> tuple[Unknown, ...]:
        """The unknowns that are shape parameters."""
        return tuple(
            unknown for unknown in self.unknowns if unknown.parameter and not unknown.parameter.prior.amplitude
        )


def key_of(name: str, choice: Mapping[str, str], runs: Sequence[str] | None = None) -> str:
    """Name of an effect with its variant and its runs.

    >>> key_of("yaw", {"side": "left"}, ["run-2"])
    'yaw (left) in run-2'
    """
    shown = ", ".join(choice.values())
    variant = f" ({shown})" if shown else ""
    return f"{name}{variant} in {', '.join(runs)}" if runs else f"{name}{variant}"


#: Effects of slip, slip angle and camber, which a drive that rolls with friction has by its phases.
SHORTCUTS = ("yaw", "tread-slip", "camber")
#: A set of effects.
Members = tuple[Candidate, ...]
#: Function of a study: the effects that it may lack.
CandidateSpace = Callable[[StudyData], tuple[Candidate, ...]]


def catalogue_candidates(study: StudyData) -> tuple[Candidate, ...]:
    """Every effect and variant of the catalogue that applies to the study and is not in it."""
    present = {(effect.name, tuple(effect.choice.items())) for effect in study.card.effects if not effect.runs}
    candidates = []
    for name, effect in catalogue().items():
        if effect.calibration or name in study.card.diagnosis.exclude or effect.refusal(study) is not None:
            continue
        for variant in effect.variants(study):
            choice = tuple(variant.items())
            if (name, choice) not in present:
                candidates.append(Candidate(name, choice, of_effect(effect, choice)))
    return tuple(candidates)


def in_single_runs(study: StudyData, candidates: Sequence[Candidate], runs: Sequence[str]) -> Members:
    """The candidates that depend on the day, each in one of several runs; without those that the study has.

    ``runs``: the fitted runs. With one run only, an effect in this run is the effect in all runs.
    """
    if len(runs) < 2:
        return ()
    present = {
        (effect.name, tuple(effect.choice.items()), run) for effect in study.card.effects for run in effect.runs or ()
    }
    return tuple(
        candidate.in_runs([run])
        for candidate in candidates
        if not candidate.runs and candidate.effect.of_the_day
        for run in runs
        if (candidate.name, candidate.choice, run) not in present
    )


def separate(candidate: Candidate, others: Iterable[Candidate]) -> bool:
    """Whether a candidate may be in one set with others: no other has its name, or both act in different runs."""
    of_effect = [other.runs for other in others if other.name == candidate.name]
    return all(candidate.runs and runs and set(candidate.runs).isdisjoint(runs) for runs in of_effect)


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


def beside_rolling(study: StudyData, candidates: Iterable[Candidate]) -> tuple[str, ...]:
    """A note on effects of slip and camber where the tyre of the drive rolls with friction already."""
    names = [name for name in SHORTCUTS if any(candidate.name == name for candidate in candidates)]
    if not names or not study.card.boundaries.sliding.rolls:
        return ()
    return (
        f"the drive rolls with friction (boundaries.sliding), so {', '.join(names)} would stand for more slip angle, "
        "slip or camber than it states; their heat is a shortcut beside that of the rolling contact: if one is named, "
        "change drive.slip_angle, drive.slip_ratio or drive.camber instead of adding it",
    )


def simulated(candidates: Sequence[Candidate], without: Collection[Unknown]) -> tuple[Members, tuple[str, ...]]:
    """The candidates whose readings could be computed, and a note on those with an unknown in ``without``."""
    failed = [candidate for candidate in candidates if not set(candidate.unknowns).isdisjoint(without)]
    everywhere = {(candidate.name, candidate.choice) for candidate in failed if not candidate.runs}
    named = [each for each in failed if not each.runs or (each.name, each.choice) not in everywhere]
    notes = (f"{candidate.key} was left out, because no tyre with it could be simulated" for candidate in named)
    return tuple(candidate for candidate in candidates if candidate not in failed), tuple(notes)


class SetPrior:
    """ln of the prior probability of a set.

    No effect: 1 - ``expected``. Sets of n effects: ``expected`` x ``shares[n - 1]``, shared evenly by all sets of n
    different effects. The share of an effect is shared evenly by its variants; of an effect that is also a candidate
    in single runs, these have ``odd_run`` of the share, evenly. The prior corrects for the number of candidates.
    Each effect beyond the number of ``shares`` has the last share as a factor.
    """

    def __init__(
        self,
        candidates: Sequence[Candidate],
        expected: float,
        shares: Sequence[float] = DEFAULT.size_shares,
        odd_run: float = DEFAULT.odd_run_share,
    ) -> None:
        self.expected, self.shares = expected, shares
        forms = Counter((candidate.name, bool(candidate.runs)) for candidate in candidates)
        self.effects = len({name for name, _ in forms})
        self._log_share = {
            (name, odd): math.log((odd_run if odd else 1 - odd_run) if (name, not odd) in forms else 1.0)
            - math.log(count)
            for (name, odd), count in forms.items()
        }

    def __call__(self, members: Members) -> float:
        n = len(members)
        if n == 0:
            return math.log(1 - self.expected)
        beyond = max(n - len(self.shares), 0)
        share = self.shares[n - beyond - 1] * self.shares[-1] ** beyond
        size = math.log(self.expected * share) - math.log(math.comb(max(self.effects, n), n))
        return size + sum(self._log_share[member.name, bool(member.runs)] for member in members)
