"""A folder of results tells one run and never costs the user a file."""

from __future__ import annotations

import errno
import json
import os
import signal
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from filelock import FileLock

from tyrefem.errors import InputError, ResultWarning
from tyrefem.output import atomic_folder, atomic_path, note_input, reading, write_json
from tyrefem.output.folder import results_folder

pytestmark = pytest.mark.fast

NAMES = ("readings.csv", "report.html", "pictures/*.png")


def write(folder: Path, *names: str, complete: bool = True) -> None:
    for name in names:
        with atomic_path(folder / name) as temporary:
            temporary.write_text(name)
    write_json({"answer": 1.0, "complete": complete}, folder / "summary.json")


def summary(folder: Path) -> dict[str, object]:
    record: dict[str, object] = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    return record


def files(folder: Path) -> set[str]:
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}


def run(folder: Path, *names: str, force: bool = False) -> None:
    with results_folder(folder, "run", NAMES, origin=None, force=force) as place:
        write(place, *names)


def marked_and_failing(folder: Path, *names: str) -> None:
    if names:
        write(folder, *names)
    assert summary(folder)["complete"] is False
    raise ZeroDivisionError


def test_the_summary_lists_the_files_of_the_run(tmp_path: Path) -> None:
    run(tmp_path / "out", "readings.csv", "pictures/a.png")
    record = summary(tmp_path / "out")
    assert (record["command"], record["complete"], record["answer"]) == ("run", True, 1.0)
    assert record["files"] == ["pictures/a.png", "readings.csv"]
    assert files(tmp_path / "out") == {"summary.json", "pictures/a.png", "readings.csv"}


def test_a_second_run_clears_what_it_does_not_write_again(tmp_path: Path) -> None:
    run(tmp_path, "readings.csv", "report.html", "pictures/a.png")
    run(tmp_path, "readings.csv")
    assert files(tmp_path) == {"summary.json", "readings.csv"}
    assert not (tmp_path / "pictures").exists()


@pytest.mark.parametrize("name", ["readings.csv", "summary.json", "pictures/mine.png"])
def test_a_foreign_file_is_an_error_before_any_computing(tmp_path: Path, name: str) -> None:
    (tmp_path / name).parent.mkdir(exist_ok=True)
    (tmp_path / name).write_text("mine")
    with pytest.raises(InputError, match=name), results_folder(tmp_path, "run", NAMES, origin=None):
        pytest.fail("computed")
    assert files(tmp_path) == {name}
    run(tmp_path, "readings.csv", force=True)
    assert summary(tmp_path)["complete"] is True


