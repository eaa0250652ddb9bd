"""Many cases in parallel; every finished one is kept in a file, so that an interrupted command goes on."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import as_completed
from pathlib import Path
from typing import Any

from tyrefem.interruption import interruption_delayed, keeping
from tyrefem.output import atomic_path
from tyrefem.processes import processes

Row = dict[str, Any]
#: Computes the row of a case from what all cases share, and its number.
Case = Callable[[Any, int], Row]
#: Folder of the files of finished cases.
CASES = "cases"
#: What the cases of a worker process share, and what computes one.
_WORK: list[tuple[Case, Any]] = []


def tag_for(decisive: Sequence[Any]) -> str:
    """Begin of the names of the files of cases, from all that they depend on: others share a folder, but no file."""
    text = json.dumps(list(decisive), sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()[:12]


def kept_cases(folder: Path, tag: str) -> dict[int, Row]:
    """Finished cases in ``folder`` whose files begin with ``tag``, by number."""
    rows = {}
    for path in folder.glob(f"{tag}-*.json"):
        rows[int(path.stem.split("-")[1])] = json.loads(path.read_text(encoding="utf-8"))
    return rows


def computed_cases(case: Case, shared: Any, numbers: Sequence[int], workers: int = 1) -> Iterator[tuple[int, Row]]:
    """Number and row of every case as it is finished, in ``workers`` processes."""
    if workers <= 1:
        yield from ((number, case(shared, number)) for number in numbers)
        return
    with processes(workers, _install, case, shared) as pool:
        futures = {pool.submit(_in_worker, number): number for number in numbers}
        for future in as_completed(futures):
            yield futures[future], future.result()


def keep_cases(
    rows: dict[int, Row],
    fresh: Iterator[tuple[int, Row]],
    folder: Path,
    tag: str,
    tick: Callable[[int], None] | None = None,
) -> None:
    """Add cases to ``rows`` as they are finished, each written to its file first.

    ``tick``: called with the number of rows.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for number, row in fresh:
        with interruption_delayed(), atomic_path(folder / f"{tag}-{number:05d}.json") as temporary:
            temporary.write_text(json.dumps(row), encoding="utf-8")
        rows[number] = row
        if tick:
            tick(len(rows))


def resuming(rows: dict[int, Row], count: int) -> Any:
    """Tell at an interruption how many of ``count`` cases are finished."""
    return keeping(lambda: f"{len(rows)} of {count} cases are finished; the same command resumes from there")


def _install(case: Case, shared: Any) -> None:
    _WORK[:] = [(case, shared)]


def _in_worker(number: int) -> Row:
    case, shared = _WORK[0]
    return case(shared, number)
