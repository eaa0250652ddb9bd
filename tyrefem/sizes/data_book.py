"""The aircraft data book that is shipped: rated load and pressure, size and rim of 395 bias tyres."""

from __future__ import annotations

import csv
import functools
from dataclasses import dataclass
from pathlib import Path

from tyrefem.sizes.designation import INCH, TyreSize, parse_size
from tyrefem.sizes.rules import UNITS

#: Where it stands, and whose it is.
FILE = Path(__file__).with_name("aircraft_bias.csv")
SOURCE = "makers' data book (Michelin, as transcribed in the public repository Felix-Deng/Aircraft-Tire-Selector)"
LBF, PSI = UNITS["lbf"][1], UNITS["psi"][1]


@dataclass(frozen=True)
class DataBookRow:
    """A row, SI. ``loaded_radius``: static, at rated load and pressure. Diameters and widths: least and largest."""

    size: str
    ply_rating: int
    load: float
    pressure: float
    diameter: tuple[float, float]
    width: tuple[float, float]
    rim_diameter: float
    rim_width: float
    flange_height: float
    loaded_radius: float

    @property
    def outer_diameter(self) -> float:
        """Mean of least and largest, m."""
        return sum(self.diameter) / 2

    @property
    def section_width(self) -> float:
        """Mean of least and largest, m."""
        return sum(self.width) / 2


@functools.cache
def data_book() -> tuple[DataBookRow, ...]:
    """All rows.

    >>> len(data_book())
    395
    """
    lines = [line for line in FILE.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    return tuple(_row(row) for row in csv.DictReader(lines))


def _row(row: dict[str, str]) -> DataBookRow:
    def number(name: str, unit: float = INCH) -> float:
        return float(row[name]) * unit

    return DataBookRow(
        row["size"].strip().lstrip("*"),
        int(row["ply_rating"]),
        number("rated_load [lbf]", LBF),
        number("rated_pressure [psi]", PSI),
        (number("outside_diameter_min [in]"), number("outside_diameter_max [in]")),
        (number("section_width_min [in]"), number("section_width_max [in]")),
        number("rim_diameter [in]"),
        number("rim_width_between_flanges [in]"),
        number("flange_height [in]"),
        number("static_loaded_radius_at_rated_load [in]"),
    )


def rows_of(size: TyreSize) -> list[DataBookRow]:
    """Rows of a bias size in any spelling, all ply ratings; by prefix, diameter, width, and rim where it names one.

    >>> {row.size for row in rows_of(parse_size("24.0 x 7.70"))}
    {'24x7.7'}
    >>> sorted({row.size for row in rows_of(parse_size("22x8"))})
    ['22x8-10', '22x8-8']
    """
    if size.kind != "aircraft-bias" or size.outside_diameter is None:
        return []
    rows = [row for row in data_book() if _numbers(parse_size(row.size)) == _numbers(size)]
    if size.rim_diameter is None:
        return [row for row in rows if parse_size(row.size).rim_diameter is None] or rows
    return [row for row in rows if _micrometres(row.rim_diameter) == _micrometres(size.rim_diameter)]


def row_of(size: TyreSize) -> DataBookRow | None:
    """The row of a size and ply rating; without a ply rating the middle one of the size.

    None: not in the book, or the book has the size on several rims and the text names none.

    >>> row_of(parse_size("22x5.5 8PR")).loaded_radius / 0.0254
    9.6
    """
    rows = sorted(rows_of(size), key=lambda row: row.ply_rating)
    if size.ply_rating is not None:
        rows = [row for row in rows if row.ply_rating == size.ply_rating]
    if len({row.rim_diameter for row in rows}) > 1:
        return None
    return rows[len(rows) // 2] if rows else None


def _numbers(size: TyreSize) -> tuple[str, int, int]:
    """Prefix, diameter and width."""
    return size.prefix, _micrometres(size.outside_diameter or 0.0), _micrometres(size.width)


def _micrometres(length: float) -> int:
    return round(length * 1e6)
