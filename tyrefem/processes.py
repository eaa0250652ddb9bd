"""Worker processes that simulate side by side, and end quietly when their parent is interrupted."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager, suppress
from multiprocessing import active_children, parent_process, resource_tracker
from multiprocessing.context import SpawnContext, SpawnProcess
from typing import Any

from threadpoolctl import threadpool_limits

from tyrefem.interruption import held_back


class _DeafProcess(SpawnProcess):
    """A process that never sees Ctrl-C, not even while it starts: it is the parent's alone."""

    def start(self) -> None:
        """Start it with the signal blocked, which it inherits."""
        # A tracker that starts together with it would lift the block.
        resource_tracker.ensure_running()
        with _blocked():
            super().start()


class _Context(SpawnContext):
    Process = _DeafProcess


@contextmanager
def processes(count: int, begin: Callable[..., None] | None = None, *given: Any) -> Iterator[ProcessPoolExecutor]:
    """So many fresh processes with one thread for linear algebra each; ``begin(*given)`` starts every one.

    Ctrl-C is the parent's alone: workers never see it, and are ended with whatever they are at when the parent leaves
    the block by an exception. They end themselves where the parent is killed.

    >>> with processes(1) as pool:
    ...     pool.submit(abs, -3).result()
    3
    """
    before = set(active_children())
    pool = ProcessPoolExecutor(count, _Context(), _begin, (begin, given))
    try:
        yield pool
        pool.shutdown()
    except BaseException:
        with held_back():
            # Nobody wants the simulations that are still running. Tasks that wait are not cancelled: Python 3.11's pool
            # prints a traceback when it finds such among those whose processes have ended.
            pool.shutdown(wait=False)
            for worker in set(active_children()) - before:
                worker.terminate()
        raise


def _begin(begin: Callable[..., None] | None, given: tuple[Any, ...]) -> None:
    # Where a signal cannot be blocked, as on Windows, it is ignored at least.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()
    threadpool_limits(1, user_api="blas")
    if begin is not None:
        begin(*given)


def _end_with_parent() -> None:
    """A parent that was killed cannot end its workers: they see to it themselves."""
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def end_children() -> None:
    """End every process that this one has started by `multiprocessing`; for a parent that is about to leave."""
    for child in active_children():
        with suppress(OSError):
            child.terminate()


@contextmanager
def _blocked() -> Iterator[None]:
    """Block Ctrl-C for this thread, and for what it starts."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    old = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, old)
