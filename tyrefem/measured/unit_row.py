"""A row of units between heading and readings, as many loggers write it."""

from __future__ import annotations

from collections.abc import Sequence

from tyrefem.errors import InputError
from tyrefem.measured.clock import form_of_unit
from tyrefem.measured.heading import is_channel, is_temperature, is_time_unit, parts


def with_units(heading: Sequence[str], row: Sequence[str], is_time: Sequence[bool]) -> tuple[str, ...] | None:
    """The heading with the units of the row below it; None if that row has readings.

    It has units if a time column's cell is a unit of time, or if all cells are units, one of them of temperature, or
    empty. ``is_time``: of each column, whether it may hold times.

    Raises
    ------
    InputError : a column has one unit in its heading and another one below it.

    >>> with_units(["time", "crown"], ["s", "°C"], [True, False]), with_units(["time"], ["0"], [True])
    (('time [s]', 'crown [°C]'), None)
    """
    units = [_without_brackets(cell) for cell in row]
    known = [unit for unit in units if unit]
    has_time_unit = any(
        of_time and (is_time_unit(unit) or form_of_unit(unit)) for unit, of_time in zip(units, is_time, strict=True)
    )
    if not has_time_unit and not (all(map(_is_unit, known)) and any(map(is_temperature, known))):
        return None
    return tuple(_joined(text, unit) for text, unit in zip(heading, units, strict=True))


def _without_brackets(cell: str) -> str:
    """The unit in a cell; empty where there is none."""
    unit = cell.strip("[](){} ")
    return "" if unit in ("-", "--", "---") else unit


def _is_unit(text: str) -> bool:
    return is_temperature(text) or is_time_unit(text) or form_of_unit(text) is not None or is_channel(f"x [{text}]")


def _joined(text: str, unit: str) -> str:
    """A name with its unit."""
    name, has = parts(text)
    if not unit or unit == has:
        return text
    if has is not None:
        raise InputError(f"column '{text[:60]}' has another unit, {unit[:20]!r}, in a row of units below the heading")
    return f"{name} [{unit}]"
