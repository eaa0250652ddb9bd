"""Worker processes with a queue each: a task goes to the worker that has made what it needs."""

from __future__ import annotations

import importlib
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from typing import Any, TypeVar

from tyrefem.processes import processes

T = TypeVar("T")


@dataclass(frozen=True)
class HomedTask:
    """``function(*arguments)``, to be done by the worker number ``home`` (modulo the number of workers).

    ``stays``: another worker, even an idle one, would take longer.
    """

    home: int
    function: Callable[..., Any]
    arguments: tuple[Any, ...]
    stays: bool = False


@dataclass(frozen=True, eq=False)
class WorkerQueues:
    """Workers that keep what they have made: simulations of a drive, for example.

    An idle worker takes the last task of the longest queue, unless the task stays.

    Parameters
    ----------
    workers : executors of one process each.
    """

    workers: Sequence[Executor]

    @property
    def count(self) -> int:
        """Number of workers."""
        return len(self.workers)

    def load(self, module: str, first: int = 0, last: int | None = None) -> None:
        """Let the processes ``first`` to ``last`` (exclusive; None: all others) import a module; do not wait."""
        for worker in self.workers[first:last]:
            worker.submit(_load, module)

    def results(self, tasks: Mapping[int, HomedTask]) -> Iterator[tuple[int, int, Any]]:
        """Yield (number of the task, number of its worker, result) as the results become ready."""
        queues: list[deque[int]] = [deque() for _ in self.workers]
        for number, task in tasks.items():
            queues[task.home % len(queues)].append(number)
        running: dict[Future[Any], tuple[int, int]] = {}

        def begin(place: int) -> None:
            queue = queues[place] or max(queues, key=len)
            if queue and (queue is queues[place] or not tasks[queue[-1]].stays):
                number = queue.popleft() if queue is queues[place] else queue.pop()
                future = self.workers[place].submit(tasks[number].function, *tasks[number].arguments)
                running[future] = number, place

        for place in range(len(queues)):
            begin(place)
        while running:
            finished, _ = wait(running, return_when=FIRST_COMPLETED)
            for future in finished:
                number, place = running.pop(future)
                begin(place)
                yield number, place, future.result()


#: What workers of a diagnosis import while their parent imports modules of its own.
EVALUATIONS = "tyrefem.diagnose.forward.evaluations"


def _load(module: str) -> None:
    importlib.import_module(module)


#: A number of processes, or processes that are already started.
Workers = int | WorkerQueues


def number_of(workers: Workers) -> int:
    """The number of processes.

    >>> number_of(3)
    3
    """
    return workers if isinstance(workers, int) else workers.count


def begun(workers: Workers, function: Callable[..., T], *arguments: Any) -> Callable[[], T]:
    """Begin ``function(*arguments)`` in the first of the processes; returns a function that waits for the result.

    Without processes the result is computed when it is asked for.

    >>> begun(1, max, 2, 3)()
    3
    """
    if isinstance(workers, int):
        return lambda: function(*arguments)
    return workers.workers[0].submit(function, *arguments).result


@contextmanager
def worker_queues(count: int) -> Iterator[WorkerQueues]:
    """``count`` new processes with a queue each; see `tyrefem.processes.processes`."""
    with ExitStack() as stack:
        workers = [stack.enter_context(processes(1)) for _ in range(count)]
        yield WorkerQueues(workers)
        for worker in workers:  # all end at once; the stack waits for one after the other
            worker.shutdown(wait=False)


@contextmanager
def started_workers(count: int, at_once: int | None = None) -> Iterator[Workers]:
    """``count`` processes that begin to import what they need; 1 if one process is enough.

    ``at_once``: so many begin now, the others with `start_others`; None: all.
    """
    if count == 1:
        yield 1
        return
    with worker_queues(count) as queues:
        queues.load(EVALUATIONS, last=at_once)
        yield queues


def start_others(workers: Workers, at_once: int) -> None:
    """Let the processes begin to import that `started_workers` did not start at once.

    While there are fewer cores than processes, each import would take that much longer, also that of the parent, on
    which all others wait.
    """
    if not isinstance(workers, int):
        workers.load(EVALUATIONS, first=at_once)
