"""Ctrl-C on the command line, at any moment: one line that names the kept files, and exit code 130."""

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
#: Time that an interrupted process may take to end, s; time until a lost interruption is sent again, s.
PATIENCE, MOMENT = 20.0, 0.01


class CtrlC:
    """Context manager that handles Ctrl-C while a command runs; ``pressed`` is True after Ctrl-C.

    It changes nothing if another handler is installed, or outside the main thread.

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
            self._unraisable, sys.unraisablehook = sys.unraisablehook, self._resend
            if self.leaves:
                # Registered first, so executed last: Python's shutdown after it cannot be interrupted.
                atexit.register(signal.signal, signal.SIGINT, signal.SIG_IGN)
        return self

    def __exit__(self, *_: object) -> None:
        if self.handles:
            sys.unraisablehook = self._unraisable
            signal.signal(signal.SIGINT, signal.default_int_handler)

    def _interrupt(self, _number: int, _frame: object) -> NoReturn:
        self.pressed = True
        raise KeyboardInterrupt

    def _resend(self, lost: sys.UnraisableHookArgs, /) -> Any:
        """Send Ctrl-C again if a finaliser or a callback of a library lost it."""
        if isinstance(lost.exc_value, KeyboardInterrupt):
            # After a delay, because here it would be lost again.
            _after(MOMENT, _thread.interrupt_main)
        else:
            self._unraisable(lost)

    def ignore(self) -> None:
        """Ignore any further Ctrl-C, so that its message is printed once."""
        if self.handles:
            signal.signal(signal.SIGINT, signal.SIG_IGN)

    def leave(self, code: int) -> NoReturn:
        """End the process. An interrupted process also ends its workers, and waits only for a limited time."""
        if self.pressed:
            if "tyrefem.processes" in sys.modules:
                sys.modules["tyrefem.processes"].end_children()
            _after(PATIENCE, os._exit, INTERRUPTED)
        elif self.handles:
            signal.signal(signal.SIGINT, _interrupted_at_end)
        # The handlers stay installed until the interpreter has ended.
        self.handles = False
        # Python ends itself by the signal if the last code that it executed was interrupted.
        exec("")
        sys.exit(code)


def interruption_in(error: BaseException) -> KeyboardInterrupt | None:
    """The interruption that caused an error, preferably the latest with a message; None: no interruption.

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


def interruption_message(interruption: KeyboardInterrupt | None) -> str:
    """The message of an interruption: the kept files, as far as the command knows them."""
    if isinstance(interruption, Interrupted):
        return str(interruption)
    output = sys.modules.get("tyrefem.output")
    folder = getattr(output, "written_to", lambda: None)()
    if folder is None:
        return "interrupted; nothing was written"
    here = folder.cwd()
    return f"interrupted; complete files are in {folder.relative_to(here) if folder.is_relative_to(here) else folder}"


def _interrupted_at_end(_number: int, _frame: object) -> NoReturn:
    """Handle Ctrl-C between the end of the command and the end of its process."""
    fail("interrupted at the end; all files are written")
    with suppress(OSError, ValueError):
        sys.stdout.flush()
    os._exit(INTERRUPTED)


def _after(seconds: float, act: Callable[..., object], *given: object) -> None:
    timer = threading.Timer(seconds, act, given)
    timer.daemon = True
    timer.start()
