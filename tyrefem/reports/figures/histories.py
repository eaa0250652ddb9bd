"""Picture of temperatures over time: thermocouples, contained air, lumped rim; and of the speed if it varies."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from tyrefem.inputs.motion import motion_in
from tyrefem.reports.figures.phases import draw_phases, make_room
from tyrefem.reports.figures.style import (
    EVEN,
    FONT,
    INK,
    QUIET,
    TITLE,
    Label,
    add_axes,
    figure,
    line_ends,
    line_style,
    short,
    tidy,
    time_unit,
    title,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from tyrefem.simulation.result import ResultData

#: Margins left of, right of and below the axes; heights of the temperature and speed axes, inches.
LEFT, RIGHT, BELOW, HIGH, LOW = 0.75, 2.5, 0.55, 3.6, 0.9


def histories_figure(result: ResultData) -> Figure:
    """Draw readings, °C, over time with the phases of the drive; below, the speed, m/s, if it varies."""
    times = result.times
    last = float(times[-1])
    divisor, unit = time_unit(last)
    shown = [phase for phase in result.phases if phase.start < last] or [result.phases[0]]
    bands = [(phase.name, phase.start / divisor, min(phase.end, last) / divisor) for phase in shown]
    t_speed, v_speed = _speed(result, last)
    varies = float(np.ptp(v_speed)) > 0
    below = BELOW + (LOW + 0.18 if varies else 0.0)
    drawn = figure(10.0, below + HIGH + TITLE)
    axes = add_axes(drawn, LEFT, below, 10.0 - LEFT - RIGHT, HIGH)
    labels = _lines(axes, result, divisor)
    low, high = axes.get_ylim()
    if high - low < EVEN:  # rounding errors are no history
        low, high = (low + high) / 2 - 0.5, (low + high) / 2 + 0.5
    axes.set_ylim(low, high + 0.02 * (high - low))
    make_room(axes, bands)
    axes.set_ylabel("temperature [°C]", fontsize=FONT)
    lowest = axes
    if varies:
        lowest = add_axes(drawn, LEFT, BELOW, 10.0 - LEFT - RIGHT, LOW)
        lowest.plot(t_speed / divisor, v_speed, color=INK, lw=1.2)
        lowest.fill_between(t_speed / divisor, v_speed, color=INK, alpha=0.08, lw=0)
        lowest.set_ylim(0, 1.15 * float(v_speed.max()))
        lowest.set_ylabel("speed [m/s]", fontsize=FONT)
        axes.tick_params(labelbottom=False)
    for panel in {axes, lowest}:
        draw_phases(panel, bands, names=panel is axes)
        tidy(panel)
        panel.set_xlim(0.0, max(last / divisor, 1e-9))
    lowest.set_xlabel(f"time [{unit}]", fontsize=FONT)
    line_ends(axes, labels, room=RIGHT)
    speed = "" if varies else f", {v_speed[0]:.3g} m/s"
    stopped = ", run interrupted" if result.history.interrupted else ""
    what = "thermocouple readings and contained air" if result.sensor_places else "contained air (no thermocouples)"
    title(drawn, result.study.title, f"{what}{speed}{stopped}")
    return drawn


def _lines(axes: Axes, result: ResultData, divisor: float) -> list[Label]:
    """Draw every column of the readings; return the labels for their ends."""
    readings = result.reading_columns
    t = readings["time_s"] / divisor
    sensors = list(result.sensor_places)
    labels = []
    for number, name in enumerate(sensors):
        values = readings[name]
        style = line_style(number)
        axes.plot(t, values, lw=1.5, **style)
        labels.append(
            Label(f"{short(name, 24)} {values[-1]:.1f} °C", float(t[-1]), float(values[-1]), color=style["color"])
        )
    for number, name in enumerate(column for column in readings if column not in ("time_s", *sensors)):
        values = readings[name]
        axes.plot(t, values, color=QUIET, lw=2.4, ls=("-", ":")[number % 2], alpha=0.75)
        text = f"{name.replace('-', ' ')} {values[-1]:.1f} °C"
        labels.append(Label(text, float(t[-1]), float(values[-1]), bold=True, color=QUIET))
    return labels


def _speed(result: ResultData, last: float) -> tuple[np.ndarray, np.ndarray]:
    """Corner points (time s, speed m/s) of the drive, with its jumps, up to ``last``."""
    drive = result.study.card.drive
    times: list[float] = []
    speeds: list[float] = []
    for start, phase in zip(drive.starts, drive.phases, strict=True):
        end = min(start + phase.duration, last)
        if start > last or (start == last and times):
            break
        times += [start, end]
        speeds += [motion_in(phase, (time - start) / phase.duration).speed for time in (start, end)]
    return np.array(times), np.array(speeds)
