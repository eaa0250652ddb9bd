"""What is perhaps not meant is said wherever a study, section or material is read, and does not stop anything."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from terminal import BARE, NASA, SHORT

from tyrefem import library
from tyrefem.cli import main
from tyrefem.schemas.line import without_line

LIGHT = ("--set", "materials.tread.density.value=1.18 kg/m**3")
WORDS = "materials.tread.density.value: 1.18 kg/m3 is unlikely"
RADIAL = "passenger-205-55r16"


def lines(capfd: pytest.CaptureFixture[str]) -> list[str]:
    err = capfd.readouterr().err.splitlines()
    assert all(line.startswith("tyrefem: warning: ") for line in err)
    return err


def test_run_says_it_once_and_writes_it_down(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["run", NASA, *SHORT, *LIGHT, "--no-vtk", "--out", "out"]) == 0
    (line,) = lines(capfd)
    assert WORDS in line
    (written,) = json.loads((here / "out/summary.json").read_text(encoding="utf-8"))["warnings"]
    assert WORDS in written
    assert f"Warning: {written}" in (here / "out/report.html").read_text(encoding="utf-8")


def test_run_with_nothing_unlikely_says_nothing(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["run", NASA, *SHORT, *BARE, "--out", "out"]) == 0
    assert lines(capfd) == []


@pytest.mark.parametrize("kind", ["study", "mesh", "strain"])
def test_show_of_a_study(kind: str, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["show", kind, NASA, *LIGHT, "--set", "mesh.size=8 mm"]) == 0
    (line,) = lines(capfd)
    assert WORDS in line


def test_show_of_a_section_and_a_material(capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["show", "section", RADIAL, "--set", "outer_diameter=800 mm"]) == 0
    assert "rating.diameter: the rated diameter is 631.9 mm" in lines(capfd)[0]
    assert main(["show", "material", "nasa-tread", "--set", "density.value=1.18 kg/m**3"]) == 0
    assert "nasa-tread.toml: density.value: 1.18 kg/m3" in lines(capfd)[0]


def written(here: Path, kind: str, name: str, old: str, new: str) -> str:
    """A card of the library with a text replaced, in the current folder."""
    text = library.find(kind, name).read_text(encoding="utf-8")
    assert old in text
    (here / "mine.toml").write_text(text.replace(old, new), encoding="utf-8")
    return "mine.toml"


def test_check_of_every_kind(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    film = 'law = "constant", coefficient = "2e4 W/m**2/K"'
    for kind, name, old, new, words in (
        ("material", "rubber-tread-passenger", "1180 kg/m**3", "1.18 kg/m**3", "mine.toml: density.value: 1.18"),
        ("section", RADIAL, "values = [0.0, 195.888] }", "values = [0.0, 300.0] }", "layers.0.s: the table of 'liner'"),
        ("study", NASA, 'law = "nasa"', film, "outside_air.coefficient: 2e+04"),
        ("study", "nasa-campaign", 'law = "nasa"', film, "outside_air.coefficient: 2e+04"),
    ):
        file = written(here, kind, name, old, new)
        if name == "nasa-campaign":
            source = library.find(kind, name).parent / "cases.csv"
            (here / "cases.csv").write_bytes(source.read_bytes())
        assert main(["check", file]) == 0
        out = capfd.readouterr()
        assert "mine.toml: a " in out.out
        assert words in out.err
        assert out.err.count(words) == 1


class TestAnotherTyre:
    """A copy of a study keeps the old tyre's load law and ranges: it says whose they are, and warns with another."""

    @pytest.fixture
    def copied(self, here: Path, capfd: pytest.CaptureFixture[str]) -> Path:
        assert main(["new", "study", "mine", "--from", RADIAL]) == 0
        out = capfd.readouterr().out
        assert f"note: for section '{RADIAL}' only (made_for): mechanics.load_law" in out
        assert main(["new", "section", "wider", "--from", RADIAL]) == 0
        assert f"note: for {RADIAL} only: rating" in capfd.readouterr().out
        assert (
            (here / "geometry/wider.toml").read_text(encoding="utf-8").startswith(f"# A copy of {RADIAL}; for {RADIAL}")
        )
        return here / "studies/mine/study.toml"

    def test_the_copy_as_it_is(self, copied: Path, capfd: pytest.CaptureFixture[str]) -> None:
        assert main(["check", str(copied)]) == 0
        assert lines(capfd) == []

    def test_with_another_section(self, copied: Path, capfd: pytest.CaptureFixture[str]) -> None:
        text = copied.read_text(encoding="utf-8")
        copied.write_text(text.replace(f'section = "{RADIAL}"', 'section = "wider"'), encoding="utf-8")
        assert main(["check", str(copied)]) == 0
        (line,) = lines(capfd)
        assert "made_for: mechanics.load_law, mechanics.footprint, mechanics.energy, published: these are for" in line
        assert main(["show", "study", RADIAL, "--set", "section=wider"]) == 0
        assert len(lines(capfd)) == 1

    def test_a_source_that_does_not_say_whose_they_are(self, copied: Path, capfd: pytest.CaptureFixture[str]) -> None:
        text = copied.read_text(encoding="utf-8")
        kept = [line for line in text.splitlines() if not line.startswith("made_for")]
        copied.write_text("\n".join(kept), encoding="utf-8")
        assert main(["new", "study", "second", "--from", "mine"]) == 0
        second = copied.parents[1] / "second/study.toml"
        assert second.read_text(encoding="utf-8").startswith(f'made_for = "{RADIAL}"')
        assert main(["check", str(second)]) == 0

    def test_a_study_without_such_numbers_is_copied_as_it_is(self, here: Path) -> None:
        assert main(["new", "study", "bias", "--from", NASA]) == 0
        shipped = library.find("study", NASA).read_text(encoding="utf-8")
        # But for the line that names the schema, which is not there.
        assert (here / "studies/bias/study.toml").read_text(encoding="utf-8") == without_line(shipped)


