"""Finished simulations of a diagnosis, kept on disk, so that an interrupted one takes them up again.

Where the diagnosis simulates: a bench's answers, in this process or in several.
"""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.brief import Brief
from tyrefem.diagnose.forward_model import Bench
from tyrefem.output import jsonable, versions
from tyrefem.processes import processes
from tyrefem.variants.answer_store import AnswerStore, digest, effects_source, plain

if TYPE_CHECKING:
    from tyrefem.diagnose.runs import Series


@dataclass(eq=False)
class ProgressStore(AnswerStore):
    """Answers of a laboratory by question, in a folder; of one study, its cards, its data and one version only."""

    def open(self, bench: Bench) -> int:
        """Find what was left for this bench, and drop what was left for any other; how many answers there are."""
        return self.take_up(key_of(bench))

    def look(self, number: int) -> ProgressStore:
        """The store of a further look at the same data; this one for the first."""
        return self if number == 0 else ProgressStore(self.folder.with_name(f"{self.folder.name}-{number + 1}"))

    def clear(self) -> None:
        """Remove everything, of further looks too: the diagnosis is done."""
        for folder in (self.folder, *self.folder.parent.glob(f"{self.folder.name}-*")):
            shutil.rmtree(folder, ignore_errors=True)


def key_of(bench: Bench) -> str:
    """Digest of everything that decides a bench's answers: study, cards, effects' source, data, versions.

    >>> from tyrefem.diagnose.forward_model import Bench
    >>> from tyrefem.inputs.study import study
    >>> one, faster = study("nasa-22x5.5-8pr"), study("nasa-22x5.5-8pr", {"drive.speed": "25 mph"})
    >>> key_of(Bench(one, ())) == key_of(Bench(faster, ()))
    False
    """
    trials = [[one.name, one.drive, one.hold_out, [_series(each) for each in one.series]] for one in bench.trials]
    return digest(
        [versions(), effects_source(), plain(bench.study), jsonable(trials), repr(bench.settings.of_simulations)]
    )


def _series(one: Series) -> list[Any]:
    data = [one.times.tolist(), one.measured.tolist()]
    return [one.sensor, data, one.noise, one.discrepancy, one.correlation_time]


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
