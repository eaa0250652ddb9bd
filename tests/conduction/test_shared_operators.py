"""Problems on one mesh share its operators, also after many other meshes."""

from __future__ import annotations

import skfem

from tyrefem.conduction.operators import operators_of


def test_operators_that_someone_holds_are_found_again_after_many_meshes() -> None:
    mesh = skfem.MeshTri().refined(1)
    held = operators_of(mesh, "P1", False)
    others = [skfem.MeshTri().refined(1).scaled(1.0 + number) for number in range(1, 21)]
    assert all(operators_of(other, "P1", False) is not held for other in others)
    assert operators_of(mesh, "P1", False) is held
    assert operators_of(skfem.MeshTri().refined(1), "P1", False) is held
    assert operators_of(mesh, "P2", False) is not held
