"""Files of a blind test: JSON, and one picture of rates with intervals, reliability and every effect."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.brief import counted
from tyrefem.interruption import keeping
from tyrefem.output import atomic_path, write_json
from tyrefem.reports.figures.style import FONT, PALETTE, QUIET, TITLE, add_axes, figure, plain, png, tidy, title

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from tyrefem.diagnose.blind.rates import Blind

#: Height of a line of text, inches.
LINE = 0.21
#: Files that `save` writes.
FILES = ("blind.json", "blind.png")


def save(rates: Blind, folder: Path) -> None:
    """Write ``blind.json`` and ``blind.png``, each completely or not at all.

    Raises
    ------
    InputError : the folder cannot be written.
    """
    count = len(rates.rows)
    with keeping(f"{count} of {count} cases are finished; the same command resumes from there"):
        write_json(rates.to_dict(), folder / "blind.json")
        with atomic_path(folder / "blind.png") as temporary:
            temporary.write_bytes(png(picture(rates)))


def picture(blind: Blind) -> Figure:
    """Draw rates, reliability and cases by effect, with 95 % intervals (Wilson)."""
    rates = [(name, rate) for name, rate in blind.rates.items() if rate.of]
    effects = blind.by_effect
    left = LINE * max(len(rates), 8)
    below = LINE * len(effects)
    drawn = figure(10.6, TITLE + left + below + 1.6)
    axes = add_axes(drawn, 3.9, below + 1.4, 2.6, left)
    _rates(axes, rates)
    if blind.reliability:
        _reliability(add_axes(drawn, 7.6, below + 1.4 + max(left - 2.6, 0.0), 2.6, min(left, 2.6)), blind)
    if effects:
        _effects(add_axes(drawn, 3.9, 0.55, 6.3, below), effects)
    data = "data of another model, " if blind.data_model == "structural" else ""
    facts = f"{counted(len(blind.rows), 'case')}, {data}seed {blind.seed}; intervals of 95 %"
    title(drawn, f"Blind test of {blind.study}", facts)
    return drawn


def _rates(axes: Any, rates: Any) -> None:
    places = np.arange(len(rates))[::-1]
    for place, (_, rate) in zip(places, rates, strict=True):
        low, high = rate.interval
        axes.plot([low, high], [place, place], color=PALETTE[0], lw=2.2, solid_capstyle="butt", alpha=0.5)
        axes.plot([rate.value], [place], "o", ms=4.5, color=PALETTE[0])
        if rate.goal is not None:
            axes.plot([rate.goal], [place], "<" if rate.at_most else ">", ms=4.5, mfc="none", color=QUIET)
        axes.annotate(
            f"{rate.right} of {rate.of}", (1.02, place), xycoords=("axes fraction", "data"), fontsize=FONT - 1.5,
            va="center", color=QUIET,
        )  # fmt: skip
    axes.set_yticks(places, [plain(name) for name, _ in rates], fontsize=FONT - 1)
    axes.set_xlim(-0.02, 1.02)
    goals = any(rate.goal is not None for _, rate in rates)
    axes.set_xlabel("share of the cases [-]" + ("; triangle: goal" if goals else ""), fontsize=FONT)
    tidy(axes)


def _reliability(axes: Any, blind: Blind) -> None:
    axes.plot([0.4, 1], [0.4, 1], color=QUIET, lw=0.8, ls="--", label="as stated")
    for row in blind.reliability:
        axes.plot([row["stated"]] * 2, [row["low"], row["high"]], color=PALETTE[1], lw=2.2, alpha=0.5)
        axes.plot([row["stated"]], [row["rate"]], "o", ms=4.5, color=PALETTE[1])
    lines = [f"stated {row['stated']:.4g}: {row['right']} of {row['of']}" for row in blind.reliability]
    axes.text(0.42, 0.12, "\n".join(lines), fontsize=FONT - 1.5, color=QUIET, va="bottom")
    axes.set_xlim(0.4, 1.02)
    axes.set_ylim(0.0, 1.05)
    axes.set_xlabel("probability stated by 'identified' [-]", fontsize=FONT)
    axes.set_ylabel("observed frequency [-]", fontsize=FONT)
    axes.legend(fontsize=FONT - 1, frameon=False, loc="lower left")
    tidy(axes)


def _effects(axes: Any, effects: Any) -> None:
    places = np.arange(len(effects))[::-1]
    named = np.array([min(row["named"], row["identifiable"]) for row in effects])
    able = np.array([row["identifiable"] for row in effects]) - named
    rest = np.array([row["cases"] for row in effects]) - named - able
    axes.barh(places, named, height=0.62, color=PALETTE[2], label="identifiable and named")
    axes.barh(places, able, left=named, height=0.62, color=PALETTE[1], label="identifiable, not named")
    axes.barh(
        places, rest, left=named + able, height=0.62, color="#d0d0d0", label="not identifiable with these sensors"
    )
    axes.set_yticks(places, [plain(row["effect"]) for row in effects], fontsize=FONT - 1)
    axes.set_ylim(-0.6, len(effects) - 0.4)
    axes.set_xlabel("number of cases with one hidden effect [-]", fontsize=FONT)
    axes.xaxis.get_major_locator().set_params(integer=True)
    axes.legend(fontsize=FONT - 1, frameon=False, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3)
    axes.set_xlim(0, max(row["cases"] for row in effects) * 1.02)
    tidy(axes)
