"""A rig's measured tables, matched with its tests and averaged for a fit; and the rig's measurement operators."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from tyrefem.brief import Brief
from tyrefem.errors import InputError, ResultWarning, nearest, quoted
from tyrefem.heating_test.card import RigCard, RunCard, SensorCard
from tyrefem.heating_test.clock import Clock
from tyrefem.heating_test.grid import PatchGrid
from tyrefem.measured import MeasuredRun
from tyrefem.measured.names import ColumnNames
from tyrefem.measured.table import table_lines

Array = NDArray[Any]


#: Largest number of readings of a sensor in a test; more are averaged in groups of neighbours.
MOST = 400


#: Time that a logger may run longer than the card's phases, s.
_SLACK = 5.0
#: Standard deviations by which a table's clock may have the switch too early for its last readings to be computed.
_EARLY = 4.0


@dataclass(frozen=True, eq=False)
class SensorReadings(Brief):
    """A sensor in a test: mean readings of groups, their sizes, and the interpolation from computed times.

    Attributes
    ----------
    times, readings, counts : (n,) s, degC, readings per group.
    matrix : (n, computed times), if the table's clock is right.
    moments, group : (m,) time of every reading, s, and its group. clock : the computed times.
    """

    test: str
    sensor: str
    times: Array
    readings: Array
    counts: Array
    matrix: Array
    moments: Array
    group: Array
    clock: Clock

    def at(self, late: float) -> Array:
        """The interpolation if the laser was switched ``late`` s later by the table's clock than the card says."""
        return self.matrix if late == 0.0 else means_of_groups(self.clock.matrix(self.moments - late), self.group)

    def clock_slope(self, late: float) -> Array:
        """d interpolation / d ``late``, 1/s."""
        step = 0.1
        return (self.at(late + step) - self.at(late - step)) / (2 * step)


@dataclass(frozen=True, eq=False)
class HeatingTest(Brief):
    """A test: card, clock, and series by sensor."""

    name: str
    run: RunCard
    clock: Clock
    series: tuple[SensorReadings, ...]
    file: Path | None = None


def read(
    card: RigCard,
    tables: Iterable[str | Path],
    without: Sequence[str] = (),
    *,
    rename: Mapping[str, str] | None = None,
    ignore: Iterable[str] = (),
) -> tuple[HeatingTest, ...]:
    """Read tables as tests; their runs (``run`` column, else file name) must have names of the card's runs.

    Parameters
    ----------
    without : sensors of the card that the tables need not have.
    rename, ignore : columns with other names, and columns to leave out, as of `read_table`; some table must have each.

    Raises InputError naming file, run and column: an unknown or repeated run, a missing sensor column, a table that
    ends before the laser is on or ends after the card's phases.
    """
    for name in without:
        if name not in card.sensors:
            raise InputError(f"unknown sensor '{name}'{nearest(name, card.sensors)}", field="without")
    wanted = [name for name in card.sensors if name not in without]
    if not wanted:
        raise InputError("no sensor is left", field="without")
    names, columns = ColumnNames.of(ignore=ignore, rename=rename), list[str]()
    heating_tests: dict[str, HeatingTest] = {}
    for table in tables:
        measured = table_lines(table, names.rename).read(rename=names.rename, ignore=names.ignore)
        columns += [*measured.columns, *measured.headings]
        for run in measured.runs:
            if run.name not in card.runs:
                words = f"run '{run.name}' is not in the rig's card{nearest(run.name, card.runs)}"
                raise InputError(words, file=table)
            if run.name in heating_tests:
                first = heating_tests[run.name].file
                raise InputError(f"run '{run.name}' is given twice; it also stands in {first}", file=table)
            if run.notes:
                warnings.warn(f"{run.file}: {'; '.join(run.notes)}", ResultWarning, stacklevel=2)
            heating_tests[run.name] = matched(card, run, wanted, set(without))
    if not heating_tests:
        raise InputError("no table of a test is given")
    names.require(columns)
    return tuple(heating_tests[name] for name in card.runs if name in heating_tests)


