"""Radial aircraft tyres: ``46x17R20``, ``1400x530R23``."""

from __future__ import annotations

import math

from tyrefem.sizes.aircraft import BEAD_MODULUS, aircraft_numbers
from tyrefem.sizes.bead import bead_wire_area
from tyrefem.sizes.belt import Belt
from tyrefem.sizes.cards import radial_cards
from tyrefem.sizes.designation import INCH, TyreSize
from tyrefem.sizes.drawn import Drawn
from tyrefem.sizes.radial import Radial
from tyrefem.sizes.radial_layers import RadialLayers
from tyrefem.sizes.radial_line import with_line
from tyrefem.sizes.rules import Rules

BEAD_FILL = 0.7
ESTIMATE = "estimate: ordinary practice"
#: How many times the rated pressure plies and belts hold; strength of a ply's cord, N, and of a belt, N/m (estimates).
SAFETY, CORD_STRENGTH, BELT_STRENGTH = 4.0, 300.0, 900 * 600.0
#: Ends of a ply at the crown, 1/m, where its cords do not overlap at the bead; diameter of its cord, m (estimates).
PLY_ENDS, CORD = 780, 0.75e-3
#: Ply rating per inch of width where the size names none (the data book's bias tyres: half have 1.35 to 1.97).
RATING = 1.8


def draw(size: TyreSize, rule: Rules) -> Drawn:
    """Nylon body plies and textile belts near the circumference, as many as hold four times the rated pressure."""
    rim, pressure = aircraft_numbers(size, rule, max(4, 2 * round(RATING * size.width / INCH / 2)))
    _crown(rule, size.width)
    _plies(rule, rim.diameter, pressure)
    counts = _belt_plies(rule, pressure)
    _rubber(rule, size.width)
    _bead(rule, rim.diameter, pressure)
    belts = (Belt("inner-belts", 2.6e-3), Belt("outer-belts", 2.2e-3))
    radial = Radial(
        size,
        rule,
        rim,
        "body-plies",
        belts,
        (("apex", 1.0),),
        f"{size.text} radial aircraft tyre by its size",
        reinforced=True,
        belt_power=(6.0, f"{ESTIMATE}: many belt plies near the circumference carry an even share to near their edge"),
    )
    radial = with_line(radial, BEAD_MODULUS)
    widest = rule(
        "inner_belts_width", 2 * radial.tread.edge, "mm", f"{ESTIMATE}, as wide as the plies under the tread", 0.02
    )
    rule("outer_belts_width", 0.90 * widest, "mm", f"{ESTIMATE}, 0.9 of the inner belts'", 0.02)
    rule.check_all_used()
    ply = radial.ply_card("aircraft-body-ply", PLY_ENDS, CORD)
    belt_cards = {
        belt.region: radial.belt_card(belt, "aircraft-belt", ends=f"{900 * count} 1/m", plies=count)
        for belt, count in zip(belts, counts, strict=True)
    }
    bead_card = radial.bead_material("aircraft-bead", 1e-3)
    materials = radial_cards("body-plies", ply, belt_cards, "rubber-tread-aircraft", bead_card)
    return RadialLayers(radial).drawn(materials | radial.fabric_card())


def _crown(rule: Rules, width: float) -> None:
    """Width and radii of the crown."""
    rule("tread_width", 0.78 * width, "mm", f"{ESTIMATE}, 0.78 nominal widths", 0.3 * width)
    rule("crown_radius", 1.5 * width, "mm", f"{ESTIMATE}, 1.5 nominal widths; of the plies' line", 0.05, 20)
    rule("tread_radius", 1.8 * width, "mm", f"{ESTIMATE}, 1.8 nominal widths; of the tread's surface", 0.05, 20)


def _height(rule: Rules, rim_diameter: float) -> float:
    """The section's height, m."""
    return (rule["outer_diameter"].value - rim_diameter) / 2


