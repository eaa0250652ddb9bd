"""What energies are compared by: the report's regions where its arcs apply, else the section's own."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

import tyrefem as tf
from tyrefem.inputs.loading import TrR64, VerticalStiffness
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


@pytest.mark.parametrize(
    ("law", "pressed", "expected"),
    [
        (VerticalStiffness(law="vertical-stiffness", stiffness="200 N/mm", source="test"), True, 0.02),
        (TrR64(), True, None),
        (TrR64(), False, 0.015),
    ],
)
def test_the_load_law_without_a_rating(law: Any, pressed: bool, expected: float | None) -> None:
    case = SimpleNamespace(load=4e3, pressure=2e5, deflection=0.015, contact=object() if pressed else None)
    outcome: Any = SimpleNamespace(
        phase=0, knot=0, result=SimpleNamespace(tyre=SimpleNamespace(schedule=SimpleNamespace(cases=[[case]])))
    )
    study: Any = SimpleNamespace(
        section=SimpleNamespace(rating=None), card=SimpleNamespace(mechanics=SimpleNamespace(load_law=law))
    )
    assert LawComparison(study, (outcome,), {}).load_law_deflection == expected
