"""Sections by their sizes: published dimensions, named numbers, files, what is refused."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.errors import InputError
from tyrefem.geometry import SectionCard, build, load
from tyrefem.geometry.meshing import build as mesh_of
from tyrefem.inputs.study import StudyData
from tyrefem.materials.card import material
from tyrefem.mechanics.solid.tyre_body import tyre_body
from tyrefem.sizes import draw_size
from tyrefem.sizes.data_book import data_book
from tyrefem.sizes.text import section_text

pytestmark = pytest.mark.fast
INCH = 0.0254
DRIVE = {"speed": "60 km/h", "load": "10 kN", "pressure": "900 kPa", "duration": "60 s", "ambient": "25 degC"}
MESH = {"size": "10 mm", "through": 1}
SIZES = (
    "205/60R15", "255/40R17", "195/65R15", "LT245/75R16", "31x10.50R15LT", "37x12.50R17LT/D",
    "295/80R22.5", "11R22.5",
    "22x5.5 8PR", "22x5.5 12PR", "40x14", "46x17R20",
)  # fmt: skip


@pytest.mark.parametrize(
    ("size", "diameter", "width", "rim"),
    [
        ("205/60R15", 627, 209, 6.0),
        ("205/55R16", 632, 214, 6.5),
        ("195/65R15", 635, 201, 6.0),
        ("255/40R17", 636, 260, 9.0),
        ("225/45R17", 634, 225, 7.5),
        ("295/80R22.5", 1044, 298, 9.0),
        ("11R22.5", 1054, 279, 8.25),
    ],
)
def test_road_tyres_have_the_standards_size(size: str, diameter: float, width: float, rim: float) -> None:
    """Overall diameter, section width and measuring rim of ETRTO/ISO 4000-1, 4209-1 (from memory), mm and in."""
    section = tf.section_from_size(size)
    assert section.outer_diameter * 1e3 == pytest.approx(diameter, abs=1.0)
    assert section.overall_width * 1e3 == pytest.approx(width, abs=1.6)
    assert draw_size(size).rules["rim_width"].value == pytest.approx(rim * INCH)


@pytest.mark.parametrize(
    ("size", "mass"),
    [("215/75R17.5", 1700), ("275/70R22.5", 3150), ("315/80R22.5", 4000), ("385/65R22.5", 4500), ("445/65R22.5", 5800)],
)
def test_loads_of_trucks_without_load_index_are_within_the_spread_that_is_stated(size: str, mass: float) -> None:
    """Loads of the indices 126, 148, 156, 160 and 169, kg: 0.72 to 1.23 times as much as before."""
    load = draw_size(size).rules["rated_load"]
    assert load.value / 9.80665 == pytest.approx(mass, rel=0.16)
    assert "within 16 %" in load.source
    assert "write the load index" in load.source


@pytest.mark.parametrize("size", ["33x8.50R15LT", "34x8.50R16LT"])
def test_a_flotation_size_may_be_higher_than_wide(size: str) -> None:
    section = tf.section_from_size(size)
    assert section.outer_diameter == pytest.approx((float(size[:2]) - 0.5) * INCH, abs=1e-5)
    assert section.warnings == ()


@pytest.mark.parametrize(("size", "exponent"), [("205/60R15", 0.8), ("22x5.5 8PR", 1.0)])
def test_without_a_load_a_lower_pressure_has_the_load_that_it_carries(size: str, exponent: float) -> None:
    rated = draw_size(size).rules
    half = draw_size(size, {"pressure": f"{rated['rated_pressure'].value / 2} Pa"}).rules["load"]
    assert half.value == pytest.approx(rated["rated_load"].value / 2**exponent, rel=1e-6)
    assert half.source == "what the tyre carries at this pressure"
    assert draw_size(size, {"pressure": rated["rated_pressure"].text}).rules["load"].source == "as rated"


@pytest.mark.parametrize(("size", "load"), [("205/55R16", 670), ("225/45R17", 670), ("195/65R15", 690)])
def test_an_extra_load_is_carried_at_its_higher_reference_pressure(size: str, load: float) -> None:
    """290 kPa in place of 250 kPa; load indices 94, 94 and 95 of these sizes' XL tyres, kg (ETRTO, from memory)."""
    standard, extra = draw_size(size).rules, draw_size(f"{size} XL").rules
    assert standard["rated_pressure"].value == pytest.approx(250e3)
    assert extra["rated_pressure"].value == pytest.approx(290e3)
    assert extra["rated_load"].value == pytest.approx(1.1 * standard["rated_load"].value, abs=10)
    assert extra["rated_load"].value == pytest.approx(load * 9.80665, rel=0.04)
    assert draw_size("205/55R16 94V XL").rules["rated_pressure"].value == pytest.approx(290e3)


