"""A column's heading: name and unit. ``shoulder inner [degF]`` is the sensor "shoulder inner", in degF.

A unit stands in brackets, or without them where it can be nothing else: ``crown °C``, ``crown_degC``, ``Time/s``.
"""

from __future__ import annotations

import functools
import re

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
#: Names of a time column; where no column has such a name, those of the second list.
_TIME = r"(?:elapsed[ _]?)?(?:time|t)|time[ _]?stamp|date[ _/]?time"
_TIME_IN_OTHER_WORDS = r"elapsed|zeit|uhrzeit|zeitstempel|temps|tiempo|tempo"
_DATE = r"date|datum|fecha"

#: Quantities that loggers write beside temperatures, by their SI unit. Angles are not included: "deg" may be degC.
_CHANNELS = ("Pa", "m/s", "N", "m", "kg", "s", "Hz", "rad/s", "W", "J", "m/s**2")
#: Units without dimension: per cent, and record numbers of a TOA5 table.
_COUNTS = ("%", "RN")

_BRACKETS = re.compile(r"^(?P<name>.*?)\s*(?:\[(?P<square>[^][]*)\]|\((?P<round>[^()]*)\))$", re.DOTALL)
# The degree sign, similar characters, and its form after a wrong decoding.
_TEMPERATURE = re.compile(r"^(?:deg(?:rees?|\.)?[\s_]*|[°º˚Â�'*]*\s*)(\w+)$", re.IGNORECASE)
# Only units with a degree sign or as words: the C of "probe C" may be a letter.
_BARE_TEMPERATURE = re.compile(
    r"^(?P<name>.*?[^\s_/,])(?:[\s_/,]*(?P<sign>Â?[°º˚�]\s*[CFK])"
    r"|[\s_/,]+(?P<word>deg(?:rees?|\.)?[\s_]*(?:C|F|K|celsius|fahrenheit|kelvin)|celsius|fahrenheit|kelvin))$",
    re.IGNORECASE,
)
# "time min" may be a least time: without a slash or comma, minutes need brackets.
_BARE_TIME = re.compile(
    rf"^(?P<name>{_TIME}|{_TIME_IN_OTHER_WORDS})(?:\s*[/,]\s*(?P<after>{'|'.join(_SPELLINGS)})"
    rf"|[\s_]+(?P<blank>{'|'.join(unit for unit in _SPELLINGS if not unit.startswith('min'))}))$",
    re.IGNORECASE,
)


def parts(text: str) -> tuple[str, str | None]:
    """Name and unit (None without one) of a heading.

    >>> parts("crown [°C]"), parts("crown"), parts("crown °C"), parts("Time/s")
    (('crown', '°C'), ('crown', None), ('crown', '°C'), ('Time', 's'))
    """
    name, unit = in_brackets(text)
    bare = None if unit is not None else _BARE_TIME.match(name) or _BARE_TEMPERATURE.match(name)
    return (name, unit) if bare is None else (bare[1], bare[2] or bare[3])


def in_brackets(text: str) -> tuple[str, str | None]:
    """Name and unit of a heading whose unit stands in brackets, round or square.

    >>> in_brackets("crown [°C]"), in_brackets("crown_degC")
    (('crown', '°C'), ('crown_degC', None))
    """
    match = _BRACKETS.match(text.strip())
    if match is None:
        return text.strip(), None
    unit = match["square"] if match["square"] is not None else match["round"]
    return match["name"].strip(), unit.strip()


@functools.lru_cache(maxsize=256)
def is_channel(text: str) -> bool:
    """True if a heading's unit is one of pressure, speed, force, length, power...: the column is no temperature sensor.

    >>> [is_channel(text) for text in ("air [kPa]", "speed [km/h]", "load (lbf)", "crown [degC]", "crown [mV]")]
    [True, True, True, False, False]
    """
    unit = parts(text)[1]
    if not unit or is_temperature(unit):
        return False
    if unit in _COUNTS:
        return True
    for quantity in _CHANNELS:
        try:
            parse(f"1 {unit}", quantity)
        except InputError:
            continue
        return True
    return False


def is_time(text: str, *, in_other_words: bool = False) -> bool:
    """True for the heading of a time column: ``time [s]``, ``Time (min)``, ``t [h]``, but not ``T [degC]``.

    ``in_other_words``: for ``Zeit [s]``, ``temps [s]``, ``elapsed [s]`` instead, if no column is called time.
    """
    name, unit = parts(text)
    names = _TIME_IN_OTHER_WORDS if in_other_words else _TIME
    return re.fullmatch(names, name, re.IGNORECASE) is not None and not is_temperature(unit or "")


def is_date(text: str) -> bool:
    """True for the heading of a column of dates, beside one of clock times."""
    name, unit = parts(text)
    return re.fullmatch(_DATE, name, re.IGNORECASE) is not None and not is_temperature(unit or "")


def is_elapsed(text: str) -> bool:
    """True for a time column whose times count from the start by their name."""
    return parts(text)[0].lower().startswith("elapsed")


def is_temperature(unit: str) -> bool:
    """Whether a unit is one of temperature."""
    return _temperature(unit) is not None


def is_time_unit(unit: str) -> bool:
    """Whether a unit is one of time."""
    return unit.lower() in _SPELLINGS


def _temperature(unit: str) -> str | None:
    """degC, degF or K for a unit of temperature, else None."""
    match = _TEMPERATURE.match(unit)
    return _LETTERS.get(match[1].lower()) if match else None


def time_unit(text: str) -> str:
    """The unit of a time column, a key of `TIME_UNITS`.

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
    if unit.lower() == "m":
        raise InputError(f"time unit '{unit}': write 'min' for minutes; allowed: {', '.join(TIME_UNITS)}")
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
