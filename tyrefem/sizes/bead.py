"""The bead bundle: so much wire as the plies' pull at several times the rated pressure needs."""

from __future__ import annotations

from tyrefem.sizes.rules import Rules

#: Strength of bead wire, Pa, and how many times the rated pressure it holds (estimates of practice).
WIRE_STRENGTH, WIRE_SAFETY = 1.9e9, 8.0
#: Height of the widest place over the rim, as a share of the plies' height (estimate; solved exactly for the line).
WIDEST = 0.6


def bead_wire_area(rule: Rules, crown: float, rim_diameter: float, pressure: float) -> float:
    """Rule of the wires' section, m2: A = n p (r_c^2 - r_m^2)/2 / strength, the radial part of the plies' pull."""
    widest = rim_diameter / 2 + WIDEST * (crown - rim_diameter / 2)
    tension = pressure * (crown**2 - widest**2) / 2
    source = f"estimate: holds {WIRE_SAFETY:g} times the rated pressure with wire of {WIRE_STRENGTH / 1e9:g} GPa"
    return rule("bead_wire_area", WIRE_SAFETY * tension / WIRE_STRENGTH, "mm**2", source, 1e-7, 1e-2)
