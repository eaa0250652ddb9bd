"""Where, when and under which drive data and study disagree: residuals by run, sensor and stretch of time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tyrefem.inputs.motion import motion_at

if TYPE_CHECKING:
    import pandas as pd

    from tyrefem.diagnose.residuals import Residuals
    from tyrefem.diagnose.runs import MeasuredSensor

Array = NDArray[np.float64]
#: A sensor is on its plateau where it changes by less than this part of its fastest rate (a convention).
SLOW = 0.1
#: A history that changes by less than this is a plateau, K.
FLAT = 0.1
STRETCHES = ("heating", "plateau", "cooling")


def stretches(readings: MeasuredSensor, computed: Array) -> NDArray[np.object_]:
    """Heating, plateau or cooling for every block, by the slope of the computed history (n_blocks,)."""
    names = np.full(len(computed), "plateau", dtype=object)
    if len(computed) < 2 or np.ptp(computed) < FLAT:
        return names
    slope = np.gradient(computed, readings.block_times)
    fastest = np.abs(slope).max()
    names[slope > SLOW * fastest] = "heating"
    names[slope < -SLOW * fastest] = "cooling"
    return names


def residual_table(
    residuals: Residuals, computed: Mapping[int, Array], like: Mapping[int, Array] | None = None
) -> pd.DataFrame:
    """One row per run, sensor and stretch: mean and rms of measured - computed, K, and how surely it is not nothing.

    ``sigma`` is the mean over its standard deviation from noise, discrepancy (both with their correlation in time),
    base numbers and sensors; ``sd_K`` that standard deviation.

    Parameters
    ----------
    computed : trial -> block means to hold against the data, e.g. the study's own.
    like : trial -> block means whose slope tells the stretches apart; default: ``computed``.
    """
    import pandas as pd

    trials, rows = residuals.trials, []
    prior = np.array([unknown.sd for unknown in residuals.unknowns[: residuals.nuisance]])
    for number, trial in enumerate(trials):
        measured = trial.measured
        drive = residuals.driven(number).card.drive
        for readings in trial.sensors:
            place = trial.parts()[readings.sensor]
            residual = (measured - computed[number])[place]
            J = residuals.sensitivities.jacobians[number][place, : residuals.nuisance]
            covariance = readings.covariance + (J * prior**2) @ J.T
            kinds = stretches(readings, (like or computed)[number][place])
            for kind in STRETCHES:
                mask = kinds == kind
                if not mask.any():
                    continue
                weight = mask * readings.sizes / (mask * readings.sizes).sum()
                mean, sd = float(weight @ residual), float(np.sqrt(weight @ covariance @ weight))
                rows.append(
                    {
                        "run": trial.name,
                        "hold_out": trial.hold_out,
                        "sensor": readings.sensor,
                        "phase": kind,
                        "speed_m_s": float(np.mean([motion_at(drive, t).speed for t in readings.block_times[mask]])),
                        "n": int((mask * readings.sizes).sum()),
                        "mean_K": mean,
                        "rms_K": float(np.sqrt(weight @ residual**2)),
                        "sd_K": sd,
                        "sigma": abs(mean) / sd,
                    }
                )
    return pd.DataFrame(rows)


def rms(residuals: Residuals, computed: Mapping[int, Array], trials: list[int], sensor: str | None = None) -> float:
    """Root mean square of measured - computed over the readings of some trials (of one sensor), K; NaN without any.

    Block means stand for their readings, so that the noise within a block is added to what the means show.
    """
    total = count = 0.0
    for number in trials:
        trial = residuals.trials[number]
        for readings in trial.sensors:
            if sensor not in (None, readings.sensor):
                continue
            place = trial.parts()[readings.sensor]
            residual = trial.measured[place] - computed[number][place]
            within = readings.measured - np.repeat(readings.block_means(readings.measured), readings.sizes.astype(int))
            # The signal's own change within a block is no noise: take it off with the computed one where it is known.
            noise = np.minimum(
                np.add.reduceat(within**2, readings.starts), readings.noise**2 * np.maximum(readings.sizes - 1, 0)
            )
            total += float(readings.sizes @ residual**2 + noise.sum())
            count += float(readings.sizes.sum())
    return float(np.sqrt(total / count)) if count else float("nan")
