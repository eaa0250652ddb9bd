"""The experiments of a diagnosis as data: measured readings in blocks of time, and how uncertain a block is."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky, solve_triangular

from tyrefem.brief import Brief
from tyrefem.compare.experiment import Experiment
from tyrefem.diagnose.settings import DEFAULT, DiagnosisSettings
from tyrefem.inputs.study import StudyData

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Series(Brief):
    """The readings of one sensor in one run: ``times`` (n,) s, ``measured`` (n,) degC, ``noise`` K of one reading.

    Means over blocks of neighbouring readings stand for them; the noise of a block of m readings is noise/sqrt(m), and
    what the model misses even when it is right is correlated over time: C = noise^2/m + d^2 exp(-|t - t'|/tau).
    """

    sensor: str
    times: Array
    measured: Array
    noise: float
    discrepancy: float
    correlation_time: float
    #: Blocks at most.
    blocks: int = DEFAULT.blocks

    @cached_property
    def starts(self) -> NDArray[np.intp]:
        """First reading of every block."""
        count = min(len(self.times), self.blocks)
        return np.unique(np.linspace(0, len(self.times), count + 1).astype(np.intp)[:-1])

    @cached_property
    def sizes(self) -> Array:
        """Number of readings in every block."""
        return np.diff(np.append(self.starts, len(self.times))).astype(float)

    def block_means(self, values: Array) -> Array:
        """Means over the blocks along the first axis of values (n, ...)."""
        shape = (-1,) + (1,) * (values.ndim - 1)
        return np.asarray(np.add.reduceat(values, self.starts, axis=0) / self.sizes.reshape(shape))

    def sampled(self, times: Array, values: Array) -> Array:
        """Block means of a computed history: values (n_times,) or (n_times, k) at ``times`` (s)."""
        if values.ndim == 1:
            return self.block_means(np.interp(self.times, times, values))
        at = np.clip(np.searchsorted(times, self.times, side="right") - 1, 0, len(times) - 2)
        share = np.clip((self.times - times[at]) / (times[at + 1] - times[at]), 0.0, 1.0)[:, None]
        return self.block_means(values[at] * (1 - share) + values[at + 1] * share)

    @cached_property
    def block_times(self) -> Array:
        """Mean time of every block, s."""
        return self.block_means(self.times)

    @cached_property
    def covariance(self) -> Array:
        """(n_blocks, n_blocks) K2."""
        apart = np.abs(self.block_times[:, None] - self.block_times[None, :])
        return np.diag(self.noise**2 / self.sizes) + self.discrepancy**2 * np.exp(-apart / self.correlation_time)

    @cached_property
    def _root(self) -> Array:
        return np.asarray(cholesky(self.covariance, lower=True))

    def whitened(self, blocks: Array) -> Array:
        """L^-1 times block values (n_blocks, ...), with C = L L^T: independent, of unit variance."""
        return np.asarray(solve_triangular(self._root, blocks, lower=True))


@dataclass(frozen=True, eq=False)
class Trial:
    """One measured run: its drive, and a series for every sensor that was read."""

    name: str
    drive: dict[str, object]
    hold_out: bool
    series: tuple[Series, ...]

    @property
    def measured(self) -> Array:
        """Block means of all series, one after the other."""
        return np.concatenate([one.block_means(one.measured) for one in self.series])

    def whitened(self, blocks: Array) -> Array:
        """Whitened values of all series, one after the other."""
        parts, start = [], 0
        for one in self.series:
            end = start + len(one.starts)
            parts.append(one.whitened(blocks[start:end]))
            start = end
        return np.concatenate(parts)

    def parts(self) -> dict[str, slice]:
        """Sensor -> its place among the blocks."""
        found, start = {}, 0
        for one in self.series:
            found[one.sensor] = slice(start, start + len(one.starts))
            start += len(one.starts)
        return found


def trial(experiment: Experiment, study: StudyData, settings: DiagnosisSettings = DEFAULT) -> Trial:
    """An experiment's readings within the simulated drive."""
    choice, run = study.card.diagnosis, experiment.run
    driven = study.with_drive(dict(experiment.drive)) if experiment.drive else study
    end = driven.card.drive.end
    series = []
    for sensor in run.sensors:
        values = run.temperatures[sensor].to_numpy(dtype=float)
        used = np.isfinite(values) & (run.times >= -1e-9) & (run.times <= end * (1 + 1e-9))
        if not used.any():
            continue
        card = study.sensors.get(sensor)
        stated = experiment.noise or (card.noise if card is not None else 0.5)
        noise = max(stated, _scatter(run.times[used], values[used]))
        series.append(
            Series(
                sensor,
                run.times[used],
                values[used],
                noise,
                choice.discrepancy,
                choice.correlation_time,
                settings.blocks,
            )
        )
    return Trial(experiment.name, dict(experiment.drive), experiment.hold_out, tuple(series))


def _scatter(times: Array, values: Array) -> float:
    """Noise seen in the readings themselves, K, if it is well above rounding: from second differences.

    Var(y_i - interpolation of its neighbours) = noise^2 (1 + w^2 + (1 - w)^2); the median is used, so that jumps and
    outliers do not count. Only a scatter a third above the stated noise is taken for noise: returns 0 for few readings.
    """
    if len(times) < 12:
        return 0.0
    share = (times[1:-1] - times[:-2]) / (times[2:] - times[:-2])
    inside = (1 - share) * values[:-2] + share * values[2:]
    deviation = (values[1:-1] - inside) / np.sqrt(1 + share**2 + (1 - share) ** 2)
    return float(np.median(np.abs(deviation)) / 0.6745 / 1.33)
