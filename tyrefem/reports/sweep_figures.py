"""Pictures of a sweep's variants: response curves, maps, Pareto front; and the list of pictures of each answer."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.reports.figures.near_points import name_points
from tyrefem.reports.figures.style import (  # fmt: skip
    ENERGY_MAP,
    FONT,
    PALETTE,
    QUIET,
    TITLE,
    add_axes,
    figure,
    line_style,
    plain,
    temperature_map,
    tidy,
    title,
)
from tyrefem.sweep.pareto import ParetoFront
from tyrefem.sweep.responses import Responses, capital, finished, judged, main_effects, numeric, short
from tyrefem.variants.answer_units import name_of, unit_of

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from tyrefem.sweep.sweep import Sweep

BROKEN = "#D55E00"
#: Largest number of lines of one picture; more are drawn as points with their mean.
MOST_LINES = 8
#: More variants than this are drawn as hexagons, so that a picture stays small; number of hexagons along an axis.
MOST_POINTS, HEXAGONS = 3000, 40
#: Longest Pareto front whose variants are named.
MOST_NAMES = 12
#: Largest numbers of maps and of curves of an answer.
MOST_MAPS, MOST_CURVES = 3, 4


@functools.singledispatch
def figures(answer: object) -> Iterator[tuple[str, str, Figure]]:
    """Pictures of an answer: file name without ending, caption, picture.

    A new kind of answer registers its function here, or has ``drawn = False``.

    Raises
    ------
    TypeError : no function is registered for this kind of answer.
    """
    if getattr(answer, "drawn", True):
        raise TypeError(f"no pictures are registered for {type(answer).__name__}")
    return iter(())


@figures.register(Responses)
def _responses(answer: Responses) -> Iterator[tuple[str, str, Figure]]:
    """Maps over the two or three numbers of most influence, and curves over every number."""
    swept = answer.swept
    if len(finished(swept)) < 2:
        return
    axes = numeric(swept)
    averaged = swept.plan.sampling.get("sample") == "grid" and len(swept.plan.varied) > 2
    mean = "; mean over the other numbers" if averaged else ""
    for name in judged(swept, answer.wanted):
        largest = [number for number in main_effects(swept, name)["number"] if number in axes]
        order = [*largest, *(number for number in axes if number not in largest)]
        for x, y in itertools.combinations(order[:MOST_MAPS], 2):
            yield _file("map", name, x, y), f"{name_of(name)} over {x} and {y}{mean}", response_map(swept, x, y, name)
        for x in order[:MOST_CURVES]:
            yield _file("curves", name, x), f"{name_of(name)} over {x}{_shades(swept)}", curves(swept, x, name)
        cards = [varied.heading for varied in swept.plan.varied if varied.heading not in axes]
        for card in cards if not axes else []:
            yield _file("bars", name, card), f"{name_of(name)} by {card}", curves(swept, card, name)


@figures.register(ParetoFront)
def _pareto(answer: ParetoFront) -> Iterator[tuple[str, str, Figure]]:
    """The front in every pair of objectives."""
    aims = [name for name in answer.chosen if name in answer.swept.overview(tuple(answer.chosen))]
    for y, x in itertools.combinations(aims, 2):
        if len(answer.table):
            caption = f"{name_of(y)} against {name_of(x)}; the front considers all objectives{_shades(answer.swept)}"
            yield f"pareto-{y}-{x}", caption, pareto(answer.swept, answer.table, x, y)


def _shades(sweep: Sweep) -> str:
    """Words for a caption about hexagons."""
    return "; darker hexagons: more variants" if len(finished(sweep)) > MOST_POINTS else ""


def _file(kind: str, answer: str, *numbers: str) -> str:
    return "-".join([kind, answer, *(short(number).replace(".", "-") for number in numbers)])


def label(answer: str) -> str:
    """Axis label of an answer."""
    unit = unit_of(answer)
    return plain(f"{name_of(answer)} [{unit}]" if unit else name_of(answer))


def axis(heading: str) -> str:
    """Axis label of a varied number, with its unit."""
    return plain(
        heading.replace("[x]", "[×]").replace("[degC]", "[°C]").replace("[deg]", "[°]").replace("delta_degC", "K")
    )


def curves(sweep: Sweep, x: str, answer: str) -> Figure:
    """Draw an answer over one number: a line per combination of the others if these are few, else points and means."""
    table = finished(sweep, [answer])
    others = [
        varied.heading for varied in sweep.plan.varied if varied.heading != x and table[varied.heading].nunique() > 1
    ]
    groups = _groups(table, others)
    lines = 0 < len(groups) <= MOST_LINES and all(len(group) > 1 for _, group in groups)
    beside = lines and bool(others)
    drawn = figure(8.9 if beside else 6.6, 4.2 + TITLE)
    axes = add_axes(drawn, 0.95, 0.62, 5.1, 3.4)
    if lines:
        for number, (values, group) in enumerate(groups):
            ordered = group.sort_values(x)
            words = ", ".join(map(_value, values))
            # No line between cards: there are no values between two cards.
            style = line_style(number) | ({} if table[x].dtype.kind in "if" else {"ls": "none"})
            axes.plot(ordered[x], ordered[answer], marker="o", ms=3.5, label=plain(words) or None, **style)
        if others:
            axes.legend(
                fontsize=FONT - 1.5, frameon=False, loc="upper left", bbox_to_anchor=(1.02, 1.02), alignment="left",
                title=", ".join(axis(other.split(".", 1)[-1]) for other in others), title_fontsize=FONT - 1.5,
            )  # fmt: skip
    else:
        _points(axes, table, x, answer)
    _limits(axes, sweep, answer, within=beside)
    axes.set_xlabel(axis(x), fontsize=FONT)
    axes.set_ylabel(label(answer), fontsize=FONT)
    tidy(axes)
    title(drawn, f"{capital(name_of(answer))} over {short(x)}", sweep.plan.study.name)
    return drawn


def _groups(table: pd.DataFrame, others: list[str]) -> list[tuple[Any, pd.DataFrame]]:
    """The rows with the same other numbers; none if these are too many for lines."""
    if not others:
        return [((), table)]
    if any(table[other].nunique() > MOST_LINES for other in others):
        return []
    grouped = table.groupby(others, sort=False)
    return list(grouped) if grouped.ngroups <= MOST_LINES else []


def _cloud(axes: Any, x: Any, y: Any) -> None:
    """Draw many variants as hexagons, darker where there are more."""
    axes.hexbin(x, y, gridsize=HEXAGONS, mincnt=1, bins="log", cmap="Greys", linewidths=0.2, vmin=0.3)


def _points(axes: Any, table: pd.DataFrame, x: str, answer: str) -> None:
    """Draw every variant, and the mean at each value (in ten classes if there are many values)."""
    numbers = table[x]
    if len(table) > MOST_POINTS and numbers.dtype.kind in "if":
        known = table.dropna(subset=[answer])
        _cloud(axes, known[x], known[answer])
    elif len(table) > MOST_POINTS:
        _ranges(axes, table, x, answer)
    else:
        axes.plot(numbers, table[answer], "o", ms=3, alpha=0.45, mew=0, color=PALETTE[0], label="variants")
    if numbers.dtype.kind in "if" and numbers.nunique() > 12:
        values = numbers.to_numpy(dtype=float)
        classes = np.minimum((10 * (values - values.min()) / np.ptp(values)).astype(int), 9)
        middle = table.groupby(classes)[[x, answer]].mean()
        axes.plot(middle[x], middle[answer], "-", lw=1.8, color=PALETTE[1], label="mean of classes")
    else:
        means = table.groupby(x)[answer].mean()
        line = "D-" if numbers.dtype.kind in "if" else "D"
        axes.plot(means.index, means, line, ms=5, lw=1.8, color=PALETTE[1], label="mean over the others")
    axes.legend(fontsize=FONT - 1, frameon=False)


def _ranges(axes: Any, table: pd.DataFrame, x: str, answer: str) -> None:
    """Draw the range of an answer at every value, for values without an order."""
    ends = table.groupby(x)[answer].agg(["min", "max"])
    axes.vlines(ends.index, ends["min"], ends["max"], lw=5, color=PALETTE[0], alpha=0.45, label="all variants")


def response_map(sweep: Sweep, x: str, y: str, answer: str) -> Figure:
    """Draw an answer over two numbers, mean over the others: contours for a grid, else coloured points."""
    table = finished(sweep, [answer])
    drawn = figure(6.9, 4.6 + TITLE)
    axes = add_axes(drawn, 0.95, 0.62, 4.5, 3.8)
    bar = add_axes(drawn, 5.65, 0.62, 0.16, 3.8)
    colours = temperature_map() if answer.endswith("_degC") else ENERGY_MAP
    grid = _regular(table, x, y, answer)
    regular = grid is not None
    many = len(table) > MOST_POINTS
    if grid is not None:
        shown: Any = axes.contourf(grid.columns, grid.index, grid.to_numpy(), levels=16, cmap=colours)
        axes.contour(grid.columns, grid.index, grid.to_numpy(), levels=16, colors="white", linewidths=0.35, alpha=0.7)
        _boundary(axes, sweep, grid, answer)
        axes.margins(0)
    elif many:
        known = table.dropna(subset=[answer])
        shown = axes.hexbin(known[x], known[y], C=known[answer], gridsize=HEXAGONS, linewidths=0.2, cmap=colours)
    else:
        shown = axes.scatter(table[x], table[y], c=table[answer], s=16, cmap=colours)
    if not regular and sweep.plan.limits:
        outside = _mostly_outside(axes, table, x, y) if many else table.loc[~table["feasible"], [x, y]].to_numpy()
        if len(outside):
            words = "most are outside a limit" if many else "outside a limit"
            axes.plot(*outside.T, "x", ms=4, color=QUIET, label=words)
            axes.legend(fontsize=FONT - 1, frameon=True, loc="lower left", bbox_to_anchor=(0.0, 1.0))
    colorbar = drawn.colorbar(shown, cax=bar)
    colorbar.set_label(label(answer), fontsize=FONT)
    bar.tick_params(labelsize=FONT - 1)
    axes.set_xlabel(axis(x), fontsize=FONT)
    axes.set_ylabel(axis(y), fontsize=FONT)
    tidy(axes, grid=False)
    fixed = (
        len([varied for varied in sweep.plan.varied if varied.heading in table and table[varied.heading].nunique() > 1])
        <= 2
    )
    title(
        drawn,
        capital(name_of(answer)),
        sweep.plan.study.name + ("" if fixed else ", mean over the other numbers" if regular or many else ""),
    )
    return drawn


def _mostly_outside(axes: Any, table: pd.DataFrame, x: str, y: str) -> Any:
    """Centres of the hexagons in which most variants are outside a limit, (n, 2)."""
    inside = table["feasible"].astype(float)
    drawn = axes.hexbin(table[x], table[y], C=inside, gridsize=HEXAGONS, visible=False)
    return drawn.get_offsets()[drawn.get_array() < 0.5]


def _regular(table: pd.DataFrame, x: str, y: str, answer: str) -> pd.DataFrame | None:
    """The mean answer at every pair of values of a grid; None: no grid."""
    count = table[x].nunique() * table[y].nunique()
    if min(table[x].nunique(), table[y].nunique()) < 2 or count > len(table):
        return None
    grid = table.pivot_table(index=y, columns=x, values=answer, aggfunc="mean")
    return grid if min(grid.shape) > 1 and bool(grid.notna().to_numpy().all()) else None


def _boundary(axes: Any, sweep: Sweep, grid: pd.DataFrame, answer: str) -> None:
    """Draw the line where the answer equals its limit."""
    limit = sweep.plan.limits.get(answer)
    for value in () if limit is None else (limit.below, limit.above):
        if value is not None and grid.to_numpy().min() < value < grid.to_numpy().max():
            line = axes.contour(
                grid.columns, grid.index, grid.to_numpy(), levels=[value], colors="white", linewidths=2.0
            )
            axes.clabel(line, fmt=f"limit {value:g}", fontsize=FONT - 1)


def pareto(sweep: Sweep, best: pd.DataFrame, x: str, y: str) -> Figure:
    """Draw all variants in two answers; filled markers are on the front."""
    table = finished(sweep, [x, y])
    drawn = figure(6.9, 4.4 + TITLE)
    axes = add_axes(drawn, 1.0, 0.62, 5.5, 3.5)
    feasible = table[table["feasible"]]
    rest = table[~table["feasible"]]
    many = len(table) > MOST_POINTS
    if many:
        known = table.dropna(subset=[x, y])
        _cloud(axes, known[x], known[y])
    else:
        axes.plot(feasible[x], feasible[y], "o", ms=3.5, mfc="none", mec=QUIET, label="variants")
    if len(rest) and not many:
        axes.plot(rest[x], rest[y], "x", ms=3.5, color="#b0b0b0", label="outside a limit")
    # A temperature that was never reached has no time.
    ordered = best.dropna(subset=[x, y]).sort_values(x)
    axes.plot(ordered[x], ordered[y], "o", ms=5.5, color=PALETTE[1], label="Pareto front")
    _limits(axes, sweep, y)
    axes.set_xlabel(label(x), fontsize=FONT)
    axes.set_ylabel(label(y), fontsize=FONT)
    axes.legend(fontsize=FONT - 1, frameon=False)
    tidy(axes)
    if len(ordered) <= MOST_NAMES:
        names = [plain(str(name)) for name in ordered["variant"]]
        points, others = (each[[x, y]].to_numpy(dtype=float) for each in (ordered, table.dropna(subset=[x, y])))
        name_points(axes, points, names, others, fontsize=FONT - 1.5, color=PALETTE[1])
    title(
        drawn,
        f"{capital(name_of(y))} against {name_of(x)}",
        f"{len(best)} of {len(feasible)} variants {'is' if len(best) == 1 else 'are'} on the Pareto front",
    )
    return drawn


def _limits(axes: Any, sweep: Sweep, answer: str, *, within: bool = False) -> None:
    """Draw limits as lines; a limit far from all variants is only written at that end of the axis.

    ``within``: write them within the axes, because a legend stands beside these.
    """
    limit = sweep.plan.limits.get(answer)
    low, high = axes.dataLim.intervaly
    words: dict[str, Any] = {"fontsize": FONT - 1.5, "color": BROKEN}
    for value in () if limit is None else (limit.below, limit.above):
        if value is None:
            continue
        if value > 2 * high - low:
            axes.annotate(f"limit {value:g} ↑", (1.0, 1.01), xycoords="axes fraction", ha="right", **words)
        elif value < 2 * low - high:
            axes.annotate(f"limit {value:g} ↓", (0.99, 0.02), xycoords="axes fraction", ha="right", **words)
        else:
            axes.axhline(value, color=BROKEN, lw=0.9, ls="--")
            place: dict[str, Any] = {"xycoords": ("axes fraction", "data"), "ha": "left"}
            if within:
                axes.annotate(f"limit {value:g}", (0.01, value), va="bottom", **place, **words)
            else:
                axes.annotate(f"limit\n{value:g}", (1.005, value), va="center", **place, **words)


def _value(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)
