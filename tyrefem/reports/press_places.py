"""Places of a pressed tyre whose strain cycle is written: given ones, or those of greatest loss."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from tyrefem.errors import InputError, nearest
from tyrefem.quantity import parse

if TYPE_CHECKING:
    from tyrefem.geometry.section import Section
    from tyrefem.mechanics.footprint.press import Pressed


@dataclass(frozen=True)
class CyclePlace:
    """A Gauss point: name, region, element and point numbers, and (r, z) before inflation, m."""

    name: str
    region: str
    element: int
    point: int
    place: tuple[float, float]


def read_place(section: Section, text: str) -> str | tuple[float, float]:
    """Parse a place: a region's name such as ``"sidewall"``, or (r, z) in m from ``"287 mm, 80 mm"``.

    Raises
    ------
    InputError : the text is neither a region of the section nor a place in it.

    >>> from tyrefem.geometry import load
    >>> read_place(load("nasa-22x5.5-8pr"), "275 mm, 2 cm")
    (0.275, 0.02)
    """
    name = text.strip()
    if "," not in name:
        if name not in section.regions:
            words = nearest(name, section.regions)
            raise InputError(f"'{name}' is neither a place like '287 mm, 80 mm' (r, z) nor a region{words}", field="at")
        return name
    parts = name.split(",")
    if len(parts) != 2:
        raise InputError(f"'{name}' is not a place; expected r and z like '287 mm, 80 mm'", field="at")
    try:
        r, z = (parse(part.strip(), "m") for part in parts)
    except InputError as error:
        raise error.within(field="at") from None
    place = [[r, abs(z) if section.half else z]]
    if not section.contains(place, tolerance=1e-4)[0]:
        close = section.place(*section.clamp(*section.locate(place), 1e-4))[0] * 1e3
        raise InputError(
            f"'{name}' is not in the section, whose nearest point is '{close[0]:.1f} mm, {close[1]:.1f} mm'", field="at"
        )
    return r, z


def cycle_places(pressed: Pressed, wanted: Iterable[str] = ()) -> tuple[CyclePlace, ...]:
    """The wanted places; by default the outermost edge of the belt, if there is one, and the place of greatest loss.

    Parameters
    ----------
    pressed : the tyre. wanted : places as in `read_place`, before inflation; a region means its place of greatest loss.

    Raises
    ------
    InputError : an entry is neither a place in the section nor a region.
    """
    places = () if isinstance(wanted, str) or not isinstance(wanted, Iterable) else tuple(wanted)
    if (not places and wanted) or not all(isinstance(text, str) for text in places):
        raise InputError(f"must be a list of places or regions, like ['tread'], not {wanted!r:.60}", field="at")
    return tuple(_wanted(pressed, text) for text in places) or _usual(pressed)


def _wanted(pressed: Pressed, text: str) -> CyclePlace:
    wanted = read_place(pressed.study.section, text)
    if isinstance(wanted, str):
        return _worst(pressed, wanted, wanted)
    r, z = wanted
    return _nearest(pressed, text.strip(), r, abs(z) if pressed.study.section.half else z)


def _nearest(pressed: Pressed, name: str, r: float, z: float) -> CyclePlace:
    points = pressed.tyre.body.rings.points
    element, point = np.unravel_index(int(np.hypot(points[0] - r, points[1] - z).argmin()), points.shape[1:])
    return _place(pressed, name, int(element), int(point))


def _place(pressed: Pressed, name: str, element: int, point: int) -> CyclePlace:
    rings = pressed.tyre.body.rings
    r, z = rings.points[:, element, point]
    return CyclePlace(name, rings.region_of(element), element, point, (float(r), float(z)))


def _worst(pressed: Pressed, name: str, region: str | None = None) -> CyclePlace:
    """The place of greatest loss per volume; without rolling, the place of greatest strain change."""
    if pressed.loss is not None:
        density = np.array(pressed.loss.density)
    else:
        density = np.array(pressed.cycle.storage_products[1:].sum(axis=0))
    if region is not None:
        outside = np.ones(len(density), dtype=bool)
        outside[np.asarray(pressed.tyre.body.mesh.subdomains[region])] = False
        density[outside] = -1.0
    element, point = (int(i) for i in np.unravel_index(int(density.argmax()), density.shape))
    return _place(pressed, name, element, point)


def _usual(pressed: Pressed) -> tuple[CyclePlace, ...]:
    """The edge of the widest belt, and the place of greatest loss."""
    points, subdomains = pressed.tyre.body.rings.points, pressed.tyre.body.mesh.subdomains
    belts = [region for region in pressed.tyre.body.parts if "belt" in region]
    places = []
    if belts:
        widest = max(belts, key=lambda region: float(points[1][subdomains[region]].max()))
        members = np.asarray(subdomains[widest])
        element, point = np.unravel_index(int(points[1][members].argmax()), points[1][members].shape)
        places.append(_place(pressed, f"edge of {widest}", int(members[element]), int(point)))
    return (*places, _worst(pressed, "greatest loss"))
