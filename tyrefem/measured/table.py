"""A measured table: CSV of one run, or of several with a ``run`` column."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from numbers import Real
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import counted
from tyrefem.errors import InputError
from tyrefem.measured.columns import (
    COLDEST,
    HOTTEST,
    NO_READING,
    Heading,
    check_decimal_mark,
    check_plausible,
    is_mark,
    numbers,
)
from tyrefem.measured.heading import in_brackets, is_channel, parts, temperature_unit
from tyrefem.measured.lines import Lines, split
from tyrefem.measured.names import ColumnNames, in_table_words, missing_columns_error
from tyrefem.measured.run import MeasuredRun
from tyrefem.measured.times import TimeColumn
from tyrefem.output import as_path


def read_table(
    path: str | Path,
    *,
    time_offset: float = 0.0,
    rename: Mapping[str, str] | None = None,
    ignore: Iterable[str] = (),
) -> tuple[MeasuredRun, ...]:
    """The runs of a thermocouple table in the format of loggers.

    The heading has ``time [s]`` (or min, h, ms), perhaps ``run``, and one column per sensor with its unit:
    ``crown [degC]``, ``[degF]`` or ``[K]``. Timestamps, and clock times as h:mm:ss, count from the first row of their
    run. Units may stand in a row of their own. Columns in a unit of pressure, speed, force, length or
    power are not sensors and are left out (`MeasuredRun.channels`).
    Comma, semicolon or tab between columns; decimal comma or point; UTF-8, UTF-16 or Latin-1. Empty, ``NaN``, ``-``,
    ``--``, ``-9999`` = no reading. ``#`` and ``//`` begin a comment.

    Parameters
    ----------
    path : the CSV file.
    time_offset : s, added to every time of the table (model time = table time + offset).
    rename : column name -> sensor name, or ``time`` or ``run``. A time column without unit is given one so:
        ``{"Dauer": "time [mm:ss]"}``.
    ignore : column names to leave out, for temperatures of other things than sensors.

    Returns
    -------
    One `MeasuredRun` per run, in the order of their first row. Its ``notes`` say how content beyond the plain form was
    read.

    Raises
    ------
    InputError : unclear content, with file, line and column; an unknown column to rename; ``ignore`` or ``rename`` of
        another form.

    >>> import tempfile
    >>> file = Path(tempfile.mkdtemp()) / "run-1.csv"
    >>> _ = file.write_text("# Wallops\\ntime [min],crown [degF]\\n0,77\\n1,\\n2,95\\n")
    >>> run, = read_table(file)
    >>> run.name, run.times.tolist(), run.temperatures["crown"].tolist()
    ('run-1', [0.0, 60.0, 120.0], [25.0, nan, 35.0])
    """
    names = ColumnNames.of(ignore=ignore, rename=rename)
    table = table_lines(path, names.rename).read(time_offset=time_offset, rename=names.rename, ignore=names.ignore)
    missing = table.missing(names.rename)
    if missing:
        raise missing_columns_error(missing, "to rename", table.columns, table.file)
    return table.runs


@dataclass(frozen=True, eq=False)
class MeasuredTable:
    """The runs of a file, and the headings of all its columns, including ignored ones."""

    file: Path
    runs: tuple[MeasuredRun, ...]
    headings: tuple[str, ...]

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns, without their units."""
        return tuple(parts(text)[0] for text in self.headings if text)

    def missing(self, names: Iterable[str]) -> list[str]:
        """The names that are no column, with or without its unit."""
        return [name for name in names if name not in self.columns and name not in self.headings]


@dataclass(frozen=True, eq=False)
class TableLines:
    """The rows of a table whose columns are not yet read.

    Parameters
    ----------
    lines : heading and rows. file : the table in errors. name : of the run of a table without a run column.
    in_memory : whether the table is no file.
    """

    lines: Lines
    file: Path
    name: str
    in_memory: bool = False

    def runs(self, names: ColumnNames) -> tuple[str, ...]:
        """Names of the runs, if no more than one column has them."""
        ignore, heading = frozenset(names.ignore), enumerate(self.lines.heading)
        named = ((i, in_table_words(text, names.rename)) for i, text in heading if not _is_ignored(text, ignore))
        columns = [column for column, text in named if _is_run(text)]
        return tuple(dict.fromkeys(row[columns[0]] for row in self.lines.rows)) if columns else (self.name,)

    def read(
        self, *, time_offset: float = 0.0, rename: Mapping[str, str] | None = None, ignore: Iterable[str] = ()
    ) -> MeasuredTable:
        """The runs; arguments and errors as of `read_table`, without the check that the columns to rename exist."""
        import pandas as pd

        lines, file = self.lines, self.file
        if not isinstance(time_offset, Real) or not math.isfinite(time_offset):
            raise InputError(f"{time_offset!r} is not a finite number of seconds", field="time_offset", file=file)
        columns = _columns(lines, dict(rename or {}), frozenset(ignore), file)
        if not lines.rows:
            raise InputError("has a heading but no readings", file=file)
        time, sensors = columns.time, columns.sensors
        check_decimal_mark(lines.rows, lines.numbers, [time.column, *(sensor.column for sensor in sensors)], file)
        cells = list(zip(*lines.rows, strict=True))
        readings = {sensor.name: _readings(sensor, cells[sensor.column], lines, file) for sensor in sensors}
        runs = []
        rows_of_runs = _rows_of_runs(None if columns.run is None else cells[columns.run], lines, file, self.name)
        source = None if self.in_memory else file
        times_of_runs, notes = time.of_runs(lines, rows_of_runs, time_offset, file)
        notes = (*lines.notes, *notes, *_notes_on_sensors(sensors, lines.heading, cells, readings))
        for name, times in times_of_runs.items():
            rows = rows_of_runs[name]
            held = {sensor: values[rows] for sensor, values in readings.items() if np.isfinite(values[rows]).any()}
            if not held:
                raise InputError(f"run '{name}' has no reading at all", file=file)
            times.flags.writeable = False
            runs.append(MeasuredRun(name, times, pd.DataFrame(held), source, lines.comments, columns.channels, notes))
        return MeasuredTable(file, tuple(runs), lines.heading)


