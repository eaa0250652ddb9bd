"""Worker processes that simulate side by side, and end quietly when their parent is interrupted."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import active_children, get_context, parent_process, resource_tracker
from typing import Any

from threadpoolctl import threadpool_limits


@contextmanager
def processes(count: int, begin: Callable[..., None] | None = None, *given: Any) -> Iterator[ProcessPoolExecutor]:
    """So many fresh processes with one thread for linear algebra each; ``begin(*given)`` starts every one.

    Ctrl-C is the parent's alone: workers never see it, even while they start, and are ended with whatever they are at
    when the parent leaves the block by an exception. They end themselves where the parent is killed.

    >>> with processes(1) as pool:
    ...     pool.submit(abs, -3).result()
    3
    """
    before = set(active_children())
    with _uninterrupted(), ProcessPoolExecutor(count, get_context("spawn"), _begin, (begin, given)) as pool:
        # The first task starts all processes; they inherit that the signal is blocked.
        pool.submit(int)
        try:
            with _interruptible():
                yield pool
        except BaseException:
            # Nobody wants the simulations that are still running. Tasks that wait are not cancelled: Python 3.11's pool
            # prints a traceback when it finds such among those whose processes have ended.
            pool.shutdown(wait=False)
            for worker in set(active_children()) - before:
                worker.terminate()
            raise


def _begin(begin: Callable[..., None] | None, given: tuple[Any, ...]) -> None:
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


@contextmanager
def _uninterrupted() -> Iterator[None]:
    """Hold Ctrl-C back until the block ends, or `_interruptible` begins."""
    # It would lift the block when it starts together with the first worker.
    resource_tracker.ensure_running()
    with _mask("SIG_BLOCK"):
        yield


@contextmanager
def _interruptible() -> Iterator[None]:
    with _mask("SIG_UNBLOCK"):
        yield


@contextmanager
def _mask(how: str) -> Iterator[None]:
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    old = signal.pthread_sigmask(getattr(signal, how), {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, old)
