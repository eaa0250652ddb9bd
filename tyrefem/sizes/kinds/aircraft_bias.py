"""Bias aircraft tyres: ``22x5.5 8PR``, ``H44.5x16.5-21``."""

from __future__ import annotations

import numpy as np

from tyrefem.errors import InputError
from tyrefem.sizes.aircraft import BEAD_MODULUS, aircraft_numbers
from tyrefem.sizes.bead import bead_wire_area
from tyrefem.sizes.cards import bead_shear
from tyrefem.sizes.designation import TyreSize
from tyrefem.sizes.drawn import Drawn, length, section_data, table, thickness
from tyrefem.sizes.growth import before_inflation
from tyrefem.sizes.meridian import bias_meridian
from tyrefem.sizes.pressed_bead import bend_radius
from tyrefem.sizes.rules import Rules

BEAD_FILL = 0.7
ESTIMATE = "estimate: ordinary practice"
#: A tread is at most as wide as this share of the carcass line's width.
MOST_TREAD = 0.98


def draw(size: TyreSize, rule: Rules) -> Drawn:
    """Nylon bias plies, crown angle that of equilibrium at the data book's width; regions as the NASA sections.

    Diameter and width are those of the inflated tyre, as data books state them; the line is drawn before inflation.
    """
    rim, pressure = aircraft_numbers(size, rule, 16)
    outer, width = rule["outer_diameter"].value, size.width
    plies = rule(
        "plies",
        max(2, round(0.65 * rule["ply_rating"].value)),
        "1",
        "estimate: 0.65 of the ply rating, nylon (22x5.5 8PR and 12PR of Clark & Dodge 1980: 5 and 8)",
        2,
        60,
    )
    carcass = plies * rule(
        "ply_gauge",
        1.02e-3,
        "mm",
        "Clark & Dodge 1980, table H1: 0.2 in of carcass of the 8PR; estimate: five plies",
        3e-4,
    )
    stiffness = rule(
        "ply_modulus",
        625e6,
        "MPa",
        "of the plies along the cords: 4 G_p/sin^2(2 alpha) of the card nasa-carcass",
        50e6,
        200e9,
    )
    tread = rule(
        "tread_gauge",
        10e-3 + 0.037 * width,
        "mm",
        "estimate: 10 mm + 0.037 widths with undertread (22x5.5 of Clark & Dodge 1980: 0.6 in)",
        3e-3,
    )
    shoulder_gauge = rule(
        "shoulder_gauge", 0.73 * tread, "mm", "estimate: 0.73 of the crown's (Clark & Dodge 1980, table H1)", 2e-3
    )
    wall = rule("sidewall_gauge", 3.5e-3, "mm", "estimate (Clark & Dodge 1980, table H1: 0.14 in)", 1.2e-3)
    tread_width = rule(
        "tread_width",
        0.75 * width,
        "mm",
        "estimate: shoulder at 0.75 half widths (Clark & Dodge 1980, appendix A), of the carcass line",
        0.2 * width,
    )
    grooves = round(rule("grooves", 0, "1", "estimate: drawn smooth; 0.22 of the width are grooves on most", 0, 9))
    share = rule("groove_share", 0.22, "1", f"{ESTIMATE}: of the tread's width", 0.01, 0.6)
    crown = outer / 2 - tread - carcass / 2
    area = bead_wire_area(rule, crown, rim.diameter, pressure)
    bundle = float((area / BEAD_FILL) ** 0.5)
    bead_width = rule(
        "bead_width",
        bundle,
        "mm",
        f"estimate: a square bundle, {BEAD_FILL:.0%} wire, between plies inside and outside of it",
        3e-3,
    )
    bead_height = rule(
        "bead_height",
        1.9 * bundle,
        "mm",
        "estimate: 1.9 bundles from the seat (8PR of Clark & Dodge 1980: 0.785 in)",
        5e-3,
    )
    chafer = rule("chafer_gauge", 3e-3, "mm", "estimate: rubber between the plies and the flange", 1.5e-3)
    turn_up = rule(
        "turn_up_height",
        0.35 * (crown - rim.diameter / 2),
        "mm",
        "estimate: from the seat, 0.35 of the plies' height; turned-up plies thicken the carcass down to the bundle",
        5e-3,
    )
    if crown < rim.diameter / 2 + 0.02:
        raise InputError("leaves no room for a sidewall above the rim", field="parameters.outer_diameter")
    angle = rule("cord_angle", 0.6, "deg", "", 0.3, 1.2) if "cord_angle" in rule.given else None
    third = carcass / 3
    offset = bead_width / 2 + third + chafer
    half = rule["section_width"].value / 2 - carcass / 2 - wall
    grows = not {"radius_growth", "width_growth"} <= rule.given.keys()
    even = rim.radius + offset
    inflated, _ = bias_meridian(crown, half, rim, offset, even, None if grows else angle)
    bend = bend_radius(rule, inflated, pressure, BEAD_MODULUS)
    growth = (0.0, 0.0)
    if grows:
        mould = before_inflation(inflated, pressure, carcass * stiffness, bend)
        growth = inflated.crown - mould.crown, 2 * (inflated.half_width - mould.half_width)
    words = (
        "solved for: cords that the rated pressure stretches, in equilibrium before and after (tyrefem.sizes.growth)"
    )
    crown -= rule("radius_growth", growth[0], "mm", words, 0.0, 0.15 * crown)
    half -= rule("width_growth", growth[1], "mm", words, -0.1 * half, 0.5 * half) / 2
    line, angle = bias_meridian(crown, half, rim, offset, bend, angle)
    if "cord_angle" not in rule.given:
        rule(
            "cord_angle",
            angle,
            "deg",
            "solved for: at this crown angle the plies in equilibrium have the section's width on the rim",
            0.2,
            1.3,
        )
    rule.check_all_used()
    end, wide, flange = line.length, line.widest_s, line.flange_s
    if tread_width > MOST_TREAD * 2 * line.half_width:
        raise InputError(
            f"{tread_width * 1e3:.4g} mm is wider than the carcass line allows here: up to "
            f"{MOST_TREAD * 2e3 * line.half_width:.4g} mm",
            field="parameters.tread_width",
        )
    s = np.linspace(0, wide, 2000)
    shoulder = float(np.interp(tread_width / 2, line.at(s)[1], s))
    up = end - turn_up
    if not wide < up < end - bead_height:
        raise InputError(
            f"must be from {bead_height * 1e3:.4g} to {(end - wide) * 1e3:.4g} mm here: between the bead and the "
            "widest place",
            field="parameters.turn_up_height",
        )
    core = [(0.0, third), (up, third), (end - bead_height, 0.9 * bead_width), (end, bead_width)]
    places = np.unique(
        np.round(
            [
                *np.linspace(0, shoulder, 5),
                *np.linspace(shoulder, wide, 6),
                *np.linspace(wide, flange, 6),
                *np.linspace(flange, end - rim.straight, 4),
                *(x for x, _ in core if x > flange),
                end,
            ],
            6,
        )
    )
    below = third + thickness(core, places) / 2
    x = np.clip(places / shoulder, 0, 1)
    drop, rise = (
        np.clip((places - shoulder) / (wide - shoulder), 0, 1),
        np.clip((places - wide) / (flange - wide), 0, 1),
    )
    least = carcass / 2 + wall
    outside = np.where(
        places <= shoulder,
        carcass / 2 + tread + (shoulder_gauge - tread) * x**2,
        least + (shoulder_gauge - wall) * (1 - drop) ** 1.5,
    )
    top = float(line.to_flange(flange))
    outside = np.where(places > wide, least + (top - least) * rise**1.5, outside)
    outside = np.where(places > flange, line.to_flange(np.minimum(places, end - rim.straight)), outside)
    rubber = list(zip(places.tolist(), np.maximum(outside - below, 2e-3).tolist(), strict=True))
    plain = [(0.0, third), (end, third)]
    layers = [
        table("inner plies", plain, [{"name": "carcass"}], rule.sources("plies", "ply_gauge")),
        table(
            "middle plies and bead",
            core,
            [{"name": "carcass", "to": "bead_start"}, {"name": "bead"}],
            rule.sources("turn_up_height", "bead_width", "bead_height"),
        ),
        table("outer plies", plain, [{"name": "carcass"}], rule.sources("plies", "ply_gauge")),
        table(
            "rubber",
            rubber,
            [
                {"name": "tread", "to": "shoulder"},
                {"name": "sidewall", "to": f"-{length(end - up)}"},
                {"name": "chafer"},
            ],
            rule.sources("tread_gauge", "shoulder_gauge", "sidewall_gauge", "chafer_gauge"),
        ),
    ]
    cut = None
    if grooves:
        at = np.sort(np.abs(2 * (np.arange(grooves) + 1) / (grooves + 1) - 1)[: (grooves + 1) // 2]) * shoulder * 0.95
        cut = {
            "at": [length(max(a, 1e-6)) for a in at],
            "width": length(share * tread_width / grooves),
            "source": rule.sources("grooves", "groove_share"),
        }
    title = f"{size.text} bias aircraft tyre by its size"
    data = section_data(
        size,
        rule,
        line,
        "middle plies and bead",
        layers,
        title=title,
        outer_diameter=outer - 2 * rule["radius_growth"].value,
        shoulder_s=shoulder,
        bead_length=bead_height,
        grooves=cut,
    )
    materials = {
        "carcass": "nasa-carcass",
        "tread": "nasa-tread",
        "sidewall": "nasa-sidewall",
        "bead": {"base": "nasa-bead", "shear_modulus": bead_shear(area / (bundle * bead_width))},
        "chafer": "rubber-chafer",
    }
    return Drawn(size, rule, line, data, materials)
