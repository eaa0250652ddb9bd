"""Section files: what they may say, and what is refused with field and reason."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import ring_section

from tyrefem.cards import read_toml
from tyrefem.errors import InputError
from tyrefem.geometry import Profile, SectionCard, build, load
from tyrefem.library import names


@pytest.fixture
def ring_card() -> dict[str, Any]:
    return ring_section.ring_card()


INCH = 0.0254
SHIPPED = {"nasa-22x5.5-8pr", "nasa-22x5.5-12pr"}


def test_shipped_sections_are_found() -> None:
    assert set(names("section")) >= SHIPPED


@pytest.mark.parametrize("name", sorted(SHIPPED))
def test_shipped_section_is_a_22_by_5_5(name: str) -> None:
    section = load(name)
    assert section.outer_diameter == pytest.approx(22 * INCH, rel=0.012)
    # The tables leave an inflated section width of 6.2-6.3 in on the 5.5 in designation.
    assert 5.5 * INCH < section.overall_width < 6.4 * INCH
    assert section.regions == ("carcass", "bead", "tread", "sidewall")
    assert section.boundaries == ("contained_air", "road", "outside_air", "rim", "symmetry")
    assert section.as_full().boundaries == ("contained_air", "road", "outside_air", "rim")


def test_thickness_at_the_stations_is_the_printed_one() -> None:
    # Table H1 rows 11, 8, 4, 1 and table H2 rows 9, 5: mean YS, H1, H2 [in].
    rows = {
        "nasa-22x5.5-8pr": [(0.315, 0.2, 0.6), (2.1, 0.2, 0.44), (4.325, 0.2, 0.14), (5.82, 0.8, 0.25)],
        "nasa-22x5.5-12pr": [(1.545, 0.33, 0.48), (3.825, 0.28, 0.2)],
    }
    for name, table in rows.items():
        section = load(name)
        for s, h1, h2 in table:
            assert section.thickness("carcass", s * INCH) == pytest.approx(h1 * INCH, rel=1e-9)
            assert section.thickness("rubber", s * INCH) == pytest.approx(h2 * INCH, rel=1e-9)


def test_rating_reads_the_full_rated_load() -> None:
    eight, twelve = load("nasa-22x5.5-8pr").rating, load("nasa-22x5.5-12pr").rating
    assert eight is not None
    assert twelve is not None
    assert eight.load == pytest.approx(4350 * 4.4482216)
    assert twelve.pressure == pytest.approx(261 * 6894.757, rel=1e-6)
    assert twelve.bead_area == pytest.approx(2 * eight.bead_area)
    assert eight.cord_angle == pytest.approx(np.radians(35))


def test_diameter_moves_the_section_outwards_and_nothing_else() -> None:
    base = load("nasa-22x5.5-8pr")
    larger = load({"base": base.name, "parameters": {"outer_diameter": "24.074 in"}})
    assert larger.line.crown_midline_radius == pytest.approx(base.line.crown_midline_radius + INCH)
    assert larger.area() == pytest.approx(base.area(), rel=1e-12)
    assert larger.overall_width == pytest.approx(base.overall_width, rel=1e-12)


def test_overall_width_is_reached_exactly() -> None:
    wanted = 6.1 * INCH
    section = load({"base": "nasa-22x5.5-8pr", "parameters": {"overall_width": "6.1 in"}})
    assert section.overall_width == pytest.approx(wanted, abs=1e-9)
    assert section.outer_diameter == pytest.approx(22.074 * INCH, rel=1e-12)


def test_overall_width_out_of_reach_says_what_is_possible() -> None:
    with pytest.raises(InputError, match="wide; change sidewall_radius") as error:
        load({"base": "nasa-22x5.5-8pr", "parameters": {"overall_width": "9 in"}})
    assert error.value.field == "parameters.overall_width"


def test_thickness_scale_of_the_tread_leaves_the_sidewall_alone() -> None:
    base = load("nasa-22x5.5-8pr")
    thick = load({"base": base.name, "parameters": {"thickness_scale": {"tread": "120 %"}}})
    s = np.linspace(0, 2.1, 30) * INCH
    assert np.allclose(thick.thickness("rubber", s), 1.2 * base.thickness("rubber", s), rtol=1e-12)
    s = np.linspace(2.7, 5.8, 30) * INCH
    assert np.allclose(thick.thickness("rubber", s), base.thickness("rubber", s), rtol=1e-12)


def test_tables_stretch_with_the_meridian() -> None:
    longer = load({"base": "nasa-22x5.5-8pr", "parameters": {"meridian_length": "6.0 in"}})
    assert longer.thickness("carcass", 6.0 * INCH) == pytest.approx(0.8 * INCH, rel=1e-9)
    assert longer.line.length - longer.layers[0].regions.ends[0] == pytest.approx(0.785 * INCH)


def test_crown_midline_radius_may_stand_for_the_diameter(ring_card: dict[str, Any]) -> None:
    del ring_card["parameters"]["crown_midline_radius"]
    ring_card["parameters"]["outer_diameter"] = "616 mm"
    assert build(SectionCard.check(ring_card)).line.crown_midline_radius == pytest.approx(0.3, rel=1e-12)
    ring_card["parameters"]["crown_midline_radius"] = "301 mm"
    with pytest.raises(InputError, match=r"0.3 m; change outer_diameter to 0.618 m"):
        build(SectionCard.check(ring_card))


@pytest.mark.parametrize(
    ("reading", "outside"), [("inner", 10), ("carcass", 8), ("total", 5), ("rubber", 3), ("outer", 0)]
)
def test_reading_of_the_meridian(ring_card: dict[str, Any], reading: str, outside: float) -> None:
    ring_card["line"]["reference"] = reading
    section = build(SectionCard.check(ring_card))
    assert section.outer_diameter == pytest.approx(0.6 + 2e-3 * outside, rel=1e-12)


def test_pchip_passes_through_the_table_without_overshoot() -> None:
    table = Profile((0.0, 0.1, 0.2, 0.3), (0.02, 0.02, 0.005, 0.004), "pchip")
    assert np.allclose(table(list(table.s)), table.values)
    s = np.linspace(-0.3, 0.3, 1001)
    assert (np.diff(table(s[s >= 0])) <= 1e-15).all()
    inner = np.abs(np.abs(s) - 0.15) < 0.149
    ds = 1e-7
    slope = (table(s + ds) - table(s - ds)) / (2 * ds)
    assert np.allclose(table.slope(s)[inner], slope[inner], atol=1e-5)


def change(card: dict[str, Any], where: str, value: Any) -> None:
    *path, last = where.split(".")
    table: Any = card
    for key in path:
        table = table[int(key)] if isinstance(table, list) else table[key]
    if value is None:
        del table[last]
    elif isinstance(table, list):
        table[int(last)] = value
    else:
        table[last] = value


@pytest.mark.parametrize(
    ("where", "value", "field", "words"),
    [
        ("parameters.crown_radius", "55 mm", "parameters.crown_radius", "outside the crown arc"),
        ("parameters.sidewall_radius", "20 mm", "parameters.sidewall_radius", "closes on itself"),
        ("parameters.sidewall_radius", "-20 mm", "parameters.sidewall_radius", "more than 0"),
        ("parameters.meridian_length", "30 mm", "parameters.meridian_length", "exceed the crown arc"),
        ("parameters.crown_midline_radius", "100 mm", "parameters.outer_diameter", "wheel's axis"),
        ("parameters.meridian_length", "310 mm", "layers.0.s", "runs from 0 to 0.2 m"),
        ("layers.0.s", ["0 mm", "0 mm"], "layers.0.thickness", "must rise"),
        ("layers.0.s", ["200 mm", "0 mm"], "layers.0.thickness", "must rise"),
        ("layers.0.s", ["10 mm", "200 mm"], "layers.0.s", "runs from 0.01"),
        ("layers.0.thickness", ["4 mm", "0 mm"], "layers.0.thickness", "must be positive"),
        ("layers.0.thickness", ["4 mm"], "layers.0.thickness", "1 values for 2 stations"),
        ("layers.0.thickness", ["4 mm", "nan mm"], "layers.0.thickness", "is not a quantity"),
        ("layers.0.thickness", ["4", "4"], "layers.0.thickness", "no unit"),
        ("layers.0.thickness", {"unit": "mm", "values": ["4 mm", 4]}, "layers.0.thickness", "list of numbers"),
        ("layers.0.thickness", {"unit": "kg", "values": [4, 4]}, "layers.0.thickness", "not a unit"),
        ("layers.0.thickness", ["210 mm", "210 mm"], "layers", "inner surface folds"),
        ("layers.0.regions.0.to", "shoulderr", "layers.0.regions.0.to", "did you mean 'shoulder'"),
        ("layers.0.regions.0.to", "250 mm", "layers.0.regions.0.to", "'carcass' ends 0.25 m from the crown, beyond"),
        ("layers.0.regions.0.to", "-250 mm", "layers.0.regions.0.to", "'carcass' ends 0.25 m from the bead, beyond"),
        ("layers.0.regions.0.to", "0 mm", "layers.0.regions.0.to", "is the crown"),
        ("layers.0.regions.0.to", None, "layers.0.regions.0.to", "every part but the last"),
        ("layers.0.regions.1.to", "200 mm", "layers.0.regions.1.to", "leave 'to' out"),
        ("layers.1.name", "carcass", "layers", "taken"),
        ("layers.1.name", "total", "layers", "taken"),
        ("line.reference", "carcas", "line.reference", "did you mean 'carcass'"),
        ("line.kind", "three-arcs", "line.kind", "two-arcs"),
        ("line.kind", "points", "parameters.shoulder_s", "needs it"),
        ("boundaries.0.name", "symmetry", "boundaries", "another boundary"),
        ("parameters.rim_length", None, "boundaries.1.to", "needs parameters.rim_length"),
        ("parameters.rim_length", "150 mm", "boundaries", "'outside_air' never appears"),
        ("parameters.crown_radius", None, "parameters.crown_radius", "needs it"),
        ("parameters.crown_midline_radius", None, "parameters.outer_diameter", "give it or"),
        ("parameters.shoulder_fraction", None, "parameters.shoulder_fraction", "give it or"),
        ("parameters.thickness_scale", {"tred": 1.1}, "parameters.thickness_scale", "did you mean 'tread'"),
        ("parameters.crown_radios", "1 m", None, "did you mean 'crown_radius'"),
        ("line.source", None, "line.source", "missing"),
        ("layers", [], "layers", "at least 1"),
        ("title", "", "title", "must not be empty"),
    ],
)
def test_bad_card_names_field_and_reason(
    ring_card: dict[str, Any], where: str, value: Any, field: str | None, words: str
) -> None:
    change(ring_card, where, value)
    with pytest.raises(InputError, match=words) as error:
        build(SectionCard.check(ring_card))
    if field is not None:
        assert error.value.field == field


def test_sidewall_that_meets_the_other_side_is_refused(ring_card: dict[str, Any]) -> None:
    ring_card["parameters"] |= {"meridian_length": "320 mm", "crown_midline_radius": "400 mm"}
    for layer in ring_card["layers"]:
        layer["stretch"] = True
    with pytest.raises(InputError, match=r"crosses the mid plane at s = 0.31"):
        build(SectionCard.check(ring_card))


def test_layers_that_overlap_are_refused(ring_card: dict[str, Any]) -> None:
    # A narrow crown with a long, tightly curled sidewall runs back into the tread.
    ring_card["parameters"] |= {"crown_radius": "400 mm", "sidewall_radius": "35 mm", "shoulder_fraction": "1.5"}
    ring_card["parameters"] |= {"meridian_length": "325 mm", "crown_midline_radius": "800 mm"}
    for layer in ring_card["layers"]:
        layer["stretch"] = True
    with pytest.raises(InputError, match="crosses itself"):
        build(SectionCard.check(ring_card))


def test_errors_name_the_file(tmp_path: Path) -> None:
    text = Path(names("section")["nasa-22x5.5-8pr"]).read_text()
    path = tmp_path / "mine.toml"
    path.write_text(text.replace('crown_radius = "3.482 in"', 'crown_radius = "2 in"'))
    with pytest.raises(InputError, match="outside the crown arc") as error:
        load(str(path))
    assert error.value.file == path
    assert error.value.field == "parameters.crown_radius"


@pytest.mark.parametrize("name", sorted(SHIPPED))
def test_every_group_of_numbers_has_a_source(name: str) -> None:
    data = read_toml(names("section")[name])
    groups = [data["line"], data["parameters"], data["rating"], *data["layers"]]
    assert all(len(group["source"]) > 20 for group in groups)
    assert "estimate" in data["rating"]["source"]


def test_no_region_has_the_name_of_what_grooves_cut_out(ring_card: dict[str, Any]) -> None:
    """Such a part would be left out of meshes, areas and masses without a word."""
    ring_card["layers"][0]["regions"] = [{"name": "groove", "to": "bead_start"}, {"name": "bead"}]
    with pytest.raises(InputError, match=r"'groove' is the name of what \[grooves\] cuts out") as error:
        build(SectionCard.check(ring_card))
    assert error.value.field == "layers.0.regions"


def test_a_worn_sidewall_leaves_the_tread_beside_its_grooves(ring_card: dict[str, Any]) -> None:
    """A row of the tread's table lies in a groove: it wears with the tread alone."""
    rubber = ring_card["layers"][1]
    rubber["s"], rubber["thickness"] = {"unit": "mm", "values": [0, 20, 40, 120, 200]}, ["6 mm"] * 5
    ring_card["grooves"] = {"at": ["20 mm"], "width": "8 mm", "source": "made up for a test"}
    section = build(SectionCard.check(ring_card))
    s = np.linspace(0.0, 0.04, 41)
    assert section.worn("sidewall", 0.2).interfaces(s) == pytest.approx(section.interfaces(s), abs=1e-12)
    assert section.worn("tread", 0.2).interfaces(s)[-1] == pytest.approx(section.interfaces(s)[-1] - 1.2e-3, abs=1e-12)


def test_a_table_that_begins_on_the_other_side_is_refused() -> None:
    """A section is symmetric: rows at negative stations changed the thickness of the crown unseen."""
    table = {
        "unit": "in",
        "values": [-1.0, *read_toml(names("section")["nasa-22x5.5-8pr"])["layers"][0]["s"]["values"][1:]],
    }
    with pytest.raises(InputError, match=r"layers\.0\.s: the table runs from -0\.0254 to 0\.1478 m"):
        load({"base": "nasa-22x5.5-8pr", "layers": {"carcass": {"s": table}}})
