"""Times and uncertainty of the readings of a run, without the readings."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky, solve_triangular

from tyrefem.brief import Brief
from tyrefem.diagnose.settings import DEFAULT

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SensorSampling(Brief):
    """Readings of one sensor in one run: ``times`` (n,) s, ``noise`` K of one reading.

    Neighbouring readings are averaged into at most ``blocks`` blocks. The noise of a block of m readings is
    noise/sqrt(m). The discrepancy of a correct model is correlated over time:
    C = noise^2/m + r^2 + d^2 exp(-|t - t'|/tau), with the ``discrepancy`` d (K) and the ``correlation_time`` tau (s).
    r is the ``rounding``: readings that stick to the steps of a logger share their error, K; else 0.
    """

    sensor: str
    times: Array
    noise: float
    discrepancy: float
    correlation_time: float
    blocks: int = DEFAULT.blocks
    rounding: float = 0.0

    @cached_property
    def starts(self) -> NDArray[np.intp]:
        """Number of the first reading of every block."""
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
        independent = np.diag(self.noise**2 / self.sizes + self.rounding**2)
        return independent + self.discrepancy**2 * np.exp(-apart / self.correlation_time)

    @cached_property
    def _root(self) -> Array:
        return np.asarray(cholesky(self.covariance, lower=True))

    def whitened(self, blocks: Array) -> Array:
        """L^-1 times block values (n_blocks, ...), with C = L L^T: independent, of unit variance."""
        return np.asarray(solve_triangular(self._root, blocks, lower=True))

    def scatter(self, rng: np.random.Generator) -> Array:
        """(n_blocks,) K, errors of the block means drawn at random: L z."""
        return np.asarray(self._root @ rng.normal(size=len(self.starts)))


@dataclass(frozen=True, eq=False)
class DriveSampling(Brief):
    """The drive of a measured run and the sampling of its sensors, as the forward model needs them.

    ``origin``: the run's name in its table, if ``name`` has a number beside it.
    """

    name: str
    drive: dict[str, object]
    hold_out: bool
    sensors: tuple[SensorSampling, ...]
    origin: str = field(default="", kw_only=True)

    @property
    def run(self) -> str:
        """The measured run, as effects that act in some runs only name it."""
        return self.origin or self.name

    @property
    def size(self) -> int:
        """Number of blocks of all sensors."""
        return sum(len(sampling.starts) for sampling in self.sensors)

    def whitened(self, blocks: Array) -> Array:
        """Whitened values of all sensors, in the order of ``sensors``."""
        pieces = np.split(blocks, np.cumsum([len(sampling.starts) for sampling in self.sensors])[:-1])
        return np.concatenate([sampling.whitened(piece) for sampling, piece in zip(self.sensors, pieces, strict=True)])

    def parts(self) -> dict[str, slice]:
        """Sensor -> slice of its blocks."""
        places, start = {}, 0
        for sampling in self.sensors:
            places[sampling.sensor] = slice(start, start + len(sampling.starts))
            start += len(sampling.starts)
        return places
