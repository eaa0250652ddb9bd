"""A study on a user's own mesh file gives what the built-in mesher gives on the same mesh."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest

import tyrefem as tf
from tyrefem.cli import main
from tyrefem.errors import InputError
from tyrefem.geometry import meshing
from tyrefem.library import find

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


def test_a_check_reads_the_mesh_file(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """A study without its mesh was in order, and every variant of its sweep failed."""
    text = find("study", "nasa-22x5.5-8pr").read_text(encoding="utf-8")
    (tmp_path / "study.toml").write_text(text + '\n[mesh]\nfile = "mine.msh"\n', encoding="utf-8")
    assert main(["check", str(tmp_path)]) == 2
    assert capfd.readouterr().err == f"tyrefem: {tmp_path / 'mine.msh'}: no such mesh file\n"


@pytest.mark.parametrize("cell", ["quad", "tri"])
def test_an_unfit_mesh_is_no_fault_of_the_drive(tmp_path: Path, cell: str) -> None:
    """The finite-element laws named 'drive.mesh.cell', and 'drive' for a file that is not there."""
    study = tf.study("nasa-22x5.5-8pr", {**SHORT, "mesh.cell": "tri", "mechanics.strain": "barrel"})
    file = tmp_path / "mine.msh"
    if cell == "tri":
        meshing.write(study.mesh(), file)
    with pytest.raises(InputError) as error:
        study.replace({"mesh": {"file": str(file)}}).run()
    assert error.value.field == ("mesh.cell" if cell == "tri" else None)


def test_a_size_beside_a_mesh_file_is_warned_of(tmp_path: Path) -> None:
    study = tf.study("nasa-22x5.5-8pr", SHORT)
    file = meshing.write(study.mesh(), tmp_path / "mine.msh")
    (warning,) = study.replace({"mesh.file": str(file)}).warnings
    assert (warning.field, warning.message) == ("mesh", "not read, as the mesh comes from mesh.file: size")
    assert not study.replace({"mesh": {"file": str(file), "element": "P1"}}).warnings
