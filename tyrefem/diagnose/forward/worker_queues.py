"""Worker processes with a queue each: a task goes to the worker that has made what it needs."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from typing import Any

from tyrefem.processes import processes


@dataclass(frozen=True)
class HomedTask:
    """``function(*arguments)``, to be done by the worker number ``home`` (modulo the number of workers)."""

    home: int
    function: Callable[..., Any]
    arguments: tuple[Any, ...]


@dataclass(frozen=True, eq=False)
class WorkerQueues:
    """Workers that keep what they have made: simulations of a drive, for example.

    An idle worker takes the last task of the longest queue.

    Parameters
    ----------
    workers : executors of one process each.
    """

    workers: Sequence[Executor]

    def start(self, ready: Callable[[], None]) -> None:
        """Start all processes, with a first task each that is not waited for."""
        for worker in self.workers:
            worker.submit(ready)

    def results(self, tasks: Mapping[int, HomedTask]) -> Iterator[tuple[int, Any]]:
        """Yield (number of the task, result) as the results become ready."""
        queues: list[deque[int]] = [deque() for _ in self.workers]
        for number, task in tasks.items():
            queues[task.home % len(queues)].append(number)
        running: dict[Future[Any], tuple[int, int]] = {}

        def begin(place: int) -> None:
            queue = queues[place] or max(queues, key=len)
            if queue:
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
                yield number, future.result()


@contextmanager
def worker_queues(count: int) -> Iterator[WorkerQueues]:
    """``count`` new processes with a queue each; see `tyrefem.processes.processes`."""
    with ExitStack() as stack:
        yield WorkerQueues([stack.enter_context(processes(1)) for _ in range(count)])
