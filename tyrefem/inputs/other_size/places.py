"""Places in a section carried over to another: along the meridian between the same marks, in the same layer."""

from __future__ import annotations

import bisect
import math
from itertools import pairwise
from typing import Any

import numpy as np

from tyrefem.geometry import Section
from tyrefem.inputs.sensor_places import station_and_depth
from tyrefem.inputs.study_card import PLACE_KEYS, Sensor

#: A sensor stays this far from a groove, m.
BESIDE = 1e-3


def along(old: Section, new: Section, s: float, layer: str = "") -> float:
    """The station of another section that corresponds to a station, m.

    Linear between the marks that both have: crown and bead, ends of the regions of ``layer``, shoulder, ends of the
    other layers' regions and of the boundaries.
    """
    stations = [(0.0, 0.0), (old.line.length, new.line.length)]
    marks, others = _marks(old), _marks(new)
    pairs = {name: (marks[name], others[name]) for name in marks if name in others}
    ordered = [pair for name, pair in pairs.items() if name[0] == layer]
    ordered += [(old.line.shoulder_s, new.line.shoulder_s), *sorted(pairs.values())]
    for before, after in ordered:
        place = bisect.bisect([station for station, _ in stations], before)
        # A mark that would turn the order round, or that is at another one, is left out.
        if 0 < place < len(stations) and all(
            stations[place - 1][part] + 1e-6 < value < stations[place][part] - 1e-6
            for part, value in enumerate((before, after))
        ):
            stations.insert(place, (before, after))
    x, y = zip(*stations, strict=True)
    return math.copysign(float(np.interp(abs(s), x, y)), s)


def _marks(section: Section) -> dict[tuple[str, ...], float]:
    """Ends of parts by the names of layer, part and following part."""
    marks: dict[tuple[str, ...], float] = {}
    parts = [(layer.name, layer.regions.parts()) for layer in section.layers]
    for owner, divided in (*parts, ("outer", section.outer.parts())):
        for (name, _, end), (following, _, _) in pairwise(divided):
            marks[owner, name, following] = end
    return marks


def same_depth(old: Section, new: Section, s: float, depth: float) -> tuple[float, float]:
    """(s, depth) in another section, m: in the same layer at the same share of its thickness."""
    before = old.interfaces(np.array(s))
    y = float(before[0]) + depth
    layer = int(np.clip(np.searchsorted(before, y) - 1, 0, len(before) - 2))
    station = along(old, new, s, old.built_layers[layer].name)
    after = new.interfaces(np.array(station))
    if len(before) != len(after):
        share = depth / float(before[-1] - before[0])
        return station, share * float(after[-1] - after[0])
    share = (y - float(before[layer])) / float(before[layer + 1] - before[layer])
    return station, float(after[layer] + share * (after[layer + 1] - after[layer]) - after[0])


def carried(sensor: Sensor, data: dict[str, Any], old: Section, new: Section) -> dict[str, Any]:
    """A sensor's table for another section. ``data``: as written; its other keys stay.

    A sensor below the surface stays as deep below it if the wall is that thick, else goes to the middle. One at a place
    by name alone stays there.
    """
    if sensor.place is not None and sensor.depth is None and sensor.below_surface is None:
        return data
    s, depth = station_and_depth(sensor, old)
    station, deep = same_depth(old, new, s, depth)
    if not old.in_groove(s):
        station = _beside_grooves(new, station)
    station = float(np.clip(station, -new.line.length, new.line.length))
    wall = float(new.rubber_thickness([station])[0])
    place: dict[str, Any] = {"s": _millimetres(station, 1)}
    if sensor.below_surface is not None:
        place["below_surface"] = data["below_surface"] if sensor.below_surface <= wall else _millimetres(wall / 2, 3)
    else:
        place["depth"] = _millimetres(min(deep, wall), 3)
    return {**place, **{key: value for key, value in data.items() if key not in PLACE_KEYS}}


def _beside_grooves(section: Section, s: float) -> float:
    """A station in a groove moved to its nearer side."""
    for start, end in section.grooves:
        if start - BESIDE < abs(s) < end + BESIDE:
            nearer = start - BESIDE if abs(s) - start < end - abs(s) and start > BESIDE else end + BESIDE
            return math.copysign(nearer, s)
    return s


def _millimetres(value: float, digits: int) -> str:
    """A length rounded towards zero, so that it stays within the wall."""
    step = 10.0**digits
    return f"{math.trunc(value * 1e3 * step + 1e-6) / step:g} mm"
