"""Truck radials on 15 degree rims: ``295/80R22.5``, ``11R22.5``."""

from __future__ import annotations

from tyrefem.sizes.bead import bead_wire_area
from tyrefem.sizes.belt import Belt
from tyrefem.sizes.cards import radial_cards
from tyrefem.sizes.designation import INCH, TyreSize
from tyrefem.sizes.drawn import Drawn
from tyrefem.sizes.radial import Radial
from tyrefem.sizes.radial_layers import RadialLayers
from tyrefem.sizes.radial_line import with_line
from tyrefem.sizes.rim import Rim
from tyrefem.sizes.road import check_rim_diameter, design_width, litres, measuring_rim, rated, road_rim
from tyrefem.sizes.rules import Rules

BEAD_FILL = 0.7
STANDARD = "ETRTO/ISO 4209-1 (from memory)"
ESTIMATE = "estimate: ordinary practice"
#: Up to this series belts and tread are wider for the nominal width (low tyres and wide-base singles).
LOW_SERIES = 0.6
#: From this nominal width on, m, a truck tyre is a wide-base single.
WIDE_BASE = 0.4
#: Load of a tyre of 100 l, kg, and the exponent of other volumes: 20 single loads, 215/75R17.5 126 to 445/65R22.5 169.
LOAD_AT, LOAD_EXPONENT = 5400.0, 0.74
LOAD_WORDS = (
    "5400 kg x (width x height x mean diameter / 100 l)^0.74, within 16 % of the load indices of 20 sizes (from "
    "memory); write the load index of yours behind the size"
)
#: Modulus of their bead between plies and flange in plane strain, Pa, and its source.
BEAD_MODULUS = (56e6, "estimate: four times 14 MPa of shear, that of fillers")


def draw(size: TyreSize, rule: Rules) -> Drawn:
    """One steel body ply, a transition belt, two working belts and a protector belt."""
    rim, outer, pressure = _rim_and_rating(size, rule)
    wide_base = size.width >= WIDE_BASE
    low = wide_base or (size.series or 1.0) <= LOW_SERIES + 1e-9
    _tread_rules(size.width, rule, low=low)
    tread = _layer_rules(size.width, rule, low=low)
    _bead_rules(size, rule, outer / 2 - tread - 15e-3, pressure)
    belts = (Belt("belt-1", 7e-3), Belt("belt-2", 2.4e-3), Belt("belt-3", 1.6e-3), Belt("belt-4", 0.0))
    radial = Radial(
        size,
        rule,
        rim,
        "body-ply",
        belts,
        (("apex-soft", 0.5), ("apex", 0.5)),
        f"{size.text} truck radial by its size",
        reinforced=True,
        belt_power=(None, "solved for: within 2 to 5, the power with which the crown is as flat as 2.4 nominal widths"),
    )
    radial = with_line(radial, BEAD_MODULUS if wide_base else None)
    rule.check_all_used()
    ply = radial.ply_card("truck-body-ply", 600, 0.95e-3)
    cards = ("truck-transition-belt", "truck-belt", "truck-belt", "truck-protector-belt")
    belt_cards = {belt.region: radial.belt_card(belt, card) for belt, card in zip(belts, cards, strict=True)}
    bead_card = radial.bead_material("truck-bead", 1.6e-3)
    materials = radial_cards("body-ply", ply, belt_cards, "rubber-tread-truck", bead_card)
    return RadialLayers(radial).drawn(materials | radial.fabric_card() | {"apex-soft": "rubber-apex-soft"})


def _rim_and_rating(size: TyreSize, rule: Rules) -> tuple[Rim, float, float]:
    """The rim, the outer diameter, m, and the rated pressure, Pa."""
    height = size.section_height or 0.0
    diameter = check_rim_diameter(size)
    rim_width = measuring_rim(
        size, rule, 0.75, 0.75 * INCH, f"{STANDARD}: measuring rim, 0.75 nominal widths to 3/4 in"
    )
    rim = road_rim(
        rule,
        diameter,
        rim_width,
        12.7e-3,
        12e-3,
        0.2617993878,
        f"15 deg drop-centre rim, flange height 12.7 mm, {STANDARD}; estimate: rounding",
    )
    outer = rule(
        "outer_diameter", diameter + 2 * height, "mm", f"{STANDARD}: rim diameter + 2 section heights", diameter + 0.1
    )
    design_width(size, rule, rim_width, 0.75)
    load = LOAD_AT * (litres(size) / 100) ** LOAD_EXPONENT
    pressure = rated(size, rule, (load, LOAD_WORDS), 850e3, f"850 kPa ({STANDARD}); 700 to 900 kPa by size and index")
    return rim, outer, pressure


