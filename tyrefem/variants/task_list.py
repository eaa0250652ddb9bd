"""Tasks that are made when they are handed out, and the number of variants of a task."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar, overload

Item = TypeVar("Item")
#: Tasks for every worker, so that the last ones end about together; variants of a task, at most.
TASKS_PER_WORKER, LARGEST = 16, 2048


@dataclass(frozen=True, eq=False)
class TaskList(Sequence[Item], Generic[Item]):
    """A sequence of ``size`` items that ``make(place)`` makes at every access.

    >>> squares = TaskList(3, lambda place: place**2)
    >>> list(squares), squares[1:]
    ([0, 1, 4], [1, 4])
    """

    size: int
    make: Callable[[int], Item]

    def __len__(self) -> int:
        return self.size

    @overload
    def __getitem__(self, place: int) -> Item: ...
    @overload
    def __getitem__(self, place: slice) -> list[Item]: ...
    def __getitem__(self, place: int | slice) -> Item | list[Item]:
        places = range(self.size)[place]
        return self.make(places) if isinstance(places, int) else [self.make(each) for each in places]


def task_size(count: int, workers: int, piece: int) -> int:
    """Number of reduced variants of a task: a multiple of ``piece``.

    Every task costs the scheduler some milliseconds, as much as several variants of a reduced model. Many variants
    therefore make larger tasks, of `LARGEST` variants at most.

    >>> task_size(1000, 2, 64), task_size(100_000, 2, 64), task_size(100_000, 100, 64)
    (64, 2048, 64)
    """
    wanted = min(count // (workers * TASKS_PER_WORKER), LARGEST)
    return piece * max(wanted // piece, 1)
