"""Picture of a diagnosis on the section: deviations at the sensors."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.diagnose.words.result_tables import rms_table
from tyrefem.reports.figures.canvas import Canvas, canvas, draw_outlines
from tyrefem.reports.figures.style import (  # fmt: skip
    FONT,
    INK,
    QUIET,
    Label,
    millimetres,
    short,
    title,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from tyrefem.diagnose.diagnosis import DiagnosisData
    from tyrefem.geometry import Section

DIVERGING = "RdBu_r"
#: Smallest distance of the two states of a sensor at the crown, as a share of the tyre's width.
APART = 0.032


def residual_figures(d: DiagnosisData) -> dict[str, Figure]:
    """Draw the mean deviation at every sensor: original left and amended right on a half section; on a full section,
    one picture each.
    """
    table = rms_table(d)
    places = {name: d.original.section_place(card) for name, card in d.original.sensors.items()}
    seen = [name for name in places if name in set(table["sensor"])]
    if not seen:
        return {}
    means: dict[str, dict[str, float]] = {"original": {}, "amended": {}}
    for name in seen:
        part = table[table["sensor"] == name]
        for state, column in (("original", "mean_before_K"), ("amended", "mean_after_K")):
            means[state][name] = float(np.average(part[column], weights=part["n"]))
    largest = max(1.0, *(abs(value) for state in means.values() for value in state.values()))
    section = d.original.section
    if section.half:
        return {"residual-map.png": _residuals(section, places, means, largest)}
    return {
        f"residual-map-{state}.png": _residuals(section, places, {state: values}, largest)
        for state, values in means.items()
    }


def _residuals(
    section: Section, places: dict[str, tuple[float, float]], means: dict[str, dict[str, float]], largest: float
) -> Figure:
    """Draw sensors coloured by their mean deviation; two states on the two sides of a half section."""
    left: list[tuple[Label, float]] = []
    right: list[tuple[Label, float]] = []
    for number, values in enumerate(means.values()):
        for name, value in values.items():
            x, y = (float(place) for place in millimetres(places[name]))
            if len(means) == 2:
                # Each state has one side; at the crown both states would be at the same place.
                x = (-1.0 if number == 0 else 1.0) * max(abs(x), APART / 2 * section.overall_width * 1e3)
                side = right if number else left
            else:
                side = left if x < 0 else right
            side.append((Label(f"{short(name)} {value:+z.1f} K", x, y), value))
    drawn = canvas(section, [label.text for label, _ in left], [label.text for label, _ in right], below=0.25)
    draw_ground(drawn)
    image: Any = None
    for side in (left, right):
        image = drawn.axes.scatter(
            [label.x for label, _ in side], [label.y for label, _ in side], c=[value for _, value in side],
            cmap=DIVERGING, vmin=-largest, vmax=largest, s=70, edgecolors=INK, linewidths=0.9, zorder=8,
        )  # fmt: skip
    drawn.beside(sorted((label for label, _ in left), key=lambda label: -label.y), -1.0)
    drawn.beside(sorted((label for label, _ in right), key=lambda label: -label.y), 1.0)
    drawn.color_bar(image, "measured - computed, mean [K]")
    names = list(means)
    if len(names) == 2:
        for name, sign in zip(names, (-1.0, 1.0), strict=True):
            drawn.axes.text(sign * drawn.width / 4, drawn.low - 0.2 * drawn.scale, name, fontsize=FONT + 1,
                            fontweight="bold", ha="center", va="center", color=INK)  # fmt: skip
    second = "mean over all runs and readings; red: the tyre is hotter than the model"
    title(drawn.figure, f"Deviation on the section: {' and '.join(names)} study", second)
    return drawn.figure


def draw_ground(drawn: Canvas) -> None:
    """Draw the section in one pale colour, with its outlines."""
    section = drawn.section
    for region in section.regions:
        for polygon in section.outline(region, 1e-3):
            x, y = millimetres(polygon)
            for sign in (1.0, -1.0) if section.half else (1.0,):
                drawn.axes.fill(sign * x, y, color="#eef0f2", lw=0, zorder=1)
    draw_outlines(drawn.axes, section, color=QUIET, width=0.6)
    if section.half:
        drawn.axes.axvline(0.0, color=QUIET, lw=0.6, ls=(0, (8, 2, 1.5, 2)), zorder=0)
