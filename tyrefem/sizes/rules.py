"""Named numbers of a size: each with its unit and its source, each replaceable by its name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from tyrefem.errors import InputError, nearest
from tyrefem.quantity import parse

#: Unit as written -> SI unit for `parse`, and its size.
UNITS = {
    "mm": ("m", 1e-3),
    "in": ("m", 0.0254),
    "mm**2": ("m**2", 1e-6),
    "deg": ("rad", 0.017453292519943295),
    "N": ("N", 1.0),
    "lbf": ("N", 4.4482216152605),
    "kPa": ("Pa", 1e3),
    "MPa": ("Pa", 1e6),
    "psi": ("Pa", 6894.757293168361),
    "1/m": ("1/m", 1.0),
    "1": ("1", 1.0),
}
#: Upper limit of a number that has none, SI.
UNLIMITED = 1e9
#: Numbers that count things.
COUNTS = ("plies", "belt_plies", "ply_rating", "grooves")


@dataclass(frozen=True)
class Number:
    """A named number in SI; ``unit`` as it is written."""

    name: str
    value: float
    unit: str
    source: str

    @property
    def text(self) -> str:
        """As a file has it.

        >>> Number("rim_width", 0.1524, "in", "given").text
        '6 in'
        """
        return written(self.value, self.unit)


def written(value: float, unit: str, digits: int = 6) -> str:
    """A quantity as a file has it."""
    number = f"{value / UNITS[unit][1]:.{digits}g}"
    return number if unit == "1" else f"{number} {unit}"


@dataclass
class Rules:
    """The numbers of a size, collected while its kind's rules are worked out. A given number replaces its rule.

    Parameters
    ----------
    given : name -> quantity as written.

    >>> rules = Rules({"crown_radius": "700 mm"})
    >>> round(rules("crown_radius", 0.5, "mm", "estimate"), 9), rules["crown_radius"].source
    (0.7, 'given')
    """

    given: Mapping[str, Any] = field(default_factory=dict)
    numbers: dict[str, Number] = field(default_factory=dict)

    def __call__(
        self, name: str, value: float, unit: str, source: str, low: float = 0.0, high: float = UNLIMITED
    ) -> float:
        """The number of a rule, SI, unless it is given. ``low`` to ``high``: what is allowed.

        Raises
        ------
        InputError : given with a wrong unit or outside what is allowed.
        """
        if name in self.given:
            try:
                value, source = parse(self.given[name], UNITS[unit][0]), "given"
            except InputError as error:
                raise error.within(field=f"parameters.{name}") from None
            if name in COUNTS and not float(value).is_integer():
                raise InputError(f"must be a whole number, not {value:g}", field=f"parameters.{name}")
        if not low <= value <= high:
            limits = f"{written(low, unit)} to {written(high, unit)}"
            if high >= UNLIMITED:
                limits = f"at least {written(low, unit)}"
            raise InputError(
                f"{written(value, unit)} is outside what is possible here: {limits}", field=f"parameters.{name}"
            )
        self.numbers[name] = Number(name, value, unit, source)
        return value

    def __getitem__(self, name: str) -> Number:
        return self.numbers[name]

    def __iter__(self) -> Iterator[Number]:
        return iter(self.numbers.values())

    def sources(self, *names: str) -> str:
        """One sentence of the sources of numbers."""
        return "; ".join(f"{name} {self[name].text} ({self[name].source})" for name in names)

    def check_all_used(self) -> None:
        """Raise `InputError` where a given number is not one of the rules."""
        for name in self.given:
            if name not in self.numbers:
                raise InputError(
                    f"this size has no number '{name}'{nearest(name, self.numbers)}", field=f"parameters.{name}"
                )
