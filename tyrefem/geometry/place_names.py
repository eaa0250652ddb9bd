from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tyrefem.geometry import Section


def place(section: Section, s: float, depth: float, region: str = "") -> str:
    """Description of a place on the section: position along the meridian, and depth; ``region`` if it is known.

    >>> from tyrefem.geometry import load
    >>> place(load("nasa-22x5.5-8pr"), 0.0, 0.0015)
    'at the crown centre, 1.5 mm from the inner surface'
    """
    along, shoulder, length = abs(s), section.line.shoulder_s, section.line.length
    down = (along - shoulder) / (length - shoulder)
    if along < 0.08 * shoulder:
        where = "at the crown centre"
    elif along < 0.85 * shoulder:
        where = "in the crown"
    elif down < 0.12:
        where = "at the shoulder"
    else:
        where = "in the upper sidewall" if down < 0.4 else "in mid sidewall" if down < 0.65 else "in the lower sidewall"
        if (region or str(section.region_at(s, depth))) == "bead":
            where = "in the bead"
    total = float(section.total_thickness([s])[0])
    if depth < 0.03 * total:
        return f"{where}, at the inner surface"
    if depth > 0.97 * total:
        return f"{where}, at the outer surface"
    return f"{where}, {depth * 1e3:.1f} mm from the inner surface"
