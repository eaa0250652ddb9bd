"""Places of a study's thermocouples."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tyrefem.errors import InputError
from tyrefem.geometry.named_places import named_place
from tyrefem.inputs.study_card import Sensor

if TYPE_CHECKING:
    from tyrefem.geometry import Section


def sensor_places(
    sensors: Mapping[str, Sensor], section: Section, file: Path | None
) -> Mapping[str, tuple[float, float]]:
    """Stated (r, z) of every sensor, m.

    Raises
    ------
    InputError : a sensor is outside the rubber.
    """
    places = _together(sensors, section)
    if places is not None:
        return places
    places = {}
    for name, sensor in sensors.items():
        try:
            places[name] = sensor_place(sensor, section)
        except InputError as error:
            raise error.within(field=f"sensors.{name}", file=file) from None
    return places


def _together(sensors: Mapping[str, Sensor], section: Section) -> dict[str, tuple[float, float]] | None:
    """The places of sensors that are all given by ``s`` and are all in the rubber; None: not so."""
    stations = [sensor.s for sensor in sensors.values()]
    if not stations or any(s is None for s in stations):
        return None
    s, length = np.array(stations, dtype=float), section.line.length
    thickness = section.rubber_thickness(s)
    pairs = [(sensor.depth, sensor.below_surface) for sensor in sensors.values()]
    given = np.array([depth if below is None else below for depth, below in pairs], dtype=float)
    lowest = 0.0 if section.half else -length
    if (s < lowest).any() or (s > length).any() or (given > thickness * (1 + 1e-9)).any():
        return None
    inside = np.minimum(given, thickness)
    below = np.array([each is not None for _, each in pairs])
    points = section.place(s, np.where(below, thickness - inside, inside))
    return {name: (float(r), float(z)) for name, (r, z) in zip(sensors, points, strict=True)}


def sensor_place(sensor: Sensor, section: Section) -> tuple[float, float]:
    """(r, z) of a sensor in a section before wear, m.

    Raises
    ------
    InputError : the sensor is outside the rubber.
    """
    if sensor.at is not None:
        r, z = sensor.at
        if section.half and z < -1e-9:
            raise InputError(
                f"the sensor is outside the rubber: z = {z * 1e3:.1f} mm is on the side that a half section leaves "
                f"out; give the mirrored place, z = {-z * 1e3:.1f} mm, or [mesh] section = 'full'"
            )
        if not section.contains([[r, z]])[0]:
            s, depth = section.locate([[r, z]])
            raise InputError(
                f"at (r, z) = ({r * 1e3:.1f}, {z * 1e3:.1f}) mm the sensor is outside the rubber; the nearest "
                f"meridian point is s = {float(s[0]) * 1e3:.1f} mm, where the rubber is "
                f"{float(section.rubber_thickness(s)[0]) * 1e3:.1f} mm thick (depth there "
                f"{float(depth[0]) * 1e3:.1f} mm)"
            )
        return float(r), float(z)
    along, deep = station_and_depth(sensor, section)
    place = section.place([along], [deep])[0]
    return float(place[0]), float(place[1])


def station_and_depth(sensor: Sensor, section: Section) -> tuple[float, float]:
    """(s, depth) of a sensor in a section before wear, m: as stated, or of its ``place`` or of ``at``.

    Raises
    ------
    InputError : ``s`` is off the section, or the wall is thinner there; the section has no such place.
    """
    if sensor.at is not None:
        stations, depths = section.locate([sensor.at])
        return float(stations[0]), float(depths[0])
    if sensor.place is not None:
        s, depth = named_place(section, sensor.place)
        if sensor.depth is None and sensor.below_surface is None:
            return s, depth
    else:
        assert sensor.s is not None
        s, length = sensor.s, section.line.length
        lowest = 0.0 if section.half else -length
        if not lowest <= s <= length:
            raise InputError(
                f"s = {s * 1e3:.1f} mm is off the section; allowed: {lowest * 1e3:.1f} to {length * 1e3:.1f} mm"
            )
    return s, depth_of(s, sensor.depth, sensor.below_surface, section)


def depth_of(s: float, depth: float | None, below_surface: float | None, section: Section) -> float:
    """Depth from the inner surface at a station, m, of which either that or the depth below the outer surface is given.

    Raises
    ------
    InputError : the wall is thinner there.
    """
    thickness = float(section.rubber_thickness([s])[0])
    name, given = ("depth", depth) if below_surface is None else ("below_surface", below_surface)
    assert given is not None
    if given > thickness * (1 + 1e-9):
        raise InputError(
            f"{name} = {given * 1e3:.2f} mm is outside the rubber, which is {thickness * 1e3:.2f} mm thick "
            f"at s = {s * 1e3:.1f} mm"
        )
    inside = min(given, thickness)
    return inside if below_surface is None else thickness - inside
