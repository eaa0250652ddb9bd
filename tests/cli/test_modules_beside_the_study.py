"""Python files of a user in the current folder that have names of standard modules: a command never loads them."""

from __future__ import annotations

import logging
import subprocess
import sys
from pathlib import Path

import pytest

from tyrefem.reports import view3d

NAMES = ("copy", "pickle", "platform", "signal", "types")
#: Starts a worker, as an installed command does: the folder of the script is not the current one.
WORKER = """
from tyrefem.processes import processes
if __name__ == "__main__":
    with processes(1) as pool:
        print(pool.submit(abs, -3).result())
"""


@pytest.fixture(autouse=True)
def beside(here: Path) -> None:
    for name in NAMES:
        (here / f"{name}.py").write_text(f"raise SystemExit('the user has a {name}.py')\n", encoding="utf-8")


def test_workers_start(here: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    script = tmp_path_factory.mktemp("scripts") / "script.py"
    script.write_text(WORKER, encoding="utf-8")
    ended = subprocess.run([sys.executable, str(script)], cwd=here, capture_output=True, text=True, timeout=120)
    assert (ended.stdout, ended.stderr, ended.returncode) == ("3\n", "", 0)


def test_a_3d_picture_is_tried(here: Path, caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.WARNING):
        assert view3d.screenshot(here / "missing.vtu", here / "3d.png") is None
    assert "the user has" not in caplog.text
    assert "missing.vtu" in caplog.text
