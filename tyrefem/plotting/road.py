"""Pictures of the road film: against speed as Cattani et al. drew it, and what averaging it costs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.plotting.style import FONT, INK, QUIET, TITLE, add_axes, figure, line_style, tidy, title
from tyrefem.road_contact import triangular_film

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from tyrefem.revolution import AveragingError

#: Rubber of the paper: W/m/K, J/m3/K.
PAPER = (0.25, 2e6)
#: Averaged against resolved: what is still called small, K (a judgement; thermocouples read to about that).
SMALL = 1.0


def _axes(first: str, second: str) -> tuple[Figure, Axes]:
    drawn = figure(7.2, 4.6 + TITLE)
    axes = add_axes(drawn, 0.75, 0.6, 6.2, 3.8)
    title(drawn, first, second)
    tidy(axes)
    return drawn, axes


def film_figure(lengths: Sequence[float], points: Sequence[tuple[float, float]] = ()) -> Figure:
    """H_c against speed for footprint lengths (m), Cattani et al. 2023, figures 4 and 5.

    ``points`` are values of the literature, (m/s, W/m2/K).
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
    """Lowest speed of a sweep, m/s, from which averaging differs by less than ``small`` K up to its highest speed."""
    above: float | None = None
    for error in sorted(errors, key=lambda error: -error.point.speed):
        if abs(error.surface_difference) >= small:
            break
        above = error.point.speed
    return above


def averaging_figure(errors: Sequence[AveragingError]) -> Figure:
    """Averaged minus resolved mean surface temperature against speed, a line per footprint length."""
    point = errors[0].point
    inside = "insulated" if point.inner_temperature is None else f"{point.inner_temperature:g} °C"
    drawn, axes = _axes(
        "Tread surface too warm by averaging the road film",
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
    words = f" above {SMALL:g} K averaging does not hold:\n low speed, long footprint"
    axes.text(low, SMALL, words, fontsize=FONT - 1, color=QUIET, va="top")
    axes.set_xlabel("speed, km/h", fontsize=FONT, color=INK)
    axes.set_ylabel("averaged − resolved, mean surface temperature, K", fontsize=FONT, color=INK)
    axes.legend(fontsize=FONT, frameon=False)
    return drawn
