"""Residuals by run, sensor and stretch of time (heating, plateau, cooling)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tyrefem.inputs.motion import motion_at

if TYPE_CHECKING:
    import pandas as pd

    from tyrefem.diagnose.data.residuals import Residuals
    from tyrefem.diagnose.data.runs import MeasuredSensor

Array = NDArray[np.float64]
#: A sensor is on its plateau while its rate is below this share of its fastest rate (a convention).
SLOW = 0.1
#: A history with a smaller total change than this is a plateau, K.
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
    """One row per run, sensor and stretch: mean and rms of measured - computed, K, and the significance of the mean.

    ``sd_K``: standard deviation of the mean from noise, discrepancy, base numbers and sensors, correlated in time.
    ``sigma``: absolute mean over ``sd_K``.

    Parameters
    ----------
    computed : number of the run -> block means to compare with the data.
    like : number of the run -> block means whose slope defines the stretches; default: ``computed``.
    """
    import pandas as pd

    runs, rows = residuals.runs, []
    prior = np.array([unknown.sd for unknown in residuals.unknowns[: residuals.nuisance]])
    for number, run in enumerate(runs):
        measured = run.measured
        drive = residuals.driven(number).card.drive
        for readings in run.sensors:
            place = run.parts()[readings.sensor]
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
                        "run": run.name,
                        "hold_out": run.hold_out,
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


def rms(residuals: Residuals, computed: Mapping[int, Array], runs: list[int], sensor: str | None = None) -> float:
    """Root mean square of measured - computed over the readings of some runs (of one sensor), K; NaN without readings.

    The residuals are those of block means; the noise within the blocks is added.
    """
    total = count = 0.0
    for number in runs:
        run = residuals.runs[number]
        for readings in run.sensors:
            if sensor not in (None, readings.sensor):
                continue
            place = run.parts()[readings.sensor]
            residual = run.measured[place] - computed[number][place]
            within = readings.measured - np.repeat(readings.block_means(readings.measured), readings.sizes.astype(int))
            # The signal changes within a block too, so the stated noise limits the scatter that counts as noise.
            noise = np.minimum(
                np.add.reduceat(within**2, readings.starts), readings.noise**2 * np.maximum(readings.sizes - 1, 0)
            )
            total += float(readings.sizes @ residual**2 + noise.sum())
            count += float(readings.sizes.sum())
    return float(np.sqrt(total / count)) if count else float("nan")
