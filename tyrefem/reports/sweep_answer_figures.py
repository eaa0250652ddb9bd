"""Pictures of a sweep's answers: tornado, Sobol indices, optimum, envelope."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from tyrefem.reports.figures.style import FONT, PALETTE, QUIET, TITLE, add_axes, figure, line_style, plain, tidy, title
from tyrefem.reports.sweep_figures import figures, label
from tyrefem.sweep.envelope import Envelope
from tyrefem.sweep.optimum import Optimum
from tyrefem.sweep.sobol_indices import Indices
from tyrefem.sweep.tornado import Tornado
from tyrefem.variants.answer_units import difference_unit, name_of, shown
from tyrefem.variants.outcomes import Answered

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

#: Largest number of bars of one picture.
MOST = 15
#: Height per bar, least width of the names, and mean width of a letter, inches.
BAR, NAMES, LETTER = 0.27, 3.5, 0.0083 * (FONT - 1)


@figures.register(Tornado)
def _tornado(answer: Tornado) -> Iterator[tuple[str, str, Figure]]:
    """A picture per answer."""
    for name in answer.answers:
        caption = f"{name_of(name)} when one number at a time is lower or higher by its tolerance"
        yield f"tornado-{name}", caption, tornado(answer, name)


@figures.register(Indices)
def _indices(answer: Indices) -> Iterator[tuple[str, str, Figure]]:
    """A picture per answer."""
    for name, table in answer.tables.items():
        yield (
            f"indices-{name}",
            f"{name_of(name)}: share of each number in its variance, with 95 % intervals",
            indices(table, name),
        )


@figures.register(Optimum)
def _optimum(answer: Optimum) -> Iterator[tuple[str, str, Figure]]:
    """A picture of the search."""
    if answer.answer in answer.table:
        caption = f"{name_of(answer.answer)} of every evaluated variant, and the best so far"
        yield "optimum", caption, search(answer)


@figures.register(Envelope)
def _envelope(answer: Envelope) -> Iterator[tuple[str, str, Figure]]:
    """A picture of speed over load, with a curve per pressure."""
    if answer.table["speed_m_s"].notna().any():
        yield (
            "envelope",
            "Below each curve, the tyre is within the limit; grey: equal load times speed",
            envelope(answer),
        )


def tornado(tornado_data: Tornado, answer: str) -> Figure:
    """Draw the change of an answer by each number alone, as bars."""
    rows = tornado_data.of(answer).dropna(subset=["range"])
    # Numbers of little influence would leave less room for the others.
    table = rows[rows["range"] > 0.01 * rows["range"].max()].head(MOST).iloc[::-1]
    high = BAR * max(len(table), 2) + 0.1
    numbers = [f"{plain(number)}  {tornado_data.tolerance(number)}" for number in table["number"]]
    room = _room(numbers)
    drawn = figure(room + 4.4, 1.0 + high + TITLE)
    axes = add_axes(drawn, room, 0.95, 4.0, high)
    places = np.arange(len(table))
    axes.barh(places, table["less"], height=0.62, color=PALETTE[0], label="number lower")
    axes.barh(places, table["more"], height=0.62, color=PALETTE[1], label="number higher")
    axes.axvline(0, color="black", lw=0.8)
    axes.set_yticks(places, numbers, fontsize=FONT - 1)
    axes.locator_params(axis="x", nbins=6)
    axes.set_xlabel(plain(f"change of the {name_of(answer)} [{difference_unit(answer) or '-'}]"), fontsize=FONT)
    axes.legend(fontsize=FONT - 1, frameon=False, loc="upper center", bbox_to_anchor=(0.5, -0.45 / high), ncols=2)
    tidy(axes)
    more = f"; the {len(table)} widest of {len(rows)}" if len(rows) > len(table) else ""
    nominal = f"{name_of(answer)} {shown(answer, float(table['nominal'].iloc[0]))} for the study" if len(table) else ""
    title(drawn, "Influence of each tolerance", f"{nominal}; one number at a time{more}")
    return drawn


def _room(names: list[str]) -> float:
    """Width of the longest name, inches."""
    return max(NAMES, 0.3 + LETTER * max(map(len, names), default=0))


def indices(table: pd.DataFrame, answer: str) -> Figure:
    """Draw first-order and total indices of every number with their intervals."""
    rows = table.head(MOST).iloc[::-1]
    high = 1.5 * BAR * max(len(rows), 2) + 0.1
    numbers = [plain(name) for name in rows["number"]]
    room = _room(numbers)
    drawn = figure(room + 4.2, 1.0 + high + TITLE)
    axes = add_axes(drawn, room, 0.95, 4.0, high)
    places = np.arange(len(rows))
    for up, share, colour, words in (
        (0.2, "first", PALETTE[0], "alone"),
        (-0.2, "total", PALETTE[1], "with interactions"),
    ):
        axes.barh(
            places + up, rows[share], height=0.36, color=colour, label=words, xerr=rows[f"{share}_95"],
            error_kw={"ecolor": "black", "elinewidth": 0.8, "capsize": 2},
        )  # fmt: skip
    axes.axvline(0, color="black", lw=0.8)
    axes.set_yticks(places, numbers, fontsize=FONT - 1)
    axes.set_xlim(right=max(1.0, axes.get_xlim()[1]))
    axes.set_xlabel("share of the variance", fontsize=FONT)
    axes.legend(fontsize=FONT - 1, frameon=False, loc="upper center", bbox_to_anchor=(0.5, -0.45 / high), ncols=2)
    tidy(axes)
    title(drawn, f"Influence on the {name_of(answer)}", "Sobol indices; bars: 95 % intervals of the estimate")
    return drawn


def search(optimum: Optimum) -> Figure:
    """Draw the answer of every evaluated variant in order, and the best so far."""
    table = optimum.table[optimum.table["failure"] == ""]
    drawn = figure(7.2, 4.0 + TITLE)
    axes = add_axes(drawn, 1.0, 0.62, 5.9, 3.1)
    order = table.index.to_numpy() + 1
    fine = table["feasible"].to_numpy(dtype=bool)
    axes.plot(order[~fine], table[optimum.answer][~fine], "x", ms=3.5, color="#b0b0b0", label="outside a limit")
    axes.plot(order[fine], table[optimum.answer][fine], "o", ms=3, color=PALETTE[0], label="within the limits")
    axes.step(order, table["best_so_far"], where="post", color=PALETTE[1], lw=1.5, label="best so far")
    if isinstance(optimum.nominal, Answered):
        nominal = float(optimum.nominal.answers[optimum.answer])
        axes.axhline(nominal, color=QUIET, lw=0.9, ls="--", label="the study")
    axes.set_xlabel("variants evaluated", fontsize=FONT)
    axes.set_ylabel(label(optimum.answer), fontsize=FONT)
    axes.legend(fontsize=FONT - 1, frameon=True, framealpha=0.9)
    tidy(axes)
    best = (
        "no variant is within the limits"
        if optimum.best is None
        else f"best: {shown(optimum.answer, optimum.full[optimum.answer])}"
    )
    word = "Smallest" if optimum.card.minimise else "Largest"
    title(drawn, f"{word} {name_of(optimum.answer)}", best)
    return drawn


def envelope(result: Envelope) -> Figure:
    """Draw the largest speed over load, a curve per pressure, and grey curves of equal load x speed."""
    table = result.table
    drawn = figure(7.4, 4.4 + TITLE)
    axes = add_axes(drawn, 0.9, 0.62, 5.5, 3.5)
    for number, (pressure, rows) in enumerate(table.groupby("pressure", sort=False)):
        ordered = rows.dropna(subset=["speed_m_s"]).sort_values("load_N")
        axes.plot(
            ordered["load_N"] / 1e3,
            ordered["speed_km_h"],
            marker="o",
            ms=4,
            label=plain(pressure),
            **line_style(number),
        )
        beyond = ordered[~ordered["at_limit"].astype(bool)]
        axes.plot(
            beyond["load_N"] / 1e3, beyond["speed_km_h"], "^", ms=8, mfc="none", color=line_style(number)["color"]
        )
    top = 1.12 * float(table["speed_km_h"].max())
    low, high = float(table["load_N"].min()) / 1e3, float(table["load_N"].max()) / 1e3
    margin = 0.06 * (high - low) or 0.1 * high
    loads = np.linspace(low - margin, high + margin, 80)
    for product in _round(np.array([0.25, 0.5, 0.75, 1.0]) * float(table["tkph"].max())):
        speeds = product / (loads / 9.80665)
        axes.plot(loads, speeds, color="#c4c4c4", lw=0.8, zorder=0)
        right = float(speeds[-1])
        if right < top:
            axes.annotate(
                f"{product:g} t km/h", (loads[-1], right), xytext=(4, 0), textcoords="offset points", va="center",
                fontsize=FONT - 2, color=QUIET,
            )  # fmt: skip
    axes.set_xlim(loads[0], loads[-1])
    axes.set_ylim(0, top)
    axes.set_xlabel("load [kN]", fontsize=FONT)
    axes.set_ylabel("largest speed [km/h]", fontsize=FONT)
    axes.legend(fontsize=FONT - 1, frameon=True, framealpha=0.9, title="cold pressure", title_fontsize=FONT - 1)
    tidy(axes)
    limit = shown(result.card.answer, result.card.below)
    open_ended = "; triangle: limit not reached at the highest speed" if not table["at_limit"].all() else ""
    title(
        drawn,
        f"Largest speed with {name_of(result.card.answer)} below {limit}",
        f"{result.study.name}, {result.study.card.drive.end:g} s{open_ended}",
    )
    return drawn


def _round(values: np.ndarray) -> list[float]:
    """The positive values with two significant digits, sorted, without duplicates."""
    return sorted({float(f"{value:.2g}") for value in values if value > 0})
