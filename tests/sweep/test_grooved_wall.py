"""The gradient through the wall of a grooved tyre: in a groove the wall ends at its bottom."""

from __future__ import annotations

import numpy as np
import pytest

from tyrefem import study
from tyrefem.geometry.wall import wall_of
from tyrefem.sweep.sweep import sweep
from tyrefem.variants.plan import plan_of


@pytest.mark.parametrize("name", ["passenger-205-55r16", "truck-295-80r22.5"])
def test_both_surfaces_of_the_wall_are_rubber(name: str) -> None:
    section = study(name).section
    wall = wall_of(section, 5e-3)
    across = section.in_groove(wall.s)
    assert across.any()
    assert section.contains(wall.inner).all()
    assert section.contains(wall.outer).all()
    assert (wall.thickness[across] < section.total_thickness(wall.s[across]) - 4e-3).all()
    apart = np.linalg.norm(wall.outer - wall.inner, axis=1)
    assert apart == pytest.approx(wall.thickness, abs=1e-3)


@pytest.mark.parametrize("name", ["nasa-22x5.5-8pr", "passenger-205-55r16"])
def test_a_full_section_has_the_stations_of_a_half_on_both_sides(name: str) -> None:
    half, full = (wall_of(study(name, {"mesh.section": side}).section, 5e-3) for side in ("half", "full"))
    assert half.s[0] == 0.0
    right = full.s >= 0
    assert full.s[right] == pytest.approx(half.s)
    assert full.s[::-1] == pytest.approx(-full.s)
    for part in ("thickness", "inner", "outer"):
        assert getattr(full, part)[right] == pytest.approx(getattr(half, part), abs=1e-9)


def test_half_and_full_section_have_the_same_steepest_gradient() -> None:
    changes = {"mesh.size": "12 mm", "drive.duration": "60 s", "numerics.tolerance": "0.5 K"}
    swept = sweep(plan_of(study("nasa-22x5.5-8pr", changes), {"mesh.section": ["half", "full"]}), reduced="never")
    half, full = swept.table["gradient_K_m"]
    assert full == pytest.approx(half, rel=1e-3)
    assert (swept.table["gradient_s_m"].abs() == swept.table["gradient_s_m"].abs().iloc[0]).all()


def test_variants_of_a_grooved_tyre_have_answers() -> None:
    changes = {
        "mesh.size": "20 mm", "mesh.element": "P1", "mechanics.strain": "given", "numerics.tolerance": "1 K",
        "drive.duration": "20 s", "output.every": "10 s",
    }  # fmt: skip
    swept = sweep(plan_of(study("passenger-205-55r16", changes), {"drive.speed": ["60 km/h", "80 km/h"]}))
    assert not swept.failed
    assert (swept.table["gradient_K_m"] > 0).all()
