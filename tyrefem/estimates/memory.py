"""Memory available on this machine."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

#: Default of free memory, bytes, if the machine gives no value.
UNKNOWN = 8 * 2**30
#: A larger limit of a control group is no limit: version 1 writes the largest possible number.
NO_LIMIT = 2**60


def free_memory(root: Path = Path("/")) -> float:
    """Bytes available to this process: the smallest of the limits by machine, control group and `ulimit`.

    On Linux they are in ``/proc/meminfo`` (MemAvailable) and ``/sys/fs/cgroup`` (versions 1 and 2). Elsewhere the total
    memory of the machine is used, or `UNKNOWN`.

    Parameters
    ----------
    root : folder that holds ``proc`` and ``sys``.

    >>> free_memory() > 0
    True
    """
    limits = [_of_machine(root), *_of_groups(root), _of_process(root)]
    return max(min((limit for limit in limits if limit is not None), default=float(UNKNOWN)), 0.0)


def _of_machine(root: Path) -> float | None:
    for line in _text(root / "proc/meminfo").splitlines():
        name, _, value = line.partition(":")
        if name == "MemAvailable" and value.split():
            return float(value.split()[0]) * 1024
    with contextlib.suppress(AttributeError, ValueError, OSError):
        pages = os.sysconf("SC_PHYS_PAGES")
        return float(pages * os.sysconf("SC_PAGE_SIZE")) if pages > 0 else None
    return None


def _of_groups(root: Path) -> list[float]:
    """Free memory of the control groups of this process and of those above them."""
    free: list[float] = []
    for line in _text(root / "proc/self/cgroup").splitlines():
        _, _, rest = line.partition(":")
        names, _, path = rest.partition(":")
        if names == "":
            base, limit, used = root / "sys/fs/cgroup", "memory.max", "memory.current"
        elif "memory" in names.split(","):
            base, limit, used = root / "sys/fs/cgroup/memory", "memory.limit_in_bytes", "memory.usage_in_bytes"
        else:
            continue
        inside = base / path.strip().lstrip("/")
        # Inside a container its group is the root; the path is that of the host.
        for group in [inside, *[parent for parent in inside.parents if base in (parent, *parent.parents)]]:
            most, now = _number(group / limit), _number(group / used)
            if most is not None and most < NO_LIMIT:
                free.append(most - (now or 0.0) + _cached(group))
    return free


def _cached(group: Path) -> float:
    """Bytes of cached files of a group, which it can release."""
    for line in _text(group / "memory.stat").splitlines():
        name, _, value = line.partition(" ")
        if name in ("inactive_file", "total_inactive_file") and value.strip().isdigit():
            return float(value)
    return 0.0


def _of_process(root: Path) -> float | None:
    """Free memory under ``ulimit -v``."""
    try:
        import resource
    except ImportError:  # not on Windows
        return None
    most = resource.getrlimit(resource.RLIMIT_AS)[0]
    if most == resource.RLIM_INFINITY:
        return None
    pages = _text(root / "proc/self/statm").split()
    used = int(pages[0]) * os.sysconf("SC_PAGE_SIZE") if pages else 0
    return float(most - used)


def _number(path: Path) -> float | None:
    text = _text(path).strip()
    return float(text) if text.isdigit() else None


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return ""
