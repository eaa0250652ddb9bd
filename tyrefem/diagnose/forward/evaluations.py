"""Evaluations of the forward model in one or several processes; kept on disk for an interrupted diagnosis."""

from __future__ import annotations

import pickle
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.cache import Cache
from tyrefem.diagnose.forward.forward_model import ForwardModel
from tyrefem.diagnose.forward.worker_queues import HomedTask, WorkerQueues, Workers, started_workers
from tyrefem.inputs.study import StudyData
from tyrefem.output import jsonable, versions
from tyrefem.variants.answer_store import AnswerStore, digest, effects_source, plain, remove_store, study_digest

if TYPE_CHECKING:
    from tyrefem.diagnose.forward.sampling import SensorSampling

Array = NDArray[np.float64]


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
            remove_store(folder)


def key_of(model: ForwardModel) -> str:
    """Digest of all inputs of a model's evaluations: study, cards, source code of the effects, drives, versions.

    >>> from tyrefem.diagnose.forward.forward_model import ForwardModel
    >>> from tyrefem.inputs.study import study
    >>> stated, faster = study("nasa-22x5.5-8pr"), study("nasa-22x5.5-8pr", {"drive.speed": "25 mph"})
    >>> key_of(ForwardModel(stated, ())) == key_of(ForwardModel(faster, ()))
    False
    """
    drives = [
        [each.run, each.drive, each.hold_out, [_times(sensor) for sensor in each.sensors]] for each in model.drives
    ]
    return digest(
        [versions(), effects_source(), plain(model.study), jsonable(drives), repr(model.settings.of_simulations)]
    )


def _times(sampling: SensorSampling) -> list[Any]:
    noise = sampling.noise, sampling.rounding, sampling.discrepancy, sampling.correlation_time
    return [sampling.sensor, sampling.times.tolist(), *noise]


#: The latest forward model of a worker process, by its file.
_MODEL: dict[Path, ForwardModel] = {}
#: Full runs by study with its drive: the run of an amended study is the first of the next look.
_HISTORIES: Cache[Array] = Cache(size=16)


def _task(file: Path | None, name: str, arguments: tuple[Any, ...]) -> Any:
    assert file is not None
    if file not in _MODEL:
        _MODEL.clear()
        _MODEL[file] = pickle.loads(file.read_bytes())
    return getattr(_MODEL[file], name)(*arguments)


@dataclass(eq=False)
class WorkerModels:
    """Worker processes that evaluate one forward model after another; ``folder``: for what they share."""

    queues: WorkerQueues
    folder: Path
    count: int = 0

    def take(self, model: ForwardModel) -> tuple[ForwardModel, Path]:
        """The model as the processes have it, sharing strain cycles, and its file."""
        self.count += 1
        place = self.folder / str(self.count)
        place.mkdir()
        shared = replace(model, folder=place)
        file = place / "model.pickle"
        file.write_bytes(pickle.dumps(shared))
        return shared, file


@contextmanager
def worker_models(workers: Workers) -> Iterator[WorkerModels | None]:
    """Worker processes for `evaluating`; a number of them starts at once. None if one process is enough."""
    with ExitStack() as stack:
        if isinstance(workers, int):
            workers = stack.enter_context(started_workers(max(workers, 1)))
        if isinstance(workers, int):
            yield None
            return
        folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="tyrefem-"))
        yield WorkerModels(workers, Path(folder))


#: The method of `ForwardModel` that simulates a point of a fit.
SIMULATION = "predict"
#: The method of a full run.
HISTORY = "history"
#: Methods that need that simulation and little else: storing their answers would take longer.
AFTER_SIMULATION = frozenset({"displaced"})


#: The name of a method of `ForwardModel`, and its arguments.
Question = tuple[str, tuple[Any, ...]]


