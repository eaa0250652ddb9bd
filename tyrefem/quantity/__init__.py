"""Units at the boundary: ``"4 kN"`` becomes ``4000.0`` once, when a person's file or argument is read.

Inside the package every number is an SI float; temperatures are degC and temperature differences kelvin.
"""

from __future__ import annotations

import copy
import functools
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.errors import InputError
from tyrefem.quantity.factors import FACTORS, TEMPERATURES
from tyrefem.quantity.factors import KELVIN as KELVIN

if TYPE_CHECKING:
    import pint
    from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
    from pydantic_core import CoreSchema

_NUMBER = re.compile(r"^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*$", re.DOTALL)
#: Names joined by * / and small powers only: pint would compute 9**9**9 without end.
_UNIT = re.compile(
    r"(?:1\s*/)?(?:[^\W\d][\w°%]*+|[°%][^\W\d]*+|[()\s/·]|\*(?!\*)|[⁻⁰¹²³⁴]+"
    r"|(?:\*\*|\^)\s*\(?\s*-?\d(?:\.\d+)?\s*\)?(?!\d|\s*(?:\*\*|\^)))+"
)
#: Units of angles, which pint counts as numbers: 1 turn is 2 pi.
_ANGLE = re.compile(r"radian|degree(?!_)|turn|revolution|arcminute|arcsecond|grade")
_EXAMPLES = {
    "m": "'0.6 in' or '15 mm'",
    "m/s": "'20 mph' or '9 m/s'",
    "N": "'2700 lbf' or '12 kN'",
    "N/m": "'200 N/mm'",
    "Pa": "'83 psi' or '5.7 bar'",
    "s": "'600 s' or '10 min'",
    "degC": "'25 degC', '77 degF' or '298 K'",
    "delta_degC": "'0.5 delta_degC' or '0.5 K'",
    "1": "'0.2' or '20 %'",
    "rad": "'35 deg'",
}


@functools.cache
def registry() -> pint.UnitRegistry[Any]:
    """The only pint registry, with pint's disk cache if that can be written."""
    import pint

    try:
        return pint.UnitRegistry(cache_folder=":auto:", autoconvert_offset_to_baseunit=False)
    except OSError:
        return pint.UnitRegistry(autoconvert_offset_to_baseunit=False)


def parse(value: object, unit: str) -> float:
    """The SI value (in ``unit``) of a quantity written by a person.

    Parameters
    ----------
    value : text such as ``"20 mph"``, a pint quantity, or a number without unit if ``unit`` is ``"1"``.
    unit : target unit; ``"degC"`` for a temperature, ``"delta_degC"`` for a difference of temperatures.

    Raises
    ------
    InputError : no unit, an unknown or wrong unit, not a finite number.

    >>> round(parse("20 mph", "m/s"), 4)
    8.9408
    >>> parse("77 degF", "degC")
    25.0
    >>> parse("5 K", "delta_degC")
    5.0
    """
    return _parse_text(value, unit) if isinstance(value, str) else _parse(value, unit)


@functools.lru_cache(maxsize=4096)
def _parse_text(value: str, unit: str) -> float:
    """`_parse` of a text, with a cache: variants of a study parse the same text many times."""
    return _parse(value, unit)


def _parse(value: object, unit: str) -> float:
    wanted = f"a quantity like {_EXAMPLES[unit]}" if unit in _EXAMPLES else f"a quantity in {unit}"
    magnitude, text = _split(value, wanted)
    if not math.isfinite(magnitude):
        raise InputError(f"{value!r:.80} is not a finite number; expected {wanted}")
    if not text:
        if unit != "1":
            raise InputError(f"{value!r:.80} has no unit; expected {wanted}")
        return magnitude
    usual = _usual(magnitude, text, unit)
    result = _convert(magnitude, text, unit, value, wanted) if usual is None else usual
    if not math.isfinite(result):
        raise InputError(f"{value!r:.80} is too large to be a number; expected {wanted}")
    if unit == "degC":
        if result < -KELVIN - 1e-9:
            raise InputError(f"{value!r:.80} is below absolute zero")
        return round(result, 10)
    return result


