"""Every command that computes, sent Ctrl-C while it starts, while it computes, while it writes."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable
from pathlib import Path

import pytest
from command_processes import ALONE, COMPUTING, NEW, after_start, at_work, ended, started, waited, writing
from content import content, half_written, one_line, unchanged
from every_command import Command

#: All commands start alike, so three are met there, in an interpreter that has imported nothing yet;
#: tests/cli/test_ctrl_c.py meets single imports. All compute by themselves, and these write by themselves.
MEETING = {after_start: NEW, at_work: {each.words for each in COMPUTING}, writing: ALONE}
MOMENTS = [
    pytest.param(command, moment, id=f"{command.name}-{moment.__name__}")
    for command in COMPUTING
    for moment, met in MEETING.items()
    if command.words in met
]


@pytest.mark.parametrize(("command", "moment"), MOMENTS)
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
