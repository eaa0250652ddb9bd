"""A command line that is sent Ctrl-C, with everything in its group, at a moment named beforehand.

A moment is the nth call of a function, ``module:function:n`` (n from 1), or the import of a module, ``module``.
"""

from __future__ import annotations

import functools
import importlib.abc
import importlib.util
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any


class Moment(importlib.abc.MetaPathFinder):
    """Watches the imports of this process, and sends the signal at its moment."""

    def __init__(self, text: str) -> None:
        self.module, *rest = text.split(":")
        self.function, self.left = (rest[0], int(rest[1])) if rest else ("", 1)

    def find_spec(self, name: str, path: Any, target: Any = None) -> Any:
        """Send it, or wrap the function as soon as its module is loaded."""
        if name != self.module:
            return None
        sys.meta_path.remove(self)
        if not self.function:
            self.count()
            return None
        spec = importlib.util.find_spec(name)
        load = spec.loader.exec_module

        def load_and_wrap(module: Any) -> None:
            load(module)
            *outer, last = self.function.split(".")
            owner = functools.reduce(getattr, outer, module)
            setattr(owner, last, self.wrapped(getattr(owner, last)))

        spec.loader.exec_module = load_and_wrap
        return spec

    def wrapped(self, function: Any) -> Any:
        """The function, which counts its calls."""

        @functools.wraps(function)
        def counted(*given: Any, **named: Any) -> Any:
            self.count()
            return function(*given, **named)

        return counted

    def count(self) -> None:
        """One call more."""
        self.left -= 1
        if not self.left:
            os.killpg(os.getpgrp(), signal.SIGINT)


@dataclass(frozen=True)
class Interrupted:
    """How an interrupted command ended."""

    code: int
    err: str
    group: int


def interrupted(*arguments: str, at: str | list[str], folder: Path, new: bool = False) -> Interrupted:
    """Run a command line in a process of its own and interrupt it at one moment, or at several.

    ``new`` , or an import as the moment: in a new interpreter; else forked from one that has imported all.
    """
    moments = [at] if isinstance(at, str) else at
    if not new and all(":" in moment for moment in moments):
        return _forked(arguments, moments, folder)
    with subprocess.Popen(
        [sys.executable, __file__, json.dumps(moments), *arguments],
        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, start_new_session=True, cwd=folder,
        # A shell that runs the tests in the background has them ignore it.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    ) as running:  # fmt: skip
        try:
            _, err = running.communicate(timeout=300)
        finally:
            if running.poll() is None:
                os.killpg(running.pid, signal.SIGKILL)
    return Interrupted(running.returncode, err, running.pid)


def _forked(arguments: tuple[str, ...], moments: list[str], folder: Path) -> Interrupted:
    # Not by this module's own process, which imports nothing before the command.
    from forked_commands import exit_code, forked

    with tempfile.NamedTemporaryFile(prefix="stderr-") as file:
        number = forked(arguments, folder, file.name, moments=moments)
        until = time.monotonic() + 300
        while (code := exit_code(number)) is None:
            if time.monotonic() > until:
                os.killpg(number, signal.SIGKILL)
            time.sleep(0.01)
        return Interrupted(code, Path(file.name).read_text(encoding="utf-8"), number)


def _main() -> None:
    sys.meta_path[:0] = [Moment(text) for text in json.loads(sys.argv[1])]
    # As the installed program: nothing else is imported before.
    from tyrefem.cli import main

    del sys.argv[1]
    main()


if __name__ == "__main__":
    # Worker processes import this file as another module, and are not watched.
    _main()
