"""`tyrefem roll`: files that agree with each other, curves, and refusals in one line."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from pathlib import Path

import pytest

from tyrefem.cli import main
from tyrefem.cli.roll import _values

STUDY = "nasa-22x5.5-8pr"
COARSE = ["--set", "mesh.size=12 mm"]


def test_files_agree(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    line = ["roll", STUDY, "--slip-angle", "2 deg", "--camber", "1 deg", "--slip", "1 %", "--out", "out", *COARSE]
    assert main([*line, "--json"]) == 0
    numbers = json.loads(capfd.readouterr().out)
    folder = here / "out"
    assert numbers == json.loads((folder / "roll.json").read_text(encoding="utf-8"))
    assert numbers["F_y_N"] < 0 < numbers["F_x_N"]
    assert numbers["slip"] == pytest.approx(0.01, abs=1e-9)
    assert numbers["rolling_resistance_coefficient"] == numbers["rolling_resistance_N"] / numbers["F_z_N"]
    assert numbers["mean_contact_pressure_Pa"] * numbers["footprint_area_m2"] == pytest.approx(numbers["F_z_N"])
    assert numbers["footprint_area_m2"] < numbers["footprint_length_m"] * numbers["footprint_width_m"]
    with (folder / "rings.csv").open(encoding="utf-8") as lines:
        power = [float(ring["friction_power_W"]) for ring in csv.DictReader(lines)]
    assert sum(power) == pytest.approx(numbers["friction_power_W"], rel=1e-6)
    with (folder / "contact.csv").open(encoding="utf-8") as lines:
        points = list(csv.DictReader(lines))
    assert {point["state"] for point in points} == {"0", "1", "2"}
    # Points that open in a step have friction power in it, but no sliding: only the column sums up to the balance.
    by_point = [float(point["friction_power_W"]) for point in points]
    assert sum(by_point) == pytest.approx(numbers["friction_power_W"], rel=1e-6)
    assert sum(by_point) == pytest.approx(numbers["axle_power_W"], rel=1e-2)
    assert numbers["peak_contact_pressure_Pa"] == pytest.approx(max(float(p["pressure_Pa"]) for p in points))
    for name in ("contact.png", "rings.png"):
        assert (folder / name).read_bytes().startswith(b"\x89PNG")
    import meshio

    surface = meshio.read(folder / "contact.vtu")
    assert len(surface.points) == len(points)
    assert surface.point_data["pressure_Pa"].max() == pytest.approx(max(float(p["pressure_Pa"]) for p in points))
    assert surface.point_data["friction_power_W"].sum() == pytest.approx(sum(by_point), rel=1e-6)


def test_a_curve(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    line = ["roll", STUDY, "--slip-angle", "0 deg:12 deg:3", "--friction", "0.6", "--out", "out", *COARSE]
    assert main(line) == 0
    assert "cornering stiffness" in capfd.readouterr().out
    numbers = json.loads((here / "out" / "roll.json").read_text(encoding="utf-8"))
    with (here / "out" / "curve.csv").open(encoding="utf-8") as lines:
        rows = list(csv.DictReader(lines))
    forces = [float(row["F_y_N"]) for row in rows]
    assert abs(forces[0]) < 1.0
    assert forces[1] < 0
    assert numbers["cornering_stiffness_N_rad"] > -forces[1] / float(rows[1]["slip_angle_rad"])
    # A tyre is softer than its tread alone, and stiffer forward than sideways.
    assert numbers["standing_longitudinal_stiffness_N_m"] > numbers["standing_lateral_stiffness_N_m"] > 1e4
    # A contact that sticks with the moduli of the revolution rises slower than with those of a small push.
    slope = numbers["cornering_stiffness_N_rad"]
    assert numbers["relaxation_length_m"] >= slope / numbers["standing_lateral_stiffness_N_m"] > 0.05
    assert numbers["relaxation_length_m"] > numbers["longitudinal_relaxation_length_m"] > 0
    assert 0.95 < -forces[2] / (0.6 * float(rows[2]["F_z_N"])) <= 1.0
    assert (here / "out" / "curve.png").read_bytes().startswith(b"\x89PNG")


def test_the_middle_of_an_even_range_is_zero() -> None:
    assert _values("slip_angle", "-6 deg:6 deg:7")[3] == 0.0


def test_friction_on_the_footprint_in_large_motion(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    line = ["roll", STUDY, "--slip-angle", "2 deg", "--load", "6 kN", "--no-pictures", "--no-vtk", "--json", *COARSE]
    assert main([*line, "--out", "linear"]) == 0
    linear = json.loads(capfd.readouterr().out)
    assert main([*line, "--motion", "large", "--out", "large"]) == 0
    large = json.loads(capfd.readouterr().out)
    assert (linear["motion"], large["motion"]) == ("linear", "large")
    assert large["F_z_N"] == pytest.approx(6000.0, rel=1e-6)
    assert large["deflection_m"] > 1.03 * linear["deflection_m"]
    assert large["F_y_N"] < 0 < large["M_z_Nm"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--slip-angle", "2"], "--slip-angle: '2' has no unit"),
        (["--slip-angle", "60 deg"], "--slip-angle: a slip angle of 60 deg is impossible"),
        (["--slip-angle", "1 deg:2 deg"], "--slip-angle: '1 deg:2 deg' is not from:to:number"),
        (["--slip-angle", "1 deg:2 deg:²"], "--slip-angle: '1 deg:2 deg:²' is not from:to:number"),
        (["--slip-angle", f"1 deg:2 deg:{5000 * '9'}"], "is not from:to:number"),
        (["--slip", "-100 %"], "--slip: a slip of -1 is impossible"),
        (["--slip", "1 %", "--torque", "10 N m"], "give at most one of slip, torque and axle force"),
        (["--friction", "-0.5"], "--friction: must be at least 0.001, not -0.5"),
        (["--set", "drive.load=0 N"], "study.toml: drive.load: must be more than 0 N"),
        (["--friction", "0"], "--friction: must be at least 0.001, not 0: less holds no rolling tyre"),
        (["--speed", "1e6 m/s"], "--speed: must be at most 400 m/s"),
        (["--turn-slip", "5 1/m"], "--turn-slip: a path with a radius of 0.2 m is too tight"),
        (["--motion", "huge"], "--motion: no motion 'huge'"),
        (["--axle-force", "100 kN"], "--axle-force: friction 1 under"),
    ],
)
def test_bad_input_is_one_line(refused: Callable[..., str], arguments: list[str], words: str) -> None:
    assert words in refused("roll", STUDY, *arguments, *COARSE)


def test_camber_that_pushes_to_the_wrong_side_is_a_warning(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """Also where a slip angle hides it."""
    coarse = {"mesh.size": "12 mm", "mechanics.moduli": "card", "drive.load": "5000 N"}
    sets = [word for key, value in coarse.items() for word in ("--set", f"{key}={value}")]
    line = ["roll", "measured-205-60r15", "--camber", "3 deg", "--slip-angle", "2 deg", "--no-pictures", "--no-vtk"]
    assert main([*line, "--out", "out", *sets]) == 0
    words = "at 5000 N camber pushes the tyre away from the side to which it leans; linear motion is too stiff there"
    assert words in capfd.readouterr().err