def matched(card: RigCard, run: MeasuredRun, wanted: Sequence[str], without: Iterable[str] = ()) -> HeatingTest:
    """Match a measured run with a test of the card."""
    missing = [name for name in wanted if name not in run.sensors]
    unknown = [name for name in run.sensors if name not in wanted and name not in without]
    if len(missing) == 1:
        name = missing[0]
        columns = nearest(name, run.sensors)
        words = f"run '{run.name}' has no column '{name} [degC]'{columns} (--without {name} fits without it)"
        raise InputError(words, file=run.file)
    if missing:
        words = f"run '{run.name}' has no columns {quoted(missing, run.sensors)} (--without SENSOR fits without one)"
        raise InputError(words, file=run.file)
    if len(unknown) == 1:
        words = f"column '{unknown[0]}' is no sensor of the rig{nearest(unknown[0], card.sensors)}"
        raise InputError(words, file=run.file)
    if unknown:
        allowed = ", ".join(card.sensors)
        words = f"columns {quoted(unknown, card.sensors)} are no sensors of the rig; allowed: {allowed}"
        raise InputError(words, file=run.file)
    idle, end = card.phases.idle, card.phases.end
    if run.times[0] < -_SLACK:
        raise InputError(f"run '{run.name}' begins at {run.times[0]:g} s; time 0 is the start of idling", file=run.file)
    if run.times[-1] > end + _SLACK:
        words = f"run '{run.name}' lasts until {run.times[-1]:g} s, but the card's phases end at {end:g} s"
        raise InputError(words, file=run.file)
    if np.sum(run.times > idle) < 5:
        words = f"run '{run.name}' has fewer than 5 readings after {idle:g} s, when the laser is switched on"
        raise InputError(words, file=run.file)
    clock = Clock(card.phases, float(min(run.times[-1], end)), _EARLY * card.phases.clock_sd)
    series = []
    for name in wanted:
        held = np.isfinite(run.temperatures[name].to_numpy(dtype=float))
        if not np.any(run.times[held] > idle):
            raise InputError(f"run '{run.name}' has no reading of '{name}' with the laser on", file=run.file)
        values = run.temperatures[name].to_numpy(dtype=float)[held]
        series.append(_series(run.name, name, run.times[held], values, clock, card))
    return HeatingTest(run.name, card.runs[run.name], clock, tuple(series), run.file)


def _series(test: str, sensor: str, times: Array, values: Array, clock: Clock, card: RigCard) -> SensorReadings:
    """Average groups of neighbours, none of which crosses a switch of the laser."""
    size = int(np.ceil(times.size / MOST))
    phases = card.phases
    phase = np.searchsorted([phases.idle, phases.idle + phases.heating], times, side="right")
    number = np.zeros(times.size, dtype=int)
    for p in np.unique(phase):
        here = np.flatnonzero(phase == p)
        number[here] = number.max() + 1 + np.arange(here.size) // size
    _, number = np.unique(number, return_inverse=True)
    counts = np.bincount(number).astype(float)
    return SensorReadings(
        test,
        sensor,
        np.bincount(number, times) / counts,
        np.bincount(number, values) / counts,
        counts,
        means_of_groups(clock.matrix(times), number),
        times,
        number,
        clock,
    )


def means_of_groups(rows: Array, group: Array) -> Array:
    """Mean of the rows (m, n) of every group, which are numbered 0, 1, 2 ... without a gap."""
    starts = np.flatnonzero(np.diff(group, prepend=-1))
    return np.asarray(np.add.reduceat(rows, starts) / np.bincount(group)[:, None])


_RINGS, _ANGLES = 4, 12


def _disc(radius: float) -> tuple[Array, Array]:
    """Points of equal weight on a disc."""
    rho = radius * np.sqrt((np.arange(_RINGS) + 0.5) / _RINGS)
    angle = (np.arange(_ANGLES) + 0.5) * 2 * np.pi / _ANGLES
    return np.outer(rho, np.cos(angle)).ravel(), np.outer(rho, np.sin(angle)).ravel()


def view(name: str, sensor: SensorCard, grid: PatchGrid, values: Mapping[str, float]) -> csr_matrix:
    """Measurement operator (1, unknowns) of a sensor for nodal temperatures, without lag and offset.

    The spot's centre is at (spot_along, spot_across) from the mark, the sensor at (aside, 0).
    """
    x, y = sensor.aside - values["spot_along"], values["spot_across"]
    if sensor.instrument == "thermocouple":
        return grid.at([np.hypot(x, y)], [values[f"{name}.depth"]])
    depth = 0.0 if sensor.face == "outer" else float(grid.depths[-1])
    if sensor.window == 0:
        return grid.at([np.hypot(x, y)], [depth])
    dx, dy = _disc(sensor.window / 2)
    rows = grid.at(np.hypot(x + dx, y + dy), depth)
    return csr_matrix(rows.mean(axis=0))
