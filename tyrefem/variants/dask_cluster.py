"""Variants on a Dask cluster."""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from tyrefem.errors import InputError, MissingLibraryError
from tyrefem.variants.outcomes import Failed
from tyrefem.variants.schedulers import AHEAD, Result

#: A task is repeated so many times after its worker was lost.
RETRIES = 3
#: Interval at which the number of workers is checked, s.
TOP_UP = 5.0
#: Interval at which finished tasks are collected, s.
POLL = 0.02


class ClusterLostError(Exception):
    """The connection to the cluster is lost; finished variants are kept."""


class Dask:
    """A Dask cluster: ``tcp://host:port`` of a scheduler, or a `distributed.Client`.

    A task whose worker dies runs again on another worker; tasks are pure, so results do not change. A task that
    repeatedly ends its worker counts as failed, with the reason.

    Parameters
    ----------
    client : address or client. timeout : s, for the scheduler and its first worker. patience : s without any worker.

    Raises
    ------
    MissingLibraryError : distributed is not installed. InputError : no scheduler at the address, or no workers.
    ClusterLostError : from `outcomes`: the scheduler no longer answers, or all workers are lost.
    """

    def __init__(self, client: Any, timeout: float = 20.0, patience: float = 120.0) -> None:
        try:
            from distributed import Client
            from distributed.comm import get_address_host_port
        except ImportError:
            raise MissingLibraryError(
                "a cluster needs the package 'distributed': pip install 'tyrefem[cluster]'", field="--scheduler"
            ) from None
        self._owns_client, self.patience = isinstance(client, str), patience
        if isinstance(client, str):
            address = client
            try:
                # Check the address first: a client of a bad address closes slowly.
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
            """Version of tyrefem on a worker; sent as code, so that it works without the package."""
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
        """Disconnect, unless the client was given."""
        if self._owns_client:
            self.client.close()

    def outcomes(
        self, work: Callable[..., Result], tasks: Sequence[Any], common: Any = None
    ) -> Iterator[tuple[int, Result | Failed]]:
        """Outcomes in the order in which tasks finish."""
        from distributed import as_completed

        shared = () if common is None else (self.client.submit(_same, common, pure=False),)
        waiting = iter(enumerate(tasks))
        places: dict[str, int] = {}
        running = as_completed(loop=self.client.loop, with_results=True, raise_errors=False)
        counted_at, most = -TOP_UP, 0
        try:
            while True:
                if time.monotonic() - counted_at > TOP_UP:
                    # The number of workers may have changed.
                    counted_at, most = time.monotonic(), AHEAD * max(self._threads(), 1)
                for place, task in itertools.islice(waiting, max(most - len(places), 0)):
                    future = self.client.submit(work, task, *shared, pure=False, retries=RETRIES)
                    places[future.key] = place
                    running.add(future)
                if not places:
                    return
                self._wait(running)
                # Results are fetched in the background; a result that is lost with its worker is computed again.
                future, result = next(running)
                place = places.pop(future.key)
                if future.status == "cancelled":
                    raise ClusterLostError(f"the Dask scheduler at {self.address} gave up its tasks ({future.status})")
                yield place, outcome_of(future.status, result)
        finally:
            if self.client.status == "running":
                self.client.cancel([*running.futures, *shared])

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

    def _wait(self, running: Any) -> None:
        """Wait until a task is finished."""
        last_seen = time.monotonic()
        checked_at = last_seen
        while not running.has_ready():
            time.sleep(POLL)
            if time.monotonic() - checked_at > TOP_UP:
                checked_at = time.monotonic()
                if self._threads():
                    last_seen = checked_at
                elif checked_at - last_seen > self.patience:
                    raise ClusterLostError(
                        f"the Dask scheduler at {self.address} has had no worker for {checked_at - last_seen:.0f} s"
                    )


def outcome_of(status: str, result: Any) -> Any:
    """The outcome of a task that was not cancelled, with the result that was fetched.

    A result is there also if its worker was lost after it was fetched: the status is then "lost", or "pending".

    >>> outcome_of("lost", 3.0), outcome_of("error", (ValueError, ValueError("killed"), None)).reason
    (3.0, 'lost by the cluster: killed')
    """
    return Failed(f"lost by the cluster: {_reason(result)}") if status == "error" else result


def _reason(result: Any) -> str:
    """Reason of a failed task, from an exception or (type, exception, traceback)."""
    return str(result[1] if isinstance(result, tuple) and len(result) > 1 else result)


def _same(common: Any) -> Any:
    """A task that returns its argument: the cluster recomputes it if all workers that hold it are lost."""
    return common