@dataclass(frozen=True, eq=False)
class Evaluations(Brief):
    """Evaluations of a forward model, in parallel if there are workers; ``file``: the model, for these.

    Evaluations that ``store`` has from an interrupted diagnosis are not simulated again. ``workers``: point of a fit ->
    the worker that has its simulation.
    """

    model: ForwardModel
    queues: WorkerQueues | None = None
    store: ProgressStore | None = None
    file: Path | None = None
    workers: dict[Any, int] = field(default_factory=dict, init=False, repr=False)

    def __reduce__(self) -> tuple[Any, ...]:
        """A pickled copy has the model only, without processes and store."""
        return Evaluations, (self.model,)

    def of(self, name: str, questions: Sequence[tuple[Any, ...]], tick: Callable[[], None] | None = None) -> list[Any]:
        """Results of the method ``name`` of `ForwardModel` for several tuples of arguments, in their order."""
        return self.together([(name, arguments) for arguments in questions], tick and (lambda _: tick()))

    def together(self, questions: Sequence[Question], tick: Callable[[str], None] | None = None) -> list[Any]:
        """Results of several methods, in the order of the questions: no worker waits between two methods.

        ``tick``: called with the name of the method after every result.
        """
        answers = [self._known(question) for question in questions]
        left = {number: questions[number] for number, answer in enumerate(answers) if answer is None}
        if tick:
            for number, (name, _) in enumerate(questions):
                if number not in left:
                    tick(name)
        for number, answer in self._answers(left):
            answers[number] = answer
            name, arguments = questions[number]
            if self.store and name not in AFTER_SIMULATION:
                self.store.keep(name, arguments, answer)
            if tick:
                tick(name)
        return answers

    def _known(self, question: Question) -> Any:
        name, arguments = question
        return self.store.known(name, arguments) if self.store and name not in AFTER_SIMULATION else None

    def histories(self, studies: Sequence[StudyData]) -> list[Array]:
        """`ForwardModel.history` of every study; those that were run before are not run again."""
        return self.histories_beside(studies, ())[0]

    def histories_beside(
        self, studies: Sequence[StudyData], questions: Sequence[Question], tick: Callable[[], None] | None = None
    ) -> tuple[list[Array], list[Any]]:
        """`histories`, and the results of further questions that are evaluated `together` with them.

        ``tick``: called after every result of a further question.
        """
        keys = [study_digest(study) for study in studies]
        left = {key: study for key, study in zip(keys, studies, strict=True) if key not in _HISTORIES}
        runs = [(HISTORY, (study,)) for study in left.values()]

        def step(name: str) -> None:
            if tick and name != HISTORY:
                tick()

        # The longest tasks come first: the workers then end at nearly the same time.
        answers = self.together([*questions, *runs], step)
        new = dict(zip(left, answers[len(questions) :], strict=True))

        def history(key: str, study: StudyData) -> Array:
            return new[key] if key in new else self.of(HISTORY, [(study,)])[0]

        histories = [
            _HISTORIES.get(key, partial(history, key, study)) for key, study in zip(keys, studies, strict=True)
        ]
        return histories, answers[: len(questions)]

    def _answers(self, questions: Mapping[int, Question]) -> Iterator[tuple[int, Any]]:
        """Yield (number of the question, result) as the results become ready.

        The questions of a drive go to the worker that has its simulations, unless another one is idle.
        """
        if self.queues is None:
            for number, (name, arguments) in questions.items():
                yield number, getattr(self.model, name)(*arguments)
            return
        tasks = {number: self._task_of(name, number, arguments) for number, (name, arguments) in questions.items()}
        for number, worker, answer in self.queues.results(tasks):
            name, arguments = questions[number]
            if name in (SIMULATION, *AFTER_SIMULATION):
                self.workers[_point(arguments)] = worker
            yield number, answer

    def _task_of(self, name: str, number: int, arguments: tuple[Any, ...]) -> HomedTask:
        """The task of a question: at the worker that has the simulation, else at that of its drive, if it has one."""
        home = arguments[0] if isinstance(arguments[0], int) else number
        simulated_by = self.workers.get(_point(arguments)) if name in AFTER_SIMULATION else None
        stays = simulated_by is not None
        return HomedTask(home if simulated_by is None else simulated_by, _task, (self.file, name, arguments), stays)


def _point(arguments: tuple[Any, ...]) -> tuple[int, frozenset[Any]]:
    """The drive and the values of the unknowns that a question begins with."""
    number, values, *_ = arguments
    return number, frozenset(values.items())


@contextmanager
def evaluating(
    model: ForwardModel,
    workers: Workers = 1,
    store: ProgressStore | None = None,
    pool: WorkerModels | None = None,
) -> Iterator[Evaluations]:
    """Evaluations of a model in ``workers``, see `worker_models`, or in those of ``pool``; 1: in this process."""
    if pool is not None:
        shared, file = pool.take(model)
        yield Evaluations(shared, pool.queues, store, file)
        return
    with worker_models(workers) as pool:
        if pool is None:
            yield Evaluations(model, store=store)
            return
        with evaluating(model, workers, store, pool) as evaluations:
            yield evaluations
