"""One line on stderr; the module imports nothing, so that it can print at any moment."""

from __future__ import annotations

import sys


def fail(message: object, code: int = 2) -> int:
    """Print a message as one line on stderr, without line breaks or control characters; return the exit code."""
    printable = "".join(letter if letter.isprintable() else " " for letter in str(message))
    print(f"tyrefem: {' '.join(printable.split())}", file=sys.stderr)
    return code
