"""A varied quantity: maps points of the unit interval to values of a study."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.errors import InputError
from tyrefem.inputs.changes import check_factor, check_number, scaled
from tyrefem.inputs.name_patterns import number_at
from tyrefem.quantity import KELVIN, amount_parts, parse
from tyrefem.variants.card import VaryCard
from tyrefem.variants.links import Links, Members, members

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData
    from tyrefem.inputs.uncertain_numbers import UncertainNumber

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
    also : (dotted name, its value) of numbers with the same factor: the card's number in other regions, or of a link.
    same : (dotted name, its share) of linked numbers with the same value, times a share. name : of the link.
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
    same: tuple[tuple[str, float], ...] = ()
    name: str = ""

    @property
    def label(self) -> str:
        """The name in tables and sentences: of the link, or the dotted name."""
        return self.name or self.key

    @property
    def keys(self) -> tuple[str, ...]:
        """All dotted names that it sets; the first is `key`."""
        return (self.key, *(key for key, _ in self.also), *(key for key, _ in self.same))

    def changes(self, value: Any) -> dict[str, Any]:
        """Dotted name -> value, for a value as in a study file.

        >>> ply = Varied("materials.ply.k", low=0.5, high=1.5, nominal="2 W", also=(("materials.wrap.k", "2 W"),))
        >>> ply.changes(ply.at(1.0))
        {'materials.ply.k': '3 W', 'materials.wrap.k': '3 W'}
        >>> belts = Varied("belt-1.angle", "deg", low=20.0, high=28.0, same=(("belt-2.angle", -1.0),), name="angle")
        >>> belts.changes(belts.at(0.5))
        {'belt-1.angle': '24 deg', 'belt-2.angle': '-24 deg'}
        """
        if self.same:
            return {self.key: value, **{key: self._shared(value, key, share) for key, share in self.same}}
        if not self.also:
            return {self.key: value}
        factor = _ratio(value, self.nominal)
        return {self.key: value, **{key: scaled(nominal_value, factor, DIGITS) for key, nominal_value in self.also}}

    def together(self, value: Any, others: Mapping[str, Any]) -> bool:
        """Do the names of ``also`` have the same factor as this value, those of ``same`` their share of it?"""
        if any(not _alike(others[key], _times(value, share)) for key, share in self.same):
            return False
        factor = _ratio(value, self.nominal) if self.also else 1.0
        return all(
            math.isclose(_ratio(others[key], nominal_value), factor, rel_tol=1e-6) for key, nominal_value in self.also
        )

    @property
    def heading(self) -> str:
        """Heading of a table's column: ``drive.speed [mph]``; for a factor ``NAME [x]``."""
        unit = self.unit or ("x" if self.nominal is not None else "")
        return f"{self.label} [{unit}]" if unit else self.label

    @property
    def settings_of_keys(self) -> dict[str, str]:
        """Dotted name -> what it gets: its share of the value, or its own value times the factor."""
        shares = {self.key: 1.0, **dict(self.same)}
        if self.nominal is not None:
            return dict.fromkeys(self.keys, "its value x factor")
        return {key: "the value" if share == 1.0 else f"{share:g} x the value" for key, share in shares.items()}

    def setting(self, value: Any) -> str:
        """A written value as text; the factor of linked numbers."""
        return f"{self.of(value):.{DIGITS}g} x" if self.name and self.nominal is not None else str(value)

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

    def _shared(self, value: Any, key: str, share: float) -> Any:
        """A number's share of the value of its link."""
        try:
            return _times(value, share)
        except InputError as error:
            raise InputError(f"{key}: {error.message}", field=f"link.{self.label}") from None

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
            number = self._number_of(value)
        except InputError:
            return False
        room = 1e-9 * max(abs(self.low), abs(self.high))
        return self.low - room <= number <= self.high + room

    def _number_of(self, value: Any) -> float:
        """The number of a written value in `unit`, or its factor."""
        if self.nominal is not None:
            return _ratio(value, self.nominal)
        number, unit = _amount(value)
        return number if unit == self.unit else parse(value, self.unit or "1")

    def place_of(self, value: Any) -> float:
        """The point of [0, 1] of a value within a continuous range: the inverse of `at`.

        >>> Varied("drive.speed", "mph", low=10.0, high=40.0).place_of("25 mph")
        0.5
        """
        number = self._number_of(value)
        if self.log:
            return math.log(number / self.low) / math.log(self.high / self.low)
        return (number - self.low) / (self.high - self.low)

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


