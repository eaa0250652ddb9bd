"""The phases of a drive on a time axis: start and name of each phase."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from tyrefem.reports.figures.style import FONT, QUIET, short, spread

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Name, start and end of a phase, in the axis's unit.
Phase = tuple[str, float, float]
SIZE = FONT - 1.5
#: Mean width of a letter, height of a line and space around a name, inches.
LETTER, LINE, ROOM = 0.0079 * SIZE, 0.0175 * SIZE, 0.05
#: Largest number of letters of a name.
LONGEST = 22


@dataclass(frozen=True)
class Name:
    """A name at ``x`` inches from the axis's start, for a phase with its middle at ``middle``."""

    text: str
    x: float
    middle: float
    upright: bool


def named(phases: Sequence[Phase], width: float) -> list[Name]:
    """Place names on an axis of ``width`` inches: horizontal if the phase is wide enough, else vertical.

    A vertical name is beside its phase if several narrow phases are neighbours. If not all names fit, the longest
    phases are named.

    >>> names = named([("roll", 0.0, 300.0), ("braking", 300.0, 303.0), ("skid", 303.0, 304.0)], 5.0)
    >>> [(name.text, name.upright) for name in names]
    [('roll', False), ('braking', True), ('skid', True)]
    """
    low, high = phases[0][1], max(end for _, _, end in phases)
    inches = width / ((high - low) or 1.0)
    spans = [(short(name, LONGEST), (start - low) * inches, (end - low) * inches) for name, start, end in phases]
    most = max(int(width / LINE), 1)
    spans = [spans[i] for i in sorted(sorted(range(len(spans)), key=lambda i: spans[i][1] - spans[i][2])[:most])]
    upright = [len(text) * LETTER + ROOM > end - start for text, start, end in spans]
    while True:
        narrow = [i for i, turned in enumerate(upright) if turned]
        places = _beside([(spans[i][1] + spans[i][2]) / 2 for i in narrow], width)
        level = {i: _level(spans[i], places) for i, turned in enumerate(upright) if not turned}
        crowded = [i for i, place in level.items() if place is None]
        if not crowded:
            break
        for i in crowded:
            upright[i] = True
    at = dict(zip(narrow, places, strict=True)) | {i: float(place) for i, place in level.items() if place is not None}
    return [Name(text, at[i], (start + end) / 2, upright[i]) for i, (text, start, end) in enumerate(spans)]


def _beside(wanted: list[float], width: float) -> list[float]:
    """Places of vertical names, at least a line apart and within the axis."""
    if not wanted:
        return []
    places = spread(wanted, LINE)
    places += max(LINE / 2 - places.min(), 0.0)
    places -= max(places.max() - (width - LINE / 2), 0.0)
    return [float(place) for place in places]


def _level(span: tuple[str, float, float], taken: Sequence[float]) -> float | None:
    """The middle of the widest space between vertical names in a phase; None if its name does not fit."""
    text, start, end = span
    edges = sorted([start, *(place for place in taken if start - LINE / 2 < place < end + LINE / 2), end])
    rooms = [
        (a + (LINE / 2 if a in taken else 0.0), b - (LINE / 2 if b in taken else 0.0))
        for a, b in itertools.pairwise(edges)
    ]
    a, b = max(rooms, key=lambda room: room[1] - room[0])
    return (a + b) / 2 if b - a > len(text) * LETTER + ROOM else None


def size_of(axes: Axes) -> tuple[float, float]:
    """Width and height of axes, inches."""
    box, (width, height) = axes.get_position(), axes.figure.get_size_inches()  # type: ignore[union-attr]
    return float(box.width * width), float(box.height * height)


def make_room(axes: Axes, phases: Sequence[Phase]) -> None:
    """Raise the upper axis limit, so that the names are above the lines."""
    if len(phases) < 2:
        return
    width, height = size_of(axes)
    needed = max(len(name.text) * LETTER if name.upright else LINE for name in named(phases, width)) + 2 * ROOM
    low, high = axes.get_ylim()
    axes.set_ylim(low, low + (high - low) / (1 - min(needed / height, 0.5)))


def draw_phases(axes: Axes, phases: Sequence[Phase], *, names: bool = True, shaded: bool = True) -> None:
    """Shade every second phase, or draw a dotted line at the start of each; write names at the top, with a line to
    phases that are too short for them."""
    if len(phases) < 2:
        return
    for number, (_, start, end) in enumerate(phases):
        if shaded and number % 2:
            axes.axvspan(start, end, color="#eef1f5", lw=0, zorder=0)
        if not shaded and number:
            axes.axvline(start, color=QUIET, lw=0.6, ls=":", zorder=0)
    if not names:
        return
    width, height = size_of(axes)
    low, high = phases[0][1], max(end for _, _, end in phases)
    per_inch = (high - low) / width
    top, below = 1 - 0.3 * ROOM / height, 1 - 1.6 * ROOM / height
    for name in named(phases, width):
        moved = name.upright and abs(name.x - name.middle) > 0.3 * LINE
        axes.annotate(
            name.text, (low + name.x * per_inch, below if moved else top), xycoords=("data", "axes fraction"),
            fontsize=SIZE, color=QUIET, ha="center", va="top", rotation=90 if name.upright else 0,
        )  # fmt: skip
        if moved:
            ends = low + np.array([name.middle, name.x]) * per_inch
            axes.plot(
                ends, [1.0, below], color=QUIET, lw=0.6, transform=axes.get_xaxis_transform(), scalex=False,
                scaley=False, zorder=1,
            )  # fmt: skip
