"""Schedulers: variants run in this process or in several processes of this machine; outcomes come as they finish."""

from __future__ import annotations

import hashlib
import pickle
import tempfile
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from numbers import Integral
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from tyrefem.cache import Cache
from tyrefem.errors import InputError
from tyrefem.processes import processes
from tyrefem.variants.outcomes import Failed

if TYPE_CHECKING:
    from concurrent.futures import Executor, Future

Result = TypeVar("Result")
#: Submitted tasks per worker: enough to keep it busy, few enough to limit memory and the loss with a worker.
AHEAD = 4


class Scheduler(Protocol):
    """Runs ``work(task)`` for every task; yields (place of the task, result) in the order in which tasks finish.

    A task that ends its worker process gives `Failed`. ``common`` is large data for all tasks, sent once per worker;
    with it ``work(task, common)`` is called. An attribute ``workers`` may state the number of parallel tasks.
    """

    def outcomes(
        self, work: Callable[..., Result], tasks: Sequence[Any], common: Any = None
    ) -> Iterator[tuple[int, Result | Failed]]:
        """Outcomes in the order in which tasks finish."""
        ...


class Here:
    """Runs tasks one after the other in this process."""

    workers = 1

    def outcomes(
        self, work: Callable[..., Result], tasks: Sequence[Any], common: Any = None
    ) -> Iterator[tuple[int, Result | Failed]]:
        """Outcomes in the order of the tasks."""
        for place, task in enumerate(tasks):
            yield place, work(task) if common is None else work(task, common)


class Local:
    """Runs tasks in ``workers`` processes of this machine. A task whose process dies is repeated once, alone.

    As a context manager it keeps its processes, and their assembled operators, from call to call.

    Raises
    ------
    InputError : ``workers`` is no whole number of at least 1.
    """

    def __init__(self, workers: int) -> None:
        if isinstance(workers, bool) or not isinstance(workers, Integral) or workers < 1:
            raise InputError(f"must be a whole number of at least 1, not {workers!r:.60}", field="workers")
        self.workers: int = int(workers)
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
        """Outcomes in the order in which tasks finish."""
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
                    # One of the running tasks ended its process and the pool; it is unknown which, so run each alone.
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
        """Discard a broken pool of processes."""
        self._pool = None
        if self._kept is not None:
            self._kept.close()


def _alone(work: Callable[..., Result], task: Any, file: str | None) -> Result | Failed:
    from concurrent.futures.process import BrokenProcessPool

    with processes(1) as pool:
        try:
            return pool.submit(_worked, work, task, file).result()
        except BrokenProcessPool:
            return Failed("its process died twice, the second time alone (out of memory?)")


@contextmanager
def _filed(common: Any) -> Iterator[str | None]:
    """A temporary file with the data common to all tasks, named by its digest; None without data."""
    if common is None:
        yield None
        return
    with tempfile.TemporaryDirectory(prefix="tyrefem-") as folder:
        content = pickle.dumps(common)
        path = Path(folder) / hashlib.sha256(content).hexdigest()
        path.write_bytes(content)
        yield str(path)


#: Digest -> common data of the tasks that a process works on.
_common: Cache[Any] = Cache(1)


def _worked(work: Callable[..., Result], task: Any, file: str | None) -> Result:
    if file is None:
        return work(task)
    path = Path(file)
    return work(task, _common.get(path.name, lambda: pickle.loads(path.read_bytes())))
