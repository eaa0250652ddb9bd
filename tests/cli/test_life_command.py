"""`tyrefem life`: files that agree with each other, a map for ParaView, and refusals in one line."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from pathlib import Path

import meshio
import numpy as np
import pytest

import tyrefem as tf
from tyrefem.cli import main

STUDY = "nasa-22x5.5-8pr"
QUICK = [
    *("--set", "mesh.size=14 mm", "--set", "mechanics.strain=fem", "--set", "mechanics.motion=linear"),
    *("--set", "drive.duration=60 s"),
]


def test_files_agree_with_each_other(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["life", STUDY, *QUICK, "--temperature", "60 degC", "--no-sensitivity", "--out", "out", "--json"]) == 0
    summary = json.loads(capfd.readouterr().out)
    folder = here / "out"
    assert summary == json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    assert summary["left_out_without_fatigue_table"] == ["bead"]
    assert "tolerance_K" not in summary  # nothing is simulated
    assert tf.study(str(folder / "study.toml")).card.mechanics.strain == "fem"
    assert summary["shortest_km"] == summary["places"][0]["life_km"] == min(summary["regions"].values())
    assert summary["share_of_phases_at_the_shortest"] == {"rolling": 1.0}
    with (folder / "life.csv").open(encoding="utf-8") as lines:
        rows = list(csv.DictReader(lines))
    assert len(rows) == 10
    for row, place in zip(rows, summary["places"], strict=True):
        assert float(row["life_km"]) == pytest.approx(place["life_km"], rel=1e-6)
        assert row["reason"] == place["reason"]
        assert "60 degC, plane " in place["reason"]
    assert (folder / "life.png").read_bytes().startswith(b"\x89PNG")
    assert not (folder / "sensitivity.csv").exists()
    mesh = meshio.read(folder / "life.vtu")
    km, logarithm = (mesh.cell_data[name][0] for name in ("life_km", "log10_life_km"))
    assert np.nanmin(km) == pytest.approx(summary["shortest_km"], rel=1e-6)
    np.testing.assert_allclose(10 ** logarithm[np.isfinite(km)], km[np.isfinite(km)], rtol=1e-5)
    corners = mesh.points[mesh.cells[0].data][:, :, :2]
    after = np.roll(corners, -1, axis=1)
    assert ((corners[..., 0] * after[..., 1] - corners[..., 1] * after[..., 0]).sum(axis=1) > 0).all()


def test_a_run_gives_temperatures_and_sensitivities(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["life", STUDY, *QUICK, "--no-pictures", "--no-vtk", "--out", "out"]) == 0
    words = capfd.readouterr().out
    summary = json.loads((here / "out" / "summary.json").read_text(encoding="utf-8"))
    assert summary["tolerance_K"] == 0.01
    by_change = {shift["change"]: shift["over_the_life_before"] for shift in summary["sensitivity"]}
    assert list(by_change) == ["speed + 10 %", "load + 10 %", "pressure - 10 %", "ambient + 10 K"]
    assert by_change["load + 10 %"] < 0.95
    assert 0.7 < by_change["ambient + 10 K"] < 0.98
    assert all(f"{change:16} shortest life" in words for change in by_change)
    assert "not compared with any measured life, and kilometres of small flaws are too few" in words
    with (here / "out" / "sensitivity.csv").open(encoding="utf-8") as lines:
        assert [row["change"] for row in csv.DictReader(lines)] == list(by_change)
    assert not (here / "out" / "life.png").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], 'mechanics.strain: the strain law "arcs" gives an energy'),
        (["--temperature", "60"], "--temperature: '60' has no unit"),
        (["--temperature", "60 degC", "--plateau"], "--plateau: --temperature has no phases"),
        (
            ["--set", "materials.tread.fatigue.tearing_energy=-1 kJ/m**2"],
            "study.toml: materials.tread.fatigue.tearing_energy: '-1 kJ/m**2'",
        ),
    ],
)
def test_bad_input_is_one_line(refused: Callable[..., str], arguments: list[str], words: str) -> None:
    assert words in refused("life", STUDY, *arguments)


def test_the_verb_saves_the_same(tmp_path: Path) -> None:
    changes = {"mesh.size": "14 mm", "mechanics.strain": "fem", "mechanics.motion": "linear"}
    life = tf.study(STUDY, changes).life(temperature=60.0)
    assert repr(life).startswith(f"Life of {STUDY}")
    assert life.save(tmp_path / "life", pictures=False, vtk=False) == tmp_path / "life"
    summary = json.loads((tmp_path / "life" / "summary.json").read_text(encoding="utf-8"))
    assert summary["shortest_km"] == life.shortest == life.places[0].km
