"""Ctrl-C: a message about the finished work that is kept, and a delay until short work is finished."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any


class Interrupted(KeyboardInterrupt):
    """Ctrl-C with a message about the finished work; only ``except KeyboardInterrupt`` catches it.

    Parameters
    ----------
    kept : a clause: the finished work, and its place. at : progress of the work, e.g. "300 s".

    >>> print(Interrupted("what is finished is in results", at="300 s"))
    interrupted at 300 s; what is finished is in results
    """

    def __init__(self, kept: str, *, at: str = "") -> None:
        self.kept, self.at = kept, at
        super().__init__(f"interrupted{f' at {at}' if at else ''}; {kept}")


@contextmanager
def keeping(kept: str | Callable[[], str]) -> Iterator[None]:
    """On Ctrl-C within the block, raise `Interrupted` with the finished work; that of an inner block has precedence.

    Parameters
    ----------
    kept : a clause such as "3 of 7 cases are in campaign.csv", or a function that returns it.

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
        with interruption_delayed():
            clause = kept if isinstance(kept, str) else kept()
            raise Interrupted(clause) from interruption


@contextmanager
def interruption_delayed() -> Iterator[None]:
    """Delay Ctrl-C until the end of the block; only for short work, and only in the main thread.

    >>> with interruption_delayed():
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
