"""Commands that compute, killed, and on a full disk: all that keep finished work or write by themselves."""

from __future__ import annotations

import os
import shutil
import signal
from pathlib import Path

import pytest
from command_processes import ALONE, COMPUTING, ended, started, waited, writing
from content import content, half_written, one_line, unchanged
from every_command import Command

KILLED = [each for each in COMPUTING if each.words in ALONE]


def test_they_are_commands() -> None:
    assert {each.words for each in KILLED} == ALONE


@pytest.mark.parametrize("command", KILLED, ids=lambda command: command.name)
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


@pytest.mark.parametrize("command", KILLED, ids=lambda command: command.name)
def test_full_disk(command: Command, here: Path) -> None:
    before = content(here)
    out = command.out(here / "new")

    # No file may grow beyond this: what a full disk does to a program.
    code, err = ended(started(command, out, largest_file=1000))
    assert code == 2, err
    one_line(err)
    assert "cannot be written" in err
    unchanged(before, here)
    assert half_written(here) == []
    shutil.rmtree(out.parent, ignore_errors=True)
