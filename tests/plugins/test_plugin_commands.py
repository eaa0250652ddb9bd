"""`tyrefem new`, `check` and `list` of plugins, and a run with one that fails."""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Callable
from pathlib import Path

import pytest

from tyrefem.cli import main
from tyrefem.contracts import TEMPLATES, check_file

Write = Callable[..., Path]
RUN = ("run", "nasa-22x5.5-8pr", "--no-pictures", "--no-vtk", "--set", "mesh.size=12 mm", "--set",
       "mesh.element=P1", "--set", "drive.duration=60 s")  # fmt: skip


@pytest.mark.parametrize("kind", TEMPLATES)
def test_a_new_plugin_passes_its_check(folder: Path, kind: str, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["new", kind, "my-own"]) == 0
    assert "plugins/my_own.py written" in capfd.readouterr().out
    assert main(["check", "plugins/my_own.py"]) == 0
    out, err = capfd.readouterr()
    assert out.splitlines()[0].startswith(f"{kind.replace('-', ' ')} '")
    assert "FAIL" not in out
    assert "all kept" in out
    assert err == ""
    assert main(["list", "sweep-answers" if kind == "sweep-answer" else f"{kind}s"]) == 0
    assert f"[{folder / 'my_own.py'}]" in capfd.readouterr().out
    assert main(["new", kind, "my-own"]) == 2
    assert "the file exists already" in capfd.readouterr().err