def test_energies_of_places_that_their_region_does_not_have(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    rows = 'apex = [["156 mm", "18 kJ/m**3"]'
    file = written(
        here, "study", RADIAL, rows, 'apex = [["20 mm", "9 kJ/m**3"], ["60 mm", "9 kJ/m**3"], ["155 mm", "18 kJ/m**3"]'
    )
    assert main(["check", file]) == 0
    (line,) = lines(capfd)
    assert "mechanics.energy.regions.apex: rows at 20, 60 mm have no effect: it runs from 155." in line


def test_a_sweep_warns_of_a_factor_as_a_single_run_does(capfd: pytest.CaptureFixture[str], here: Path) -> None:
    """The study itself has no factor; both ends of the range have one that acts on half of the plies' area."""
    (here / "sweep.toml").write_text(
        f'study = "{RADIAL}"\n[vary]\n"section.thickness_scale.body-ply" = {{ from = 0.8, to = 1.2 }}\n',
        encoding="utf-8",
    )
    for words in (["check", "sweep.toml"], ["show", "sweep", "sweep.toml"]):
        assert main(words) == 0
        (line,) = lines(capfd)
        assert "section.parameters.thickness_scale.body-ply: 0.8 changes the area of 'body-ply' by -10 %" in line


def test_a_sweep_warns_of_the_values_of_its_table_of_cases(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """Each field once, by the first variant that has a warning of it; values that the study has itself are known."""
    (here / "cases.csv").write_text(
        "name,section.thickness_scale.body-ply,materials.tread.density.value\n"
        "thin,0.8,1130 kg/m**3\nlight,1.0,1.13 kg/m**3\nlighter,1.0,1.12 kg/m**3\n",
        encoding="utf-8",
    )
    (here / "sweep.toml").write_text(f'study = "{RADIAL}"\nsample = "list"\ncases = "cases.csv"\n', encoding="utf-8")
    assert main(["check", "sweep.toml"]) == 0
    factor, density = lines(capfd)
    assert "section.parameters.thickness_scale.body-ply: 0.8 changes the area of 'body-ply' by -10 %" in factor
    assert "materials.tread.density.value: 1.13" in density
    # The command says the same before it computes.
    (here / "out").write_text("", encoding="utf-8")
    assert main(["sweep", RADIAL, "--cases", "cases.csv", "--out", "out"]) == 2
    assert capfd.readouterr().err.splitlines()[:2] == [factor, density]


def test_check_of_a_campaign_warns_of_its_cases_as_of_a_study(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """Also of an effect beside a strain law that presses the tyre itself."""
    text = library.find("study", NASA).read_text(encoding="utf-8")
    effect = '[[effects]]\nname = "pressure-rise"\nrise = 0.1\n'
    (here / "study.toml").write_text(f'cases = "cases.csv"\n{without_line(text)}\n{effect}', encoding="utf-8")
    (here / "cases.csv").write_text("name,mechanics.strain\npressed,fem\n", encoding="utf-8")
    assert main(["check", "study.toml"]) == 0
    (line,) = lines(capfd)
    assert "effects.pressure-rise: " in line
    assert line.endswith("the strain law is 'fem'")