@pytest.mark.parametrize(
    ("size", "diameter", "width", "rim"),
    [
        ("27x8.50R14LT", 674, 218, 7.0),
        ("30x9.50R15LT", 750, 240, 7.5),
        ("31x10.50R15LT", 775, 268, 8.5),
        ("32x11.50R15LT", 801, 290, 9.0),
        ("33x12.50R15LT", 826, 318, 10.0),
        ("37x12.50R17LT", 928, 318, 10.0),
        ("33x13.50R15LT", 826, 345, 11.0),
    ],
)
def test_flotation_sizes_have_the_standards_size(size: str, diameter: float, width: float, rim: float) -> None:
    """UN R54, Annex 5, high flotation (from memory), mm and in; a maker's catalogue has the same widths and rims."""
    rules = draw_size(size).rules
    assert rules["outer_diameter"].value * 1e3 == pytest.approx(diameter, abs=1.0)
    assert rules["section_width"].value * 1e3 == pytest.approx(width, abs=0.6)
    assert rules["rim_width"].value == pytest.approx(rim * INCH)
    assert tf.section_from_size(size).outer_diameter == pytest.approx(rules["outer_diameter"].value)


@pytest.mark.parametrize(
    ("size", "psi", "pounds"),
    [
        ("27x8.50R14LT/C", 50, 1520),
        ("31x10.50R15LT/C", 50, 2270),
        ("33x12.50R15LT/C", 35, 2205),
        ("33x10.50R17LT/D", 65, 2910),
        ("35x12.50R20LT/E", 65, 3195),
        ("33x11.50R18LT/E", 80, 3305),
    ],
)
def test_flotation_loads_are_those_of_the_load_table(size: str, psi: float, pounds: float) -> None:
    """Loads of tirepressure.com's table of flotation sizes, lb."""
    rules = draw_size(size).rules
    assert rules["rated_pressure"].value == pytest.approx(psi * 6894.757, rel=1e-6)
    assert rules["rated_load"].value == pytest.approx(pounds * 4.448222, rel=0.03)


@pytest.mark.parametrize(
    ("size", "low", "high"),
    [("31x10.50R15LT", 7.0, 9.0), ("33x12.50R15LT", 8.0, 10.5), ("37x13.50R22LT", 9.5, 12), ("42x15.50R24LT", 11, 14)],
)
def test_flotation_sizes_have_the_rims_of_a_catalogue(size: str, low: float, high: float) -> None:
    """Catalogue of the Radar Renegade X; the rims an inch beyond are refused."""
    for width in (low, high):
        assert draw_size(size, {"rim_width": f"{width} in"}).rules["rim_width"].value == pytest.approx(width * INCH)
    for width in (low - 1.5, high + 1.5):
        with pytest.raises(InputError, match=r"too (narrow|wide) for"):
            draw_size(size, {"rim_width": f"{width} in"})


@pytest.mark.parametrize(("service", "psi"), [("33x12.50R15LT 108Q", 35), ("37x12.50R17LT 124Q", 50),
                                              ("35x12.50R17LT 121Q", 65), ("33x12.50R20LT 119Q", 80)])  # fmt: skip
def test_a_load_index_decides_the_pressure_of_a_flotation_size(service: str, psi: float) -> None:
    """Makers' load ranges of these sizes and load indices: C, D, E and F."""
    assert draw_size(service).rules["rated_pressure"].value == pytest.approx(psi * 6894.757, rel=1e-6)


