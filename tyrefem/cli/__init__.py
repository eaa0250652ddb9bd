"""The command line. Ctrl-C is taken care of before anything else is imported.

The only room that reads arguments; no other room knows it.
"""

from __future__ import annotations

import gc
from typing import TYPE_CHECKING, Any

from tyrefem.cli.ctrl_c import INTERRUPTED, CtrlC, interruption_in, line_of
from tyrefem.cli.line import fail

if TYPE_CHECKING:
    from tyrefem.cli.commands import app

__all__ = ["app", "main"]


def __getattr__(name: str) -> Any:
    if name != "app":
        raise AttributeError(f"module 'tyrefem.cli' has no attribute '{name}'")
    from tyrefem.cli.commands import app

    return app


def main(arguments: list[str] | None = None) -> int:
    """Run a command line and give its exit code; without ``arguments`` take the process's own and end it.

    0: done. 1: no solution, or a case of a campaign failed. 2: bad input, said in one line. 130: interrupted.
    """
    # Importing makes many objects and no garbage: looking for it every 700 objects takes a tenth of a short run.
    gc.set_threshold(100_000)
    with CtrlC(leaves=arguments is None) as ctrl_c:
        message, code = _performed(arguments, ctrl_c)
        if message:
            fail(message)
        if arguments is None:
            ctrl_c.leave(code)
    return code


def _performed(arguments: list[str] | None, ctrl_c: CtrlC) -> tuple[object, int]:
    """The line that the command ends with, or none, and its exit code."""
    try:
        from tyrefem.cli.commands import performed

        message, code = performed(arguments)
    except BaseException as error:
        ctrl_c.ignore()
        interruption = interruption_in(error)
        # Whatever goes wrong after Ctrl-C, such as an import that was cut off, goes wrong because of it.
        if interruption is None and not ctrl_c.pressed:
            raise
        return line_of(interruption), INTERRUPTED
    ctrl_c.ignore()
    if ctrl_c.pressed and code != INTERRUPTED:
        return f"interrupted: {message or 'all was done already'}", INTERRUPTED
    return message, code
