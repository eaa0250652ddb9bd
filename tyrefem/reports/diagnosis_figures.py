"""Pictures of a diagnosis: rms before and after, histories with both curves, probabilities."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.diagnose.data.runs import MeasuredDrive, MeasuredSensor
from tyrefem.diagnose.numbers import percent
from tyrefem.diagnose.unknowns.candidates import key_of
from tyrefem.diagnose.words.result_tables import candidate_rows, rms_table, set_rows
from tyrefem.reports.diagnosis_energy import energy_figures
from tyrefem.reports.diagnosis_gap import AFTER, BEFORE, HELD_OUT, gap_figure
from tyrefem.reports.diagnosis_missing import missing_figures, tells_missing_heat
from tyrefem.reports.diagnosis_sections import residual_figures
from tyrefem.reports.figures.phases import Phase, draw_phases, make_room
from tyrefem.reports.figures.style import (
    FONT,
    INK,
    QUIET,
    TITLE,
    add_axes,
    figure,
    png,
    short,
    tidy,
    time_unit,
    title,
)

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from tyrefem.diagnose.diagnosis import DiagnosisData


def pictures(d: DiagnosisData) -> dict[str, bytes]:
    """File name -> PNG: ``gap``, ``rms``, ``residual-map``, ``probabilities``, histories; ``missing-heat`` if
    the verdict tells of some; ``energy-share`` if another strain energy is the most probable discrepancy.
    """
    drawn = {
        "gap.png": gap_figure(d),
        "rms.png": rms_figure(d),
        **residual_figures(d),
        "probabilities.png": probabilities_figure(d),
    }
    if tells_missing_heat(d):
        drawn |= missing_figures(d)
    drawn |= energy_figures(d)
    for number, run in enumerate(d.gap.runs):
        name = re.sub(r"[^\w.-]+", "-", run.name).strip("-.") or "run"
        file, again = f"histories-{name}.png", 2
        while file in drawn:
            file, again = f"histories-{name}-{again}.png", again + 1
        drawn[file] = histories_figure(d, number)
    return {name: png(figure) for name, figure in drawn.items()}


# -- rms ---------------------------------------------------------------------------------------------------------------


def rms_figure(d: DiagnosisData) -> Figure:
    """Draw a panel per run: two bars for every sensor, original and amended; held-out runs have a tinted background."""
    table = rms_table(d)
    runs = list(table["run"].unique())
    sensors = list(dict.fromkeys(table["sensor"]))
    columns = min(2, len(runs))
    rows = math.ceil(len(runs) / columns)
    wide, high = (3.9 if columns > 1 else 6.5), 0.33 * len(sensors) + 0.15
    left, step_x, step_y = 1.75, wide + 0.35, high + 0.62
    drawn = figure(left + columns * step_x + 0.1, rows * step_y + TITLE + 0.45)
    largest = float(table[["before_K", "after_K"]].max().max()) * 1.22
    for number, run in enumerate(runs):
        row, column = divmod(number, columns)
        axes = add_axes(drawn, left + column * step_x, 0.75 + (rows - 1 - row) * step_y, wide, high)
        _rms_panel(axes, table[table["run"] == run], sensors, largest)
        axes.set_title(f"{short(run, 30)}{_held(table, run)}", fontsize=FONT + 0.5, loc="left", pad=4)
        if column:
            axes.tick_params(labelleft=False)
        if number + columns >= len(runs):
            axes.set_xlabel("rms of measured - computed [K]", fontsize=FONT)
    title(drawn, "Deviation by run and sensor", "readings, noise included")
    _legend(drawn, [("original", BEFORE), ("amended", AFTER)], "noise")
    return drawn


def _rms_panel(axes: Axes, part: pd.DataFrame, sensors: list[str], largest: float) -> None:
    if part["hold_out"].any():
        axes.set_facecolor(HELD_OUT)
    for row in part.to_dict(orient="records"):
        y = sensors.index(row["sensor"])
        for shift, key, color in ((-0.19, "before_K", BEFORE), (0.19, "after_K", AFTER)):
            axes.barh(y + shift, row[key], height=0.36, color=color)
            # A number must not cover the tick of the noise.
            near = abs(row[key] - row["noise_K"]) < 0.06 * largest
            end = max(row[key], row["noise_K"]) if near else row[key]
            axes.text(end + 0.012 * largest, y + shift, f"{row[key]:.1f}", fontsize=FONT - 2, va="center", color=INK)
        axes.plot([row["noise_K"]] * 2, [y - 0.45, y + 0.45], color=INK, lw=1.0, ls=(0, (2, 1.2)), zorder=4)
    axes.set_yticks(range(len(sensors)), [short(sensor, 22) for sensor in sensors])
    axes.set_ylim(len(sensors) - 0.4, -0.6)
    axes.set_xlim(0, largest)
    tidy(axes)
    axes.grid(axis="y", visible=False)


def _held(table: pd.DataFrame, run: str) -> str:
    return " (held out)" if bool(table.loc[table["run"] == run, "hold_out"].any()) else " (fitted)"


def _legend(drawn: Figure, colors: list[tuple[str, str]], noise: str = "", measured: bool = False) -> None:
    """One legend for all panels, at the upper right."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = []
    if measured:
        handles.append(Line2D([], [], ls="", marker=".", color=QUIET, label="measured"))
        handles += [Line2D([], [], color=color, lw=1.6, ls=_dashes(color), label=name) for name, color in colors]
        handles.append(Patch(color=QUIET, alpha=0.2, lw=0, label=noise))
    else:
        handles += [Patch(color=color, label=name) for name, color in colors]
        handles.append(Line2D([], [], color=INK, lw=1.0, ls=(0, (2, 1.2)), label=noise))
    width, height = drawn.get_size_inches()
    drawn.legend(
        handles=handles, loc="upper right", bbox_to_anchor=(1 - 0.05 / width, 1 - 0.28 / height), ncols=len(handles),
        fontsize=FONT, frameon=False, handlelength=1.6, columnspacing=1.2,
    )  # fmt: skip