def test_other_files_of_the_users_stay(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    run(tmp_path, "readings.csv")
    run(tmp_path, "report.html")
    assert files(tmp_path) == {"notes.txt", "report.html", "summary.json"}


def test_a_file_changed_since_is_the_users(tmp_path: Path) -> None:
    run(tmp_path, "readings.csv", "report.html")
    (tmp_path / "report.html").write_text("with my remarks")
    with pytest.raises(InputError, match=r"report\.html"):
        run(tmp_path, "readings.csv")
    assert (tmp_path / "report.html").read_text() == "with my remarks"


def test_an_input_is_never_written(tmp_path: Path) -> None:
    run(tmp_path, "readings.csv")
    for given in (tmp_path / "readings.csv", tmp_path / "link.csv"):
        if not given.exists():
            given.symlink_to(tmp_path / "readings.csv")
        with reading():
            note_input(given)
            for force in (False, True):
                with pytest.raises(InputError, match="is an input of this command"):
                    run(tmp_path, "readings.csv", force=force)
    assert (tmp_path / "readings.csv").read_text() == "readings.csv"


def test_an_input_outside_the_folder_is_never_written_either(tmp_path: Path) -> None:
    table = tmp_path / "table.csv"
    table.write_text("mine")
    with reading(), results_folder(tmp_path / "out", "run", NAMES, origin=None, inputs=[table]) as out:
        with pytest.raises(InputError, match="is an input"), atomic_path(out.parent / "table.csv") as temporary:
            temporary.write_text("lost")
        with pytest.raises(InputError, match="is an input"), atomic_folder(out.parent) as place:
            (place / "table.csv").write_text("lost")
    assert files(tmp_path) == {"table.csv"}


def test_another_commands_results_are_not_mixed(tmp_path: Path) -> None:
    run(tmp_path, "readings.csv")
    with (
        pytest.raises(InputError, match="holds the results of 'tyrefem run'"),
        results_folder(tmp_path, "compare", ("comparison.csv",), origin=None),
    ):
        pytest.fail("computed")
    with results_folder(tmp_path, "compare", ("comparison.csv",), origin=None, force=True) as place:
        write(place, "comparison.csv")
    assert files(tmp_path) == {"summary.json", "comparison.csv"}


def test_a_failure_before_writing_leaves_no_trace(tmp_path: Path) -> None:
    out = tmp_path / "a" / "b"
    with pytest.raises(ZeroDivisionError), results_folder(out, "run", NAMES, origin=None, keeps=["store/*.json"]):
        raise ZeroDivisionError
    assert not (tmp_path / "a").exists()
    run(out, "readings.csv")
    before = summary(out)
    with pytest.raises(ZeroDivisionError), results_folder(out, "run", NAMES, origin=None, keeps=["store/*.json"]):
        marked_and_failing(out)
    assert summary(out) == before


def test_while_it_writes_a_folder_is_not_complete(tmp_path: Path) -> None:
    with pytest.raises(ZeroDivisionError), results_folder(tmp_path, "run", NAMES, origin=None) as place:
        marked_and_failing(place, "readings.csv")
    assert summary(tmp_path)["complete"] is False
    assert summary(tmp_path)["files"] == ["readings.csv"]
    run(tmp_path, "report.html")
    assert summary(tmp_path)["complete"] is True
    assert files(tmp_path) == {"summary.json", "report.html"}


def test_a_killed_command_leaves_a_folder_that_is_used_again(tmp_path: Path) -> None:
    if not (child := os.fork()):
        with results_folder(tmp_path, "run", NAMES, origin=None) as place:
            write(place, "readings.csv", "pictures/a.png")
            (place / "pictures" / ".tyrefem-01234567.png").write_text("half")
            os._exit(9)
    os.waitpid(child, 0)
    assert summary(tmp_path)["complete"] is False
    run(tmp_path, "readings.csv")
    assert files(tmp_path) == {"summary.json", "readings.csv"}


def test_ctrl_c_within_the_writing_itself_leaves_no_half_file(tmp_path: Path) -> None:
    """A signal may come between making a temporary folder and the block that removes it."""

    def interrupted(place: Path) -> None:
        write(place, "pictures/a.png")
        (place / "pictures" / ".tyrefem-01234567.png").write_text("half")
        (place / ".tyrefem-89abcdef").mkdir()
        raise KeyboardInterrupt

    with (
        pytest.raises(KeyboardInterrupt),
        results_folder(tmp_path / "out", "run", NAMES, origin=None) as place,
    ):
        interrupted(place)
    assert not list(tmp_path.rglob(".tyrefem-*"))


def test_finished_work_stays_for_another_try(tmp_path: Path) -> None:
    def attempt(name: str) -> None:
        with results_folder(tmp_path, "blind", ("blind.json",), origin=None, keeps=["cases/*.json"]) as place:
            write(place, f"cases/{name}.json")

    attempt("a")
    attempt("b")
    assert summary(tmp_path)["files"] == ["cases/a.json", "cases/b.json"]
    assert (tmp_path / "cases" / "a.json").is_file()


@pytest.mark.parametrize("force", [False, True])
def test_a_case_in_other_capital_letters_keeps_its_files(force: bool, tmp_path: Path) -> None:
    def case(name: str) -> None:
        with results_folder(tmp_path, "run", [f"cases/{name}/*.csv"], origin=None, force=force) as place:
            write(place, f"cases/{name}/readings.csv")

    case("A")
    # As on Windows and macOS, where both names are one folder.
    (tmp_path / "cases" / "a").symlink_to("A")
    case("a")
    assert summary(tmp_path)["files"] == ["cases/a/readings.csv"]
    assert (tmp_path / "cases" / "a" / "readings.csv").read_text(encoding="utf-8") == "cases/a/readings.csv"


def test_two_commands_at_once_are_one_too_many(tmp_path: Path) -> None:
    with (
        results_folder(tmp_path, "run", NAMES, origin=None),
        pytest.raises(InputError, match="another command is writing"),
    ):
        run(tmp_path, "readings.csv")
    run(tmp_path, "readings.csv")
    assert files(tmp_path) == {"summary.json", "readings.csv"}


@pytest.mark.skipif(os.name != "posix", reason="Windows locks in another way")
def test_a_file_system_without_locks_holds_results(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def flock(*_: object) -> None:
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr("fcntl.flock", flock)
    with pytest.warns(ResultWarning, match="its file system has no locks"):
        run(tmp_path / "out", "readings.csv")
    assert files(tmp_path / "out") == {"summary.json", "readings.csv"}


def test_a_lock_of_another_user_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def acquire(lock: FileLock, timeout: float) -> None:
        raise PermissionError(errno.EACCES, "Permission denied", lock.lock_file)

    monkeypatch.setattr(FileLock, "acquire", acquire)
    with pytest.raises(InputError) as error:
        run(tmp_path, "readings.csv")
    assert error.value.file == tmp_path
    (tmp_path / ".tyrefem-lock").touch()
    with pytest.raises(InputError, match=r"\.tyrefem-lock: --out: cannot be written: Permission denied"):
        run(tmp_path, "readings.csv")


def test_ctrl_c_while_the_folder_is_locked_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    acquire = FileLock.acquire

    def interrupted(lock: FileLock, timeout: float) -> Any:
        acquired = acquire(lock, timeout)
        signal.raise_signal(signal.SIGINT)
        return acquired

    monkeypatch.setattr(FileLock, "acquire", interrupted)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            run(tmp_path / "out", "readings.csv")
    finally:
        signal.signal(signal.SIGINT, before)
    assert not (tmp_path / "out").exists()


def test_an_interrupted_answer_says_so_itself(tmp_path: Path) -> None:
    with results_folder(tmp_path, "run", NAMES, origin=None) as place:
        write(place, "readings.csv", complete=False)
    assert summary(tmp_path)["complete"] is False


@pytest.mark.parametrize(("make", "message"), [
    (lambda place: place.write_text("mine"), "a file is in the place"),
    (lambda place: place.symlink_to("nowhere"), "is a link to nothing"),
])  # fmt: skip
def test_what_is_no_folder_is_refused(tmp_path: Path, make: object, message: str) -> None:
    place = tmp_path / "out"
    make(place)  # type: ignore[operator]
    for folder in (place, place / "deeper"):
        with pytest.raises(InputError, match=message):
            run(folder, "readings.csv")
    assert os.path.lexists(place)


def test_a_drive_that_is_not_there_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # On Windows the folder above Q:\\ is Q:\\ itself, whether or not there is such a drive.
    monkeypatch.setattr(os.path, "lexists", lambda _: False)
    with pytest.raises(InputError, match="there is no such drive"):
        run(tmp_path / "out", "readings.csv")


def test_this_folder_is_a_folder_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with results_folder(".", "run", NAMES, origin=None) as place, atomic_folder(place) as temporary:
        (temporary / "readings.csv").write_text("1")
        (temporary / "summary.json").write_text('{"answer": 2}')
    assert files(tmp_path) == {"summary.json", "readings.csv"}
    assert summary(tmp_path)["answer"] == 2


class Maker:
    """What makes the results of a test."""

    def names(self, folder: Path) -> tuple[str, ...]:
        return ("maker.toml",)

    def write(self, folder: Path) -> tuple[str, ...]:
        with atomic_path(folder / "maker.toml") as temporary:
            temporary.write_text("")
        return ("maker.toml",)

    def summary(self) -> dict[str, Any]:
        return {"maker": "a study"}


def write_readings(folder: Path) -> None:
    with atomic_path(folder / "readings.csv") as temporary:
        temporary.write_text("")


def write_readings_and_fail(folder: Path) -> None:
    write_readings(folder)
    raise ZeroDivisionError


def test_the_folder_writes_what_made_its_results(tmp_path: Path) -> None:
    with results_folder(tmp_path, "run", NAMES, origin=Maker()) as place:
        write_readings(place)
    record = summary(tmp_path)
    assert record["files"] == ["maker.toml", "readings.csv"]
    assert (record["maker"], record["complete"]) == ("a study", True)


def test_a_summary_of_the_command_stays(tmp_path: Path) -> None:
    with results_folder(tmp_path, "run", NAMES, origin=Maker()) as place:
        write(place, "readings.csv")
    assert summary(tmp_path)["answer"] == 1.0
    assert "maker" not in summary(tmp_path)
    assert (tmp_path / "maker.toml").is_file()


def test_results_left_by_a_failure_tell_what_made_them(tmp_path: Path) -> None:
    with pytest.raises(ZeroDivisionError), results_folder(tmp_path, "run", NAMES, origin=Maker()) as place:
        write_readings_and_fail(place)
    record = summary(tmp_path)
    assert (record["maker"], record["complete"]) == ("a study", False)
    assert (tmp_path / "maker.toml").is_file()


def test_without_results_nothing_of_what_makes_them_is_written(tmp_path: Path) -> None:
    keeps = ["store/*.csv"]
    with (
        pytest.raises(ZeroDivisionError),
        results_folder(tmp_path / "out", "run", NAMES, origin=Maker(), keeps=keeps) as place,
    ):
        write_readings_and_fail(place / "store")
    assert files(tmp_path / "out") == {"store/readings.csv", "summary.json"}
    assert "maker" not in summary(tmp_path / "out")


def test_a_users_file_in_the_place_of_what_makes_results_is_refused(tmp_path: Path) -> None:
    (tmp_path / "maker.toml").write_text("mine")
    refused = pytest.raises(InputError, match=r"maker\.toml")
    with refused, results_folder(tmp_path, "run", NAMES, origin=Maker()):
        pass


def test_threads_save_side_by_side(tmp_path: Path) -> None:
    """Each with its own list of files: none takes another's file for one of the user."""
    begun = threading.Barrier(4)

    def saved(name: str) -> dict[str, object]:
        folder = tmp_path / name
        with results_folder(folder, "run", ["*.txt"], origin=None):
            begun.wait(10)
            for number in range(3):
                with atomic_path(folder / f"{number}.txt") as temporary:
                    temporary.write_text(name)
                begun.wait(10)
            write_json({"study": name}, folder / "summary.json")
        return summary(folder)

    with ThreadPoolExecutor(4) as threads:
        summaries = list(threads.map(saved, "abcd"))
    assert [(each["study"], each["files"], each["complete"]) for each in summaries] == [
        (name, ["0.txt", "1.txt", "2.txt"], True) for name in "abcd"
    ]
