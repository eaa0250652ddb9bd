"""Labels beside a picture: spread so that none overlaps another, each with a line to its point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyrefem.plotting.style import FONT, INK

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Label:
    """A text for a point (x, y) of the picture."""

    text: str
    x: float
    y: float
    bold: bool = False
    color: str = INK


def spread(wanted: ArrayLike, gap: float) -> Array:
    """Places nearest to the wanted ones (least squares), in their order of size and at least ``gap`` apart.

    >>> spread([0.0, 0.0, 10.0], 2.0).tolist()
    [-1.0, 1.0, 10.0]
    """
    wanted = np.asarray(wanted, dtype=float)
    order = np.argsort(wanted, kind="stable")
    # Minus the gaps the places must not fall: pool neighbours that would (isotonic regression).
    blocks: list[list[float]] = []
    for rank, place in enumerate(wanted[order]):
        blocks.append([place - rank * gap, 1.0])
        while len(blocks) > 1 and blocks[-2][0] > blocks[-1][0]:
            mean, count = blocks.pop()
            blocks[-1] = [
                (blocks[-1][0] * blocks[-1][1] + mean * count) / (blocks[-1][1] + count),
                blocks[-1][1] + count,
            ]
    values = np.concatenate([np.full(int(count), mean) for mean, count in blocks]) if blocks else np.empty(0)
    found = np.empty(len(wanted))
    found[order] = values + gap * np.arange(len(wanted))
    return found


def column(
    axes: Axes, labels: Sequence[Label], x: float, low: float, high: float, *, gap: float, align: str = "left"
) -> None:
    """Write labels at a column ``x``, in the order given from top to bottom, with leaders to their points.

    Parameters
    ----------
    low, high : the column's ends, in data units. gap : height of a line of text, in data units; where the labels
        do not fit, text and gap shrink together.
    align : "left" or "right": the side of the text that is at ``x``, from which the leaders start.
    """
    if not labels:
        return
    gap_now = min(gap, (high - low) / max(len(labels) - 1, 1))
    size = max(FONT * min(1.0, gap_now / gap), 4.0)
    # Their order is given, so each wants to be no higher than the one before.
    wanted = np.minimum.accumulate([min(max(label.y, low), high) for label in labels])
    places = -spread(-wanted, gap_now)
    # Up from the lower end, then down from the upper: together they fit.
    rising = gap_now * np.arange(len(places))
    places = np.maximum.accumulate((np.maximum(places, low) - rising[::-1])[::-1])[::-1] + rising[::-1]
    places = np.minimum.accumulate(np.minimum(places, high) + rising) - rising
    nearer = 0.25 * gap * (1 if align == "right" else -1)
    for label, y in zip(labels, places, strict=True):
        _write(axes, label, x, float(y), size, align)
    _leaders(axes, [((x + nearer, float(y)), (label.x, label.y)) for label, y in zip(labels, places, strict=True)])


def _write(axes: Axes, label: Label, x: float, y: float, size: float, align: str) -> None:
    text = axes.text(
        x, y, label.text, fontsize=size, ha=align, va="center", color=label.color,
        fontweight="bold" if label.bold else "normal", zorder=6,
    )  # fmt: skip
    text.set_in_layout(False)


def _leaders(axes: Axes, lines: list[Any], colors: Sequence[str] = (INK,)) -> None:
    """Thin lines with a pale edge, to be seen on every colour."""
    from matplotlib.collections import LineCollection

    axes.add_collection(LineCollection(lines, colors="white", lw=2.0, alpha=0.55, zorder=5), autolim=False)
    axes.add_collection(LineCollection(lines, colors=list(colors), lw=0.7, zorder=5), autolim=False)


def line_ends(axes: Axes, labels: Sequence[Label], *, room: float, size: float = FONT) -> None:
    """Names of lines to the right of their ends, in the lines' colours, apart where lines end together.

    ``room``: inches of paper right of the axes that the names may take.
    """
    if not labels:
        return
    figure = axes.figure
    box = axes.get_position()
    width, height = (float(v) for v in figure.get_size_inches())  # type: ignore[union-attr]
    low, high = axes.get_ylim()
    per_inch = (high - low) / (box.height * height)
    gap = min(1.35 * size / 72 * per_inch, (high - low) / len(labels))
    ordered = sorted(labels, key=lambda label: label.y)
    places = spread([label.y for label in ordered], gap)
    places += max(low - places.min(), 0.0)
    places -= max(places.max() - high, 0.0)
    inch = (axes.get_xlim()[1] - axes.get_xlim()[0]) / (box.width * width)
    longest = max(len(label.text) for label in labels)
    size = min(size, 72 * gap / per_inch / 1.3, (room - 0.25) / (longest * 0.0084))
    for label, y in zip(ordered, places, strict=True):
        axes.plot(
            [label.x, label.x + 0.2 * inch], [label.y, float(y)], color=label.color, lw=0.7, clip_on=False, zorder=5,
            scalex=False, scaley=False,
        )  # fmt: skip
        _write(axes, label, label.x + 0.24 * inch, float(y), size, "left")