def table_lines(path: str | Path, rename: Mapping[str, str] | None = None) -> TableLines:
    """The rows of a file; ``rename``: column -> name, for a time column that is called otherwise."""
    file = as_path(path, "path")
    return TableLines(split(file, rename), file, file.stem)


def _is_ignored(text: str, ignore: frozenset[str]) -> bool:
    return bool({text, parts(text)[0]} & ignore)


def _is_run(text: str) -> bool:
    """Whether a heading is that of the run column."""
    return parts(text)[0].lower() == "run"


@dataclass(frozen=True)
class _Columns:
    """The time column, the index of the run column, the sensors, the headings of other quantities."""

    time: TimeColumn
    run: int | None
    sensors: tuple[Heading, ...]
    channels: tuple[str, ...]


def _columns(lines: Lines, rename: dict[str, str], ignore: frozenset[str], file: Path) -> _Columns:
    where = f"line {lines.heading_line}: "
    try:
        named = {
            column: in_table_words(text, rename)
            for column, text in enumerate(lines.heading)
            if not _is_ignored(text, ignore) and (text or any(row[column] for row in lines.rows))
        }
        time = TimeColumn.of(named, lines.rows)
    except InputError as error:
        raise InputError(where + error.message, field=error.field, file=file) from None
    run: int | None = None
    sensors: dict[str, Heading] = {}
    channels, without_unit, wrong = [], [], []
    for column in named:
        text = lines.heading[column]
        name = parts(text)[0]
        if time is not None and column in (time.column, time.date):
            continue
        try:
            if _is_run(named[column]):
                if run is not None:
                    raise InputError(f"two run columns, {run + 1} and {column + 1}")
                run = column
                continue
            if is_channel(text):
                channels.append(text)
                continue
            if not name:
                raise InputError(f"column {column + 1} has readings but no name")
            sensor = rename.get(text, rename.get(name, name))
            if sensor in sensors:
                first = lines.heading[sensors[sensor].column]
                raise InputError(f"two columns for sensor '{sensor}': '{first}' and '{text}'")
        except InputError as error:
            raise InputError(where + error.message, file=file) from None
        try:
            if not parts(text)[1]:
                without_unit.append(text)
            sensors[sensor] = Heading(sensor, temperature_unit(text), column)
        except InputError as error:
            wrong.append(error.message)
    if len(without_unit) > 1:
        names = ", ".join(f"'{text[:40]}'" for text in without_unit)
        wrong = [line for line in wrong if "has no unit" not in line]
        wrong.append(f"{names} have no unit; write '{without_unit[0][:40]} [degC]' (or [degF], [K])")
    if wrong:
        raise InputError(f"{where}{'; '.join(wrong)}; columns of other quantities need `ignore`", file=file)
    if time is None:
        raise InputError(f"{where}the time column is ignored; it is needed", file=file)
    if not sensors:
        raise InputError(f"{where}no sensor column beside '{lines.heading[time.column]}'", file=file)
    return _Columns(time, run, tuple(sensors.values()), tuple(channels))


def _notes_on_sensors(
    sensors: Iterable[Heading],
    heading: Sequence[str],
    cells: Sequence[Sequence[str]],
    readings: Mapping[str, NDArray[np.float64]],
) -> tuple[str, ...]:
    """Notes on units without brackets, and on words and numbers for a broken thermocouple."""
    notes = []
    bare = [sensor for sensor in sensors if in_brackets(heading[sensor.column])[1] is None]
    if bare:
        names = ", ".join(f"{parts(heading[sensor.column])[0][:60]} in {sensor.unit}" for sensor in bare)
        notes.append(f"units without brackets: {names}")
    for sensor in sensors:
        without = (cells[sensor.column][row] for row in np.flatnonzero(np.isnan(readings[sensor.name])).tolist())
        broken = [cell for cell in without if cell.lower() not in NO_READING]
        if broken:
            words = ", ".join(dict.fromkeys(broken))
            notes.append(f"no reading in {counted(len(broken), 'cell')} of '{heading[sensor.column][:60]}' ({words})")
    return tuple(notes)


def _readings(heading: Heading, cells: Sequence[str], lines: Lines, file: Path) -> NDArray[np.float64]:
    shown = lines.heading[heading.column]
    degC = heading.to_degC(numbers(cells, lines.numbers, shown, file, gaps=True))
    for row in np.flatnonzero((degC < COLDEST) | (degC > HOTTEST)).tolist():
        if is_mark(cells[row], degC[row]):
            degC[row] = np.nan
    if not np.isfinite(degC).any():
        raise InputError(f"column '{shown[:60]}' has no reading in any row", file=file)
    check_plausible(heading, degC, lines.numbers, file)
    return degC


def _rows_of_runs(cells: Sequence[str] | None, lines: Lines, file: Path, only: str) -> dict[str, NDArray[np.intp]]:
    """Run -> its rows; a table without a run column is one run, ``only``."""
    if cells is None:
        return {only: np.arange(len(lines.rows))}
    rows_of: dict[str, list[int]] = {}
    for row, (cell, line) in enumerate(zip(cells, lines.numbers, strict=True)):
        if not cell:
            raise InputError(f"line {line}: the run column is empty", file=file)
        rows_of.setdefault(cell, []).append(row)
    return {name: np.array(rows) for name, rows in rows_of.items()}
