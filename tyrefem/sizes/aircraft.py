"""What aircraft tyres have in common: the data book's row or rules in its place, the rim, the rated load."""

from __future__ import annotations

import math

from tyrefem.errors import InputError
from tyrefem.sizes.data_book import SOURCE, DataBookRow, row_of, rows_of
from tyrefem.sizes.designation import INCH, TyreSize
from tyrefem.sizes.load_index import AIRCRAFT_EXPONENT, capacity, check_carries
from tyrefem.sizes.rim import Rim
from tyrefem.sizes.rules import UNITS, Rules

PSI = UNITS["psi"][1]
#: Deflection at the rated load over the section height, of sizes without a row (estimate: usual for aircraft tyres).
DEFLECTION = 0.32
#: Modulus of the bead between plies and flange in plane strain, Pa, and its source.
BEAD_MODULUS = (
    48e6,
    "estimate: four times 12 MPa of shear, between fillers (14 MPa) and the thinner rim strips (5 MPa)",
)


def aircraft_numbers(size: TyreSize, rule: Rules, plies: int) -> tuple[Rim, float]:
    """Rules of size, rim, load and pressure; the rim and the rated pressure, Pa.

    ``plies``: the ply rating if none is known.

    Raises
    ------
    InputError : the rim's diameter is not known; a rim out of range; a pressure that cannot carry the load.
    """
    row = row_of(size)
    outside, width = size.outside_diameter or 0.0, size.width
    diameter = row.rim_diameter if row else size.rim_diameter
    if diameter is None and "rim_diameter" not in rule.given:
        raise InputError(f"'{size.text}' {_without_rim(size)}, or give rim_diameter", field="size")
    rating = row.ply_rating if row else size.ply_rating or plies
    rule(
        "ply_rating",
        size.ply_rating or rating,
        "1",
        "of the size" if size.ply_rating else f"{SOURCE if row else 'estimate'}: the size names none",
        2,
        60,
    )
    diameter = rule(
        "rim_diameter", diameter or 0.0, "in", SOURCE if row else "of the size", 0.2 * outside, 0.85 * outside
    )
    outer = rule(
        "outer_diameter",
        row.outer_diameter if row else 0.985 * outside,
        "in",
        f"{SOURCE}: mean of least and largest" if row else "estimate: 0.985 of the nominal (largest) diameter",
        diameter + 0.04,
    )
    rule(
        "section_width",
        row.section_width if row else 0.975 * width,
        "in",
        f"{SOURCE}: mean of least and largest" if row else "estimate: 0.975 of the nominal (largest) width",
        0.6 * width,
        1.2 * width,
    )
    between = row.rim_width if row else 0.74 * width
    rim_width = rule(
        "rim_width",
        between,
        "in",
        f"{SOURCE}: between the flanges"
        if row
        else "estimate: 0.74 nominal widths between the flanges (mean of the data book's bias tyres)",
    )
    low, high = between - 0.12 * width, between + 0.12 * width
    if not low <= rim_width <= high:
        raise InputError(
            f"{rim_width / INCH:.4g} in is too {'narrow' if rim_width < low else 'wide'} for {size.text}; "
            f"allowed: {low / INCH:.3g} to {high / INCH:.3g} in",
            field="rim_width",
        )
    height = rule(
        "flange_height",
        row.flange_height if row else 0.105 * width,
        "in",
        SOURCE if row else "estimate: 0.105 nominal widths",
        5e-3,
        80e-3,
    )
    radius = rule("flange_radius", 0.45 * height, "mm", "estimate: 0.45 flange heights", 3e-3, 60e-3)
    rim = Rim(
        diameter, rim_width, height, radius, rule("seat_taper", math.radians(5), "deg", "estimate: 5 deg seat", 0, 0.35)
    )
    pressure = _rated(size, rule, row, outer)
    return rim, pressure


def _without_rim(size: TyreSize) -> str:
    """Why the data book has no row of a size that names no rim, and how to write it with one."""
    plain = size.text.split(" ")[0]
    rows = rows_of(size)
    if not rows:
        rim = max(4, round(0.53 * (size.outside_diameter or 0.0) / INCH))
        return f"does not name its rim and is not in the data book: write it with the rim, such as {plain}-{rim}"
    if size.ply_rating is None or size.ply_rating in {row.ply_rating for row in rows}:
        rims = sorted({row.rim_diameter / INCH for row in rows})
        return (
            f"does not name its rim and the data book has several: write {' or '.join(f'{plain}-{x:g}' for x in rims)}"
        )
    ratings = sorted({row.ply_rating for row in rows})
    return (
        "does not name its rim and the data book has other ply ratings of this size, "
        f"{', '.join(f'{x}PR' for x in ratings)}: take one, write it with the rim, such as "
        f"{plain}-{rows[0].rim_diameter / INCH:g}"
    )


def _rated(size: TyreSize, rule: Rules, row: DataBookRow | None, outer: float) -> float:
    guess = 100 * PSI * rule["ply_rating"].value / (size.width / INCH)
    words = "estimate: 100 psi in x ply rating over the width"
    pressure = rule("rated_pressure", row.pressure if row else guess, "psi", SOURCE if row else words, 5e4, 4e6)
    load = row.load if row else _tr_r64(size.width, outer, 0.5 * (outer - rule["rim_diameter"].value), pressure)
    load = rule(
        "rated_load", load, "lbf", SOURCE if row else f"estimate: NASA TR R-64 at {DEFLECTION:.0%} deflection", 100, 1e6
    )
    if "load" in rule.given or "pressure" in rule.given:
        at = rule("pressure", pressure, "psi", "as rated", 1e4, 4e6)
        words = "as rated" if at >= pressure else "what the tyre carries at this pressure"
        wanted = rule("load", capacity(load, pressure, at, AIRCRAFT_EXPONENT), "lbf", words)
        check_carries(load, pressure, wanted, at, AIRCRAFT_EXPONENT)
    return pressure


def _tr_r64(width: float, diameter: float, height: float, pressure: float) -> float:
    """NASA TR R-64 (Smiley and Horne 1958): F = 1.08 p w sqrt(w d) 2.4 (u - C_z), u = deflection/w, C_z = 0.02."""
    return float(1.08 * pressure * width * math.sqrt(width * diameter) * 2.4 * (DEFLECTION * height / width - 0.02))
