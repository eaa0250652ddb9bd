"""Ctrl-C on the command line, at whatever moment: one line that says what is kept, exit code 130."""

from __future__ import annotations

import _thread
import atexit
import os
import signal
import sys
import threading
from contextlib import suppress
from typing import TYPE_CHECKING, Any, NoReturn

from tyrefem.cli.line import fail
from tyrefem.interruption import Interrupted

if TYPE_CHECKING:
    from collections.abc import Callable

INTERRUPTED = 130
#: s that an interrupted process may take to end in good order; s until an interruption that went nowhere is sent again.
PATIENCE, MOMENT = 20.0, 0.01


class CtrlC:
    """What Ctrl-C does while a command runs, as a context manager; ``pressed``: it came.

    Where somebody else handles the signal, or in other threads than the main one, nothing is changed.

    Parameters
    ----------
    leaves : the process ends with the command, see `leave`.
    """

    def __init__(self, *, leaves: bool) -> None:
        self.leaves, self.pressed, self.handles = leaves, False, False

    def __enter__(self) -> CtrlC:
        in_main = threading.current_thread() is threading.main_thread()
        self.handles = in_main and signal.getsignal(signal.SIGINT) is signal.default_int_handler
        if self.handles:
            signal.signal(signal.SIGINT, self._interrupt)
            self._unraisable, sys.unraisablehook = sys.unraisablehook, self._lost
            if self.leaves:
                # Registered first, done last: what Python takes apart after that cannot be interrupted.
                atexit.register(signal.signal, signal.SIGINT, signal.SIG_IGN)
        return self

    def __exit__(self, *_: object) -> None:
        if self.handles:
            sys.unraisablehook = self._unraisable
            signal.signal(signal.SIGINT, signal.default_int_handler)

    def _interrupt(self, _number: int, _frame: object) -> NoReturn:
        self.pressed = True
        raise KeyboardInterrupt

    def _lost(self, lost: sys.UnraisableHookArgs, /) -> Any:
        """Ctrl-C within a finaliser or a callback of a library goes nowhere: it is sent again."""
        if isinstance(lost.exc_value, KeyboardInterrupt):
            # A moment later: here it would be lost again.
            _later(MOMENT, _thread.interrupt_main)
        else:
            self._unraisable(lost)

    def ignore(self) -> None:
        """From here on nothing is said twice."""
        if self.handles:
            signal.signal(signal.SIGINT, signal.SIG_IGN)

    def leave(self, code: int) -> NoReturn:
        """End the process; an interrupted one ends its workers too, and waits for nothing for long."""
        if self.pressed:
            if "tyrefem.processes" in sys.modules:
                sys.modules["tyrefem.processes"].end_children()
            _later(PATIENCE, os._exit, INTERRUPTED)
        elif self.handles:
            signal.signal(signal.SIGINT, _too_late)
        # The handlers stay as they are: the interpreter has still to end.
        self.handles = False
        # Python ends itself by the signal if the last text that it executed was interrupted.
        exec("")
        sys.exit(code)


def interruption_in(error: BaseException) -> KeyboardInterrupt | None:
    """The interruption that an error is, or comes from: the latest that knows what is kept; None: there is none.

    >>> interruption_in(KeyboardInterrupt())
    KeyboardInterrupt()
    """
    each: BaseException | None = error
    interruption = None
    while each is not None and not isinstance(interruption, Interrupted):
        if isinstance(each, KeyboardInterrupt):
            interruption = each
        each = each.__cause__ or each.__context__
    return interruption


def line_of(interruption: KeyboardInterrupt | None) -> str:
    """What an interruption says: what the command knows to be kept, or which files are complete."""
    if isinstance(interruption, Interrupted):
        return str(interruption)
    output = sys.modules.get("tyrefem.output")
    folder = getattr(output, "written_to", lambda: None)()
    if folder is None:
        return "interrupted; nothing was written"
    here = folder.cwd()
    return f"interrupted; complete files are in {folder.relative_to(here) if folder.is_relative_to(here) else folder}"


def _too_late(_number: int, _frame: object) -> NoReturn:
    """The command is done; only its process is not."""
    fail("interrupted at the very end; everything is written")
    with suppress(OSError, ValueError):
        sys.stdout.flush()
    os._exit(INTERRUPTED)


def _later(seconds: float, act: Callable[..., object], *given: object) -> None:
    timer = threading.Timer(seconds, act, given)
    timer.daemon = True
    timer.start()
