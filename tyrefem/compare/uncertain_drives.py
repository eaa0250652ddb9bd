"""Uncertain numbers of the drive: the drive of every measured run must use them."""

from __future__ import annotations

from collections.abc import Sequence

from tyrefem.compare.experiment import Experiment
from tyrefem.errors import InputError
from tyrefem.inputs.changes import is_overridden
from tyrefem.inputs.drive_table import EXCLUSIVE_KEYS
from tyrefem.inputs.study import StudyData


def check_uncertain_drives(study: StudyData, planned: Sequence[Experiment]) -> None:
    """Check that the drive of every run uses the numbers of the drive that the study states as uncertain.

    A run's entry may replace them: the load by a deflection, the speed of ``[drive]`` by one of each phase.

    Raises
    ------
    InputError : a run's drive lacks such a number, or each of its phases sets its own; says what to write instead.
    """
    if not any(number.key.startswith("drive.") for number in study.uncertain_numbers):
        return
    for experiment in planned:
        at_run = study.with_drive(dict(experiment.drive)) if experiment.drive else study
        try:
            _ = at_run.uncertain_numbers
        except InputError as error:
            key = (error.field or "").removeprefix("uncertainty.")
            if not key.startswith("drive."):
                raise
            wrong = f"run '{experiment.name}' ({experiment.run.file}): {_reason(at_run, experiment, key, error)}"
            raise InputError(wrong, field=error.field, file=study.file) from None


def _reason(at_run: StudyData, experiment: Experiment, key: str, error: InputError) -> str:
    """What is wrong with the uncertain number in a run, and what to write."""
    short = key.removeprefix("drive.")
    same = {short, *EXCLUSIVE_KEYS.get(short, ())}
    instead = [f"'{name}'" for name in experiment.drive if name.rpartition(".")[2] in same and name != short]
    place = f" in place of {' and '.join(instead)}" if instead else ""
    wrong = error.message
    if is_overridden(at_run.data, key):
        wrong = f"every phase of its drive sets '{' or '.join(sorted(same))}'"
    entry = f"in its [[measured]] entry, write '{short}' in 'drive'{place}"
    return f"{wrong}; {entry}, or leave '{key}' out of [uncertainty]"
