"""gmsh is a guest: quiet, optional, and it leaves no trace."""

from __future__ import annotations

import builtins
import signal
import subprocess
import sys
import threading
from typing import Any

import pytest

from tyrefem.errors import InputError, MissingLibraryError
from tyrefem.geometry import load
from tyrefem.geometry.meshing import build


@pytest.mark.parametrize(
    ("raised", "words"),
    [
        (ModuleNotFoundError("No module named 'gmsh'", name="gmsh"), r"package 'gmsh': pip install 'tyrefem\[gmsh\]'"),
        (OSError("libGLU.so.1: cannot open shared object file"), r"libGLU\.so\.1.*apt-get install.*libglu1-mesa"),
    ],
)
def test_missing_library_is_named_with_the_cure(monkeypatch: pytest.MonkeyPatch, raised: Exception, words: str) -> None:
    original = builtins.__import__

    def failing(name: str, *rest: Any, **more: Any) -> Any:
        if name in ("gmsh", "pygmsh"):
            raise raised
        return original(name, *rest, **more)

    monkeypatch.setattr(builtins, "__import__", failing)
    with pytest.raises(MissingLibraryError, match=words) as error:
        build(load("nasa-22x5.5-8pr"), mesher="gmsh")
    assert error.value.field == "mesher"


@pytest.mark.usefixtures("needs_gmsh")
def test_quiet_and_without_traces(capfd: pytest.CaptureFixture[str]) -> None:
    import gmsh

    before = signal.getsignal(signal.SIGINT)
    build(load("nasa-22x5.5-8pr"), mesher="gmsh", size=6e-3)
    assert signal.getsignal(signal.SIGINT) is before
    assert not gmsh.isInitialized()
    output = capfd.readouterr()
    assert (output.out, output.err) == ("", "")


@pytest.mark.usefixtures("needs_gmsh")
def test_a_broken_pipe_is_still_an_error_and_not_the_end() -> None:
    # In a process of its own: gmsh's own start leaves it so that it would be killed without a word.
    code = (
        "import os; from tyrefem.geometry.meshing import build; from tyrefem.geometry import load\n"
        "build(load('nasa-22x5.5-8pr'), mesher='gmsh', size=2e-2)\n"
        "there, here = os.pipe(); os.close(there)\n"
        "try: os.write(here, b'x')\n"
        "except BrokenPipeError: print('an error')"
    )
    completed = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (completed.returncode, completed.stdout) == (0, "an error\n"), completed.stderr


@pytest.mark.usefixtures("needs_gmsh")
def test_a_running_gmsh_keeps_its_model_and_options() -> None:
    import gmsh

    gmsh.initialize(interruptible=False)
    try:
        gmsh.model.add("mine")
        gmsh.option.setNumber("Mesh.Algorithm", 5)
        gmsh.option.setNumber("General.Terminal", 0)
        build(load("nasa-22x5.5-8pr"), mesher="gmsh", size=6e-3)
        assert gmsh.model.getCurrent() == "mine"
        assert gmsh.option.getNumber("Mesh.Algorithm") == 5
        assert "tyrefem section" not in gmsh.model.list()
    finally:
        gmsh.finalize()


@pytest.mark.usefixtures("needs_gmsh")
def test_works_beside_the_main_thread() -> None:
    counts: list[int] = []
    section = load("nasa-22x5.5-8pr")
    threads = [
        threading.Thread(target=lambda: counts.append(build(section, mesher="gmsh", size=6e-3).n_nodes))
        for _ in range(2)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(counts) == 2
    assert counts[0] == counts[1]


@pytest.mark.usefixtures("needs_gmsh")
def test_failure_of_gmsh_is_an_input_error(monkeypatch: pytest.MonkeyPatch) -> None:
    import gmsh

    def failing(dimension: int) -> None:
        raise Exception("Invalid boundary mesh")

    monkeypatch.setattr(gmsh.model.mesh, "generate", failing)
    with pytest.raises(InputError, match=r"gmsh cannot mesh section .*: Invalid boundary mesh"):
        build(load("nasa-22x5.5-8pr"), mesher="gmsh", size=6e-3)
    assert not gmsh.isInitialized()


def test_mapped_mesher_needs_no_gmsh() -> None:
    import subprocess

    code = (
        "import sys; from tyrefem.geometry import load; from tyrefem.geometry.meshing import build;"
        "build(load('nasa-22x5.5-8pr'), size=6e-3); sys.exit('gmsh' in sys.modules or 'pygmsh' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
