"""The measured runs of a diagnosis: readings in blocks of time, with the uncertainty of each block."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tyrefem.compare.experiment import Experiment
from tyrefem.diagnose.sampling import DriveSampling, SensorSampling
from tyrefem.diagnose.settings import DEFAULT, DiagnosisSettings
from tyrefem.inputs.study import StudyData

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class MeasuredSensor(SensorSampling):
    """The readings of one sensor in one run: ``measured`` (n,) degC at ``times``."""

    measured: Array = field(kw_only=True)

    @property
    def sampling(self) -> SensorSampling:
        """The sampling without the readings."""
        return SensorSampling(self.sensor, self.times, self.noise, self.discrepancy, self.correlation_time, self.blocks)


@dataclass(frozen=True, eq=False)
class MeasuredDrive(DriveSampling):
    """A measured run: its drive, and the readings of every sensor."""

    sensors: tuple[MeasuredSensor, ...]

    @cached_property
    def measured(self) -> Array:
        """Block means of all sensors, one after the other, degC."""
        return np.concatenate([readings.block_means(readings.measured) for readings in self.sensors])

    @cached_property
    def sampling(self) -> DriveSampling:
        """The drive and the sampling of the run, without the readings."""
        sensors = tuple(readings.sampling for readings in self.sensors)
        return DriveSampling(self.name, self.drive, self.hold_out, sensors)


def measured_drive(experiment: Experiment, study: StudyData, settings: DiagnosisSettings = DEFAULT) -> MeasuredDrive:
    """The measured run of an experiment, with its readings within the simulated drive."""
    choice, run = study.card.diagnosis, experiment.run
    driven = study.with_drive(dict(experiment.drive)) if experiment.drive else study
    end = driven.card.drive.end
    sensors = []
    for sensor in run.sensors:
        values = run.temperatures[sensor].to_numpy(dtype=float)
        used = np.isfinite(values) & (run.times >= -1e-9) & (run.times <= end * (1 + 1e-9))
        if not used.any():
            continue
        card = study.sensors.get(sensor)
        stated = experiment.noise or (card.noise if card is not None else 0.5)
        times, measured = run.times[used], values[used]
        noise = max(stated, _scatter(times, measured))
        correlated = choice.discrepancy, choice.correlation_time
        sensors.append(MeasuredSensor(sensor, times, noise, *correlated, settings.blocks, measured=measured))
    return MeasuredDrive(experiment.name, dict(experiment.drive), experiment.hold_out, tuple(sensors))


def _scatter(times: Array, values: Array) -> float:
    """Noise estimated from second differences of the readings, divided by 1.33, K; 0 for fewer than 12 readings.

    Var(y_i - interpolation of its neighbours) = noise^2 (1 + w^2 + (1 - w)^2). The median makes the estimate robust
    against jumps and outliers. Because of the division, only a scatter a third above the stated noise replaces it.
    """
    if len(times) < 12:
        return 0.0
    share = (times[1:-1] - times[:-2]) / (times[2:] - times[:-2])
    inside = (1 - share) * values[:-2] + share * values[2:]
    deviation = (values[1:-1] - inside) / np.sqrt(1 + share**2 + (1 - share) ** 2)
    return float(np.median(np.abs(deviation)) / 0.6745 / 1.33)
