"""What nothing is compared with: readings outside the simulated span, columns without temperatures, a warm start."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import counted
from tyrefem.compare.experiment import Experiment
from tyrefem.compare.sensors import OUTSIDE_THE_RUBBER
from tyrefem.inputs.study import StudyData

#: How a note begins that stands in the summary, too.
ERROR = "ERROR: "
#: Estimates: a reading up to so many s counts as one of the start; so many K off the drive's start it is reported.
EARLY, WARM = 15.0, 10.0


def outside_note(experiment: Experiment, first: float, last: float, outside: int) -> list[str]:
    """A note on readings outside the simulated span; an error if they are more than half of the run."""
    if not outside:
        return []
    total = len(experiment.run.times)
    level = ERROR if 2 * outside > total else "Note: "
    return [
        f"{level}run '{experiment.name}': {outside} of {total} measured times lie outside the simulated span "
        f"{first:g} to {last:g} s and are not compared{_clock(experiment, first, last) if outside == total else ''}"
    ]


def _clock(experiment: Experiment, first: float, last: float) -> str:
    """What to write if the logger's clock is another one: the run fits into the span, but elsewhere."""
    begin, end = (float(experiment.run.times[place]) for place in (0, -1))
    if end - begin > last - first:
        return ""
    return (
        f" (its clock runs from {begin:g} to {end:g} s: if the drive starts with it, add {first - begin:.12g} s to the "
        "'time_offset' of its [[measured]] entry)"
    )


def within(study: StudyData, experiment: Experiment) -> NDArray[np.bool_]:
    """Which readings are within the drive of their run."""
    return inside(experiment, _end(study, experiment))


def inside(experiment: Experiment, end: float) -> NDArray[np.bool_]:
    """Which readings are within a drive of so many seconds."""
    times = experiment.run.times
    return (times >= -1e-9) & (times <= end * (1 + 1e-9))


def outside_notes(study: StudyData, planned: Sequence[Experiment]) -> list[str]:
    """The notes on readings outside the drives of their runs, before any simulation."""
    notes = []
    for experiment in planned:
        end = _end(study, experiment)
        notes += outside_note(experiment, 0.0, end, int(np.sum(~inside(experiment, end))))
    return notes


def _end(study: StudyData, experiment: Experiment) -> float:
    """Last time of the drive of a run, s."""
    return (study.with_drive(dict(experiment.drive)) if experiment.drive else study).card.drive.end


def start_notes(study: StudyData, planned: Sequence[Experiment]) -> list[str]:
    """Notes on runs whose tyre did not start at the temperature of the drive: the median of the first readings."""
    notes = []
    for experiment in planned:
        run = experiment.run
        early = (run.times >= -1e-9) & (run.times <= EARLY)
        columns = [run.temperatures[name].to_numpy(dtype=float)[early] for name in run.sensors if _in_rubber(name)]
        first = [column[np.isfinite(column)][0] for column in columns if np.isfinite(column).any()]
        if not first:
            continue
        initial = (study.with_drive(dict(experiment.drive)) if experiment.drive else study).card.drive.initial
        start = float(np.median(first))
        if abs(start - initial) > WARM:
            notes.append(
                f"Note: run '{experiment.name}' begins at {start:.0f} degC (median of "
                f"{counted(len(first), 'sensor')} in the first {EARLY:g} s), its drive at {initial:.0f} "
                "degC: if the tyre was warm, state drive.initial in the run's [[measured]] entry"
            )
    return notes


def _in_rubber(sensor: str) -> bool:
    return sensor not in OUTSIDE_THE_RUBBER


def columns_note(planned: Sequence[Experiment]) -> list[str]:
    """A note on columns without temperatures."""
    channels = dict.fromkeys(heading for experiment in planned for heading in experiment.run.channels)
    return [f"Note: columns without temperatures are left out: {', '.join(channels)}"] if channels else []


def table_notes(planned: Sequence[Experiment]) -> list[str]:
    """A note for each table with content beyond the plain form: how it was read."""
    notes: dict[str, list[str]] = {}
    for experiment in planned:
        run = experiment.run
        if run.notes:
            table = run.file.name if run.file is not None else f"run '{experiment.name}'"
            notes.setdefault(table, []).extend(run.notes)
    return [f"Note: {table}: {'; '.join(dict.fromkeys(lines))}" for table, lines in notes.items()]
