"""One line on stderr; imports nothing, so that it can be printed at any moment."""

from __future__ import annotations

import sys


def fail(message: object, code: int = 2) -> int:
    """One line on stderr, whatever the message quotes from a file; gives back the exit code."""
    printable = "".join(letter if letter.isprintable() else " " for letter in str(message))
    print(f"tyrefem: {' '.join(printable.split())}", file=sys.stderr)
    return code
