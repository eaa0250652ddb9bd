"""Training of a reduced model by full runs and residual corrections, in parallel.

Worker tasks that use a reduced model receive it as arrays.
"""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.cache import Cache
from tyrefem.errors import InputError
from tyrefem.geometry.meshing.mapped import Counts
from tyrefem.reduced.answers import ReducedOutcome, batch_solutions, learnt_outcomes, reduced_answers
from tyrefem.reduced.error_estimate import estimated_errors
from tyrefem.reduced.learnt_cycles import LearntCycles, Press, learnt, mechanical_numbers, press_count, press_of
from tyrefem.reduced.learnt_inputs import LearntInputs
from tyrefem.reduced.model import NotReducibleError, ReducedModel
from tyrefem.reduced.residual import TIME_TOLERANCE as CORRECTION_TOLERANCE
from tyrefem.reduced.residual import correction
from tyrefem.reduced.shape_operators import ShapeOperators
from tyrefem.reduced.shapes import counts_of, shape_count, tyre_of, with_shapes
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
class PackedModel:
    """A reduced model without its operators; the receiving process assembles them once on the same mesh.

    Parameters
    ----------
    base : the study that it was made for. V, samples, nodes_from_samples, hot, shapes, further, cycles : as in
        `ReducedModel`.
    inputs : as in `ReducedModel`.
    counts : rows and gaps of the mesh that all shapes of the section share; None: the section does not vary.
    """

    base: Bundle
    V: Array
    samples: Mapping[str, Array]
    nodes_from_samples: Array
    hot: Mapping[str, NDArray[np.intp]]
    counts: Counts | None = None
    shapes: ShapeOperators | None = None
    further: Array | None = None
    cycles: LearntCycles | None = None
    inputs: LearntInputs | None = None

    @functools.cached_property
    def digest(self) -> str:
        """Digest of the study and the modes."""
        without = [part is None for part in (self.shapes, self.further, self.cycles)]
        text = f"{self.base.digest} {self.counts} {without} {self.inputs and self.inputs.digest}"
        return hashlib.sha256(text.encode() + self.V.tobytes()).hexdigest()[:16]

    def unpacked(self) -> ReducedModel:
        """The reduced model, unpacked once per process."""
        return _models.get(
            self.digest,
            lambda: ReducedModel(
                base_of(self.base, self.counts),
                self.V,
                self.samples,
                self.nodes_from_samples,
                self.hot,
                self.shapes,
                self.further,
                self.cycles,
                self.inputs,
            ),
        )


def base_of(packed: Bundle, counts: Counts | None = None) -> RollingTyre:
    """The tyre of a study, built once per process; all variants use its mesh, or its topology (``counts``)."""
    return _bases.get((packed.digest, counts), lambda: tyre_of(unpacked(packed), counts))


def remember(packed: Bundle, base: RollingTyre) -> None:
    """Make `base_of` return this tyre in this process, unless it has a tyre of the same study."""
    _bases.get((packed.digest, _counts(base)), lambda: base)


def _counts(base: RollingTyre) -> Counts | None:
    return None if base.topology is None else base.topology.counts


def pack(model: ReducedModel, base: Bundle) -> PackedModel:
    """A model packed for other processes; ``base``: the study that it was made for."""
    arrays = (model.V, model.samples, model.nodes_from_samples, model.hot)
    return PackedModel(base, *arrays, _counts(model.base), model.shapes, model.further, model.cycles, model.inputs)


#: Models and tyres that a process keeps: two sweeps may run on threads of one worker.
KEPT = 2
_models: Cache[ReducedModel] = Cache(KEPT)
_bases: Cache[RollingTyre] = Cache(KEPT)


@dataclass(frozen=True, eq=False)
class ReducedTask:
    """Variants for the reduced model: their changes, in order. ``time_to``: see `answers`."""

    changes: Sequence[Mapping[str, Any]]
    time_to: float | None = None


def perform_reduced(task: ReducedTask, packed: PackedModel) -> tuple[ReducedOutcome, ...]:
    """Run in a worker: the outcome of every variant, in the order of the task."""
    model = packed.unpacked()
    learnt = learnt_outcomes(model, task.changes, task.time_to)
    if learnt is not None:
        return tuple(learnt)
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


ProgressCallback = Callable[[str, int, int], None]


#: Variants corrected by residuals in a round: per number that varies, and at least.
CORRECTIONS_PER_NUMBER, LEAST_CORRECTIONS = 2.0, 10