def test_a_load_range_lowers_pressure_and_load() -> None:
    """Loads of the Tire and Rim Association (from memory): 2205, 2623 and 3042 lb at 50, 65 and 80 psi."""
    loads = [draw_size(f"LT245/75R16/{letter}").rules["rated_load"].value for letter in "CDE"]
    assert loads[:2] == pytest.approx([2205 / 3042 * loads[2], 2623 / 3042 * loads[2]], rel=0.01)


@pytest.mark.parametrize(
    "size", ["22x5.5 8PR", "22x5.5 12PR", "40x14 24PR", "24x7.7 16PR", "H40x14.5-19 26PR", "49x17 30PR"]
)
def test_bias_tyres_lie_within_the_data_book(size: str) -> None:
    section, rules = tf.section_from_size(size), draw_size(size).rules
    name, plies = size.removesuffix("PR").split()
    row = next(row for row in data_book() if row.size == name and row.ply_rating == int(plies))
    inflated = section.outer_diameter + 2 * rules["radius_growth"].value
    assert row.diameter[0] <= inflated <= row.diameter[1]
    assert row.width[0] <= section.overall_width + rules["width_growth"].value <= row.width[1] * 1.005
    assert rules["rated_load"].value == row.load
    assert 20 < np.degrees(rules["cord_angle"].value) < 45


@pytest.mark.parametrize(
    ("size", "count"),
    [("205/60R15", "plies"), ("205/60R15", "grooves"), ("46x17R20", "belt_plies"), ("22x5.5 8PR", "ply_rating")],
)
def test_a_count_is_a_whole_number(size: str, count: str) -> None:
    """It was rounded where it is drawn, and the file said another number."""
    with pytest.raises(InputError, match=f"parameters.{count}: must be a whole number, not 3.5"):
        draw_size(size, {count: 3.5})
    assert draw_size(size, {count: "4"}).rules[count].value == 4


@pytest.mark.parametrize("size", SIZES)
def test_a_size_is_meshed_and_nothing_is_odd(size: str) -> None:
    section = tf.section_from_size(size)
    assert section.warnings == ()
    mesh = mesh_of(section, size=8e-3, through=1)
    assert set(mesh.mesh.subdomains) == set(section.regions)
    assert sum(mesh.area(region) for region in section.regions) == pytest.approx(section.area(), rel=0.01)


@pytest.mark.parametrize("size", SIZES)
def test_every_number_has_a_source_and_the_file_is_the_section(size: str) -> None:
    drawn = draw_size(size)
    assert all(number.source for number in drawn.rules)
    text = section_text(drawn, "test")
    read = build(SectionCard.check(tomllib.loads(text)), name=size)
    made = tf.section_from_size(size)
    assert read.regions == made.regions
    assert read.area() == pytest.approx(made.area(), rel=1e-12)
    for number in drawn.rules:
        assert f"# {number.name} " in text
        assert number.text in text


@pytest.mark.parametrize("size", ["205/60R15", "295/80R22.5", "22x5.5 8PR", "46x17R20"])
def test_every_number_can_be_given(size: str) -> None:
    """Each number given back as written changes nothing; the rounding of six digits is left."""
    drawn = draw_size(size)
    solved = {"cord_angle"} if size == "22x5.5 8PR" else set()
    given = {number.name: number.text for number in drawn.rules if number.name not in solved}
    again = draw_size(size, given)
    assert again.meridian.length == pytest.approx(drawn.meridian.length, abs=3e-6)
    assert {number.source for number in again.rules if number.name not in solved} == {"given"}


def test_numbers_change_the_section() -> None:
    usual, wide = tf.section_from_size("205/60R15"), tf.section_from_size("205/60R15", {"rim_width": "7 in"})
    assert wide.overall_width - usual.overall_width == pytest.approx(0.4 * INCH, abs=2e-4)
    flat = tf.section_from_size("205/60R15", {"grooves": 0, "tread_gauge": "4 mm"})
    assert not flat.grooves
    assert usual.grooves
    assert flat.outer_diameter == pytest.approx(usual.outer_diameter, abs=1e-6)


