"""The readings of every drive and sensor that a plan may use, as every set of effects predicts them."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.diagnose.data.sensitivities import Sensitivities, responses, sensitivities
from tyrefem.diagnose.forward.effort import SENSITIVITIES, check_effort
from tyrefem.diagnose.forward.evaluations import Evaluations, evaluating
from tyrefem.diagnose.forward.forward_model import ForwardModel
from tyrefem.diagnose.forward.multifidelity import Predictions
from tyrefem.diagnose.forward.sampling import DriveSampling, SensorSampling
from tyrefem.diagnose.forward.worker_queues import number_of
from tyrefem.diagnose.layout.planned_runs import READING_INTERVAL
from tyrefem.diagnose.options import SimulationWork
from tyrefem.diagnose.settings import DEFAULT, DiagnosisSettings
from tyrefem.diagnose.unknowns.unknown import Unknown, sensor_unknowns
from tyrefem.errors import InputError, OutputError
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.strain_laws import strain_law
from tyrefem.plan.beliefs import NOISE, Beliefs
from tyrefem.plan.drives import CandidateDrive, refused_drive
from tyrefem.plan.information import Gaussians, projected
from tyrefem.plan.places import CandidatePlace

Array = NDArray[np.float64]
Tick = Callable[[str, int, int], None]


@dataclass(frozen=True, eq=False)
class PlannedReadings(Brief):
    """Gram matrices of the readings of every sensor at every drive.

    Parameters
    ----------
    beliefs : the sets. installed : sensors that every run reads. unknowns : columns of the slopes.
    of_sensor : further sensor -> numbers of its unknowns. grams : (number of the drive, sensor) -> A^T A (m, m), with
        the whitened columns A = [slopes of the unknowns, changes of the readings by every set].
    """

    beliefs: Beliefs
    installed: tuple[str, ...]
    unknowns: tuple[Unknown, ...]
    of_sensor: dict[str, list[int]]
    grams: dict[tuple[int, str], Array]

    def expected(self, drives: Sequence[int], added: Collection[str]) -> Gaussians:
        """What the sets predict for several runs, read by the installed and by added sensors.

        All runs share base numbers, amplitudes and sensors; noise and discrepancy of two runs are independent.
        """
        sensors = (*self.installed, *sorted(added))
        gram = np.sum([self.grams[number, sensor] for number in drives for sensor in sensors], axis=0)
        n = len(self.unknowns)
        further = [number for name in sorted(added) for number in self.of_sensor[name]]
        idle = {number for name in set(self.of_sensor) - set(added) for number in self.of_sensor[name]}
        active = [number for number in range(n) if gram[number, number] > 0 and number not in idle]
        kept = [*active, *range(n, len(gram))]
        factors = []
        for L in self._factors:
            sd = np.zeros((len(self.unknowns), len(further)))
            sd[further, range(len(further))] = [self.unknowns[number].sd for number in further]
            factors.append(np.hstack([L, sd])[active])
        return projected(gram[np.ix_(kept, kept)], len(active), factors, self.beliefs.probabilities)

    @cached_property
    def _factors(self) -> list[Array]:
        """By set L (n, r): covariance L L^T of its unknowns; unknowns that it does not have are 0."""
        place = {unknown: column for column, unknown in enumerate(self.unknowns)}
        factors = []
        for entry in self.beliefs.sets:
            values, vectors = np.linalg.eigh(entry.covariance)
            root = vectors * np.sqrt(np.maximum(values, 0.0))
            L = np.zeros((len(self.unknowns), len(values)))
            for row, unknown in enumerate(entry.unknowns):
                if unknown in place:
                    L[place[unknown]] = root[row]
            factors.append(L)
        return factors


def planned_readings(
    beliefs: Beliefs,
    study: StudyData,
    drives: Sequence[CandidateDrive],
    places: Sequence[CandidatePlace],
    work: SimulationWork,
    settings: DiagnosisSettings = DEFAULT,
) -> PlannedReadings:
    """Simulate every drive with its sensitivities, and predict its readings for every set.

    After a verdict, the change of the readings by a set is that of its fit: by the certified reduced model of the
    drive, or by simulation. Before a test it is linear. Slopes are those at x = 0.

    Parameters
    ----------
    study : with the sensors of ``places``.
    work : its ``known`` are responses of the drives to these unknowns or to more, if they are available.

    Raises
    ------
    InputError : a drive cannot run; the given responses belong to another study.
    """
    samplings = tuple(_sampling(beliefs, study, drive, places) for drive in drives)
    model = ForwardModel(study, samplings, settings=settings)
    if work.known is None:
        _check_drives(model, drives)
        check_effort(model, f"the plan of {study.name}", SENSITIVITIES, number_of(work.workers))
    if work.store is not None:
        work.store.open(model)
    unknowns, presence = _columns(beliefs)
    installed = tuple(sampling.sensor for sampling in samplings[0].sensors[: len(beliefs.noise)])
    further: list[Unknown] = []
    of_sensor: dict[str, list[int]] = {}
    for place in places:
        of_place = sensor_unknowns(study, {place.name})
        of_sensor[place.name] = list(range(len(unknowns) + len(further), len(unknowns) + len(further) + len(of_place)))
        further += of_place
    columns = (*unknowns, *further)
    everything = (*columns, *presence)
    with evaluating(model, work.workers, work.store) as evaluations:
        try:
            at_hand = work.known or responses(evaluations, everything, work.progress)
        except OutputError:
            raise
        except InputError as error:
            raise InputError(f"a drive of the plan cannot run: {error}", field="plan.limits", file=study.file) from None
        sensitive = sensitivities(samplings, everything, 0, [response.of(everything) for response in at_hand])
        beliefs = beliefs.without(sensitive.failed)
        changes = _changes(beliefs, sensitive, evaluations, work.progress)
    grams: dict[tuple[int, str], Array] = {}
    for number, drive in enumerate(samplings):
        J = np.nan_to_num(sensitive.whitened[number][:, : len(columns)])
        A = np.column_stack([J, *changes[number]])
        for sensor, rows in drive.parts().items():
            grams[number, sensor] = A[rows].T @ A[rows]
    return PlannedReadings(beliefs, installed, columns, of_sensor, grams)


def _sampling(
    beliefs: Beliefs, study: StudyData, drive: CandidateDrive, places: Sequence[CandidatePlace]
) -> DriveSampling:
    """A drive with the readings of all sensors, every 10 s."""
    times = np.arange(0.0, drive.duration + READING_INTERVAL / 2, READING_INTERVAL)
    noises = beliefs.noise | {
        place.name: study.sensors[place.name].noise if place.name in study.sensors else NOISE for place in places
    }
    choice = study.card.diagnosis
    sensors = tuple(
        SensorSampling(name, times, noise, choice.discrepancy, choice.correlation_time)
        for name, noise in noises.items()
    )
    return DriveSampling(f"next: {drive.name}", dict(drive.changes), False, sensors)


def _check_drives(model: ForwardModel, drives: Sequence[CandidateDrive]) -> None:
    """Refuse a drive that cannot run before the others are simulated; by finite elements that would take too long."""
    if strain_law(model.coarse).by_elements:
        return
    for number, drive in enumerate(drives):
        try:
            model.base(number)
        except InputError as error:
            raise refused_drive(model.study, drive.changes, error) from None


def _columns(beliefs: Beliefs) -> tuple[tuple[Unknown, ...], tuple[Unknown, ...]]:
    """Unknowns of all sets that act in every run, and those of effects without amplitude.

    Shape parameters are left out: without the effect's amplitude, at x = 0, they change nothing.
    """
    members = [member for entry in beliefs.sets for member in entry.members if not member.runs]
    shapes = {unknown for member in members for unknown in member.shapes}
    every = (unknown for entry in beliefs.sets for unknown in entry.unknowns)
    unknowns = dict.fromkeys(unknown for unknown in every if not unknown.runs and unknown not in shapes)
    return tuple(unknowns), tuple(dict.fromkeys(unknown for member in members for unknown in member.presence))


def _changes(
    beliefs: Beliefs, sensitive: Sensitivities, evaluations: Evaluations, progress: Tick | None
) -> list[list[Array]]:
    """By drive and set: whitened change of the readings from x = 0 to the mean of the set."""
    place = {unknown: column for column, unknown in enumerate(sensitive.unknowns)}
    numbers = range(len(sensitive.drives))
    predicted: list[list[Array]] = []
    if beliefs.verdict:
        done = 0

        def step() -> None:
            nonlocal done
            done += 1
            if progress is not None:
                progress("predicting the next runs", done, 0)

        predictions = Predictions(evaluations, [response.modes for response in sensitive.responses])
        predicted = predictions.predict([(entry.members, entry.values) for entry in beliefs.sets], numbers, step)
    changes = []
    for number, drive in enumerate(sensitive.drives):
        rows = []
        for order, entry in enumerate(beliefs.sets):
            x = np.zeros(len(sensitive.unknowns))
            for unknown, value in entry.values.items():
                if unknown in place:
                    x[place[unknown]] = value
            change = np.nan_to_num(sensitive.jacobians[number]) @ x
            if predicted and np.isfinite(predicted[order][number]).all():
                change = predicted[order][number] - sensitive.computed[number]
            rows.append(drive.whitened(change))
        changes.append(rows)
    return changes
