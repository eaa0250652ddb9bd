"""Tension of the cords of every layer round the wheel."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from tyrefem.plotting.footprint import described
from tyrefem.plotting.style import FONT, INK, PALETTE, QUIET, TITLE, add_axes, figure, si, tidy, title

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from tyrefem.footprint.cord_cycle import CordCycle
    from tyrefem.footprint.pressed import Footprint

#: Height of a panel with its axis, inches.
PANEL = 1.95


def cord_tension_figure(found: Footprint, cords: Sequence[CordCycle]) -> Figure:
    """One panel for each layer of cords: both directions of the cords, and the tension of the inflated tyre."""
    rows = (len(cords) + 1) // 2
    drawn = figure(10.4, 0.35 + PANEL * rows + TITLE)
    height = float(drawn.get_size_inches()[1])
    for number, one in enumerate(cords):
        row, column = divmod(number, 2)
        axes = add_axes(drawn, 0.75 + 5.1 * column, height - TITLE - PANEL * (row + 1) + 0.35, 4.2, PANEL - 0.65)
        largest = float(np.abs(np.concatenate([one.plus, one.minus])).max())
        scale, unit = si(largest, one.unit)
        degrees = np.degrees(one.angles)
        crossed = not np.allclose(one.plus, one.minus, rtol=0, atol=1e-3 * largest)
        axes.plot(degrees, one.plus / scale, color=PALETTE[0], lw=1.4, label="+angle" if crossed else "cords")
        if crossed:
            axes.plot(degrees, one.minus / scale, color=PALETTE[1], lw=1.2, ls=(0, (5, 1.5)), label="−angle")
        axes.axhline(one.inflated / scale, color=QUIET, lw=0.9, ls=(0, (1.2, 1.2)), label="inflated")
        axes.axhline(0.0, color=INK, lw=0.5)
        r, z = (1e3 * x for x in one.place)
        what = "cord" if one.unit == "N" else "layer"
        axes.set_title(f"{one.region} (r {r:.0f}, z {z:.0f} mm)", fontsize=FONT, loc="left", color=INK)
        axes.set_ylabel(f"{what} [{unit}]", fontsize=FONT)
        axes.set_xlim(-180, 180)
        axes.set_xticks(range(-180, 181, 60))
        tidy(axes)
        axes.legend(fontsize=FONT - 1.5, frameon=False, loc="lower right", bbox_to_anchor=(1.0, 0.97), ncols=3)
        if number >= len(cords) - 2:
            axes.set_xlabel("angle from the middle of the footprint [°]", fontsize=FONT)
    title(drawn, "Cord tension round the wheel, where it is greatest in each layer", described(found))
    return drawn
