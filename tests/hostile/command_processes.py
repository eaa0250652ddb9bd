"""Every command that computes, as a process of its own, and the moments at which a signal may meet it."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from every_command import Command, commands
from forked_commands import exit_code, forked

#: Commands that answer at once, by their first word; the others compute something.
AT_ONCE = {"check", "list", "new", "road", "schema", "show", "slide"}
COMPUTING = [each for each in commands() if each.words.split()[0] not in AT_ONCE]
#: Commands that keep finished work for a later attempt, or write by themselves: folders of files, one file, tables of
#: a rig. The others compute, and then put whole files in place: `test_files_of_every_command.py` sees each of them.
ALONE = {
    "blind", "compare", "diagnose", "export", "isolability", "plan", "rig simulate", "run", "strain", "sweep",
}  # fmt: skip
#: Commands whose interpreter is always a new one, which imports while it works.
NEW = ("run", "sweep", "rig simulate")


@dataclass
class Process:
    """A running command in a group of its own. ``poll`` : its exit code, or None; ``err`` : the file of its stderr."""

    pid: int
    poll: Callable[[], int | None]
    err: Path


def started(command: Command, out: Path, *, largest_file: int = 0) -> Process:
    """The command as a process: one of `NEW` of a new interpreter, the others forked (`forked_commands.py`).

    ``largest_file`` : bytes that no file may exceed.
    """
    number, name = tempfile.mkstemp(prefix="stderr-")
    os.close(number)
    if command.words not in NEW:
        pid = forked(command.line(out), os.getcwd(), name, largest_file=largest_file)
        codes: list[int] = []

        def poll() -> int | None:
            if not codes and (code := exit_code(pid)) is not None:
                codes.append(code)
            return codes[0] if codes else None

        return Process(pid, poll, Path(name))

    def begin() -> None:
        # A shell that runs the tests in the background has them ignore it.
        signal.signal(signal.SIGINT, signal.default_int_handler)
        if largest_file:
            resource.setrlimit(resource.RLIMIT_FSIZE, (largest_file, largest_file))

    # Python itself would leave bytecode that is cut short.
    short = {"PYTHONDONTWRITEBYTECODE": "1"} if largest_file else {}
    with open(name, "w", encoding="utf-8") as err:
        running = subprocess.Popen(
            [sys.executable, "-m", "tyrefem", *command.line(out)], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
            stderr=err, start_new_session=True, preexec_fn=begin, env=os.environ | short,
        )  # fmt: skip
    return Process(running.pid, running.poll, Path(name))


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
    until = time.monotonic() + 120
    while (code := running.poll()) is None:
        if time.monotonic() > until:
            os.killpg(running.pid, signal.SIGKILL)
        time.sleep(0.01)
    err = running.err.read_text(encoding="utf-8")
    running.err.unlink()
    return code, err
