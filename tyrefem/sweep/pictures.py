"""Pictures of a sweep: response curves, maps, the Pareto front, scatter over every number, tornado, indices."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.plotting.style import FONT, PALETTE, QUIET, TITLE, add_axes, figure, plain, tidy, title

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from tyrefem.sweep.sweep import Sweep

#: What is drawn of every sweep, with its axis.
DRAWN = {
    "hottest_degC": "highest temperature [°C]",
    "rolling_resistance_coefficient": "rolling resistance coefficient [-]",
    "contained-air_degC": "contained air at the end [°C]",
    "gradient_K_m": "steepest gradient [K/m]",
    "mass_kg": "mass [kg]",
    "time_to_limit_s": "time to the limit [s]",
}


def label(answer: str) -> str:
    """An axis for an answer."""
    return DRAWN.get(answer, answer)


def numeric(found: Sweep) -> list[str]:
    """Headings of the varied numbers that make an axis."""
    table = found.table
    return [
        one.heading
        for one in found.plan.varied
        if one.heading in table and table[one.heading].dtype.kind in "if" and table[one.heading].nunique() > 1
    ]


def curves(found: Sweep, x: str, answer: str) -> Figure:
    """An answer over one number; one line per combination of the others where they are few, else points."""
    table = _done(found)
    others = [one.heading for one in found.plan.varied if one.heading != x]
    drawn = figure(7.0, 4.2 + TITLE)
    axes = add_axes(drawn, 0.85, 0.6, 4.4 if others else 5.9, 3.4)
    groups = list(table.groupby(others, sort=False)) if others else [((), table)]
    if len(groups) <= 8 and all(len(group) > 1 for _, group in groups):
        for number, (values, group) in enumerate(groups):
            ordered = group.sort_values(x)
            words = ", ".join(f"{_short(name)} {_value(value)}" for name, value in zip(others, values, strict=True))
            axes.plot(ordered[x], ordered[answer], "o-", ms=3.5, color=PALETTE[number % 8], label=plain(words) or None)
        if others:
            axes.legend(fontsize=FONT - 1.5, frameon=False, loc="upper left", bbox_to_anchor=(1.01, 1.0))
    else:
        axes.plot(table[x], table[answer], "o", ms=2.5, alpha=0.6, color=PALETTE[0])
    _limits(axes, found, answer)
    axes.set_xlabel(plain(x), fontsize=FONT)
    axes.set_ylabel(label(answer), fontsize=FONT)
    tidy(axes)
    title(drawn, f"{label(answer).split(' [')[0].capitalize()} over {_short(x)}", found.plan.study.name)
    return drawn


def response_map(found: Sweep, x: str, y: str, answer: str) -> Figure:
    """An answer over two numbers: contours of a grid, coloured points of any other sample."""
    table = _done(found)
    drawn = figure(6.6, 4.6 + TITLE)
    axes = add_axes(drawn, 0.95, 0.6, 4.3, 3.8)
    bar = add_axes(drawn, 5.4, 0.6, 0.16, 3.8)
    grid = table.pivot_table(index=y, columns=x, values=answer, aggfunc="mean")
    if grid.notna().to_numpy().all() and min(grid.shape) > 1 and grid.size <= len(table):
        shown: Any = axes.contourf(grid.columns, grid.index, grid.to_numpy(), levels=14, cmap="viridis")
        axes.plot(table[x], table[y], ".", ms=2.5, color="white", alpha=0.7)
    else:
        shown = axes.scatter(table[x], table[y], c=table[answer], s=14, cmap="viridis")
    outside = table[~table["feasible"]]
    if found.plan.limits and len(outside):
        axes.plot(outside[x], outside[y], "x", ms=4, color="#D55E00", label="breaks a limit")
        axes.legend(fontsize=FONT - 1, frameon=True, loc="best")
    drawn.colorbar(shown, cax=bar)
    bar.tick_params(labelsize=FONT - 1)
    axes.set_xlabel(plain(x), fontsize=FONT)
    axes.set_ylabel(plain(y), fontsize=FONT)
    tidy(axes)
    axes.grid(visible=False)
    title(drawn, label(answer).split(" [")[0].capitalize(), f"{label(answer)}, over {_short(x)} and {_short(y)}")
    return drawn


def pareto(found: Sweep, best: pd.DataFrame, x: str, y: str) -> Figure:
    """All variants in two answers, those on the front filled."""
    table = _done(found)
    drawn = figure(6.6, 4.4 + TITLE)
    axes = add_axes(drawn, 1.0, 0.6, 5.3, 3.6)
    feasible = table[table["feasible"]]
    rest = table[~table["feasible"]]
    axes.plot(feasible[x], feasible[y], "o", ms=3.5, mfc="none", mec=QUIET, label="variants")
    if len(rest):
        axes.plot(rest[x], rest[y], "x", ms=3.5, color="#c0c0c0", label="break a limit")
    ordered = best.sort_values(x)
    axes.plot(ordered[x], ordered[y], "o", ms=5, color=PALETTE[1], label="Pareto front")
    if len(ordered) <= 20:
        for name, a, b in zip(ordered["variant"], ordered[x], ordered[y], strict=True):
            axes.annotate(plain(str(name)), (a, b), xytext=(4, 4), textcoords="offset points", fontsize=FONT - 2)
    axes.set_xlabel(label(x), fontsize=FONT)
    axes.set_ylabel(label(y), fontsize=FONT)
    axes.legend(fontsize=FONT - 1, frameon=False)
    tidy(axes)
    title(drawn, "What is given up for what", f"{len(best)} of {len(feasible)} variants are beaten by none")
    return drawn


def tornado(table: pd.DataFrame, answer: str, most: int = 20) -> Figure:
    """Bars of how far each number alone moves an answer."""
    shown = table.dropna().head(most).iloc[::-1]
    drawn = figure(7.6, 0.9 + 0.27 * len(shown) + TITLE)
    axes = add_axes(drawn, 3.6, 0.55, 3.7, 0.27 * len(shown) + 0.1)
    places = np.arange(len(shown))
    axes.barh(places, shown["less"], height=0.6, color=PALETTE[0], label="less of it")
    axes.barh(places, shown["more"], height=0.6, color=PALETTE[1], label="more of it")
    axes.axvline(0, color="black", lw=0.8)
    axes.set_yticks(places, [plain(name) for name in shown["number"]], fontsize=FONT - 1)
    axes.set_xlabel(f"change of the {label(answer)}", fontsize=FONT)
    axes.legend(fontsize=FONT - 1, frameon=False, loc="lower right")
    tidy(axes)
    title(drawn, "Which tolerance matters", "every number alone, less and more by its tolerance")
    return drawn


def _done(found: Sweep) -> pd.DataFrame:
    return found.table[found.table["failure"] == ""]


def _limits(axes: Any, found: Sweep, answer: str) -> None:
    limit = found.plan.limits.get(answer)
    for value in () if limit is None else (limit.below, limit.above):
        if value is not None:
            axes.axhline(value, color="#D55E00", lw=0.9, ls="--")


def _short(heading: str) -> str:
    return heading.split(" [")[0].split(".", 1)[-1]


def _value(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)
