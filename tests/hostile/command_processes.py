"""Every command that computes, as a process of its own, and the moments at which a signal may meet it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

from every_command import Command, commands

Process = subprocess.Popen[str]
#: Commands that answer at once, by their first word; the others compute something.
AT_ONCE = {"check", "list", "new", "road", "schema", "show", "slide"}
COMPUTING = [each for each in commands() if each.words.split()[0] not in AT_ONCE]


def started(command: Command, out: Path, prepare: Callable[[], None] | None = None, **variables: str) -> Process:
    """The command as a process, and group, of its own; with further environment variables."""

    def begin() -> None:
        # A shell that runs the tests in the background has them ignore it.
        signal.signal(signal.SIGINT, signal.default_int_handler)
        if prepare is not None:
            prepare()

    return subprocess.Popen(
        [sys.executable, "-m", "tyrefem", *command.line(out)], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        text=True, start_new_session=True, preexec_fn=begin, env=os.environ | variables,
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


def waited(running: Process, moment: Callable[[Path], bool], out: Path) -> None:
    until = time.monotonic() + 120
    while running.poll() is None and not moment(out) and time.monotonic() < until:
        time.sleep(0.01)


def ended(running: Process) -> tuple[int, str]:
    """Exit code and stderr."""
    try:
        _, err = running.communicate(timeout=120)
    finally:
        if running.poll() is None:
            os.killpg(running.pid, signal.SIGKILL)
            running.communicate()
    return running.returncode, err
