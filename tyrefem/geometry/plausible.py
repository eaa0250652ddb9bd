"""Warnings for unlikely sections, which can be built but may be mistakes; `checks` has the errors."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tyrefem.cards.plausible import BLOCK_LENGTH, RATED_LOAD, RATED_PRESSURE, WIRE_AREA
from tyrefem.errors import InputWarning
from tyrefem.geometry import measures
from tyrefem.geometry.layer import Layered

Array = NDArray[np.float64]
#: Length of a table beyond the meridian's end, over its length, from which it was made for another one (a judgement).
OVERHANG = 0.05
#: Range of section width over nominal width: shipped tyres have 1.01 to 1.15, cars 0.96 to 1.06 by standards.
WIDTH = (0.85, 1.25)
#: Range of rated width and diameter over those of the section.
RATED = (0.85, 1.15)
#: Range of a measured over the drawn volume of the contained air (a judgement).
VOLUME = (0.5, 2.0)
#: Smallest turn of the meridian, rad, that is not rounding of its points: 0.1 mm in 6 mm are 1.9 deg.
ROUNDING = np.radians(3.0)
#: Kinks: smallest curvature over the meridian's mean; smallest turn, rad. Shipped lines reach 2.1 (judgements).
KINK, CORNER = 5.0, np.radians(10.0)


def warnings_of(section: Layered) -> tuple[InputWarning, ...]:
    """Warnings for unlikely values of a section, with the fields of its card.

    >>> from tyrefem.geometry import load
    >>> warnings_of(load("passenger-205-55r16"))
    ()
    >>> print(*warnings_of(load({"base": "passenger-205-55r16", "rating": {"width": "255 mm"}})))
    rating.width: the rated width is 255 mm and the nominal width 205 mm: check that the ratings are of this tyre
    """
    return (*_tables(section), *_widths(section), *_numbers(section), *_meridian(section))


def _tables(section: Layered) -> Iterator[InputWarning]:
    """Rows beyond the end of the meridian, which have no effect, and tables made for a longer meridian."""
    length = section.line.length
    for index, layer in enumerate(section.built_layers):
        stations = np.asarray(layer.thickness.s)
        beyond = int(np.sum(stations[:-1] >= length - 1e-9))
        overhang = float(stations[-1]) - length
        if beyond or overhang > OVERHANG * length:
            lost = (
                f"its last {beyond} row{'s have' if beyond > 1 else ' has'} no effect" if beyond else "it is cut there"
            )
            yield InputWarning(
                f"the table of '{layer.name}' goes on to {stations[-1] * 1e3:.4g} mm, but the meridian ends at "
                f"{length * 1e3:.4g} mm: {lost}",
                field=f"layers.{index}.s",
            )


def _widths(section: Layered) -> Iterator[InputWarning]:
    """Widths and diameters that belong to different tyres."""
    ratio = section.overall_width / section.nominal_width
    if not WIDTH[0] <= ratio <= WIDTH[1]:
        yield InputWarning(
            f"the section is {section.overall_width * 1e3:.4g} mm wide, but its nominal width is "
            f"{section.nominal_width * 1e3:.4g} mm; a tyre is {WIDTH[0]:g} to {WIDTH[1]:g} times as wide",
            field="parameters.nominal_width",
        )
    rating = section.rating
    if rating is None:
        return
    for name, rated, drawn, words in (
        ("width", rating.width, section.nominal_width, "nominal width"),
        ("diameter", rating.diameter, section.outer_diameter, "outer diameter"),
    ):
        if not RATED[0] <= rated / drawn <= RATED[1]:
            yield InputWarning(
                f"the rated {name} is {rated * 1e3:.4g} mm and the {words} {drawn * 1e3:.4g} mm: "
                "check that the ratings are of this tyre",
                field=f"rating.{name}",
            )


def _numbers(section: Layered) -> Iterator[InputWarning]:
    """Volume, rating and pattern: numbers of a slipped unit or decimal point."""
    drawn = 2 * measures.gas_volume(section) if section.half else measures.gas_volume(section)
    volume = section.inner_volume
    if volume is not None and not VOLUME[0] <= volume / drawn <= VOLUME[1]:
        yield InputWarning(
            f"the measured volume is {volume * 1e3:.4g} l, but the section encloses {drawn * 1e3:.4g} l: check the "
            "unit",
            field="parameters.inner_volume",
        )
    if section.pattern is not None:
        yield from filter(None, [BLOCK_LENGTH.warning(section.pattern.block_length, "pattern.block_length")])
    rating = section.rating
    if rating is not None:
        numbers = {"load": RATED_LOAD, "pressure": RATED_PRESSURE, "bead_wire_area": WIRE_AREA}
        unlikely = (likely.warning(getattr(rating, name), f"rating.{name}") for name, likely in numbers.items())
        yield from filter(None, unlikely)


def _meridian(section: Layered) -> Iterator[InputWarning]:
    """Kinks, and intervals with the wrong curvature: pressure moves a wall outwards and turns it there.

    The meridian of a tyre is convex from the crown and may be hollow once, towards the bead.
    """
    s = np.linspace(0.0, section.line.length, 2001)
    curvature = section.line.curvature(s)
    turns = curvature * s[1]
    stretches = [(first, last, float(turns[first:last].sum())) for first, last in _stretches(turns)]
    # Hollow intervals, except the one towards the bead.
    wrong = [
        f"s = {s[first] * 1e3:.0f} to {s[last - 1] * 1e3:.0f} mm ({np.degrees(-turn):.0f} deg)"
        for number, (first, last, turn) in enumerate(stretches)
        if turn < 0 and number < len(stretches) - 1
    ]
    if wrong:
        yield InputWarning(
            f"the meridian is hollow at {', '.join(wrong)} and bends back outwards behind: inflated, the wall turns "
            "there; smooth its points",
            field="line.points",
        )
    kinks = list(_kinks(section, s, curvature))
    if kinks:
        yield InputWarning(f"the meridian has a kink at {', '.join(kinks)}; smooth its points", field="line.points")


def _stretches(turns: Array) -> list[tuple[int, int]]:
    """(first, last + 1) of intervals of one sign that turn by more than rounding; the others are joined to these."""
    borders = [0, *(np.flatnonzero(np.diff(np.sign(turns)) != 0) + 1).tolist(), len(turns)]
    stretches: list[tuple[int, int]] = []
    for first, last in pairwise(borders):
        turn = turns[first:last].sum()
        if abs(turn) < ROUNDING:
            continue
        if stretches and np.sign(turns[slice(*stretches[-1])].sum()) == np.sign(turn):
            stretches[-1] = (stretches[-1][0], last)
        else:
            stretches.append((first if stretches else 0, last))
    return stretches


def _kinks(section: Layered, s: Array, curvature: Array) -> Iterator[str]:
    """Descriptions of corners: radius smaller than the wall thickness, or far smaller than elsewhere on the line."""
    thickness = section.total_thickness(s)
    mean = float(np.abs(curvature).mean())
    tight = np.abs(curvature) > np.minimum(1 / thickness, KINK * mean)
    borders = np.flatnonzero(np.diff(np.concatenate([[0], tight.astype(int), [0]])))
    for first, last in zip(borders[::2], borders[1::2], strict=True):
        turn = abs(float((curvature[first:last] * s[1]).sum()))
        if turn < CORNER:
            continue
        peak = first + int(np.argmax(np.abs(curvature[first:last])))
        yield (
            f"s = {s[peak] * 1e3:.0f} mm ({np.degrees(turn):.0f} deg, radius {1e3 / abs(curvature[peak]):.3g} mm "
            f"in a wall {thickness[peak] * 1e3:.3g} mm thick)"
        )
