"""A measured table: CSV of one run, or of several with a ``run`` column."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from numbers import Real
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.measured.columns import bare_units, check_decimal_mark
from tyrefem.measured.heading import parts
from tyrefem.measured.lines import Lines, split
from tyrefem.measured.names import ColumnNames, in_table_words, missing_columns_error
from tyrefem.measured.run import MeasuredRun
from tyrefem.measured.spikes import spike_notes
from tyrefem.measured.table_columns import TableColumns, is_ignored, is_run
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
        named = ((i, in_table_words(text, names.rename)) for i, text in heading if not is_ignored(text, ignore))
        columns = [column for column, text in named if is_run(text)]
        return tuple(dict.fromkeys(row[columns[0]] for row in self.lines.rows)) if columns else (self.name,)

    def read(
        self, *, time_offset: float = 0.0, rename: Mapping[str, str] | None = None, ignore: Iterable[str] = ()
    ) -> MeasuredTable:
        """The runs; arguments and errors as of `read_table`, without the check that the columns to rename exist."""
        import pandas as pd

        lines, file = self.lines, self.file
        if not isinstance(time_offset, Real) or not math.isfinite(time_offset):
            raise InputError(f"{time_offset!r} is not a finite number of seconds", field="time_offset", file=file)
        columns = TableColumns.of(lines, dict(rename or {}), frozenset(ignore), file)
        if not lines.rows:
            raise InputError("has a heading but no readings", file=file)
        time, sensors = columns.time, columns.sensors
        check_decimal_mark(lines.rows, lines.numbers, [time.column, *(sensor.column for sensor in sensors)], file)
        readings = {sensor.name: sensor.readings(lines, file) for sensor in sensors}
        runs = []
        rows_of_runs = _rows_of_runs(columns.run, lines, file, self.name)
        source = None if self.in_memory else file
        times_of_runs, notes = time.of_runs(lines, rows_of_runs, time_offset, file)
        of_sensors = (note for sensor in sensors for note in sensor.notes(lines, readings[sensor.name]))
        notes = (*lines.notes, *notes, *bare_units(sensors), *of_sensors)
        for sensor in sensors:
            notes += spike_notes(sensor.heading, lines.numbers, readings[sensor.name], rows_of_runs, times_of_runs)
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


def _rows_of_runs(column: int | None, lines: Lines, file: Path, only: str) -> dict[str, NDArray[np.intp]]:
    """Run -> its rows; a table without a run column is one run, ``only``."""
    if column is None:
        return {only: np.arange(len(lines.rows))}
    rows_of: dict[str, list[int]] = {}
    for place, (row, line) in enumerate(zip(lines.rows, lines.numbers, strict=True)):
        if not row[column]:
            raise InputError(f"line {line}: the run column is empty", file=file)
        rows_of.setdefault(row[column], []).append(place)
    return {name: np.array(places) for name, places in rows_of.items()}
