"""Before and after as tables: by run, sensor and stretch of time; by run and sensor; reading by reading."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from tyrefem.diagnose.where import rms

if TYPE_CHECKING:
    import pandas as pd

    from tyrefem.diagnose.diagnosis import Diagnosis


def where_table(d: Diagnosis) -> pd.DataFrame:
    """One row per run, sensor and stretch: the columns of `gap_table`, and what is left in the amended study."""
    keys = ["run", "hold_out", "sensor", "phase"]
    after = d.where_after.rename(columns={"mean_K": "mean_after_K", "rms_K": "rms_after_K"})
    return d.where.merge(after[[*keys, "mean_after_K", "rms_after_K"]], on=keys, how="left", validate="1:1")


def rms_table(d: Diagnosis) -> pd.DataFrame:
    """One row per run and sensor: root mean square of the readings' deviations before and after, noise included, K."""
    import pandas as pd

    rows = []
    for number, trial in enumerate(d.gap.lab.bench.trials):
        for one in trial.series:
            place = trial.parts()[one.sensor]
            left = [trial.measured[place] - computed[number][place] for computed in (d.before, d.after)]
            rows.append(
                {
                    "run": trial.name,
                    "hold_out": trial.hold_out,
                    "sensor": one.sensor,
                    "n": len(one.times),
                    "before_K": rms(d.gap, d.before, [number], one.sensor),
                    "after_K": rms(d.gap, d.after, [number], one.sensor),
                    "noise_K": one.noise,
                    "mean_before_K": float(np.average(left[0], weights=one.sizes)),
                    "mean_after_K": float(np.average(left[1], weights=one.sizes)),
                }
            )
    return pd.DataFrame(rows)


def history_table(d: Diagnosis) -> pd.DataFrame:
    """One row per block of readings: measured mean, and what the original and the amended study say, degC."""
    import pandas as pd

    rows = []
    for number, trial in enumerate(d.gap.lab.bench.trials):
        measured, before, after = trial.measured, d.before[number], d.after[number]
        for one in trial.series:
            place = trial.parts()[one.sensor]
            rows.append(
                pd.DataFrame(
                    {
                        "run": trial.name,
                        "hold_out": trial.hold_out,
                        "sensor": one.sensor,
                        "time_s": one.block_times,
                        "readings": one.sizes.astype(int),
                        "measured_degC": measured[place],
                        "original_degC": before[place],
                        "amended_degC": after[place],
                        "noise_K": one.noise / np.sqrt(one.sizes),
                    }
                )
            )
    return pd.concat(rows, ignore_index=True)
