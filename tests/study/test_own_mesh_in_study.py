"""A study on a user's own mesh file gives what the built-in mesher gives on the same mesh."""

from __future__ import annotations

from pathlib import Path

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
