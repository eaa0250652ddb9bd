"""Courses in time that heat of unknown origin may follow: constant, a switch, a ramp, a phase, one run, or any."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief, PickledFields

Array = NDArray[np.float64]
#: Prior sd of a run's deviation from the strength that all runs share, as a share of the prior sd of the strength.
OF_RUN = 0.5
#: Correlation times of a free course, as shares of the longest run.
CORRELATED = (0.1, 0.4)
#: Number of times at which a switch is tried.
SWITCHES = 60
CONSTANT, SPEED, BEGINS, ENDS, GROWS, FREE = "constant", "speed", "begins", "ends", "grows", "free"
#: Prefix of a course that acts in one phase, or in one run.
PHASE, RUN = "phase ", "run "


@dataclass(frozen=True, eq=False)
class CourseGrid(Brief, PickledFields):
    """The fitted runs of a diagnosis on a grid of times.

    Parameters
    ----------
    names : of the runs. knots : by run (n_knots,) s. phases : by run the (name, start, end) of its phases, s.
    speed : (run, time s) -> speed, m/s.
    """

    names: tuple[str, ...]
    knots: tuple[Array, ...]
    phases: tuple[tuple[tuple[str, float, float], ...], ...]
    speed: Callable[[int, float], float]

    @property
    def size(self) -> int:
        """Number of all knots."""
        return sum(len(knots) for knots in self.knots)

    @property
    def ends(self) -> Array:
        """(n_runs,) s: last knot of every run."""
        return np.array([knots[-1] for knots in self.knots])

    @property
    def rolling_phases(self) -> tuple[str, ...]:
        """Names of the phases in the middle of which a tyre rolls."""
        names = [
            name
            for number, phases in enumerate(self.phases)
            for name, start, end in phases
            if self.speed(number, (start + end) / 2) > 0
        ]
        return tuple(dict.fromkeys(names))

    def sampled(self, course: Callable[[int, Array], Array]) -> list[Array]:
        """By run (n_knots,): mean of a course over the hat of every knot. A switch between two knots keeps its time.

        ``course``: (number of the run, times s) -> strengths.
        """
        return [hats @ course(number, fine) / hats.sum(axis=1) for number, (fine, hats) in enumerate(self._hats)]

    @cached_property
    def _hats(self) -> tuple[tuple[Array, Array], ...]:
        """By run: many times (n_times,), s, and the hat of every knot (n_knots, n_times)."""
        result = []
        for knots in self.knots:
            fine = np.linspace(knots[0], knots[-1], 40 * (len(knots) - 1) + 1)
            result.append((fine, np.array([np.interp(fine, knots, hat) for hat in np.eye(len(knots))])))
        return tuple(result)

    def parts(self) -> list[slice]:
        """By run, the place of its knots among all."""
        edges = np.cumsum([0, *(len(knots) for knots in self.knots)])
        return [slice(int(start), int(end)) for start, end in pairwise(edges)]


@dataclass(frozen=True, eq=False)
class Course(Brief):
    """A course in time of unit strength, and its prior.

    Parameters
    ----------
    kind : constant, speed, begins, ends, grows, free, "phase NAME", "run NAME" or "run NAME begins".
    factor : (n_all_knots, r) factor of the prior, for a source of unit prior sd. time : of the switch, s, or None.
    strength : (n_all_knots,) the course itself; empty if free.
    """

    kind: str
    factor: Array
    time: float | None = None
    strength: Array = field(default_factory=lambda: np.zeros(0))


def courses(grid: CourseGrid) -> Iterator[Course]:
    """All courses that the runs can show."""
    yield _shaped(grid, CONSTANT, lambda _, t: np.ones_like(t))
    speeds = [np.array([grid.speed(number, float(t)) for t in knots]) for number, knots in enumerate(grid.knots)]
    top = max(float(speed.max()) for speed in speeds)
    moving = np.concatenate([speed[speed > 0] for speed in speeds])
    if moving.size and np.ptp(moving) > 0.02 * top:
        yield _shaped(grid, SPEED, lambda run, t: np.interp(t, grid.knots[run], speeds[run]) / top)
    for name in _switched_phases(grid):
        yield _shaped(grid, PHASE + name, _in_phase(grid, name))
    longest = float(grid.ends.max())
    for time in switch_times(grid):
        yield _shaped(grid, BEGINS, _after(time), time)
        yield _shaped(grid, ENDS, _before(time), time)
    for time in np.linspace(0.0, 0.8, 9) * longest:
        yield _shaped(grid, GROWS, _ramp(float(time), longest), float(time))
    if len(grid.names) > 1:
        for number, name in enumerate(grid.names):
            yield _shaped(grid, RUN + name, lambda _, t: np.ones_like(t), None, number)
            for time in switch_times(grid):
                if time < 0.95 * grid.ends[number]:
                    yield _shaped(grid, f"{RUN}{name} {BEGINS}", _after(time), time, number)
    for share in CORRELATED:
        yield free(grid, share * longest)


def constant(grid: CourseGrid) -> Course:
    """The same strength at all times."""
    return next(courses(grid))


def free(grid: CourseGrid, correlation: float) -> Course:
    """Any course: half of the variance is constant, half is correlated over a time (s), run by run."""
    factors = [np.full((grid.size, 1), np.sqrt(0.5))]
    for part, knots in zip(grid.parts(), grid.knots, strict=True):
        kernel = np.exp(-np.abs(knots[:, None] - knots) / correlation)
        wide = np.zeros((grid.size, len(knots)))
        wide[part] = np.linalg.cholesky(kernel + 1e-9 * np.eye(len(knots))) * np.sqrt(0.5)
        factors.append(wide)
    return Course(FREE, np.hstack(factors))


def switch_times(grid: CourseGrid) -> Array:
    """Times at which a switch is tried, s: within the longest run."""
    longest = float(grid.ends.max())
    return np.linspace(0.0, longest, SWITCHES + 1)[3:-1]


def _shaped(
    grid: CourseGrid,
    kind: str,
    course: Callable[[int, Array], Array],
    time: float | None = None,
    only: int | None = None,
) -> Course:
    """A course of given shape, with a strength that all runs share and a smaller part of every run."""
    parts = [strength * (only in (None, number)) for number, strength in enumerate(grid.sampled(course))]
    strength = np.concatenate(parts)
    columns = [strength]
    if only is None and len(parts) > 1:
        for part in grid.parts():
            column = np.zeros(grid.size)
            column[part] = OF_RUN * strength[part]
            columns.append(column)
    return Course(kind, np.column_stack(columns), time, strength)


def _switched_phases(grid: CourseGrid) -> Sequence[str]:
    """Names of the phases that are only a part of the drive."""
    names = dict.fromkeys(name for phases in grid.phases for name, start, end in phases if end > start)
    whole = min(len(phases) for phases in grid.phases) < 2
    return () if whole else tuple(names)


def _in_phase(grid: CourseGrid, name: str) -> Callable[[int, Array], Array]:
    def strength(run: int, t: Array) -> Array:
        inside = np.zeros_like(t)
        for phase, start, end in grid.phases[run]:
            if phase == name:
                inside[(t >= start) & (t < end)] = 1.0
        return inside

    return strength


def _after(time: float) -> Callable[[int, Array], Array]:
    return lambda _, t: (t >= time).astype(float)


def _before(time: float) -> Callable[[int, Array], Array]:
    return lambda _, t: (t < time).astype(float)


def _ramp(time: float, end: float) -> Callable[[int, Array], Array]:
    return lambda _, t: np.clip((t - time) / (end - time), 0.0, 1.0)
