"""`tyrefem modes`: files that agree with each other, a picture, and refusals in one line."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from pathlib import Path

import pytest

from tyrefem.cli import main

STUDY = "nasa-22x5.5-8pr"
COARSE = ["--set", "mesh.size=12 mm"]


def test_files_and_picture(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    line = ["modes", STUDY, "--highest", "2", "--count", "3", "--out", "out", *COARSE]
    assert main([*line, "--json"]) == 0
    numbers = json.loads(capfd.readouterr().out)
    folder = here / "out"
    assert numbers == json.loads((folder / "modes.json").read_text(encoding="utf-8"))
    assert [mode["harmonic"] for mode in numbers["modes"]] == [0, 0, 0, 1, 1, 1, 2, 2, 2]
    with (folder / "modes.csv").open(encoding="utf-8") as lines:
        rows = list(csv.DictReader(lines))
    assert [float(row["frequency_Hz"]) for row in rows] == [mode["frequency_Hz"] for mode in numbers["modes"]]
    for mode in numbers["modes"]:
        assert mode["radial"] + mode["lateral"] + mode["circumferential"] == pytest.approx(1, rel=1e-9)
    assert (folder / "modes.png").read_bytes().startswith(b"\x89PNG")


def test_words_and_pressure(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    frequencies = []
    for pressure in ("50 psi", "100 psi"):
        line = ["modes", STUDY, "--highest", "0", "--no-pictures", "--pressure", pressure, "--out", "out", *COARSE]
        assert main(line) == 0
        (lateral,) = [row for row in capfd.readouterr().out.splitlines() if " lateral " in row and " Hz " not in row]
        frequencies.append(float(lateral.split()[1]))
    assert frequencies[1] > 1.05 * frequencies[0]
    assert not (here / "out" / "modes.png").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--pressure", "2.2"], "--pressure: '2.2' has no unit"),
        (["--pressure", "0 bar"], "--pressure: '0 bar' is out of range: must be more than 0 Pa"),
        (["--set", "drive.pressure=0 bar"], "drive.pressure: must be more than 0 Pa"),
        (["--speed", "1e9 m/s"], "--speed: '1e9 m/s' is out of range: must be at most 400 m/s"),
        (["--speed", "390 m/s", "--set", "mesh.size=15 mm"], "an element at 'contained_air' is distorted"),
        (["--pressure", "500 MPa", "--set", "mesh.size=15 mm"], "tyrefem: --pressure: no equilibrium beyond"),
        (["--amplitude", "0 %"], "--amplitude: '0 %' is out of range: must be more than 0"),
        (["--amplitude", "2 mm"], "--amplitude: 'mm' is not a unit of this quantity"),
    ],
)
def test_bad_input_is_one_line(refused: Callable[..., str], arguments: list[str], words: str) -> None:
    assert words in refused("modes", STUDY, *arguments)


def test_it_says_how_much_stiffer_small_vibrations_are(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    table = (
        "{base = 'nasa-sidewall', strain_dependence = {small_strain_modulus = '2 MPa', critical_strain = '2 %', "
        "large_strain_modulus = '0.7 MPa', greatest_loss_modulus = '0.17 MPa', source = 'test'}}"
    )
    line = ["modes", STUDY, "--highest", "0", "--no-pictures", "--out", "out", *COARSE]
    assert main(line) == 0
    assert "moduli as in the cards: none gives a strain dependence" in capfd.readouterr().out
    assert main([*line, "--force", "--amplitude", "2 %", "--set", f"materials.sidewall={table}"]) == 0
    # G'(2 %) = 1.35 MPa, G'(10 %) = 0.7 + 1.3/(1 + 5^1.2) = 0.8646 MPa.
    assert "moduli at the strain amplitude 2 %, over those of the cards: sidewall 1.56" in capfd.readouterr().out


def test_a_rotating_tyre_has_forward_and_backward_waves(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    line = ["modes", STUDY, "--highest", "2", "--speed", "100 km/h", "--out", "out", *COARSE]
    assert main(line) == 0
    words = capfd.readouterr().out
    assert "frequencies in the rubber's frame" in words
    assert " forward " in words
    with (here / "out" / "modes.csv").open(encoding="utf-8") as lines:
        rows = list(csv.DictReader(lines))
    assert {row["direction"] for row in rows} == {"standing", "forward", "backward"}
    assert all(float(row["axle_frequency_Hz"]) > 0 for row in rows)
    assert (here / "out" / "modes.png").read_bytes().startswith(b"\x89PNG")
