"""Picture of the section's temperature at one time, with thermocouples and the hottest point."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.reports.figures.canvas import (
    Canvas,
    canvas,
    draw_outlines,
    halo,
    marks,
    region_labels,
    sensor_labels,
    sides,
)
from tyrefem.reports.figures.cells import triangles
from tyrefem.reports.figures.style import EVEN, FONT, INK, Label, millimetres, short, temperature_map, time_unit, title

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from tyrefem.simulation.result import ResultData

Array = NDArray[np.float64]


def temperature_figure(result: ResultData, time: float | None = None) -> Figure:
    """Draw the temperature, °C, at the reading time nearest to ``time``, s; default: the last.

    Left of the mid plane: isotherms and regions; right: the thermocouples' readings, if there are any. A half section
    is shown with its mirror image.
    """
    times = result.times
    i = len(times) - 1 if time is None else int(np.argmin(np.abs(times - time)))
    section = result.study.section
    temperatures = np.asarray(result.history.values[i])
    texts = {name: f"{short(name)} {result.recorded[name][i]:.1f} °C" for name in result.sensor_places}
    inside, left, right = sensor_labels(section, result.sensor_places, texts)
    hottest = _hottest(result, temperatures)
    names = region_labels(section)
    drawn = canvas(section, [label.text for label in [*names, *left]], [label.text for label in right])
    _map(drawn, result, temperatures)
    draw_outlines(drawn.axes, section, color="#404040", width=0.7)
    marks(drawn.axes, [*inside, *left, *right])
    if np.ptp(temperatures) > EVEN:
        drawn.axes.plot([hottest.x], [hottest.y], "*", ms=12, mfc="white", mec=INK, mew=1.0, zorder=8)
        inside = [hottest, *inside]
    drawn.inside(inside)
    drawn.beside(right, 1.0)
    drawn.beside(sorted([*names, *left], key=lambda label: -label.y), -1.0)
    divisor, unit = time_unit(float(times[-1]))
    stopped = " (run interrupted)" if result.history.interrupted and i == len(times) - 1 else ""
    title(drawn.figure, result.study.title, f"temperature after {times[i] / divisor:.4g} {unit}{stopped}")
    return drawn.figure


def _hottest(result: ResultData, temperatures: Array) -> Label:
    node = int(np.argmax(temperatures))
    x, y = millimetres(result.history.points[:, node])
    return Label(f"hottest {temperatures[node]:.1f} °C", float(x), float(y), bold=True)


def _map(drawn: Canvas, result: ResultData, temperatures: Array) -> None:
    from matplotlib.ticker import MaxNLocator

    axes, operators = drawn.axes, result.tyre.problem.operators
    corners, _ = triangles(operators)
    x, y = millimetres(operators.points.T)
    low, high = float(temperatures.min()), float(temperatures.max())
    even = high - low < EVEN
    if even:
        low, high = low - 0.5, high + 0.5
    image: Any = None
    colours = temperature_map()
    for sign in sides(drawn.section):
        image = axes.tripcolor(
            sign * x, y, corners, temperatures, shading="gouraud", cmap=colours, vmin=low, vmax=high,
            rasterized=True, zorder=1,
        )  # fmt: skip
    levels = [level for level in MaxNLocator(8, steps=[1, 2, 5, 10]).tick_values(low, high) if low < level < high]
    bar = drawn.color_bar(image, "temperature [°C]", ticks=levels)
    bar.ax.hlines(levels, 0, 1, color="white", lw=0.6, transform=bar.ax.get_yaxis_transform())
    if even:
        return
    mirrored = -x if drawn.section.half else x
    lines = axes.tricontour(mirrored, y, corners, temperatures, levels=levels, colors="white", linewidths=0.6, zorder=2)
    decimals = max(0, int(np.ceil(-np.log10(levels[1] - levels[0]) - 1e-9))) if len(levels) > 1 else 1
    written = axes.clabel(lines, fmt=f"%.{decimals}f", fontsize=FONT - 1.5, inline=False, colors=INK)
    for text in written or ():
        text.set_path_effects(halo())
