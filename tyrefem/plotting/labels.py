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
            blocks[-1] = [(blocks[-1][0] * blocks[-1][1] + mean * count) / (blocks[-1][1] + count), blocks[-1][1] + count]
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
    align : "left", "right", or "center": leaders then leave from the side their point is on.
    """
    if not labels:
        return
    count = len(labels)
    gap_now = min(gap, (high - low) / max(count - 1, 1))
    size = max(FONT * min(1.0, gap_now / gap), 5.0)
    # Their order is given, so each wants to be no higher than the one before.
    wanted = np.minimum.accumulate([min(max(label.y, low), high) for label in labels])
    places = -spread(-wanted, gap_now)
    places += max(low - places.min(), 0.0)
    places -= max(places.max() - high, 0.0)
    for label, y in zip(labels, places, strict=True):
        side = {"left": 0.0, "right": 1.0}.get(align, 1.0 if label.x >= x else 0.0)
        axes.annotate(
            label.text, (label.x, label.y), (x, float(y)), fontsize=size, ha=align, va="center", color=label.color,
            fontweight="bold" if label.bold else "normal", zorder=6, annotation_clip=False,
            arrowprops=_leader(side, label.color),
        )  # fmt: skip


def _leader(side: float, color: str) -> dict[str, Any]:
    return {"arrowstyle": "-", "lw": 0.7, "color": color, "relpos": (side, 0.5), "shrinkA": 1.0, "shrinkB": 2.5}


def line_ends(axes: Axes, labels: Sequence[Label], x: float, *, gap: float) -> None:
    """Names of lines at their right ends, in the lines' colours, moved apart where lines end together."""
    for label, y in zip(labels, spread([label.y for label in labels], gap), strict=True):
        axes.annotate(
            label.text, (label.x, label.y), (x, float(y)), fontsize=FONT, va="center", color=label.color,
            annotation_clip=False, arrowprops=_leader(0.0, label.color),
        )  # fmt: skip
