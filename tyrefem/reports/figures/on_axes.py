"""Pictures of a run on matplotlib axes of the user's, to be arranged and annotated at will."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from tyrefem.errors import InputError, nearest
from tyrefem.reports.figures.canvas import draw_outlines, sides
from tyrefem.reports.figures.cells import triangles
from tyrefem.reports.figures.style import (
    FONT,
    INK,
    line_style,
    millimetres,
    plain,
    section_axes,
    temperature_map,
    tidy,
    time_unit,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from tyrefem.simulation.result import ResultData

#: Size of a new figure, inches.
SIZE = (7.5, 5.0)


def draw(result: ResultData, picture: str, time: float | None = None, axes: Axes | None = None) -> Axes:
    """Draw a picture of `PICTURES` on axes; None: on those of a new figure of pyplot. Returns the axes.

    Raises
    ------
    InputError : no such picture; a time outside the run.
    """
    if picture not in list(PICTURES):
        raise InputError(f"no picture '{picture}'{nearest(picture, PICTURES)}", field="picture")
    i = result.reading_at(time)
    if axes is None:
        from matplotlib import pyplot

        _, axes = pyplot.subplots(figsize=SIZE, layout="constrained")
    PICTURES[picture](axes, result, i)
    return axes


def draw_temperature(axes: Axes, result: ResultData, i: int) -> None:
    """The section's temperature at ``times[i]`` with its colour bar, both sides of the tyre, and the sensors."""
    operators, section = result.tyre.problem.operators, result.study.section
    corners, _ = triangles(operators)
    x, y = millimetres(operators.points.T)
    values = np.asarray(result.history.values[i])
    low, high = float(values.min()), float(values.max())
    if high - low < 0.01:
        low, high = low - 0.5, high + 0.5
    for sign in sides(section):
        image = axes.tripcolor(
            sign * x, y, corners, values, shading="gouraud", cmap=temperature_map(), vmin=low, vmax=high,
            rasterized=True,
        )  # fmt: skip
    draw_outlines(axes, section, color="#404040", width=0.7)
    if result.sensor_places:
        places = millimetres(list(result.sensor_places.values()))
        axes.plot(*places, "o", ms=FONT / 2, mfc="white", mec=INK, mew=1.0, zorder=7)
    bar = axes.figure.colorbar(image, ax=axes)
    bar.set_label("temperature [°C]", fontsize=FONT)
    section_axes(axes)
    axes.set_title(_title(result, f"{result.times[i]:g} s, at most {values.max():.1f} °C"), fontsize=FONT + 1)


def draw_histories(axes: Axes, result: ResultData, i: int) -> None:
    """Readings of all sensors, contained air and rim over time, up to ``times[i]``."""
    readings = result.readings.iloc[: i + 1]
    divisor, unit = time_unit(float(result.times[-1]))
    names = [name for name in readings.columns if name != "time_s"]
    for number, name in enumerate(names):
        axes.plot(readings["time_s"] / divisor, readings[name], lw=1.5, label=plain(name), **line_style(number))
    axes.set_xlabel(f"time [{unit}]", fontsize=FONT)
    axes.set_ylabel("temperature [°C]", fontsize=FONT)
    axes.legend(fontsize=FONT - 1, frameon=False)
    tidy(axes)
    axes.set_title(_title(result, "readings"), fontsize=FONT + 1)


def draw_heat(axes: Axes, result: ResultData, i: int) -> None:
    """Power generated, stored and lost over time, up to ``times[i]``."""
    budget = result.heat_budget
    divisor, unit = time_unit(float(result.times[-1]))
    kinds = dict.fromkeys(kind for kind, _ in budget.powers)
    for number, kind in enumerate(kinds):
        axes.plot(
            result.times[: i + 1] / divisor, budget.power(kind)[: i + 1], lw=1.5, label=kind, **line_style(number)
        )
    axes.set_xlabel(f"time [{unit}]", fontsize=FONT)
    axes.set_ylabel("power [W]", fontsize=FONT)
    axes.legend(fontsize=FONT - 1, frameon=False)
    tidy(axes)
    axes.set_title(_title(result, "heat of the whole tyre"), fontsize=FONT + 1)


def _title(result: ResultData, words: str) -> str:
    return f"{plain(result.study.title)}\n{words}"


#: Picture -> function that draws it on axes, of a result up to a reading.
PICTURES: dict[str, Callable[[Axes, ResultData, int], None]] = {
    "temperature": draw_temperature,
    "histories": draw_histories,
    "heat": draw_heat,
}
