"""Teaching a reduced model: full runs, and corrections by residuals, wherever the scheduler has room.

Variants of a reduced model as work for any process: the model travels as arrays.
"""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.cache import Cache
from tyrefem.errors import InputError
from tyrefem.reduced.answers import ReducedOutcome, reduced_answers, side_by_side
from tyrefem.reduced.model import NotReducibleError, ReducedModel
from tyrefem.reduced.residual import TIME_TOLERANCE as CORRECTED_TO
from tyrefem.reduced.residual import correction
from tyrefem.reduced.training import ReducedFineness, Snapshots, snapshots, trained, training_run
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.simulation.run import run
from tyrefem.variants.answers import answers
from tyrefem.variants.outcomes import Failed, NotReducible
from tyrefem.variants.plan import Plan
from tyrefem.variants.samples import changes_at
from tyrefem.variants.schedulers import Result, Scheduler
from tyrefem.variants.task import Bundle, Task, unpacked

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Packed:
    """A reduced model without its operators: who unpacks it assembles them once on the same mesh.

    Parameters
    ----------
    base : the study it was made for. V, samples, nodes_from_samples, hot : as `ReducedModel` has them.
    """

    base: Bundle
    V: Array
    samples: Mapping[str, Array]
    nodes_from_samples: Array
    hot: Mapping[str, NDArray[np.intp]]

    @functools.cached_property
    def digest(self) -> str:
        """Of study and modes."""
        return hashlib.sha256(self.base.digest.encode() + self.V.tobytes()).hexdigest()[:16]

    def unpacked(self) -> ReducedModel:
        """The model again, once per process."""
        return _models.get(
            self.digest,
            lambda: ReducedModel(base_of(self.base), self.V, self.samples, self.nodes_from_samples, self.hot),
        )


def base_of(packed: Bundle) -> RollingTyre:
    """The tyre of a study, whose mesh and operators serve all its variants; once per process."""
    return _bases.get(packed.digest, lambda: RollingTyre(unpacked(packed)))


def remember(packed: Bundle, base: RollingTyre) -> None:
    """Let `base_of` give this tyre here, unless it has one of the same study."""
    _bases.get(packed.digest, lambda: base)


def pack(model: ReducedModel, base: Bundle) -> Packed:
    """A model to be sent to other processes; ``base`` is the study it was made for."""
    return Packed(base, model.V, model.samples, model.nodes_from_samples, model.hot)


#: Models and tyres that a process keeps: those of two sweeps at once, on threads of one worker.
KEPT = 2
_models: Cache[ReducedModel] = Cache(KEPT)
_bases: Cache[RollingTyre] = Cache(KEPT)


@dataclass(frozen=True, eq=False)
class ReducedTask:
    """Variants to be marched side by side: their changes, in order."""

    changes: Sequence[Mapping[str, Any]]
    time_to: float | None = None


def perform_reduced(task: ReducedTask, packed: Packed) -> tuple[ReducedOutcome, ...]:
    """Done in a worker: what becomes of every variant, in their order."""
    model = packed.unpacked()
    outcomes: dict[int, ReducedOutcome] = {}
    studies, places = [], []
    for place, changes in enumerate(task.changes):
        try:
            studies.append(model.base.study.replace(changes))
            places.append(place)
        except InputError as error:
            outcomes[place] = Failed(str(error))
    outcomes |= dict(zip(places, reduced_answers(model, studies, task.time_to), strict=True))
    return tuple(outcomes[place] for place in range(len(task.changes)))


Tick = Callable[[str, int, int], None]


#: Variants corrected by residuals in a round, per number that varies and at least.
PER_NUMBER, LEAST = 2.0, 10


#: Variants corrected together: marched side by side, few enough for several processes.
TOGETHER = 5


#: Horizons of the corrections over the duration of a phase, in turns.
HORIZONS = (0.1, 0.5)


#: Places of the box are stretched about its middle: corners are interpolated between, not extrapolated to.
STRETCH = 1.25


@dataclass(frozen=True, eq=False)
class Lesson:
    """Work of a full run: snapshots of one variant, and its answers.

    Parameters
    ----------
    fields : temperature fields taken of it. time_tolerance : K, of the run. with_answers : whether answers are wanted.
    """

    task: Task
    fields: int
    time_tolerance: float
    with_answers: bool


@dataclass(frozen=True, eq=False)
class Learnt:
    """What a full run teaches, and its answers; none where none are wanted."""

    snapshots: Snapshots
    answers: Mapping[str, Any] = field(default_factory=dict)


def learn(lesson: Lesson) -> Learnt | Failed:
    """Done in a worker: run a variant in full."""
    from tyrefem.conduction import SolverError

    task, base = lesson.task, base_of(lesson.task.packed)
    try:
        study = base.study.replace(task.changes)
        if not lesson.with_answers:
            return Learnt(training_run(RollingTyre(study, base), lesson.time_tolerance))
        result = run(study.replace({"numerics.tolerance": f"{lesson.time_tolerance:.6g} delta_degC"}), like=base)
        return Learnt(snapshots(result, lesson.fields), answers(result, task.time_to))
    except (InputError, SolverError) as error:
        return Failed(str(error))