def _tread_rules(width: float, rule: Rules, *, low: bool) -> None:
    """Width and radii of tread and crown; ``low``: a low tyre or a wide-base single."""
    tread_share, tread_words = 0.79, "mean of five highway ribs, 0.74 to 0.82"
    if low:
        tread_share, tread_words = 0.86, "low tyres and wide-base singles, 0.83 to 0.88"
    rule(
        "tread_width",
        tread_share * width,
        "mm",
        f"estimate: {tread_share:g} nominal widths, {tread_words} (makers' data books, from memory)",
        0.4 * width,
    )
    rule("crown_radius", 2.4 * width, "mm", f"{ESTIMATE}, 2.4 nominal widths; of the plies' line", 0.1, 20)
    rule(
        "tread_radius",
        3.5 * width,
        "mm",
        f"{ESTIMATE}, 3.5 nominal widths, flatter than the plies; of the tread's surface",
        0.1,
        20,
    )


def _layer_rules(width: float, rule: Rules, *, low: bool) -> float:
    """Ply, belts, and the gauges of all layers; return the tread's gauge, m."""
    rule("cord_angle", 1.5707963268, "deg", "radial body ply", 1.4, 1.5708)
    for name, usual, broad, gauge, words in (
        ("belt_1", 0.57, 0.72, 2.0e-3, "transition belt"),
        ("belt_2", 0.67, 0.82, 2.2e-3, "first working belt"),
        ("belt_3", 0.61, 0.77, 2.2e-3, "second working belt"),
        ("belt_4", 0.44, 0.52, 1.8e-3, "protector belt"),
    ):
        share = broad if low else usual
        rule(f"{name}_width", share * width, "mm", f"{ESTIMATE}, {words}, {share:g} nominal widths", 0.03)
        rule(f"{name}_gauge", gauge, "mm", f"{ESTIMATE}, {words}: steel cord in rubber", 8e-4)
    rule("plies", 1, "1", f"{ESTIMATE}, steel cord", 1, 2)
    rule("ply_gauge", 2.0e-3, "mm", f"{ESTIMATE}, steel cord 0.95 mm in rubber", 1e-3)
    rule("liner_gauge", 2.4e-3, "mm", f"{ESTIMATE}, with tie gum", 5e-4)
    rule("undertread_gauge", 5.0e-3, "mm", f"{ESTIMATE}: to the bottom of the grooves", 5e-4)
    tread = rule("tread_gauge", 15e-3, "mm", f"{ESTIMATE}: depth of a new steer-axle tread", 2e-3)
    rule("grooves", 4, "1", f"{ESTIMATE}; 0: smooth", 0, 9)
    rule("groove_share", 0.21, "1", f"{ESTIMATE}: of the tread's width", 0.01, 0.6)
    rule(
        "sidewall_gauge",
        2.4e-3,
        "mm",
        f"{ESTIMATE}: rubber at the widest place, with the rests below it 5.4 mm",
        1.2e-3,
    )
    rule(
        "rest_gauge",
        0.6e-3,
        "mm",
        "estimate: what a belt's layer has left beyond its cushion, sidewall rubber as well",
        2e-4,
    )
    rule("chafer_gauge", 3.5e-3, "mm", f"{ESTIMATE}: rim strip at the bead", 1.2e-3)
    return tread


def _bead_rules(size: TyreSize, rule: Rules, crown: float, pressure: float) -> None:
    """Bead, apex, turn-up, chafer and its fabric; ``crown``: radius of the carcass line, m."""
    height = size.section_height or 0.0
    area = bead_wire_area(rule, crown, check_rim_diameter(size), pressure)
    bead = rule(
        "bead_height",
        1.14 * (area / BEAD_FILL) ** 0.5,
        "mm",
        f"{ESTIMATE}: {BEAD_FILL:.0%} of the bundle is wire, 1.3 times as high as wide",
        3e-3,
    )
    rule("bead_width", area / BEAD_FILL / bead, "mm", f"{ESTIMATE}: of the bundle's area", 2e-3)
    rule(
        "apex_height", 0.34 * height, "mm", f"{ESTIMATE}: 0.34 section heights above the wires, half of it hard", 10e-3
    )
    rule("turn_up_height", 0.22 * height, "mm", f"{ESTIMATE}: 0.22 section heights above the wires", 6e-3)
    rule("toe_gauge", 5e-3, "mm", f"{ESTIMATE}: rubber below the wires", 2e-3)
    rule("chafer_height", 0.34 * height, "mm", f"{ESTIMATE}: along the line from the seat", 10e-3)
    rule("fabric_height", 0.25 * height, "mm", f"{ESTIMATE}: outer leg of the chafer's fabric, along the line", 10e-3)