#: Variants corrected in one task: few enough to occupy several processes.
CORRECTIONS_PER_TASK = 5


#: Candidates for every place that is chosen by its estimated error; candidates in one task.
CANDIDATES, CANDIDATES_PER_TASK = 6, 32


#: Batches of presses at most. Strain cycles are learnt if their relative error times the rise of temperature is at most
#: so many times the tolerance: errors of single nodes are larger than those of the heat around them.
PRESS_BATCHES, PRESS_FACTOR = 2, 3.0


#: Times tau of the corrections over the duration of a phase, used in turn.
HORIZONS = (0.1, 0.5)


#: Sample points are stretched about the middle of the box, so that its corners need no extrapolation.
STRETCH = 1.25


@dataclass(frozen=True, eq=False)
class PressTask:
    """A variant to be pressed: the study, the variant's changes, and the counts of the mesh that all shapes share."""

    packed: Bundle
    changes: Mapping[str, Any]
    counts: Counts | None


def perform_press(task: PressTask) -> Press | Failed:
    """Run in a worker: the strain cycles of a variant at the nodes of its mesh."""
    base = base_of(task.packed, task.counts)
    try:
        return press_of(RollingTyre(base.study.replace(task.changes), base))
    except InputError as error:
        return Failed(str(error))


@dataclass(frozen=True, eq=False)
class FullRunTask:
    """A full run of a variant for snapshots, and for answers if wanted.

    Parameters
    ----------
    variant : the variant. fields : snapshots to take. time_tolerance : K, of the run. with_answers : compute answers?
    counts : of the mesh that all shapes share; answers are then also those of a run on the variant's own mesh.
    """

    variant: Task
    fields: int
    time_tolerance: float
    with_answers: bool
    counts: Counts | None = None


@dataclass(frozen=True, eq=False)
class FullRun:
    """Snapshots of a full run, and its answers; without answers the mapping is empty.

    ``own_answers``: of a run on the variant's own mesh, if the shapes share another one.
    """

    snapshots: Snapshots
    answers: Mapping[str, Any] = field(default_factory=dict)
    own_answers: Mapping[str, Any] | None = None


def perform_full_run(task: FullRunTask) -> FullRun | Failed:
    """Run in a worker: a full run of a variant."""
    from tyrefem.conduction import SolverError

    variant, base = task.variant, base_of(task.variant.packed, task.counts)
    try:
        study = base.study.replace(variant.changes)
        if not task.with_answers:
            return FullRun(training_run(RollingTyre(study, base), task.time_tolerance))
        study = study.replace({"numerics.tolerance": f"{task.time_tolerance:.6g} delta_degC"})
        result = run(study, like=base)
        at_own_mesh = None if task.counts is None else answers(run(study), variant.time_to)
        return FullRun(snapshots(result, task.fields), answers(result, variant.time_to), at_own_mesh)
    except (InputError, SolverError) as error:
        return Failed(str(error))


@dataclass(frozen=True, eq=False)
class CandidateTask:
    """Variants whose errors are estimated: their changes."""

    changes: Sequence[Mapping[str, Any]]


def perform_estimates(task: CandidateTask, packed: PackedModel) -> Array:
    """Run in a worker: the estimated error of every variant, K; 0 where there is no estimate."""
    model = packed.unpacked()
    errors, tyres, places = np.zeros(len(task.changes)), [], []
    for place, changes in enumerate(task.changes):
        try:
            tyres.append(model.tyre(model.base.study.replace(changes)))
            places.append(place)
        except InputError:
            continue
    try:
        for numbers, part in batch_solutions(model, tyres, CORRECTION_TOLERANCE):
            estimates = None if isinstance(part, Failed | NotReducible) else estimated_errors(part)
            if estimates is not None:
                errors[[places[number] for number in numbers]] = estimates
    except InputError:
        return errors
    return errors


@dataclass(frozen=True, eq=False)
class CorrectionTask:
    """Variants to be corrected by residuals; ``shares``: tau over the phase duration, per variant."""

    changes: Sequence[Mapping[str, Any]]
    shares: Sequence[float]


@dataclass(frozen=True, eq=False)
class Correction:
    """Corrected snapshots of a reduced run; ``largest``: the largest correction, K."""

    snapshots: Snapshots
    largest: float


