"""Numbers and places in the words of a report."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tyrefem.section import Section


def number(value: float, significant: int = 4) -> str:
    """A number for people: so many significant digits, no exponent between 1e-4 and 1e6.

    >>> number(539335.4), number(0.00698786), number(-0.0), number(2.5e8), number(1786)
    ('539 335', '0.006988', '0', '2.5e8', '1786')
    """
    value = float(value)
    if not math.isfinite(value):
        return "–"
    if value == 0:
        return "0"
    size = math.floor(math.log10(abs(value)))
    if size >= 7 or size < -4:
        mantissa, _, exponent = f"{value:.{significant - 1}e}".partition("e")
        return f"{mantissa.rstrip('0').rstrip('.')}e{int(exponent)}"
    text = f"{value:.{max(significant - 1 - size, 0)}f}"
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return f"{float(text):,.0f}".replace(",", " ") if size >= 4 else text


def seconds(value: float) -> str:
    """A time in s, and in minutes or hours where that reads better.

    >>> seconds(600.0), seconds(45.0), seconds(7200.0)
    ('600 s (10 min)', '45 s', '7200 s (2 h)')
    """
    text = f"{number(value)} s"
    if value >= 7200:
        return f"{text} ({number(value / 3600, 3)} h)"
    return f"{text} ({number(value / 60, 3)} min)" if value >= 300 else text


def place(section: Section, s: float, depth: float, region: str = "") -> str:
    """A place on the section in words: where along the meridian, and how deep; ``region`` where it is known.

    >>> from tyrefem.section import load
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
