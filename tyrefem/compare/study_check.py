"""Check of the names in a study file: uncertain numbers, drives, measured runs and columns of tables."""

from __future__ import annotations

from tyrefem.compare.experiment import experiments
from tyrefem.compare.uncertain_drives import check_uncertain_drives
from tyrefem.errors import InputError, nearest
from tyrefem.inputs.study import StudyData
from tyrefem.inputs.uncertain_numbers import uncertain_at
from tyrefem.mechanics.solved_cases import check_cases


def check_study(study: StudyData) -> int:
    """Check all names of a study without running it; returns the number of its measured runs.

    Raises
    ------
    InputError : a mesh file that is missing or does not suit the section; an impossible load, a missing uncertain
        number, a wrong drive of a measured table, a missing table, run or column; the study's own run is none of the
        measured ones.
    """
    if study.card.mesh.file is not None:
        study.mesh()
    check_cases(study)
    for key in study.card.uncertainty:
        try:
            uncertain = uncertain_at(study, key)
            study.scaled(key, 1 + (uncertain.sd if uncertain else 0.0))
        except InputError as error:
            raise InputError(
                f"one standard deviation more: {error}", field=f"uncertainty.{key}", file=study.file
            ) from None
    for number, entry in enumerate(study.card.measured):
        if entry.drive:
            _check_drive(study, number)
    planned = experiments(study) if study.measured else ()
    check_uncertain_drives(study, planned)
    names = {experiment.origin for experiment in planned}
    if study.card.run is not None and names and study.card.run not in names:
        wrong = f"no measured run '{study.card.run}'{nearest(study.card.run, names)}"
        raise InputError(wrong, field="run", file=study.file)
    return len(planned)


def _check_drive(study: StudyData, number: int) -> None:
    entry = study.card.measured[number]
    try:
        check_cases(study.with_drive(entry.drive))
    except InputError as error:
        if error.file not in (None, study.file):
            raise
        raise InputError(error.message, field=f"measured.{number}.{error.field or 'drive'}", file=study.file) from None
