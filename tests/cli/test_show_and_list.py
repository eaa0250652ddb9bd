"""`tyrefem list`, `tyrefem show`, `tyrefem compare`."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest
from terminal import NASA

import tyrefem as tf
from tyrefem import library
from tyrefem.cli import main
from tyrefem.effects import catalogue
from tyrefem.reports.inputs import boundary_rows

PNG = b"\x89PNG\r\n\x1a\n"


@pytest.mark.parametrize("kind", ["sections", "materials", "studies"])
def test_list_gives_every_name_and_title(kind: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list", kind]) == 0
    lines = capsys.readouterr().out.splitlines()
    known = library.names({"sections": "section", "materials": "material", "studies": "study"}[kind])
    assert [line.split()[0] for line in lines] == sorted(known)
    assert all(len(line.split()) > 2 for line in lines)
    # Titles stand in one column, also beside long names.
    titles = {line.index(line.split(maxsplit=1)[1]) for line in lines}
    assert len(titles) == 1


def test_no_marks_of_docstrings_are_printed(capsys: pytest.CaptureFixture[str]) -> None:
    for words in (["list", "laws"], ["list", "effects"], ["show", "effect", "swapped-channels"]):
        assert main(words) == 0
        assert "``" not in capsys.readouterr().out
    films = [["0 m/s", "5 W/m**2/K"], ["9 m/s", "20 W/m**2/K"]]
    outside = tf.study("nasa-22x5.5-8pr", {"boundaries.outside_air": {"law": "table", "table": films}})
    assert "Rows [speed, film]; linear" in str(boundary_rows(outside))


def test_list_goes_on_past_a_broken_card(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (here / "materials").mkdir()
    (here / "materials/broken.toml").write_text("=", encoding="utf-8")
    assert main(["list", "materials"]) == 0
    out = capsys.readouterr().out
    assert "(cannot be read: not valid TOML" in out
    assert "nasa-tread" in out


def test_list_laws(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list", "laws"]) == 0
    assert {line.split()[0] for line in capsys.readouterr().out.splitlines()} == {
        "road", "outside_air", "contained_air", "rim", "sliding",
    }  # fmt: skip


def test_list_effects(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list", "effects"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert sorted(line.split()[0] for line in lines) == sorted(catalogue())
    assert all(line.endswith(".") for line in lines)


def test_show_effect_says_bounds_units_prior_and_source(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", "effect", "ambient-drift"]) == 0
    out = capsys.readouterr().out
    for words in (
        "boundary",
        "source: estimate",
        "-40 delta_degC/hour to 40 delta_degC/hour",
        "prior sd",
        "[[effects]]",
    ):
        assert words in out


def test_show_of_an_unknown_effect(refused: Callable[..., str]) -> None:
    assert "no effect named 'wet_road'; did you mean 'wet-road'?" in refused("show", "effect", "wet_road")


def test_an_effect_takes_no_changes(refused: Callable[..., str]) -> None:
    assert "--set: changes a card" in refused("show", "effect", "wet-road", "--set", "drive.speed=25 mph")


@pytest.mark.parametrize("value", [5000 * "9", 5000 * "["], ids=["digits", "brackets"])
def test_a_change_or_card_that_no_reader_takes_is_one_line(value: str, here: Path, refused: Callable[..., str]) -> None:
    assert "drive.speed: " in refused("show", "study", NASA, "--set", f"drive.speed={value}")
    (here / "card.toml").write_text(f"title = {value}", encoding="utf-8")
    assert "card.toml: not valid TOML: a number is too long, or" in refused("check", "card.toml")


def test_a_change_is_one_value(refused: Callable[..., str]) -> None:
    assert "drive.duration: " in refused("show", "study", NASA, "--set", "drive.duration='5 s'\nspeed='1 m/s'")


def test_list_of_an_unknown_kind(refused: Callable[..., str]) -> None:
    assert "did you mean 'studies'?" in refused("list", "study")


@pytest.mark.parametrize("kind", ["section", "mesh", "strain"])
def test_show_draws(kind: str, here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["show", kind, NASA, "--out", "seen.png"]) == 0
    assert (here / "seen.png").read_bytes().startswith(PNG)
    out, err = capfd.readouterr()
    assert "drawn in seen.png" in out
    assert err == ""


def test_capital_letters_of_an_ending_are_no_matter(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["new", "study", "mine", "--out", "MINE.TOML"]) == 0
    coarse = ("--set", "mesh.size=12 mm")
    assert main(["check", "MINE.TOML"]) == 0
    assert main(["show", "mesh", "MINE.TOML", *coarse]) == 0
    assert (here / "mesh-MINE.png").is_file()
    for mesh in ("M.MSH", "M.VTK", "M.VTU"):
        assert main(["show", "mesh", "MINE.TOML", *coarse, "--out", mesh]) == 0
        assert main(["show", "mesh", "MINE.TOML", "--set", f"mesh.file={mesh}", "--out", "again.png"]) == 0
    speeds = ["--vary", "drive.speed=10 mph,20 mph", "--set", "drive.duration=10 s", "--workers", "1", "--no-pictures"]
    assert main(["sweep", "MINE.TOML", *coarse, *speeds, "--reduced", "never"]) == 0
    assert main(["new", "study", "205/60R15", "--out", "SIZE.TOML"]) == 0
    assert (here / "SIZE.TOML").is_file()


def test_show_says_yes_and_no(capsys: pytest.CaptureFixture[str], here: Path) -> None:
    assert main(["show", "section", NASA, "--out", "a.png"]) == 0
    assert re.search(r"^half +yes$", capsys.readouterr().out, re.MULTILINE)


def test_show_section_takes_changes(capsys: pytest.CaptureFixture[str]) -> None:
    volumes = []
    for value in ("3.0 in", "3.4 in"):
        assert main(["show", "section", NASA, "--set", f"crown_radius={value}", "--out", "a.png"]) == 0
        lines = dict(line.split(None, 1) for line in capsys.readouterr().out.splitlines())
        volumes.append(float(lines["gas_volume_m3"]))
    assert volumes[0] != pytest.approx(volumes[1], rel=1e-3)


def test_show_prints_toml_that_can_be_used(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", "study", NASA, "--set", "drive.speed=25 mph"]) == 0
    text = capsys.readouterr().out
    assert tomllib.loads(text)["drive"]["speed"] == "25 mph"
    (here / "shown.toml").write_text(text, encoding="utf-8")
    assert tf.study("shown.toml").data == tf.study(NASA, {"drive.speed": "25 mph"}).data
    assert main(["show", "material", "nasa-tread"]) == 0
    assert "loss_tangent" in tomllib.loads(capsys.readouterr().out)


def test_show_refuses(refused: Callable[..., str]) -> None:
    assert "did you mean 'mesh'?" in refused("show", "mehs", NASA)
    assert "no material named 'x'" in refused("show", "material", "x")
    assert "is out of range" in refused("show", "material", "nasa-tread", "--set", "density.value=-1 kg/m**3")
    assert refused("show", "section", NASA, "--set", "crown_radius=1 mm")


def test_compare_says_json_and_nothing_else(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["compare", "example-validation", "--no-inputs", "--json", "--set", "mesh.size=8 mm"]) == 0
    out, err = capfd.readouterr()
    assert err == "tyrefem: 3 simulations: 3 drives as driven\n"
    record = json.loads(out)
    table = here / "results/example-validation-compare"
    assert (table / "comparison.html").is_file()
    assert record["summary"]


def test_compare_refuses_a_table_of_other_sensors(here: Path, refused: Callable[..., str]) -> None:
    (here / "mine.csv").write_text("time [s],crowm-inner [degC]\n0,25\n10,26\n", encoding="utf-8")
    assert "did you mean 'crown-inner'?" in refused("compare", NASA, "mine.csv")
    assert "nowhere.csv" in refused("compare", NASA, "nowhere.csv")


def test_a_narrow_terminal_cuts_no_number(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "40")
    assert main(["show", "strain", "nasa-22x5.5-8pr", "--set", "mesh.size=12 mm"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert not any("…" in line for line in lines)
    (whole,) = (line for line in lines if line.startswith("whole tyre"))
    assert whole.split()[-1] == "100.0"
