"""Make the synthetic tables of studies/rig-trtlab (seeded; run from the repository's root with the package installed).

The "truth" is not the library's model: hexahedra on a doubly curved patch, BDF2 and tabulated air of `tests/rig`, with
the spot, the thermocouple, films, absorptance and offsets off by what the card calls their uncertainty. True properties
are printed, so that an identification can be judged.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, "tests/rig")

from cases import measured, properties, truth

from tyrefem.measured import MeasuredRun
from tyrefem.rig import load

FOLDER = Path("studies/rig-trtlab")
SEED = 1


def main() -> None:
    """Write one table per run of the card."""
    card, _ = load(FOLDER)
    real = truth(SEED, card, linear=True)
    for run in measured(SEED, card, real):
        comments = (
            f"SYNTHETIC example table, not a measurement: made by tools/make_rig_tables.py, seed {SEED}.",
            f"run {run.name}: laser {card.runs[run.name].power:g} W",
        )
        MeasuredRun(run.name, run.times, run.temperatures.round(2), None, comments).write(FOLDER / f"{run.name}.csv")
    for name, value in properties(card, real).items():
        print(f"{name:24} {value:.4g}")
    for layer, own in zip(card.layers, real.layers, strict=True):
        print(f"{layer.name}: slopes of k and c {own.k_slope:.3g}, {own.c_slope:.3g} 1/K about 60 degC")


if __name__ == "__main__":
    main()
