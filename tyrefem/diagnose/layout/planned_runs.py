"""The runs that a study plans, before any data: their drives and readings, and the sensitivities of these."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from tyrefem.compare.sensors import OUTSIDE_THE_RUBBER
from tyrefem.diagnose.data.sensitivities import Sensitivities, responses, sensitivities, unknowns_of
from tyrefem.diagnose.forward.drive_response import DriveResponse
from tyrefem.diagnose.forward.effort import SENSITIVITIES, check_effort
from tyrefem.diagnose.forward.evaluations import Evaluations, ProgressStore, evaluating
from tyrefem.diagnose.forward.forward_model import ForwardModel
from tyrefem.diagnose.forward.sampling import DriveSampling, SensorSampling
from tyrefem.diagnose.forward.worker_queues import Workers, number_of
from tyrefem.diagnose.unknowns.candidates import Candidate, catalogue_candidates
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.requirements import Requirements

#: What a study must have for isolability.
NEEDS = Requirements("isolability", fitted=True)
#: Assumed interval between two readings, s.
READING_INTERVAL = 10.0


def planned(study: StudyData, sensors: Sequence[str] = ()) -> tuple[DriveSampling, ...]:
    """The planned runs: the study's ``[[measured]]`` entries, or its drive, with all sensors read every 10 s.

    Raises
    ------
    InputError : a drive is shorter than the interval between two readings.
    """
    entries = study.measured
    plans = [(entry.run or f"run {n + 1}", dict(entry.drive), entry.hold_out) for n, entry in enumerate(entries)]
    samplings = []
    for name, drive, hold_out in plans or [("the study's own drive", {}, False)]:
        driven = study.with_drive(drive) if drive else study
        if driven.card.drive.end < READING_INTERVAL:
            least = f"it must last at least {READING_INTERVAL:g} s, the interval between two readings"
            message = f"{name} lasts {driven.card.drive.end:g} s; {least}"
            raise InputError(message, field="drive", file=study.file)
        times = np.arange(0.0, driven.card.drive.end + READING_INTERVAL / 2, READING_INTERVAL)
        choice = study.card.diagnosis
        names = list(sensors) or [*study.sensors, OUTSIDE_THE_RUBBER[0]]
        sampled = tuple(
            SensorSampling(
                sensor,
                times,
                study.sensors[sensor].noise if sensor in study.sensors else 0.5,
                choice.discrepancy,
                choice.correlation_time,
            )
            for sensor in names
        )
        samplings.append(DriveSampling(name, drive, hold_out, sampled))
    return tuple(samplings)


def layout_notes(study: StudyData) -> tuple[str, ...]:
    """Sentences on sensors and runs that the study lacks, and what `planned` takes instead."""
    notes = []
    if not study.sensors:
        notes.append("The study has no [sensors]: only the contained air is read.")
    if not study.measured:
        notes.append("The study has no [[measured]] runs: its drive is the only run.")
    return tuple(notes)


def candidates_of(study: StudyData) -> tuple[Candidate, ...]:
    """The effects that a study may lack.

    Raises
    ------
    InputError : there is none.
    """
    candidates = catalogue_candidates(study)
    if not candidates:
        message = "no effect of the catalogue is left that the study may lack: exclude fewer"
        raise InputError(message, field="diagnosis.exclude", file=study.file)
    return candidates


def planned_sensitivities(
    study: StudyData,
    *,
    workers: Workers = 1,
    progress: Callable[[str, int, int], None] | None = None,
    store: ProgressStore | None = None,
) -> Sensitivities:
    """Sensitivities of the planned runs of a study; arguments and errors are those of `isolability`."""
    NEEDS.check(study)
    candidates_of(study)
    model = ForwardModel(study, planned(study))
    check_effort(model, f"the sensitivities of {study.name}", SENSITIVITIES, number_of(workers))
    if store is not None:
        store.open(model)
    with evaluating(model, workers, store) as evaluations:
        return layout_sensitivities(evaluations, progress=progress)


def layout_sensitivities(
    evaluations: Evaluations,
    responses_at_hand: Sequence[DriveResponse] | None = None,
    progress: Callable[[str, int, int], None] | None = None,
) -> Sensitivities:
    """Sensitivities of the planned runs to all unknowns that their diagnosis may fit."""
    model = evaluations.model
    read = {name for drive in model.drives for name in drive.parts()}
    unknowns, nuisance = unknowns_of(model.study, read, catalogue_candidates(model.study), model.settings)
    known = responses_at_hand or responses(evaluations, unknowns, progress)
    return sensitivities(model.drives, unknowns, nuisance, known)
