"""Where variants run: this process or several of this machine. All give outcomes as they are finished."""

from __future__ import annotations

import hashlib
import pickle
import tempfile
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from tyrefem.cache import Cache
from tyrefem.processes import processes
from tyrefem.variants.outcomes import Failed

if TYPE_CHECKING:
    from concurrent.futures import Executor, Future

Result = TypeVar("Result")
#: Tasks in flight per worker: enough to keep it busy, few enough that memory and a lost worker cost little.
AHEAD = 4


class Scheduler(Protocol):
    """Runs ``work(task)`` for every task; yields (place of the task, result) in the order they are finished.

    The result of a task that took its worker down with it is `Failed`. With ``common``, something large that all tasks
    need, ``work(task, common)``: it travels once per worker. One that runs several tasks at a time may say so by
    ``workers``.
    """

    def outcomes(
        self, work: Callable[..., Result], tasks: Sequence[Any], common: Any = None
    ) -> Iterator[tuple[int, Result | Failed]]:
        """Outcomes as they come."""
        ...


class Here:
    """One after the other in this process."""

    workers = 1

    def outcomes(
        self, work: Callable[..., Result], tasks: Sequence[Any], common: Any = None
    ) -> Iterator[tuple[int, Result | Failed]]:
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

    def outcomes(
        self, work: Callable[..., Result], tasks: Sequence[Any], common: Any = None
    ) -> Iterator[tuple[int, Result | Failed]]:
        """Outcomes as they come."""
        from concurrent.futures.process import BrokenProcessPool

        left = dict.fromkeys(range(len(tasks)))
        with _filed(common) as file:
            while left:
                running: dict[Future[Result], int] = {}
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
        self,
        work: Callable[..., Result],
        tasks: Sequence[Any],
        places: list[int],
        running: dict[Future[Result], int],
        file: str | None,
    ) -> Iterator[tuple[int, Result]]:
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


def _alone(work: Callable[..., Result], task: Any, file: str | None) -> Result | Failed:
    from concurrent.futures.process import BrokenProcessPool

    with processes(1) as pool:
        try:
            return pool.submit(_worked, work, task, file).result()
        except BrokenProcessPool:
            return Failed("its process died, alone too (out of memory?)")


@contextmanager
def _filed(common: Any) -> Iterator[str | None]:
    """A file from which processes of this machine read what is common to all tasks; its name tells its content."""
    if common is None:
        yield None
        return
    with tempfile.TemporaryDirectory(prefix="tyrefem-") as folder:
        content = pickle.dumps(common)
        path = Path(folder) / hashlib.sha256(content).hexdigest()
        path.write_bytes(content)
        yield str(path)


#: What is common to the tasks that a process works on, by its digest.
_common: Cache[Any] = Cache(1)


def _worked(work: Callable[..., Result], task: Any, file: str | None) -> Result:
    if file is None:
        return work(task)
    path = Path(file)
    return work(task, _common.get(path.name, lambda: pickle.loads(path.read_bytes())))
