"""The measured runs of a diagnosis: readings in blocks of time, with the uncertainty of each block."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tyrefem.compare.experiment import Experiment
from tyrefem.compare.omitted import ERROR, columns_note, outside_notes, start_notes, table_notes, within
from tyrefem.diagnose.data.noise import ReadingNoise, noise_of
from tyrefem.diagnose.forward.sampling import DriveSampling, SensorSampling
from tyrefem.diagnose.settings import DEFAULT, DiagnosisSettings
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class MeasuredSensor(SensorSampling):
    """The readings of one sensor in one run: ``measured`` (n,) degC at ``times``.

    ``origin``: the stated noise and that of the readings' scatter; None: ``noise`` is the stated one.
    """

    measured: Array = field(kw_only=True)
    origin: ReadingNoise | None = field(default=None, kw_only=True)

    @property
    def sampling(self) -> SensorSampling:
        """The sampling without the readings."""
        return SensorSampling(**{each.name: getattr(self, each.name) for each in fields(SensorSampling)})


@dataclass(frozen=True, eq=False)
class MeasuredDrive(DriveSampling):
    """A measured run: its drive, and the readings of every sensor."""

    sensors: tuple[MeasuredSensor, ...]

    @property
    def last(self) -> float:
        """Time of the last reading, s."""
        return max(float(readings.times[-1]) for readings in self.sensors)

    @cached_property
    def measured(self) -> Array:
        """Block means of all sensors, one after the other, degC."""
        return np.concatenate([readings.block_means(readings.measured) for readings in self.sensors])

    @cached_property
    def sampling(self) -> DriveSampling:
        """The drive and the sampling of the run, without the readings."""
        sensors = tuple(readings.sampling for readings in self.sensors)
        return DriveSampling(self.name, self.drive, self.hold_out, sensors, origin=self.origin)


def drive_of_means(sampling: DriveSampling, means: Array) -> MeasuredDrive:
    """A run whose block means, of all sensors one after the other, are ``means`` (n_blocks,) degC."""
    sensors = []
    for readings, place in zip(sampling.sensors, sampling.parts().values(), strict=True):
        measured = np.repeat(means[place], readings.sizes.astype(int))
        stated = {each.name: getattr(readings, each.name) for each in fields(SensorSampling)}
        sensors.append(MeasuredSensor(**stated, measured=measured))
    return MeasuredDrive(sampling.name, sampling.drive, sampling.hold_out, tuple(sensors), origin=sampling.origin)


def measured_drive(experiment: Experiment, study: StudyData, settings: DiagnosisSettings = DEFAULT) -> MeasuredDrive:
    """The measured run of an experiment with the stated noise; only readings within the simulated drive."""
    choice, run = study.card.diagnosis, experiment.run
    in_drive = within(study, experiment)
    sensors = []
    for sensor in run.sensors:
        values = run.temperatures[sensor].to_numpy(dtype=float)
        used = np.isfinite(values) & in_drive
        if not used.any():
            continue
        stated = experiment.noise_of(sensor, study)
        correlated = choice.discrepancy, choice.correlation_time
        times, measured = run.times[used], values[used]
        sensors.append(MeasuredSensor(sensor, times, stated, *correlated, settings.blocks, measured=measured))
    drive = dict(experiment.drive)
    return MeasuredDrive(experiment.name, drive, experiment.hold_out, tuple(sensors), origin=experiment.origin)


def with_noise_of_data(
    runs: tuple[MeasuredDrive, ...], settings: DiagnosisSettings = DEFAULT
) -> tuple[MeasuredDrive, ...]:
    """The runs with the noise that their readings show, where it differs clearly from the stated one: `noise_of`."""
    sensors = [readings for run in runs for readings in run.sensors]
    # Noise is a matter of differences: the level of the readings stays here.
    series = [(readings.sensor, readings.times, readings.measured - readings.measured[0]) for readings in sensors]
    estimates = iter(noise_of(series, [readings.noise for readings in sensors], settings))

    def judged(readings: MeasuredSensor) -> MeasuredSensor:
        noise = next(estimates)
        return replace(readings, noise=noise.used, rounding=noise.rounding, origin=noise)

    return tuple(replace(run, sensors=tuple(judged(readings) for readings in run.sensors)) for run in runs)


def measured_drives(
    study: StudyData, planned: Sequence[Experiment], settings: DiagnosisSettings
) -> tuple[tuple[MeasuredDrive, ...], tuple[str, ...]]:
    """The measured runs as blocks of readings within the simulated drives, and notes on what is left out.

    A held-out run with readings at 0 s only is left out: they are the initial temperature, and test nothing.
    """
    runs = [run for run in (measured_drive(experiment, study, settings) for experiment in planned) if run.sensors]
    fitted = [run for run in runs if not run.hold_out]
    if not fitted:
        outside = "; ".join(outside_notes(study, planned)).replace(ERROR, "")
        message = f"no fitted run has a reading within the simulated drive: {outside}"
        raise InputError(message, field="measured", file=study.file)
    for run in fitted:
        if run.last <= 0:
            raise InputError(f"run '{run.name}' has readings at 0 s only", field="measured", file=study.file)
    empty = [run for run in runs if run.last <= 0]
    notes = (
        *outside_notes(study, planned),
        *start_notes(study, planned),
        *columns_note(planned),
        *table_notes(planned),
    )
    return with_noise_of_data(tuple(run for run in runs if run not in empty), settings), (
        *(f"held-out run '{run.name}' was left out: it has readings at 0 s only, which test nothing" for run in empty),
        *(note.removeprefix("Note: ") for note in notes),
    )
