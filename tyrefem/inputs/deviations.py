"""Standard deviations as written in ``[uncertainty]``: a share of the number, or a quantity like the number."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema

from tyrefem.errors import InputError
from tyrefem.quantity import KELVIN, Unit, amount_parts, parse

SHARE = Unit("1", gt=0, lt=1)
_SCALES = re.compile(r"deg[CF]|degree_(Celsius|Fahrenheit)|celsius|fahrenheit|°\s?[CF]")


@dataclass(frozen=True)
class Deviation:
    """Annotation of a standard deviation: a share like ``"2 %"``, kept as a number, or text like ``"200 N"``."""

    def __call__(self, value: object) -> float | str:
        try:
            return SHARE(value)
        except InputError:
            if not isinstance(value, str):
                raise
            _, unit = amount_parts(value) or ("", "")
            if not unit or "%" in unit:
                raise
            return value

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        from pydantic_core import core_schema

        return core_schema.no_info_plain_validator_function(self)

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return {"anyOf": [SHARE.schema(), {"type": "string", "description": "a quantity in the number's unit"}]}


def has_arbitrary_zero(unit: str) -> bool:
    """Whether a unit is a scale of temperatures on which a share means nothing.

    >>> has_arbitrary_zero("degC"), has_arbitrary_zero("K")
    (True, False)
    """
    return bool(_SCALES.fullmatch(unit.strip()))


def share_of(written: Any, stated: float | str) -> tuple[float, Any]:
    """A deviation as a share of a written number, and the number whose share it is: a temperature in K.

    Raises
    ------
    InputError : a quantity for a table or a number without unit; another unit; not between 0 and the number.

    >>> share_of("2 kN", "100 N"), share_of("2 kN", 0.05)
    ((0.05, '2 kN'), (0.05, '2 kN'))
    >>> share_of("25 degC", "2 K")[1]
    '298.15 K'
    """
    if not isinstance(stated, str):
        return stated, written
    amount, unit = amount_parts(written) or ("", "")
    if not unit:
        what = "a table" if isinstance(written, list | Mapping) else f"{written!r}"
        raise InputError(f"is {what}: its standard deviation is a share, for example '2 %', not {stated!r}")
    if has_arbitrary_zero(unit):
        number, sd = parse(written, "degC") + KELVIN, parse(stated, "delta_degC")
        written = f"{number:.12g} K"
    else:
        number, sd = abs(float(amount)), parse(stated, "delta_degC" if unit in ("K", "kelvin") else unit)
    if not 0 < sd < number:
        raise InputError(f"{stated!r} is out of range: a standard deviation is between 0 and the number, {written}")
    return sd / number, written