def test_the_lines_to_copy_hold_in_a_folder_with_a_blank(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """As a shell reads them: one path, not two words."""
    folder = tmp_path / "my tyres"
    folder.mkdir()
    monkeypatch.chdir(folder)
    assert main(["new", "effect", "--out", "my plugins/lamp.py"]) == 0
    _, check, export = capfd.readouterr().out.splitlines()
    assert shlex.split(check)[-1] == "my plugins/lamp.py"
    assert shlex.split(export)[-1] == f"TYREFEM_PLUGINS={folder / 'my plugins'}"


@pytest.mark.parametrize("kind", TEMPLATES)
def test_a_kind_without_a_name_has_that_of_its_example(folder: Path, kind: str) -> None:
    assert main(["new", kind]) == 0
    assert (folder / f"{TEMPLATES[kind].replace('-', '_')}.py").is_file()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["new", "effect", "My Lamp"], "is not allowed as a plugin's name"),
        (["new", "effect", "lamp", "--from", "sun"], "are for cards"),
        (["new", "study"], "is missing: the new card's name"),
        (["new", "effct", "lamp"], "did you mean 'effect'?"),
        (["check", "nasa-tread", "--study", "nasa-22x5.5-8pr"], "goes with a Python file of plugins"),
        (["list", "strain-law"], "did you mean 'strain-laws'?"),
    ],
)
def test_a_wrong_command_is_refused(
    folder: Path, arguments: list[str], words: str, capfd: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    assert words in capfd.readouterr().err


@pytest.mark.parametrize(
    ("kind", "name"),
    [
        ("effect", "sun"),
        ("boundary-law", "nasa"),
        ("tan-delta-law", "exponential"),
        ("strain-law", "fem"),
        ("friction-law", "savkoor"),
        ("sweep-answer", "tornado"),
        ("sweep-answer", "vary"),
    ],
)
def test_a_new_plugin_does_not_take_a_shipped_name(
    folder: Path, kind: str, name: str, capfd: pytest.CaptureFixture[str]
) -> None:
    assert main(["new", kind, name]) == 2
    errors = capfd.readouterr().err
    assert errors.count("\n") == 1
    assert f"'{name}' is the name of a shipped {kind.replace('-', ' ')}" in errors or "another table" in errors
    assert list(folder.iterdir()) == []


def test_a_failing_check_has_exit_code_2(write: Write, capfd: pytest.CaptureFixture[str]) -> None:
    file = write("boundary-law", ("return self", "return -self"))
    assert main(["check", str(file)]) == 2
    out, err = capfd.readouterr()
    assert "FAIL  film gives a finite number of at least 0 W/m2/K: film(0 m/s) must be" in out
    assert err == f"tyrefem: {file}: 2 of 4 contracts fail\n"
    assert main(["check", str(file), "--json"]) == 2
    contracts = json.loads(capfd.readouterr().out)
    assert (contracts["failed"], contracts["contracts"]) == (2, 4)


def test_an_effect_later_than_the_trial_is_told_what_shows_it(write: Write, capfd: pytest.CaptureFixture[str]) -> None:
    late = ("return self.shine", "return self.shine if t > 300 else 0.0")
    jump = ("surfaces:", "jumps: ClassVar[tuple[float, ...]] = (300.0,)\n    surfaces:")
    file = write("effect", late, jump)
    assert main(["check", str(file)]) == 2
    out = capfd.readouterr().out
    assert "no reading changes in this drive of 150 s; name a study that shows it (--study NAME), or say" in out
    hint = re.search(r"(signature = )(Signature\(.*?\)), from (tyrefem[.\w]+)", out)
    assert hint is not None
    imported = f"from {hint[3]} import Signature\nfrom tyrefem.effects import"
    line = f"signature: ClassVar[Signature] = {hint[2]}\n\n    shine:"
    write("effect", late, jump, ("from tyrefem.effects import", imported), ("shine:", line))
    assert main(["check", str(file)]) == 0
    assert main(["check", str(write("effect", late, jump)), "--study", "example-validation"]) == 0
    capfd.readouterr()
    assert main(["check", str(write("effect", late)), "--study", "example-validation"]) == 2
    assert "flux('outside_air') jumps at 300 s; its jumps are: none" in capfd.readouterr().out


def test_a_copy_of_a_loaded_file_is_checked(write: Write, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    copy = tmp_path / "copies" / "lamp.py"
    copy.parent.mkdir()
    copy.write_bytes(write("effect").read_bytes())
    assert main(["check", str(copy)]) == 0
    assert "effect 'lamp', class Lamp" in capfd.readouterr().out


@pytest.mark.parametrize("name", [None, "nasa-22x5.5-8pr", "nasa-brake-yaw-skid"])
def test_a_sliding_law_is_tried_with_slip(folder: Path, name: str | None) -> None:
    file = folder / "grip.py"
    file.write_text(
        "from typing import Literal\nfrom tyrefem.boundaries.sliding import UniformSliding\n\n\n"
        'class Grip(UniformSliding):\n    """mu = 0.4."""\n\n    law: Literal["grip"]\n\n'
        "    def friction(self, sliding_speed, rolling_speed):\n        return 0.4\n",
        encoding="utf-8",
    )
    checked = check_file(file, name)
    assert (checked.count, checked.failed) == (4, 0)


@pytest.mark.parametrize(
    ("kind", "change", "words"),
    [
        ("boundary-law", ('"30 W/m**2/K"}', '"30 W/m**2/K"}, 1'), "example: must be a table"),
        ("sweep-answer", ("    key: ClassVar", "    example: ClassVar = None\n    key: ClassVar"), "must be a table"),
        ("strain-law", ("float | None] = 2.0", "str] = 'two'"), "its contracts can be tried: ValueError"),
    ],
)
def test_an_attribute_of_another_type_is_a_contract_that_fails(
    write: Write, kind: str, change: tuple[str, str], words: str, capfd: pytest.CaptureFixture[str]
) -> None:
    assert main(["check", str(write(kind, change))]) == 2
    out = capfd.readouterr().out
    assert "FAIL  its contracts can be tried: " in out
    assert words in out


def test_a_file_that_cannot_be_loaded_is_listed_once(write: Write, capfd: pytest.CaptureFixture[str]) -> None:
    file = write("effect", ("class Lamp", "clas Lamp"))
    assert main(["check", str(file)]) == 2
    out, err = capfd.readouterr()
    assert out.count("cannot be loaded") == 1
    assert err == f"tyrefem: {file}: 1 of 1 contracts fail\n"


def test_a_run_without_the_failing_plugin_works_with_one_line(
    write: Write, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    file = write("effect", ("surface, x, t)", "x)"))
    assert main([*RUN]) == 0
    (line,) = [line for line in capfd.readouterr().err.splitlines() if "warning" in line]
    assert line.startswith(f"tyrefem: warning: left out: {file}: class Lamp: ")


def test_a_run_with_it_ends_in_one_error_before_it_starts(
    write: Write, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    file = write("effect", ("return self.shine", "return float('nan')"))
    assert main([*RUN, "--set", 'effects=[{name="lamp", shine="5 W/m**2"}]']) == 2
    out, err = capfd.readouterr()
    assert out == ""
    (line,) = err.splitlines()
    assert line.startswith(f"tyrefem: {file}: class Lamp: flux('outside_air', ")
    assert not (tmp_path / "results").exists()


def test_every_plugin_is_listed(write: Write, capfd: pytest.CaptureFixture[str]) -> None:
    files = [write(kind) for kind in TEMPLATES]
    assert main(["list", "plugins"]) == 0
    lines = capfd.readouterr().out.splitlines()
    assert len(lines) == len(files)
    assert {line.split("[")[1].rstrip("]") for line in lines} == set(map(str, files))


ROAD_LAWS = """
from typing import Annotated, ClassVar, Literal

from tyrefem.boundaries.road import RoadLaw
from tyrefem.quantity import Unit


class Rising(RoadLaw):
    law: Literal["rising"]
    slope: Annotated[float, Unit("1", gt=0)]
    example: ClassVar[dict] = {"slope": 200.0}

    def film(self, contact):
        return self.slope * contact.speed


class Unknown(RoadLaw):
    law: Literal["unknown"]
    slope: Annotated[float, Unit("1", gt=0)]

    def film(self, contact):
        return self.slope
"""


def test_road_film_computes_a_law_of_the_user_with_the_values_of_its_example(
    folder: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    (folder / "road_laws.py").write_text(ROAD_LAWS, encoding="utf-8")
    assert main(["road", "film", "--speed", "10 m/s", "--footprint", "0.14 m", "--json"]) == 0
    films = json.loads(capfd.readouterr().out)["films_W_m2_K"]
    assert sorted(films) == ["cattani", "constant", "half-space", "rising"]
    assert films["rising"] == pytest.approx(2000.0)
