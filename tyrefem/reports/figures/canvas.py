"""The whole section, crown up, with space for labels: the base of every picture on the section."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.geometry.outlines import label_place
from tyrefem.reports.figures.style import (
    FONT,
    INK,
    TITLE,
    Label,
    add_axes,
    column,
    figure,
    millimetres,
    plain,
    section_axes,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from tyrefem.geometry import Section

#: Mean width of a letter and height of a line of text, inches.
LETTER, LINE = 0.072, 0.185
#: Width of the drawn section and of a colour bar with its labels, inches.
DRAWN, BAR = 5.2, 0.92


@dataclass(frozen=True, eq=False)
class Canvas:
    """A figure of one section, in mm; a half section is shown with its mirror image."""

    figure: Figure
    axes: Axes
    section: Section
    #: Scale: mm of the tyre per inch of the figure.
    scale: float
    width: float
    low: float
    high: float

    @property
    def gap(self) -> float:
        """Height of a line of text, mm."""
        return LINE * self.scale

    def beside(self, labels: Sequence[Label], side: float) -> None:
        """Write labels in a column right (side = 1) or left (-1) of the section, from crown to bead."""
        x = side * (self.width / 2 + 0.3 * self.scale)
        align = "left" if side > 0 else "right"
        column(self.axes, labels, x, self.low, self.high, gap=self.gap, align=align)

    def inside(self, labels: Sequence[Label]) -> None:
        """Write labels in the air space, in an order in which their leaders do not cross."""
        if not labels:
            return
        half = max(len(label.text) for label in labels) * LETTER * self.scale / 2
        top = float(self.section.place(0.0, 0.0)[0]) * 1e3 - 0.6 * self.scale
        right = [label for label in labels if label.x >= 0]
        left = [label for label in labels if label.x < 0]
        # The column is below its innermost point: leaders then rise beside the texts above, not across them.
        x = self._under(right, half)
        self._fan(right, x, top, 1.0)
        # The left column's leaders start left of the right column's texts.
        self._fan(left, x - 2 * half if right else -self._under(left, half), top - self.gap * len(right), -1.0)

    def _under(self, labels: Sequence[Label], half: float) -> float:
        """Start of a column's leaders, mm right of the mid plane for labels on that side."""
        innermost = min((abs(label.x) for label in labels), default=0.0)
        return min(half, max(innermost - 0.12 * self.scale, -half / 4))

    def _fan(self, labels: Sequence[Label], x: float, top: float, sign: float) -> None:
        def angle(label: Label) -> float:
            return float(np.arctan2(label.y - top, sign * (label.x - x)))

        ordered = sorted(labels, key=lambda label: -angle(label))
        align = "right" if sign > 0 else "left"
        column(self.axes, ordered, x, self.low + 0.1 * self.scale, top, gap=self.gap, align=align)

    def color_bar(
        self, image: Any, label: str, *, side: float = 1.0, ticks: Any = None, extend: str | None = None
    ) -> Any:
        """Draw a colour bar right (1) or left (-1) of all labels; ``extend``: "max" for values beyond its end."""
        width, height = (float(v) for v in self.figure.get_size_inches())
        box = self.axes.get_position()
        left = width - BAR + 0.05 if side > 0 else 0.62
        axes = add_axes(self.figure, left, box.y0 * height, 0.16, box.height * height)
        bar = self.figure.colorbar(image, cax=axes, ticks=ticks, extend=extend)
        if side < 0:
            axes.yaxis.set_ticks_position("left")
            axes.yaxis.set_label_position("left")
        bar.set_label(label, fontsize=FONT)
        axes.tick_params(labelsize=FONT, colors=INK)
        return bar


