"""Bias aircraft tyres: ``22x5.5 8PR``, ``H44.5x16.5-21``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.sizes.aircraft import BEAD_MODULUS, aircraft_numbers
from tyrefem.sizes.bead import bead_wire_area
from tyrefem.sizes.cards import bead_shear
from tyrefem.sizes.designation import TyreSize
from tyrefem.sizes.drawn import Drawn, length, section_data, table, thickness
from tyrefem.sizes.growth import before_inflation
from tyrefem.sizes.meridian import SizedMeridian, bias_meridian
from tyrefem.sizes.pressed_bead import bend_radius
from tyrefem.sizes.rim import Rim
from tyrefem.sizes.rules import Rules

Array = NDArray[np.float64]

BEAD_FILL = 0.7
ESTIMATE = "estimate: ordinary practice"
#: A tread is at most as wide as this share of the carcass line's width.
MOST_TREAD = 0.98


@dataclass(frozen=True)
class Gauges:
    """Thicknesses of carcass and rubber, width of the tread, m; modulus of the plies along the cords, Pa."""

    carcass: float
    stiffness: float
    tread: float
    shoulder: float
    wall: float
    tread_width: float

    @classmethod
    def of(cls, size: TyreSize, rule: Rules) -> Gauges:
        """The numbers by their rules."""
        plies = rule(
            "plies",
            max(2, round(0.65 * rule["ply_rating"].value)),
            "1",
            "estimate: 0.65 of the ply rating, nylon (22x5.5 8PR and 12PR of Clark & Dodge 1980: 5 and 8)",
            2,
            60,
        )
        ply = rule(
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
            10e-3 + 0.037 * size.width,
            "mm",
            "estimate: 10 mm + 0.037 widths with undertread (22x5.5 of Clark & Dodge 1980: 0.6 in)",
            3e-3,
        )
        shoulder = rule(
            "shoulder_gauge", 0.73 * tread, "mm", "estimate: 0.73 of the crown's (Clark & Dodge 1980, table H1)", 2e-3
        )
        wall = rule("sidewall_gauge", 3.5e-3, "mm", "estimate (Clark & Dodge 1980, table H1: 0.14 in)", 1.2e-3)
        tread_width = rule(
            "tread_width",
            0.75 * size.width,
            "mm",
            "estimate: shoulder at 0.75 half widths (Clark & Dodge 1980, appendix A), of the carcass line",
            0.2 * size.width,
        )
        return cls(plies * ply, stiffness, tread, shoulder, wall, tread_width)


@dataclass(frozen=True)
class Bead:
    """Bead and turned-up plies: areas, m^2; side of a square bundle of the wires, lengths along the line, m."""

    wires: float
    bundle: float
    width: float
    height: float
    chafer: float
    turn_up: float

    @classmethod
    def of(cls, rule: Rules, crown: float, rim_diameter: float, pressure: float) -> Bead:
        """The numbers by their rules; ``crown``: radius of the inflated carcass line, m."""
        wires = bead_wire_area(rule, crown, rim_diameter, pressure)
        bundle = float((wires / BEAD_FILL) ** 0.5)
        width = rule(
            "bead_width",
            bundle,
            "mm",
            f"estimate: a square bundle, {BEAD_FILL:.0%} wire, between plies inside and outside of it",
            3e-3,
        )
        height = rule(
            "bead_height",
            1.9 * bundle,
            "mm",
            "estimate: 1.9 bundles from the seat (8PR of Clark & Dodge 1980: 0.785 in)",
            5e-3,
        )
        chafer = rule("chafer_gauge", 3e-3, "mm", "estimate: rubber between the plies and the flange", 1.5e-3)
        turn_up = rule(
            "turn_up_height",
            0.35 * (crown - rim_diameter / 2),
            "mm",
            "estimate: from the seat, 0.35 of the plies' height; turned-up plies thicken the carcass down to the "
            "bundle",
            5e-3,
        )
        return cls(wires, bundle, width, height, chafer, turn_up)


def draw(size: TyreSize, rule: Rules) -> Drawn:
    """Nylon bias plies, crown angle that of equilibrium at the data book's width; regions as the NASA sections.

    Diameter and width are those of the inflated tyre, as data books state them; the line is drawn before inflation.
    """
    rim, pressure = aircraft_numbers(size, rule, 16)
    outer = rule["outer_diameter"].value
    gauges = Gauges.of(size, rule)
    grooves = round(rule("grooves", 0, "1", "estimate: drawn smooth; 0.22 of the width are grooves on most", 0, 9))
    share = rule("groove_share", 0.22, "1", f"{ESTIMATE}: of the tread's width", 0.01, 0.6)
    crown = outer / 2 - gauges.tread - gauges.carcass / 2
    bead = Bead.of(rule, crown, rim.diameter, pressure)
    if crown < rim.diameter / 2 + 0.02:
        raise InputError("leaves no room for a sidewall above the rim", field="parameters.outer_diameter")
    line = _line_before_inflation(rule, gauges, bead, rim, crown, pressure)
    rule.check_all_used()
    if gauges.tread_width > MOST_TREAD * 2 * line.half_width:
        raise InputError(
            f"{gauges.tread_width * 1e3:.4g} mm is wider than the carcass line allows here: up to "
            f"{MOST_TREAD * 2e3 * line.half_width:.4g} mm",
            field="parameters.tread_width",
        )
    if not line.widest_s < line.length - bead.turn_up < line.length - bead.height:
        raise InputError(
            f"must be from {bead.height * 1e3:.4g} to {(line.length - line.widest_s) * 1e3:.4g} mm here: between the "
            "bead and the widest place",
            field="parameters.turn_up_height",
        )
    s = np.linspace(0, line.widest_s, 2000)
    shoulder = float(np.interp(gauges.tread_width / 2, line.at(s)[1], s))
    data = section_data(
        size,
        rule,
        line,
        "middle plies and bead",
        _layers(rule, gauges, bead, rim, line, shoulder),
        title=f"{size.text} bias aircraft tyre by its size",
        outer_diameter=outer - 2 * rule["radius_growth"].value,
        shoulder_s=shoulder,
        bead_length=bead.height,
        grooves=_grooves(rule, grooves, share * gauges.tread_width, shoulder) if grooves else None,
    )
    materials = {
        "carcass": "nasa-carcass",
        "tread": "nasa-tread",
        "sidewall": "nasa-sidewall",
        "bead": {"base": "nasa-bead", "shear_modulus": bead_shear(bead.wires / (bead.bundle * bead.width))},
        "chafer": "rubber-chafer",
    }
    return Drawn(size, rule, line, data, materials)


def _line_before_inflation(
    rule: Rules, gauges: Gauges, bead: Bead, rim: Rim, crown: float, pressure: float
) -> SizedMeridian:
    """The carcass line as made: in equilibrium, and by its growth of the stated size when inflated."""
    angle = rule("cord_angle", 0.6, "deg", "", 0.3, 1.2) if "cord_angle" in rule.given else None
    offset = bead.width / 2 + gauges.carcass / 3 + bead.chafer
    half = rule["section_width"].value / 2 - gauges.carcass / 2 - gauges.wall
    grows = not {"radius_growth", "width_growth"} <= rule.given.keys()
    even = rim.radius + offset
    inflated, _ = bias_meridian(crown, half, rim, offset, even, None if grows else angle)
    bend = bend_radius(rule, inflated, pressure, BEAD_MODULUS)
    growth = (0.0, 0.0)
    if grows:
        mould = before_inflation(inflated, pressure, gauges.carcass * gauges.stiffness, bend)
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
    return line


def _layers(
    rule: Rules, gauges: Gauges, bead: Bead, rim: Rim, line: SizedMeridian, shoulder: float
) -> list[dict[str, Any]]:
    """Tables of the section's layers, from inside to outside."""
    third, end = gauges.carcass / 3, line.length
    up = end - bead.turn_up
    core = [(0.0, third), (up, third), (end - bead.height, 0.9 * bead.width), (end, bead.width)]
    places = _places(line, rim, shoulder, core)
    below = third + thickness(core, places) / 2
    rubber = np.maximum(_outside(places, gauges, rim, line, shoulder) - below, 2e-3)
    plain = [(0.0, third), (end, third)]
    plies = rule.sources("plies", "ply_gauge")
    return [
        table("inner plies", plain, [{"name": "carcass"}], plies),
        table(
            "middle plies and bead",
            core,
            [{"name": "carcass", "to": "bead_start"}, {"name": "bead"}],
            rule.sources("turn_up_height", "bead_width", "bead_height"),
        ),
        table("outer plies", plain, [{"name": "carcass"}], plies),
        table(
            "rubber",
            list(zip(places.tolist(), rubber.tolist(), strict=True)),
            [
                {"name": "tread", "to": "shoulder"},
                {"name": "sidewall", "to": f"-{length(end - up)}"},
                {"name": "chafer"},
            ],
            rule.sources("tread_gauge", "shoulder_gauge", "sidewall_gauge", "chafer_gauge"),
        ),
    ]