def perform_corrections(work: CorrectionTask, packed: PackedModel) -> tuple[Correction | Failed | NotReducible, ...]:
    """Run in a worker: corrections of reduced runs, in the order of the task."""
    model = packed.unpacked()
    base = model.base
    outcomes: dict[int, Correction | Failed | NotReducible] = {}
    tyres: dict[int, RollingTyre] = {}
    for number, changes in enumerate(work.changes):
        try:
            tyres[number] = model.tyre(base.study.replace(changes))
        except InputError as error:
            outcomes[number] = Failed(str(error))
    numbers = list(tyres)
    try:
        for places, part in batch_solutions(model, list(tyres.values()), CORRECTION_TOLERANCE):
            for place, number in enumerate(numbers[task] for task in places):
                if isinstance(part, Failed | NotReducible):
                    outcomes[number] = part
                else:
                    outcomes[number] = Correction(*correction(part, place, work.shares[number]))
    except InputError as error:
        outcomes = {number: Failed(str(error)) for number in numbers} | outcomes
    return tuple(outcomes[number] for number in range(len(work.changes)))


def check_reducible(outcomes: Sequence[object]) -> None:
    """Raise `NotReducibleError` if the reduced model cannot follow one of the variants."""
    for outcome in outcomes:
        if isinstance(outcome, NotReducible):
            raise NotReducibleError(outcome.reason)


