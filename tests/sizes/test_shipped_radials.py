"""The shipped radials are their sizes by the rules, so that anybody can make them again."""

from __future__ import annotations

import pytest

import tyrefem as tf
from tyrefem import library
from tyrefem.geometry import load
from tyrefem.mechanics.solid.inflation import inflate
from tyrefem.schemas.line import without_line
from tyrefem.sizes import draw_size
from tyrefem.sizes.text import section_text

#: Section file -> its size and the study that has its materials.
SHIPPED = {
    "passenger-205-55r16": ("205/55R16 91V", "passenger-205-55r16"),
    "truck-295-80r22.5": ("295/80R22.5 152/148M", "truck-295-80r22.5"),
    "aircraft-radial-22x5.5": ("22x5.5R12 8PR", "aircraft-radial"),
}


@pytest.mark.parametrize("name", SHIPPED)
def test_the_file_is_what_the_rules_write(name: str) -> None:
    """No number is given: each has its rule and source. The first line has the command, behind that of the schema."""
    size, _ = SHIPPED[name]
    _, path, _ = library.load("section", name)
    text = without_line(path.read_text(encoding="utf-8"))
    assert text == section_text(draw_size(size), f"tyrefem new section '{size}'")
    assert "given" not in {number.source for number in draw_size(size).rules}


@pytest.mark.parametrize("name", SHIPPED)
def test_the_study_has_the_materials_of_the_size(name: str) -> None:
    size, study = SHIPPED[name]
    data, _, _ = library.load("study", study)
    assert data["materials"] == draw_size(size).materials
    assert data["section"] == name


@pytest.mark.parametrize("name", SHIPPED)
def test_nothing_unfolds_under_pressure(name: str) -> None:
    """Sections drawn by hand grew by 8 mm in width; a carcass line in equilibrium moves by its cords' stretch only."""
    study = tf.study(SHIPPED[name][1], {"mesh.size": "12 mm"})
    growth = inflate(study).width_growth
    assert 0 < growth < 4e-3
    assert load(name).warnings == ()


@pytest.mark.parametrize("size", ["22x5.5R9", "18x5.5R8", "27x7.75R15", "46x17R20", "1400x530R23"])
def test_belts_of_aircraft_radials_fit_under_their_tread(size: str) -> None:
    """Without a number given; their plies and pressure follow the width where the size names no ply rating."""
    rules = draw_size(size).rules
    assert rules["outer_belts_width"].value < rules["inner_belts_width"].value < rules["tread_width"].value
    assert 140 < rules["rated_pressure"].value / 6894.757 < 220
