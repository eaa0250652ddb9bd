"""A table's rows as runs: a file, or a sheet of a workbook."""

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
from tyrefem.measured.lines import Lines
from tyrefem.measured.names import ColumnNames, in_table_words
from tyrefem.measured.run import MeasuredRun
from tyrefem.measured.spikes import spike_notes
from tyrefem.measured.table_columns import TableColumns, is_ignored, is_run


@dataclass(frozen=True, eq=False)
class Sheet:
    """The rows of a file, or of a sheet of a workbook, whose columns are not yet read.

    Parameters
    ----------
    lines : heading and rows. file : the table in errors. name : of the run of a table without a run column.
    in_memory : whether the table is no file. sheet : its name in errors; None: the file has no other.
    """

    lines: Lines
    file: Path
    name: str
    in_memory: bool = False
    sheet: str | None = None

    def runs(self, names: ColumnNames) -> tuple[str, ...]:
        """Names of the runs, if no more than one column has them."""
        ignore, heading = frozenset(names.ignore), enumerate(self.lines.heading)
        named = ((i, in_table_words(text, names.rename)) for i, text in heading if not is_ignored(text, ignore))
        columns = [column for column, text in named if is_run(text)]
        return tuple(dict.fromkeys(row[columns[0]] for row in self.lines.rows)) if columns else (self.name,)

    def read(
        self, *, time_offset: float = 0.0, rename: Mapping[str, str] | None = None, ignore: Iterable[str] = ()
    ) -> tuple[MeasuredRun, ...]:
        """The runs; arguments and errors as of `tyrefem.measured.read_table`, but for columns to rename."""
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
        return tuple(runs)


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
