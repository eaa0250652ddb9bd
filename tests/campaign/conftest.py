"""A campaign of three cases that takes a moment."""

from __future__ import annotations

from pathlib import Path

import pytest
import tomli_w

import tyrefem as tf

NASA = "nasa-22x5.5-8pr"
CASES = """\
# load of the last row: more than the tyre can carry at this pressure
name,drive.load [lbf],drive.pressure [psi],note
light,2000,83,
usual,2700,83,"as in the report, table 1"
crushed,40000,83,must fail
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with the campaign's study and table."""
    short = {"drive.duration": "20 s", "mesh.size": "8 mm", "output.fields": 2}
    data = tf.study(NASA).replace(short | {"cases": "cases.csv", "title": "Three <loads>"}).data
    (tmp_path / "study.toml").write_text(tomli_w.dumps(data), encoding="utf-8")
    (tmp_path / "cases.csv").write_text(CASES, encoding="utf-8")
    return tmp_path


@pytest.fixture
def campaign(folder: Path) -> tf.Campaign:
    """The campaign."""
    return tf.study(folder).campaign()
