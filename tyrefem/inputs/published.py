"""Published ranges for comparison with a study's results; no computation uses them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import model_validator

from tyrefem.cards import Card, Text
from tyrefem.errors import InputError
from tyrefem.quantity import Unit, convert

if TYPE_CHECKING:
    pass


class _Range(Card):
    """``between``: least and greatest value; ``source``: reference."""

    between: tuple[float, float]
    source: Text

    @model_validator(mode="after")
    def _rises(self) -> _Range:
        if not self.between[0] < self.between[1]:
            raise InputError("the first of the two must be less than the second", field="between")
        return self


class StiffnessRange(_Range):
    """Range of a stiffness, N/m."""

    between: tuple[Annotated[float, Unit("N/m", gt=0)], Annotated[float, Unit("N/m", gt=0)]]


class LengthRange(_Range):
    """Range of a length, m."""

    between: tuple[Annotated[float, Unit("m", gt=0)], Annotated[float, Unit("m", gt=0)]]


class AreaRange(_Range):
    """Range of an area, m2."""

    between: tuple[Annotated[float, Unit("m**2", gt=0)], Annotated[float, Unit("m**2", gt=0)]]


class RatioRange(_Range):
    """Range of a number."""

    between: tuple[Annotated[float, Unit("1", gt=0)], Annotated[float, Unit("1", gt=0)]]


class Published(Card):
    """The table ``[published]`` of a study, all of it optional.

    ``vertical_stiffness`` is load over deflection at the drive's first load. Length and width are of the footprint's
    outline; the area is without the section's grooves.
    """

    vertical_stiffness: StiffnessRange | None = None
    footprint_length: LengthRange | None = None
    footprint_width: LengthRange | None = None
    footprint_area: AreaRange | None = None
    rolling_resistance_coefficient: RatioRange | None = None


#: SI unit, displayed unit, digits.
SHOWN = {
    "vertical_stiffness": ("N/m", "N/mm", ".0f"),
    "footprint_length": ("m", "mm", ".0f"),
    "footprint_width": ("m", "mm", ".0f"),
    "footprint_area": ("m**2", "cm**2", ".0f"),
    "rolling_resistance_coefficient": ("1", "1", ".5f"),
}


@dataclass(frozen=True)
class PublishedComparison:
    """A result beside the published range of its quantity, SI."""

    quantity: str
    value: float
    low: float
    high: float
    source: str

    @property
    def inside(self) -> bool:
        """True if the result is in the range."""
        return self.low <= self.value <= self.high

    @property
    def words(self) -> str:
        """One line of text.

        >>> print(PublishedComparison("vertical_stiffness", 226e3, 180e3, 220e3, "a book").words)
        vertical stiffness 226, published 180 to 220 N/mm: outside (a book)
        """
        quantity, value, between, verdict, source = self.cells
        number, _, unit = value.partition(" ")
        return f"{quantity} {number}, published {between}{' ' if unit else ''}{unit}: {verdict} ({source})"

    @property
    def cells(self) -> list[str]:
        """Row of a table: quantity, result with its unit, published range, verdict, source.

        >>> PublishedComparison("footprint_length", 0.13, 0.12, 0.15, "a book").cells
        ['footprint length', '130 mm', '120 to 150', 'inside', 'a book']
        """
        unit, shown, digits = SHOWN[self.quantity]
        value, low, high = (
            format(convert(number, unit, shown), digits) for number in (self.value, self.low, self.high)
        )
        name = "" if shown == "1" else f" {shown.replace('**', '')}"
        verdict = "inside" if self.inside else "outside"
        return [self.quantity.replace("_", " "), value + name, f"{low} to {high}", verdict, self.source]

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {**asdict(self), "unit": SHOWN[self.quantity][0], "verdict": "inside" if self.inside else "outside"}


def compared(published: Published, values: Mapping[str, float]) -> tuple[PublishedComparison, ...]:
    """Compare results with the published ranges; results without a range are left out.

    Parameters
    ----------
    published : the study's table. values : results, SI, by the table's names.
    """
    comparisons = []
    for name in SHOWN:
        known = getattr(published, name)
        if known is not None and name in values:
            low, high = known.between
            comparisons.append(PublishedComparison(name, values[name], low, high, known.source))
    return tuple(comparisons)


def of_footprint(footprint: Any) -> dict[str, float]:
    """Stiffness and footprint of a `footprint.Footprint` by the table's names, SI."""
    return {
        "vertical_stiffness": footprint.load / footprint.deflection,
        "footprint_length": footprint.length,
        "footprint_width": footprint.width,
        "footprint_area": footprint.area,
    }
