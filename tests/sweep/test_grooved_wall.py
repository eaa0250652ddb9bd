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
    mesh = study(name, {"mesh.size": "5 mm"}).mesh()
    section, wall = mesh.section, wall_of(mesh)
    across = section.in_groove(wall.s)
    assert across.any()
    assert section.contains(wall.inner).all()
    assert section.contains(wall.outer).all()
    assert (wall.thickness[across] < section.total_thickness(wall.s[across]) - 4e-3).all()
    apart = np.linalg.norm(wall.outer - wall.inner, axis=1)
    assert apart == pytest.approx(wall.thickness, abs=1e-3)


@pytest.mark.parametrize("name", ["nasa-22x5.5-8pr", "passenger-205-55r16"])
def test_a_full_section_has_the_stations_of_a_half_on_both_sides(name: str) -> None:
    half, full = (wall_of(study(name, {"mesh.section": side}).mesh()) for side in ("half", "full"))
    assert half.s[0] == 0.0
    right = full.s >= 0
    assert full.s[right] == pytest.approx(half.s)
    assert full.s[::-1] == pytest.approx(-full.s)
    for part in ("thickness", "inner", "outer"):
        assert getattr(full, part)[right] == pytest.approx(getattr(half, part), abs=1e-9)


@pytest.mark.parametrize(("name", "strain"), [("nasa-22x5.5-8pr", "arcs"), ("passenger-205-55r16", "given")])
def test_a_coarse_mesh_has_the_gradient_of_a_fine_one(name: str, strain: str) -> None:
    """Both ends lie on the surfaces, a sagitta from them at most: no part of the wall's difference is left out."""
    changes = {"mechanics.strain": strain, "drive.duration": "300 s", "numerics.tolerance": "0.1 K"}
    coarse, fine = (study(name, {**changes, "mesh.size": size}).run() for size in ("15 mm", "4 mm"))
    wall = wall_of(coarse.tyre.mesh)
    apart = np.linalg.norm(wall.outer - wall.inner, axis=1)
    # Of an element of 15 mm on a curve of 80 mm: 15^2 / (8 80) mm.
    assert np.abs(apart - wall.thickness).max() < 0.5e-3
    (_, steep), (_, steep_fine) = coarse.wall_gradient, fine.wall_gradient
    assert steep.max() == pytest.approx(steep_fine.max(), rel=0.04)


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
