"""What a column's heading says: ``shoulder inner [degF]`` is the sensor "shoulder inner", in degF."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError, nearest

TIME_UNITS = {"s": 1.0, "ms": 1e-3, "min": 60.0, "h": 3600.0}
TEMPERATURE_UNITS = ("degC", "degF", "K")
_SPELLINGS = {
    **dict.fromkeys(("s", "sec", "secs", "second", "seconds"), "s"),
    **dict.fromkeys(("ms", "msec", "millisecond", "milliseconds"), "ms"),
    **dict.fromkeys(("min", "mins", "minute", "minutes"), "min"),
    **dict.fromkeys(("h", "hr", "hrs", "hour", "hours"), "h"),
}
_LETTERS = {"c": "degC", "celsius": "degC", "f": "degF", "fahrenheit": "degF", "k": "K", "kelvin": "K"}
_HEADING = re.compile(r"^(?P<name>.*?)\s*(?:\[(?P<square>[^][]*)\]|\((?P<round>[^()]*)\))$", re.DOTALL)
_TIME = re.compile(r"^(?:elapsed[ _]?)?(?:time|t)$", re.IGNORECASE)
# The degree sign in its look-alikes, and as it arrives after a wrong decoding.
_TEMPERATURE = re.compile(r"^(?:deg(?:rees?|\.)?[\s_]*|[°º˚Â�'*]*\s*)(\w+)$", re.IGNORECASE)


@dataclass(frozen=True)
class Heading:
    """A column: its name, its unit, and its place in the row."""

    name: str
    unit: str
    column: int

    def to_degC(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """degC of readings in this column's unit.

        >>> Heading("crown", "degF", 1).to_degC(np.array([212.0])).tolist()
        [100.0]
        """
        if self.unit == "degF":
            return (values - 32.0) / 1.8
        return values - 273.15 if self.unit == "K" else values


def parts(text: str) -> tuple[str, str | None]:
    """Name and unit (None if there are no brackets) of a heading.

    >>> parts("crown [°C]"), parts("crown")
    (('crown', '°C'), ('crown', None))
    """
    match = _HEADING.match(text.strip())
    if match is None:
        return text.strip(), None
    unit = match["square"] if match["square"] is not None else match["round"]
    return match["name"].strip(), unit.strip()


def is_time(text: str) -> bool:
    """Whether a heading is the time column: ``time [s]``, ``Time (min)``, ``t [h]``, but not ``T [degC]``."""
    name, unit = parts(text)
    degree = _TEMPERATURE.match(unit or "")
    return bool(_TIME.match(name)) and not (degree and degree[1].lower() in _LETTERS)


def time_unit(text: str) -> str:
    """The unit of the time column.

    Raises
    ------
    InputError : no unit, or one that is not a time.
    """
    unit = parts(text)[1]
    if not unit:
        raise InputError(f"'{text}' has no unit; write 'time [s]' (or [min], [h], [ms])")
    known = _SPELLINGS.get(unit.lower())
    if known is None:
        raise InputError(f"unknown time unit '{unit[:30]}'{nearest(unit, TIME_UNITS)}")
    return known


def temperature_unit(text: str) -> str:
    """degC, degF or K, in any common spelling.

    Raises
    ------
    InputError : no unit, or one that is not a temperature.

    >>> [temperature_unit(f"crown [{unit}]") for unit in ("°C", "C", "deg F", "k", "Celsius")]
    ['degC', 'degC', 'degF', 'K', 'degC']
    """
    name, unit = parts(text)
    if not unit:
        raise InputError(f"'{text[:60]}' has no unit; write '{name[:40]} [degC]' (or [degF], [K])")
    match = _TEMPERATURE.match(unit)
    known = _LETTERS.get(match[1].lower()) if match else None
    if known is None:
        raise InputError(f"unknown temperature unit '{unit[:30]}'{nearest(unit, TEMPERATURE_UNITS)}")
    return known
