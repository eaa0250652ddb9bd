"""Without a terminal, long work says on stderr how far it is; quiet, it says nothing."""

from __future__ import annotations

import re
import time
from pathlib import Path

import pytest

from tyrefem.cli.durations import cache_file, expected, remember
from tyrefem.cli.progress import EVERY, Stage, counted, progress, stages
from tyrefem.cli.shell import speaking


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
    def work() -> None:
        with stages(every=0.01 if quiet else EVERY) as tick:
            tick("simulations", 1, 2)
            time.sleep(0.05)

    speaking(work)(quiet=quiet)
    assert capfd.readouterr().err == ""


def test_what_is_left_follows_from_the_work_done() -> None:
    stage = Stage("simulations", done=3.0, total=4.0, start=time.monotonic() - 30.0)
    assert stage.left == pytest.approx(10.0, abs=0.1)
    assert stage.words == "about 10 s left"
    # Too early to tell; nothing is done yet; all that is counted is done, but the stage goes on.
    assert Stage("simulations", done=3.0, total=4.0).words == ""
    assert Stage("simulations", total=4.0, start=time.monotonic() - 30.0).words == ""
    assert Stage("simulations", done=4.0, total=4.0, start=time.monotonic() - 30.0).words == ""


def test_a_stage_without_count_has_the_time_of_the_last_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    assert expected("pressed") is None
    remember("pressed", 1.0)  # short work is not kept
    assert not cache_file().exists()
    remember("pressed", 40.0)
    assert expected("pressed") == 40.0
    stage = Stage("pressed", start=time.monotonic() - 25.0, before=expected("pressed"))
    assert stage.left == pytest.approx(15.0, abs=0.1)
    # Longer than the last time: nothing is said.
    assert Stage("pressed", start=time.monotonic() - 45.0, before=40.0).words == ""
    for number in range(400):
        remember(f"stage {number}", 5.0)
    assert expected("pressed") is None  # the oldest are forgotten
    assert expected("stage 399") == 5.0


def test_a_cache_that_cannot_be_read_or_written_is_no_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    remember("pressed", 40.0)
    assert expected("pressed") is None
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    cache_file().parent.mkdir()
    cache_file().write_text("[1, 2", encoding="utf-8")
    assert expected("pressed") is None


def test_the_line_in_a_log_tells_what_is_left(capfd: pytest.CaptureFixture[str]) -> None:
    with stages(every=2.2) as tick:
        tick("simulations", 1, 2)
        time.sleep(2.4)
    assert capfd.readouterr().err == "tyrefem: simulations, 50% after 0 min, about 2 s left\n"


def test_what_is_left_does_not_follow_from_what_comes_first(capfd: pytest.CaptureFixture[str]) -> None:
    with stages(every=4.7) as tick:
        step = counted(tick, "tyre, first its strain cycles", "tyre", 100.0)
        time.sleep(2.2)
        step(1.0)
        time.sleep(2.3)
        step(50.0)
        time.sleep(0.4)
    assert capfd.readouterr().err == "tyrefem: tyre, 50% after 0 min, about 2 s left\n"


def test_a_bar_on_a_terminal(capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    monkeypatch.setenv("FORCE_COLOR", "1")
    with progress("simulations", 4.0) as step:
        step(3.0)
        time.sleep(0.2)
    drawn = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", capfd.readouterr().err)
    assert "simulations" in drawn
    assert "75%" in drawn


def test_a_bar_has_the_name_of_its_stage_as_it_is(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    with stages() as tick:
        tick("tyre [v2] [/b]: simulations", 1, 2)
    assert "tyre [v2] [/b]: simulations" in capsys.readouterr().err
