"""What a column's heading says: ``shoulder inner [degF]`` is the sensor "shoulder inner", in degF."""

from __future__ import annotations

import functools
import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError, nearest
from tyrefem.quantity import parse

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
_TIME = re.compile(r"^(?:(?:elapsed[ _]?)?(?:time|t)|time[ _]?stamp|date[ _/]?time)$", re.IGNORECASE)
#: Quantities that loggers write beside temperatures, by their SI unit. No angle: "deg" may stand for degC.
_CHANNELS = ("Pa", "m/s", "N", "m", "kg", "s", "Hz", "W", "J", "m/s**2")
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


@functools.lru_cache(maxsize=256)
def is_channel(text: str) -> bool:
    """Whether a heading's unit is that of a pressure, speed, force, length, power...: no sensor of temperature.

    >>> [is_channel(text) for text in ("air [kPa]", "speed [km/h]", "load (lbf)", "crown [degC]", "crown [mV]")]
    [True, True, True, False, False]
    """
    unit = parts(text)[1]
    if not unit or _temperature(unit) is not None:
        return False
    if unit == "%":
        return True
    for quantity in _CHANNELS:
        try:
            parse(f"1 {unit}", quantity)
        except InputError:
            continue
        return True
    return False


def is_time(text: str) -> bool:
    """Whether a heading is the time column: ``time [s]``, ``Time (min)``, ``t [h]``, but not ``T [degC]``."""
    name, unit = parts(text)
    return bool(_TIME.match(name)) and _temperature(unit or "") is None


def _temperature(unit: str) -> str | None:
    """degC, degF or K, if that is what a unit says."""
    match = _TEMPERATURE.match(unit)
    return _LETTERS.get(match[1].lower()) if match else None


def time_unit(text: str) -> str:
    """The unit of the time column.

    Raises
    ------
    InputError : no unit, or one that is not a time.
    """
    unit = parts(text)[1]
    if not unit:
        raise InputError(
            f"'{text}' has no unit; write 'time [s]' (or [min], [h], [ms]), or timestamps like 2024-05-01T12:30:01"
        )
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
    known = _temperature(unit)
    if known is None:
        hint = nearest(unit, TEMPERATURE_UNITS)
        raise InputError(f"unknown temperature unit '{unit[:30]}'{hint} (column '{text[:60]}')")
    return known
