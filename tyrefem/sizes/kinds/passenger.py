"""Passenger radials, ISO metric: ``205/60R15``, ``P255/40ZR17 98W``."""

from __future__ import annotations

from tyrefem.sizes import flotation
from tyrefem.sizes.bead import bead_wire_area
from tyrefem.sizes.belt import Belt
from tyrefem.sizes.cards import radial_cards
from tyrefem.sizes.designation import INCH, TyreSize
from tyrefem.sizes.drawn import Drawn
from tyrefem.sizes.radial import Radial
from tyrefem.sizes.radial_layers import RadialLayers
from tyrefem.sizes.radial_line import with_line
from tyrefem.sizes.rim import Rim
from tyrefem.sizes.road import (
    STANDARD,
    check_rim_diameter,
    design_width,
    litres,
    measuring_rim,
    rated,
    rated_flotation,
    road_rim,
)
from tyrefem.sizes.rules import Rules

#: Series -> measuring rim over nominal width, up to that series.
RIM_SHARES = ((0.44, 0.90), (0.49, 0.85), (0.59, 0.80), (0.74, 0.75), (1.0, 0.70))
BEAD_FILL = 0.5
ESTIMATE = "estimate: ordinary practice"


#: Reference pressure, Pa, and load, kg per litre, of a standard and an extra load (XL). The extra load is 3 to 4 load
#: indices more: 1.09 to 1.12 times as much (ETRTO, from memory).
STANDARD_LOAD, EXTRA_LOAD = (250e3, 50.0), (290e3, 55.0)


def draw(size: TyreSize, rule: Rules) -> Drawn:
    """Two steel belts at 20 deg, one wound nylon cap ply, one polyester ply."""
    pressure, density = EXTRA_LOAD if size.extra_load else STANDARD_LOAD
    return draw_with(size, rule, plies=1, tread=8.3e-3, pressure=pressure, density=density, apex=0.24)


def draw_with(
    size: TyreSize, rule: Rules, *, plies: int, tread: float, pressure: float, density: float, apex: float
) -> Drawn:
    """A passenger construction. ``tread``: gauge, m; ``density`` of the load, kg/l; ``apex`` over section height."""
    rim, outer, pressure = _rim_and_rating(size, rule, pressure, density)
    tread_width = _tread_rules(size, rule)
    _layer_rules(rule, plies, tread, tread_width, pressure)
    _bead_rules(size, rule, outer / 2 - tread - 5e-3, pressure, apex)
    belts = (Belt("belt-1", 2.6e-3), Belt("belt-2", 1.1e-3), Belt("cap-ply", 0.0))
    radial = Radial(size, rule, rim, "body-ply", belts, (("apex", 1.0),), f"{size.text} {size.kind} radial by its size")
    radial = with_line(radial)
    rule.check_all_used()
    ply = radial.ply_card("passenger-body-ply", 1100, 0.55e-3)
    cards = ("passenger-belt", "passenger-belt", "passenger-cap-ply")
    belt_cards = {belt.region: radial.belt_card(belt, card) for belt, card in zip(belts, cards, strict=True)}
    bead_card = radial.bead_material("passenger-bead", 1e-3)
    return RadialLayers(radial).drawn(radial_cards("body-ply", ply, belt_cards, "rubber-tread-passenger", bead_card))


def _rim_and_rating(size: TyreSize, rule: Rules, pressure: float, density: float) -> tuple[Rim, float, float]:
    """The rim, the outer diameter, m, and the rated pressure, Pa."""
    series, height = size.series or 0.0, size.section_height or 0.0
    diameter = check_rim_diameter(size)
    inches = size.outside_diameter is not None
    if inches:
        rim_width = measuring_rim(size, rule, flotation.RIM_SHARE, INCH / 2, flotation.RIM_SOURCE, flotation.RIM_REACH)
    else:
        share = next(share for top, share in RIM_SHARES if series <= top)
        words = f"{STANDARD}: measuring rim, {share:g} nominal widths to the half inch"
        rim_width = measuring_rim(size, rule, share, INCH / 2, words)
    rim = road_rim(rule, diameter, rim_width, 17.3e-3, 9.5e-3, 0.0872664626, f"J contour of a 5 deg seat, {STANDARD}")
    words = flotation.DIAMETER_SOURCE if inches else f"{STANDARD}: rim diameter + 2 section heights"
    outer = rule("outer_diameter", diameter + 2 * height, "mm", words, diameter + 0.04)
    theoretical = 0.85 if series < 0.5 else 0.7
    if inches:
        design_width(size, rule, rim_width, flotation.RIM_SHARE, flotation.WIDTH_SOURCE)
    else:
        design_width(size, rule, rim_width, theoretical)
    if inches:
        pressure = rated_flotation(size, rule)
    else:
        spread = "extra load, 1.1 times a standard load" if size.extra_load else "mean of eight sizes, 3 % either way"
        words = f"reference pressure {pressure / 1e3:g} kPa ({STANDARD}); {spread}"
        load = (density * litres(size), f"{density:g} kg per litre of width x height x mean diameter")
        pressure = rated(size, rule, load, pressure, words)
    return rim, outer, pressure


