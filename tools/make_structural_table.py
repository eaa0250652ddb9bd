"""Make the synthetic table of `studies/example-structural`: a hot road, and another mechanics than the study's.

    python tools/make_structural_table.py

The model of the data differs from the study's in structure: its strain energy has another course along the meridian
(smooth modes, 20 % rms), its gauges are 5 % off, its mesh, elements and time integration are others. Base numbers and
sensors are off by about 0.7 of their stated uncertainties, the road is 24 K warmer; noise 0.5 K, irregular clock.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

import tyrefem as tf
from tyrefem.diagnose.blind.blind_case import BlindCase, measured
from tyrefem.diagnose.blind.other_model import OtherModel
from tyrefem.diagnose.blind.synthetic import Logger
from tyrefem.diagnose.unknowns.candidates import catalogue_candidates
from tyrefem.diagnose.unknowns.unknown import base_unknowns, sensor_unknowns

STUDY = Path(__file__).parents[1] / "studies" / "example-structural"
SEED = 20261122
#: What is hidden: a road warmer by so many kelvins.
HIDDEN, WARMER = "hot-road", 24.0
#: The strain energy is multiplied by exp(sum_k a_k cos(k pi s / L)), s from the crown; 20 % rms.
MODES = (-0.042, 0.064, 0.268, 0.028, 0.007)
GAUGES = {"carcass": 1.05, "tread": 0.95, "sidewall": 1.05, "bead": 0.95}
#: Base numbers and sensors are off by so many of their stated standard deviations.
OFF = 0.7
HEADER = (
    f"# SYNTHETIC table, not a measurement (tools/make_structural_table.py, seed {SEED}): other strain energy along\n"
    "# the meridian, gauges, mesh and time integration than the study's; base numbers and sensors off; noise 0.5 K.\n"
)


def hidden_case(study: tf.Study) -> BlindCase:
    """The hidden effect, with base numbers and sensors drawn at random."""
    rng = np.random.default_rng(SEED)
    unknowns = (*base_unknowns(study), *sensor_unknowns(study, set(study.sensors)))
    values = {unknown: float(rng.normal(0.0, OFF * unknown.sd)) for unknown in unknowns}
    (hidden,) = (candidate for candidate in catalogue_candidates(study) if candidate.key == HIDDEN)
    return BlindCase(0, SEED, "one", (hidden,), values | {hidden.amplitudes[0]: WARMER})


def table(study: tf.Study) -> pd.DataFrame:
    """All runs below each other, s and degC."""
    model = OtherModel(law="", factor=1.0, modes=MODES, gauges=GAUGES, speed_laws={})
    parts = []
    for run in measured(study, hidden_case(study), Logger(every=15.0), model=model):
        readings = run.temperatures.round(2)
        readings.columns = [f"{name} [degC]" for name in readings.columns]
        readings.insert(0, "time [s]", np.round(run.times, 1))
        readings.insert(0, "run", run.name)
        parts.append(readings)
    return pd.concat(parts)


def main() -> None:
    """Write the table."""
    with (STUDY / "runs.csv").open("w", encoding="utf-8") as file:
        file.write(HEADER)
        table(tf.study(STUDY)).to_csv(file, index=False, lineterminator="\n")


if __name__ == "__main__":
    main()
