"""What the columns of a table are: times, runs, sensors, other quantities."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from tyrefem.errors import InputError
from tyrefem.measured.columns import SensorColumn, has_words_only
from tyrefem.measured.heading import is_channel, is_temperature, parts, temperature_unit
from tyrefem.measured.lines import Lines
from tyrefem.measured.names import in_table_words
from tyrefem.measured.times import TimeColumn


def is_ignored(text: str, ignore: frozenset[str]) -> bool:
    """Whether a heading, or its name without unit, is among those to ignore."""
    return bool({text, parts(text)[0]} & ignore)


def is_run(text: str) -> bool:
    """Whether a heading is that of the run column; ``run [degC]`` is a sensor, as ``time [degC]`` is."""
    name, unit = parts(text)
    return name.lower() == "run" and not is_temperature(unit or "")


@dataclass(frozen=True)
class TableColumns:
    """The columns of a table.

    Parameters
    ----------
    time : the time column. run : index of the run column; None without one. sensors : columns of readings.
    channels : headings of other quantities.
    """

    time: TimeColumn
    run: int | None
    sensors: tuple[SensorColumn, ...]
    channels: tuple[str, ...]

    @classmethod
    def of(cls, lines: Lines, rename: dict[str, str], ignore: frozenset[str], file: Path) -> TableColumns:
        """The columns by their headings; ``rename`` and ``ignore``: names by the user.

        Raises
        ------
        InputError : no time column or no sensor, two columns for the same thing, a sensor without a name or a unit.
        """
        where = f"line {lines.heading_line}: "
        try:
            named = {
                column: in_table_words(text, rename)
                for column, text in enumerate(lines.heading)
                if not is_ignored(text, ignore) and (text or any(row[column] for row in lines.rows))
            }
            time = TimeColumn.of(named, lines.rows)
        except InputError as error:
            raise InputError(where + error.message, field=error.field, file=file) from None
        run: int | None = None
        sensors: dict[str, SensorColumn] = {}
        channels, without_unit, wrong = [], [], []
        for column in named:
            text = lines.heading[column]
            name = parts(text)[0]
            if time is not None and column in (time.column, time.date):
                continue
            try:
                if is_run(named[column]):
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
                    first = sensors[sensor].heading
                    raise InputError(f"two columns for sensor '{sensor}': '{first}' and '{text}'")
            except InputError as error:
                raise InputError(where + error.message, file=file) from None
            try:
                if not parts(text)[1]:
                    if has_words_only([row[column] for row in lines.rows]):
                        wrong.append(f"'{text[:60]}' has words; if they name the runs, it needs `rename` to run")
                        continue
                    without_unit.append(text)
                sensors[sensor] = SensorColumn(sensor, temperature_unit(text), column, text)
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
        return cls(time, run, tuple(sensors.values()), tuple(channels))
