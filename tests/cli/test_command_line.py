"""Help, version, completion: quick, and without the heavy libraries."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from terminal import command, process

import tyrefem
from tyrefem.cli import main

COMMANDS = ("run", "compare", "list", "show", "check", "new")
#: Of these typer itself imports pydantic for a command that takes arguments, in some versions.
HEAVY = ("numpy", "scipy", "skfem", "pandas", "matplotlib", "pint", "pydantic", "pyvista", "gmsh", "jinja2")


@pytest.mark.parametrize("arguments", [["--help"], *([name, "--help"] for name in COMMANDS)])
def test_help_imports_nothing_heavy(arguments: list[str]) -> None:
    code = (
        "import sys; from tyrefem.cli import main\n"
        f"code = main({arguments!r})\n"
        f"heavy = sorted(set(sys.modules) & set({HEAVY!r}))\n"
        "print(code, heavy, file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True)
    assert done.stderr in ("0 []\n", "0 ['pydantic']\n" if len(arguments) > 1 else "")
    assert "Usage" in done.stdout


def test_help_names_every_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--help"]) == 0
    out = capsys.readouterr().out
    assert [name for name in COMMANDS if f" {name} " in out] == list(COMMANDS)


def test_capital_letters_make_no_command_where_files_do_not_tell_them(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    # As on Windows and macOS, where RUN.py is the file run.py.
    monkeypatch.setattr(Path, "is_file", lambda _: True)
    assert main(["RUN"]) == 2
    assert "No such command 'RUN'" in capsys.readouterr().err


def test_version() -> None:
    done = process("--version")
    assert (done.returncode, done.stdout, done.stderr) == (0, f"tyrefem {tyrefem.__version__}\n", "")


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completion_script(shell: str) -> None:
    done = process(env=os.environ | {"_TYREFEM_COMPLETE": f"source_{shell}"})
    assert done.returncode == 0
    assert f"_TYREFEM_COMPLETE=complete_{shell}" in done.stdout


@pytest.mark.parametrize(
    ("typed", "offered"),
    [
        ("tyrefem run nasa-22", {"nasa-22x5.5-8pr", "nasa-22x5.5-12pr"}),
        ("tyrefem list ma", {"materials"}),
        ("tyrefem show me", {"mesh"}),
        ("tyrefem show material nasa-t", {"nasa-tread"}),
        ("tyrefem new section mine --from nasa-22x5.5-8", {"nasa-22x5.5-8pr"}),
    ],
)
def test_completion_offers_names(typed: str, offered: set[str]) -> None:
    completion = {
        "_TYREFEM_COMPLETE": "complete_bash",
        "COMP_WORDS": typed,
        "COMP_CWORD": str(len(typed.split()) - 1),
    }
    done = process(env=os.environ | completion)
    assert set(done.stdout.split()) == offered


def test_a_reader_that_goes_away_is_no_error() -> None:
    reading, writing = os.pipe()
    os.close(reading)
    with os.fdopen(writing, "w") as gone:
        done = subprocess.run(command("list"), stdout=gone, stderr=subprocess.PIPE, text=True, timeout=60, check=False)
    assert done.stderr == ""


def test_unknown_command_and_missing_argument(capfd: pytest.CaptureFixture[str]) -> None:
    for arguments, words in ((["rum"], "No such command 'rum'"), (["run"], "Missing argument 'STUDY'")):
        assert main(arguments) == 2
        out, err = capfd.readouterr()
        assert out == ""
        assert err.startswith("tyrefem: ")
        assert words in err
        assert err.count("\n") == 1
