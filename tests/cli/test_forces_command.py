"""`tyrefem forces`: files that agree, a `.tir` file that gives the forces back, refusals in one line."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from pathlib import Path

import pytest

import tyrefem as tf
from tyrefem.cli import main
from tyrefem.materials.cord_layers import masses
from tyrefem.tyre_forces.property_file import read_tir

STUDY = "nasa-22x5.5-8pr"
FEW = [
    "--loads",
    "8 kN, 12 kN",
    "--slip-angles",
    "0 deg, 1 deg, 4 deg, 8 deg",
    "--slips",
    "-20 %, -5 %, -2 %, 2 %, 5 %, 20 %",
]
COARSE = ["--set", "mesh.size=14 mm"]


def test_files_agree(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    line = ["forces", STUDY, *FEW, "--cambers", "none", "--friction", "0.8", "--out", "out", *COARSE]
    assert main([*line, "--json"]) == 0
    numbers = json.loads(capfd.readouterr().out)
    folder = here / "out"
    assert numbers == json.loads((folder / "forces.json").read_text(encoding="utf-8"))
    with (folder / "forces.csv").open(encoding="utf-8") as lines:
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(lines)]
    # Four angles and six slips at both loads.
    assert len(rows) == len(numbers["points"]) == 20
    formula = read_tir(folder / "tyre.tir")
    # The mass is that of a sweep; the coarse mesh of 14 mm has 0.4 % less.
    study = tf.study(STUDY)
    _, mass = (line for line in (folder / "tyre.tir").read_text().splitlines() if line.startswith("MASS "))
    stated = float(mass.split("=")[1].split("$")[0])
    assert stated == pytest.approx(sum(masses(study.section, study.materials).values()), rel=1e-5)
    largest = max(abs(row["F_y_N"]) for row in rows)
    for row in rows:
        if row["free"]:
            fitted = formula.lateral_force(row["F_z_N"], row["slip_angle_rad"])
            assert fitted == pytest.approx(row["F_y_N"], abs=0.05 * largest)
        else:
            fitted = formula.longitudinal_force(row["F_z_N"], row["slip"])
            assert fitted == pytest.approx(row["F_x_N"], abs=0.05 * largest)
    assert max(numbers["magic_formula"]["rms_over_largest"].values()) < 0.05
    assert (folder / "forces.png").read_bytes().startswith(b"\x89PNG")


def test_stiffnesses_are_at_one_of_the_loads_that_were_computed(here: Path) -> None:
    """The drive's load is 12 kN: a fit of lighter tyres tells nothing about it."""
    loads = ["--loads", "4 kN, 6 kN", *FEW[2:], "--cambers", "none"]
    assert main(["forces", STUDY, *loads, "--no-pictures", "--out", "out", *COARSE]) == 0
    assert read_tir(here / "out" / "tyre.tir").nominal_load == pytest.approx(5e3)


def test_camber_leans_the_forces(here: Path) -> None:
    line = [
        "forces",
        STUDY,
        *FEW[:2],
        "--slip-angles",
        "0 deg, 1 deg, 2 deg, 3 deg, 5 deg, 7 deg, 9 deg, 12 deg",
        "--slips",
        "none",
    ]
    assert main([*line, "--cambers", "4 deg", "--no-pictures", "--out", "out", *COARSE]) == 0
    with (here / "out" / "forces.csv").open(encoding="utf-8") as lines:
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(lines)]
    leaning = [row for row in rows if row["camber_rad"]]
    thrust = next(row for row in leaning if abs(row["slip_angle_rad"]) < 1e-9)
    # The wheel leans to its left, and is pushed there.
    assert thrust["F_y_N"] > 0
    assert {row["slip_angle_rad"] > 0 for row in leaning} == {True, False}


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--loads", "8 kN"], "--loads: give at least two different loads"),
        (["--loads", "8 kN, 8 kN"], "--loads: give at least two different loads"),
        (["--loads", "8 kN, -1 kN"], "--loads: must be more than 0 N"),
        (["--slip-angles", "1 deg, 2"], "--slip-angles: '2' has no unit"),
        (["--slip-angles", "60 deg"], "--slip-angles: a slip angle of 60 deg is impossible"),
        (["--slips", "-100 %"], "--slips: a slip of -1 is impossible"),
        (["--friction", "-0.5"], "--friction: must be at least 0.001, not -0.5"),
        (["--set", "drive.drum_diameter=1 mm"], "study.toml: drive.drum_diameter: a drum of 1 mm is too small"),
        (["--drum", "1 mm"], "tyrefem: --drum: a drum of 1 mm is too small"),
        (["--cambers", "80 deg"], "tyrefem: --cambers: must be between -34.4 and 34.4 deg, not 80 deg"),
        (["--friction", "0"], "--friction: must be at least 0.001, not 0: less holds no rolling tyre"),
        (["--speed", "1e6 m/s"], "--speed: must be at most 400 m/s"),
        (["--motion", "huge"], "--motion: no motion 'huge'"),
        (["--slips", "none", "--slip-angles", "none"], "--slip-angles: give at least one slip angle or one slip"),
    ],
)
def test_bad_input_is_one_line(refused: Callable[..., str], arguments: list[str], words: str) -> None:
    given = [] if "--loads" in arguments else ["--loads", "8 kN, 12 kN"]
    assert words in refused("forces", STUDY, *given, *arguments, *COARSE)


def test_camber_that_pushes_to_the_wrong_side_is_named(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """Linear motion of the measured tyre with its cards' moduli: +29 N at 2 kN, -156 N at 5 kN.

    With secant moduli, which take twice the time, +23 and -119 N; in large motion +69 and +174 N.
    """
    points = ["--loads", "2 kN, 5 kN", "--slip-angles", "0 deg, 4 deg", "--slips", "none", "--cambers", "3 deg"]
    line = ["forces", "measured-205-60r15", *points, "--set", "mechanics.moduli=card"]
    line += ["--no-pictures", "--out", "out", *COARSE]
    assert main(line) == 0
    words = "at 5000 N camber pushes the tyre away from the side to which it leans; linear motion is too stiff there"
    assert words in capfd.readouterr().err
    assert words in (here / "out" / "tyre.tir").read_text(encoding="utf-8")
