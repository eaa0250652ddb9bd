"""Where variants run: this process or several of this machine. All give outcomes as they are finished."""

from __future__ import annotations

import functools
import pickle
import tempfile
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from tyrefem.processes import processes

if TYPE_CHECKING:
    from concurrent.futures import Executor

Outcome = dict[str, Any]
Work = Callable[..., Outcome]
#: Tasks in flight per worker: enough to keep it busy, few enough that memory and a lost worker cost little.
AHEAD = 4


class Scheduler(Protocol):
    """Runs ``work(task)`` for every task; yields (place of the task, outcome) in the order they are finished.

    With ``common``, something large that all tasks need, ``work(task, common)``: it travels once per worker.
    One that runs several tasks at a time may say so by ``workers``.
    """

    def outcomes(self, work: Work, tasks: Sequence[Any], common: Any = None) -> Iterator[tuple[int, Outcome]]:
        """Outcomes as they come."""
        ...


class Here:
    """One after the other in this process."""

    workers = 1

    def outcomes(self, work: Work, tasks: Sequence[Any], common: Any = None) -> Iterator[tuple[int, Outcome]]:
        """Outcomes in the order of the tasks."""
        for place, task in enumerate(tasks):
            yield place, work(task) if common is None else work(task, common)


class Local:
    """So many processes of this machine. A task whose process dies is tried once more, alone.

    As a context manager it keeps its processes from one call to the next, with what they have assembled.
    """

    def __init__(self, workers: int) -> None:
        self.workers = workers
        self._kept: ExitStack | None = None
        self._pool: Executor | None = None

    def __enter__(self) -> Local:
        self._kept = ExitStack()
        return self

    def __exit__(self, *raised: Any) -> None:
        kept, self._kept, self._pool = self._kept, None, None
        if kept is not None:
            kept.__exit__(*raised)

    def outcomes(self, work: Work, tasks: Sequence[Any], common: Any = None) -> Iterator[tuple[int, Outcome]]:
        """Outcomes as they come."""
        from concurrent.futures.process import BrokenProcessPool

        left = dict.fromkeys(range(len(tasks)))
        with _filed(common) as file:
            while left:
                running: dict[Any, int] = {}
                try:
                    for place, outcome in self._together(work, tasks, list(left), running, file):
                        del left[place]
                        yield place, outcome
                except BrokenProcessPool:
                    self._broken()
                    # One of these took its process, and with it the pool, down: nobody knows which.
                    for place in sorted(running.values()):
                        del left[place]
                        yield place, _alone(work, tasks[place], file)

    def _together(
        self, work: Work, tasks: Sequence[Any], places: list[int], running: dict[Any, int], file: str | None
    ) -> Iterator[tuple[int, Outcome]]:
        from concurrent.futures import FIRST_COMPLETED, wait

        waiting = deque(places)
        with self._processes(len(places)) as pool:
            while waiting or running:
                while waiting and len(running) < self.workers * AHEAD:
                    place = waiting.popleft()
                    running[pool.submit(_worked, work, tasks[place], file)] = place
                for future in wait(running, return_when=FIRST_COMPLETED).done:
                    outcome = future.result()
                    yield running.pop(future), outcome

    @contextmanager
    def _processes(self, tasks: int) -> Iterator[Executor]:
        if self._kept is None:
            with processes(min(self.workers, tasks)) as pool:
                yield pool
            return
        if self._pool is None:
            self._pool = self._kept.enter_context(processes(self.workers))
        yield self._pool

    def _broken(self) -> None:
        """Forget processes that are of no more use."""
        self._pool = None
        if self._kept is not None:
            self._kept.close()


def _alone(work: Work, task: Any, file: str | None) -> Outcome:
    from concurrent.futures.process import BrokenProcessPool

    with processes(1) as pool:
        try:
            outcome: Outcome = pool.submit(_worked, work, task, file).result()
        except BrokenProcessPool:
            return {"failure": "its process died, alone too (out of memory?)"}
    return outcome


@contextmanager
def _filed(common: Any) -> Iterator[str | None]:
    """A file from which processes of this machine read what is common to all tasks."""
    if common is None:
        yield None
        return
    with tempfile.TemporaryDirectory(prefix="tyrefem-") as folder:
        path = Path(folder) / "common"
        path.write_bytes(pickle.dumps(common))
        yield str(path)


def _worked(work: Work, task: Any, file: str | None) -> Outcome:
    return work(task) if file is None else work(task, _read(file))


@functools.lru_cache(maxsize=1)
def _read(file: str) -> Any:
    return pickle.loads(Path(file).read_bytes())
