"""Files of a plan: table, JSON, picture, and one self-contained page."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import TYPE_CHECKING, Any

import tyrefem
from tyrefem.output import atomic_folder, write_json
from tyrefem.plan.record import record
from tyrefem.plan.words import plan_words, step_name
from tyrefem.reports.figures.style import FONT, INK, PALETTE, QUIET, TITLE, add_axes, figure, png, short, tidy, title
from tyrefem.reports.template import rendered

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from tyrefem.plan.steps import PlanData

PAGE = "plan.html"
#: Files that `save` may write.
FILES = ("plan.csv", "plan.json", "plan.png", "plan-candidates.csv", PAGE)
#: Largest number of experiments in the picture, and of sets on the page.
DRAWN, SHOWN = 14, 12
BAR = 0.24


def save(plan: PlanData, folder: str | Path) -> Path:
    """Write plan.csv, plan-candidates.csv, plan.json, plan.png and plan.html; return the page's path.

    Raises
    ------
    InputError : the folder cannot be written.
    """
    drawn = picture(plan)
    folder = Path(folder)
    with atomic_folder(folder) as temporary:
        plan.table.to_csv(temporary / "plan.csv", index=False, lineterminator="\n")
        plan.candidates.to_csv(temporary / "plan-candidates.csv", index=False, lineterminator="\n")
        write_json(record(plan), temporary / "plan.json")
        (temporary / "plan.png").write_bytes(drawn)
        (temporary / PAGE).write_text(page(plan, drawn), encoding="utf-8")
    return folder / PAGE


def page(plan: PlanData, drawn: bytes) -> str:
    """The page's HTML; ``drawn``: the picture as PNG."""
    first, *rest = plan_words(plan)
    sets = plan.beliefs.sets
    return rendered(
        "plan.html",
        plan=plan,
        version=tyrefem.__version__,
        first=first,
        rest=rest,
        steps=[(step, step_name(step)) for step in plan.steps],
        sets=sets[:SHOWN],
        others=len(sets[SHOWN:]),
        others_probability=sum(entry.probability for entry in sets[SHOWN:]),
        candidates=[_candidate(row) for row in plan.candidates.to_dict(orient="records")],
        picture=base64.b64encode(drawn).decode("ascii"),
    )


def _candidate(row: dict[Any, Any]) -> dict[str, Any]:
    """A row of the page: empty cells as text."""
    return row | {key: row[key] if isinstance(row[key], str) else "" for key in ("drive", "place")}


def picture(plan: PlanData) -> bytes:
    """PNG: gain of the compared experiments, and expected information over cost along the plan."""
    rows = plan.candidates.head(DRAWN).to_dict(orient="records")
    height = max(BAR * len(rows), 2.4) + TITLE + 0.75
    drawn = figure(12.6, height)
    _bars(add_axes(drawn, 4.6, 0.55, 3.0, height - TITLE - 0.75), rows)
    _course(add_axes(drawn, 8.5, 0.55, 3.8, height - TITLE - 0.75), plan)
    state = f"after the verdict '{plan.beliefs.verdict}'" if plan.beliefs.verdict else "before any data"
    title(
        drawn,
        f"Plan of {plan.study}, {state}",
        "expected information about which effects act, nats; best per cost first",
    )
    return png(drawn)


def _bars(axes: Axes, rows: list[dict[Any, Any]]) -> None:
    """Gain of each compared first experiment, with two standard errors."""
    places = range(len(rows))
    gains = [max(row["gain_nats"], 0.0) for row in rows]
    errors = [2 * row["gain_sd_nats"] for row in rows]
    axes.barh(places, gains, xerr=errors, color=PALETTE[0], ecolor=QUIET, height=0.7)
    axes.set_yticks(places, [short(_label(row), 62) for row in rows], fontsize=FONT - 2)
    axes.invert_yaxis()
    axes.set_xlabel("gain of the first step, nats", fontsize=FONT)
    tidy(axes)
    axes.tick_params(axis="y", labelsize=FONT - 2)


def _label(row: dict[Any, Any]) -> str:
    parts = [row[key] for key in ("drive", "sensor") if isinstance(row[key], str)]
    return " + ".join(parts)


def _course(axes: Axes, plan: PlanData) -> None:
    """Expected information over cost, step by step, below the doubt."""
    cost = [0.0, *(step.total_cost for step in plan.steps)]
    gain = [0.0, *(step.total_gain for step in plan.steps)]
    error = [0.0, *(2 * step.sd for step in plan.steps)]
    axes.errorbar(cost, gain, yerr=error, color=PALETTE[1], marker="o", capsize=3)
    for step in plan.steps:
        words = f"{step.number}: {'sensor' if step.drive is None else f'run {step.run}'}"
        words += " + sensor" if step.drive is not None and step.place is not None else ""
        axes.annotate(
            words,
            (step.total_cost, step.total_gain),
            (4, -11),
            textcoords="offset points",
            fontsize=FONT - 1,
            color=INK,
        )
    axes.axhline(plan.doubt, color=QUIET, ls="--", lw=1)
    axes.text(0.0, plan.doubt, " doubt between the sets", fontsize=FONT - 1, color=QUIET, va="bottom")
    axes.set_xlim(-0.03 * max(cost[-1], 1.0), 1.4 * max(cost[-1], 1.0))
    axes.set_ylim(0.0, max(1.15 * plan.doubt, 0.05))
    axes.set_xlabel("cost", fontsize=FONT)
    axes.set_ylabel("expected information, nats", fontsize=FONT)
    tidy(axes)