def _dashes(color: str) -> Any:
    return (0, (4, 1.5)) if color == BEFORE else "-"


# -- histories ---------------------------------------------------------------------------------------------------------


def histories_figure(d: DiagnosisData, number: int) -> Figure:
    """Draw one run, a panel per sensor: measured readings and both curves, with the deviations of both below."""
    run = d.gap.runs[number]
    columns = min(3, len(run.sensors))
    rows = math.ceil(len(run.sensors) / columns)
    wide, high, low = 3.0 if columns > 2 else 4.2, 1.75, 0.8
    left, step_x, step_y = 0.75, wide + 0.42, high + low + 0.72
    drawn = figure(left + columns * step_x, rows * step_y + TITLE + 0.12)
    divisor, unit = time_unit(_last(run))
    spans = _spans(d, number, run)
    phases = _phases(d, number, divisor)
    for place, series in enumerate(run.sensors):
        row, column = divmod(place, columns)
        bottom = 0.5 + (rows - 1 - row) * step_y
        lower = add_axes(drawn, left + column * step_x, bottom, wide, low)
        upper = add_axes(drawn, left + column * step_x, bottom + low + 0.08, wide, high)
        _history(d, number, series, upper, lower, divisor)
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
    _legend(drawn, [("original", BEFORE), ("amended", AFTER)], "noise ± 1 sd of a block", measured=True)
    return drawn


def _last(run: MeasuredDrive) -> float:
    """Time of the last reading, s."""
    return max(float(series.times[-1]) for series in run.sensors)


def _phases(d: DiagnosisData, number: int, divisor: float) -> list[Phase]:
    """The phases of a run's drive, up to the last reading."""
    drive, last = d.gap.driven(number).card.drive, _last(d.gap.runs[number])
    return [
        (phase.name, start / divisor, min(start + phase.duration, last) / divisor)
        for start, phase in zip(drive.starts, drive.phases, strict=True)
        if start < last
    ]


