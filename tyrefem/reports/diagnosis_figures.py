"""Pictures of a diagnosis but its histories: rms before and after, probabilities; other modules have the rest."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from tyrefem.diagnose.numbers import percent
from tyrefem.diagnose.unknowns.candidates import key_of
from tyrefem.diagnose.words.result_tables import candidate_rows, rms_table, set_rows
from tyrefem.reports.diagnosis_energy import energy_figures
from tyrefem.reports.diagnosis_gap import AFTER, BEFORE, HELD_OUT, gap_figure
from tyrefem.reports.diagnosis_missing import missing_figures, tells_missing_heat
from tyrefem.reports.diagnosis_sections import residual_figures
from tyrefem.reports.figures.style import (
    FONT,
    INK,
    TITLE,
    add_axes,
    figure,
    legend,
    panel_title,
    png,
    short,
    tidy,
    title,
)

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from tyrefem.diagnose.diagnosis import DiagnosisData


def pictures(d: DiagnosisData) -> dict[str, bytes]:
    """File name -> PNG: ``gap``, ``rms``, ``residual-map``, ``probabilities``; ``missing-heat`` if the verdict tells
    of some; ``energy-share`` if another strain energy is the most probable discrepancy.

    The histories are drawn by `tyrefem.reports.diagnosis_histories`.
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
    return {name: png(each) for name, each in drawn.items()}


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
    largest = float(table[["before_K", "after_K", "noise_K"]].max().max()) * 1.22 or 1.0
    for number, run in enumerate(runs):
        row, column = divmod(number, columns)
        axes = add_axes(drawn, left + column * step_x, 0.75 + (rows - 1 - row) * step_y, wide, high)
        _rms_panel(axes, table[table["run"] == run], sensors, largest)
        panel_title(axes, f"{short(run, 30)}{_held(table, run)}", size=FONT + 0.5, pad=4)
        if column:
            axes.tick_params(labelleft=False)
        if number + columns >= len(runs):
            axes.set_xlabel("rms of measured - computed [K]", fontsize=FONT)
    title(drawn, "Deviation by run and sensor", "readings, noise included")
    _legend(drawn)
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


def _legend(drawn: Figure) -> None:
    """One legend for all panels, at the upper right."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = [Patch(color=color, label=name) for name, color in (("original", BEFORE), ("amended", AFTER))]
    handles.append(Line2D([], [], color=INK, lw=1.0, ls=(0, (2, 1.2)), label="noise"))
    legend(drawn, handles)


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
            # A part of the chosen set is not this set.
            chosen = name in members if axes is upper else name == best or set(name.split(" + ")) == members
            axes.barh(y, probability, height=0.7, color=AFTER if chosen else "#b9c0c8")
            axes.text(probability + 0.01, y, percent(probability), fontsize=FONT - 1, va="center", color=INK)
        axes.set_yticks(range(len(rows)), [short(name, 44) for name, _ in rows])
        axes.set_ylim(len(rows) - 0.4, -0.6)
        axes.set_xlim(0, 1)
        tidy(axes)
        axes.grid(axis="y", visible=False)
        panel_title(axes, what, pad=4)
    lower.set_xlabel("probability", fontsize=FONT)
    title(drawn, "Probabilities of effects and of sets", "")
    return drawn