def test_the_tread_is_rounded_off_at_its_shoulder() -> None:
    """The road's boundary lies on the tread's arc, then on the shoulder's, tangent to it, up to the tread's width."""
    size, rules = "255/40R17", draw_size("255/40R17").rules
    section = tf.section_from_size(size, {"grooves": 0})
    r, z = np.concatenate(section.boundary_line("road")).T
    n = {number.name: number.value for number in rules}
    crown, start = n["outer_diameter"] / 2, n["tread_width"] / 2 - n["shoulder_width"]
    angle = np.arcsin(start / n["tread_radius"])
    radius = np.where(z < start, n["tread_radius"], n["shoulder_radius"])
    centre_r = np.where(z < start, crown, crown - (n["tread_radius"] - n["shoulder_radius"]) * (1 - np.cos(angle)))
    centre_z = np.where(z < start, 0.0, (n["tread_radius"] - n["shoulder_radius"]) * np.sin(angle))
    assert np.hypot(r - centre_r + radius, z - centre_z) == pytest.approx(radius, abs=2e-4)
    assert z.max() == pytest.approx(n["tread_width"] / 2, abs=3e-3)  # it ends with the belt that is near
    assert crown - r.min() > 1.2 * z.max() ** 2 / 2 / n["tread_radius"]


def test_a_given_cord_angle_decides_the_width() -> None:
    steep = draw_size("22x5.5 8PR", {"cord_angle": "34 deg"}).meridian
    assert np.arccos(steep.membrane.lift * steep.crown) == pytest.approx(np.radians(34))
    assert steep.half_width != pytest.approx(draw_size("22x5.5 8PR").meridian.half_width, abs=1e-3)


def test_the_size_of_the_clark_and_dodge_tyre_is_its_section() -> None:
    """The published 22x5.5 8PR, inflated: carcass crown at 10.34 in, crown radius 3.48 in, 5.82 in long."""
    line = draw_size("22x5.5 8PR", {"radius_growth": "0 mm", "width_growth": "0 mm"}).meridian
    assert line.crown / INCH == pytest.approx(10.337, abs=0.15)
    assert 1 / float(line.membrane.curvature(line.crown)) / INCH == pytest.approx(3.48, rel=0.15)
    assert line.length / INCH == pytest.approx(5.82, rel=0.08)