def _tread_rules(size: TyreSize, rule: Rules) -> float:
    """Width and radii of tread and crown; return the width, m."""
    series = size.series or 0.0
    inches = size.outside_diameter is not None
    tread_share = 1.075 - 0.5 * series
    words = "design tread width (1.075 - 0.5 series) x nominal width (from memory of the Tire and Rim Association)"
    if inches:
        tread_share, words = flotation.TREAD_SHARE, flotation.TREAD_SOURCE
    tread_width = rule("tread_width", tread_share * size.width, "mm", words, 0.4 * size.width)
    radius = 1.65 * size.width / series
    rule(
        "crown_radius",
        radius,
        "mm",
        "estimate: 1.65 nominal widths over the series, the lower the flatter; of the plies' line",
        0.05,
        20,
    )
    rule("tread_radius", radius, "mm", "estimate: as crown_radius; of the tread's surface", 0.05, 20)
    rounding = rule(
        "shoulder_radius",
        radius / 8,
        "mm",
        "an eighth of tread_radius by rule: 4 to 12 for a tread's outer arcs over its shoulder's (EP 0 424 155)",
        5e-3,
        20,
    )
    rule(
        "shoulder_width",
        0.1 * tread_width,
        "mm",
        "estimate: tread_width ends within the rounded shoulder; 0.1 tread widths of it on each side",
        0.0,
        min(0.4 * tread_width, 0.7 * rounding),
    )
    return tread_width


def _layer_rules(rule: Rules, plies: int, tread: float, tread_width: float, pressure: float) -> None:
    """Ply, belts, and the gauges of all layers."""
    rule("cord_angle", 1.5707963268, "deg", "radial body ply", 1.4, 1.5708)
    belt = rule("belt_1_width", 0.95 * tread_width, "mm", f"{ESTIMATE}, 0.95 tread widths", 0.03)
    rule("belt_2_width", belt - 10e-3, "mm", f"{ESTIMATE}, 10 mm narrower than belt-1", 0.02)
    rule("cap_ply_width", belt + 6e-3, "mm", f"{ESTIMATE}, covers both belt edges by 3 mm", 0.02)
    rule("belt_1_gauge", 1.25e-3, "mm", f"{ESTIMATE}, steel cord 0.53 mm in rubber", 5e-4)
    rule("belt_2_gauge", 1.25e-3, "mm", f"{ESTIMATE}, steel cord 0.53 mm in rubber", 5e-4)
    rule("cap_ply_gauge", 0.9e-3, "mm", f"{ESTIMATE}, one layer of nylon 0.55 mm in rubber", 5e-4)
    rule("plies", plies, "1", f"{ESTIMATE} at {pressure / 1e3:.4g} kPa", 1, 6)
    rule("ply_gauge", 1.1e-3, "mm", f"{ESTIMATE}, polyester 0.55 mm in rubber", 5e-4)
    rule("liner_gauge", 1.0e-3, "mm", f"{ESTIMATE}, with tie gum", 3e-4)
    rule("undertread_gauge", 1.3e-3, "mm", ESTIMATE, 3e-4)
    rule("tread_gauge", tread, "mm", f"{ESTIMATE}: depth of a new tread", 1e-3)
    rule("grooves", 4, "1", f"{ESTIMATE}; 0: smooth", 0, 9)
    rule("groove_share", 0.22, "1", f"{ESTIMATE}: of the tread's width", 0.01, 0.6)
    rule(
        "sidewall_gauge",
        2.2e-3,
        "mm",
        f"{ESTIMATE}: rubber at the widest place, with the rests below it 3.7 mm",
        1.2e-3,
    )
    rule(
        "rest_gauge",
        0.4e-3,
        "mm",
        "estimate: what a belt's layer has left beyond its cushion, sidewall rubber as well",
        2e-4,
    )
    rule("chafer_gauge", 2.8e-3, "mm", f"{ESTIMATE}: rim strip at the bead", 1.2e-3)


def _bead_rules(size: TyreSize, rule: Rules, crown: float, pressure: float, apex: float) -> None:
    """Bead, apex, turn-up and chafer; ``crown``: radius of the carcass line, m."""
    height = size.section_height or 0.0
    area = bead_wire_area(rule, crown, check_rim_diameter(size), pressure)
    bead = rule(
        "bead_height",
        1.36 * (area / BEAD_FILL) ** 0.5,
        "mm",
        f"{ESTIMATE}: {BEAD_FILL:.0%} of the bundle is wire, 1.85 times as high as wide",
        3e-3,
    )
    rule("bead_width", area / BEAD_FILL / bead, "mm", f"{ESTIMATE}: of the bundle's area", 2e-3)
    rule("apex_height", apex * height, "mm", f"{ESTIMATE}: {apex:g} section heights above the wires", 4e-3)
    rule("turn_up_height", (apex + 0.06) * height, "mm", f"{ESTIMATE}: 0.06 section heights above the apex", 4e-3)
    rule("toe_gauge", 3.4e-3, "mm", f"{ESTIMATE}: rubber below the wires", 1e-3)
    rule(
        "chafer_height",
        50e-3 if height > 0.09 else 0.45 * height,
        "mm",
        f"{ESTIMATE}: along the line from the seat",
        10e-3,
    )
