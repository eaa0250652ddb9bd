"""What is hidden in studies/hidden-effect, and how its table was made. Do not read this before you have tried.

Run from the repository's root to write the table again: python tests/studies/hidden_effect_truth.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

import tyrefem as tf
from tyrefem.diagnose.blind.blind_case import BlindCase, measured
from tyrefem.diagnose.unknowns.candidates import catalogue_candidates
from tyrefem.diagnose.unknowns.unknown import base_unknowns, sensor_unknowns

HIDDEN, AMPLITUDE = "gas-mixing", 1.6
SEED = 20261121
TABLE = Path("studies/hidden-effect/runs.csv")
HEADER = (
    "# SYNTHETIC table, not a measurement (seed {seed}): another mesh and time integrator than the solver's own, base\n"
    "# numbers and sensors off by about their stated uncertainties, noise 0.5 K, irregular clock, gaps.\n"
    "# As a logger gives it: minutes, Fahrenheit, four runs below each other.\n"
)


def truth(study: tf.Study) -> BlindCase:
    """The hidden effect, with base numbers and sensors drawn from their priors."""
    rng = np.random.default_rng(SEED)
    unknowns = (*base_unknowns(study), *sensor_unknowns(study, set(study.sensors)))
    values = {unknown: float(rng.normal(0.0, 0.7 * unknown.sd)) for unknown in unknowns}
    hidden = next(unknown for unknown in catalogue_candidates(study) if unknown.name == HIDDEN)
    return BlindCase(0, SEED, "one", (hidden,), values | {hidden.amplitudes[0]: AMPLITUDE})


def main() -> None:
    """Write the table."""
    study = tf.study("studies/hidden-effect")
    parts = []
    for run in measured(study, truth(study)):
        table = run.temperatures * 9 / 5 + 32
        table.columns = [f"{name} [degF]" for name in table.columns]
        table.insert(0, "time [min]", run.times / 60)
        table.insert(0, "run", run.name)
        parts.append(table)
    whole = pd.concat(parts)
    readings = [name for name in whole if name.endswith("[degF]")]
    whole = whole.round({"time [min]": 4, **dict.fromkeys(readings, 2)})
    with TABLE.open("w", encoding="utf-8") as file:
        file.write(HEADER.format(seed=SEED))
        whole.to_csv(file, index=False, lineterminator="\n")


if __name__ == "__main__":
    main()
