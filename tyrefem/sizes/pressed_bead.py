"""The bead before inflation, from the inflated one: plies press what lies between them and the rim's flange.

Plies with the tension N_phi that bend round the flange with the radius R press with N_phi/R. A bead of thickness h
(flange to plies) then gives way by

    d = h N_phi / (R E),    N_phi = p A / (2 r sin alpha)  (`tyrefem.sizes.membrane`),

E its modulus in plane strain: along the circumference it cannot widen. The inflated plies shall lie evenly about the
flange, on a circle of radius R about its centre. Before inflation they leave the flange by d further away: the bend
begins at the same straight part beside the seat, turns by the same angle t, and has the radius

    R + d / (1 - cos t).
"""

from __future__ import annotations

import numpy as np

from tyrefem.sizes.meridian import SizedMeridian
from tyrefem.sizes.rules import Rules

#: A bead gives way by at most this share of its thickness, and its bend is larger by at most this share.
MOST_PRESSED, MOST_LARGER = 0.25, 0.35


def pressed_by(line: SizedMeridian, pressure: float, modulus: float) -> float:
    """d, m, where the plies of ``line`` leave the flange; ``modulus``: E, Pa.

    ``line``: that of the inflated tyre, bent evenly about the flange.
    """
    r = line.at(line.flange_s)[0]
    return float(line.offset * pressure * line.membrane.tension(r) / (line.bend * modulus))


def bend_before(line: SizedMeridian, pressed: float) -> float:
    """Radius of the bend before inflation, m, of plies that inflation presses by ``pressed``, m, on to ``line``."""
    larger = pressed / (1 - float(np.cos(line.rim.taper - line.leaves)))
    return line.bend + min(larger, MOST_LARGER * line.bend)


def bend_radius(rule: Rules, line: SizedMeridian, pressure: float, modulus: tuple[float, str]) -> float:
    """Rules of the bead's modulus, of what the plies press it by, and of the radius of their bend before inflation.

    ``modulus``: E, Pa, and its source.
    """
    stiff = rule("bead_modulus", modulus[0], "MPa", modulus[1], 1e6, 1e12)
    most = MOST_PRESSED * line.offset
    words = "solved for: the plies' pull over their bend's radius, on what lies between them and the flange"
    pressed = rule("bead_pressed", min(pressed_by(line, pressure, stiff), most), "mm", words, 0.0, most)
    words = (
        "flange_radius and what lies outside of the plies; larger, so that before inflation they leave the flange "
        "by bead_pressed further away"
    )
    return rule("bend_radius", bend_before(line, pressed), "mm", words, 3e-3)
