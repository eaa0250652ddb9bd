"""`tyrefem press`: numbers that balance, files that agree with each other, and refusals in one line."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tyrefem.cli import main

STUDY = "nasa-22x5.5-8pr"
COARSE = ["--set", "mesh.size=8 mm", "--set", "mechanics.motion=linear"]


def test_numbers_and_files(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """Load balances pressure; the curve has the footprint's point, its slope the tangent; JSON and file agree."""
    assert main(["press", STUDY, "--deflection", "15 mm", "--out", "out", "--json", *COARSE]) == 0
    numbers = json.loads(capfd.readouterr().out)
    folder = here / "out"
    assert numbers == json.loads((folder / "press.json").read_text(encoding="utf-8"))
    assert numbers["deflection_m"] == pytest.approx(0.015, rel=1e-12)
    assert numbers["secant_stiffness_N_m"] * 0.015 == pytest.approx(numbers["load_N"], rel=1e-12)
    mean = numbers["mean_contact_pressure_Pa"]
    assert mean * numbers["footprint_area_m2"] == pytest.approx(numbers["load_N"], rel=1e-12)
    assert mean < numbers["peak_contact_pressure_Pa"]
    # A tyre rolls further than its loaded radius says, and not so far as when free.
    assert numbers["loaded_radius_m"] < numbers["rolling_radius_m"] < numbers["loaded_radius_m"] + 0.015
    assert numbers["rolling_resistance_N"] == pytest.approx(
        numbers["loss_per_revolution_J"] / (2 * np.pi * numbers["rolling_radius_m"]), rel=1e-12
    )
    assert numbers["error"] <= numbers["tolerance"]
    assert {"tyrefem", "numpy", "scikit-fem"} <= set(numbers["versions"])
    *columns, harmonics = np.loadtxt(folder / "load-deflection.csv", delimiter=",", skiprows=1).T
    curve = np.column_stack(columns)
    assert (np.diff(curve, axis=0) > 0).all()
    assert (harmonics == numbers["harmonics"]).all()
    # The tread touches more as it goes down: the curve stiffens and holds the footprint's own point.
    assert (np.diff(curve[:, 1], 2) > 0).all()
    assert np.interp(0.015, *curve.T) == pytest.approx(numbers["load_N"], rel=0.01)
    slope = np.gradient(curve[:, 1], curve[:, 0])
    assert np.interp(0.015, curve[:, 0], slope) == pytest.approx(numbers["tangent_stiffness_N_m"], rel=0.1)
    for name in ("section.png", "pressure.png", "load-deflection.png"):
        assert (folder / name).read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--pressure", "83"], "--pressure: '83' has no unit"),
        (["--pressure", "0 psi"], "--pressure: '0 psi' is out of range: must be more than 0 Pa"),
        (["--load", "1 kN", "--deflection", "9 mm"], "--load: give a load or a deflection, not both"),
        (["--drum", "-1 m"], "--drum: '-1 m' is out of range"),
        (["--set", "drive.load=0 N"], "drive.load: must be more than 0 N, not 0 N"),
        (["--set", "drive.pressure=0 psi"], "drive.pressure: must be more than 0 Pa"),
        (["--motion", "larg"], "--motion: no motion 'larg'; did you mean 'large'"),
        (["--motion", "linear", "--balanced"], "--motion: 'linear' contradicts --balanced, which is --motion large"),
    ],
)
def test_bad_input_is_one_line(refused: Callable[..., str], arguments: list[str], words: str) -> None:
    assert words in refused("press", STUDY, *arguments)


def test_a_deflection_beyond_the_rim_names_the_option(refused: Callable[..., str]) -> None:
    error = refused("press", STUDY, "--deflection", "200 mm", *COARSE)
    assert "--deflection: a deflection of 200 mm is impossible" in error
    assert "where the crown meets the rim" in error


def test_in_large_motion_the_tyre_is_softer_and_the_curve_is_its_way(
    here: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    coarse = ["--set", "mesh.size=12 mm", "--deflection", "20 mm", "--no-pictures", "--no-vtk"]
    assert main(["press", STUDY, "--motion", "large", "--json", "--out", "large", *coarse]) == 0
    large = json.loads(capfd.readouterr().out)
    assert main(["press", STUDY, "--motion", "linear", "--json", "--out", "linear", *coarse]) == 0
    linear = json.loads(capfd.readouterr().out)
    assert (large["motion"], large["balanced"]) == ("large", True)
    assert (linear["motion"], linear["balanced"]) == ("linear", False)
    assert 0.1 < linear["left_out_by_linear_strains"]["mean"] < linear["left_out_by_linear_strains"]["greatest"]
    # TR R-64 gives 7595 N.
    assert large["load_N"] == pytest.approx(7595.0, rel=0.1)
    assert large["load_N"] < 0.8 * linear["load_N"]
    assert large["rolling_resistance_N"] < linear["rolling_resistance_N"]
    table = here / "large" / "load-deflection.csv"
    assert table.read_text(encoding="utf-8").startswith("deflection_m,load_N,harmonics\n")
    *columns, harmonics = np.loadtxt(table, delimiter=",", skiprows=1).T
    curve = np.column_stack(columns)
    assert (np.diff(curve, axis=0) > 0).all()
    # Load steps have fewer harmonics than the footprint, and a higher load.
    assert (harmonics[:-1] < harmonics[-1]).all()
    assert harmonics[-1] == large["harmonics"]
    assert curve[-1] == pytest.approx([0.02, large["load_N"]], rel=1e-6)
    cords = (here / "large" / "cord-tension.csv").read_text(encoding="utf-8").splitlines()[1:]
    carried = [float(row.rsplit(",", 1)[1]) for row in cords if row.startswith("carcass")]
    # Slack cords carry no more compression than half their rubber's shear modulus.
    assert min(carried) > -1.2e6
