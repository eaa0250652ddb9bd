"""A study on a user's own mesh file gives what the built-in mesher gives on the same mesh."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest

import tyrefem as tf
from tyrefem.errors import InputError
from tyrefem.geometry import meshing

SHORT = {"drive.duration": "60 s", "mesh.size": "4 mm", "mesh.element": "P1"}


@pytest.mark.parametrize("suffix", ["msh", "vtu"])
def test_written_and_read_back(tmp_path: Path, suffix: str) -> None:
    study = tf.study("nasa-22x5.5-8pr").replace(SHORT)
    file = meshing.write(study.mesh(), tmp_path / f"mine.{suffix}")
    from_file = study.replace({"mesh.file": str(file)})
    assert from_file.run().readings.to_numpy() == pytest.approx(study.run().readings.to_numpy(), abs=1e-6)
    assert from_file.run().summary()["mesh"]["mesher"] == "file"


def test_mesh_of_another_tyre_is_refused(tmp_path: Path) -> None:
    file = meshing.write(tf.study("nasa-22x5.5-12pr").replace(SHORT).mesh(), tmp_path / "other.msh")
    from_file = tf.study("nasa-22x5.5-8pr").replace({"mesh.file": str(file)})
    with pytest.raises(InputError, match=r"other\.msh.*times the area"):
        from_file.mesh()


def test_a_mesh_without_the_line_that_a_strain_law_needs_names_its_file(tmp_path: Path) -> None:
    """The report's law has other strains in the carcass under the tread: its elements must end at the shoulder."""
    study = tf.study("nasa-22x5.5-8pr").replace(SHORT)
    file = meshing.write(study.mesh(), tmp_path / "mine.vtu")
    mesh = meshio.read(file)
    section = study.section
    s, depth = section.locate(mesh.points[:, :2])
    shoulder = section.line.shoulder_s
    carcass = section.thickness("carcass", [shoulder])[0]
    at = np.flatnonzero((np.abs(s - shoulder) < 1e-6) & (depth > 1e-4) & (depth < carcass - 1e-4))
    assert len(at)
    mesh.points[at, :2] = section.place(s[at] + 4e-4, depth[at])
    mesh.write(file)
    with pytest.raises(InputError, match=r"mesh\.file: the mesh has no line at s = 56\.0683 mm; elements.*'arcs'"):
        study.replace({"mesh.file": str(file)}).run()
