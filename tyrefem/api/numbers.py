"""Numbers of the methods: plain numbers in SI units; text with a unit belongs into a file or a change of the study."""

from __future__ import annotations

import math
from collections.abc import Iterable
from contextlib import suppress
from typing import Any

from tyrefem.errors import InputError
from tyrefem.quantity import parse

#: Number -> its unit; of those without one "1".
UNITS = {
    "pressure": "Pa", "load": "N", "deflection": "m", "drum_diameter": "m", "camber": "rad", "speed": "m/s",
    "slip_angle": "rad", "slip": "1", "torque": "N*m", "axle_force": "N", "turn_slip": "1/m", "friction": "1",
    "tolerance": "1", "amplitude": "1", "temperature": "degC",
}  # fmt: skip
#: Lists of numbers -> their unit.
LISTS = {"loads": "N", "slip_angles": "rad", "slips": "1", "cambers": "rad"}
#: Numbers that may be infinite: a flat road.
ENDLESS = ("drum_diameter",)


def check_numbers(**values: Any) -> None:
    """Raise `InputError` for a value that is no finite number, with what was probably meant; None and functions pass.

    >>> check_numbers(load=4e3, pressure=None, loads=[3e3, 4e3])
    """
    for name, value in values.items():
        if value is None or callable(value):
            continue
        if name in LISTS and (isinstance(value, str) or not isinstance(value, Iterable)):
            raise InputError(f"must be a list of numbers in {LISTS[name]}, not {value!r:.60}", field=name)
        several = isinstance(value, Iterable) and not isinstance(value, str)
        for each in value if several else (value,):
            _check(name, LISTS.get(name) or UNITS[name], each)


def _check(name: str, unit: str, value: object) -> None:
    wanted = "a number" if unit == "1" else f"a number in {unit}"
    if isinstance(value, str):
        meant = ""
        with suppress(InputError):
            meant = f"; did you mean {parse(value, unit):g}?"
        raise InputError(f"must be {wanted}, not '{value:.60}'{meant}", field=name)
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        raise InputError(f"must be {wanted}, not {value!r:.60}", field=name) from None
    if math.isnan(number) or (math.isinf(number) and name not in ENDLESS):
        raise InputError(f"must be finite, not {number:g}", field=name)