class Training:
    """Training of a reduced model: full runs and residual corrections give the snapshots."""

    def __init__(
        self, plan: Plan, scheduler: Scheduler, fineness: ReducedFineness, report: ProgressCallback, seed: int
    ) -> None:
        from scipy.stats import qmc

        self.plan, self.scheduler, self.fineness, self.report = plan, scheduler, fineness, report
        self.counts = counts_of(plan)
        self.base = tyre_of(plan.study, self.counts)
        remember(plan.packed, self.base)
        self.snapshots: list[Snapshots] = []
        self.cycles: LearntCycles | None = None
        self.correction_count = 0
        self.round_size = max(LEAST_CORRECTIONS, int(np.ceil(CORRECTIONS_PER_NUMBER * len(plan.varied))))
        self.sequence = qmc.Halton(len(plan.varied), seed=seed)
        #: Places of corrections -> places that repeat load cases, where these are costly.
        self.repeated: Callable[[list[Array]], list[Array]] = list

    def fresh_places(self, count: int) -> list[Array]:
        """New points of the unit box, from a Halton sequence."""
        return list(self.sequence.random(count))

    def variant(self, place: Array) -> dict[str, Any]:
        """The variant's changes at a point of the unit box."""
        return changes_at(self.plan.varied, place)

    def run(
        self, places: Sequence[Array], time_tolerance: float, what: str, with_answers: bool
    ) -> list[FullRun | Failed]:
        """Outcomes of full runs at points of the box, in order; their snapshots are added to the training."""
        tasks = [
            FullRunTask(
                Task(n, self.plan.packed, self.variant(place), self.plan.time_to),
                self.fineness.fields,
                time_tolerance,
                with_answers,
                self.counts,
            )
            for n, place in enumerate(places)
        ]
        outcomes = self._outcomes(perform_full_run, tasks, what)
        full_runs = [outcome for outcome in outcomes if isinstance(outcome, FullRun)]
        failed = [outcome for outcome in outcomes if isinstance(outcome, Failed)]
        if failed and not full_runs:
            raise NotReducibleError(f"all runs for {what} failed: {failed[0].reason}")
        self.snapshots += [outcome.snapshots for outcome in full_runs]
        return outcomes

    def correction_rounds(self, most: int, enough: float, *, search: bool = False) -> ReducedModel:
        """A model trained on corrections at new points, until the largest correction is at most ``enough`` K.

        ``search``: from the second round on, half of the points are those with the largest estimated errors of many.
        """
        for number in range(most):
            searching = search and number > 0 and self.counts is None
            model = self._trained(further=searching)
            packed = pack(model, self.plan.packed)
            places = self.repeated(self._worst(packed) if searching else self._stretched(self.round_size))
            changes = [self.variant(place) for place in places]
            shares = [HORIZONS[n % len(HORIZONS)] for n in range(len(places))]
            firsts = range(0, len(places), CORRECTIONS_PER_TASK)
            work = [
                CorrectionTask(changes[n : n + CORRECTIONS_PER_TASK], shares[n : n + CORRECTIONS_PER_TASK])
                for n in firsts
            ]
            parts = self._outcomes(perform_corrections, work, "correcting", packed)
            # A task that failed as a whole, e.g. because its process died, gives no snapshots.
            outcomes = [outcome for part in parts for outcome in ((part,) if isinstance(part, Failed) else part)]
            check_reducible(outcomes)
            corrected = [outcome for outcome in outcomes if isinstance(outcome, Correction)]
            self.snapshots += [outcome.snapshots for outcome in corrected]
            self.correction_count += len(outcomes)
            if max((outcome.largest for outcome in corrected), default=0.0) <= enough:
                break
        return self._trained(further=True)

    def _trained(self, *, further: bool) -> ReducedModel:
        return replace(trained(self.base, self.snapshots, self.fineness, further=further), cycles=self.cycles)

    def learn_cycles(self, tolerance: float) -> None:
        """Learn the strain cycles from presses, where every variant would cost one.

        Where their error would change temperatures by more than the tolerance, K, every variant is pressed.
        """
        numbers = mechanical_numbers(self.plan.study, self.plan.varied)
        if not numbers:
            return
        fields = [snapshot.fields for snapshot in self.snapshots]
        rise = max(float(np.ptp(field)) for field in fields)
        known: list[tuple[Array, Press]] = []
        for _ in range(PRESS_BATCHES):
            known += self._pressed(numbers, len(known))
            at = np.array([place[numbers] for place, _ in known])
            varied = [self.plan.varied[number] for number in numbers]
            cycles = learnt(self.base, varied, at, [press for _, press in known])
            if cycles.error * rise <= PRESS_FACTOR * tolerance:
                self.cycles = cycles
                return

    def _pressed(self, numbers: Sequence[int], known: int) -> list[tuple[Array, Press]]:
        """Presses at new places."""
        places = self._stretched(press_count(len(numbers)))
        if len(numbers) == 1:
            # Many places of a line would lie on its ends; those of the next batch lie between those of the first.
            even = np.linspace(0.0, 1.0, len(places))
            for place, part in zip(places, even if not known else (even[:-1] + even[1:]) / 2, strict=False):
                place[numbers] = part
        tasks = [PressTask(self.plan.packed, self.variant(place), self.counts) for place in places]
        outcomes = self._outcomes(perform_press, tasks, "pressing")
        pressed = [(place, press) for place, press in zip(places, outcomes, strict=True) if isinstance(press, Press)]
        if len(pressed) < len(places):
            raise NotReducibleError(next(outcome.reason for outcome in outcomes if isinstance(outcome, Failed)))
        return pressed

    def over_shapes(self, model: ReducedModel) -> ReducedModel:
        """The model with projected operators over the box's shapes, if the section varies."""
        if self.counts is None:
            return model
        studies = []
        for place in self._stretched(shape_count(self.plan.varied)):
            try:
                studies.append(self.plan.study.replace(self.variant(place)))
            except InputError:
                continue
        return with_shapes(model, studies)

    def _worst(self, packed: PackedModel) -> list[Array]:
        """New points of the unit box: half of them those with the largest estimated errors of many."""
        some = self.round_size // 2
        candidates = self._stretched(CANDIDATES * some)
        firsts = range(0, len(candidates), CANDIDATES_PER_TASK)
        tasks = [
            CandidateTask([self.variant(place) for place in candidates[n : n + CANDIDATES_PER_TASK]]) for n in firsts
        ]
        parts = self._outcomes(perform_estimates, tasks, "searching", packed)
        errors = np.concatenate([[] if isinstance(part, Failed) else part for part in parts])
        if len(errors) < len(candidates):
            return self._stretched(self.round_size)
        worst = [candidates[int(n)] for n in np.argsort(errors)[::-1][:some]]
        return worst + self._stretched(self.round_size - some)

    def _stretched(self, count: int) -> list[Array]:
        """New points of the unit box; many lie on its faces."""
        return [np.clip(0.5 + STRETCH * (place - 0.5), 0.0, 1.0) for place in self.fresh_places(count)]

    def _outcomes(
        self, work: Callable[..., Result], tasks: Sequence[Any], what: str, common: Any = None
    ) -> list[Result | Failed]:
        outcomes: dict[int, Result | Failed] = {}
        for place, outcome in self.scheduler.outcomes(work, tasks, common):
            outcomes[place] = outcome
            self.report(what, len(outcomes), len(tasks))
        return [outcomes[n] for n in range(len(tasks))]
