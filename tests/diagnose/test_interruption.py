"""Ctrl-C ends a diagnosis at once: no traceback, nothing half written, and what is finished stays."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

from hidden import Case


def test_interruption_keeps_what_is_finished_and_nothing_else(case: Case, tmp_path: Path) -> None:
    out = tmp_path / "out"
    command = [
        sys.executable, "-m", "tyrefem", "diagnose", str(case.study.file), "--out", str(out), "--workers", "2",
        "--set", "drive.load=2710 lbf",
    ]  # fmt: skip
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
        # A shell that runs the tests in the background has them ignore it.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    ) as running:  # fmt: skip
        try:
            until = time.monotonic() + 240
            while not list(out.rglob("*.npz")) and running.poll() is None and time.monotonic() < until:
                time.sleep(0.05)
            # A terminal sends it to the whole group, workers too.
            os.killpg(running.pid, signal.SIGINT)
            printed, err = running.communicate(timeout=120)
        finally:
            if running.poll() is None:
                os.killpg(running.pid, signal.SIGKILL)
    assert running.returncode == 130
    assert printed == ""
    # A busy machine says before how far it is.
    (line,) = [each for each in err.splitlines() if "% after " not in each]
    assert line.startswith("tyrefem: interrupted; ")
    assert "the same command resumes from there" in line
    # The folder says that it is not complete, and has the finished simulations, whole.
    assert sorted(file.name for file in out.iterdir()) == [".progress", "summary.json"]
    assert json.loads((out / "summary.json").read_text(encoding="utf-8"))["complete"] is False
    kept = [file for file in (out / ".progress").rglob("*") if file.is_file()]
    assert kept
    assert all(file.suffix == ".npz" and not file.name.startswith(".") for file in kept)
