"""Picture of how heat and strain cycle rise with the speed below a critical speed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from tyrefem.reports.figures.style import FONT, PALETTE, TITLE, add_axes, figure, tidy, title

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from tyrefem.mechanics.rolling.amplification import Amplification


def rise_figure(rises: Sequence[Amplification]) -> Figure:
    """Draw heat and strain over those without inertia, and the effect `standing-wave` that comes nearest."""
    drawn = figure(7.2, 3.8 + TITLE)
    axes = add_axes(drawn, 0.8, 0.6, 6.0, 3.0)
    several = len({amplification.temperature for amplification in rises}) > 1
    for amplification, colour in zip(rises, PALETTE * (1 + len(rises) // len(PALETTE)), strict=False):
        speeds = np.array([rise.speed for rise in amplification.rises])
        label = f"{amplification.pressure / 1e3:.0f} kPa"
        label += f", {amplification.temperature:.4g} °C" if several else ""
        for name, style in (("loss", "o-"), ("strain", "x:")):
            values = [getattr(rise, name) for rise in amplification.rises]
            kind = "heat of a revolution" if name == "loss" else "strain amplitude"
            axes.plot(speeds, values, style, ms=3.5, lw=1.2, color=colour, label=f"{label}, {kind}")
        if amplification.onset is not None:
            fine = np.linspace(0, speeds[-1], 100)
            axes.plot(fine, amplification.onset.factor(fine), "--", lw=0.9, color=colour, label="effect standing-wave")
        if amplification.refused is not None:
            axes.axvline(amplification.refused[0], lw=0.8, color=colour, alpha=0.5)
    axes.set_xlabel("speed [m/s]", fontsize=FONT)
    axes.set_ylabel("over that without inertia", fontsize=FONT)
    axes.set_xlim(left=0)
    tidy(axes)
    axes.legend(fontsize=FONT, frameon=False)
    first = rises[0]
    title(
        drawn,
        f"{first.study.name}: heat rises towards the critical speed",
        f"{first.load / 1e3:.3g} kN; a vertical line: no solution from this speed on",
    )
    return drawn
