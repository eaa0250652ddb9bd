"""Threads of linear algebra: one, because several mostly wait for each other.

The matrices of a tyre are small. On two idle cores a second thread saves little time or none and takes 1.4 to 2.2 times
the processor time; beside another busy process a press took 4.5 times as long with it. docs/evidence/performance.md
"""

from __future__ import annotations

import functools
import math
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController

#: Environment variables from which libraries for linear algebra take their number of threads when they are loaded.
VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def one_thread_by_default() -> None:
    """Give libraries that are loaded from now on one thread, unless the environment names a number."""
    if not any(name in os.environ for name in VARIABLES):
        os.environ.update(dict.fromkeys(VARIABLES, "1"))


def usable_cores(root: str = "/") -> int:
    """Processor cores that this process may use: of a shared machine, a queue or a container often gives it some only.

    Parameters
    ----------
    root : folder that holds ``sys``.

    >>> 1 <= usable_cores() <= (os.cpu_count() or 1)
    True
    """
    most = [os.cpu_count() or 1, *_quotas(os.path.join(root, "sys/fs/cgroup"))]
    if hasattr(os, "sched_getaffinity"):  # Linux
        most.append(len(os.sched_getaffinity(0)))
    return max(min(most), 1)


def _quotas(group: str) -> Iterator[int]:
    """Limits of a container's control group, rounded up: ``200000 100000`` are two cores, ``max`` or -1 no limit."""
    for files in (("cpu.max",), ("cpu/cpu.cfs_quota_us", "cpu/cpu.cfs_period_us")):
        with suppress(OSError, ValueError):
            time, period = " ".join(_text(os.path.join(group, file)) for file in files).split()
            if int(time) > 0 and int(period) > 0:
                yield math.ceil(int(time) / int(period))


def _text(file: str) -> str:
    with open(file, encoding="ascii") as stream:
        return stream.read()


@contextmanager
def one_thread() -> Iterator[None]:
    """Context, and decorator, in which linear algebra uses one thread.

    >>> with one_thread():
    ...     pass
    """
    with _libraries().limit(limits=1, user_api="blas"):
        yield


@functools.cache
def _libraries() -> ThreadpoolController:
    """The libraries of numpy and scipy; their search takes some milliseconds."""
    import scipy.linalg  # noqa: F401 - loads them
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()
