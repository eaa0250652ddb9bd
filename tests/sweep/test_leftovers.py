"""A sweep's folder that is used again holds what was asked last, and everything that is not ours."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tyrefem.cli import main

TYRE = "nasa-22x5.5-8pr"
COARSE = ["mesh.size=20 mm", "mesh.element=P1", "numerics.tolerance=1 K", "drive.duration=20 s", "output.every=10 s"]
QUICK = [word for change in COARSE for word in ("--set", change)] + ["--workers", "1", "--reduced", "never"]
TORNADO = ["--tornado", "--tolerance-of", "drive.speed=5%", "--answer", "hottest_degC"]
ENVELOPE = ["--envelope", "hottest_degC<29", "--loads", "2 kN,4 kN", "--speeds", "5 m/s:20 m/s"]


def files_after(out: Path, *flags: str) -> dict[str, bytes]:
    """Every file of the folder after a command."""
    assert main(["sweep", TYRE, *flags, *QUICK, "--out", str(out)]) == 0
    return {str(file.relative_to(out)): file.read_bytes() for file in sorted(out.rglob("*")) if file.is_file()}


@pytest.fixture
def tornado(tmp_path: Path) -> dict[str, bytes]:
    return files_after(tmp_path, *TORNADO)


OURS = {"tornado.csv", "tornado.parquet", "pictures/tornado-hottest_degC.png"}
FINISHED = "tornado/variants.jsonl"


def test_another_question_leaves_nothing_of_the_one_before_but_finished_variants(
    tmp_path: Path, tornado: dict[str, bytes]
) -> None:
    assert set(tornado) > OURS
    user_files = {
        "notes.csv": b"mine",
        "pictures/photo.png": b"mine",
        "tornado.txt": b"mine",
        "tornado/notes.csv": b"mine",
    }
    for name, content in user_files.items():
        (tmp_path / name).write_bytes(content)
    after = files_after(tmp_path, *ENVELOPE)
    assert not OURS & set(after)
    assert {"envelope.csv", "pictures/envelope.png"} < set(after)
    assert {name: after[name] for name in user_files} == user_files
    assert after[FINISHED] == tornado[FINISHED]
    files = json.loads(after["summary.json"])["files"]
    assert set(files) == set(after) - set(user_files) - {"summary.json"}
    # Back to the first question: nothing is run again, and its files are as they were.
    again = files_after(tmp_path, *TORNADO)
    assert again[FINISHED] == tornado[FINISHED]
    assert {name: again[name] for name in OURS} == {name: tornado[name] for name in OURS}
    assert "envelope.csv" not in again


def test_the_same_question_without_pictures_keeps_those_that_are_true(
    tmp_path: Path, tornado: dict[str, bytes]
) -> None:
    assert set(files_after(tmp_path, *TORNADO, "--no-pictures")) == set(tornado)
    other = files_after(tmp_path, *TORNADO, "--no-pictures", "--restart", "--set", "drive.load=2 kN")
    assert "tornado.csv" in other
    assert not [name for name in other if name.endswith((".png", ".html"))]
    assert not (tmp_path / "pictures").exists()


def test_an_unfinished_sweep_takes_nothing_of_its_own_question_away(
    tmp_path: Path, tornado: dict[str, bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("tyrefem.sweep.tornado.sweep", interrupted)
    command = ["sweep", TYRE, *TORNADO, *QUICK, "--out", str(tmp_path)]
    assert main(command) == 130
    assert {name: (tmp_path / name).read_bytes() for name in OURS} == {name: tornado[name] for name in OURS}


@pytest.mark.parametrize(
    "files", ['["../precious.csv", "/precious.csv", "precious.txt", "pictures/../precious.csv", 7]', '"precious.csv"']
)
def test_a_list_that_is_not_ours_removes_nothing(tmp_path: Path, files: str) -> None:
    out, names = tmp_path / "out", ("precious.csv", "out/precious.csv", "out/precious.txt")
    (out / "pictures").mkdir(parents=True)
    for name in names:
        (tmp_path / name).write_text("precious")
    (out / "summary.json").write_text(f'{{"command": "sweep", "files": {files}, "checksums": {files}}}')
    files_after(out, *TORNADO, "--no-pictures")
    assert all((tmp_path / name).read_text() == "precious" for name in names)
    assert (out / "pictures").is_dir()
