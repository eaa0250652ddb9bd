"""Where variants run: this process, local processes, or a Dask cluster. All give outcomes as they are finished."""

from __future__ import annotations

import itertools
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from typing import Any, Protocol

from tyrefem.errors import InputError, MissingLibraryError
from tyrefem.processes import processes

Outcome = dict[str, Any]
Work = Callable[[Any], Outcome]
#: So often a task of a cluster is run again after its worker was lost.
RETRIES = 3
#: Seconds after which a cluster is asked how large it is now.
TOP_UP = 5.0
#: Tasks in flight per worker: enough to keep it busy, few enough that memory and a lost worker cost little.
AHEAD = 4


class Scheduler(Protocol):
    """Runs ``work(task)`` for every task; yields (place of the task, outcome) in the order they are finished."""

    def outcomes(self, work: Work, tasks: Sequence[Any]) -> Iterator[tuple[int, Outcome]]:
        """Outcomes as they come."""
        ...


class Here:
    """One after the other in this process."""

    def outcomes(self, work: Work, tasks: Sequence[Any]) -> Iterator[tuple[int, Outcome]]:
        """Outcomes in the order of the tasks."""
        for place, task in enumerate(tasks):
            yield place, work(task)


class Local:
    """So many processes of this machine. A task whose process dies is tried once more, alone."""

    def __init__(self, workers: int) -> None:
        self.workers = workers

    def outcomes(self, work: Work, tasks: Sequence[Any]) -> Iterator[tuple[int, Outcome]]:
        """Outcomes as they come."""
        from concurrent.futures.process import BrokenProcessPool

        left = dict.fromkeys(range(len(tasks)))
        while left:
            running: dict[Any, int] = {}
            try:
                for place, outcome in self._together(work, tasks, list(left), running):
                    del left[place]
                    yield place, outcome
            except BrokenProcessPool:
                # One of these took its process, and with it the pool, down: nobody knows which.
                for place in sorted(running.values()):
                    del left[place]
                    yield place, _alone(work, tasks[place])

    def _together(
        self, work: Work, tasks: Sequence[Any], places: list[int], running: dict[Any, int]
    ) -> Iterator[tuple[int, Outcome]]:
        from concurrent.futures import FIRST_COMPLETED, wait

        waiting = deque(places)
        with processes(min(self.workers, len(places))) as pool:
            while waiting or running:
                while waiting and len(running) < self.workers * AHEAD:
                    place = waiting.popleft()
                    running[pool.submit(work, tasks[place])] = place
                for future in wait(running, return_when=FIRST_COMPLETED).done:
                    outcome = future.result()
                    yield running.pop(future), outcome


def _alone(work: Work, task: Any) -> Outcome:
    from concurrent.futures.process import BrokenProcessPool

    with processes(1) as pool:
        try:
            outcome: Outcome = pool.submit(work, task).result()
        except BrokenProcessPool:
            return {"failure": "its process died, alone too (out of memory?)"}
    return outcome


class Dask:
    """A Dask cluster: ``tcp://host:port`` of a scheduler, or a `distributed.Client`.

    A task whose worker dies is run again by another one; tasks are pure, so nothing is computed wrongly. What the
    cluster lost for good counts as failed, with the reason.

    Raises
    ------
    MissingLibraryError : distributed is not installed. InputError : no scheduler answers there.
    """

    def __init__(self, client: Any, timeout: float = 20.0) -> None:
        try:
            from distributed import Client
        except ImportError:
            raise MissingLibraryError(
                "a cluster needs the package 'distributed': pip install 'tyrefem[cluster]'", field="--scheduler"
            ) from None
        self._own = isinstance(client, str)
        if isinstance(client, str):
            try:
                client = Client(client, timeout=timeout, set_as_default=False)
            except (OSError, ValueError) as error:
                raise InputError(f"no Dask scheduler at '{client}': {error}", field="--scheduler") from None
        self.client = client

    def outcomes(self, work: Work, tasks: Sequence[Any]) -> Iterator[tuple[int, Outcome]]:
        """Outcomes as they come."""
        from distributed import as_completed

        waiting = iter(enumerate(tasks))
        places: dict[str, int] = {}
        going = as_completed()
        asked, most = -TOP_UP, 0
        try:
            while True:
                if time.monotonic() - asked > TOP_UP:
                    # Workers may have come or gone.
                    asked, most = time.monotonic(), AHEAD * max(sum(self.client.nthreads().values()), 1)
                for place, task in itertools.islice(waiting, max(most - len(places), 0)):
                    future = self.client.submit(work, task, pure=False, retries=RETRIES)
                    places[future.key] = place
                    going.add(future)
                if not places:
                    return
                future = next(going)
                place = places.pop(future.key)
                if future.status == "finished":
                    yield place, future.result()
                else:
                    yield place, {"failure": f"lost by the cluster: {future.exception()}"}
        finally:
            self.client.cancel(list(going.futures))
            if self._own:
                self.client.close()
