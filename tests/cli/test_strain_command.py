"""`tyrefem strain`: the three laws in one table that adds up, files that agree, and refusals in one line."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from pathlib import Path

import pytest
import tomli_w

import tyrefem as tf
from tyrefem.cli import main
from tyrefem.simulation.law_comparison import TOTAL, compared_laws

STUDY = "nasa-22x5.5-8pr"
BRIEF = ("--set", "mesh.size=10 mm", "--set", "drive.duration=120 s", "--set", "numerics.tolerance=0.1 delta_degC",
         "--set", "mechanics.motion=linear")  # fmt: skip


def test_numbers_files_and_picture(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["strain", STUDY, "--out", "out", "--json", *BRIEF]) == 0
    numbers = json.loads(capfd.readouterr().out)
    folder = here / "out"
    assert numbers == json.loads((folder / "strain.json").read_text(encoding="utf-8"))
    assert list(numbers["laws"]) == list(compared_laws())
    laws, parts = numbers["laws"], numbers["parts"]
    assert list(parts) == ["I", "II", "III", "IV", "V"]
    for law in laws.values():
        for energy in ("energy_J", "heating_energy_J"):
            assert law[energy][TOTAL] == pytest.approx(sum(law[energy][part] for part in parts), rel=1e-12)
        for part in parts:
            mean = law["energy_J"][part] / numbers["volume_m3"][part]
            assert law["mean_energy_J_m3"][part] == pytest.approx(mean, rel=1e-12)
        assert law["temperatures_degC"]["hottest"] >= max(
            value for name, value in law["temperatures_degC"].items() if name != "contained-air"
        )
        assert law["hottest"]["temperature_degC"] == law["temperatures_degC"]["hottest"]
        assert law["hottest"]["region"] in ("carcass", "tread", "sidewall", "bead")
    # One state of strain is its own largest change; harmonics lose more than one cycle of the same height.
    for law in ("arcs", "barrel"):
        assert laws[law]["heating_energy_J"] == laws[law]["energy_J"]
        assert laws[law]["deflection_m"] == numbers["load_law_deflection_m"]
    assert laws["fem"]["heating_energy_J"][TOTAL] > laws["fem"]["energy_J"][TOTAL]
    # Same tan delta and rolling radius: the drag is in proportion to U tan delta, tread and carcass most.
    for law in laws.values():
        share = law["cold_coefficient"] / sum(
            tangent * law["heating_energy_J"][part]
            for part, tangent in {"I": 0.10, "II": 0.20, "III": 0.10, "IV": 0.15, "V": 0.03}.items()
        )
        assert share * numbers["load_N"] * 2 * (0.2803398 - numbers["load_law_deflection_m"] / 3) == pytest.approx(
            1, rel=0.03
        )
    with (folder / "strain.csv").open(encoding="utf-8") as lines:
        rows = list(csv.DictReader(lines))
    table = {(row["kind"], row["name"]): row for row in rows}
    for law in compared_laws():
        assert float(table["energy", "II"][law]) == pytest.approx(laws[law]["energy_J"]["II"], rel=1e-9)
        assert float(table["temperature", "hottest"][law]) == pytest.approx(laws[law]["temperatures_degC"]["hottest"])
    assert (folder / "strain.png").read_bytes().startswith(b"\x89PNG")


def test_a_law_without_an_answer_is_said_and_the_others_stand(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """With a soft load law the barrel would have to press the crown on the rim: the footprint carries its load."""
    soft = "mechanics.load_law={law='vertical-stiffness', stiffness='110 N/mm', source='test'}"
    assert main(["strain", STUDY, "--law", "barrel", "--law", "fem", "--set", soft, *BRIEF]) == 0
    out, err = capfd.readouterr()
    assert "warning: the strain law 'barrel' has no solution: 1.201e+04 N at 572.3 kPa: a deflection of 109.2 mm" in err
    assert err.count("\n") == 1
    lines = out.splitlines()
    assert any(line.split()[:2] == ["│", "deflection,"] for line in lines)
    assert "barrel" not in out
    assert "II tread rubber" in out
    assert (here / "results" / f"{STUDY}-strain" / "strain.csv").is_file()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--law", "barel"], "--law: no strain law 'barel' to compare; did you mean 'barrel'?"),
        (["--law", "given"], "--law: no strain law 'given' to compare; allowed: arcs, barrel, fem"),
        (["--law", "barrel", "--set", "drive.load=12000 lbf", *BRIEF], "where the crown meets the rim"),
        (["--law", "arcs", "--set", "drive.load=0 N", *BRIEF], "drive.load: the tyre is never under load"),
    ],
)
def test_bad_input_is_one_line(refused: Callable[..., str], arguments: list[str], words: str) -> None:
    assert words in refused("strain", STUDY, *arguments)


def test_a_section_without_arcs_is_compared_by_its_own_regions(refused: Callable[..., str]) -> None:
    """No arcs to compare, and the only law asked for is theirs."""
    error = refused("strain", "passenger-205-55r16", "--law", "arcs")
    assert "the strain law 'arcs' needs" in error


def test_a_measured_table_of_the_study_is_never_replaced(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """The command does not read the table, but the study needs it."""
    table = here / "out" / "strain.csv"
    table.parent.mkdir()
    table.write_text("time [s],contained-air [degC]\n0,25\n", encoding="utf-8")
    card = {**tf.study(STUDY).data, "measured": [{"table": "out/strain.csv"}]}
    (here / "mine.toml").write_text(tomli_w.dumps(card), encoding="utf-8")
    assert main(["strain", "mine.toml", "--out", "out", "--force", *BRIEF]) == 2
    assert "strain.csv: is an input of this command" in capfd.readouterr().err
    assert table.read_text(encoding="utf-8").startswith("time")


def test_a_title_with_brackets_is_printed_as_it_is(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    quick = ["--set", "mesh.size=14 mm", "--set", "drive.duration=10 s", "--law", "barrel"]
    assert main(["strain", STUDY, *quick, "--set", "title=Tyre [v2] [/b] :car:"]) == 0
    assert capfd.readouterr().out.startswith("Tyre [v2] [/b] :car: ")
