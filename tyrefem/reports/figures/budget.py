"""Picture of the heat budget: heat generated, stored and lost, J, and powers over time, W."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from tyrefem.reports.figures.phases import Phase, draw_phases, make_room
from tyrefem.reports.figures.style import (
    FONT,
    GENERATED,
    INK,
    LOST,
    QUIET,
    SLIDING,
    STORED,
    TITLE,
    Label,
    add_axes,
    digits,
    figure,
    line_ends,
    line_style,
    plain,
    si,
    tidy,
    time_unit,
    title,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from tyrefem.simulation.heat_budget import HeatBudget
    from tyrefem.simulation.result import ResultData

#: Mean width of a letter of the bars' names, inches.
LETTER = 0.074
#: Width of the waterfall, inches.
WIDE = 3.0
KINDS = {"generated": GENERATED, "sliding": SLIDING, "stored": STORED, "lost": LOST}
WORDS = {"generated": "generated in", "sliding": "from", "stored": "stored in", "lost": "lost to"}
#: Kinds that add heat.
MADE = ("generated", "sliding")
#: Powers above this multiple of the generated power are cut off, so that the others can be read.
TALLEST = 10.0


@dataclass(frozen=True)
class Bar:
    """A step of the waterfall, from ``start`` to ``end``, J."""

    kind: str
    name: str
    start: float
    end: float

    @property
    def energy(self) -> float:
        """Energy of the bar, J, with the sign of its kind."""
        return self.end - self.start if self.kind in MADE else self.start - self.end


def waterfall(budget: HeatBudget) -> list[Bar]:
    """Bars that rise by generated and sliding heat, and fall by stored and lost heat to the residual."""
    bars, level = [], 0.0
    for kind in KINDS:
        sign = 1.0 if kind in MADE else -1.0
        for (k, name), series in budget.energies.items():
            if k == kind:
                after = level + sign * float(series[-1])
                bars.append(Bar(kind, name, level, after))
                level = after
    return bars


def budget_figure(result: ResultData) -> Figure:
    """Draw the waterfall of energies of the whole tyre (left) and the powers over time (right)."""
    budget = result.heat_budget
    bars = waterfall(budget)
    high = max(3.4, 0.24 * len(bars))
    left = 0.25 + LETTER * max((len(_name(bar)) for bar in bars), default=0)
    drawn = figure(left + 8.6, high + 0.55 + TITLE)
    _energies(add_axes(drawn, left, 0.55, WIDE, high), bars, budget)
    power = add_axes(drawn, left + 3.8, 0.55, 2.9, high)
    divisor, _ = time_unit(float(budget.times[-1]))
    phases = [(p.name, p.start / divisor, min(p.end, budget.times[-1]) / divisor) for p in result.phases]
    _powers(power, budget, [phase for phase in phases if phase[1] < phase[2]])
    largest = max(budget.floor, *(abs(budget.total(kind)) for kind in KINDS))
    factor, unit = si(largest, "J")
    form = digits(largest / factor, 4)
    numbers = {kind: format(budget.total(kind) / factor, form) for kind in KINDS}
    rubbed = f" + sliding {numbers['sliding']}" if "sliding" in _kinds(budget) else ""
    title(
        drawn, result.study.title,
        f"heat of the whole tyre: generated {numbers['generated']} {unit}{rubbed} = stored {numbers['stored']} + lost "
        f"{numbers['lost']}; "
        f"{budget.closing}{'' if budget.empty else ' of it'}",
    )  # fmt: skip
    return drawn


def _kinds(budget: HeatBudget) -> list[str]:
    """The kinds of heat in this budget."""
    return [kind for kind in KINDS if any(k == kind for k, _ in budget.energies)]


def _name(bar: Bar) -> str:
    return f"{WORDS[bar.kind]} {plain(bar.name)}"


def _energies(axes: Axes, bars: list[Bar], budget: HeatBudget) -> None:
    ends = [value for bar in bars for value in (bar.start, bar.end)] or [0.0]
    factor, unit = si(max(budget.floor, *map(abs, ends)), "J")
    made = 0.0 if budget.empty else budget.made
    form = digits(max(budget.floor, *(abs(bar.energy) for bar in bars)) / factor, 4)
    texts: list[str] = []
    for row, bar in enumerate(bars):
        axes.barh(row, (bar.end - bar.start) / factor, left=bar.start / factor, color=KINDS[bar.kind], height=0.72)
        axes.plot([bar.end / factor] * 2, [row - 0.36, row + 1.36], color=QUIET, lw=0.6)
        share = f" ({100 * bar.energy / made:z.1f} %)" if made > 0 else ""
        texts.append(format(bar.energy / factor, form) + share)
        axes.annotate(
            texts[-1], (max(bar.start, bar.end) / factor, row), xytext=(4, 0), textcoords="offset points", va="center",
            fontsize=FONT - 0.5,
        )  # fmt: skip
    axes.set_yticks(range(len(bars)), [_name(bar) for bar in bars])
    axes.set_ylim(len(bars) - 0.4, -0.6)
    low, high = min(0.0, *ends) / factor, max(0.0, *ends) / factor
    span = max(high - low, budget.floor / factor) or 1.0
    left = low - 0.02 * span
    # Space for a number to the right of each bar.
    shares = [(len(text) * LETTER + 0.1) / WIDE for text in texts]
    tops = [max(bar.start, bar.end) / factor for bar in bars]
    right = max((end - share * left) / (1 - share) for end, share in zip(tops, shares, strict=True)) if bars else high
    axes.set_xlim(left, max(right, high + 0.05 * span))
    axes.axvline(0.0, color=INK, lw=0.8)
    what = "generated" if "sliding" not in _kinds(budget) else "generated and sliding heat"
    axes.set_xlabel(f"heat [{unit}]" + (f", share of the {what}" if made > 0 else ""), fontsize=FONT)
    tidy(axes)
    axes.grid(visible=False, axis="y")
    for tick, bar in zip(axes.get_yticklabels(), bars, strict=True):
        tick.set_color(KINDS[bar.kind])


def _cut_off(axes: Axes) -> None:
    """Clip all lines at the present limits, so that none crosses the names of the phases."""
    from matplotlib.patches import Rectangle

    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    for line in axes.lines:
        line.set_clip_path(Rectangle((left, low), right - left, high - low, transform=axes.transData))


def _powers(axes: Axes, budget: HeatBudget, phases: list[Phase]) -> None:
    divisor, unit_t = time_unit(float(budget.times[-1]))
    t = budget.times / divisor
    curves = {kind: budget.power(kind) for kind in _kinds(budget)}
    # Rounding errors of powers are not drawn.
    least = budget.floor / max(float(budget.times[-1]), 1e-9)
    top = highest = max(least, *(float(abs(curve).max()) for curve in curves.values()))
    usual = TALLEST * float(budget.power("generated").max(initial=0.0))
    if "sliding" in curves and highest > usual > 0:
        top = usual / 2
    factor, unit = si(top, "W")
    form = digits(top / factor)
    labels = []
    for kind, curve in curves.items():
        axes.plot(t, curve / factor, color=KINDS[kind], lw=2.0)
        labels.append(
            Label(f"{kind} {curve[-1] / factor:{form}}", float(t[-1]), float(curve[-1] / factor), color=KINDS[kind])
        )
    lost = [(name, series) for (kind, name), series in budget.powers.items() if kind == "lost"]
    peak = max((float(abs(series).max()) for _, series in lost), default=0.0)
    shown = [(name, series) for name, series in lost if float(abs(series).max()) > 0.02 * peak]
    for number, (name, series) in enumerate(shown):
        style = {
            **line_style(number),
            "color": QUIET,
            "ls": ("--", ":", "-.", (0, (1, 3)), (0, (6, 2, 1, 2)))[number % 5],
        }
        axes.plot(t, series / factor, lw=1.2, **style)
        text = f"to {plain(name)} {series[-1] / factor:{form}}"
        labels.append(Label(text, float(t[-1]), float(series[-1] / factor), color=QUIET))
    if budget.empty:
        axes.set_ylim(-top / factor, top / factor)
    axes.axhline(0.0, color=INK, lw=0.8)
    axes.set_xlim(0.0, max(float(t[-1]), 1e-9))
    axes.set_xlabel(f"time [{unit_t}]", fontsize=FONT)
    axes.set_ylabel(f"power [{unit}]", fontsize=FONT)
    if top < highest:
        low = min(float(curve.min()) for curve in curves.values())
        axes.set_ylim(max(low, -0.3 * top) / factor, top / factor)
        _cut_off(axes)
        axes.axhline(top / factor, color=QUIET, lw=0.6, ls=":")
        text = f"cut off: up to {highest / factor:{form}} {unit}"
        axes.annotate(text, (0.02, top / factor), xycoords=("axes fraction", "data"), fontsize=FONT - 1, color=QUIET,
                      va="top")  # fmt: skip
    make_room(axes, phases)
    draw_phases(axes, phases)
    tidy(axes)
    line_ends(axes, labels, room=1.6, size=FONT - 0.5)
