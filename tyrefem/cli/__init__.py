"""The command line. It handles Ctrl-C before it imports anything else.

Only this package reads arguments; no other package imports it.
"""

from __future__ import annotations

import gc
from typing import TYPE_CHECKING, Any

from tyrefem.cli.ctrl_c import INTERRUPTED, CtrlC, interruption_in, interruption_message
from tyrefem.cli.line import fail
from tyrefem.cli.streams import make_streams_usable
from tyrefem.threads import one_thread_by_default

if TYPE_CHECKING:
    from tyrefem.cli.commands import app

__all__ = ["app", "main"]


def __getattr__(name: str) -> Any:
    if name != "app":
        raise AttributeError(f"module 'tyrefem.cli' has no attribute '{name}'")
    from tyrefem.cli.commands import app

    return app


def main(arguments: list[str] | None = None) -> int:
    """Run a command line and return its exit code; without ``arguments``, run the process's arguments and exit.

    0: done. 1: no solution, or a case of a campaign failed. 2: bad input, reported in one line. 130: interrupted.
    """
    # Imports make many objects and no garbage: a collection every 700 objects takes a tenth of a short run.
    gc.set_threshold(100_000)
    if arguments is None:
        one_thread_by_default()
        make_streams_usable()
    with CtrlC(leaves=arguments is None) as ctrl_c:
        message, code = _run(arguments, ctrl_c)
        if message:
            fail(message)
        if arguments is None:
            gc.freeze()  # the process ends: a last search for garbage would take up to half a second
            ctrl_c.leave(code)
    return code


def _run(arguments: list[str] | None, ctrl_c: CtrlC) -> tuple[object, int]:
    """The command's last line, or None, and its exit code."""
    try:
        from tyrefem.cli.commands import run_command_line

        message, code = run_command_line(arguments)
    except BaseException as error:
        ctrl_c.ignore()
        interruption = interruption_in(error)
        # An error after Ctrl-C, such as an import that was cut off, is caused by it.
        if interruption is None and not ctrl_c.pressed:
            raise
        return interruption_message(interruption), INTERRUPTED
    ctrl_c.ignore()
    if ctrl_c.pressed and code != INTERRUPTED:
        return f"interrupted: {message or 'the command was already done'}", INTERRUPTED
    return message, code
