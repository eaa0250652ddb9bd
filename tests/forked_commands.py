"""Commands as processes that are forked from one which has imported what they import, see `command_server.py`."""

from __future__ import annotations

import atexit
import functools
import json
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any


def forked(
    line: Sequence[str], folder: str | Path, err: str | Path, *, largest_file: int = 0, moments: Sequence[str] = ()
) -> int:
    """Start a command in a group of its own; gives its process number.

    Parameters
    ----------
    line : its words after ``tyrefem``. folder : where it runs. err : file of its stderr. largest_file : bytes that no
        file may exceed. moments : calls at which its group is sent Ctrl-C, ``module:function:n``, n from 1.
    """
    request = {"line": list(line), "folder": str(folder), "err": str(err), "largest_file": largest_file}
    return int(_asked(**request, moments=list(moments), environment=dict(os.environ)))


def exit_code(number: int) -> int | None:
    """The exit code of a command that has ended, minus the signal that ended it; else None. It is given once."""
    code = _asked(ended=number)
    return None if code is None else int(code)


@functools.cache
def _server() -> subprocess.Popen[str]:
    """The process that forks; it ends with the tests, when its stdin does."""
    threads = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    server = subprocess.Popen(
        [sys.executable, str(Path(__file__).with_name("command_server.py"))], stdin=subprocess.PIPE,
        stdout=subprocess.PIPE, text=True, env=os.environ | threads, cwd=Path(__file__).parent,
    )  # fmt: skip
    atexit.register(server.communicate)
    return server


def _asked(**request: Any) -> Any:
    """The server's answer."""
    server = _server()
    assert server.stdin is not None
    assert server.stdout is not None
    server.stdin.write(json.dumps(request) + "\n")
    server.stdin.flush()
    return json.loads(server.stdout.readline())
