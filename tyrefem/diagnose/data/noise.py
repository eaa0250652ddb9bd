"""Noise of the readings, estimated from their scatter and held against the stated noise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray
from scipy.special import ndtr

from tyrefem.diagnose.settings import DEFAULT, DiagnosisSettings

Array = NDArray[np.float64]
#: Order of the differences: they contain no cubic course of the temperature.
ORDER = 4
#: Relative sd of an estimate from n differences of white noise is SPREAD/sqrt(n). With even times it is
#: sqrt(sum of rho_k^2 / 2) = 1.15; with random times, where close pairs weigh most, 1.5 (300 simulated tables).
SPREAD = 1.5
#: Differences beyond this many standard deviations do not count: jumps, outliers, kinks of the drive.
CUT = 2.5
#: Noise that is assumed where the study states 0, K; only the scale of a pooled estimate.
SCALE = 0.5


@dataclass(frozen=True)
class ReadingNoise:
    """Noise of one series of readings, K (standard deviation).

    Parameters
    ----------
    stated : by the study. from_data : by the scatter of the readings; NaN: too few readings. used : by the diagnosis.
    correlated : neighbouring readings share noise, so the scatter shows only a part of it.
    resolution : step of rounded readings; 0: not rounded. rounding : error that neighbours share which stick to a step,
        step/sqrt(12); 0: they do not stick.
    """

    stated: float
    from_data: float
    used: float
    correlated: bool = False
    resolution: float = 0.0
    rounding: float = 0.0

    @property
    def differs(self) -> bool:
        """Whether the diagnosis uses another noise than the stated one."""
        return self.used != self.stated


def noise_of(
    series: Sequence[tuple[str, Array, Array]], stated: Sequence[float], settings: DiagnosisSettings = DEFAULT
) -> list[ReadingNoise]:
    """Noise of every series of readings.

    All series are pooled, each in units of its stated noise. A sensor whose scatter differs clearly from the pool has
    its own estimate, and so has a single series. The estimate replaces the stated noise if they differ by more than
    ``noise_tolerance`` and three standard deviations. The stated noise stays if there are too few readings. It also
    stays if it is larger and neighbouring readings share noise.

    Parameters
    ----------
    series : (sensor, times (n,) s, readings (n,) K above any level) of every series. stated : its stated noise, K.
    """
    scales = [value if value > 0 else SCALE for value in stated]
    pieces = [differences(times, values) / scale for (_, times, values), scale in zip(series, scales, strict=True)]
    thinned = [_thinned(times, values) / scale for (_, times, values), scale in zip(series, scales, strict=True)]
    sensors = [sensor for sensor, *_ in series]
    whole = _Estimate.of(pieces)
    correlated = _is_correlated(whole, _Estimate.of(thinned))
    by_sensor = {
        name: _Estimate.of([piece for sensor, piece in zip(sensors, pieces, strict=True) if sensor == name])
        for name in dict.fromkeys(sensors)
    }
    result = []
    for (sensor, _, values), piece, scale, given in zip(series, pieces, scales, stated, strict=True):
        estimate = whole
        for closer in (by_sensor[sensor], _Estimate.of([piece])):
            if closer.sd <= settings.noise_sd and closer.clearly_differs(estimate.size, settings.noise_own):
                estimate = closer
        # A few readings are multiples of some step by chance; two always are.
        step = resolution(values) if len(piece) else 0.0
        size = estimate.size * scale
        # Readings that stick to their steps are off by up to half a step, many neighbours alike.
        sticks = size < step / 2
        size = step / 2 if sticks else size
        noise = _judged(given, size, estimate.sd, correlated and not sticks, step, settings)
        result.append(replace(noise, rounding=step / np.sqrt(12.0)) if sticks else noise)
    return result


def _judged(
    stated: float, size: float, sd: float, correlated: bool, step: float, settings: DiagnosisSettings
) -> ReadingNoise:
    """The noise that the diagnosis uses; ``sd``: relative standard deviation of the estimate ``size``."""
    if not np.isfinite(sd):
        return ReadingNoise(stated, np.nan, stated, False, step)
    if sd > settings.noise_sd:
        # A rough estimate only warns of noise a third above the stated one.
        return ReadingNoise(stated, size, max(stated, size / 1.33), correlated, step)
    off = abs(size - stated) > max(settings.noise_tolerance, 3 * sd) * stated
    used = size if off and (size > stated or not correlated) else stated
    return ReadingNoise(stated, size, used, correlated, step)


@dataclass(frozen=True)
class _Estimate:
    """Scale ``size`` of differences and its relative standard deviation ``sd``."""

    size: float
    sd: float

    @classmethod
    def of(cls, pieces: Sequence[Array]) -> _Estimate:
        values = np.concatenate(pieces) if pieces else np.zeros(0)
        return cls(scale_of(values), SPREAD / np.sqrt(len(values)) if len(values) else np.inf)

    def clearly_differs(self, size: float, least: float) -> bool:
        """Whether ``size`` is off by more than ``least`` (relative) and four standard deviations."""
        return bool(abs(self.size - size) > max(least, 4 * self.sd) * size)


def _is_correlated(estimate: _Estimate, thinned: _Estimate) -> bool:
    """Whether every other reading scatters clearly more than neighbours do."""
    return bool(thinned.size > estimate.size * (1 + max(0.12, 4 * estimate.sd)))


def differences(times: Array, values: Array) -> Array:
    """Divided differences of fourth order with weights of unit norm: (n - 4,), K; empty for fewer than 12 readings.

    Independent noise of standard deviation s gives differences of standard deviation s; a cubic course gives 0. The
    clock may be irregular: w_i = 1 / product of (t_i - t_j) over j != i.
    """
    kept = np.diff(times, prepend=-np.inf) > 0
    if kept.sum() < 3 * ORDER:
        return np.zeros(0)
    t, y = (sliding_window_view(each[kept], ORDER + 1) for each in (times, values))
    apart = t[:, :, None] - t[:, None, :] + np.eye(ORDER + 1)
    # Scaled times keep the products of long and of short intervals in range.
    weights = 1.0 / np.prod(apart / (np.ptp(t, axis=1)[:, None, None] / ORDER), axis=2)
    return np.asarray((weights * (y - y[:, :1])).sum(axis=1) / np.linalg.norm(weights, axis=1))


def _thinned(times: Array, values: Array) -> Array:
    """Differences of every other reading, beginning with the first and with the second."""
    return np.concatenate([differences(times[start::2], values[start::2]) for start in (0, 1)])


def scale_of(values: Array) -> float:
    """Standard deviation of values about 0 without those beyond `CUT` standard deviations; NaN without values.

    It starts from the median and is corrected for what normal numbers lose by the cut.

    >>> round(scale_of(np.append(np.random.default_rng(1).normal(0.0, 0.3, 4000), [50.0] * 40)), 2)
    0.3
    """
    if not len(values):
        return float("nan")
    size = np.abs(values)
    # Rounded readings may have a median of 0.
    scale = float(np.median(size) / 0.6745) or float(size.mean())
    inside = 1 - 2 * CUT * np.exp(-(CUT**2) / 2) / np.sqrt(2 * np.pi) / (2 * ndtr(CUT) - 1)
    for _ in range(20):
        kept = size[size <= CUT * scale]
        if not len(kept):
            break
        scale = float(np.sqrt((kept**2).mean() / inside))
    return scale


def resolution(values: Array) -> float:
    """Step of rounded readings, in the unit of the values; 0 if they are not multiples of a step.

    >>> resolution(np.array([20.1, 20.3, 20.2, 20.6])), resolution(np.array([20.113, 20.341, 20.228, 20.667]))
    (0.1, 0.0)
    """
    gaps = np.diff(np.unique(np.round(values, 6)))
    if not len(gaps):
        return 0.0
    step = float(gaps.min())
    multiples = gaps / step
    return round(step, 6) if np.abs(multiples - np.round(multiples)).max() < 1e-3 else 0.0