def _plies(rule: Rules, rim_diameter: float, pressure: float) -> None:
    """Angle, number and gauge of the body plies."""
    rule("cord_angle", math.pi / 2, "deg", "radial body plies", 1.4, 1.5708)
    # From the bead to the crown, about 16 mm below the tread's surface, the cords move apart.
    ends = min(PLY_ENDS, rim_diameter / 2 / (rule["outer_diameter"].value / 2 - 16e-3) / CORD)
    plies = max(2, math.ceil(SAFETY * 0.55 * _height(rule, rim_diameter) * pressure / (ends * CORD_STRENGTH)))
    rule("plies", plies, "1", f"estimate: cords hold {SAFETY:g} times the rated pressure, pull 0.55 p x height", 1, 20)
    rule("ply_gauge", 1.1e-3, "mm", f"{ESTIMATE}, nylon 0.75 mm in rubber", 5e-4)


def _belt_plies(rule: Rules, pressure: float) -> tuple[int, int]:
    """Number and gauge of the belt plies; returns how many are inner and outer ones."""
    needed = max(4, 2 * math.ceil(SAFETY * pressure * rule["outer_diameter"].value / 2 / BELT_STRENGTH / 2))
    source = f"estimate: belts hold {SAFETY:g} times the rated pressure, pull p x radius"
    count = round(rule("belt_plies", needed, "1", source, 2, 30))
    one_ply = rule("belt_ply_gauge", 1.0e-3, "mm", f"{ESTIMATE}, cord 0.75 mm in rubber", 5e-4)
    first, second = (count + 1) // 2, count // 2
    rule("inner_belts_gauge", first * one_ply, "mm", f"{first} belt plies", 5e-4)
    rule("outer_belts_gauge", second * one_ply, "mm", f"{second} belt plies", 5e-4)
    return first, second


def _rubber(rule: Rules, width: float) -> None:
    """Gauges of liner, tread and sidewall; grooves."""
    rule("liner_gauge", 1.6e-3, "mm", f"{ESTIMATE}, tubeless", 3e-4)
    rule("undertread_gauge", 2.1e-3, "mm", ESTIMATE, 3e-4)
    rule("tread_gauge", 8e-3 + 0.015 * width, "mm", "estimate: 8 mm + 0.015 widths", 2e-3)
    rule("grooves", 0 if width < 0.2 else 4, "1", f"{ESTIMATE}; 0: smooth", 0, 9)
    rule("groove_share", 0.15, "1", f"{ESTIMATE}: of the tread's width", 0.01, 0.6)
    rule("sidewall_gauge", 2.5e-3, "mm", f"{ESTIMATE}: rubber at the widest place", 1.2e-3)
    left = "estimate: what a belt's layer has left beyond its cushion, sidewall rubber as well"
    rule("rest_gauge", 0.6e-3, "mm", left, 2e-4)
    rule("chafer_gauge", 3e-3, "mm", f"{ESTIMATE}: rim strip at the bead", 1.2e-3)


def _bead(rule: Rules, rim_diameter: float, pressure: float) -> None:
    """Wires of the bead, and what lies round them."""
    line = rule["outer_diameter"].value / 2 - rule["tread_gauge"].value - 8e-3
    area = bead_wire_area(rule, line, rim_diameter, pressure)
    source = f"{ESTIMATE}: {BEAD_FILL:.0%} of the bundle is wire, 2.1 times as high as wide"
    bead = rule("bead_height", 1.46 * (area / BEAD_FILL) ** 0.5, "mm", source, 3e-3)
    rule("bead_width", area / BEAD_FILL / bead, "mm", f"{ESTIMATE}: of the bundle's area", 2e-3)
    height = _height(rule, rim_diameter)
    rule("apex_height", 0.20 * height, "mm", f"{ESTIMATE}: 0.2 section heights above the wires", 5e-3)
    rule("turn_up_height", 0.13 * height, "mm", f"{ESTIMATE}: 0.13 section heights above the wires", 4e-3)
    rule("toe_gauge", 3e-3, "mm", f"{ESTIMATE}: rubber below the wires", 1e-3)
    rule("chafer_height", 0.3 * height, "mm", f"{ESTIMATE}: along the line from the seat", 10e-3)
    rule("fabric_height", 0.25 * height, "mm", f"{ESTIMATE}: outer leg of the chafer's fabric, along the line", 10e-3)
