"""Every command that computes, interrupted, killed, and on a full disk."""

from __future__ import annotations

import os
import resource
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from content import content, half_written, one_line, unchanged
from every_command import Command, commands

#: Commands that compute something.
COMPUTING = [each for each in commands() if "quiet" in each.options]


def started(command: Command, out: Path, prepare: Callable[[], None] | None = None) -> subprocess.Popen[str]:
    """The command as a process, and group, of its own."""

    def begin() -> None:
        # A shell that runs the tests in the background has them ignore it.
        signal.signal(signal.SIGINT, signal.default_int_handler)
        if prepare is not None:
            prepare()

    return subprocess.Popen(
        [sys.executable, "-m", "tyrefem", *command.line(out)], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        text=True, start_new_session=True, preexec_fn=begin,
    )  # fmt: skip


def after_start(out: Path) -> bool:
    """While the command reads and checks."""
    time.sleep(0.6)
    return True


def at_work(out: Path) -> bool:
    """Its folder is there: it computes."""
    return (out if out.suffix == "" else out.parent).exists()


def writing(out: Path) -> bool:
    """A file of the answer is there."""
    return any(path.is_file() and path.name not in (".tyrefem-lock", "summary.json") for path in out.rglob("*"))


def waited(running: subprocess.Popen[str], moment: Callable[[Path], bool], out: Path) -> None:
    until = time.monotonic() + 120
    while running.poll() is None and not moment(out) and time.monotonic() < until:
        time.sleep(0.01)


def ended(running: subprocess.Popen[str]) -> tuple[int, str]:
    """Exit code and stderr."""
    try:
        _, err = running.communicate(timeout=120)
    finally:
        if running.poll() is None:
            os.killpg(running.pid, signal.SIGKILL)
            running.communicate()
    return running.returncode, err


@pytest.mark.parametrize("moment", [after_start, at_work, writing], ids=lambda moment: moment.__name__)
@pytest.mark.parametrize("command", COMPUTING, ids=lambda command: command.name)
def test_interrupted(command: Command, moment: Callable[[Path], bool], here: Path) -> None:
    before = content(here)
    out = command.out(here / "new")
    running = started(command, out)
    waited(running, moment, out)
    if running.poll() is None:
        os.killpg(running.pid, signal.SIGINT)
    code, err = ended(running)
    assert code in (0, 130), err
    one_line(err)
    assert code == 0 or sum("interrupted" in line for line in err.splitlines()) == 1, err
    unchanged(before, here)
    assert half_written(here) == []
    assert not list(here.rglob(".tyrefem-lock"))


@pytest.mark.parametrize("command", COMPUTING, ids=lambda command: command.name)
def test_killed_and_again(command: Command, here: Path) -> None:
    before = content(here)
    out = command.out(here / "new")
    running = started(command, out)
    waited(running, writing, out)
    if running.poll() is None:
        os.killpg(running.pid, signal.SIGKILL)
    ended(running)
    code, err = ended(started(command, out))
    assert code == 0, err
    unchanged(before, here)
    assert half_written(here) == []


@pytest.mark.parametrize("command", COMPUTING, ids=lambda command: command.name)
def test_full_disk(command: Command, here: Path) -> None:
    before = content(here)
    out = command.out(here / "new")
    # No file may grow beyond this: what a full disk does to a program.
    code, err = ended(started(command, out, lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))))
    assert code == 2, err
    one_line(err)
    assert "cannot be written" in err
    unchanged(before, here)
    assert half_written(here) == []
    shutil.rmtree(out.parent, ignore_errors=True)