@pytest.mark.parametrize(
    ("reference", "message"),
    [
        ({"size": "205/60R15", "rim_width": "4 in"}, "4 in is too narrow for 205/60R15; allowed: 5.19 to 7.53"),
        ({"size": "205/60R15", "rim_width": "9 in"}, "too wide"),
        ({"size": "205/60R15", "load": "6 kN", "pressure": "200 kPa"}, "pressure: 200 kPa carries 5211.5 N, not"),
        ({"size": "205/60R15", "load": "9 kN"}, "load: 9000 N is more than the rated load of 6230 N"),
        ({"size": "22x5.5 8PR", "load": "4350 lbf", "pressure": "100 psi"}, "at least 930.8 kPa are needed"),
        ({"size": "205/60R35"}, "rim diameter 35 in, which road tyres have not; nearest 24.5 in"),
        ({"size": "25x9.1"}, "is not in the data book: write it with the rim, such as 25x9.1-13"),
        ({"size": "205/60R15", "parameters": {"crown_radus": "4 in"}}, "did you mean 'crown_radius'"),
        ({"size": "205/60R15", "parameters": {"crown_radius": "4 kg"}}, "parameters.crown_radius"),
        ({"size": "205/60R15", "parameters": {"crown_radius": "1 mm"}}, "outside what is possible here: 50 mm to"),
        ({"size": "205/60R15", "parameters": {"apex_height": "200 mm"}}, "from the bead to below the widest place"),
        ({"size": "205/60R15", "parameters": {"section_width": "165 mm", "rim_width": "7.5 in"}}, "."),
        ({"size": "295/80R22.5", "parameters": {"belt_power": "2", "crown_radius": "0.6 m"}}, "give one of them"),
        ({"size": "385/65R22.5", "parameters": {"belt_power": "2"}}, "a larger belt_power, a wider belt"),
        ({"size": "22x5.5 8PR", "parameters": {"belt_power": "2"}}, "no number 'belt_power'"),
        ({"size": "205/60R15", "color": "black"}, "unknown key 'color'"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_one_error(reference: dict[str, object], message: str) -> None:
    with pytest.raises(InputError) as error:
        load(reference)
    assert message in str(error.value)


@pytest.mark.parametrize(("size", "share"), [("205/60R15", 0.5), ("295/80R22.5", 0.7), ("46x17R20", 0.7)])
def test_a_bundle_is_the_mixture_of_its_wires_and_rubber(size: str, share: float) -> None:
    """G = (1 + v)/(1 - v) 10 MPa, rho = (1 - v) 1120 + v 7850 kg/m3; the wires of the card are those of the rule."""
    drawn = draw_size(size)
    card, rules = drawn.materials["bead"], drawn.rules
    area = rules["bead_wire_area"].value
    assert area / (rules["bead_height"].value * rules["bead_width"].value) == pytest.approx(share, rel=1e-6)
    assert float(card["shear_modulus"]["value"].split()[0]) == pytest.approx(10 * (1 + share) / (1 - share), rel=1e-3)
    assert float(card["density"]["value"].split()[0]) == pytest.approx(1120 + share * 6730, rel=1e-3)
    wires = float(card["cords"]["ends"].split()[0]) * rules["bead_height"].value
    diameter = 1.6e-3 if "22.5" in size else 1e-3
    assert wires * np.pi * diameter**2 / 4 == pytest.approx(area, rel=1e-3)


@pytest.mark.parametrize("size", ["22x5.5 8PR", "40x14 24PR"])
def test_bias_wires_are_those_of_the_rule_though_the_bead_is_drawn_smaller(size: str) -> None:
    """The core thins by a tenth along the bead, 5.4 % of its area with the bend: the hoop stiffness is still E A."""
    drawn = draw_size(size)
    rules = drawn.rules
    data = {"title": "bead", "section": size, "materials": {}, "drive": DRIVE, "mesh": MESH}
    study = StudyData("bead", data, None, Path())
    body = tyre_body(study)
    (layer,) = body.parts["bead"].cords
    bead = body.mesh.subdomains["bead"]
    stiffness = (layer.stiffness * body.rings.weights[bead] / body.rings.points[0, bead]).sum()
    wire = float(study.materials["bead"].youngs_modulus.value)
    assert stiffness == pytest.approx(wire * rules["bead_wire_area"].value, rel=0.01)
    stated = rules["bead_height"].value * rules["bead_width"].value
    assert study.section.area("bead") == pytest.approx(0.946 * stated, rel=0.005)


@pytest.mark.parametrize(
    "size", ["205/55R16 91V", "175/70R13", "LT235/85R16", "295/80R22.5", "445/65R22.5", "22x5.5R12 8PR", "1400x530R23"]
)
def test_a_bundle_is_drawn_as_large_as_its_numbers_say(size: str) -> None:
    """It bends about the flange: its middle is as long as it is high, so that it has its height times its width."""
    rules, section = draw_size(size).rules, load({"size": size})
    stated = rules["bead_height"].value * rules["bead_width"].value
    assert section.area("bead") == pytest.approx(stated, rel=0.01)


@pytest.mark.parametrize(
    "size", ["205/60R15", "LT235/85R16", "11R22.5", "445/65R22.5", "22x5.5R12 8PR", "46x17R20", "1400x530R23"]
)
def test_cords_of_a_body_ply_do_not_overlap_at_the_bead(size: str) -> None:
    """Radial cords keep their number round the wheel: their distance falls with the radius, to a diameter at least."""
    drawn, section = draw_size(size), load({"size": size})
    for region in ("turn-up", "bead-wrap"):
        cords = material(drawn.materials[region]).cords
        least = min(float(outline[:, 0].min()) for outline in section.outline(region))
        assert cords.diameter * cords.ends / cords.plies * cords.angle_radius / least < 1.002
        assert cords.plies == drawn.rules["plies"].value


def test_more_wire_than_the_bundle_holds_is_refused() -> None:
    with pytest.raises(InputError, match="bead_height x bead_width; allowed: below 90%"):
        draw_size("205/60R15", {"bead_width": "3 mm", "bead_height": "4 mm"})
