"""`tyrefem road`, and the warning of `tyrefem run` where one contact reaches far into the tread."""

from __future__ import annotations

import json

import pytest

from tyrefem.boundaries.road_film import propagation_depth
from tyrefem.cli import main

PNG = b"\x89PNG"


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_table(capfd):
    assert main(["road", "table"]) == 0
    assert "largest deviation of 80 values in table 2: 0.005 W/m2/K" in capfd.readouterr().out


def test_film(capfd):
    assert main(["road", "film", "--speed", "50 km/h", "--footprint", "0.14 m"]) == 0
    lines = capfd.readouterr().out.splitlines()
    films = [(line.split()[0], float(line.split()[1])) for line in lines]
    assert films[0] == ("cattani", 7043.0)  # table 2 prints 7042.95
    assert films[1] == ("constant", 10460.0)
    assert films[2][1] < films[3][1] == pytest.approx(7042.95 * 1.12838, abs=0.06)
    depth = propagation_depth(0.14 * 3.6 / 50, 0.25, 2e6) * 1e3
    assert lines[-1].endswith(f"penetrates {depth:.4g} mm into the tread")


def test_averaging_and_figures(capfd, here):
    assert main(["road", "averaging", "--out", "a/averaging.png"]) == 0
    assert "footprint 140 mm: averaging holds to 1 K from 15 km/h" in capfd.readouterr().out
    assert main(["road", "figures", "--out", "pictures"]) == 0
    for name in ("a/averaging.png", "pictures/figure-4.png", "pictures/figure-5.png"):
        assert (here / name).read_bytes().startswith(PNG)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["film", "--speed", "50", "--footprint", "0.14 m"], "--speed: '50' has no unit"),
        (["film", "--speed", "50 km/h", "--footprint", "0 m"], "--footprint: '0 m' is out of range"),
        (
            ["film", "--speed", "1 m/s", "--footprint", "1 m", "--road-conductivity", "1 m"],
            "tyrefem: --road-conductivity: 'm' is not a unit of this quantity",
        ),
        (["averaging", "--inside", "warm"], "--inside: 'warm' is not a quantity"),
        (["tabel"], "No such command 'tabel'"),
    ],
)
def test_bad_input_is_one_line(capfd, arguments, words):
    assert main(["road", *arguments]) == 2
    out, err = capfd.readouterr()
    assert out == ""
    assert err.startswith("tyrefem: ")
    assert words in err
    assert err.count("\n") == 1


def test_run_warns_where_a_contact_is_deep(capfd, here):
    """At 5 mm/s a contact lasts over half a minute and reaches millimetres; at the study's 20 mph a tenth of one."""
    bare = ["--no-vtk", "--no-pictures", "--out", "out", "--set", "drive.duration=10 s"]
    bare += ["--set", "mesh.size=4 mm", "--set", "mesh.element=P1"]
    summaries = {}
    for speed in ("5 mm/s", "20 mph"):
        assert main(["run", "nasa-22x5.5-8pr", *bare, "--set", f"drive.speed={speed}"]) == 0
        err = capfd.readouterr().err
        summary = json.loads((here / "out" / "summary.json").read_text(encoding="utf-8"))
        assert err == "".join(f"tyrefem: warning: {warning}\n" for warning in summary["warnings"])
        summaries[speed] = summary
    assert len(summaries["5 mm/s"]["warnings"]) == 1
    assert "of its thickness at the crown" in summaries["5 mm/s"]["warnings"][0]
    assert summaries["20 mph"]["warnings"] == []
    assert summaries["20 mph"]["phases"][0]["propagation_depth"] < 2e-4