def amount_parts(value: object) -> tuple[str, str] | None:
    """Number and unit of a written quantity, as they are written; None for what is no such text.

    >>> amount_parts(" 20 mph"), amount_parts("2"), amount_parts("soft")
    (('20', 'mph'), ('2', ''), None)
    """
    match = _NUMBER.match(value) if isinstance(value, str) else None
    return None if match is None else (match[1], match[2])


def _usual(magnitude: float, text: str, unit: str) -> float | None:
    """The value of a quantity in a usual unit, without pint; None: another unit."""
    if unit == "degC":
        factor, offset = TEMPERATURES.get(text, (None, 0.0))
    else:
        factor, offset = FACTORS.get(unit, {}).get(text), 0.0
    if factor is None:
        return None
    return offset + factor * magnitude


def _split(value: object, wanted: str) -> tuple[float, str]:
    if isinstance(value, bool) or value is None:
        raise InputError(f"{value!r:.80} is not {wanted}")
    if isinstance(value, int | float):
        try:
            return float(value), ""
        except OverflowError:
            raise InputError(f"{str(value)[:20]}... is too large to be a number; expected {wanted}") from None
    if hasattr(value, "magnitude") and hasattr(value, "units"):
        return float(value.magnitude), str(value.units)
    amount = amount_parts(value)
    if amount is None:
        raise InputError(f"{value!r:.80} is not {wanted}")
    return float(amount[0]), amount[1]


