"""The uncertain numbers of a study: numbers with a standard deviation in its cards or in the study."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from tyrefem.cards import Card
from tyrefem.errors import InputError
from tyrefem.inputs.changes import by_places, canonical, check_factor, check_number, check_used, scaled, value_at
from tyrefem.inputs.deviations import share_of
from tyrefem.materials.reads import STIFFNESS, tables_read
from tyrefem.quantity import amount_parts

if TYPE_CHECKING:
    from tyrefem.inputs.study_card import StudyCard
    from tyrefem.materials.card import MaterialCard

#: Number of names that a sentence lists; further names are counted.
NAMED = 3


@dataclass(frozen=True)
class UncertainNumber:
    """A number with a relative standard deviation: a single random variable for all its uses.

    A number of a card is the same variable in all regions with that card.

    Parameters
    ----------
    key : name of the number, the first of ``keys``. keys : all its dotted names, which one factor multiplies.
    written : values as written in the study or its cards.
    sd : relative standard deviation.
    card : name of its card; empty: the study. regions : regions with that card.
    idle : reason why it has no influence on a run of this study; empty: it has influence.
    """

    key: str
    keys: tuple[str, ...]
    written: tuple[Any, ...]
    sd: float
    card: str = ""
    regions: tuple[str, ...] = ()
    idle: str = ""

    def changes(self, factor: float, significant: int | None = None) -> dict[str, Any]:
        """Dotted name -> written value times a factor, for `Study.replace`.

        >>> UncertainNumber("drive.load", ("drive.load",), ("2 kN",), 0.05).changes(1.5)
        {'drive.load': '3 kN'}
        """
        for value in self.written:
            check_factor(value)
        return {key: scaled(value, factor, significant) for key, value in zip(self.keys, self.written, strict=True)}

    @property
    def tables(self) -> tuple[str, ...]:
        """Dotted names of the tables with the number."""
        return tuple(dict.fromkeys(key.rpartition(".")[0] for key in self.keys)) or (self.key,)

    @property
    def label(self) -> str:
        """Name of the number, and the other regions of its card.

        >>> cord = "cords.modulus"
        >>> UncertainNumber(f"materials.ply.{cord}", (), (), 0.1, "nylon", ("ply", "turn-up")).label
        'materials.ply.cords.modulus (also turn-up)'
        """
        return f"{self.key} (also {', '.join(self.regions[1:])})" if len(self.regions) > 1 else self.key

    @property
    def kelvins(self) -> float:
        """A temperature, K, of which a share means nothing; 0: another number.

        >>> UncertainNumber("drive.ambient", ("drive.ambient",), ("298.15 K",), 0.01).kelvins
        298.15
        """
        amount, unit = amount_parts(self.written[0] if self.written else "") or ("", "")
        return float(amount) if unit in ("K", "kelvin") else 0.0

    @property
    def deviation(self) -> str:
        """One standard deviation as text: a share, of a temperature kelvins.

        >>> UncertainNumber("drive.ambient", ("drive.ambient",), ("298.15 K",), 0.01).deviation
        '±2.98 K'
        >>> UncertainNumber("drive.load", ("drive.load",), ("2 kN",), 0.05).deviation
        '±5 %'
        """
        return f"±{self.sd * self.kelvins:.3g} K" if self.kelvins else f"±{100 * self.sd:.3g} %"


class StudyOfCards(Protocol):
    """Data of a study for its uncertain numbers: numbers as written, and cards with data and file of each region."""

    @property
    def card(self) -> StudyCard: ...
    @property
    def data(self) -> Mapping[str, Any]: ...
    @property
    def file(self) -> Path | None: ...
    @property
    def folder(self) -> Path | None: ...
    @property
    def materials(self) -> Mapping[str, MaterialCard]: ...
    @property
    def material_data(self) -> Mapping[str, tuple[Mapping[str, Any], Path]]: ...
    @property
    def uncertain_numbers(self) -> tuple[UncertainNumber, ...]: ...


def uncertain_numbers(study: StudyOfCards) -> tuple[UncertainNumber, ...]:
    """All uncertain numbers; those without influence state the reason.

    Order: by region; then the numbers that only a strain law reads; then the study's table.

    Raises
    ------
    InputError : the study has no number of a name in ``[uncertainty]``, or a number has two names there.
    """
    numbers = sorted(_of_cards(study), key=lambda number: _table(number.key) in STIFFNESS)
    places = {key: place for place, number in enumerate(numbers) for key in number.keys}
    stated: dict[int, str] = {}
    for key, deviation in study.card.uncertainty.items():
        try:
            check_used(study.data, key)
            number = _stated(_named(study, key, 0.0), deviation)
            number.changes(1.0)
            full = by_places(study.data, key)
        except InputError as error:
            raise InputError(error.message, field=f"uncertainty.{key}", file=study.file) from None
        place = places.get(full)
        if place is None:
            place = len(numbers)
            numbers.append(number)
            places |= dict.fromkeys((full, *number.keys), place)
        elif place in stated and numbers[place].sd != number.sd:
            why = f": both regions use the card '{number.card}'" if number.card else ""
            message = f"is the same number as '{stated[place]}'{why}; state only one"
            raise InputError(message, field=f"uncertainty.{key}", file=study.file)
        else:
            numbers[place] = replace(numbers[place], sd=number.sd)
        stated.setdefault(place, key)
    return tuple(numbers)


def _stated(number: UncertainNumber, deviation: float | str) -> UncertainNumber:
    """A number with a deviation as stated, of which the number may be a temperature, in K then."""
    shares = [share_of(value, deviation) for value in number.written]
    if len({share for share, _ in shares}) > 1:
        raise InputError("has several values: its standard deviation is a share, for example '2 %'")
    return replace(number, sd=shares[0][0], written=tuple(written for _, written in shares))


def uncertain_number(study: StudyOfCards, key: str, sd: float = 0.0) -> UncertainNumber:
    """The number at a dotted name, with the relative standard deviation ``sd``.

    Raises
    ------
    InputError : there is no number of that name; names the nearest.
    """
    together = uncertain_at(study, key)
    if together is None:
        return _named(study, key, sd)
    first = key.split(".")[1]
    regions = tuple(sorted(together.regions, key=lambda region: region != first))
    return replace(together, key=key, sd=sd, regions=regions)


def uncertain_at(study: StudyOfCards, key: str) -> UncertainNumber | None:
    """The uncertain number with a dotted name, however it is written; None if the number is not uncertain."""
    full = by_places(study.data, key)
    numbers = study.uncertain_numbers
    return next((number for number in numbers if any(by_places(study.data, k) == full for k in number.keys)), None)


def _named(study: StudyOfCards, key: str, sd: float) -> UncertainNumber:
    """The number at a dotted name, with the other regions of the same card."""
    value = value_at(study.data, key, study.folder)
    check_number(value)
    # A layer's angle is that of the cords of its region's card.
    parts = canonical(study.data, key).split(".")
    if parts[0] != "materials" or len(parts) < 4:
        return UncertainNumber(key, (key,), (value,), sd)
    region, within = parts[1], ".".join(parts[2:])
    data, path = study.material_data[region]
    regions = [
        other
        for other, (its, file) in study.material_data.items()
        if file == path and _at(its, within) == _at(data, within)
    ]
    regions.sort(key=lambda name: name != region)
    keys = tuple(f"materials.{name}.{within}" for name in regions)
    return UncertainNumber(
        key, keys, (value,) * len(keys), sd, path.stem, tuple(regions), _idle(study, regions, within)
    )


def written_at(study: StudyOfCards, key: str) -> Any:
    """The value as written at a dotted name of a study or its cards."""
    parts = key.split(".")
    if parts[0] == "materials" and len(parts) > 2 and parts[1] in study.material_data:
        return _at(study.material_data[parts[1]][0], ".".join(parts[2:]))
    return value_at(study.data, key, study.folder)


def left_out(numbers: Iterable[UncertainNumber]) -> list[str]:
    """A sentence for every reason why numbers have no influence in their study.

    >>> left_out([UncertainNumber("materials.tread.shear_modulus.value", (), (), 0.2, idle="no strain law reads them")])
    ['left out, because no strain law reads them: materials.tread.shear_modulus.value']
    """
    reasons: dict[str, list[str]] = {}
    for number in numbers:
        if number.idle:
            reasons.setdefault(number.idle, []).append(number.label)
    return [f"left out, because {reason}: {_listed(names)}" for reason, names in reasons.items()]


def _listed(names: list[str]) -> str:
    more = len(names) - NAMED
    return "; ".join(names) if more <= 1 else f"{'; '.join(names[:NAMED])}; and {more} more"


def _of_cards(study: StudyOfCards) -> list[UncertainNumber]:
    """Uncertain numbers of the material cards; a card's number in several regions is listed once."""
    together: dict[tuple[Any, ...], list[str]] = {}
    written: dict[tuple[Any, ...], tuple[Any, ...]] = {}
    for region, card in study.materials.items():
        data, path = study.material_data[region]
        for where, entry in stated_deviations(card):
            groups = [
                tuple(name for field in group if _at(data, name := f"{where}.{field}") is not None)
                for group in entry.uncertain_fields
            ]
            for fields in [group for group in groups if group] or [()]:
                values = tuple(_at(data, field) for field in fields)
                key = path, where, fields, repr(values), entry.relative_sd
                together.setdefault(key, []).append(region)
                written[key] = values
    return [_number(study, key, regions, written[key]) for key, regions in together.items()]


