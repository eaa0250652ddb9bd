"""Fixed-step simulation of a fit: readings only, without error control and heat budget."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from tyrefem.cache import Cache, Content
from tyrefem.conduction.fixed_steps import GAMMA, fixed_step_solution
from tyrefem.conduction.points import located
from tyrefem.conduction.sensitivity import stage_times
from tyrefem.effects import catalogue
from tyrefem.geometry.meshing.sagitta import kept_inside
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.nearby_cycles import NearbyCycles
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.simulation.sensors import displacements, logged, recorded, true_places
from tyrefem.simulation.surroundings import GAS, RIM

Array = NDArray[np.float64]

#: A jump nearer than this to another is at the same time, s.
LEAST_STEP = 1.0
#: Drives of fewer steps take all of them for sensitivities.
FEW = 16
#: Difference quotients over the place of a sensor, m.
QUOTIENT = 2e-5
#: Places of sensors in a mesh, by section, size of the elements and true places.
_POINTS: Cache[Array] = Cache(size=256)


@dataclass(frozen=True, eq=False)
class FixedStepRun:
    """A study simulated with fixed time steps.

    Parameters
    ----------
    study : defines sensors and logger; it may differ from the tyre's study in effects of measurement.
    times : (n_times,) s, start, stage and end of every step. values, reservoirs : (n_times, n), (n_times, m) degC.
    every : s between two readings on `grid`.
    """

    study: StudyData
    tyre: RollingTyre
    times: Array
    values: Array
    reservoirs: Array
    every: float
    #: Temperatures on `grid` by point or reservoir, shared with the same simulation as measured by other sensors.
    _histories: Cache[Array] = field(default_factory=lambda: Cache(128), repr=False)
    #: What double steps leave out of the slopes of the sensors' readings, (n_sensors, n_grid), by sensors and unknown.
    left_out: Cache[Array] = field(default_factory=lambda: Cache(256), init=False, repr=False)

    def as_measured_by(self, study: StudyData) -> FixedStepRun:
        """The same temperatures, measured by the sensors of another study."""
        return dataclasses.replace(self, study=study)

    @cached_property
    def grid(self) -> Array:
        """Times of the readings, s."""
        return time_grid(self.times, self.every)

    @cached_property
    def starts(self) -> tuple[float, ...]:
        """Times at which data jump, s: between them a history is smooth. See `breaks`."""
        return tuple(start for start in breaks(self.study)[:-1] if np.abs(self.times - start).min() < 1e-9)

    def dense(self, history: Array, times: Array | None = None) -> Array:
        """A history at ``times`` (n_times, ...) on `grid`: cubic splines between the ends of steps, up to each jump.

        Default: the times of this simulation.
        """
        return on_grid(self.times if times is None else times, history, self.starts, self.grid)

    def in_double_steps(self) -> tuple[Array, Array, Array]:
        """Times, values and reservoirs of steps twice as long, for sensitivities at a fraction of the time."""
        times = double_steps(self.times, self.starts)
        values, reservoirs = (on_grid(self.times, each, self.starts, times) for each in (self.values, self.reservoirs))
        return times, values, reservoirs

    def at(self, s: Array, depth: Array) -> Array:
        """(n_grid, n_places) degC at stations and depths (n_places,), m."""
        section = self.tyre.study.section
        points = kept_inside(self.tyre.mesh, section.place(*section.clamp(s, depth)))
        return self.dense((located(self.tyre.problem.operators, points).value() @ self.values.T).T)

    @cached_property
    def sensor_points(self) -> Array:
        """(n_sensors, 2) m: places of the sensors, kept within the straight-sided elements."""
        return sensor_points(self.study, self.tyre)

    def _at_points(self, points: Array) -> Array:
        """(n_grid, n_points) degC at points (n_points, 2), m."""
        keys = [Content.of(point) for point in points]
        missing = [number for number, key in enumerate(keys) if key not in self._histories]
        computed = dict(zip(missing, self._computed(points[missing]).T, strict=True)) if missing else {}

        def column(number: int) -> Array:
            return computed[number] if number in computed else self._computed(points[[number]])[:, 0]

        columns = [self._histories.get(key, partial(column, number)) for number, key in enumerate(keys)]
        return np.column_stack(columns)

    def _of_reservoir(self, number: int) -> Array:
        return self.dense(self.reservoirs[:, number])

    def _computed(self, points: Array) -> Array:
        history = (located(self.tyre.problem.operators, points).value() @ self.values[::2].T).T
        return on_grid(self.times[::2], history, self.starts, self.grid, ends_only=True)

    @cached_property
    def readings(self) -> dict[str, Array]:
        """Sensor -> degC on `grid`, contained air and rim included."""
        at_sensors = None
        if self.study.sensors:
            at_sensors = self._at_points(self.sensor_points)
        names = list(self.tyre.problem.reservoirs)
        lumped = {
            name: self._histories.get(name, partial(self._of_reservoir, names.index(name)))
            for name in (GAS, RIM)
            if name in names
        }
        return read(self.study, self.grid, at_sensors, lumped)

    def displaced(self, shifts: Array) -> dict[str, Array]:
        """Sensor -> (n_grid, n_shifts) degC on `grid` if the sensors were elsewhere, the contained air not included.

        ``shifts`` (n_shifts, n_sensors, 2) m: along the meridian and in depth, from the sensors' places.
        """
        temperatures = self._computed(self._moved(shifts).reshape(-1, 2)).reshape(len(self.grid), *shifts.shape[:2])
        return recorded(self.study, self.grid, temperatures.swapaxes(1, 2))

    def at_displaced(self, shift: Array) -> dict[str, Array]:
        """Sensor -> (3, n_grid): change of the reading if all sensors move, K; its slopes over both directions, K/m.

        ``shift`` (n_sensors, 2) m: as in `displaced`. Where the wall ends a slope is that towards the inside.
        """
        inside = self._shift_inside(shift)
        steps = self._steps_inside(inside)
        shifts = np.array([shift, inside, inside])
        shifts[1, :, 0] += steps[:, 0]
        shifts[2, :, 1] += steps[:, 1]
        changes, of_sensor = {}, dict(zip(self.study.stated_places, steps, strict=True))
        for name, readings in self.displaced(shifts).items():
            there, along, deeper = readings.T
            by, into = of_sensor[name]
            changes[name] = np.array([there - self._unmoved[name], (along - there) / by, (deeper - there) / into])
        return changes

    @cached_property
    def _unmoved(self) -> dict[str, Array]:
        """Sensor -> (n_grid,) degC: `displaced` by nothing, for the changes of all further displacements."""
        still = np.zeros((1, *self._stated.shape))
        return {name: readings[:, 0] for name, readings in self.displaced(still).items()}

    def _steps_inside(self, shift: Array) -> Array:
        """(n_sensors, 2) m: signed steps of difference quotients about moved sensors, away from the end of the wall."""
        ahead = shift + QUOTIENT * np.array([[[0.0, 0.0]], [[1.0, 0.0]], [[0.0, 1.0]]])
        here, *there = self._moved(ahead)
        distances = np.linalg.norm(np.array(there) - here, axis=-1)
        return np.where(distances < QUOTIENT / 2, -QUOTIENT, QUOTIENT).T

    def _shift_inside(self, shift: Array) -> Array:
        """(n_sensors, 2) m: the shift to where a moved sensor is read, which in the mesh's edge is a sagitta deeper."""
        section, read = self.tyre.study.section, self._moved(shift)
        at_edge = np.linalg.norm(section.place(*(self._stated + shift).T) - read, axis=1) > 1e-9
        if not at_edge.any():
            return shift
        return np.where(at_edge[:, None], np.column_stack(section.locate(read)) - self._stated, shift)

    @cached_property
    def _stated(self) -> Array:
        """(n_sensors, 2) m: (s, depth) of the sensors, with the displacements that the study's effects have."""
        places = np.array(list(self.study.stated_places.values())).reshape(-1, 2)
        known = np.array(list(displacements(self.study).values())).reshape(-1, 2)
        return np.column_stack(self.tyre.study.section.locate(places)) + known

    def _moved(self, shifts: Array) -> Array:
        """(..., n_sensors, 2) m: (r, z) of the sensors, moved by ``shifts`` (..., n_sensors, 2) m and kept inside."""
        section = self.tyre.study.section
        s, depth = np.moveaxis(self._stated + shifts, -1, 0)
        places = section.place(*section.clamp(s.ravel(), depth.ravel()))
        return kept_inside(self.tyre.mesh, places).reshape(shifts.shape)


