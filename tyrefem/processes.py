"""Worker processes for simultaneous simulations, which end silently when their parent is interrupted."""

from __future__ import annotations

import gc
import os
import shutil
import signal
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, ProcessPoolExecutor
from contextlib import contextmanager, suppress
from multiprocessing import active_children, current_process, parent_process, resource_tracker, util
from multiprocessing.context import SpawnContext, SpawnProcess
from typing import Any

from threadpoolctl import threadpool_limits

from tyrefem.interruption import interruption_delayed
from tyrefem.threads import VARIABLES

#: Python's option that hides the tracker's warning.
LEFT_BEHIND = "ignore:resource_tracker:UserWarning"


#: New objects that start a collection of garbage.
GARBAGE = 100_000
#: Priority of what a worker does last.
LAST = -1000
#: Environment variable with which Python does not look for modules in the current folder.
SAFE_PATH = "PYTHONSAFEPATH"
#: Exit code of a worker that would start workers while it imports its parent's script.
UNGUARDED = 78


class _ProcessWithoutCtrlC(SpawnProcess):
    """A process that never receives Ctrl-C, not even during its start: only the parent does."""

    def start(self) -> None:
        """Start it with the signal blocked; the process inherits this."""
        with _blocked(), _standard_modules():
            super().start()
        _STARTED.add(self)


#: Workers of this process whose end was not yet looked at.
_STARTED: set[_ProcessWithoutCtrlC] = set()


class _Context(SpawnContext):
    Process = _ProcessWithoutCtrlC


@contextmanager
def processes(count: int, begin: Callable[..., None] | None = None, *given: Any) -> Iterator[ProcessPoolExecutor]:
    """``count`` new processes with one thread for linear algebra each; every one starts with ``begin(*given)``.

    Only the parent receives Ctrl-C. If the parent leaves the block by an exception, workers are terminated, even during
    a simulation. If the parent is killed, they end themselves. Their temporary files are removed after them.

    Raises
    ------
    RuntimeError : a worker, which imports the script that started it, came to the same place of the script.

    >>> with processes(1) as pool:
    ...     pool.submit(abs, -3).result()
    3
    """
    if getattr(current_process(), "_inheriting", False):
        os._exit(UNGUARDED)
    before = set(active_children())
    _start_tracker()
    # An ended worker removes nothing itself. A file that is still open stays, as on Windows.
    folder = tempfile.TemporaryDirectory(prefix="tyrefem-", ignore_cleanup_errors=True)
    pool = ProcessPoolExecutor(count, _Context(), _begin, (folder.name, begin, given))
    try:
        yield pool
        pool.shutdown()
    except BaseException as error:
        unguarded = isinstance(error, BrokenExecutor) and UNGUARDED in _exit_codes()
        with interruption_delayed():
            # Running simulations are no longer needed. Waiting tasks are not cancelled: Python 3.11's pool
            # prints a traceback for cancelled tasks of ended processes.
            pool.shutdown(wait=False)
            for worker in set(active_children()) - before:
                worker.terminate()
        if unguarded:
            message = 'a script whose work has several processes needs it under: if __name__ == "__main__":'
            raise RuntimeError(message) from None
        raise
    finally:
        with interruption_delayed():
            folder.cleanup()
        _STARTED.difference_update([each for each in _STARTED if each.exitcode is not None])


def _exit_codes() -> list[int | None]:
    """Exit codes of the workers of a broken pool. Its thread waits for them, too: only one of both sees the exit."""
    until = time.monotonic() + 2.0
    while (codes := [each.exitcode for each in _STARTED]) and None in codes and time.monotonic() < until:
        time.sleep(0.02)
    return codes


def _start_tracker() -> None:
    """Start the process that removes what this one leaves behind, without its warning.

    An interrupted process that ends at once leaves the semaphores of its queues. They are removed, so the user need not
    know. Started with the first worker, the tracker would unblock Ctrl-C for it.
    """
    if os.name != "posix":
        return
    sys.warnoptions.append(LEFT_BEHIND)
    try:
        with _standard_modules():
            resource_tracker.ensure_running()
    finally:
        sys.warnoptions.remove(LEFT_BEHIND)


def _begin(folder: str, begin: Callable[..., None] | None, given: tuple[Any, ...]) -> None:
    tempfile.tempdir = folder  # the parent removes it
    # Where a signal cannot be blocked, as on Windows, it is ignored.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, args=(folder,), daemon=True).start()
    # As in the parent: imports make many objects and no garbage.
    gc.set_threshold(GARBAGE)
    # To dismantle a worker's memory object by object takes a quarter of a second.
    util.Finalize(None, _leave, exitpriority=LAST)
    # Libraries that are loaded already, and those that the first task loads.
    threadpool_limits(1, user_api="blas")
    os.environ.update(dict.fromkeys(VARIABLES, "1"))
    if begin is not None:
        begin(*given)


def _leave() -> None:
    """End a worker that has nothing left to do."""
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.flush()
    os._exit(0)


def _end_with_parent(folder: str) -> None:
    """End a worker when its parent is killed, as the parent can neither end it then nor remove its temporary folder."""
    parent = parent_process()
    if parent is not None:
        parent.join()
        shutil.rmtree(folder, ignore_errors=True)
        os._exit(1)


def end_children() -> None:
    """Terminate all processes that this one has started by `multiprocessing`; for a parent about to exit."""
    for child in active_children():
        with suppress(OSError):
            child.terminate()


@contextmanager
def _standard_modules() -> Iterator[None]:
    """Processes started here find no modules in the current folder before they have the parent's path.

    Else a user's file there with the name of a standard module, such as ``signal.py``, would end them at their start.
    """
    before = os.environ.get(SAFE_PATH)
    os.environ[SAFE_PATH] = "1"
    try:
        yield
    finally:
        if before is None:
            os.environ.pop(SAFE_PATH, None)
        else:
            os.environ[SAFE_PATH] = before


@contextmanager
def _blocked() -> Iterator[None]:
    """Block Ctrl-C for this thread and for processes started by it."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    old = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, old)
