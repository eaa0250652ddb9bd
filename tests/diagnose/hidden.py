"""A study with three thermocouples and short runs, and measurements that another mesh and a hidden effect made."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import tomli_w

import tyrefem as tf
from tyrefem.diagnose import DiagnosisData
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.effects import catalogue

#: Few rivals make a short test: all of them heat or cool the tread, or move a reading.
RIVALS = {"hot-road", "sun", "sensor-offset"}
RUNS: dict[str, dict[str, Any]] = {
    "slow": {},
    "loaded": {"load": "3600 lbf", "pressure": "110 psi"},
    "fast": {"speed": "30 mph"},
}
HELD_OUT = "fast"
NOISE, END = 0.5, 160.0
#: Meshes of a quick study and of its data; fits that go with them. The verdicts are those of finer meshes.
COARSE_MESH, FINER_MESH = "8 mm", "6 mm"
COARSE = DiagnosisSettings(
    mesh_size=COARSE_MESH, largest=1, looks=1, odd_run_share=0.0, heat_widths=(3.0,), discrepancy_sizes=(1.0,)
)
#: Few sets are fitted, fits end after a few steps, each kind of discrepancy is tried in one size, and no effect in
#: single runs: for claims that hold however well anything is fitted.
HASTY = DiagnosisSettings(
    largest=1, looks=1, singles=2, most_sets=3, first_steps=2, more_steps=2, most_continuations=1, beside_sets=1,
    beside_steps=2, heat_widths=(3.0,), discrepancy_sizes=(1.0,), odd_run_share=0.0,
)  # fmt: skip
#: What is hidden in the measurements, K; trials whose sensitivities are finished when the diagnosis is interrupted.
WARMER, FINISHED = 25.0, 2


@dataclass(frozen=True)
class Case:
    """A diagnosis, its folder, the trials whose sensitivities each of the two tries computed, and what was kept."""

    study: tf.Study
    diagnosis: DiagnosisData
    folder: Path
    first: list[int]
    second: list[int]
    kept: Path
    resumed: int


def study(folder: Path, mesh: str = "4 mm") -> tf.Study:
    """The study as its owner wrote it, saved in a folder."""
    changes = {
        "title": "Three thermocouples",
        "drive": {
            "speed": "20 mph", "load": "2700 lbf", "pressure": "83 psi", "ambient": "25 degC", "duration": f"{END} s",
        },
        "mesh.size": mesh,
        "sensors": {
            "crown-outer": {"s": "0.33 in", "depth": "0.63 in", "lag": "2 s"},
            "shoulder-inner": {"s": "2.00 in", "depth": "0.07 in", "lag": "2 s"},
            "sidewall-outer": {"s": "3.95 in", "depth": "0.28 in", "lag": "2 s"},
        },
        "diagnosis.exclude": sorted(name for name in catalogue() if name not in RIVALS),
        "measured": [
            {"table": f"{name}.csv", "drive": drive, "hold_out": name == HELD_OUT} for name, drive in RUNS.items()
        ],
    }  # fmt: skip
    base = tf.study("example-validation").replace(changes)
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / "study.toml"
    file.write_text(tomli_w.dumps(dict(base.data)), encoding="utf-8")
    return tf.study(file)


def measure(owner: tf.Study, effects: list[dict[str, Any]], mesh: str = "3 mm") -> None:
    """Write the tables: truth on a finer mesh, with hidden effects and noise."""
    rng = np.random.default_rng(11)
    truth = owner.replace({"mesh.size": mesh, "effects": effects, "measured": []})
    assert owner.folder is not None
    for name, drive in RUNS.items():
        readings = truth.with_drive(drive).run().readings
        times = np.arange(0.0, END + 1.0, 3.0)
        columns = {"time [s]": times}
        for sensor in owner.sensors:
            computed = np.interp(times, readings["time_s"], readings[sensor])
            columns[f"{sensor} [degC]"] = np.round(computed + NOISE * rng.normal(size=len(times)), 2)
        pd.DataFrame(columns).to_csv(owner.folder / f"{name}.csv", index=False)
