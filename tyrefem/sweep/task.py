"""One variant's work, done in a worker: build the study, run it, answer."""

from __future__ import annotations

import functools
import gc
import threading
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from tyrefem.studies import Study
from tyrefem.sweep.bundle import Bundle, Unpacked, VersionError

if TYPE_CHECKING:
    from tyrefem.rolling import RollingTyre


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


#: Tyres that a thread ran last: mesh, operators and strain cycles serve the next variant where they are the same.
REMEMBERED = 4
_recent = threading.local()


def _most_alike(study: Study) -> RollingTyre | None:
    """The tyre among the last ones from which most can be taken over."""
    tyres: list[RollingTyre] = _recent.__dict__.setdefault("tyres", [])
    return max(tyres, key=lambda tyre: _alike(study, tyre.study), default=None)


def _alike(study: Study, other: Study) -> tuple[bool, bool, int]:
    """Same section; same strain cycle as far as the study says; how many materials are the same."""
    same = [study.data.get(table) == other.data.get(table) for table in ("section", "mesh", "drive", "mechanics")]
    mine, theirs = study.data["materials"], other.data["materials"]
    return same[0] and same[1], same[2] and same[3], sum(mine[region] == theirs.get(region) for region in mine)


def _remember(tyre: RollingTyre) -> None:
    """Keep a tyre; it must not hold those before it alive."""
    object.__setattr__(tyre, "like", None)
    tyres: list[RollingTyre] = _recent.tyres
    forgotten = tyres[REMEMBERED - 1 :]
    tyres[:] = [tyre, *tyres[: REMEMBERED - 1]]
    if any(all(one.mesh is not other.mesh for other in tyres) for one in forgotten):
        # A mesh that goes takes its operators with it, tens of MB that refer to each other.
        del forgotten
        gc.collect()


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
        before = _most_alike(study)
        if before is not None:
            study = unpacked(task.packed).replace(task.changes, like=before.study)
        result = run(study, like=before)
        found = answers(result, task.time_to)
        _remember(result.tyre)
        return {"answers": found}
    except (InputError, SolverError) as error:
        return {"failure": str(error)}
    except VersionError:
        raise
    except Exception as error:  # a defect; it is named as what it is
        return {"failure": f"defect, please report: {type(error).__name__}: {error}"}
