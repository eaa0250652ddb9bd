"""Progress of a command with its remaining time: a bar on a terminal, else one line per minute on stderr.

Nothing with ``--quiet``. What is left follows from the work done; of a stage that does not count its work, from the
time that it took before on this machine.
"""

from __future__ import annotations

import signal
import sys
import threading
import time
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from tyrefem.cli.durations import expected, left, remember
from tyrefem.cli.shell import shell

#: Name of the stage, work done, total work (0: not known).
Tick = Callable[[str, float, float], None]
#: Time between the lines without a terminal, s.
EVERY = 60.0
#: A remaining time is shown after so many seconds of a stage.
SETTLED = 2.0


@dataclass
class Stage:
    """A stage of the work: its name, and how far it is."""

    name: str
    done: float = 0.0
    total: float = 0.0
    start: float = field(default_factory=time.monotonic)
    #: Duration the last time, s.
    before: float | None = None

    @property
    def elapsed(self) -> float:
        """Seconds since its start."""
        return time.monotonic() - self.start

    @property
    def left(self) -> float | None:
        """Seconds that are left, by the share done, or by the last time; None: not known."""
        elapsed = self.elapsed
        if elapsed < SETTLED:
            return None
        # Work after the counted part, such as growth of cracks after a run, has no count.
        if 0 < self.done < self.total:
            return elapsed * (self.total - self.done) / self.done
        return None if self.before is None or self.before <= elapsed else self.before - elapsed

    @property
    def words(self) -> str:
        """The remaining time in words; empty: not known."""
        return "" if self.left is None else left(self.left)


@contextmanager
def progress(description: str, total: float = 0.0) -> Iterator[Callable[[float], None]]:
    """Show the progress of one stage. Yields a function of the work done; without ``total``, only time is shown."""
    with stages() as tick:
        tick(description, 0.0, total)
        yield lambda done: tick(description, done, total)


def counted(tick: Tick, first: str, name: str, total: float) -> Callable[[float], None]:
    """A function of the work done in the stage ``name``; the stage ``first`` before it, without count, begins here.

    The time of what comes first, such as strain cycles by finite elements, says nothing of the time that is left.
    """
    tick(first, 0.0, total if first == name else 0.0)
    return lambda done: tick(name, done, total)


@contextmanager
def stages(*, every: float = EVERY) -> Iterator[Tick]:
    """Show the progress of several stages. Yields a function of the stage, work done and total (0: not known)."""
    if shell().quiet:
        yield lambda _what, _done, _total: None
    elif sys.stderr.isatty():
        with _bars() as tick:
            yield tick
    else:
        with _lines(every) as tick:
            yield tick


def _key(stage: str) -> str:
    """A stage of this command with these options."""
    return f"{stage} {zlib.crc32(shell().work.encode()):08x}"


def _next(stage: Stage | None, what: str, done: float, total: float) -> Stage:
    """The stage with its work; a stage that follows another ends that one."""
    if stage is None or stage.name != what:
        if stage is not None:
            remember(_key(stage.name), stage.elapsed)
        stage = Stage(what, before=expected(_key(what)))
    stage.done, stage.total = done, total
    return stage


@contextmanager
def _bars() -> Iterator[Tick]:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, ProgressColumn, TaskProgressColumn, TextColumn, TimeElapsedColumn
    from rich.text import Text

    stage: Stage | None = None

    class Remaining(ProgressColumn):
        """Remaining time of the stage at work."""

        def render(self, task: Any) -> Text:
            """The column of a task."""
            at_work = stage is not None and stage.name == task.description and not task.finished
            return Text(stage.words if at_work and stage is not None else "")

    bar = BarColumn(bar_width=24)
    columns = (
        TextColumn("{task.description}", markup=False),
        bar,
        TaskProgressColumn(),
        TimeElapsedColumn(),
        Remaining(),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as shown:
        tasks: dict[str, Any] = {}
        endless: list[str] = []

        def tick(what: str, done: float, total: float) -> None:
            nonlocal stage
            stage = _next(stage, what, done, total)
            if what not in tasks:
                # A stage without a total, such as reading, disappears when the next stage begins.
                for name in endless:
                    shown.remove_task(tasks.pop(name))
                endless[:] = [] if total else [what]
                tasks[what] = shown.add_task(what, total=total or None)
            shown.update(tasks[what], completed=done, total=total or None)

        yield tick
    if stage is not None:
        remember(_key(stage.name), stage.elapsed)


@contextmanager
def _lines(every: float) -> Iterator[Tick]:
    stage: Stage | None = None
    start, ended = time.monotonic(), threading.Event()

    def tick(what: str, done: float, total: float) -> None:
        nonlocal stage
        stage = _next(stage, what, done, total)

    def write() -> None:
        if hasattr(signal, "pthread_sigmask"):
            # The main thread handles Ctrl-C, and may delay it for a moment.
            signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        while not ended.wait(every):
            now = stage or Stage("")
            share = f", {now.done / now.total:.0%}" if now.total else ""
            minutes = (time.monotonic() - start) / 60
            words = f", {now.words}" if now.words else ""
            print(f"tyrefem: {now.name}{share} after {minutes:.0f} min{words}", file=sys.stderr, flush=True)

    writer = threading.Thread(target=write, name="progress", daemon=True)
    writer.start()
    try:
        yield tick
    finally:
        ended.set()
        writer.join()
    if stage is not None:
        remember(_key(stage.name), stage.elapsed)
