"""One variant's work, done in a worker: build the study, run it, answer."""

from __future__ import annotations

import functools
import threading
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from tyrefem.studies import Study
from tyrefem.sweep.bundle import Bundle, Unpacked, VersionError


@dataclass(frozen=True)
class Task:
    """A variant to run.

    Parameters
    ----------
    number : of the variant. packed : the study. changes : what the variant changes. time_to : see `answers`.
    """

    number: int
    packed: Bundle
    changes: Mapping[str, Any]
    time_to: float | None = None


@functools.cache
def _shelf() -> Unpacked:
    """Of this process."""
    return Unpacked()


def unpacked(packed: Bundle) -> Study:
    """The study of a bundle, unpacked once in this process."""
    return _shelf().study(packed)


#: The tyre that this thread ran last: its mesh and operators serve the next variant where they are the same.
_last = threading.local()


def perform_all(tasks: Sequence[Task]) -> dict[str, Any]:
    """``{"outcomes": [...]}``: several variants one after the other."""
    return {"outcomes": [perform(task) for task in tasks]}


def perform(task: Task) -> dict[str, Any]:
    """``{"answers": {...}}``, or ``{"failure": reason}``: one variant's failure must not cost the others."""
    from tyrefem.conduction import SolverError
    from tyrefem.errors import InputError
    from tyrefem.rolling import run
    from tyrefem.sweep.answers import answers

    try:
        study = unpacked(task.packed).replace(task.changes)
        before = getattr(_last, "tyre", None)
        result = run(study, like=before)
        _last.tyre = result.tyre
        if result.history.interrupted:
            raise KeyboardInterrupt
        return {"answers": answers(result, task.time_to)}
    except (InputError, SolverError) as error:
        return {"failure": str(error)}
    except VersionError:
        raise
    except Exception as error:  # a defect; it is named as what it is
        return {"failure": f"defect, please report: {type(error).__name__}: {error}"}
