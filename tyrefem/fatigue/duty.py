"""What a drive asks of every point: revolutions of each strain cycle, weighted by the temperature there."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyrefem.fatigue.growth import temperature_factor
from tyrefem.materials.fatigue import Fatigue
from tyrefem.mechanics.stored_cycles import solved

if TYPE_CHECKING:
    from tyrefem.mechanics.cycle_schedule import CycleSchedule
    from tyrefem.simulation.rolling_tyre import RollingTyre

Array = NDArray[np.float64]

#: Intervals of a phase for a temperature that is given.
INTERVALS = 16
#: Temperatures at places (n, 2) in (r, z), m: (times, n), degC.
Temperatures = Callable[[Array], Array]


class WarmRun(Protocol):
    """What a duty asks of a finished run; variants of reduced models have it too."""

    @property
    def tyre(self) -> RollingTyre:
        """The rolling tyre, with its strain cycles."""
        ...

    @property
    def times(self) -> Array:
        """Times of the readings, (n,) s."""
        ...

    def near(self, points: ArrayLike) -> Array:
        """Temperatures at points (n, 2) in (r, z), m, of another mesh of the section: (n_times, n), degC."""
        ...


@dataclass(frozen=True, eq=False)
class Duty:
    """A drive as intervals of time; speed and load case are those of the middle of each.

    Parameters
    ----------
    schedule : load cases and strain cycles of the drive. times : (n + 1,) ends of the intervals, s.
    temperatures : at places, at the times.
    """

    schedule: CycleSchedule
    times: Array
    temperatures: Temperatures

    @classmethod
    def of_run(cls, result: WarmRun, *, plateau: bool = False) -> Duty:
        """The drive of a finished run at its temperatures; with ``plateau`` each phase at those of its end."""
        times = np.asarray(result.times)
        if not plateau:
            return cls(solved(result.tyre.schedule), times, lambda places: np.asarray(result.near(places)))
        starts = np.asarray(result.tyre.schedule.drive.starts)
        ends = np.append(starts[1:], result.tyre.schedule.drive.end)
        # Every phase has its own begin and end: the time between two phases stands twice, an interval of no length.
        inside = [(times > start - 1e-9) & (times < end + 1e-9) for start, end in zip(starts, ends, strict=True)]
        last = np.concatenate([np.full(int(part.sum()), np.flatnonzero(part)[-1]) for part in inside])
        repeated = np.concatenate([times[part] for part in inside])
        return cls(solved(result.tyre.schedule), repeated, lambda places: np.asarray(result.near(places))[last])

    @classmethod
    def at_temperature(cls, schedule: CycleSchedule, temperature: float) -> Duty:
        """The drive at one temperature everywhere, degC."""
        edges = np.append(np.asarray(schedule.drive.starts), schedule.drive.end)
        parts = [np.linspace(a, b, INTERVALS + 1)[:-1] for a, b in itertools.pairwise(edges)]
        times = np.append(np.concatenate(parts), edges[-1])
        return cls(schedule, times, lambda places: np.full((len(times), len(places)), temperature))

    @property
    def _middles(self) -> Array:
        return np.asarray((self.times[1:] + self.times[:-1]) / 2)

    def distance(self) -> float:
        """Distance that the wheel travels over the road in the drive, m; with slip it turns less or more often."""
        speeds = np.array([self.schedule.motion(float(t)).speed for t in self._middles])
        return float((speeds * np.diff(self.times)).sum())

    def revolutions(self) -> dict[tuple[int, int], Array]:
        """(phase, knot) of a load case -> (n,) its revolutions in each interval, shared between two in a ramp."""
        counts: dict[tuple[int, int], Array] = {}
        for i, (t, step) in enumerate(zip(self._middles, np.diff(self.times), strict=True)):
            turns = self.schedule.revolutions_per_second(float(t)) * step
            for phase, knot, weight in self.schedule.weights(float(t)):
                if turns * weight > 0:
                    counts.setdefault((phase, knot), np.zeros(len(self.times) - 1))[i] += turns * weight
        return counts

    def cycles(self) -> dict[tuple[int, ...], tuple[Any, Array]]:
        """Strain cycles with load that occur, each with its phases and (phases, n) revolutions in each interval.

        Phases with the same footprint share a cycle; the key is the first (phase, knot) that has it.
        """
        phases = len(self.schedule.drive.phases)
        merged: dict[tuple[int, ...], tuple[Any, Array]] = {}
        places: dict[Any, tuple[int, ...]] = {}
        for (phase, knot), turns in self.revolutions().items():
            cycle: Any = self.schedule.cycles[phase][knot]
            if cycle.footprint is None:
                continue
            key = places.setdefault(cycle.footprint, (phase, knot))
            _, counts = merged.setdefault(key, (cycle, np.zeros((phases, len(turns)))))
            counts[phase] += turns
        return merged


@dataclass(frozen=True, eq=False)
class WarmRevolutions:
    """Revolutions at points, weighted by the growth of cracks at their temperatures over that at the reference.

    Parameters
    ----------
    weighted : key of a cycle -> (phases, points). mean : (points,) degC, mean temperature weighted alike.
    """

    weighted: Mapping[tuple[int, ...], Array]
    mean: Array

    @classmethod
    def at(
        cls, fatigue: Fatigue, temperatures: Array, cycles: Mapping[tuple[int, ...], tuple[Any, Array]]
    ) -> WarmRevolutions:
        """Of a compound at points with temperatures (times, points), degC."""
        factors = temperature_factor(fatigue, temperatures)
        factors, degrees = (factors[1:] + factors[:-1]) / 2, (temperatures[1:] + temperatures[:-1]) / 2
        weighted = {key: counts @ factors for key, (_, counts) in cycles.items()}
        turns = sum((counts.sum(axis=0) for _, counts in cycles.values()), np.zeros(len(factors)))
        total = turns @ factors
        mean = (turns @ (factors * degrees)) / np.where(total > 0, total, 1.0)
        return cls(weighted, np.asarray(mean))
