"""Where the diagnosis simulates: a bench's answers, in this process or in several."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from tyrefem.brief import Brief
from tyrefem.diagnose.bench import Bench
from tyrefem.diagnose.progress_store import ProgressStore
from tyrefem.processes import processes

_BENCH: list[Bench] = []


def _install(bench: Bench) -> None:
    _BENCH[:] = [bench]


def _task(name: str, arguments: tuple[Any, ...]) -> Any:
    return getattr(_BENCH[0], name)(*arguments)


@dataclass(frozen=True, eq=False)
class Laboratory(Brief):
    """Simulations for a bench, side by side if it has workers. Results come in the order of the questions.

    What ``store`` knows from an interrupted diagnosis is not simulated again.
    """

    bench: Bench
    pool: Executor | None = None
    store: ProgressStore | None = None

    def __reduce__(self) -> tuple[Any, ...]:
        """Processes and folders stay where they are; what asks again asks here."""
        return Laboratory, (self.bench,)

    def ask(self, name: str, questions: Sequence[tuple[Any, ...]], tick: Callable[[], None] | None = None) -> list[Any]:
        """The answers of a method of `Bench` to several questions (arguments)."""
        found = [self.store.known(name, one) if self.store else None for one in questions]
        open_ones = [number for number, answer in enumerate(found) if answer is None]
        for _ in range(len(found) - len(open_ones)):
            if tick:
                tick()
        for number, answer in self._answers(name, {number: questions[number] for number in open_ones}):
            found[number] = answer
            if self.store:
                self.store.keep(name, questions[number], answer)
            if tick:
                tick()
        return found

    def _answers(self, name: str, questions: Mapping[int, tuple[Any, ...]]) -> Iterator[tuple[int, Any]]:
        """Answers as they are ready, with their questions' numbers."""
        if self.pool is None:
            for number, one in questions.items():
                yield number, getattr(self.bench, name)(*one)
            return
        futures = {self.pool.submit(_task, name, one): number for number, one in questions.items()}
        for future in as_completed(futures):
            yield futures[future], future.result()


@contextmanager
def laboratory(bench: Bench, workers: int = 1, store: ProgressStore | None = None) -> Iterator[Laboratory]:
    """A laboratory with so many processes; 1: in this one."""
    if workers <= 1:
        yield Laboratory(bench, store=store)
        return
    with tempfile.TemporaryDirectory(prefix="tyrefem-") as folder:
        shared = replace(bench, folder=Path(folder))
        with processes(workers, _install, shared) as pool:
            yield Laboratory(shared, pool, store)