def varied(study: StudyData, key: str, card: VaryCard, links: Links | None = None) -> Varied:
    """A varied quantity of a study; ``links``: names that stand for several numbers.

    Raises
    ------
    InputError : the study has no such number, the ends have different units, or a logarithmic range includes zero.
    """
    try:
        group = members(study, key, links or {})
        if card.factor is not None:
            by_factor = factored(study, group)
            return replace(
                by_factor, low=card.factor[0], high=card.factor[1], log=card.scale == "log", levels=card.levels
            )
        return replace(_by_value(group.pairs[0][0], card), same=group.pairs[1:], name=key if group.linked else "")
    except InputError as error:
        if error.field == key or (error.field or "").startswith("link"):
            raise
        words = f"{error.field}: {error.message}" if error.field else error.message
        raise InputError(words, field=f"vary.{key}", file=error.file) from None


def factored(study: StudyData, group: Members) -> Varied:
    """The numbers of a name, all times one factor on their values in the study.

    Raises
    ------
    InputError : a number is not in the study or its cards, or is zero.
    """
    values = [number_at(study.data, key, study.folder) for key in group.keys]
    for key, value in zip(group.keys, values, strict=True):
        scaled(value, 1.0)
        check_number(value)
        check_factor(value)
        if not _first(value):
            raise InputError(f"is {value!r}: a factor does not change it; give values", field=key)
    others = tuple(zip(group.keys[1:], values[1:], strict=True))
    return Varied(group.keys[0], nominal=values[0], also=others, name=group.name if group.linked else "")


def _by_value(key: str, card: VaryCard) -> Varied:
    if card.values is not None:
        return _listed(key, card.values)
    (low, unit), (high, other) = _amount(card.low), _amount(card.high)
    if unit != other:
        raise InputError(f"'from' is in '{unit}' and 'to' in '{other}'; write both in the same unit")
    if not low < high:
        raise InputError(f"'from' ({low:g}) must be below 'to' ({high:g})")
    if card.scale == "log" and low <= 0:
        raise InputError(f"a logarithmic range must be positive; 'from' is {low:g}")
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
        if number.kelvins:
            varied_numbers.append(_temperature(study, number, reach))
        else:
            varied_numbers.append(Varied(key, "", (), 1 - reach, 1 + reach, nominal=nominal, also=tuple(also)))
    if not varied_numbers:
        raise InputError("neither cards (relative_sd) nor [uncertainty] state a standard deviation", field="uncertain")
    return varied_numbers


def _temperature(study: StudyData, number: UncertainNumber, reach: float) -> Varied:
    """An uncertain temperature by its values, in degC unless the study has it in K: a factor of it means nothing."""
    _, unit = amount_parts(number_at(study.data, number.key, study.folder)) or ("", "")
    zero, unit = (0.0, "K") if unit in ("K", "kelvin") else (KELVIN, "degC")
    low, high = ((1 + sign * reach) * number.kelvins - zero for sign in (-1, 1))
    return Varied(number.key, unit, (), low, high, same=tuple((key, 1.0) for key in number.keys[1:]))


def _listed(key: str, values: list[Any]) -> Varied:
    amounts = [amount_parts(value) for value in values]
    units = {each[1] for each in amounts if each}
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
    amounts = [amount_parts(value) for value in values]
    unit = next((each[1] for each in amounts if each), "") or "1"
    converted = []
    for value, amount in zip(values, amounts, strict=True):
        try:
            converted.append(float(f"{parse(value, unit):.12g}") if amount else value)
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
    amount = amount_parts(value)
    if amount is None:
        raise InputError(f"{value!r} is not a number with its unit, e.g. '20 mph'")
    return float(amount[0]), amount[1]


def _ratio(value: Any, nominal: Any) -> float:
    """The factor of a written value on a nominal value; of tables, by their first number that is not zero."""
    number = _first(nominal)
    return _first(value) / number if number else math.nan


def _first(value: Any) -> float:
    """The number of a written value; of a table the first that is not zero, without its first column."""
    if isinstance(value, Mapping):
        value = value["values"]
    if isinstance(value, list):
        numbers = (_first(entry[1:] if isinstance(entry, list) else entry) for entry in value)
        return next((number for number in numbers if number), 0.0)
    return _amount(value)[0]


def factor_of(value: Any) -> float | None:
    """The factor of a cell of a list, ``1.1 x`` under a heading ``NAME [x]``; None for other values.

    >>> factor_of("1.1 x"), factor_of("1.1 mm")
    (1.1, None)
    """
    amount = amount_parts(value)
    return float(amount[0]) if amount is not None and amount[1] == "x" else None


def _times(value: Any, share: float) -> Any:
    if share == 1.0:
        return value
    check_factor(value)
    return scaled(value, share, DIGITS)


def _alike(value: Any, other: Any) -> bool:
    """Are two written values equal, also in different units?"""
    if value == other:
        return True
    try:
        (number, unit), expected = _amount(other), value
        return math.isclose(parse(expected, unit or "1"), number, rel_tol=1e-6, abs_tol=1e-12)
    except InputError:
        return False
