"""Every command that computes, sent Ctrl-C while it starts, while it computes, while it writes."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable
from pathlib import Path

import pytest
from command_processes import COMPUTING, after_start, at_work, ended, started, waited, writing
from content import content, half_written, one_line, unchanged
from every_command import Command


@pytest.mark.parametrize("moment", [after_start, at_work, writing], ids=lambda moment: moment.__name__)
@pytest.mark.parametrize("command", COMPUTING, ids=lambda command: command.name)
def test_interrupted(command: Command, moment: Callable[[Path], bool], here: Path) -> None:
    before = content(here)
    out = command.out(here / "new")
    # At its start it imports: in an interpreter that has done so there is no such moment.
    running = started(command, out, new=moment is after_start)
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
