"""Commands where streams are closed or have few letters, and where the user's pictures are made with LaTeX."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path

import pytest
from terminal import BARE, NASA, SHORT, command, process

TITLE = ("--set", "title=Prüf \u03a9 \u2192")


def test_letters_that_stdout_lacks_are_written_as_numbers() -> None:
    # As Windows redirects into a file.
    environment = {**os.environ, "PYTHONIOENCODING": "cp1252"}
    done = process("run", NASA, *SHORT, *BARE, *TITLE, env=environment, encoding="cp1252")
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("Prüf \\u03a9 \\u2192\n")
    told = process("run", NASA, *SHORT, *BARE, *TITLE, "--json", env=environment, encoding="cp1252")
    assert json.loads(told.stdout)["title"] == "Prüf \u03a9 \u2192"


@pytest.mark.skipif(os.name != "posix", reason="needs a shell")
@pytest.mark.parametrize("closed", ["2>&-", ">&-", "<&-"])
def test_a_closed_stream_does_not_stop_a_command(closed: str, here: Path) -> None:
    words = command("run", NASA, *SHORT, *BARE)
    done = subprocess.run(["sh", "-c", f'exec "$@" {closed}', "sh", *words], capture_output=True, timeout=120)
    assert (done.returncode, done.stderr) == (0, b"")
    assert json.loads((here / "results" / NASA / "summary.json").read_text(encoding="utf-8"))["complete"] is True


def test_the_users_latex_is_not_used(here: Path) -> None:
    pictures = []
    for setting in ("", "text.usetex: True\n"):
        (here / "matplotlibrc").write_text(setting, encoding="utf-8")
        done = process("show", "section", NASA, "--out", f"picture{len(pictures)}.png")
        assert done.stderr == ""
        pictures.append((here / f"picture{len(pictures)}.png").read_bytes())
    assert pictures[0] == pictures[1]
