"""What a command answers with ``--json``, and what its folder of results tells of its making."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from documented_keys import checked
from every_command import Command

import tyrefem as tf
from tyrefem.cli import main
from tyrefem.output.folder import checksum

#: Commands whose numbers come without time steps.
WITHOUT_STEPS = ("press", "roll", "forces", "modes", "wear")
#: Commands with random numbers, and their seeds here.
SEEDS = {"blind": 1, "plan": 0, "sweep": 1, "rig layers": 1}


def tells_what_made_it(place: Path, command: Command, line: list[str]) -> None:
    """The folder names command, versions, inputs, mesh, tolerance and seed; its study runs again from there."""
    told = json.loads((place / "summary.json").read_text(encoding="utf-8"))
    assert told["command"] == command.words
    assert told["arguments"] == line
    libraries = set() if command.words == "schema" else {"python", "numpy", "scipy", "scikit-fem"}
    assert {"tyrefem", *libraries} <= set(told["versions"])
    assert all(checksum(Path(file)) == kept for file, kept in told["files_read"].items())
    read = {Path(file).name for file in told["files_read"]}
    assert read >= {Path(word).name for word in command.arguments if word.endswith(".toml")}
    assert told.get("random_seed") == SEEDS.get(command.words)
    if not command.of_study:
        return
    assert told["input"]["mesh"]["size"] == "15 mm"
    assert (told["mesh"]["mesher"], told["mesh"]["size_m"]) == ("mapped", 0.015)
    steps = told.get("tolerance_K", told.get("numerics", {}).get("tolerance_K"))
    assert (steps is None) == (command.words in WITHOUT_STEPS), steps
    assert "study.toml" in told["files"]
    study = tf.study(str(place / "study.toml"))
    assert study.card.mesh.size == 0.015
    assert study.section.regions == tf.study("study.toml").section.regions
    loaded = tf.load(place)
    assert loaded.study is not None


def answered(command: Command, line: list[str], capfd: pytest.CaptureFixture[str]) -> None:
    """Run a command line with ``--json``: one JSON object with the documented keys, and only our words on stderr."""
    assert {"as_json", "quiet"} <= command.options
    code = main(line)
    out, err = capfd.readouterr()
    assert code == 0, err
    checked(command.words, out)
    assert all(line.startswith("tyrefem: ") for line in err.splitlines())
