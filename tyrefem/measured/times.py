"""Times of a table's rows, s: numbers in a unit, timestamps, dates with clock times, or h:mm:ss."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.measured.clock import (
    FORMS,
    clock_times,
    form_of_unit,
    has_three_numbers,
    in_24_hours,
    may_be_clock,
    over_midnight,
)
from tyrefem.measured.columns import is_number, numbers
from tyrefem.measured.heading import TIME_UNITS, is_date, is_elapsed, is_time, parts, time_unit
from tyrefem.measured.lines import Lines
from tyrefem.measured.timestamps import (
    DAY_FIRST,
    MONTH_FIRST,
    are_timestamps,
    is_day_first,
    is_slashed,
    microseconds,
    stamped,
)

#: s; 30 years. A larger time is a calendar time and needs ``time_offset``.
LONGEST_TIME = 1e9
#: s.
HOUR = 3600.0
#: "Unit" of a time column that holds timestamps, alone or with a column of dates.
STAMPED = "ISO 8601"


@dataclass(frozen=True)
class TimeColumn:
    """The column of times.

    Parameters
    ----------
    heading : its name, with its unit. column : its index. date : index of the column of dates that goes with it.
    unit : a key of `TIME_UNITS`, `STAMPED`, or a form of clock times (a key of `clock.FORMS`).
    """

    heading: str
    column: int
    unit: str
    date: int | None = None

    @classmethod
    def of(cls, headings: Mapping[int, str], rows: Sequence[Sequence[str]]) -> TimeColumn | None:
        """The time column among columns, index -> heading; None without one.

        Raises
        ------
        InputError : two of them; no unit, an unknown one, or times of another form.
        """
        columns = [column for column, text in headings.items() if is_time(text)]
        columns = columns or [column for column, text in headings.items() if is_time(text, in_other_words=True)]
        if not columns:
            return None
        if len(columns) > 1:
            raise InputError(f"two time columns, {columns[0] + 1} and {columns[1] + 1}; ignore one of them")
        (column,) = columns
        text = headings[column]
        unit, cells = parts(text)[1], [in_24_hours(row[column]) for row in rows[:100]]
        first = next(filter(None, cells), "")
        if are_timestamps(cells):
            return cls(text, column, STAMPED)
        form = form_of_unit(unit or "")
        if form == "h:mm" and has_three_numbers(first):
            # Cells of a workbook have the seconds that their format hides.
            form = "h:mm:ss"
        dates = [other for other, heading in headings.items() if is_date(heading)]
        # Two numbers beside a date may still be minutes and seconds since a start.
        has_clock = form == "h:mm" or (has_three_numbers(first) and (form == "h:mm:ss" or not unit))
        if len(dates) == 1 and has_clock and not is_elapsed(text):
            return cls(text, column, STAMPED, dates[0])
        return cls(text, column, form or _unit(text, unit, first))

    def of_runs(
        self, lines: Lines, runs: Mapping[str, NDArray[np.intp]], offset: float, file: Path
    ) -> tuple[dict[str, NDArray[np.float64]], tuple[str, ...]]:
        """Run -> its times, s, with ``offset`` added, and notes on how they were read; ``runs``: run -> its rows.

        Timestamps and clock times count from the first row of their run; numbers and elapsed time count as they are.

        Raises
        ------
        InputError : errors of `numbers`, `clock_times` and `microseconds`; times that repeat, fall back or lie beyond
            `LONGEST_TIME`.
        """
        cells = [row[self.column] for row in lines.rows]
        if self.unit in TIME_UNITS:
            seconds = numbers(cells, lines.numbers, self.heading, file, gaps=False) * TIME_UNITS[self.unit] + offset
            _check_longest(seconds, self.heading, file)
            times, notes = {name: seconds[rows] for name, rows in runs.items()}, self._notes(lines)
        else:
            times, notes = self._counted([in_24_hours(cell) for cell in cells], lines, runs, file)
            times = {name: values + offset for name, values in times.items()}
        for name, values in times.items():
            _check_increasing(values, [lines.numbers[row] for row in runs[name]], name, file, self.unit)
            if self.unit == STAMPED:
                notes += _put_forward(values, [lines.numbers[row] for row in runs[name]])
        return times, notes

    def _counted(
        self, cells: list[str], lines: Lines, runs: Mapping[str, NDArray[np.intp]], file: Path
    ) -> tuple[dict[str, NDArray[np.float64]], tuple[str, ...]]:
        """Run -> s since its first row, or since the start for elapsed time; and notes."""
        notes = list(self._notes(lines))
        if self.unit != STAMPED:
            counts = clock_times(cells, lines.numbers, self.heading, self.unit, file)
        else:
            if self.date is not None:
                cells = [stamped(row[self.date], cell) for row, cell in zip(lines.rows, cells, strict=True)]
            counts, order = self._of_stamps(cells, lines, runs, file)
            notes += order
        has_day = self.unit in ("h:mm:ss", "h:mm") and not is_elapsed(self.heading)
        times = {}
        for name, rows in runs.items():
            of_run = over_midnight(counts[rows]) if has_day else counts[rows]
            if has_day and of_run[-1] != counts[rows][-1]:
                notes.append(f"run '{name}' passes midnight")
            start = 0 if self._is_elapsed_clock else of_run[0]
            times[name] = (of_run - start) / 1e6
        return times, tuple(notes)

    def _of_stamps(
        self, stamps: list[str], lines: Lines, runs: Mapping[str, NDArray[np.intp]], file: Path
    ) -> tuple[NDArray[np.int64], tuple[str, ...]]:
        """(n,) microseconds since the first timestamp; and a note if slashed dates can have only one order."""
        where = lines.numbers, self._headings(lines), file
        slashed = next(filter(is_slashed, stamps), None)
        if slashed is None:
            return microseconds(stamps, *where), ()
        orders = {}
        for order in (MONTH_FIRST, DAY_FIRST):
            with suppress(InputError):
                orders[order] = microseconds(stamps, *where, order)
        if not orders:
            return microseconds(stamps, *where), ()
        counts, *others = orders.values()
        if not others:
            return counts, (f"dates are {next(iter(orders))}",)
        if any((np.diff(counts[rows]) != np.diff(others[0][rows])).any() for rows in runs.values()):
            raise InputError(
                f"column '{where[1][:60]}': the date in {slashed[:40]!r} may be {MONTH_FIRST} or {DAY_FIRST}; write "
                "dates like 2024-05-01",
                file=file,
            )
        return counts, ()

    @property
    def _is_elapsed_clock(self) -> bool:
        return self.unit in FORMS and is_elapsed(self.heading)

    def _headings(self, lines: Lines) -> str:
        """The headings of date and time, for messages."""
        return self.heading if self.date is None else f"{lines.heading[self.date]} {self.heading}"

    def _notes(self, lines: Lines) -> tuple[str, ...]:
        """How times that are no plain numbers or timestamps are read."""
        first = lines.rows[0][self.column]
        named = f"'{self.heading}'"
        notes = []
        if self._is_elapsed_clock:
            notes.append(f"times in {named} are {self.unit} since the start")
        elif self.unit in FORMS:
            notes.append(f"times in {named} are {self.unit}, counted from the first row of the run ({first})")
        elif self.date is not None:
            notes.append(
                f"times are those of '{lines.heading[self.date]}' and {named}, counted from the run's first row"
            )
        elif not is_time(self.heading):
            notes.append(f"times are those of {named}")
        if self.unit == STAMPED and is_day_first(lines.rows[0][self.column if self.date is None else self.date]):
            notes.append("dates are day.month.year")
        return tuple(notes)


def _unit(text: str, unit: str | None, first: str) -> str:
    """The unit of a time column without timestamps, whose first cell is ``first``.

    Raises
    ------
    InputError : no unit, an unknown one, or a first cell of another form.
    """
    if not unit and has_three_numbers(first):
        return "h:mm:ss"
    if not unit and may_be_clock(first):
        raise InputError(
            f"'{text}' begins with {first[:40]!r}, which may be h:mm or mm:ss; say which in the heading: "
            f"'{text[:40]} [mm:ss]', by hand or with rename"
        )
    if not unit and first and not is_number(first):
        raise InputError(
            f"'{text}' begins with {first[:40]!r}, which is no timestamp like 2024-05-01T12:30:01 (date and time in "
            "one column) and no time like 12:30:01; write all times so, or as numbers with a unit: 'time [s]'"
        )
    return time_unit(text)


def _check_longest(times: NDArray[np.float64], column: str, file: Path) -> None:
    if np.abs(times).max() > LONGEST_TIME:
        raise InputError(
            f"column '{column}': {times[np.abs(times).argmax()]:g} s is no time since a start; "
            "give time_offset if the table holds calendar times",
            file=file,
        )


def _put_forward(times: NDArray[np.float64], lines: list[int]) -> tuple[str, ...]:
    """A note where timestamps step by an hour more than usual: local time, put forward to summer time there?"""
    steps = np.diff(times)
    usual = float(np.median(steps)) if len(steps) > 2 else HOUR
    rows = np.flatnonzero((usual < HOUR / 4) & (np.abs(steps - HOUR - usual) <= usual / 2))
    return tuple(
        f"lines {lines[row]} and {lines[row + 1]} are an hour and {steps[row] - HOUR:g} s apart, where {usual:g} s are "
        "usual: if the clock was put forward there (summer time), take an hour off the later times"
        for row in rows
    )


def _check_increasing(times: NDArray[np.float64], lines: list[int], name: str, file: Path, unit: str) -> None:
    for row in np.flatnonzero(np.diff(times) <= 0.0)[:1]:
        same = times[row] == times[row + 1]
        wrong = "the same time" if same else f"time runs back from {times[row]:g} s to {times[row + 1]:g} s"
        at = f", {times[row]:g} s," if same else ""
        hint = ""
        if unit in FORMS and not same:
            hint = " (over midnight, give the dates, too)"
        elif unit == STAMPED and HOUR / 2 <= times[row] - times[row + 1] <= HOUR:
            hint = " (if the clock was put back there from summer time, add an hour to the later times)"
        raise InputError(
            f"lines {lines[row]} and {lines[row + 1]}: {wrong}{at} in run '{name}'; times must increase{hint}",
            file=file,
        )
