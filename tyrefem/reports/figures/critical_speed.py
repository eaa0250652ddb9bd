"""Picture of the speeds at which waves stand, and of the section moved by such a wave."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from tyrefem.reports.figures.style import FONT, PALETTE, QUIET, TITLE, add_axes, figure, tidy, title

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from tyrefem.mechanics.rolling.critical_speed import CriticalSpeed

#: Largest motion of the drawn wave over the section's height.
DRAWN = 0.12


def critical_speed_figure(results: Sequence[CriticalSpeed]) -> Figure:
    """Draw the speed of standing waves over their number round the wheel, and the slowest wave of the belt."""
    drawn = figure(10.4, 3.8 + TITLE)
    speeds, section = add_axes(drawn, 0.8, 0.6, 4.6, 3.0), add_axes(drawn, 5.9, 0.3, 4.2, 3.4)
    for result, colour in zip(results, PALETTE * (1 + len(results) // len(PALETTE)), strict=False):
        label = f"{result.pressure / 1e3:.0f} kPa"
        label += "" if result.temperature is None else f", {result.temperature:.4g} °C"
        for standing, style, kind in ((result.belt, "o-", "of the belt"), (result.any_wave, "x--", "of any part")):
            if standing is not None:
                orders, values = list(standing.by_harmonic), list(standing.by_harmonic.values())
                speeds.plot(orders, values, style, ms=3.5, lw=1.2, color=colour, label=f"{label}, {kind}")
    speeds.set_xlabel("waves round the wheel", fontsize=FONT)
    speeds.set_ylabel("speed at which the wave stands [m/s]", fontsize=FONT)
    speeds.set_ylim(bottom=0)
    tidy(speeds)
    if speeds.get_legend_handles_labels()[0]:
        speeds.legend(fontsize=FONT, frameon=False)
    wave = _draw_wave(section, results[0])
    title(drawn, f"{results[0].study.name}: waves that stand still while the tyre turns", wave)
    return drawn


def _draw_wave(axes: Axes, result: CriticalSpeed) -> str:
    """Draw the section and its wave; return what the wave is."""
    from matplotlib.collections import PolyCollection

    axes.set_axis_off()
    standing = result.belt or result.any_wave
    if standing is None:
        return "none was found"
    elements = standing.tyre.body.rings
    corners, nodes = elements.element_nodes[:, :4], standing.tyre.places
    motion = standing.wave.shape.reshape(-1, 3)
    scale = DRAWN * float(nodes[0].max() - nodes[0].min()) / float(abs(motion[:, :2]).max())
    for side in (1,) if standing.wave.symmetric is None else (1, -1):
        sign = 1.0 if side == 1 or standing.wave.symmetric else -1.0
        for moved, face, edge in ((0.0, "0.93", QUIET), (scale, "none", PALETTE[0])):
            z = side * (nodes[1] + moved * sign * motion[:, 1])
            r = nodes[0] + moved * sign * motion[:, 0]
            cells = [list(zip(z[cell], r[cell], strict=True)) for cell in corners]
            axes.add_collection(PolyCollection(cells, facecolors=face, edgecolors=edge, linewidths=0.5))
    axes.autoscale_view()
    axes.set_aspect("equal")
    part = "the belt" if result.belt is not None else "any part"
    return (
        f"section: the slowest wave of {part} at {result.pressure / 1e3:.0f} kPa, {standing.harmonic} waves round the "
        f"wheel at {standing.speed:.1f} m/s"
    )
