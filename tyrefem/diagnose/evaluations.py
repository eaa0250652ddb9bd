"""Evaluations of the forward model in one or several processes; kept on disk for an interrupted diagnosis."""

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
from tyrefem.diagnose.forward_model import ForwardModel
from tyrefem.output import jsonable, versions
from tyrefem.processes import processes
from tyrefem.variants.answer_store import AnswerStore, digest, effects_source, plain

if TYPE_CHECKING:
    from tyrefem.diagnose.sampling import SensorSampling


@dataclass(eq=False)
class ProgressStore(AnswerStore):
    """A folder with evaluations of one forward model: one study with its cards and drives, and one version."""

    def open(self, model: ForwardModel) -> int:
        """Resume the stored evaluations of this model and delete those of other models; returns their number."""
        return self.resume(key_of(model))

    def look(self, number: int) -> ProgressStore:
        """The store of a further look at the same data; for the first look, this store."""
        return self if number == 0 else ProgressStore(self.folder.with_name(f"{self.folder.name}-{number + 1}"))

    def by_law(self, law: str) -> ProgressStore:
        """The store of the diagnosis with another strain law."""
        return ProgressStore(self.folder.with_name(f"{self.folder.name}-{law}"))

    def clear(self) -> None:
        """Delete the stored evaluations of all looks, after the diagnosis is finished."""
        for folder in (self.folder, *self.folder.parent.glob(f"{self.folder.name}-*")):
            shutil.rmtree(folder, ignore_errors=True)


def key_of(model: ForwardModel) -> str:
    """Digest of all inputs of a model's evaluations: study, cards, source code of the effects, drives, versions.

    >>> from tyrefem.diagnose.forward_model import ForwardModel
    >>> from tyrefem.inputs.study import study
    >>> stated, faster = study("nasa-22x5.5-8pr"), study("nasa-22x5.5-8pr", {"drive.speed": "25 mph"})
    >>> key_of(ForwardModel(stated, ())) == key_of(ForwardModel(faster, ()))
    False
    """
    drives = [
        [each.name, each.drive, each.hold_out, [_times(sensor) for sensor in each.sensors]] for each in model.drives
    ]
    return digest(
        [versions(), effects_source(), plain(model.study), jsonable(drives), repr(model.settings.of_simulations)]
    )


def _times(sampling: SensorSampling) -> list[Any]:
    noise = sampling.noise, sampling.discrepancy, sampling.correlation_time
    return [sampling.sensor, sampling.times.tolist(), *noise]


_MODEL: list[ForwardModel] = []


def _install(model: ForwardModel) -> None:
    _MODEL[:] = [model]


def _task(name: str, arguments: tuple[Any, ...]) -> Any:
    return getattr(_MODEL[0], name)(*arguments)


@dataclass(frozen=True, eq=False)
class Evaluations(Brief):
    """Evaluations of a forward model, in parallel if there are workers.

    Evaluations that ``store`` has from an interrupted diagnosis are not simulated again.
    """

    model: ForwardModel
    pool: Executor | None = None
    store: ProgressStore | None = None

    def __reduce__(self) -> tuple[Any, ...]:
        """A pickled copy has the model only, without processes and store."""
        return Evaluations, (self.model,)

    def of(self, name: str, questions: Sequence[tuple[Any, ...]], tick: Callable[[], None] | None = None) -> list[Any]:
        """Results of the method ``name`` of `ForwardModel` for several tuples of arguments, in their order."""
        answers = [self.store.known(name, arguments) if self.store else None for arguments in questions]
        left = [number for number, answer in enumerate(answers) if answer is None]
        for _ in range(len(answers) - len(left)):
            if tick:
                tick()
        for number, answer in self._answers(name, {number: questions[number] for number in left}):
            answers[number] = answer
            if self.store:
                self.store.keep(name, questions[number], answer)
            if tick:
                tick()
        return answers

    def _answers(self, name: str, questions: Mapping[int, tuple[Any, ...]]) -> Iterator[tuple[int, Any]]:
        """Yield (number of the question, result) as the results become ready."""
        if self.pool is None:
            for number, arguments in questions.items():
                yield number, getattr(self.model, name)(*arguments)
            return
        futures = {self.pool.submit(_task, name, arguments): number for number, arguments in questions.items()}
        for future in as_completed(futures):
            yield futures[future], future.result()


@contextmanager
def evaluating(model: ForwardModel, workers: int = 1, store: ProgressStore | None = None) -> Iterator[Evaluations]:
    """Evaluations of a model in ``workers`` processes; 1: in this process."""
    if workers <= 1:
        yield Evaluations(model, store=store)
        return
    with tempfile.TemporaryDirectory(prefix="tyrefem-") as folder:
        shared = replace(model, folder=Path(folder))
        with processes(workers, _install, shared) as pool:
            yield Evaluations(shared, pool, store)