def _places(line: SizedMeridian, rim: Rim, shoulder: float, core: list[tuple[float, float]]) -> Array:
    """Lengths s along the line at which the rubber's thickness is given, m."""
    end, wide, flange = line.length, line.widest_s, line.flange_s
    places = [
        *np.linspace(0, shoulder, 5),
        *np.linspace(shoulder, wide, 6),
        *np.linspace(wide, flange, 6),
        *np.linspace(flange, end - rim.straight, 4),
        *(s for s, _ in core if s > flange),
        end,
    ]
    return np.unique(np.round(places, 6))


def _outside(places: Array, gauges: Gauges, rim: Rim, line: SizedMeridian, shoulder: float) -> Array:
    """Distance of the outer surface from the carcass line, m: tread, shoulder, wall, then the rim's flange."""
    wide, flange = line.widest_s, line.flange_s
    x = np.clip(places / shoulder, 0, 1)
    drop = np.clip((places - shoulder) / (wide - shoulder), 0, 1)
    rise = np.clip((places - wide) / (flange - wide), 0, 1)
    least = gauges.carcass / 2 + gauges.wall
    outside = np.where(
        places <= shoulder,
        gauges.carcass / 2 + gauges.tread + (gauges.shoulder - gauges.tread) * x**2,
        least + (gauges.shoulder - gauges.wall) * (1 - drop) ** 1.5,
    )
    top = float(line.to_flange(flange))
    outside = np.where(places > wide, least + (top - least) * rise**1.5, outside)
    return np.where(places > flange, line.to_flange(np.minimum(places, line.length - rim.straight)), outside)


def _grooves(rule: Rules, count: int, width: float, shoulder: float) -> dict[str, Any]:
    """Grooves of one half at equal distances; ``width``: of all together, m."""
    places = np.sort(np.abs(2 * (np.arange(count) + 1) / (count + 1) - 1)[: (count + 1) // 2]) * shoulder * 0.95
    return {
        "at": [length(max(place, 1e-6)) for place in places],
        "width": length(width / count),
        "source": rule.sources("grooves", "groove_share"),
    }
