"""How long a stage of a command took the last time on this machine: what is left of one that does not count its work.

The times stand in the user's cache, ``durations.json``. Without it, or where it cannot be written, none is known.
"""

from __future__ import annotations

import json
import os
from contextlib import suppress
from pathlib import Path

#: Shortest stage that is kept, s, and number of stages kept.
SHORTEST, KEPT = 2.0, 300


def cache_file() -> Path:
    """``tyrefem/durations.json`` in ``XDG_CACHE_HOME``, by default ``~/.cache``."""
    folder = os.environ.get("XDG_CACHE_HOME")
    return (Path(folder) if folder else Path.home() / ".cache") / "tyrefem" / "durations.json"


def _read() -> dict[str, float]:
    with suppress(OSError, ValueError, RuntimeError):
        known = json.loads(cache_file().read_text(encoding="utf-8"))
        if isinstance(known, dict):
            return {str(key): float(value) for key, value in known.items() if isinstance(value, int | float)}
    return {}


def expected(stage: str) -> float | None:
    """Seconds that the stage took the last time; None: not known."""
    return _read().get(stage)


def remember(stage: str, seconds: float) -> None:
    """Keep the duration of a finished stage."""
    if seconds < SHORTEST:
        return
    known = _read()
    known.pop(stage, None)
    kept = dict([*known.items(), (stage, round(seconds, 1))][-KEPT:])
    with suppress(OSError, RuntimeError):
        file = cache_file()
        file.parent.mkdir(parents=True, exist_ok=True)
        temporary = file.with_name(f".{os.getpid()}.json")
        temporary.write_text(json.dumps(kept, indent=1), encoding="utf-8")
        temporary.replace(file)


def left(seconds: float) -> str:
    """A remaining time in words.

    >>> left(8.0), left(100.0), left(4000.0)
    ('about 8 s left', 'about 2 min left', 'about 1.1 h left')
    """
    if seconds < 90:
        return f"about {max(seconds, 1):.0f} s left"
    return f"about {seconds / 60:.0f} min left" if seconds < 3600 else f"about {seconds / 3600:.2g} h left"
