"""Pictures of the road film over speed, of the error of averaging it, and of contact temperatures with slip."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.boundaries.road_film import triangular_film
from tyrefem.reports.figures.style import (
    FONT,
    INK,
    PALETTE,
    QUIET,
    TITLE,
    add_axes,
    figure,
    line_style,
    plain,
    tidy,
    title,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from tyrefem.boundaries.averaging import AveragingError
    from tyrefem.simulation.sliding_outcome import SlidingOutcome

#: Rubber of the paper: W/m/K, J/m3/K.
PAPER = (0.25, 2e6)


#: Small difference of averaged and resolved temperature, K (a judgement: the accuracy of thermocouples).
SMALL = 1.0


def _axes(first: str, second: str) -> tuple[Figure, Axes]:
    drawn = figure(7.2, 4.6 + TITLE)
    axes = add_axes(drawn, 0.75, 0.6, 6.2, 3.8)
    title(drawn, first, second)
    tidy(axes)
    return drawn, axes


def film_figure(lengths: Sequence[float], points: Sequence[tuple[float, float]] = ()) -> Figure:
    """Draw H_c over speed for footprint lengths, m: Cattani et al. 2023, figures 4 and 5.

    ``points``: values of the literature, (m/s, W/m2/K).
    """
    drawn, axes = _axes(
        "Road film coefficient during contact",
        "equation 12 of Cattani et al. 2023, λ = 0.25 W/m/K, C = 2 MJ/m³/K",
    )
    speeds = np.linspace(0.0, 300.0, 301)
    for number, length in enumerate(lengths):
        films = [triangular_film(v / 3.6, length, *PAPER) / 1e3 for v in speeds.tolist()]
        axes.plot(speeds, films, label=f"footprint {length * 1e3:.0f} mm", **line_style(number))
    for number, (speed, film) in enumerate(points):
        label = "" if number else "literature, table 1"
        axes.plot(speed * 3.6, film / 1e3, "o", color="#c1121f", ms=6, label=label or None)
    axes.set_xlim(0, 300)
    axes.set_ylim(bottom=0)
    axes.set_xlabel("speed, km/h", fontsize=FONT, color=INK)
    axes.set_ylabel("$H_c$, kW/m²/K", fontsize=FONT, color=INK)
    axes.legend(fontsize=FONT, frameon=False)
    return drawn


def holds_above(errors: Sequence[AveragingError], small: float = SMALL) -> float | None:
    """Lowest speed of a sweep, m/s, above which averaging always differs by less than ``small`` K."""
    above: float | None = None
    for error in sorted(errors, key=lambda error: -error.point.speed):
        if abs(error.surface_difference) >= small:
            break
        above = error.point.speed
    return above


def averaging_figure(errors: Sequence[AveragingError]) -> Figure:
    """Draw averaged minus resolved mean surface temperature over speed, with a line per footprint length."""
    point = errors[0].point
    inside = "insulated" if point.inner_temperature is None else f"{point.inner_temperature:g} °C"
    drawn, axes = _axes(
        "Error of the tread surface temperature by averaging the road film",
        f"tread {point.thickness * 1e3:g} mm, inside {inside}, road {point.road_temperature:g} °C, "
        f"{point.circumference:g} m around",
    )
    by_length: dict[float, list[Any]] = {}
    for error in errors:
        by_length.setdefault(error.point.footprint_length, []).append(error)
    for number, (length, row) in enumerate(sorted(by_length.items())):
        speeds = [error.point.speed * 3.6 for error in row]
        differences = [error.surface_difference for error in row]
        axes.plot(speeds, differences, label=f"footprint {length * 1e3:.0f} mm", **line_style(number))
    axes.set_xscale("log")
    axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.set_ylim(bottom=0)
    low = axes.get_xlim()[0]
    axes.axhline(SMALL, color=QUIET, lw=0.8, ls="--")
    words = f" above {SMALL:g} K averaging is not valid:\n low speed, long footprint"
    axes.text(low, SMALL, words, fontsize=FONT - 1, color=QUIET, va="top")
    axes.set_xlabel("speed, km/h", fontsize=FONT, color=INK)
    axes.set_ylabel("averaged − resolved, mean surface temperature, K", fontsize=FONT, color=INK)
    axes.legend(fontsize=FONT, frameon=False)
    return drawn


#: Panels in a row, and size of a panel with its margins, inches.
ACROSS, WIDE, HIGH, LEFT, BELOW = 3, 2.5, 2.1, 0.7, 0.5


#: Width that the title and the legend need, inches.
NARROWEST = 6.4
CURVES = (
    ("exit_edge_degC", "exit edge of the contact", PALETTE[1], "-", 1.8),
    ("tread_mean_degC", "mean tread surface", PALETTE[0], "-", 1.8),
    ("half_space_degC", "half-space under a locked wheel", INK, ":", 1.4),
)


def sliding_figure(outcome: SlidingOutcome) -> Figure:
    """Draw exit edge, mean tread surface and (locked) half-space, °C, of every phase; titles give the friction."""
    count = len(outcome.phases)
    across, down = min(count, ACROSS), -(-count // ACROSS)
    wide = max(WIDE, (NARROWEST - 0.3) / across - LEFT)
    cell_w, cell_h = wide + LEFT, HIGH + BELOW + 0.3
    drawn = figure(across * cell_w + 0.3, down * cell_h + TITLE + 0.3)
    title(drawn, outcome.title, "contact with the road in phases with slip")
    limit = outcome.decomposition_temperature
    for number, phase in enumerate(outcome.phases):
        row, place = divmod(number, ACROSS)
        axes = add_axes(drawn, LEFT + place * cell_w, 0.3 + BELOW + (down - 1 - row) * cell_h, wide, HIGH)
        seen = outcome.series[outcome.series.phase == phase.name]
        time = seen.time_s - phase.start
        for name, label, color, dashes, width in CURVES:
            if seen[name].notna().any():
                axes.plot(time, seen[name], label=label, color=color, ls=dashes, lw=width)
        if phase.capped:
            axes.axhline(limit, color=QUIET, lw=0.8, ls="--")
            axes.annotate(
                "decomposition", (0.98, limit), xycoords=("axes fraction", "data"), fontsize=FONT - 2, color=QUIET,
                ha="right", va="bottom",
            )  # fmt: skip
        friction = f"{phase.friction:.2f}" + (f" → {phase.friction_lowest:.2f}" if phase.capped else "")
        axes.set_title(plain(f"{phase.name}: friction {friction}"), fontsize=FONT, color=INK)
        axes.set_xlabel("time in the phase [s]", fontsize=FONT)
        if place == 0:
            axes.set_ylabel("temperature [°C]", fontsize=FONT)
        tidy(axes)
    shown = {label: line for axes in drawn.axes for line, label in zip(*axes.get_legend_handles_labels(), strict=True)}
    drawn.legend(shown.values(), shown.keys(), loc="lower center", ncols=3, fontsize=FONT - 1, frameon=False)
    return drawn
