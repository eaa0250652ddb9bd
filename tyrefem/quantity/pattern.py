"""What a quantity may look like in a file, as a regular expression for editors: a number and a unit of its kind.

`tyrefem.quantity.parse` reads every unit that pint knows; the expressions hold those in use, in any order of factors.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Mapping
from typing import Any

#: Kind of quantity -> units with one name.
NAMES = {
    "length": "m km dm cm mm um µm micrometer nm meter metre millimeter millimetre centimeter "
    "inch inches in ft foot feet thou yd yard mi mile miles",
    "time": "s ms us µs second seconds min minute minutes h hr hour hours day days",
    "mass": "kg g mg t tonne lb lbs pound oz slug kilogram gram",
    "force": "N kN MN mN daN newton lbf kip kgf",
    "pressure": "Pa hPa kPa MPa GPa bar mbar psi ksi atm pascal torr",
    "energy": "J mJ kJ MJ GJ joule cal kcal Wh kWh BTU Btu",
    "power": "W mW kW MW watt hp",
    "temperature": "degC degF °C °F K kelvin celsius degree_Celsius degree_Fahrenheit",
    "difference": "K kelvin mK delta_degC delta_degF",
    "degree": "K kelvin delta_degC delta_degF degC degF °C °F",
    "angle": "deg rad mrad degree degrees radian radians ° arcmin",
    "speed": "mph kph knot knots kt",
    "volume": "l L liter litre ml gal cc",
    "frequency": "Hz kHz MHz mHz GHz hertz",
    "ratio": "% percent ppm",
}
#: Unit of a card -> its forms: (kinds above the line, kinds below), a kind with its power.
FORMS: dict[str, list[tuple[str, str]]] = {
    "m": [("length", "")],
    "s": [("time", "")],
    "kg": [("mass", "")],
    "N": [("force", "")],
    "W": [("power", ""), ("energy", "time")],
    "degC": [("temperature", "")],
    "delta_degC": [("difference", "")],
    "rad": [("angle", "")],
    "Hz": [("frequency", ""), ("1", "time")],
    "Pa": [("pressure", ""), ("force", "length2")],
    "Pa/s": [("pressure", "time")],
    "m/s": [("speed", ""), ("length", "time")],
    "N*m": [("force length", ""), ("energy", "")],
    "N/m": [("force", "length")],
    "m**2": [("length2", "")],
    "m**3": [("length3", ""), ("volume", "")],
    "1/m": [("1", "length")],
    "1/delta_degC": [("1", "degree")],
    "delta_degC/s": [("degree", "time")],
    "kg/m**3": [("mass", "length3"), ("mass", "volume")],
    "J/kg/K": [("energy", "mass degree")],
    "J/m**2": [("energy", "length2"), ("force", "length")],
    "J/m**3": [("energy", "length3"), ("energy", "volume"), ("pressure", "")],
    "J/K": [("energy", "degree")],
    "J/m**3/K": [("energy", "length3 degree")],
    "W/K": [("power", "degree"), ("energy", "time degree")],
    "W/m/K": [("power", "length degree"), ("energy", "time length degree")],
    "W/m**2": [("power", "length2"), ("energy", "time length2")],
    "W/m**3": [("power", "length3"), ("energy", "time length3")],
    "W/m**2/K": [("power", "length2 degree"), ("energy", "time length2 degree")],
    "W*s/m**3/K": [("power time", "length3 degree"), ("energy", "length3 degree")],
    "m**2*K/W": [("length2 degree", "power")],
}
#: Unit -> examples of a file.
EXAMPLES: dict[str, tuple[str, ...]] = {
    "1": ("0.2", "20 %"),
    "m": ("15 mm", "0.6 in"),
    "s": ("600 s", "10 min"),
    "kg": ("8 kg", "20 lb"),
    "N": ("4 kN", "2700 lbf"),
    "W": ("500 W", "2 kW"),
    "degC": ("25 degC", "77 degF"),
    "delta_degC": ("0.5 K", "2 delta_degC"),
    "rad": ("35 deg",),
    "Hz": ("10 Hz",),
    "Pa": ("210 kPa", "83 psi"),
    "Pa/s": ("10 Pa/s",),
    "m/s": ("80 km/h", "20 mph"),
    "N*m": ("200 N*m",),
    "N/m": ("200 N/mm", "200 kN/m"),
    "m**2": ("12 mm**2",),
    "m**3": ("0.03 m**3", "30 l"),
    "1/m": ("1100 1/m",),
    "1/delta_degC": ("0.0148 1/delta_degC",),
    "delta_degC/s": ("0.01 delta_degC/s",),
    "kg/m**3": ("1180 kg/m**3", "1.18 g/cm**3"),
    "J/kg/K": ("1650 J/kg/K",),
    "J/m**2": ("10 kJ/m**2",),
    "J/m**3": ("12 kJ/m**3",),
    "J/K": ("5 kJ/K",),
    "J/m**3/K": ("2 MJ/m**3/K",),
    "W/K": ("10 W/K",),
    "W/m/K": ("0.25 W/m/K",),
    "W/m**2": ("500 W/m**2",),
    "W/m**3": ("50 kW/m**3",),
    "W/m**2/K": ("20 W/m**2/K",),
    "W*s/m**3/K": ("1.7 W*s/m**3/K",),
    "m**2*K/W": ("1e-4 m**2*K/W",),
}
NUMBER, SIGNED = r"\+?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?"
_TIMES, _OVER = r"( ?[*·] ?| )", " ?/ ?"
_POWERS = {"2": r" ?(\*\*|\^) ?2|²", "3": r" ?(\*\*|\^) ?3|³"}


def _factor(kind: str) -> str:
    """A factor such as ``length2``: any unit of the kind, with the power."""
    if kind == "1":
        return "1"
    power = kind[-1] if kind[-1] in _POWERS else ""
    names = "|".join(sorted(NAMES[kind.rstrip("23")].split(), key=len, reverse=True))
    return f"({names})" + (f"({_POWERS[power]})" if power else "")


def _orders(kinds: str, between: str) -> list[str]:
    return [between.join(map(_factor, order)) for order in itertools.permutations(kinds.split())]


def _form(above: str, below: str) -> str:
    top = "|".join(_orders(above, _TIMES))
    if not below:
        return f"({top})"
    bottoms = [_OVER + order for order in _orders(below, _OVER)]
    if " " in below:
        bottoms += [rf"{_OVER}\( ?{order} ?\)" for order in _orders(below, _TIMES)]
    return f"({top})({'|'.join(bottoms)})"


@functools.lru_cache(maxsize=128)
def pattern(unit: str, *, signed: bool = True) -> str:
    """The expression of a quantity with a unit of ``unit``'s kind; for ``"1"`` the unit may be missing.

    A unit without forms takes any text behind the number.

    >>> import re
    >>> speed = re.compile(pattern("m/s", signed=False))
    >>> [bool(speed.search(text)) for text in ("80 km/h", "20 mph", "80", "80 kg", "-1 m/s")]
    [True, True, False, False, False]
    """
    number = SIGNED if signed else NUMBER
    if unit == "1":
        return rf"^ *{number} *({'|'.join(NAMES['ratio'].split())})? *$"
    if unit not in FORMS:
        return rf"^ *{number} *\S.*$"
    return rf"^ *{number} *({'|'.join(_form(*form) for form in FORMS[unit])}) *$"


@functools.cache
def pattern_names() -> dict[str, str]:
    """Pattern -> a name of it, such as ``W-per-m2-K``; ``-or-more`` where nothing is negative."""
    names = {}
    for unit in ("1", *FORMS):
        name = "ratio" if unit == "1" else unit.replace("**", "").replace("*", "-")
        first, *below = name.split("/")
        name = f"{first}-per-{'-'.join(below)}" if below else first
        names[pattern(unit)], names[pattern(unit, signed=False)] = name, f"{name}-or-more"
    return names


def quantity_schema(unit: str, bounds: Mapping[str, float | None] | None = None) -> dict[str, Any]:
    """JSON schema of a quantity: text with a number and a unit; a number or text for a ratio.

    ``bounds``: of `tyrefem.quantity.Unit`, SI. A schema checks them for bare numbers, and that no quantity is negative
    where none may be; ``x-quantity`` keeps them for descriptions.
    """
    known = {name: bound for name, bound in (bounds or {}).items() if bound is not None}
    signed = not any(known.get(name, -1.0) >= 0 for name in ("gt", "ge"))
    text: dict[str, Any] = {"type": "string", "pattern": pattern(unit, signed=signed)}
    if unit == "1":
        keys = {"gt": "exclusiveMinimum", "ge": "minimum", "lt": "exclusiveMaximum", "le": "maximum"}
        text = {"anyOf": [{"type": "number", **{keys[name]: bound for name, bound in known.items()}}, text]}
    return {**text, "examples": list(EXAMPLES.get(unit, ())), "x-quantity": {"unit": unit, **known}}


def row_schema(*units: str, least: int = 2) -> dict[str, Any]:
    """JSON schema of a table of rows, with one quantity of each unit in a row."""
    row = {
        "type": "array",
        "items": [quantity_schema(unit) for unit in units],
        "minItems": len(units),
        "additionalItems": False,
    }
    return {"type": "array", "items": row, "minItems": least}
