"""Names beside points, where they cover neither each other nor, as far as there is room, the points."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
#: Width of a character and height of a line, over the size of the font.
WIDE, HIGH = 0.65, 1.15
#: Gaps between a point and its name that are tried, in points; from a longer one a line leads to the point.
REACHES, NEAR = (4.0, 9.0, 16.0, 25.0, 36.0, 50.0), 10.0
DIRECTIONS = 16
#: Radius of a marker, in points.
MARKER = 3.0
#: What a place costs: another name below it, a place outside the axes, a named point, another point; per point of gap.
NAME, OUTSIDE, NAMED, OTHER, GAP = 1000.0, 300.0, 30.0, 4.0, 0.2


def name_points(axes: Any, points: Array, names: Sequence[str], others: Array, **words: Any) -> list[Array]:
    """Write names beside points; the limits of the axes must be final.

    Parameters
    ----------
    points : (n, 2) in data units. others : (m, 2), what names should not cover either.
    words : of the text, with ``fontsize`` and ``color``.

    Returns
    -------
    The box of each name: (left, bottom, right, top), in points of 1/72 inch of the figure.
    """
    axes.get_xlim(), axes.get_ylim()
    to_points = 72.0 / axes.figure.dpi
    named, rest = (axes.transData.transform(np.reshape(each, (-1, 2))) * to_points for each in (points, others))
    frame = np.array(axes.get_window_extent().extents) * to_points
    size = float(words["fontsize"])
    boxes: list[Array] = []
    for point, name in zip(named, names, strict=True):
        half = np.array([WIDE * len(name), HIGH]) * size / 2
        tried = [(reach, offset) for reach in REACHES for offset in _offsets(reach, half)]
        costs = [
            _cost(np.concatenate([point + offset - half, point + offset + half]), boxes, named, rest, frame)
            + GAP * reach
            for reach, offset in tried
        ]
        reach, offset = tried[int(np.argmin(costs))]
        boxes.append(np.concatenate([point + offset - half, point + offset + half]))
        leader = {"arrowstyle": "-", "lw": 0.6, "color": words["color"], "shrinkA": 0.0, "shrinkB": MARKER}
        axes.annotate(
            name, point, xycoords="figure points", xytext=tuple(offset), textcoords="offset points",
            ha="center", va="center", arrowprops=leader if reach > NEAR else None, **words,
        )  # fmt: skip
    return boxes


def _offsets(reach: float, half: Array) -> list[Array]:
    """Middles of a text about its point, the text at this gap; the upper right first."""
    angles = np.pi / 4 + 2 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    return [np.array([np.cos(a), np.sin(a)]) * (reach + half) for a in angles]


def _cost(box: Array, boxes: Sequence[Array], named: Array, rest: Array, frame: Array) -> float:
    covered = sum(bool((box[:2] < other[2:]).all() and (other[:2] < box[2:]).all()) for other in boxes)
    outside = bool((box[:2] < frame[:2]).any() or (box[2:] > frame[2:]).any())
    inside = [int(((each > box[:2] - MARKER) & (each < box[2:] + MARKER)).all(axis=1).sum()) for each in (named, rest)]
    return NAME * covered + OUTSIDE * outside + NAMED * inside[0] + OTHER * inside[1]
