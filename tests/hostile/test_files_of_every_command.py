"""Every command, found by itself: its answer in JSON, and folders in which files of the user could be lost."""

from __future__ import annotations

import errno
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from command_processes import ALONE
from content import content, half_written, one_line, unchanged
from every_command import Command, commands
from filelock import FileLock
from json_answers import answered, tells_what_made_it

from tyrefem.cli import main

WRITING = [each for each in commands() if "out" in each.options]


def call(command: Command, capfd: pytest.CaptureFixture[str], out: str | Path, *more: str) -> tuple[int, str]:
    """Exit code and stderr; stdout is thrown away."""
    code = main(command.line(out, *more))
    err = capfd.readouterr().err
    assert "Traceback" not in err
    return code, err


@pytest.fixture
def put_in_place(monkeypatch: pytest.MonkeyPatch) -> set[Path]:
    """Files that took their place whole, moved there when they were complete."""
    moved: set[Path] = set()
    replace = os.replace

    def noted(source: str | Path, target: str | Path) -> None:
        replace(source, target)
        moved.add(Path(os.path.abspath(target)))

    monkeypatch.setattr(os, "replace", noted)
    return moved


@pytest.mark.parametrize("command", WRITING, ids=lambda command: command.name)
def test_nothing_of_the_users_is_lost(
    command: Command, here: Path, capfd: pytest.CaptureFixture[str], put_in_place: set[Path]
) -> None:
    before = content(here)
    place = command.out(here / "new")
    line = command.line(place, "--json")
    answered(command, line, capfd)
    unchanged(before, here)
    written = {name: entry for name, entry in content(here).items() if name not in before}
    assert written
    assert half_written(here) == []
    # However it ends, no file is there in part, but for a sweep's, which grows; what is kept for a later attempt has to
    # be met by a kill, too.
    assert {Path(name).name for name in written if here / name not in put_in_place} <= {"variants.jsonl"}
    assert command.words in ALONE or not any(".progress" in path.parts for path in put_in_place)
    if command.writes_folder:
        tells_what_made_it(place, command, line)
        _folder(command, place, capfd)
    else:
        _file(command, place, capfd)
    unchanged(before, here)


#: Of the commands that write a folder, some: with the inputs in it.
AMONG = [each for each in WRITING if each.words in ("compare", "press", "rig identify", "rig simulate", "run", "sweep")]