@dataclass(frozen=True, eq=False)
class Amendment:
    """Work of corrections by residuals: variants, and for each tau over the duration of every phase."""

    changes: Sequence[Mapping[str, Any]]
    shares: Sequence[float]


@dataclass(frozen=True, eq=False)
class Corrected:
    """What the full model makes of a reduced run, and by how much at most, K."""

    snapshots: Snapshots
    largest: float


def amend(work: Amendment, packed: Packed) -> tuple[Corrected | Failed | NotReducible, ...]:
    """Done in a worker: correct reduced runs of variants, in their order."""
    model = packed.unpacked()
    base = model.base
    outcomes: dict[int, Corrected | Failed | NotReducible] = {}
    tyres: dict[int, RollingTyre] = {}
    for number, changes in enumerate(work.changes):
        try:
            tyres[number] = RollingTyre(base.study.replace(changes), base)
        except InputError as error:
            outcomes[number] = Failed(str(error))
    numbers = list(tyres)
    try:
        for places, part in side_by_side(model, list(tyres.values()), CORRECTED_TO):
            for place, number in enumerate(numbers[task] for task in places):
                if isinstance(part, Failed | NotReducible):
                    outcomes[number] = part
                else:
                    outcomes[number] = Corrected(*correction(part, place, work.shares[number]))
    except InputError as error:
        outcomes = {number: Failed(str(error)) for number in numbers} | outcomes
    return tuple(outcomes[number] for number in range(len(work.changes)))


def check_reducible(outcomes: Sequence[object]) -> None:
    """Raise `NotReducibleError` where a reduced model cannot follow one of the variants."""
    for outcome in outcomes:
        if isinstance(outcome, NotReducible):
            raise NotReducibleError(outcome.reason)


class School:
    """Teaches: full runs, and corrections by residuals."""

    def __init__(self, plan: Plan, scheduler: Scheduler, choice: ReducedFineness, tick: Tick, seed: int) -> None:
        from scipy.stats import qmc

        self.plan, self.scheduler, self.choice, self.tick = plan, scheduler, choice, tick
        self.base = RollingTyre(plan.study)
        remember(plan.packed, self.base)
        self.learnt: list[Snapshots] = []
        self.amended = 0
        self.round = max(LEAST, int(np.ceil(PER_NUMBER * len(plan.varied))))
        self.places = qmc.Halton(len(plan.varied), seed=seed)

    def fresh(self, count: int) -> list[Array]:
        """Places of the box that were not used yet."""
        return list(self.places.random(count))

    def variant(self, place: Array) -> dict[str, Any]:
        """Changes at a place of the unit box."""
        return changes_at(self.plan.varied, place)

    def run(
        self, places: Sequence[Array], time_tolerance: float, what: str, with_answers: bool
    ) -> list[Learnt | Failed]:
        """What full runs teach, in their order; their snapshots are learnt."""
        lessons = [
            Lesson(
                Task(n, self.plan.packed, self.variant(place), self.plan.time_to),
                self.choice.fields,
                time_tolerance,
                with_answers,
            )
            for n, place in enumerate(places)
        ]
        outcomes = self._done(learn, lessons, what)
        learnt = [outcome for outcome in outcomes if isinstance(outcome, Learnt)]
        failed = [outcome for outcome in outcomes if isinstance(outcome, Failed)]
        if failed and not learnt:
            raise NotReducibleError(f"no run for {what} succeeded: {failed[0].reason}")
        self.learnt += [outcome.snapshots for outcome in learnt]
        return outcomes

    def rounds(self, most: int, enough: float) -> ReducedModel:
        """A model corrected at fresh places until corrections are small."""
        for _ in range(most):
            model = trained(self.base, self.learnt, self.choice)
            packed = pack(model, self.plan.packed)
            places = [np.clip(0.5 + STRETCH * (place - 0.5), 0.0, 1.0) for place in self.fresh(self.round)]
            changes = [self.variant(place) for place in places]
            shares = [HORIZONS[n % len(HORIZONS)] for n in range(len(places))]
            firsts = range(0, len(places), TOGETHER)
            work = [Amendment(changes[n : n + TOGETHER], shares[n : n + TOGETHER]) for n in firsts]
            parts = self._done(amend, work, "correcting", packed)
            # A part that failed as a whole, as where its process died, teaches nothing.
            outcomes = [outcome for part in parts for outcome in ((part,) if isinstance(part, Failed) else part)]
            check_reducible(outcomes)
            corrected = [outcome for outcome in outcomes if isinstance(outcome, Corrected)]
            self.learnt += [outcome.snapshots for outcome in corrected]
            self.amended += len(outcomes)
            if max((outcome.largest for outcome in corrected), default=0.0) <= enough:
                break
        return trained(self.base, self.learnt, self.choice)

    def _done(
        self, work: Callable[..., Result], tasks: Sequence[Any], what: str, common: Any = None
    ) -> list[Result | Failed]:
        outcomes: dict[int, Result | Failed] = {}
        for place, outcome in self.scheduler.outcomes(work, tasks, common):
            outcomes[place] = outcome
            self.tick(what, len(outcomes), len(tasks))
        return [outcomes[n] for n in range(len(tasks))]
