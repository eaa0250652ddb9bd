"""What the rules of a kind give: the numbers of a size, its line, and the section's tables as a file has them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.sizes.designation import TyreSize
from tyrefem.sizes.meridian import SizedMeridian
from tyrefem.sizes.rules import Rules, written

Array = NDArray[np.float64]
#: Points of the line in a file, about.
POINTS = 44


@dataclass(frozen=True)
class Drawn:
    """A size drawn by the rules of its kind.

    ``data``: the section's file as plain data. ``materials``: region -> material card, as a study's ``[materials]``.
    """

    size: TyreSize
    rules: Rules
    meridian: SizedMeridian
    data: Mapping[str, Any]
    materials: Mapping[str, Any]


def millimetres(values: Iterable[float], digits: int = 3) -> dict[str, Any]:
    """A table of lengths as a section file has it."""
    return {"unit": "mm", "values": [round(float(value) * 1e3, digits) for value in values]}


def length(value: float) -> str:
    """A length as a section file has it, to a micrometre."""
    return f"{round(value * 1e3, 3):g} mm"


def thickness(rows: Iterable[tuple[float, float]], at: Array) -> Array:
    """Thickness at stations by rows (s, thickness), linear between them."""
    s, values = np.array(list(rows)).T
    return np.asarray(np.interp(at, s, values))


def table(name: str, rows: Iterable[tuple[float, float]], regions: list[dict[str, str]], source: str) -> dict[str, Any]:
    """A layer of a section file; rows (s, thickness) of one station are joined."""
    kept: list[tuple[float, float]] = []
    *before, (last, at_end) = sorted(rows)
    # The line through the file's rounded points is a little longer or shorter than the one that they are taken from.
    for s, height in [*before, (1.01 * last, at_end)]:
        if kept and s - kept[-1][0] < 5e-4:
            continue
        kept.append((s, height))
    return {
        "name": name,
        "s": millimetres(s for s, _ in kept),
        "thickness": millimetres(height for _, height in kept),
        "regions": regions,
        "source": source,
    }


def section_data(
    size: TyreSize, rules: Rules, line: SizedMeridian, reference: str, layers: list[dict[str, Any]], **more: Any
) -> dict[str, Any]:
    """The tables that all kinds have.

    ``more``: shoulder_s and bead_length, m; outer_diameter before inflation, m, where it differs from the rules';
    grooves, wrap, rating, title.
    """
    points = line.points(POINTS)
    radial = line.membrane.lift == 0
    words = (
        "sin phi = (r^2 - r_m^2)/(r_c^2 - r_m^2)"
        if radial
        else "sin phi ~ (r^2 - r_m^2) sin alpha, cos alpha/r constant"
    )
    before = "with the belts' share of the pressure" if line.belted else "an arc"
    return {
        "title": more["title"],
        "line": {
            "kind": "points",
            "reference": reference,
            "points": {"unit": "mm", "values": [[round(r * 1e3, 4), round(z * 1e3, 4)] for r, z in points]},
            "source": f"cords in equilibrium under pressure, {words} (Purdy), from {line.join_s * 1e3:.1f} mm to "
            f"{line.flange_s * 1e3:.1f} mm along "
            f"the line, r_m {line.membrane.widest * 1e3:.1f} mm; {before} before, the rim's flange and seat behind "
            f"it; fitted to {size.text} by "
            "tyrefem.sizes",
        },
        "parameters": {
            "outer_diameter": written(
                more.get("outer_diameter", rules["outer_diameter"].value), rules["outer_diameter"].unit
            ),
            "nominal_width": written(size.width, rules["outer_diameter"].unit),
            "shoulder_s": length(more["shoulder_s"]),
            "bead_length": length(more["bead_length"]),
            "rim_length": length(line.length - line.flange_s),
            "flange_radius": rules["flange_radius"].text,
            "flange_r": length(line.rim.centre[0]),
            "flange_z": length(line.rim.centre[1]),
            "source": f"{size.text}: "
            + rules.sources("outer_diameter", "section_width", "tread_width", "flange_radius"),
        },
        "layers": layers,
        **({"grooves": more["grooves"]} if more.get("grooves") else {}),
        **({"wrap": more["wrap"]} if more.get("wrap") else {}),
        "boundaries": [{"name": "road", "to": "shoulder"}, {"name": "outside_air", "to": "rim_start"}, {"name": "rim"}],
        "rating": {
            "width": written(size.width, rules["outer_diameter"].unit),
            "diameter": rules["outer_diameter"].text,
            "load": rules["rated_load"].text,
            "pressure": rules["rated_pressure"].text,
            "cord_angle": rules["cord_angle"].text,
            "bead_wire_area": rules["bead_wire_area"].text,
            "bead_bundles": 1,
            "source": rules.sources("rated_load", "rated_pressure", "cord_angle", "bead_wire_area"),
        },
    }
