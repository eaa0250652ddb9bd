"""Make the synthetic tables of studies/example-validation (seeded; run from the repository's root).

The "truth" is the model itself on another mesh with other numbers: carcass and tread lose 12 % and 8 % more, the road
is 4 K warmer, thermocouples are displaced by about 1 mm, lag by 5 s and have 0.5 K noise.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

import tyrefem as tf

FOLDER = Path("studies/example-validation")
SEED = 20261121
HEADER = (
    "# SYNTHETIC example table, not a measurement: made by tools/make_example_tables.py, seed {seed}.\n"
    "# The curves of Clark & Dodge (1980) are not legible, so no measured table of these tyres is shipped.\n"
    "# {run}\n"
)


def truth(rng: np.random.Generator) -> tf.Study:
    """The study with other numbers and displaced sensors."""
    study = tf.study(FOLDER)
    changes = {
        "mesh.cell": "tri",
        "mesh.element": "P2",
        "mesh.size": "1.5 mm",
        "materials.carcass.loss_tangent.value": 0.112,
        "materials.tread.loss_tangent.value": 0.216,
        "boundaries.road.temperature": "29 degC",
        "output.every": "1 s",
    }
    section = study.section
    for name, sensor in study.sensors.items():
        s, depth = sensor.s + rng.normal(0, 1e-3), sensor.depth + rng.normal(0, 5e-4)
        s, depth = (float(v[0]) for v in section.clamp(np.array([s]), np.array([depth]), 2e-4))
        changes |= {f"sensors.{name}.s": f"{s} m", f"sensors.{name}.depth": f"{depth} m", f"sensors.{name}.lag": "5 s"}
    return study.replace(changes)


def readings(study: tf.Study, drive: dict[str, str], times: np.ndarray, rng: np.random.Generator) -> pd.DataFrame:
    """Noisy readings at the logger's times."""
    clean = study.with_drive(drive).run().readings
    names = list(study.sensors)
    table = {name: np.interp(times, clean["time_s"], clean[name]) + rng.normal(0, 0.5, len(times)) for name in names}
    return pd.DataFrame({"time_s": times} | table)


def main() -> None:
    """Write the three tables."""
    rng = np.random.default_rng(SEED)
    study = truth(rng)
    entries = tf.study(FOLDER).card.measured
    for number, entry in enumerate(entries, 1):
        step = (10.0, 15.0, 7.5)[number - 1]
        times = np.arange(0.0, 1200.0 + step / 2, step)
        data = readings(study, entry.drive, times, rng)
        run = f"run {number}: drive {entry.drive or 'as in study.toml'}"
        with (FOLDER / entry.table).open("w", encoding="utf-8") as file:
            file.write(HEADER.format(seed=SEED, run=run))
            if number == 2:  # as another logger gives it: minutes, Fahrenheit, missing cells
                data.iloc[rng.random(len(data)) < 0.05, 3] = np.nan
                data.iloc[20:26, 5] = np.nan
                data["time_s"] /= 60
                data.iloc[:, 1:] = data.iloc[:, 1:] * 9 / 5 + 32
                data.columns = ["time [min]", *[f"{name} [degF]" for name in data.columns[1:]]]
            else:
                data.columns = ["time [s]", *[f"{name} [degC]" for name in data.columns[1:]]]
            data.round(3 if number == 2 else 2).to_csv(file, index=False)


if __name__ == "__main__":
    main()