def sensor_points(study: StudyData, tyre: RollingTyre) -> Array:
    """(n_sensors, 2) m: places of a study's sensors in a tyre's mesh, kept within the straight-sided elements."""
    places = np.array(list(true_places(study).values())).reshape(-1, 2)
    mesh = tyre.mesh
    key = mesh.section, mesh.mesher, mesh.cell, mesh.size, Content.of(mesh.mesh.p), Content.of(places)
    return _POINTS.get(key, lambda: kept_inside(mesh, places))


def read(study: StudyData, grid: Array, at_sensors: Array | None, lumped: dict[str, Array]) -> dict[str, Array]:
    """Sensor -> degC on ``grid`` as the study's logger records it, contained air and rim included.

    Parameters
    ----------
    at_sensors : (n_grid, n_sensors) degC; None without sensors. lumped : contained air and rim if they are reservoirs.
    """
    readings = {name: logged(study, grid, column) for name, column in lumped.items()}
    if at_sensors is not None:
        readings = recorded(study, grid, at_sensors) | readings
    if GAS not in readings:
        held = study.card.boundaries.contained_air.fixed_temperature
        readings[GAS] = np.full(len(grid), held)
    return readings


def fixed_step_run(
    study: StudyData, like: RollingTyre | None = None, near: NearbyCycles | None = None, *, every: float = 5.0
) -> FixedStepRun:
    """Simulate a study's drive with fixed steps and a reading ``every`` s; ``like``, ``near``: see `RollingTyre`."""
    return run_of_tyre(study, RollingTyre(study, like, near=near), every=every)


