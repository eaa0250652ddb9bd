"""Pictures of the runs of a diagnosis: measured readings, both curves, and the deviations of both over time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.reports.diagnosis_gap import AFTER, BEFORE, HELD_OUT
from tyrefem.reports.figures.phases import Phase, draw_phases, make_room
from tyrefem.reports.figures.style import (
    FONT,
    INK,
    QUIET,
    TITLE,
    add_axes,
    figure,
    legend,
    panel_title,
    png,
    short,
    tidy,
    time_unit,
    title,
)
from tyrefem.reports.words import history_files

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from tyrefem.diagnose.data.runs import MeasuredDrive, MeasuredSensor
    from tyrefem.diagnose.diagnosis import DiagnosisData

Array = NDArray[np.float64]
#: Most readings of a sensor that are drawn.
MOST_READINGS = 300


@dataclass(frozen=True, eq=False)
class RunHistory:
    """What is drawn of a run: the readings, block means of both studies in degC, and the phases up to the last reading.

    ``phases``: name, start and end, s.
    """

    run: MeasuredDrive
    before: Array
    after: Array
    phases: Sequence[Phase]

    @classmethod
    def of(cls, d: DiagnosisData, number: int) -> RunHistory:
        """The history of the run with this number."""
        run, drive = d.gap.runs[number], d.gap.driven(number).card.drive
        last = _last(run)
        phases = [
            (phase.name, start, min(start + phase.duration, last))
            for start, phase in zip(drive.starts, drive.phases, strict=True)
            if start < last
        ]
        return cls(run, d.before[number], d.after[number], phases)


def _last(run: MeasuredDrive) -> float:
    """Time of the last reading, s."""
    return max(float(series.times[-1]) for series in run.sensors)


def history_pictures(histories: Sequence[RunHistory]) -> dict[str, bytes]:
    """File name -> PNG, for every run; a diagnosis lets a worker draw them."""
    files = history_files(history.run.name for history in histories)
    return {file: png(histories_figure(history)) for file, history in zip(files, histories, strict=True)}


def histories_figure(history: RunHistory) -> Figure:
    """Draw a panel per sensor: measured readings and both curves, with the deviations of both below."""
    run = history.run
    columns = min(3, len(run.sensors))
    rows = math.ceil(len(run.sensors) / columns)
    wide, high, low = 3.0 if columns > 2 else 4.2, 1.75, 0.8
    left, step_x, step_y = 0.75, wide + 0.42, high + low + 0.72
    drawn = figure(left + columns * step_x, rows * step_y + TITLE + 0.12)
    divisor, unit = time_unit(_last(run))
    spans = _spans(history)
    phases = [(name, start / divisor, end / divisor) for name, start, end in history.phases]
    for place, series in enumerate(run.sensors):
        row, column = divmod(place, columns)
        bottom = 0.5 + (rows - 1 - row) * step_y
        lower = add_axes(drawn, left + column * step_x, bottom, wide, low)
        upper = add_axes(drawn, left + column * step_x, bottom + low + 0.08, wide, high)
        _draw(history, series, upper, lower, divisor)
        upper.set_ylim(*spans[0])
        lower.set_ylim(*spans[1])
        make_room(upper, phases)
        draw_phases(upper, phases, shaded=False)
        draw_phases(lower, phases, names=False, shaded=False)
        upper.tick_params(labelbottom=False)
        if column == 0:
            upper.set_ylabel("temperature [°C]", fontsize=FONT)
            lower.set_ylabel("measured -\ncomputed [K]", fontsize=FONT - 1)
        else:
            upper.tick_params(labelleft=False)
            lower.tick_params(labelleft=False)
        if place + columns >= len(run.sensors):
            lower.set_xlabel(f"time [{unit}]", fontsize=FONT)
    held = "held out: used in no fit" if run.hold_out else "fitted"
    title(drawn, f"{run.name} ({held})", "")
    _legend(drawn)
    return drawn


def _legend(drawn: Figure) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = [Line2D([], [], ls="", marker=".", color=QUIET, label="measured")]
    for name, color in (("original", BEFORE), ("amended", AFTER)):
        handles.append(Line2D([], [], color=color, lw=1.6, ls=_dashes(color), label=name))
    handles.append(Patch(color=QUIET, alpha=0.2, lw=0, label="noise ± 1 sd of a block"))
    legend(drawn, handles)


def _dashes(color: str) -> Any:
    return (0, (4, 1.5)) if color == BEFORE else "-"


def _spans(history: RunHistory) -> tuple[tuple[float, float], tuple[float, float]]:
    """Common axis limits of temperature and deviation for all sensors of a run."""
    measured = history.run.measured
    values = np.concatenate([measured, history.before, history.after])
    left = np.concatenate([measured - history.before, measured - history.after, [0.5, -0.5]])
    return tuple(  # type: ignore[return-value]
        (float(curve.min() - 0.06 * np.ptp(curve)), float(curve.max() + 0.06 * np.ptp(curve)))
        for curve in (values, left)
    )


def _draw(history: RunHistory, series: MeasuredSensor, upper: Axes, lower: Axes, divisor: float) -> None:
    run = history.run
    place = run.parts()[series.sensor]
    t = series.block_times / divisor
    step = max(1, math.ceil(len(series.times) / MOST_READINGS))
    upper.plot(series.times[::step] / divisor, series.measured[::step], ".", color=QUIET, ms=2.6, alpha=0.8, zorder=2)
    noise = series.noise / np.sqrt(series.sizes)
    lower.fill_between(t, -noise, noise, color=QUIET, alpha=0.2, lw=0, zorder=1)
    lower.axhline(0.0, color=INK, lw=0.6, zorder=1)
    for computed, color in ((history.before[place], BEFORE), (history.after[place], AFTER)):
        upper.plot(t, computed, color=color, lw=1.5, ls=_dashes(color), zorder=3)
        lower.plot(t, run.measured[place] - computed, color=color, lw=1.2, ls=_dashes(color), zorder=3)
    for axes in (upper, lower):
        tidy(axes)
        axes.set_xlim(0.0, _last(run) / divisor)
        if run.hold_out:
            axes.set_facecolor(HELD_OUT)
    panel_title(upper, short(series.sensor, 34))
