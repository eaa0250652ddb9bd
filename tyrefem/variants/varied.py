"""A varied quantity: maps points of the unit interval to values of a study."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.errors import InputError
from tyrefem.inputs.changes import scaled, value_at
from tyrefem.quantity import parse
from tyrefem.variants.card import VaryCard

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData

_AMOUNT = re.compile(r"^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*$", re.DOTALL)
#: Significant digits of written values, so that a variant can be typed again.
DIGITS = 9


@dataclass(frozen=True)
class Varied:
    """A dotted name of a study and its values.

    Parameters
    ----------
    key : dotted name. unit : of the numbers; empty for pure numbers, cards and words.
    values : listed values, as written; empty for a continuous quantity.
    low, high : ends of a continuous range, in ``unit``. log : logarithmic spacing. levels : values in a grid.
    nominal : the study's value; the numbers are factors on it.
    also : (dotted name, its value) of numbers with the same factor: the card's number in other regions.
    """

    key: str
    unit: str = ""
    values: tuple[Any, ...] = ()
    low: float = 0.0
    high: float = 1.0
    log: bool = False
    levels: int = 5
    nominal: Any = None
    also: tuple[tuple[str, Any], ...] = ()

    def changes(self, value: Any) -> dict[str, Any]:
        """Dotted name -> value, for a value as in a study file.

        >>> ply = Varied("materials.ply.k", low=0.5, high=1.5, nominal="2 W", also=(("materials.wrap.k", "2 W"),))
        >>> ply.changes(ply.at(1.0))
        {'materials.ply.k': '3 W', 'materials.wrap.k': '3 W'}
        """
        if not self.also:
            return {self.key: value}
        factor = _ratio(value, self.nominal)
        return {self.key: value, **{key: scaled(nominal_value, factor, DIGITS) for key, nominal_value in self.also}}

    def together(self, value: Any, others: Mapping[str, Any]) -> bool:
        """Do the names of ``also`` have the same factor as this value?"""
        factor = _ratio(value, self.nominal) if self.also else 1.0
        return all(
            math.isclose(_ratio(others[key], nominal_value), factor, rel_tol=1e-6) for key, nominal_value in self.also
        )

    @property
    def heading(self) -> str:
        """Heading of a table's column: ``drive.speed [mph]``; for a factor ``NAME [x]``."""
        unit = self.unit or ("x" if self.nominal is not None else "")
        return f"{self.key} [{unit}]" if unit else self.key

    def number(self, place: float) -> float:
        """The number at a point of [0, 1] of a continuous range, in `unit`."""
        if self.log:
            return float(self.low * (self.high / self.low) ** place)
        return float(self.low + (self.high - self.low) * place)

    def at(self, place: float) -> Any:
        """The value at a point of [0, 1], as in a study file.

        >>> Varied("drive.speed", "mph", low=10.0, high=40.0).at(0.5)
        '25 mph'
        >>> Varied("materials.tread", values=("soft", "hard")).at(0.5)
        'hard'
        """
        if self.values:
            return self.values[min(int(place * len(self.values)), len(self.values) - 1)]
        return self.written(self.number(place))

    def written(self, number: float) -> Any:
        """A number of this quantity, as in a study file."""
        rounded = float(f"{number:.{DIGITS}g}")
        if self.nominal is not None:
            return scaled(self.nominal, rounded, DIGITS)
        return f"{rounded:.{DIGITS}g} {self.unit}" if self.unit else rounded

    def of(self, value: Any) -> Any:
        """A written value for a table: its number in `unit` if it has one, else the value."""
        if self.values and not self.unit:
            return value if isinstance(value, int | float) else str(value)
        if self.nominal is not None:
            return _ratio(value, self.nominal)
        return _amount(value)[0]

    def contains(self, value: Any) -> bool:
        """Is a written value within the range, or among the listed values?

        >>> Varied("drive.speed", "mph", low=10.0, high=40.0).contains("10 m/s")
        True
        """
        if self.values:
            return value in self.values
        try:
            if self.nominal is not None:
                number = _ratio(value, self.nominal)
            else:
                number, unit = _amount(value)
                if unit != self.unit:
                    number = parse(value, self.unit or "1")
        except InputError:
            return False
        room = 1e-9 * max(abs(self.low), abs(self.high))
        return self.low - room <= number <= self.high + room

    @property
    def grid(self) -> list[Any]:
        """Values of a grid, as in a study file."""
        if self.values:
            return list(self.values)
        return [self.at(float(place)) for place in np.linspace(0.0, 1.0, self.levels)]

    @property
    def ends(self) -> list[Any]:
        """All listed values, or both ends of the range: they are checked before anything runs."""
        return list(self.values) or [self.at(0.0), self.at(1.0)]


