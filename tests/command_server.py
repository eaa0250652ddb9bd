"""A process that has imported what commands import, and forks one process for each command line it is sent.

The commands are true processes, with a group and signals of their own; only the time of their imports is saved. A
line of stdin is a request in JSON, a line of stdout its answer: ``{"line": [...], ...}`` starts a command and gives its
process number, ``{"ended": number}`` gives its exit code, or null while it runs. `forked_commands.py` asks it.
"""

from __future__ import annotations

import atexit
import functools
import importlib
import itertools
import json
import os
import pkgutil
import resource
import signal
import sys
import traceback
from typing import Any, NoReturn


def load() -> None:
    """Import the package and the libraries that its commands import later."""
    import tyrefem
    from tyrefem.quantity import registry

    for module in pkgutil.walk_packages(tyrefem.__path__, "tyrefem."):
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)
    for name in ("pandas", "jinja2", "filelock", "tomli_w", "matplotlib.figure", "matplotlib.backends.backend_agg",
                 "rich.console", "scipy.optimize", "scipy.interpolate", "scipy.stats"):  # fmt: skip
        importlib.import_module(name)
    registry()


def interrupt_at(moment: str) -> None:
    """Send Ctrl-C to this group at the nth call of a function: ``module:function:n``, n from 1."""
    name, function, number = moment.split(":")
    module = importlib.import_module(name)
    *outer, last = function.split(".")
    owner = functools.reduce(getattr, outer, module)
    original = getattr(owner, last)
    calls = itertools.count(1)

    @functools.wraps(original)
    def counted(*given: Any, **named: Any) -> Any:
        if next(calls) == int(number):
            os.killpg(os.getpgrp(), signal.SIGINT)
        return original(*given, **named)

    setattr(owner, last, counted)
    # Modules that have imported it by its name.
    for other in list(sys.modules.values()):
        for alias in [alias for alias, value in vars(other).items() if value is original]:
            setattr(other, alias, counted)


def begin(request: dict[str, Any]) -> int:
    """Start a command; return its process number."""
    number = os.fork()
    if not number:
        try:
            _run(request)
        finally:
            os._exit(70)
    return number


def _run(request: dict[str, Any]) -> NoReturn:
    os.setsid()
    for descriptor, path, mode in ((0, os.devnull, os.O_RDONLY), (1, os.devnull, os.O_WRONLY),
                                   (2, request["err"], os.O_WRONLY | os.O_CREAT)):  # fmt: skip
        opened = os.open(path, mode, 0o600)
        os.dup2(opened, descriptor)
        os.close(opened)
    os.chdir(request["folder"])
    os.environ.clear()
    os.environ.update(request["environment"])
    signal.signal(signal.SIGINT, signal.default_int_handler)
    if request["largest_file"]:
        resource.setrlimit(resource.RLIMIT_FSIZE, (request["largest_file"],) * 2)
        sys.dont_write_bytecode = True
    for moment in request["moments"]:
        interrupt_at(moment)
    sys.argv = ["tyrefem", *request["line"]]
    from tyrefem.cli import main

    code = 1
    try:
        main()
        code = 0
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else 0
    except BaseException:
        traceback.print_exc()
    atexit._run_exitfuncs()
    sys.stderr.flush()
    os._exit(code)


def ended(number: int) -> int | None:
    """The exit code of a command, minus the signal that ended it; None while it runs."""
    which, status = os.waitpid(number, os.WNOHANG)
    return os.waitstatus_to_exitcode(status) if which else None


def main() -> None:
    """Answer requests until stdin ends."""
    load()
    for line in sys.stdin:
        request = json.loads(line)
        print(json.dumps(ended(request["ended"]) if "ended" in request else begin(request)), flush=True)


if __name__ == "__main__":
    main()
