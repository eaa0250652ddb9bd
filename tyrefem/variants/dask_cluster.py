"""Variants on a Dask cluster."""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from tyrefem.errors import InputError, MissingLibraryError
from tyrefem.variants.outcomes import Failed
from tyrefem.variants.schedulers import AHEAD, Result

#: So often a task of a cluster is run again after its worker was lost.
RETRIES = 3
#: Seconds after which a cluster is asked how large it is now.
TOP_UP = 5.0
#: Seconds between looks for finished tasks of a cluster.
POLL = 0.02


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
            from distributed.comm import get_address_host_port
        except ImportError:
            raise MissingLibraryError(
                "a cluster needs the package 'distributed': pip install 'tyrefem[cluster]'", field="--scheduler"
            ) from None
        self._own, self.patience = isinstance(client, str), patience
        if isinstance(client, str):
            address = client
            try:
                # What is no address would leave a half-made client behind, which takes its time to go.
                get_address_host_port(address)
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

        def installed() -> str:
            """Travels as code, so that a worker without the package can say so."""
            from importlib import import_module
            from importlib.util import find_spec

            return str(import_module("tyrefem").__version__) if find_spec("tyrefem") else ""

        versions = self.client.run(installed)
        wrong = {worker: version for worker, version in versions.items() if version != tyrefem.__version__}
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

    def outcomes(
        self, work: Callable[..., Result], tasks: Sequence[Any], common: Any = None
    ) -> Iterator[tuple[int, Result | Failed]]:
        """Outcomes as they come."""
        from distributed import as_completed

        shared = () if common is None else (self.client.submit(_same, common, pure=False),)
        waiting = iter(enumerate(tasks))
        places: dict[str, int] = {}
        going = as_completed(loop=self.client.loop, with_results=True, raise_errors=False)
        counted_at, most = -TOP_UP, 0
        try:
            while True:
                if time.monotonic() - counted_at > TOP_UP:
                    # Workers may have come or gone.
                    counted_at, most = time.monotonic(), AHEAD * max(self._threads(), 1)
                for place, task in itertools.islice(waiting, max(most - len(places), 0)):
                    future = self.client.submit(work, task, *shared, pure=False, retries=RETRIES)
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
                    yield place, Failed(f"lost by the cluster: {_reason(result)}")
                else:
                    raise ClusterLostError(f"the Dask scheduler at {self.address} gave up its tasks ({future.status})")
        finally:
            if self.client.status == "running":
                self.client.cancel([*going.futures, *shared])

    @property
    def workers(self) -> int:
        """Threads of all workers."""
        return max(self._threads(), 1)

    def _threads(self) -> int:
        """Threads of all workers."""
        try:
            return int(sum(self.client.nthreads().values()))
        except (OSError, RuntimeError):
            raise ClusterLostError(f"the Dask scheduler at {self.address} no longer answers") from None

    def _wait(self, going: Any) -> None:
        """Until a task is finished."""
        seen = time.monotonic()
        checked_at = seen
        while not going.has_ready():
            time.sleep(POLL)
            if time.monotonic() - checked_at > TOP_UP:
                checked_at = time.monotonic()
                if self._threads():
                    seen = checked_at
                elif checked_at - seen > self.patience:
                    raise ClusterLostError(
                        f"the Dask scheduler at {self.address} has had no worker for {checked_at - seen:.0f} s"
                    )


def _reason(result: Any) -> str:
    """What a failed task of a cluster says: an exception, or (type, exception, traceback)."""
    return str(result[1] if isinstance(result, tuple) and len(result) > 1 else result)


def _same(common: Any) -> Any:
    """A task of a cluster: its result is had again where every worker that held it is lost."""
    return common
