"""Tasks for worker processes: apart, so that a worker imports no more than this to begin."""

from __future__ import annotations

import os
import signal
import tempfile
from pathlib import Path
from typing import Any


def squared(task: Any) -> dict[str, Any]:
    return {"answers": {"x": float(task) ** 2}}


def dies_the_first_time(task: tuple[int, str]) -> dict[str, Any]:
    number, folder = task
    if number == 3:
        mark = Path(folder) / "died"
        if not mark.exists():
            mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)
    return {"answers": {"x": float(number)}}


def always_dies(task: int) -> dict[str, Any]:
    if task == 2:
        os.kill(os.getpid(), signal.SIGKILL)
    return {"answers": {"x": float(task)}}


def added(task: int, common: list[float]) -> dict[str, Any]:
    return {"answers": {"x": task + common[0], "process": os.getpid()}}


def kept_file(task: int) -> str:
    """A temporary file that the worker does not remove."""
    return tempfile.mkstemp(suffix=str(task))[1]
