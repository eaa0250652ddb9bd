"""What a short command loads: a module that it does not need costs every user a part of a second, every time."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

import tyrefem
from tyrefem.cli import app, main
from tyrefem.cli.commands import _single

COARSE = ("--set", "mesh.size=15 mm", "--set", "mesh.element=P1", "--set", "drive.duration=20 s")
#: Heavy libraries, and what they would bring with them.
NEVER = {"pandas", "pyarrow", "pint", "pyvista", "vtk", "dask", "xarray", "gmsh", "SALib", "scipy.stats",
         "scipy.optimize", "scipy.interpolate", "matplotlib.pyplot", "urllib.request", "multiprocessing.pool",
         "concurrent.futures.process"}  # fmt: skip
DRAWING = {"matplotlib", "PIL", "jinja2"}
NUMERICS = {"numpy", "scipy", "skfem", "meshio", "tyrefem.api", "tyrefem.simulation", "tyrefem.conduction"}
OTHER_COMMANDS = {
    "tyrefem.cli.diagnose", "tyrefem.cli.sweep", "tyrefem.diagnose", "tyrefem.compare.comparison", "tyrefem.fatigue",
    "tyrefem.reduced.model", "tyrefem.realtime.box_model", "tyrefem.mechanics.rolling.roll",
}  # fmt: skip


#: Runs a command; prints every module that its process has loaded, with the lines of code that asked for it first.
CODE = """
import json, sys
lines = {}
class Record:
    def find_spec(self, name, path=None, target=None):
        frame, callers = sys._getframe(1), []
        while frame is not None and len(callers) < 8:
            if "importlib" not in frame.f_code.co_filename:
                callers.append(f"{frame.f_code.co_filename}:{frame.f_lineno}")
            frame = frame.f_back
        lines.setdefault(name, callers)
sys.meta_path.insert(0, Record())
from tyrefem.cli import main
assert main(json.loads(sys.argv[1])) == 0
print(json.dumps({name: lines.get(name, []) for name in sorted(sys.modules)}))
"""


def loaded(*arguments: str) -> dict[str, list[str]]:
    """The modules of a process that has run a command, each with the lines that asked for it."""
    done = subprocess.run(
        [sys.executable, "-c", CODE, json.dumps(arguments)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    modules: dict[str, list[str]] = json.loads(done.stdout.splitlines()[-1])
    return modules


def among(modules: dict[str, list[str]], names: set[str]) -> dict[str, list[str]]:
    """Those of these names: a failure shows who loads them."""
    return {name: lines for name, lines in modules.items() if name in names}


def test_a_module_is_named_with_the_lines_that_load_it(here: Path) -> None:
    (lines,) = among(loaded("list", "studies"), {"tyrefem.library"}).values()
    assert Path(lines[0].rpartition(":")[0]).is_relative_to(Path(tyrefem.__file__).parent)


def test_help_loads_no_numerics(here: Path) -> None:
    modules = loaded("--help")
    assert among(modules, NEVER | DRAWING | NUMERICS) == {}


def test_help_of_a_command_loads_that_command_alone(here: Path) -> None:
    modules = loaded("run", "--help")
    assert among(modules, NEVER | DRAWING | NUMERICS | OTHER_COMMANDS) == {}
    assert "tyrefem.cli.run" in modules


def test_a_run_loads_what_it_computes_with(here: Path) -> None:
    modules = loaded("run", "nasa-22x5.5-8pr", *COARSE, "--no-pictures", "--out", "out")
    assert among(modules, NEVER | DRAWING | OTHER_COMMANDS) == {}
    assert {"skfem", "tyrefem.cli.run"} <= modules.keys()


def test_a_report_loads_what_draws(here: Path) -> None:
    modules = loaded("run", "nasa-22x5.5-8pr", *COARSE, "--out", "out")
    assert among(modules, NEVER | OTHER_COMMANDS) == {}
    assert modules.keys() >= DRAWING


def test_python_knows_the_public_names_before_it_loads_them() -> None:
    code = (
        "import sys, tyrefem as tf\n"
        "tf.study, dir(tf)\n"
        "print('pandas' in sys.modules, 'tyrefem.diagnose' in sys.modules)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "False False\n"


def _shown(capfd: pytest.CaptureFixture[str], *arguments: str) -> str:
    assert main(list(arguments)) == 0
    return capfd.readouterr().out


def test_the_list_of_commands_is_that_of_the_whole_application(
    here: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    short = _shown(capfd, "--help")
    # For shell completion the whole application is made.
    monkeypatch.setenv("_TYREFEM_COMPLETE_NOT_WANTED", "1")
    assert _shown(capfd, "--help") == short
    assert "isolability" in short


@pytest.mark.parametrize("command", ["run", "thermal-card", "road", "list"])
def test_a_command_alone_is_that_of_the_whole_application(
    command: str, here: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    alone = _shown(capfd, command, "--help")
    monkeypatch.setenv("_TYREFEM_COMPLETE_NOT_WANTED", "1")
    assert _shown(capfd, command, "--help") == alone


def test_every_command_but_list_is_found_by_the_name_of_its_module() -> None:
    names = [command.name or command.callback.__name__.replace("_", "-") for command in app.registered_commands]
    names += [group.typer_instance.info.name for group in app.registered_groups]
    assert [name for name in names if _single(name) is None] == ["list"]


@pytest.mark.parametrize("name", ["new_tyre", "common", "shell", "../run", "", "--help", "no-such"])
def test_no_command_is_made_of_another_module(name: str) -> None:
    assert _single(name) is None


def test_an_unknown_command_names_the_nearest(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["diagnos"]) == 2
    assert "diagnose" in capfd.readouterr().err
