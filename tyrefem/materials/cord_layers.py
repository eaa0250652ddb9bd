"""Cord layers in their section: check that they fit, and the masses of the regions."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.materials.card import MaterialCard

if TYPE_CHECKING:
    from tyrefem.geometry import Section

Array = NDArray[np.float64]


def region_thickness(section: Section, region: str) -> Array:
    """Smallest and largest thickness [m] of the layer within this region, over all its pieces."""
    section.require_region(region)
    return np.array(_thickness_range(section, region))


@functools.lru_cache(maxsize=256)
def _thickness_range(section: Section, region: str) -> tuple[float, float]:
    if section.wrapping is not None and region == section.wrap:
        return section.wrapping.thickness, section.wrapping.thickness
    values = []
    for piece in section.pieces:
        if piece.region == region:
            inside = [s for s in section.breaks if piece.start < s < piece.end]
            stations = np.array([piece.start, *inside, *np.linspace(piece.start, piece.end, 30)])
            values.append(section.built_layers[piece.layer].thickness(stations))
    together = np.concatenate(values)
    return float(together.min()), float(together.max())


@functools.lru_cache(maxsize=256)
def _greatest_radius(section: Section, region: str) -> float:
    """Greatest radius of a region, m; studies with changed materials ask for that of the same section."""
    return max(float(outline[:, 0].max()) for outline in section.outline(region))


def check_cords_fit(card: MaterialCard, section: Section, region: str) -> None:
    """Raise `InputError` for cords that do not fit the region: too thick, too dense, or lifted too far.

    >>> from tyrefem.materials.card import material
    >>> from tyrefem.geometry import load
    >>> check_cords_fit(material("passenger-belt"), load("passenger-205-55r16"), "belt-1")
    """
    cords = card.cords
    if cords is None:
        return
    least = float(region_thickness(section, region)[0])
    try:
        cords.volume_fraction(least)
    except InputError as error:
        raise error.within(field="cords") from None
    if cords.angle_radius is None or not cords.lift:
        return
    furthest = _greatest_radius(section, region)
    if not 0.2 <= cords.angle_radius / (section.outer_diameter / 2) <= 1.0:
        raise InputError(
            f"{cords.angle_radius:.4g} m is not on the tyre, whose outer radius is {section.outer_diameter / 2:.4g} m",
            field="cords.angle_radius",
        )
    if math.cos(cords.angle) * furthest / cords.angle_radius >= 1:
        raise InputError(
            f"with {math.degrees(cords.angle):.4g} deg at r = {cords.angle_radius:.4g} m the lift law has no angle at"
            f" r = {furthest:.4g} m, where the region reaches",
            field="cords.angle",
        )


def masses(section: Section, materials: Mapping[str, MaterialCard], temperature: float = 25.0) -> dict[str, float]:
    """Mass of the whole tyre by region [kg]: volume of the ring x density at a temperature (degC).

    Transverse grooves of a ``[pattern]`` are empty.
    """
    left = {} if section.pattern is None else {section.patterned: section.pattern.rubber}
    return {
        region: left.get(region, 1.0) * volume * materials[region].density.at(temperature)
        for region, volume in _whole_volumes(section)
    }


@functools.lru_cache(maxsize=32)
def _whole_volumes(section: Section) -> tuple[tuple[str, float], ...]:
    """(region, volume) of the whole tyre, m3. The values of the 32 latest sections are kept for all studies."""
    sides = 2.0 if section.half else 1.0
    return tuple((region, sides * section.volume(region)) for region in section.regions)
