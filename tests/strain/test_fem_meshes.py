"""The mechanics on gmsh's meshes: its quadrilaterals give what the mapped mesh gives; beside its triangles the mapped
mesh serves."""

from __future__ import annotations

import pytest

import tyrefem as tf
from tyrefem.errors import InputError
from tyrefem.geometry.meshing import build, write
from tyrefem.mechanics.footprint.pressed_tyre import mechanical_mesh
from tyrefem.mechanics.solid.inflation import inflate

STUDY = "nasa-22x5.5-8pr"
pytestmark = pytest.mark.usefixtures("needs_gmsh")


def test_gmshs_quadrilaterals_inflate_as_the_mapped_mesh() -> None:
    gmsh = tf.study(STUDY, {"mesh.size": "20 mm", "mesh.mesher": "gmsh", "mesh.cell": "quad"})
    mapped = tf.study(STUDY, {"mesh.size": "6 mm"})
    meshes = [mechanical_mesh(item) for item in (gmsh, mapped)]
    assert [mesh.mesher for mesh in meshes] == ["gmsh", "mapped"]
    first, second = (inflate(item, 3e5, mesh) for item, mesh in zip((gmsh, mapped), meshes, strict=True))
    # Where the held seat ends moves with the elements.
    assert first.radius_growth == pytest.approx(second.radius_growth, rel=0.02)
    stretched = [item.cord_tensions["carcass"].strain[1] for item in (first, second)]
    assert stretched[0] == pytest.approx(stretched[1], rel=0.02)


def test_a_run_on_gmshs_triangles_takes_its_strain_from_the_mapped_mesh() -> None:
    """Only the places where energies are read differ."""
    changes = {"mechanics.strain": "fem", "mesh.size": "10 mm", "drive.duration": "60 s", "drive.load": "2000 lbf"}
    changes["mechanics.motion"] = "linear"
    studies = [tf.study(STUDY, {**changes, "mesh.mesher": item}) for item in ("gmsh", "mapped")]
    assert studies[0].mesh().cell == "tri"
    results = [study.run() for study in studies]
    cycle = results[0].tyre.schedule.cycles[0][0]
    assert cycle.tyre.body.mesh.t.shape[0] == 4
    forces = [result.rolling_resistance.cold_force for result in results]
    assert forces[0] == pytest.approx(forces[1], rel=0.03)


def test_a_file_of_triangles_is_refused(tmp_path) -> None:
    section = tf.study(STUDY).section
    file = write(build(section, size=12e-3, cell="tri", through=1).mesh, tmp_path / "tri.msh")
    with pytest.raises(InputError, match="needs quadrilaterals") as caught:
        inflate(tf.study(STUDY, {"mesh.file": str(file)}))
    assert caught.value.field == "mesh.cell"