def _spans(d: DiagnosisData, number: int, run: MeasuredDrive) -> tuple[tuple[float, float], tuple[float, float]]:
    """Common axis limits of temperature and deviation for all sensors of a run."""
    values = np.concatenate([run.measured, d.before[number], d.after[number]])
    left = np.concatenate([run.measured - d.before[number], run.measured - d.after[number], [0.5, -0.5]])
    return tuple(  # type: ignore[return-value]
        (float(curve.min() - 0.06 * np.ptp(curve)), float(curve.max() + 0.06 * np.ptp(curve)))
        for curve in (values, left)
    )


def _history(d: DiagnosisData, number: int, series: MeasuredSensor, upper: Axes, lower: Axes, divisor: float) -> None:
    run = d.gap.runs[number]
    place = run.parts()[series.sensor]
    t = series.block_times / divisor
    step = max(1, math.ceil(len(series.times) / 300))
    upper.plot(series.times[::step] / divisor, series.measured[::step], ".", color=QUIET, ms=2.6, alpha=0.8, zorder=2)
    noise = series.noise / np.sqrt(series.sizes)
    lower.fill_between(t, -noise, noise, color=QUIET, alpha=0.2, lw=0, zorder=1)
    lower.axhline(0.0, color=INK, lw=0.6, zorder=1)
    for computed, color in ((d.before[number][place], BEFORE), (d.after[number][place], AFTER)):
        upper.plot(t, computed, color=color, lw=1.5, ls=_dashes(color), zorder=3)
        lower.plot(t, run.measured[place] - computed, color=color, lw=1.2, ls=_dashes(color), zorder=3)
    for axes in (upper, lower):
        tidy(axes)
        axes.set_xlim(0.0, _last(run) / divisor)
        if run.hold_out:
            axes.set_facecolor(HELD_OUT)
    upper.set_title(short(series.sensor, 34), fontsize=FONT, loc="left", pad=3)


# -- probabilities -----------------------------------------------------------------------------------------------------


def probabilities_figure(d: DiagnosisData, most: int = 8) -> Figure:
    """Draw the probability that each effect is present, and the probability of each set of effects."""
    members = {member.key for member in d.best.members}
    effects = [
        (key_of(row["name"], row["variant"], row["runs"]), row["probability"]) for row in candidate_rows(d)[:most]
    ]
    sets = [(" + ".join(row["effects"]) or "no effect", row["probability"]) for row in set_rows(d, most)]
    heights = [0.27 * len(rows) + 0.1 for rows in (effects, sets)]
    drawn = figure(9.4, sum(heights) + 2 * 0.62 + 0.25 + TITLE - 0.3)
    best = d.judgement.best.key
    lower = add_axes(drawn, 3.6, 0.5, 4.4, heights[1])
    upper = add_axes(drawn, 3.6, 0.5 + heights[1] + 0.62, 4.4, heights[0])
    for axes, rows, what in (
        (upper, effects, "effect: probability that it is present"),
        (lower, sets, "set of effects: probability that exactly these are present"),
    ):
        for y, (name, probability) in enumerate(rows):
            chosen = name in members or name == best or set(name.split(" + ")) == members
            axes.barh(y, probability, height=0.7, color=AFTER if chosen else "#b9c0c8")
            axes.text(probability + 0.01, y, percent(probability), fontsize=FONT - 1, va="center", color=INK)
        axes.set_yticks(range(len(rows)), [short(name, 50) for name, _ in rows])
        axes.set_ylim(len(rows) - 0.4, -0.6)
        axes.set_xlim(0, 1)
        tidy(axes)
        axes.grid(axis="y", visible=False)
        axes.set_title(what, fontsize=FONT, loc="left", pad=4)
    lower.set_xlabel("probability", fontsize=FONT)
    title(drawn, "Probabilities of effects and of sets", "")
    return drawn
