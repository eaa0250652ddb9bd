"""The streams of a command's process, which may be closed, or have an encoding with few letters."""

from __future__ import annotations

import os
import sys


def make_streams_usable() -> None:
    """Open closed streams as empty ones, and write letters that stdout's encoding lacks as their numbers.

    Without a console, as under a scheduler, Windows gives no streams. There a redirected stdout has a code page, often
    without Greek letters or arrows. A terminal or pipe with UTF-8 stays as it is.
    """
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))  # noqa: SIM115, as long as the process
    encoding = getattr(sys.stdout, "encoding", None) or "utf-8"
    if not encoding.lower().replace("-", "").startswith("utf") and hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(errors="backslashreplace")