def canvas(
    section: Section, left: Iterable[str] = (), right: Iterable[str] = (), *, bars: int = 1, below: float = 0.0
) -> Canvas:
    """An empty canvas with space for the longest text on either side, and for colour bars (the second is left).

    ``below``: empty space under the section, inches.
    """
    lines = [line for name in section.boundaries for line in section.boundary_line(name)]
    r = np.concatenate([line[:, 0] for line in lines]) * 1e3
    low, high, width = float(r.min()), float(r.max()), section.overall_width * 1e3
    margins = [max((len(text) for text in texts), default=0) * LETTER for texts in (left, right)]
    margins = [margin + 0.45 if margin else 0.2 for margin in margins]
    scale = width / DRAWN
    across, up = DRAWN + sum(margins), (high - low) / scale + 0.4 + below
    first = 0.62 + (BAR if bars > 1 else 0.0)
    made = figure(first + across + (BAR if bars else 0.1), up + 0.5 + TITLE)
    axes = add_axes(made, first, 0.5, across, up)
    axes.set_xlim(-width / 2 - margins[0] * scale, width / 2 + margins[1] * scale)
    bottom = low - (0.2 + below) * scale
    axes.set_ylim(bottom, high + 0.2 * scale)
    section_axes(axes)
    ticks = np.asarray(axes.get_xticks())
    axes.set_xticks(ticks[np.abs(ticks) <= width / 2 + 1e-9])
    axes.set_yticks([tick for tick in axes.get_yticks() if low - 0.2 * scale <= tick <= high + 0.2 * scale])
    return Canvas(made, axes, section, scale, width, low, high)


def sides(section: Section) -> tuple[float, ...]:
    """Factors on z that give both sides of the tyre: 1 for a full section, 1 and -1 for a half."""
    return (1.0, -1.0) if section.half else (1.0,)


def draw_outlines(axes: Axes, section: Section, *, color: str = INK, width: float = 0.8) -> None:
    """Draw the borders of all regions on both sides."""
    for region in section.regions:
        for polygon in section.outline(region, 1e-3):
            x, y = millimetres(polygon)
            cut = (np.abs(x) < 1e-9) & (np.abs(np.roll(x, -1)) < 1e-9)
            x = np.where(cut, np.nan, x)
            for sign in sides(section):
                axes.plot(sign * x, y, color=color, lw=width, zorder=3, solid_joinstyle="round")


def region_labels(section: Section) -> list[Label]:
    """Names of the regions on the left side, from crown to bead."""
    labels = []
    for region in section.regions:
        x, y = millimetres(label_place(section, region))
        labels.append(Label(plain(region), -float(x), float(y)))
    return sorted(labels, key=lambda label: -label.y)


def sensor_labels(
    section: Section, places: dict[str, tuple[float, float]], texts: dict[str, str]
) -> tuple[list[Label], list[Label], list[Label]]:
    """Labels (inside, left, right) of named points (r, z); labels of points nearer the inner surface are inside."""
    inside: list[tuple[float, Label]] = []
    left: list[tuple[float, Label]] = []
    right: list[tuple[float, Label]] = []
    for name, place in places.items():
        s, depth = (float(np.ravel(value)[0]) for value in section.locate(np.array([place])))
        x, y = millimetres(place)
        label = Label(texts[name], float(x), float(y))
        inner = depth < float(section.total_thickness([s])[0]) / 2
        (inside if inner else right if x >= 0 else left).append((abs(s), label))
    ordered = [[label for _, label in sorted(group, key=lambda pair: pair[0])] for group in (inside, left, right)]
    return ordered[0], ordered[1], ordered[2]


def halo(width: float = 2.0) -> list[Any]:
    """White edge that keeps text readable on a dark map."""
    from matplotlib.patheffects import withStroke

    return [withStroke(linewidth=width, foreground="white")]


def marks(axes: Axes, labels: Sequence[Label]) -> None:
    """Draw circles at the labels' points."""
    if labels:
        axes.plot(
            [label.x for label in labels], [label.y for label in labels], "o", ms=FONT / 2, mfc="white", mec=INK,
            mew=1.0, zorder=7,
        )  # fmt: skip
