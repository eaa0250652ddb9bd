"""Teaching a reduced model: full runs, and corrections by residuals, wherever the scheduler has room.

Variants of a reduced model as work for any process: the model travels as arrays.
"""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.reduced.answers import reduced_answers, side_by_side
from tyrefem.reduced.model import NotReducibleError, ReducedModel
from tyrefem.reduced.residual import TIME_TOLERANCE as CORRECTED_TO
from tyrefem.reduced.residual import correction
from tyrefem.reduced.training import ReducedFineness, Snapshots, snapshots, trained, training_run
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.simulation.run import run
from tyrefem.variants.answers import answers
from tyrefem.variants.plan import Plan
from tyrefem.variants.samples import changes_at
from tyrefem.variants.schedulers import Scheduler
from tyrefem.variants.task import Bundle, Task

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
        if self.digest not in _MODELS:
            _MODELS.clear()
            _MODELS[self.digest] = ReducedModel(
                base_of(self.base), self.V, self.samples, self.nodes_from_samples, self.hot
            )
        return _MODELS[self.digest]


def base_of(packed: Bundle) -> RollingTyre:
    """The tyre of a study, whose mesh and operators serve all its variants; once per process."""
    if packed.digest not in _BASES:
        from tyrefem.variants.task import unpacked

        remember(packed, RollingTyre(unpacked(packed)))
    return _BASES[packed.digest]


def remember(packed: Bundle, base: RollingTyre) -> None:
    """Let this tyre be the one that `base_of` gives here."""
    _BASES.clear()
    _BASES[packed.digest] = base


def pack(model: ReducedModel, base: Bundle) -> Packed:
    """A model to be sent to other processes; ``base`` is the study it was made for."""
    return Packed(base, model.V, model.samples, model.nodes_from_samples, model.hot)


_MODELS: dict[str, ReducedModel] = {}
_BASES: dict[str, RollingTyre] = {}


@dataclass(frozen=True, eq=False)
class ReducedTask:
    """Variants to be marched side by side: their changes, in order."""

    changes: Sequence[Mapping[str, Any]]
    time_to: float | None = None


def perform_reduced(task: ReducedTask, packed: Packed) -> dict[str, Any]:
    """``{"outcomes": [...]}``, one per variant: ``answers``, ``failure`` or ``not_reducible``."""
    model = packed.unpacked()
    found: list[dict[str, Any]] = [{} for _ in task.changes]
    studies, places = [], []
    for place, changes in enumerate(task.changes):
        try:
            studies.append(model.base.study.replace(changes))
            places.append(place)
        except InputError as error:
            found[place] = {"failure": str(error)}
    for place, outcome in zip(places, reduced_answers(model, studies, task.time_to), strict=True):
        found[place] = outcome
    return {"outcomes": found}


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
    fields : temperature fields taken of it. time_tolerance : K, of the run. asked : whether answers are wanted.
    """

    task: Task
    fields: int
    time_tolerance: float
    asked: bool


def learn(lesson: Lesson) -> dict[str, Any]:
    """Done in a worker: ``{"snapshots", "answers"}`` or ``{"failure"}``."""
    from tyrefem.conduction import SolverError

    task, base = lesson.task, base_of(lesson.task.packed)
    try:
        study = base.study.replace(task.changes)
        if not lesson.asked:
            return {"snapshots": training_run(RollingTyre(study, base), lesson.time_tolerance)}
        result = run(study.replace({"numerics.tolerance": f"{lesson.time_tolerance:.6g} delta_degC"}), like=base)
        return {"snapshots": snapshots(result, lesson.fields), "answers": answers(result, task.time_to)}
    except (InputError, SolverError) as error:
        return {"failure": str(error)}


@dataclass(frozen=True, eq=False)
class Amendment:
    """Work of corrections by residuals: variants, and for each tau over the duration of every phase."""

    changes: Sequence[Mapping[str, Any]]
    shares: Sequence[float]


def amend(work: Amendment, packed: Packed) -> dict[str, Any]:
    """Done in a worker: ``{"each"}``: ``{"snapshots", "correction"}``, ``{"failure"}`` or ``{"not_reducible"}``."""
    model, base = packed.unpacked(), packed.unpacked().base
    found: list[dict[str, Any]] = [{} for _ in work.changes]
    tyres: dict[int, RollingTyre] = {}
    for number, changes in enumerate(work.changes):
        try:
            tyres[number] = RollingTyre(base.study.replace(changes), base)
        except InputError as error:
            found[number] = {"failure": str(error)}
    numbers = list(tyres)
    try:
        for places, part in side_by_side(model, list(tyres.values()), CORRECTED_TO):
            for place, number in enumerate(numbers[one] for one in places):
                if isinstance(part, dict):
                    found[number] = part
                else:
                    snapshots, largest = correction(part, place, work.shares[number])
                    found[number] = {"snapshots": snapshots, "correction": largest}
    except InputError as error:
        found = [one or {"failure": str(error)} for one in found]
    return {"each": found}


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

    def run(self, places: Sequence[Array], time_tolerance: float, what: str, asked: bool) -> list[dict[str, Any]]:
        """Outcomes of full runs; their snapshots are learnt."""
        lessons = [
            Lesson(
                Task(n, self.plan.packed, self.variant(place), self.plan.time_to),
                self.choice.fields,
                time_tolerance,
                asked,
            )
            for n, place in enumerate(places)
        ]
        found = self._done(learn, lessons, what)
        if all("failure" in one for one in found):
            raise NotReducibleError(f"no run for {what} succeeded: {found[0]['failure']}")
        self.learnt += [one["snapshots"] for one in found if "snapshots" in one]
        return found

    def rounds(self, most: int, enough: float) -> ReducedModel:
        """A model corrected at fresh places until corrections are small."""
        for _ in range(most):
            model = trained(self.base, self.learnt, self.choice)
            packed = pack(model, self.plan.packed)
            places = [np.clip(0.5 + STRETCH * (one - 0.5), 0.0, 1.0) for one in self.fresh(self.round)]
            changes = [self.variant(one) for one in places]
            shares = [HORIZONS[n % len(HORIZONS)] for n in range(len(places))]
            firsts = range(0, len(places), TOGETHER)
            work = [Amendment(changes[n : n + TOGETHER], shares[n : n + TOGETHER]) for n in firsts]
            parts = self._done(amend, work, "correcting", packed)
            # A part that failed as a whole, as where its process died, teaches nothing.
            found = [one for part in parts for one in part.get("each", [part])]
            refused = next((one["not_reducible"] for one in found if "not_reducible" in one), None)
            if refused is not None:
                raise NotReducibleError(refused)
            self.learnt += [one["snapshots"] for one in found if "snapshots" in one]
            self.amended += len(found)
            if max((one["correction"] for one in found if "correction" in one), default=0.0) <= enough:
                break
        return trained(self.base, self.learnt, self.choice)

    def _done(
        self, work: Callable[..., dict[str, Any]], tasks: Sequence[Any], what: str, common: Any = None
    ) -> list[dict[str, Any]]:
        outcomes: dict[int, dict[str, Any]] = {}
        for place, outcome in self.scheduler.outcomes(work, tasks, common):
            outcomes[place] = outcome
            self.tick(what, len(outcomes), len(tasks))
        return [outcomes[n] for n in range(len(tasks))]
