"""Picture of heat of unknown origin over time."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from tyrefem.diagnose.words.heat import course_words, source_place
from tyrefem.reports.figures.style import (
    FONT,
    INK,
    TITLE,
    add_axes,
    figure,
    line_style,
    panel_title,
    short,
    si,
    tidy,
    time_unit,
    title,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from tyrefem.diagnose.diagnosis import DiagnosisData
    from tyrefem.diagnose.heat.over_time import HeatOverTime


#: Mean width of a letter, inches.
LETTER = 0.073
#: File of `heat_course_figure`; sentences elsewhere name it.
FILE = "missing-heat-course.png"


def heat_course_figure(d: DiagnosisData, over_time: HeatOverTime) -> Figure:
    """Draw the free course of every source, a panel each: a line per run with a band of one standard deviation.

    Heat inside is left out while the tyre is at rest, as the readings tell nothing of it. A vertical band shows the
    time of a switch, if a switch is the most probable course.
    """
    count, high, step = len(over_time.sources), 2.0, 2.75
    drawn = figure(9.4, count * step + TITLE + 0.35)
    divisor, unit = time_unit(max(float(knots[-1]) for knots in over_time.knots))
    for number, source in enumerate(over_time.sources):
        axes = add_axes(drawn, 0.95, 0.5 + (count - 1 - number) * step, 8.2, high)
        shown = [rolling if source.inside else np.ones_like(rolling) for rolling in over_time.rolling]
        edges = [
            float((np.abs(mean) + sd)[mask].max(initial=0.0))
            for mean, sd, mask in zip(source.strength, source.strength_sd, shown, strict=True)
        ]
        scale, written = si(max([1e-9, *edges]), "W/m³" if source.inside else "W/m²")
        for run, (knots, mean, sd, mask) in enumerate(
            zip(over_time.knots, source.strength, source.strength_sd, shown, strict=True)
        ):
            color = line_style(run)["color"]
            t, middle = knots / divisor, np.where(mask, mean, np.nan) / scale
            axes.fill_between(t, middle - sd / scale, middle + sd / scale, color=color, alpha=0.18, lw=0)
            axes.plot(t, middle, color=color, lw=1.5, label=over_time.runs[run])
        if math.isfinite(source.time):
            axes.axvspan(
                (source.time - source.time_sd) / divisor, (source.time + source.time_sd) / divisor, color=INK,
                alpha=0.25, lw=0,
            )  # fmt: skip
        axes.axhline(0.0, color=INK, lw=0.7)
        axes.set_ylabel(f"[{written}]", fontsize=FONT)
        clear = "" if source.clear else " (not clear)"
        place = f"{short(source_place(d, source), 70)}{clear}"
        panel_title(axes, place, pad=4)
        course = course_words(source).replace(f" (picture {FILE})", "")
        axes.annotate(short(course, 110), (0.01, 0.95), xycoords="axes fraction", fontsize=FONT - 1, va="top")
        axes.set_xlim(0.0, max(float(knots[-1]) for knots in over_time.knots) / divisor)
        tidy(axes)
        if number == 0:
            lines, names = axes.get_legend_handles_labels()
            columns = min(3, len(names))
            # Each name has its part of what the panel's title leaves, less its line.
            length = int(((8.2 - LETTER * len(place) - 0.3) / columns - 0.65) / LETTER)
            axes.legend(
                lines, [short(name, min(max(length, 4), 24)) for name in names], fontsize=FONT - 0.5, frameon=False,
                ncols=columns, loc="lower right", bbox_to_anchor=(1.0, 0.99),
            )  # fmt: skip
        if number == count - 1:
            axes.set_xlabel(f"time [{unit}]", fontsize=FONT)
    title(drawn, "Heat of unknown origin over time", "free course; band: 1 standard deviation")
    return drawn