def run_of_tyre(study: StudyData, tyre: RollingTyre, *, every: float) -> FixedStepRun:
    """`fixed_step_run` of a study's tyre."""
    times = stage_times(breaks(study))
    return FixedStepRun(study, tyre, times, *fixed_step_solution(tyre.problem, times, tyre.drive.initial), every)


def breaks(study: StudyData) -> list[float]:
    """Times at which data of a drive jump, s: start and end of every phase, and jumps of effects.

    Jumps of the catalogue's classes count for every study, so that all simulations of a diagnosis share their times.
    """
    drive = study.card.drive
    times = [*drive.starts, drive.end]
    of_classes = [effect.jumps for effect in catalogue().values() if isinstance(effect.jumps, tuple | list)]
    for jump in sorted(jump for jumps in (*of_classes, *(effect.jumps for effect in study.effects)) for jump in jumps):
        if 0 < jump < drive.end and min(abs(jump - time) for time in times) > LEAST_STEP:
            times.append(jump)
    return sorted(times)


def time_grid(times: Array, every: float) -> Array:
    """Evenly spaced times over the whole drive, s."""
    return np.linspace(times[0], times[-1], max(int(np.ceil((times[-1] - times[0]) / every)), 2) + 1)


def double_steps(times: Array, starts: Sequence[float]) -> Array:
    """Stage times in which two steps are one; after each of ``starts`` an odd first step stays.

    Drives of fewer steps than `FEW` keep them.

    >>> times = stage_times([0.0, 1200.0])
    >>> len(times), len(double_steps(times, [0.0]))
    (41, 21)
    """
    ends, edges = times[::2], [*starts, times[-1]]
    if len(ends) <= FEW:
        return times
    merged = [float(ends[0])]
    for start, end in pairwise(edges):
        inside = ends[(ends > start + 1e-9) & (ends < end + 1e-9)]
        for last in inside[1 - len(inside) % 2 :: 2]:
            merged += [merged[-1] + GAMMA * (last - merged[-1]), float(last)]
    return np.array(merged)


def on_grid(times: Array, history: Array, starts: tuple[float, ...], grid: Array, *, ends_only: bool = False) -> Array:
    """A history at stage times (or at ends of steps only) on a grid: cubic splines from each of ``starts`` on."""
    if not ends_only:
        times, history = times[::2], history[::2]
    values = np.empty((len(grid), *history.shape[1:]))
    edges = [*starts, times[-1]]
    for start, end in pairwise(edges):
        in_phase = (times >= start - 1e-9) & (times <= end + 1e-9)
        inside = (grid >= start - 1e-9) & (grid <= end + 1e-9)
        if inside.any():
            values[inside] = CubicSpline(times[in_phase], history[in_phase], axis=0)(grid[inside])
    return values
