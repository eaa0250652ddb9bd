"""Pictures of sliding heat: a locked wheel over speed, and table 2 measured and predicted."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from tyrefem.boundaries.friction_rise import MEAN_OF_EXIT
from tyrefem.boundaries.friction_tables import WoodRow
from tyrefem.boundaries.skid import MILD, SEVERE, LockedWheel
from tyrefem.reports.figures.style import FONT, INK, PALETTE, QUIET, add_axes, figure, tidy, title

if TYPE_CHECKING:
    from matplotlib.figure import Figure

KMH = 3.6


def locked_wheel_figure(car: LockedWheel) -> Figure:
    """Draw temperature rise and coefficient of friction of a locked wheel from 0 to 150 km/h.

    >>> len(locked_wheel_figure(LockedWheel()).axes)
    2
    """
    drawn = figure(9.2, 4.5)
    words = f"friction {car.friction:g}, {car.pressure / 1e3:g} kPa on the rubber, {car.length * 1e3:g} mm long"
    title(drawn, "Locked wheel on asphalt", f"estimates: {words}")
    kmh = np.linspace(0.5, 150.0, 300)
    speeds = [float(v) for v in kmh / KMH]
    rise, grip = add_axes(drawn, 0.7, 0.55, 4.5, 3.25), add_axes(drawn, 6.0, 0.55, 2.95, 3.25)
    low, high = (MEAN_OF_EXIT * np.array([w.uncapped_exit_rise(v) for v in speeds]) for w in (MILD, SEVERE))
    rise.fill_between(kmh, low, high, color="#e6e6e6", lw=0, label="mean, uncapped: mildest to most severe estimate")
    free = np.array([car.uncapped_exit_rise(v) for v in speeds])
    rise.plot(kmh, free, color=PALETTE[1], ls="--", lw=1.2, label="exit edge, friction unchanged (12)")
    capped = np.array([car.exit_rise(v) for v in speeds])
    rise.plot(kmh, capped, color=PALETTE[1], lw=2, label="exit edge, capped by decomposition (13)")
    rise.plot(kmh, MEAN_OF_EXIT * free, color=PALETTE[0], ls="--", lw=1.2, label="mean over the contact, unchanged")
    rise.plot(kmh, MEAN_OF_EXIT * capped, color=PALETTE[0], lw=2, label="mean over the contact, capped")
    rise.plot([50, 150], [200, 200], color=INK, lw=1, ls=":", label="Roberts: can exceed 200 K above 50 km/h")
    rise.axvline(50.0, color=INK, lw=0.6, ls=":")
    rise.set_ylim(0, 1.8 * max(float(free[-1]), float(high[-1]) / 1.3))
    rise.set_ylabel("temperature rise [K]", fontsize=FONT)
    rise.legend(fontsize=FONT - 1.5, loc="upper left", framealpha=1.0, edgecolor="none")
    for name, wheel, color, dashes, width in (
        ("mild", MILD, QUIET, "--", 1.0),
        ("chosen", car, PALETTE[0], "-", 2.0),
        ("severe", SEVERE, QUIET, ":", 1.0),
    ):
        grip.plot(kmh, [wheel.friction_at(v) for v in speeds], label=name, color=color, ls=dashes, lw=width)
    grip.set_ylim(0, max(1.1, 1.1 * car.friction))
    grip.set_ylabel("friction coefficient, at most (13)", fontsize=FONT)
    grip.legend(
        fontsize=FONT - 1.5,
        framealpha=1.0,
        edgecolor="none",
        loc="upper right",
        title="estimates",
        title_fontsize=FONT - 1.5,
    )
    for axes in (rise, grip):
        axes.set_xlim(0, 150)
        axes.set_xlabel("speed [km/h]", fontsize=FONT)
        tidy(axes)
    return drawn


def wood_figure(rows: tuple[WoodRow, ...]) -> Figure:
    """Draw measured rise, the paper's prediction and equations 3 and 4 for every row of table 2."""
    drawn = figure(7.6, 3.9)
    title(drawn, "Rubber on wood, Roberts table 2", "rise 15 mm behind the pad; bars: observed uncertainty")
    axes = add_axes(drawn, 0.7, 0.75, 6.7, 2.4)
    place = np.arange(len(rows), dtype=float)
    axes.errorbar(
        place - 0.2, [row.observed for row in rows], yerr=[row.uncertainty for row in rows],
        fmt="o", ms=6, color=PALETTE[0], capsize=3, label="measured",
    )  # fmt: skip
    axes.plot(place, [row.printed for row in rows], "D", ms=6, color=PALETTE[5], label="printed prediction")
    axes.plot(place + 0.2, [row.predicted for row in rows], "s", ms=6, color=PALETTE[1], label="equations 3 and 4")
    for at, row in zip(place, rows, strict=True):
        if not row.follows:
            axes.axvspan(at - 0.45, at + 0.45, color="#f1f1f1", lw=0, zorder=0)
    axes.set_yscale("log")
    axes.set_yticks([1, 2, 5, 10, 20, 50], ["1", "2", "5", "10", "20", "50"])
    axes.set_ylabel("rise [K]", fontsize=FONT)
    labels = [f"{row.length * 1e3:g}×{row.breadth * 1e3:g}\n{row.speed:g} m/s" for row in rows]
    axes.set_xticks(place, labels)
    words = "pad length × breadth [mm], speed; grey: the printed prediction does not follow from its inputs"
    axes.set_xlabel(words, fontsize=FONT)
    tidy(axes)
    axes.legend(fontsize=FONT - 1, frameon=False, loc="upper left")
    return drawn
