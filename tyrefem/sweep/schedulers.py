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
#: Seconds between looks for finished tasks of a cluster.
POLL = 0.02


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


class ClusterLostError(Exception):
    """The cluster is gone; what it had finished is kept by whoever asked."""


class Dask:
    """A Dask cluster: ``tcp://host:port`` of a scheduler, or a `distributed.Client`.

    A task whose worker dies is run again by another one; tasks are pure, so nothing is computed wrongly. A task that
    takes its worker down again and again counts as failed, with the reason.

    Parameters
    ----------
    client : address or client. timeout : s, for the scheduler and its first worker. patience : s without any worker.

    Raises
    ------
    MissingLibraryError : distributed is not installed. InputError : no scheduler answers there, or it has no workers.
    ClusterLostError : from `outcomes`: the scheduler no longer answers, or all workers are gone.
    """

    def __init__(self, client: Any, timeout: float = 20.0, patience: float = 120.0) -> None:
        try:
            from distributed import Client
        except ImportError:
            raise MissingLibraryError(
                "a cluster needs the package 'distributed': pip install 'tyrefem[cluster]'", field="--scheduler"
            ) from None
        self._own, self.patience = isinstance(client, str), patience
        if isinstance(client, str):
            address = client
            try:
                client = Client(address, timeout=timeout, set_as_default=False)
            except (OSError, ValueError) as error:
                raise InputError(f"no Dask scheduler at '{address}': {error}", field="--scheduler") from None
        self.client, self.address = client, str(client.scheduler.address)
        try:
            client.wait_for_workers(1, timeout=timeout)
        except TimeoutError:
            self.close()
            raise InputError(
                f"the Dask scheduler at '{self.address}' has no worker; start some: dask worker {self.address}",
                field="--scheduler",
            ) from None
        self._check_versions()

    def _check_versions(self) -> None:
        import tyrefem

        def version() -> str:
            """Travels as code, so that a worker without the package can say so."""
            from importlib import import_module
            from importlib.util import find_spec

            return str(import_module("tyrefem").__version__) if find_spec("tyrefem") else ""

        found = self.client.run(version)
        wrong = {worker: version for worker, version in found.items() if version != tyrefem.__version__}
        if wrong:
            worker, version = next(iter(wrong.items()))
            self.close()
            raise InputError(
                f"worker {worker} has {f'tyrefem {version}' if version else 'no tyrefem'}, this is"
                f" {tyrefem.__version__}; install the same version everywhere",
                field="--scheduler",
            )

    def close(self) -> None:
        """Leave the cluster, if the connection is our own."""
        if self._own:
            self.client.close()

    def outcomes(self, work: Work, tasks: Sequence[Any]) -> Iterator[tuple[int, Outcome]]:
        """Outcomes as they come."""
        from distributed import as_completed

        waiting = iter(enumerate(tasks))
        places: dict[str, int] = {}
        going = as_completed(loop=self.client.loop, with_results=True, raise_errors=False)
        asked, most = -TOP_UP, 0
        try:
            while True:
                if time.monotonic() - asked > TOP_UP:
                    # Workers may have come or gone.
                    asked, most = time.monotonic(), AHEAD * max(self._threads(), 1)
                for place, task in itertools.islice(waiting, max(most - len(places), 0)):
                    future = self.client.submit(work, task, pure=False, retries=RETRIES)
                    places[future.key] = place
                    going.add(future)
                if not places:
                    return
                self._wait(going)
                # Results are fetched in the background: one whose worker has died meanwhile is computed again.
                future, result = next(going)
                place = places.pop(future.key)
                if future.status == "finished":
                    yield place, result
                elif future.status == "error":
                    yield place, {"failure": f"lost by the cluster: {_reason(result)}"}
                else:
                    raise ClusterLostError(f"the Dask scheduler at {self.address} gave up its tasks ({future.status})")
        finally:
            if self.client.status == "running":
                self.client.cancel(list(going.futures))

    def _threads(self) -> int:
        """Threads of all workers."""
        try:
            return int(sum(self.client.nthreads().values()))
        except (OSError, RuntimeError):
            raise ClusterLostError(f"the Dask scheduler at {self.address} no longer answers") from None

    def _wait(self, going: Any) -> None:
        """Until a task is finished."""
        seen = time.monotonic()
        asked = seen
        while not going.has_ready():
            time.sleep(POLL)
            if time.monotonic() - asked > TOP_UP:
                asked = time.monotonic()
                if self._threads():
                    seen = asked
                elif asked - seen > self.patience:
                    raise ClusterLostError(
                        f"the Dask scheduler at {self.address} has had no worker for {asked - seen:.0f} s"
                    )


def _reason(result: Any) -> str:
    """What a failed task of a cluster says: an exception, or (type, exception, traceback)."""
    return str(result[1] if isinstance(result, tuple) and len(result) > 1 else result)
