"""The shipped tyres' arcs at any load, for the tests of the strain cycle."""

from __future__ import annotations

from dataclasses import replace

import tyrefem as tf
from tyrefem.mechanics.arcs import Arcs
from tyrefem.simulation.rolling_tyre import RollingTyre

INCH, PSI = 0.0254, 6894.757293168361
NAMES = ("nasa-22x5.5-8pr", "nasa-22x5.5-12pr")


def shipped(name):
    """The strain cycle of a shipped study."""
    return RollingTyre(tf.study(name)).schedule.cycles[0][0]


def at(cycle, deflection=None, stiffness=None, drum=None, **load):
    """The same tyre at another deflection (m), stiffness or drum diameter (m)."""
    case = replace(cycle.case, **load)
    case = case if deflection is None else replace(case, deflection=deflection)
    case = case if drum is None else replace(case, drum_diameter=drum)
    return Arcs(cycle.section, cycle.stiffness if stiffness is None else stiffness, case)


def nodes(cycle):
    """Zone -> points (2, n) spread over the zone, and the area-weights r dA of a quadrature, (n,)."""
    import numpy as np

    section, places_of_zones = cycle.section, {}
    for zone in cycle.zones:
        places, weights = [], []
        for piece in section.pieces:
            start, end = max(piece.start, zone.start), min(piece.end, zone.end)
            if piece.region != zone.region or end <= start:
                continue
            s = start + (np.arange(24) + 0.5) / 24 * (end - start)
            faces = section.interfaces(s)
            for fraction in (np.arange(6) + 0.5) / 6:
                y = faces[piece.layer] + fraction * (faces[piece.layer + 1] - faces[piece.layer])
                points = section.place(s, y - faces[0])
                width = (faces[piece.layer + 1] - faces[piece.layer]) / 6 * (1 + section.line.curvature(s) * y)
                places.append(points)
                weights.append(points[:, 0] * width * (end - start) / 24)
        places_of_zones[zone.name] = np.concatenate(places).T, np.concatenate(weights)
    return places_of_zones