@pytest.mark.parametrize("command", AMONG, ids=lambda command: command.name)
def test_results_among_the_inputs_stand_beside_them_or_are_refused(
    command: Command, here: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    before = content(here)
    code, err = call(command, capfd, ".")
    assert code in (0, 2), err
    unchanged(before, here)
    assert half_written(here) == []
    if code == 2:
        one_line(err)
        assert content(here) == before


def _refused(command: Command, out: Path, capfd: pytest.CaptureFixture[str], *more: str) -> str:
    state = content(Path())
    code, err = call(command, capfd, out, *more)
    assert code == 2, err
    one_line(err)
    assert len(err.splitlines()) == 1
    assert content(Path()) == state
    return err


def _folder(command: Command, place: Path, capfd: pytest.CaptureFixture[str]) -> None:
    summary = json.loads((place / "summary.json").read_text(encoding="utf-8"))
    assert summary["complete"] is True
    assert summary["command"] == command.words
    assert summary["files"]
    for name in summary["files"]:
        assert (place / name).is_file()
    if command.of_study:
        assert summary["input"]["section"]
        assert (place / "study.toml").is_file()
    # A file that was changed since is the user's.
    mine = place / summary["files"][0]
    mine.write_bytes(b"mine")
    assert summary["files"][0] in _refused(command, place, capfd)
    # Another command at work in the folder.
    with FileLock(place / ".tyrefem-lock"):
        assert "another command" in _refused(command, place, capfd)
    # Another command's results.
    (place / "summary.json").write_text('{"command": "another"}')
    assert "tyrefem another" in _refused(command, place, capfd)
    # No folder at all.
    Path("file").write_text("mine")
    Path("link").symlink_to("nowhere")
    assert "in the place" in _refused(command, Path("file"), capfd)
    assert "link to nothing" in _refused(command, Path("link"), capfd)
    assert "cannot be written" in _refused(command, Path("/proc/tyrefem"), capfd)
    assert os.path.islink("link")


def _file(command: Command, file: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert file.is_file()
    if command.of_study:
        assert file.with_suffix(".toml").is_file()
    file.write_bytes(b"mine")
    assert "--force" in _refused(command, file, capfd)
    assert "is a folder" in _refused(command, Path(), capfd)
    link = Path("link").with_suffix(file.suffix)
    link.symlink_to("nowhere")
    assert "link to nothing" in _refused(command, link, capfd)
    other = Path("study.txt" if file.suffix == ".toml" else "study.toml")
    assert "must end with" in _refused(command, other, capfd, "--force")


def test_a_rigs_own_tables_are_never_simulated_over(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    before = content(here)
    for force in ([], ["--force"]):
        assert main(["rig", "simulate", "rig", "--out", "rig", *force]) == 2
        assert "a.csv" in capfd.readouterr().err
    assert content(here) == before


def test_a_studys_own_table_is_never_replaced_by_a_run(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    (here / "measured.csv").rename(here / "readings.csv")
    (here / "study.toml").write_text((here / "study.toml").read_text().replace("measured.csv", "readings.csv"))
    (here / "study.toml").rename(here / "mine.toml")
    before = content(here)
    assert main(["run", "mine.toml", "--out", ".", "--force"]) == 2
    assert "is an input" in capfd.readouterr().err
    assert content(here) == before


#: Of the user, in the places where commands keep finished work and write their files.
OTHERS = (
    "notes.txt", ".progress/notes.txt", ".progress/0123456789abcdef/notes.txt", ".progress-2/notes.txt",
    ".progress-mine/a.txt", "cases/notes.txt", "pictures/notes.txt", "again/notes.txt", "effects/notes.txt",
)  # fmt: skip


#: Of the commands that keep finished work for a later attempt, the quick ones.
KEEPING = [each for each in WRITING if each.words in ("compare", "plan", "isolability")]


@pytest.mark.parametrize("command", KEEPING, ids=lambda command: command.name)
def test_other_files_in_the_folder_of_results_stay(
    command: Command, here: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    out = here / "out"
    for name in OTHERS:
        (out / name).parent.mkdir(parents=True, exist_ok=True)
        (out / name).write_text("mine")
    before = content(here)
    for force in ([], ["--force"]):
        assert call(command, capfd, out, *force)[0] == 0
        unchanged(before, here)
        # Nothing that the command has kept for a later attempt is left.
        assert [path for path in out.rglob("*") if path.suffix == ".npz"] == []


def test_a_full_disk_is_named_with_the_file_that_has_no_room(
    here: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    (plan,) = (each for each in WRITING if each.words == "plan")
    monkeypatch.setattr("numpy.savez", full)
    code, err = call(plan, capfd, "out")
    assert code == 2
    assert re.fullmatch(r"tyrefem: \S+/\.progress/\S+\.npz: cannot be written: No space left on device\n", err)


def test_a_card_without_room_names_the_copy_not_its_source(here: Path) -> None:
    """Files of this process end after 100 bytes, as on a full disk."""
    code = (
        "import resource, sys\n"
        "from tyrefem.cli import main\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))\n"
        "sys.exit(main(['new', 'study', 'copied', '--from', 'example-validation', '--out', 'copied.toml']))\n"
    )
    # Without bytecode (-B), which would be cut, too.
    done = subprocess.run([sys.executable, "-B", "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 2, done.stderr
    assert done.stderr == f"tyrefem: {here}/copied.toml: cannot be written: File too large\n"
    assert not Path("copied.toml").exists()
