"""Problems on one mesh share its operators, also after many other meshes."""

from __future__ import annotations

import skfem

from tyrefem.conduction.operators import operators_of


def test_operators_that_someone_holds_are_found_again_after_many_meshes() -> None:
    mesh = skfem.MeshTri().refined(1)
    held = operators_of(mesh, "P1", False)
    others = [skfem.MeshTri().refined(1) for _ in range(20)]
    assert len({id(operators_of(one, "P1", False)) for one in others}) > 6
    assert operators_of(mesh, "P1", False) is held
    assert operators_of(mesh, "P2", False) is not held
