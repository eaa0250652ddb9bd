"""An empty folder to work in, and a command that must be refused in one line."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from tyrefem.cli import main
from tyrefem.diagnose.forward.forward_model import ForwardModel


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder that is the current one."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("TYREFEM_PATH", raising=False)
    return tmp_path


@pytest.fixture
def refused(here: Path, capfd: pytest.CaptureFixture[str]) -> Callable[..., str]:
    """Run a command that must be refused in one line, which is returned; exit code 2, nothing written."""

    def run(*arguments: str) -> str:
        before = sorted(here.rglob("*"))
        assert main(list(arguments)) == 2
        out, err = capfd.readouterr()
        assert out == ""
        assert err.startswith("tyrefem: ")
        assert err.count("\n") == 1
        assert sorted(here.rglob("*")) == before
        return err

    return run


@pytest.fixture
def no_simulation(monkeypatch: pytest.MonkeyPatch) -> None:
    """A run or a simulation of the diagnosis fails the test."""

    def never(*_arguments: object, **_options: object) -> None:
        raise AssertionError("simulated before the study was checked")

    monkeypatch.setattr(ForwardModel, "response", never)
    monkeypatch.setattr("tyrefem.simulation.simulate.simulate", never)
