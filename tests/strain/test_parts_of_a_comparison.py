"""What energies are compared by: the report's regions where its arcs apply, else the section's own."""

from __future__ import annotations

import pytest

import tyrefem as tf
from tyrefem.simulation.law_comparison import LawComparison


@pytest.mark.parametrize(
    ("name", "arcs"), [("nasa-22x5.5-8pr", True), ("aircraft-radial", False), ("passenger-205-55r16", False)]
)
def test_parts_are_regions_that_the_section_has(name: str, arcs: bool) -> None:
    # The aircraft radial is drawn by two arcs too, but has plies in place of one carcass.
    compared = LawComparison(tf.study(name, {"mesh.size": "12 mm"}), (), {})
    names = [part.name for part in compared.parts]
    assert (names == ["I", "II", "III", "IV", "V"]) is arcs
    whole = compared.study.section.volume() * (2 if compared.study.section.half else 1)
    assert sum(compared.volumes.values()) == pytest.approx(whole, rel=0.02)