def _number(study: StudyOfCards, key: tuple[Any, ...], regions: list[str], values: tuple[Any, ...]) -> UncertainNumber:
    path, where, fields, _, sd = key
    keys = tuple(f"materials.{region}.{field}" for region in regions for field in fields)
    idle = _idle(study, regions, where) if fields else "they have no single number that a factor could change"
    first = keys[0] if keys else f"materials.{regions[0]}.{where}"
    return UncertainNumber(first, keys, values * len(regions), sd, Path(path).stem, tuple(regions), idle)


def stated_deviations(card: Card, where: str = "") -> Iterator[tuple[str, Any]]:
    """Every table of a card with a standard deviation, and its dotted name."""
    for name in type(card).model_fields:
        value = getattr(card, name)
        if isinstance(value, Card):
            path = f"{where}.{name}" if where else name
            if getattr(value, "relative_sd", None):
                yield path, value
            yield from stated_deviations(value, path)


def _idle(study: StudyOfCards, regions: list[str], within: str) -> str:
    """Reason why a number of a card has no influence on a run; empty: it has influence."""
    mechanics, table = study.card.mechanics, within.split(".")[0]
    law, feedback = mechanics.strain, mechanics.feedback
    if table == "expansion":
        return "a run does not use thermal expansion"
    softens = "softening" in within.split(".")
    if softens and (feedback is None or not feedback.modulus):
        return "only mechanics.feedback uses the softening"
    if softens and law == "given":
        energy = mechanics.energy
        return "" if energy is not None and energy.temperature is not None else "mechanics.energy has no temperature"
    reads = tables_read(law, study.materials)
    stiff = set(STIFFNESS) if table == "softening" else {table} & set(STIFFNESS)
    if stiff and not any(stiff & set(reads.get(region, ())) for region in regions):
        return f"the strain law '{law}' does not read them"
    return ""


def _table(key: str) -> str:
    parts = key.split(".")
    return parts[2] if parts[0] == "materials" and len(parts) > 2 else ""


def _at(data: Mapping[str, Any], path: str) -> Any:
    """The value at a dotted name of a card's plain data; None if there is none."""
    place: Any = data
    for part in path.split("."):
        place = place.get(part) if isinstance(place, Mapping) else None
    return place
