"""Tasks of a training, as workers run them: presses, full runs, error estimates, corrections."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.geometry.meshing.mapped import Counts
from tyrefem.reduced.answers import batch_solutions
from tyrefem.reduced.error_estimate import estimated_errors
from tyrefem.reduced.learnt_cycles import Press, press_of
from tyrefem.reduced.packed_model import PackedModel, base_of
from tyrefem.reduced.residual import TIME_TOLERANCE as CORRECTION_TOLERANCE
from tyrefem.reduced.residual import correction
from tyrefem.reduced.training import Snapshots, snapshots, training_run
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.simulation.run import run
from tyrefem.variants.answers import answers
from tyrefem.variants.outcomes import Failed, NotReducible
from tyrefem.variants.task import Bundle, Task

Array = NDArray[np.float64]


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