def written(value: Any) -> Any:
    """A value as written in a file: pint quantities and paths as text, numpy's numbers as Python's; tables and lists
    copied.

    >>> written({"speed": registry().Quantity(25, "mph"), "at": [registry().Quantity(2.5, "mm")]})
    {'speed': '25 mph', 'at': ['2.5 mm']}
    """
    if type(value) in (str, float, int, bool):
        return value
    if isinstance(value, Mapping):
        return {key: written(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [written(entry) for entry in value]
    if hasattr(value, "magnitude") and hasattr(value, "units"):
        return _with_unit(written(value.magnitude), _unit_text(value.units))
    if hasattr(value, "tolist"):
        return written(value.tolist())
    if isinstance(value, Path):
        return str(value)
    try:
        return copy.deepcopy(value)
    except TypeError:  # a generator: who reads the value refuses it by its name
        return value


def _with_unit(number: Any, unit: str) -> Any:
    if isinstance(number, list):
        return [_with_unit(entry, unit) for entry in number]
    return f"{float(number)!r}".removesuffix(".0") + f" {unit}" if unit else number


def _unit_text(units: Any) -> str:
    """Text of a pint unit for a file: its symbol if that is ASCII and parses to the same unit, else its name."""
    name, symbol = f"{units:D}", f"{units:~D}"
    if name == "dimensionless":
        return ""
    try:
        if symbol.isascii() and _pint_name(symbol) == _pint_name(name):
            return symbol
    except Exception:  # pint raises many kinds; the reader of the value reports a wrong unit
        return name
    return name.replace("degree_Celsius", "degC").replace("degree_Fahrenheit", "degF")


def _convert(magnitude: float, text: str, unit: str, value: object, wanted: str) -> float:
    if len(text) > 60:
        raise InputError(f"{text[:60]!r}... is not a unit; expected {wanted}")
    if re.match(r",\d", text):
        raise InputError(f"{value!r:.80} has a comma; numbers have a decimal point; expected {wanted}")
    if text.count("%") > 1 or not _UNIT.fullmatch(text) or re.search(r"\)\s*(?:\*\*|\^)", text):
        raise InputError(f"'{text}' in {value!r:.80} is not a unit; expected {wanted}")
    try:
        given = _pint_name(text)
    except Exception as error:  # pint raises many kinds for text that is not a unit
        raise InputError(f"unknown unit '{text}' in {value!r:.80}; expected {wanted}") from error
    if unit == "delta_degC" and given in ("degree_Celsius", "degree_Fahrenheit"):
        difference = "delta_degC" if "Celsius" in given else "delta_degF"
        raise InputError(
            f"{value!r:.80} is a temperature, but a difference of temperatures is wanted: write '{difference}'"
        )
    if unit == "degC" and "delta" in given:
        raise InputError(f"{value!r:.80} is a difference of temperatures, but a temperature is wanted: 'degC'")
    try:
        converted = _converted(magnitude, text, unit)
    except Exception as error:  # dimensionality or offset units: the same advice to the user
        weight = _weight(magnitude, text) if unit == "N" else ""
        raise InputError(
            f"'{text}' is not a unit of this quantity ({value!r:.80}){weight}; expected {wanted}"
        ) from error
    _check_angle(given, unit, value, wanted)
    return converted


def _weight(magnitude: float, text: str) -> str:
    """What a mass weighs, as part of a message; empty for other quantities."""
    try:
        force = _converted(magnitude, text, "kg") * _converted(1.0, "kgf", "N")
    except Exception:  # as in `_convert`: another quantity
        return ""
    return f", but a mass: its weight is '{force / 1e3:.5g} kN'"


def _check_angle(given: str, unit: str, value: object, wanted: str) -> None:
    """Refuse what pint takes for the same because an angle has no dimension."""
    angle = _ANGLE.search(given) is not None
    if unit == "Hz" and angle:
        raise InputError(f"{value!r:.80} is an angle per time, but cycles per time are wanted: 1 Hz is 2 pi rad/s")
    if unit == "1" and angle:
        raise InputError(f"{value!r:.80} is an angle, but a number is wanted: {wanted}")
    if unit == "rad" and not angle:
        raise InputError(f"{value!r:.80} is a number, but an angle is wanted: {wanted}")


@functools.lru_cache(maxsize=512)
def _pint_name(text: str) -> str:
    """pint's name of a unit; raises pint's errors."""
    return str(registry().parse_units(text))


def _converted(magnitude: float, text: str, unit: str) -> float:
    """Conversion with cached factors: every variant of a study is read with mostly the same units."""
    factor = _factor(text, unit)
    return _convert_with_pint(magnitude, text, unit) if factor is None else magnitude * factor


@functools.lru_cache(maxsize=512)
def _factor(text: str, unit: str) -> float | None:
    """pint's conversion factor; None for a unit with an offset."""
    return None if _convert_with_pint(0.0, text, unit) != 0.0 else _convert_with_pint(1.0, text, unit)


def _convert_with_pint(magnitude: float, text: str, unit: str) -> float:
    units = registry()
    target = "dimensionless" if unit == "1" else unit
    return float(units.Quantity(magnitude, units.parse_units(text)).to(target).magnitude)


def convert(value: float, unit: str, to: str) -> float:
    """An SI number in another unit, for output to a person.

    >>> round(convert(0.0254, "m", "in"), 6)
    1.0
    """
    units = registry()
    return float(units.Quantity(value, unit).to(to).magnitude)


@dataclass(frozen=True)
class Unit:
    """Annotation of a card's field: input is text with a unit, the value an SI float within bounds.

    ``Annotated[float, Unit("m", gt=0)]`` accepts ``"0.6 in"`` and holds ``0.01524``.
    """

    unit: str
    gt: float | None = None
    ge: float | None = None
    lt: float | None = None
    le: float | None = None

    def __call__(self, value: object) -> float:
        number = parse(value, self.unit)
        shown = "" if self.unit == "1" else f" {self.unit}"
        for bound, holds, words in (
            (self.gt, self.gt is None or number > self.gt, "more than"),
            (self.ge, self.ge is None or number >= self.ge, "at least"),
            (self.lt, self.lt is None or number < self.lt, "less than"),
            (self.le, self.le is None or number <= self.le, "at most"),
        ):
            if not holds:
                raise InputError(f"{value!r:.80} is out of range: must be {words} {bound:g}{shown}")
        return number

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        from pydantic_core import core_schema

        return core_schema.no_info_plain_validator_function(self)

    def schema(self) -> dict[str, Any]:
        """JSON schema of the text in a file."""
        from tyrefem.quantity.pattern import quantity_schema

        return quantity_schema(self.unit, {"gt": self.gt, "ge": self.ge, "lt": self.lt, "le": self.le})

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return self.schema()


@dataclass(frozen=True)
class Ramp:
    """A quantity that changes from ``start`` to ``end``, linear in time. SI.

    >>> Ramp(0.0, 10.0).at(0.25)
    2.5
    """

    start: float
    end: float

    @property
    def constant(self) -> bool:
        """True if start and end are equal."""
        return self.start == self.end

    def at(self, fraction: float) -> float:
        """The value at a fraction of the ramp's time."""
        return self.start + (self.end - self.start) * fraction
