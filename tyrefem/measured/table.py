"""A measured table: CSV of one run, or of several with a ``run`` column."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError, nearest
from tyrefem.measured.cells import numbers, one_decimal_mark, plausible
from tyrefem.measured.heading import TIME_UNITS, Heading, is_time, parts, temperature_unit, time_unit
from tyrefem.measured.lines import Lines, split
from tyrefem.measured.run import MeasuredRun

#: s; 30 years. A larger time is a calendar time, which needs ``time_offset``.
LONGEST_TIME = 1e9


def read_table(
    path: str | Path,
    *,
    time_offset: float = 0.0,
    rename: Mapping[str, str] | None = None,
    ignore: Iterable[str] = (),
) -> tuple[MeasuredRun, ...]:
    """The runs of a thermocouple table as loggers write it.

    The heading has ``time [s]`` (or min, h, ms), perhaps ``run``, and one column per sensor with its unit:
    ``crown [degC]``, ``[degF]`` or ``[K]``. Comma, semicolon or tab between columns; decimal comma or point;
    UTF-8, UTF-16 or Latin-1. Empty, ``NaN``, ``-``, ``--`` = no reading. ``#`` and ``//`` begin a comment.

    Parameters
    ----------
    path : the CSV file.
    time_offset : s, added to every time of the table (model time = table time + offset).
    rename : column name -> sensor name.
    ignore : column names to leave out, for channels that are no temperature.

    Returns
    -------
    One `MeasuredRun` per run, in the order of their first row.

    Raises
    ------
    InputError : anything unclear, with file, line and column.

    >>> import tempfile
    >>> file = Path(tempfile.mkdtemp()) / "run-1.csv"
    >>> _ = file.write_text("# Wallops\\ntime [min],crown [degF]\\n0,77\\n1,\\n2,95\\n")
    >>> run, = read_table(file)
    >>> run.name, run.times.tolist(), run.temperatures["crown"].tolist()
    ('run-1', [0.0, 60.0, 120.0], [25.0, nan, 35.0])
    """
    import pandas as pd

    file = Path(path)
    if not np.isfinite(time_offset):
        raise InputError(f"{time_offset!r} is not a finite number of seconds", field="time_offset", file=file)
    lines = split(file)
    time, run_column, sensors = _columns(lines, dict(rename or {}), frozenset(ignore), file)
    if not lines.rows:
        raise InputError("has a heading but no readings", file=file)
    one_decimal_mark(lines.rows, lines.numbers, [time.column, *(one.column for one in sensors)], file)
    cells = list(zip(*lines.rows, strict=True))
    shown = lines.heading[time.column]
    times = numbers(cells[time.column], lines.numbers, shown, file, gaps=False)
    times = times * TIME_UNITS[time.unit] + time_offset
    if np.abs(times).max() > LONGEST_TIME:
        raise InputError(
            f"column '{shown}': {times[np.abs(times).argmax()]:g} s is no time since a start; "
            "give time_offset if the table holds calendar times",
            file=file,
        )
    readings = {one.name: _readings(one, cells[one.column], lines, file) for one in sensors}
    runs = []
    for name, rows in _rows_of_runs(None if run_column is None else cells[run_column], lines, file).items():
        _increasing(times[rows], [lines.numbers[row] for row in rows], name, file)
        held = {sensor: values[rows] for sensor, values in readings.items() if np.isfinite(values[rows]).any()}
        if not held:
            raise InputError(f"run '{name}' has no reading at all", file=file)
        own = times[rows]
        own.flags.writeable = False
        runs.append(MeasuredRun(name, own, pd.DataFrame(held), file, lines.comments))
    return tuple(runs)


def _columns(
    lines: Lines, rename: dict[str, str], ignore: frozenset[str], file: Path
) -> tuple[Heading, int | None, list[Heading]]:
    """The time column, the place of the run column, and the sensors."""
    where = f"line {lines.heading_line}: "
    time: Heading | None = None
    run: int | None = None
    found: dict[str, str] = {}
    sensors = []
    for column, text in enumerate(lines.heading):
        name = parts(text)[0]
        if {text, name} & ignore or (not text and not any(row[column] for row in lines.rows)):
            continue
        try:
            if is_time(text):
                if time is not None:
                    raise InputError(f"two time columns, {time.column + 1} and {column + 1}")
                time = Heading(name, time_unit(text), column)
                continue
            if name.lower() == "run":
                if run is not None:
                    raise InputError(f"two run columns, {run + 1} and {column + 1}")
                run = column
                continue
            if not name:
                raise InputError(f"column {column + 1} has readings but no name")
            sensor = rename.get(text, rename.get(name, name))
            if sensor in found:
                raise InputError(f"two columns for sensor '{sensor}': '{found[sensor]}' and '{text}'")
            found[sensor] = text
            sensors.append(Heading(sensor, temperature_unit(text), column))
        except InputError as error:
            raise InputError(where + error.message, file=file) from None
    if time is None:
        raise InputError(f"{where}the time column is ignored; it is needed", file=file)
    if not sensors:
        raise InputError(f"{where}no sensor column beside '{lines.heading[time.column]}'", file=file)
    names = [parts(text)[0] for text in lines.heading if text]
    for name in rename:
        if name not in names and name not in lines.heading:
            raise InputError(f"{where}no column '{name}' to rename{nearest(name, names)}", file=file)
    return time, run, sensors


def _readings(one: Heading, cells: Sequence[str], lines: Lines, file: Path) -> NDArray[np.float64]:
    shown = lines.heading[one.column]
    degC = one.to_degC(numbers(cells, lines.numbers, shown, file, gaps=True))
    if not np.isfinite(degC).any():
        raise InputError(f"column '{shown[:60]}' has no reading in any row", file=file)
    plausible(one, degC, lines.numbers, file)
    return degC


def _rows_of_runs(cells: Sequence[str] | None, lines: Lines, file: Path) -> dict[str, NDArray[np.intp]]:
    """Run -> its rows; a table without a run column is one run, named like the file."""
    if cells is None:
        return {file.stem: np.arange(len(lines.rows))}
    found: dict[str, list[int]] = {}
    for row, (cell, line) in enumerate(zip(cells, lines.numbers, strict=True)):
        if not cell:
            raise InputError(f"line {line}: the run column is empty", file=file)
        found.setdefault(cell, []).append(row)
    return {name: np.array(rows) for name, rows in found.items()}


def _increasing(times: NDArray[np.float64], lines: list[int], name: str, file: Path) -> None:
    for row in np.flatnonzero(np.diff(times) <= 0.0)[:1]:
        same = times[row] == times[row + 1]
        wrong = "the same time" if same else f"time runs back from {times[row]:g} s to {times[row + 1]:g} s"
        at = f", {times[row]:g} s," if same else ""
        raise InputError(
            f"lines {lines[row]} and {lines[row + 1]}: {wrong}{at} in run '{name}'; times must increase",
            file=file,
        )
