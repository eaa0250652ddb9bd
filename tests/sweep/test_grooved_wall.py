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


def test_variants_of_a_grooved_tyre_have_answers() -> None:
    changes = {
        "mesh.size": "20 mm", "mesh.element": "P1", "mechanics.strain": "given", "numerics.tolerance": "1 K",
        "drive.duration": "20 s", "output.every": "10 s",
    }  # fmt: skip
    swept = sweep(plan_of(study("passenger-205-55r16", changes), {"drive.speed": ["60 km/h", "80 km/h"]}))
    assert not swept.failed
    assert (swept.table["gradient_K_m"] > 0).all()
