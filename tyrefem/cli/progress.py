"""Progress of a command: a bar on a terminal, else one line per minute on stderr; nothing with ``--quiet``."""

from __future__ import annotations

import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

#: Name of the stage, work done, total work (0: not known).
Tick = Callable[[str, float, float], None]
#: Time between the lines without a terminal, s.
EVERY = 60.0


@contextmanager
def progress(description: str, total: float = 0.0, *, quiet: bool = False) -> Iterator[Callable[[float], None]]:
    """Show the progress of one stage. Yields a function of the work done; without ``total``, only time is shown."""
    with stages(quiet=quiet) as tick:
        tick(description, 0.0, total)
        yield lambda done: tick(description, done, total)


@contextmanager
def stages(*, quiet: bool = False, every: float = EVERY) -> Iterator[Tick]:
    """Show the progress of several stages. Yields a function of the stage, work done and total (0: not known)."""
    if quiet:
        yield lambda _what, _done, _total: None
    elif sys.stderr.isatty():
        with _bars() as tick:
            yield tick
    else:
        with _lines(every) as tick:
            yield tick


@contextmanager
def _bars() -> Iterator[Tick]:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn

    columns = (TextColumn("{task.description}"), BarColumn(bar_width=24), TaskProgressColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as shown:
        tasks: dict[str, Any] = {}
        endless: list[str] = []

        def tick(what: str, done: float, total: float) -> None:
            if what not in tasks:
                # A stage without a total, such as reading, disappears when the next stage begins.
                for name in endless:
                    shown.remove_task(tasks.pop(name))
                endless[:] = [] if total else [what]
                tasks[what] = shown.add_task(what, total=total or None)
            shown.update(tasks[what], completed=done, total=total or None)

        yield tick


@contextmanager
def _lines(every: float) -> Iterator[Tick]:
    state: tuple[str, float, float] = ("", 0.0, 0.0)
    start, ended = time.monotonic(), threading.Event()

    def tick(what: str, done: float, total: float) -> None:
        nonlocal state
        state = (what, done, total)

    def write() -> None:
        if hasattr(signal, "pthread_sigmask"):
            # The main thread handles Ctrl-C, and may delay it for a moment.
            signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        while not ended.wait(every):
            what, done, total = state
            share = f", {done / total:.0%}" if total else ""
            minutes = (time.monotonic() - start) / 60
            print(f"tyrefem: {what}{share} after {minutes:.0f} min", file=sys.stderr, flush=True)

    writer = threading.Thread(target=write, name="progress", daemon=True)
    writer.start()
    try:
        yield tick
    finally:
        ended.set()
        writer.join()
