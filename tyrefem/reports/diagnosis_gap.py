"""The first picture of a diagnosis: measured - computed per sensor and run, before and after, with the noise."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tyrefem.diagnose.data.residual_tables import rms
from tyrefem.diagnose.words.result_tables import rms_table
from tyrefem.reports.figures.style import (
    FONT,
    INK,
    PALETTE,
    QUIET,
    TITLE,
    add_axes,
    figure,
    panel_title,
    short,
    tidy,
    title,
)

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from tyrefem.diagnose.data.runs import MeasuredDrive, MeasuredSensor
    from tyrefem.diagnose.diagnosis import DiagnosisData

Array = NDArray[np.float64]
BEFORE, AFTER = PALETTE[1], PALETTE[0]
#: Background of held-out runs.
HELD_OUT = "#f6f3e4"
#: A bar goes from the lower to the upper of these percentiles of the block means.
LOW, HIGH = 5.0, 95.0
#: Half width of the noise band, standard deviations.
BAND = 2.0
#: Width that is kept free for the rms, inches.
WRITTEN = 0.78


def gap_figure(d: DiagnosisData, width: float = 9.4, most_runs: int = 99, most_sensors: int = 99) -> Figure:
    """Draw a panel per run, a row per sensor: bars of measured - computed of both studies over the band of noise.

    A bar spans 90 % of the means of neighbouring readings, its dot is their mean. The band is two standard deviations
    of such a mean, from noise and discrepancy. The numbers are the rms of the readings before and after, K.

    ``width``: of the figure, inches. ``most_runs``, ``most_sensors``: so many with the largest gaps are drawn.
    """
    table = rms_table(d)
    sensors = _largest(table, "sensor", most_sensors)
    kept = _largest(table, "run", most_runs)
    runs = [(number, run) for number, run in enumerate(d.gap.runs) if run.name in kept]
    left = 0.25 + 0.068 * max(len(short(name, 20)) for name in sensors)
    columns = min(len(runs), max(int((width - left) / 1.45), 1))
    rows = math.ceil(len(runs) / columns)
    step_x, high = (width - left - 0.1) / columns, 0.30 * len(sensors) + 0.12
    step_y = high + 0.5
    drawn = figure(width, rows * step_y + TITLE + 0.16)
    limits = _limits(d, [number for number, _ in runs], sensors)
    for place, (number, run) in enumerate(runs):
        row, column = divmod(place, columns)
        axes = add_axes(drawn, left + column * step_x, 0.46 + (rows - 1 - row) * step_y, step_x - 0.16, high)
        _panel(axes, d, number, sensors, limits, step_x - 0.16)
        held = " (held out)" if run.hold_out else ""
        panel_title(axes, f"{short(run.name, 16)}{held}")
        if column:
            axes.tick_params(labelleft=False)
        if place + columns >= len(runs):
            axes.set_xlabel("[K]", fontsize=FONT)
    left_out = _left_out(table, sensors, kept)
    title(drawn, "The gap before and after", f"measured - computed; numbers: rms, original → amended [K]{left_out}")
    _legend(drawn)
    return drawn


def _largest(table: pd.DataFrame, column: str, most: int) -> list[str]:
    """Names of the runs or sensors with the largest gaps, in the order of the table."""
    names = list(dict.fromkeys(table[column]))
    largest = table.groupby(column)["before_K"].max().sort_values(ascending=False, kind="stable").index[:most]
    return [name for name in names if name in set(largest)]


def _left_out(table: pd.DataFrame, sensors: list[str], runs: list[str]) -> str:
    """Which share is drawn, if it is not all."""
    parts = [
        f"{len(kept)} of {table[column].nunique()} {column}s"
        for column, kept in (("sensor", sensors), ("run", runs))
        if len(kept) < table[column].nunique()
    ]
    return f"; drawn: the largest gaps, {', '.join(parts)}" if parts else ""


def _limits(d: DiagnosisData, numbers: list[int], sensors: list[str]) -> tuple[float, float]:
    """Common limits of all panels, K; the band of noise is always seen whole."""
    ends = []
    for number in numbers:
        run = d.gap.runs[number]
        for readings in run.sensors:
            if readings.sensor in sensors:
                ends += [BAND * _sd(readings), -BAND * _sd(readings)]
                ends += [end for computed in (d.before, d.after) for end in _span(run, computed[number], readings)[:2]]
    finite = [end for end in ends if math.isfinite(end)]
    room = 0.05 * (max(finite) - min(finite))
    return min(finite) - room, max(finite) + room


def _span(run: MeasuredDrive, computed: Array, readings: MeasuredSensor) -> tuple[float, float, float]:
    """(lower end, upper end, mean) of measured - computed of a sensor, K; the mean weighs readings alike."""
    gap = (run.measured - computed)[run.parts()[readings.sensor]]
    low, high = np.percentile(gap, [LOW, HIGH])
    return float(low), float(high), float(np.average(gap, weights=readings.sizes))


def _sd(readings: MeasuredSensor) -> float:
    """Standard deviation of the mean of a block of readings, from noise and discrepancy, K; rms over the blocks."""
    return float(np.sqrt(np.mean(np.diag(readings.covariance))))


def _panel(
    axes: Axes, d: DiagnosisData, number: int, sensors: list[str], limits: tuple[float, float], width: float
) -> None:
    """Draw one run on axes of this width, inches; the numbers stand at the right of the limits."""
    from matplotlib.ticker import MaxNLocator

    run = d.gap.runs[number]
    if run.hold_out:
        axes.set_facecolor(HELD_OUT)
    for readings in run.sensors:
        if readings.sensor not in sensors:
            continue
        y, band = sensors.index(readings.sensor), BAND * _sd(readings)
        axes.fill_between([-band, band], y - 0.46, y + 0.46, color=QUIET, alpha=0.28, lw=0, zorder=1)
        for shift, computed, color in ((-0.17, d.before, BEFORE), (0.17, d.after, AFTER)):
            low, high, mean = _span(run, computed[number], readings)
            axes.barh(y + shift, high - low, left=low, height=0.26, color=color, alpha=0.85, zorder=3)
            axes.plot(mean, y + shift, ".", color=INK, ms=4.5, zorder=4)
        before, after = (rms(d.gap, computed, [number], readings.sensor) for computed in (d.before, d.after))
        axes.annotate(
            f"{before:.1f} → {after:.1f}", (0.985, y), xycoords=("axes fraction", "data"), fontsize=FONT - 1,
            ha="right", va="center", color=INK, zorder=5,
        )  # fmt: skip
    axes.axvline(0.0, color=INK, lw=0.6, zorder=2)
    axes.set_yticks(range(len(sensors)), [short(sensor, 20) for sensor in sensors])
    axes.set_ylim(len(sensors) - 0.45, -0.55)
    low, high = limits
    # About an inch for three ticks.
    many = max(round(3 * (width - WRITTEN)), 2)
    ticks = [tick for tick in MaxNLocator(many, steps=[1, 2, 5, 10]).tick_values(low, high) if low <= tick <= high]
    axes.set_xticks(ticks)
    axes.set_xlim(low, low + width / (width - WRITTEN) * (high - low))
    tidy(axes)
    axes.grid(axis="y", visible=False)


def _legend(drawn: Figure) -> None:
    from matplotlib.patches import Patch

    handles = [
        Patch(color=BEFORE, alpha=0.85, label="original"),
        Patch(color=AFTER, alpha=0.85, label="amended"),
        Patch(color=QUIET, alpha=0.28, lw=0, label="noise ± 2 sd"),
    ]
    width, height = drawn.get_size_inches()
    drawn.legend(
        handles=handles, loc="upper right", bbox_to_anchor=(1 - 0.05 / width, 1 - 0.02 / height), ncols=3,
        fontsize=FONT, frameon=False, handlelength=1.4, columnspacing=1.0,
    )  # fmt: skip
