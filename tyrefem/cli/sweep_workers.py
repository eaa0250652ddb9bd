"""Where the variants of `tyrefem sweep` run: this process, several, or a cluster, ended when the sweep is."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tyrefem.sweep.design import Design
    from tyrefem.sweep.execution import Execution
    from tyrefem.sweep.questions import Questions
    from tyrefem.sweep.schedulers import Scheduler


class _InterruptedError(Exception):
    """Processes that are at work are ended, not waited for."""


def answered(wanted: Questions, how: Execution, address: str | None, workers: int | None) -> Design:
    """The answers, by a Dask cluster at an address or by so many processes; None: one per core."""
    try:
        with _scheduler(address, workers) as where:
            found = wanted.answered(how, scheduler=where)
            if found.interrupted:
                raise _InterruptedError
    except _InterruptedError:
        pass
    return found


@contextmanager
def _scheduler(address: str | None, workers: int | None) -> Iterator[Scheduler]:
    """Kept for all questions of the command."""
    from tyrefem.sweep.cluster import Dask
    from tyrefem.sweep.schedulers import Here, Local

    if address is not None:
        cluster = Dask(address)
        try:
            yield cluster
        finally:
            cluster.close()
        return
    count = workers or os.cpu_count() or 1
    if count == 1:
        yield Here()
        return
    with Local(count) as processes:
        yield processes
