"""Without a terminal, long work says on stderr how far it is; quiet, it says nothing."""

from __future__ import annotations

import re
import time

import pytest

from tyrefem.cli.progress import EVERY, progress, stages


def test_a_line_at_a_time_without_a_terminal(capfd: pytest.CaptureFixture[str]) -> None:
    with stages(every=0.05) as tick:
        tick("reading", 0, 0)
        time.sleep(0.08)
        tick("simulations", 3, 4)
        time.sleep(0.12)
    lines = capfd.readouterr().err.splitlines()
    assert lines[0] == "tyrefem: reading after 0 min"
    assert lines[-1] == "tyrefem: simulations, 75% after 0 min"
    time.sleep(0.1)
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("quiet", [True, False])
def test_nothing_when_quiet_and_nothing_of_what_is_short(quiet: bool, capfd: pytest.CaptureFixture[str]) -> None:
    with stages(quiet=quiet, every=0.01 if quiet else EVERY) as tick:
        tick("simulations", 1, 2)
        time.sleep(0.05)
    assert capfd.readouterr().err == ""


def test_a_bar_on_a_terminal(capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    monkeypatch.setenv("FORCE_COLOR", "1")
    with progress("simulations", 4.0) as step:
        step(3.0)
        time.sleep(0.2)
    drawn = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", capfd.readouterr().err)
    assert "simulations" in drawn
    assert "75%" in drawn
