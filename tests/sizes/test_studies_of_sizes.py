"""A study whose section is a size: cards of the size, dotted names, cases, files."""

from __future__ import annotations

from pathlib import Path

import pytest

import tyrefem as tf
from tyrefem.api import Study
from tyrefem.errors import InputError
from tyrefem.inputs.changes import all_changed, check_compatible, value_at
from tyrefem.sizes.section import drawn_of
from tyrefem.variants.task import bundle

pytestmark = pytest.mark.fast
STUDY = """
title = "a size"
section = { size = "205/60R15", rim_width = "6 in", parameters = { crown_radius = "700 mm" } }
[materials]
tread = "rubber-tread-passenger-low-loss"
body-ply = { cords = { modulus = "5 GPa" } }
[drive]
speed = "60 km/h"
load = "4 kN"
pressure = "220 kPa"
duration = "60 s"
ambient = "25 degC"
[mesh]
size = "8 mm"
through = 1
"""


@pytest.fixture
def sized(tmp_path: Path) -> Study:
    (tmp_path / "study.toml").write_text(STUDY)
    return tf.study(tmp_path / "study.toml")


def test_cards_follow_the_size(sized: Study) -> None:
    assert sized.section.name == "205/60R15"
    assert sized.materials["body-ply"].cords.modulus == 5e9
    assert sized.materials["body-ply"].cords.ends == 1100
    assert "low" in sized.materials["tread"].title.lower()
    crown = sized.section.line.position(0.0)[0]
    assert sized.materials["turn-up"].cords.angle_radius == pytest.approx(crown, abs=1e-5)


def test_dotted_names_reach_the_rules(sized: Study) -> None:
    wide = sized.replace({"section.rim_width": "7 in"})
    assert wide.section.overall_width > sized.section.overall_width + 0.009
    round_crown = sized.replace({"section.parameters.crown_radius": "500 mm"})
    assert round_crown.data["section"]["parameters"] == {"crown_radius": "500 mm"}
    assert round_crown.section.line.position(0.05)[0] < sized.section.line.position(0.05)[0]
    assert sized.replace({"section.crown_radius": "500 mm"}).section == round_crown.section
    stiffer = sized.replace({"materials.belt-1.cords.modulus": "180 GPa"})
    assert stiffer.materials["belt-1"].cords.modulus == 1.8e11
    assert stiffer.materials["belt-1"].cords.angle_radius == sized.materials["belt-1"].cords.angle_radius


def test_both_names_of_the_rim_set_the_same_number(sized: Study) -> None:
    for first in ("section.rim_width", "section.parameters.rim_width"):
        for second in ("section.rim_width", "section.parameters.rim_width"):
            study = sized.replace({first: "6 in"}).replace({second: "6.5 in"})
            assert drawn_of(study.data["section"]).rules["rim_width"].text == "6.5 in"
    both = {"size": "205/60R15", "rim_width": "6 in", "parameters": {"rim_width": "7 in"}}
    with pytest.raises(InputError, match=r"section\.parameters\.rim_width: 'rim_width' of the same table"):
        sized.replace({"section": both})
    with pytest.raises(InputError, match=r"'section\.rim_width' sets it too"):
        check_compatible(sized.data, {"section.rim_width": "6 in", "section.parameters.rim_width": "7 in"})


def test_numbers_of_the_rules_can_be_varied_by_factors(sized: Study) -> None:
    assert value_at(sized.data, "section.crown_radius") == "700 mm"
    assert value_at(sized.data, "section.parameters.tread_gauge") == "8.3 mm"
    assert value_at(sized.data, "section.size") == "205/60R15"
    assert value_at(sized.data, "materials.belt-1.cords.modulus") == "150 GPa"
    thin = sized.replace({"section.tread_gauge": "4.15 mm"})
    assert sized.scaled("section.tread_gauge", 0.5).section == thin.section


def test_another_size_takes_its_own_cards(sized: Study) -> None:
    other = sized.replace({"section.size": "255/40R17", "section.rim_width": "9 in", "drive.load": "6 kN"})
    assert other.section.outer_diameter == pytest.approx(0.6358, abs=2e-4)
    assert other.materials["belt-1"].cords.angle_radius > sized.materials["belt-1"].cords.angle_radius
    with pytest.raises(InputError, match="rim_width: 6 in is too narrow for 255/40R17"):
        sized.replace({"section.size": "255/40R17"})


def test_a_size_replaces_a_card_and_a_card_a_size() -> None:
    card = {"section": {"base": "nasa-22x5.5-8pr", "parameters": {"crown_radius": "3.6 in"}}}
    assert all_changed(card, {"section.size": "22x5.5 8PR"})["section"] == {"size": "22x5.5 8PR"}
    size = {"section": {"size": "22x5.5 8PR", "rim_width": "4.2 in"}}
    assert all_changed(size, {"section.base": "nasa-22x5.5-8pr"})["section"] == {"base": "nasa-22x5.5-8pr"}
    assert all_changed({"section": "205/60R15"}, {"section.tread_gauge": "5 mm"})["section"] == {
        "size": "205/60R15", "parameters": {"tread_gauge": "5 mm"},
    }  # fmt: skip


def test_cases_swap_sizes(sized: Study, tmp_path: Path) -> None:
    (tmp_path / "cases.csv").write_text(
        "name,section.size,section.rim_width [in],drive.load [N],drive.pressure [kPa]\n"
        "small,195/65R15,6,4000,220\nwide,255/40R17,9,5000,240\ntruck-size,22x5.5 8PR,4.25,12000,572\n"
    )
    text = STUDY.partition("[materials]")[2].partition("[drive]")[2]
    head = 'title = "sizes"\ncases = "cases.csv"\nsection = { size = "205/60R15" }\n[materials]\n[drive]'
    (tmp_path / "study.toml").write_text(head + text)
    study = tf.study(tmp_path / "study.toml")
    sections = [study.case(name).section for name in study.case_names]
    assert [section.name for section in sections] == ["195/65R15", "255/40R17", "22x5.5 8PR"]


def test_a_study_of_a_size_is_saved_and_packed(sized: Study, tmp_path: Path) -> None:
    again = tf.study(sized.save(tmp_path / "elsewhere" / "study.toml"))
    assert again.section == sized.section
    sent = bundle(sized)
    assert sent.data["section"] == sized.data["section"]


def test_the_table_of_materials_may_be_left_out(tmp_path: Path, sized: Study) -> None:
    before, after = STUDY.split("[materials]")
    (tmp_path / "study.toml").write_text(before + after[after.index("[drive]") :])
    plain = tf.study(tmp_path / "study.toml")
    assert list(plain.materials) == list(sized.materials)
    dense = plain.replace({"materials.tread.density.value": "1200 kg/m^3"})
    assert dense.materials["tread"].density.value == "1200 kg/m^3"
    assert tf.study(plain.save(tmp_path / "saved.toml")).materials.keys() == plain.materials.keys()
    assert bundle(plain).unpacked(tmp_path / "packed").materials.keys() == plain.materials.keys()
    with pytest.raises(InputError, match="materials: no material card for region 'carcass'"):
        plain.replace({"section": "nasa-22x5.5-8pr"})
