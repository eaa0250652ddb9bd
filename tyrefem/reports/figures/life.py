"""Picture of the life of the section: log10 km of every element, and the places that fail first."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.reports.figures.canvas import Canvas, canvas, draw_outlines, region_labels, sides
from tyrefem.reports.figures.cells import parts_of
from tyrefem.reports.figures.style import FONT, INK, Label, title

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from tyrefem.fatigue.life import LifeData
    from tyrefem.fatigue.places import FailurePlace

#: Decades of life that the colours show, from the shortest one.
DECADES = 5
#: Colours from short to long life.
COLOURS = "inferno"


def life_figure(life: LifeData, places: Sequence[FailurePlace]) -> Figure:
    """Draw log10 km of every element; grey: no ``[fatigue]``. Numbers: the places that fail first, with their km."""
    section = life.study.section
    labels = [place_label(number, place, half=section.half) for number, place in enumerate(places, start=1)]
    right = [label for label in labels if label.x >= 0]
    left = sorted([*region_labels(section), *(label for label in labels if label.x < 0)], key=lambda label: -label.y)
    drawn = canvas(section, [label.text for label in left], [label.text for label in right])
    _map(drawn, life)
    draw_outlines(drawn.axes, section, color="#404040", width=0.3)
    for number, place in enumerate(places, start=1):
        x, y = abs(place.z) * 1e3 if section.half else place.z * 1e3, place.r * 1e3
        drawn.axes.plot([x], [y], "o", ms=3.5, mfc="white", mec=INK, mew=0.8, zorder=8)
        if number == 1:
            drawn.axes.plot([x], [y], "*", ms=12, mfc="white", mec=INK, mew=1.0, zorder=9)
    drawn.beside(sorted(right, key=lambda label: -label.y), 1.0)
    drawn.beside(left, -1.0)
    given = "" if life.temperature is None else f", {life.temperature:g} °C everywhere"
    title(drawn.figure, life.study.title, f"distance until a flaw is a crack{given}; not compared with a measured life")
    return drawn.figure


def place_label(number: int, place: FailurePlace, *, half: bool) -> Label:
    """The label of a place, on its side; of a half section, whose sides are alike, on the right."""
    km = f"{place.km:,.0f}" if place.km < 1e7 else f"{place.km:.1g}"
    text = f"{number}  {km} km, {place.temperature:.0f} °C"
    z = abs(place.z) if half else place.z
    return Label(text, z * 1e3, place.r * 1e3, bold=number == 1)


def _map(drawn: Canvas, life: LifeData) -> None:
    from matplotlib import colormaps
    from matplotlib.collections import PolyCollection

    rings = life.rings
    parts = np.array(parts_of(9))
    corners = rings.element_nodes[:, parts].reshape(-1, 4)
    with np.errstate(divide="ignore"):
        values = np.repeat(np.log10(np.maximum(life.element_km, 1e-12)), len(parts))
    places = np.stack([rings.nodes[1], rings.nodes[0]], axis=-1)[corners] * 1e3
    low = np.floor(2 * np.nanmin(values)) / 2
    colours = colormaps[COLOURS].with_extremes(bad="0.8")
    image: Any = None
    for sign in sides(drawn.section):
        image = PolyCollection(
            list(places * [sign, 1.0]), array=np.ma.masked_invalid(values), cmap=colours, edgecolors="face",
            linewidths=0.2, zorder=1,
        )  # fmt: skip
        image.set_clim(low, low + DECADES)
        drawn.axes.add_collection(image)
    bar = drawn.color_bar(image, "log10 of the life [km]", extend="max")
    bar.ax.tick_params(labelsize=FONT)
