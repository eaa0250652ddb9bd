"""Ctrl-C: what is kept is named by whoever knows it, and short work that must not be cut in two is finished first."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any


class Interrupted(KeyboardInterrupt):
    """Ctrl-C, and what is kept of the work; only ``except KeyboardInterrupt`` catches it.

    Parameters
    ----------
    kept : a clause: what is finished, and where it is. at : how far the work was, e.g. "300 s".

    >>> print(Interrupted("what is finished is in results", at="300 s"))
    interrupted at 300 s; what is finished is in results
    """

    def __init__(self, kept: str, *, at: str = "") -> None:
        self.kept, self.at = kept, at
        super().__init__(f"interrupted{f' at {at}' if at else ''}; {kept}")


@contextmanager
def keeping(kept: str | Callable[[], str]) -> Iterator[None]:
    """Ctrl-C within the block says what is kept; what an inner block has said stands.

    Parameters
    ----------
    kept : a clause such as "3 of 7 cases are in campaign.csv", or a function that gives it when it is needed.

    >>> try:
    ...     with keeping("the tables are in results"):
    ...         raise KeyboardInterrupt
    ... except Interrupted as interruption:
    ...     print(interruption)
    interrupted; the tables are in results
    """
    try:
        yield
    except Interrupted:
        raise
    except KeyboardInterrupt as interruption:
        with held_back():
            clause = kept if isinstance(kept, str) else kept()
            raise Interrupted(clause) from interruption


@contextmanager
def held_back() -> Iterator[None]:
    """Ctrl-C waits until the block has ended; only for short work, and only where the main thread does it.

    >>> with held_back():
    ...     finished = "in one piece"
    """
    before = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(before):
        yield
        return
    waiting: list[Any] = []
    signal.signal(signal.SIGINT, lambda _number, frame: waiting.append(frame))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
        if waiting:
            before(signal.SIGINT, waiting[-1])