def varied(study: StudyData, key: str, card: VaryCard) -> Varied:
    """A varied quantity of a study.

    Raises
    ------
    InputError : the study has no such number, the ends have different units, or a logarithmic range includes zero.
    """
    try:
        if card.values is not None:
            return _listed(key, card.values)
        if card.factor is not None:
            nominal = value_at(study.data, key, study.folder)
            scaled(nominal, 1.0)
            return Varied(key, "", (), *card.factor, log=card.scale == "log", levels=card.levels, nominal=nominal)
        (low, unit), (high, other) = _amount(card.low), _amount(card.high)
        if unit != other:
            raise InputError(f"'from' is in '{unit}' and 'to' in '{other}'; write both in the same unit")
        if not low < high:
            raise InputError(f"'from' ({low:g}) must be below 'to' ({high:g})")
        if card.scale == "log" and low <= 0:
            raise InputError(f"a logarithmic range must be positive; 'from' is {low:g}")
    except InputError as error:
        raise error if error.field == key else error.within(field=f"vary.{key}") from None
    return Varied(key, unit, (), low, high, card.scale == "log", card.levels)


def uncertain(study: StudyData, deviations: float) -> list[Varied]:
    """The uncertain numbers of a study that affect answers, uniform within so many standard deviations.

    Raises
    ------
    InputError : no uncertain number is stated, or a range reaches zero.
    """
    varied_numbers = []
    for number in study.uncertain_numbers:
        if number.idle:
            continue
        reach = deviations * number.sd
        if reach >= 1:
            message = f"{deviations:g} standard deviations of '{number.key}' ({100 * number.sd:.3g} %) reach zero"
            raise InputError(message, field="uncertain")
        pairs = zip(number.keys, number.written, strict=True)
        (key, nominal), *also = pairs
        varied_numbers.append(Varied(key, "", (), 1 - reach, 1 + reach, nominal=nominal, also=tuple(also)))
    if not varied_numbers:
        raise InputError("neither cards (relative_sd) nor [uncertainty] state a standard deviation", field="uncertain")
    return varied_numbers


def _listed(key: str, values: list[Any]) -> Varied:
    amounts = [_AMOUNT.match(value) if isinstance(value, str) else None for value in values]
    units = {match[2] for match in amounts if match}
    same = in_one_unit(values)
    for number, item in enumerate(same):
        if item in same[:number]:
            first, again = values[same.index(item)], values[number]
            raise InputError(f"{again!r} is given twice" + ("" if first == again else f": it is {first!r}"))
    unit = units.pop() if len(units) == 1 and all(amounts) else ""
    return Varied(key, unit, tuple(values), levels=len(values))


def in_one_unit(values: Sequence[Any]) -> list[Any]:
    """The values as numbers in the unit of the first quantity among them, so that equal values compare equal.

    >>> in_one_unit(["10 mph", "4.4704 m/s", "10.0 mph"]), in_one_unit(["soft", "8 mm"])
    ([10.0, 10.0, 10.0], ['soft', 8.0])
    """
    amounts = [_AMOUNT.match(value) if isinstance(value, str) else None for value in values]
    unit = next((match[2] for match in amounts if match), "") or "1"
    converted = []
    for value, match in zip(values, amounts, strict=True):
        try:
            converted.append(float(f"{parse(value, unit):.12g}") if match else value)
        except InputError:
            converted.append(value)
    return converted


def _amount(value: Any) -> tuple[float, str]:
    if isinstance(value, bool):
        raise InputError(f"{value!r} is not a number")
    if isinstance(value, int | float):
        if not math.isfinite(value):
            raise InputError(f"{value!r} is not a finite number")
        return float(value), ""
    match = _AMOUNT.match(value) if isinstance(value, str) else None
    if match is None:
        raise InputError(f"{value!r} is not a number with its unit, e.g. '20 mph'")
    return float(match[1]), match[2]


def _ratio(value: Any, nominal: Any) -> float:
    if isinstance(value, list):
        value, nominal = value[-1], nominal[-1]
        return _ratio(value, nominal)
    return _amount(value)[0] / _amount(nominal)[0]


def scaled_value(study: StudyData, key: str, factor: float, digits: int = DIGITS) -> Any:
    """The study's value at a dotted name times a factor, as in a study file."""
    return scaled(value_at(study.data, key, study.folder), factor, digits)
