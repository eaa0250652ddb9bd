"""Numbers of the methods: plain numbers in SI units; text with a unit belongs into a file or a change of the study."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from typing import Any

from tyrefem.errors import InputError
from tyrefem.quantity import parse

#: Number -> its unit; of those without one "1".
UNITS = {
    "pressure": "Pa", "load": "N", "deflection": "m", "drum_diameter": "m", "camber": "rad", "speed": "m/s",
    "slip_angle": "rad", "slip": "1", "torque": "N*m", "axle_force": "N", "turn_slip": "1/m", "friction": "1",
    "tolerance": "1", "amplitude": "1", "temperature": "degC", "distance": "m",
}  # fmt: skip
#: Lists of numbers -> their unit.
LISTS = {"loads": "N", "slip_angles": "rad", "slips": "1", "cambers": "rad"}
#: Numbers that may be infinite: a flat road.
ENDLESS = ("drum_diameter",)


#: Numbers that may be functions of the state, and numbers of which a curve takes several.
FUNCTIONS, SEVERAL = ("friction",), ("slip_angle", "slip")


def check_numbers(*, curve: bool = False, **values: Any) -> None:
    """Raise `InputError` for a value that is no finite number, with what was probably meant; None passes.

    ``curve``: a slip angle or a slip may be a list of numbers.

    >>> check_numbers(load=4e3, pressure=None, loads=[3e3, 4e3])
    """
    for name, value in values.items():
        if value is None or (name in FUNCTIONS and callable(value)):
            continue
        if name in LISTS and not _is_list(value):
            raise InputError(f"must be a list of numbers in {LISTS[name]}, not {value!r:.60}", field=name)
        several = _is_list(value) and (name in LISTS or (curve and name in SEVERAL))
        for each in value if several else (value,):
            _check(name, LISTS.get(name) or UNITS[name], each)


def kept(value: Any) -> Any:
    """A value, and the numbers of a generator, which can be read once only, as a tuple.

    >>> kept(each for each in (3e3, 4e3)), kept(None)
    ((3000.0, 4000.0), None)
    """
    return tuple(value) if isinstance(value, Iterator) else value


def _is_list(value: object) -> bool:
    """Whether a value is a sequence of numbers: an array of no dimension, a mapping or a quantity of pint is none."""
    if isinstance(value, str | bytes | Mapping) or hasattr(value, "magnitude"):
        return False
    return isinstance(value, Iterable) and getattr(value, "ndim", 1) == 1


def _check(name: str, unit: str, value: Any) -> None:
    wanted = "a number" if unit == "1" else f"a number in {unit}"
    if isinstance(value, str) or hasattr(value, "magnitude"):
        meant = ""
        with suppress(InputError):
            meant = f"; did you mean {parse(str(value), unit):g}?"
        raise InputError(f"must be {wanted}, not '{value!s:.60}'{meant}", field=name)
    try:
        if isinstance(value, bool | bytes) or getattr(value, "ndim", 0) != 0 or str(value) in ("True", "False"):
            raise TypeError
        number = float(value)
    except (TypeError, ValueError):
        more = "; several numbers make a curve: slip_curve" if name in SEVERAL and _is_list(value) else ""
        raise InputError(f"must be {wanted}, not {value!r:.60}{more}", field=name) from None
    except OverflowError:
        number = math.inf
    if math.isnan(number) or (math.isinf(number) and name not in ENDLESS):
        raise InputError(f"must be finite, not {number:g}", field=name)
