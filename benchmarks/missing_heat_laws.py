"""What a diagnosis finds of causes that are not in the catalogue: law, draft effect, and gap before and after.

    python benchmarks/missing_heat_laws.py [--case payne] [--out docs/evidence/tables/diagnosis-laws.csv]

The layout is `hidden-effect` (8 histories, three fitted runs, one held out) with two further runs. Data come from
another mesh with 0.5 K noise. Each case is diagnosed twice: without and with the draft effect of the first diagnosis.
The catalogue has eight effects (`--all`: all but those of single sensors), and the fits have a 6 mm mesh, for speed.
"""

from __future__ import annotations

import argparse
import csv
import os
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import tomli_w

import tyrefem as tf
from tyrefem.diagnose.law_words import law_formula, law_words
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.words import verdict_words
from tyrefem.effects import catalogue, use_effects
from tyrefem.simulation.surroundings import GAS

HIDDEN = Path(__file__).parent / "hidden_laws"
NOISE, EVERY = 0.5, 10.0
SETTINGS = DiagnosisSettings(looks=1, largest=1, mesh_size="6 mm")
#: Effects that compete unless ``--all`` is given.
RIVALS = {"hot-road", "sun", "radiation", "loss-speed-exponent", "loss-temperature-law", "under-inflation-flexing",
          "belt-edge-shear", "wet-road"}  # fmt: skip
OF_SENSORS = ["sensor-lag", "sensor-misplaced", "sensor-offset", "swapped-channels", "clock-offset"]
#: Further fitted runs: three runs leave two ratios, too few for exponents of speed, load and pressure.
FURTHER: tuple[dict[str, Any], ...] = (
    {"run": "E", "drive": {"load": "2000 lbf", "phases.rolling.speed": "35 mph"}},
    {"run": "F", "drive": {"load": "3400 lbf", "pressure": "115 psi", "phases.rolling.speed": "14 mph"}},
)
#: Case -> hidden entry, the law in words, effects that the catalogue does not have.
CASES: Mapping[str, tuple[dict[str, Any], str, list[str]]] = {
    "payne": (
        {"name": "hidden-payne", "gain": 1.0},
        "share of all hysteresis, about deflection^-0.7",
        [],
    ),
    "delamination": (
        {"name": "hidden-delamination", "heat": "100 kW/m**3"},
        "carcass at s = 97 mm, speed^1 x deflection^2, begins at 300 s",
        [],
    ),
    "evaporation": (
        {"name": "hidden-evaporation", "film": "400 W/m**2/K"},
        "film of the tread while rolling, falling to nothing at 600 s",
        [],
    ),
    "belt-edge": (
        {"name": "hidden-belt-edge", "heat": "150 kW/m**3"},
        "under the shoulder, speed^1.8 x load^0.7",
        ["belt-edge-shear"],
    ),
}  # fmt: skip


def measured(folder: Path, entry: Mapping[str, Any], exclude: list[str], size: str, seed: int) -> tf.Study:
    """The study with tables that a hidden effect made, on a finer mesh."""
    base = tf.study("hidden-effect")
    runs = [*(dict(each) for each in base.data["measured"]), *(dict(each) for each in FURTHER)]
    use_effects(HIDDEN)
    truth = base.replace({"mesh.size": "4 mm", "effects": [dict(entry)], "measured": []})
    rng = np.random.default_rng(seed)
    for run in runs:
        readings = truth.with_drive(run.get("drive", {})).run().readings
        times = np.arange(0.0, float(readings["time_s"].iloc[-1]) + 1e-6, EVERY)
        columns = {"time [s]": times}
        for sensor in (*base.sensors, GAS):
            computed = np.interp(times, readings["time_s"], readings[sensor])
            columns[f"{sensor} [degC]"] = np.round(computed + NOISE * rng.normal(size=len(times)), 2)
        pd.DataFrame(columns).to_csv(folder / f"{run['run']}.csv", index=False)
        run["table"] = f"{run.pop('run')}.csv"
    os.environ["TYREFEM_EFFECTS"] = ""
    study = base.replace({"mesh.size": size, "measured": runs, "diagnosis.exclude": exclude})
    (folder / "study.toml").write_text(tomli_w.dumps(dict(study.data)), encoding="utf-8")
    return tf.study(folder / "study.toml")


def case(name: str, size: str, seed: int, workers: int, folder: Path, *, whole: bool) -> dict[str, str]:
    """One hidden law, diagnosed without and with its draft effect: a row of the table."""
    entry, words, exclude = CASES[name]
    left_out = OF_SENSORS if whole else [effect for effect in catalogue() if effect not in RIVALS]
    exclude = sorted({*exclude, *left_out})
    study = measured(folder, entry, exclude, size, seed)
    began = time.process_time()
    first = study.diagnose(settings=SETTINGS, workers=workers)
    seconds = time.process_time() - began
    for sentence in verdict_words(first):
        print("  ", sentence)
    row = {
        "hidden": name, "law": words, "verdict": first.verdict,
        "held_out_before_K": f"{first.rms(after=False, held_out=True):.2f}",
        "fitted_before_K": f"{first.rms(after=False, held_out=False):.2f}",
    }  # fmt: skip
    if first.verdict == "identified":
        row["named"] = first.best.key
    first.save(folder / "first")
    if first.law is None:
        return row | {"found": "no law"}
    law = first.law.law
    switch = law.fit.switch.kind + (f" {law.time:.0f} ± {law.time_sd:.0f} s" if np.isfinite(law.time) else "")
    row |= {
        "place": f"{first.law.place.kind}, {first.law.place.where}"
        + (f", s = {first.law.place.station * 1e3:.0f} mm" if np.isfinite(first.law.place.station) else ""),
        "found": law_formula(law), "switch": switch, "holds": str(first.law.holds),
        "lead_nats": f"{first.law.lead:.0f}",
    }  # fmt: skip
    print("  ", *law_words(first), sep=" | ")
    for each in first.law.ranking:
        fit = each.law.fit
        print(f"   {each.below:8.1f} {each.place.kind} {each.place.where} {each.place.station:.3f} "
              f"{law_formula(each.law)} {fit.switch.kind} {each.law.amplitude:.3g}")  # fmt: skip
    for each in first.signatures[:6]:
        print(f"   like {each.name}: {each.likeness:.2f} ({each.below:.1f}) {dict(each.exponents)}")
    if not first.law.holds:
        return row
    began = time.process_time()
    second = study.diagnose(settings=SETTINGS, workers=workers, effects=folder / "first" / "effects")
    for sentence in verdict_words(second):
        print("  ", sentence)
    print(f"   processor seconds {seconds:.0f} and {time.process_time() - began:.0f}")
    draft = next((folder / "first" / "effects").glob("*.py")).stem.replace("_", "-")
    chance = sum(share for key, share in second.judgement.named.items() if key.startswith(draft))
    row |= {
        "second_verdict": second.verdict, "second_set": second.best.key, "draft_probability": f"{chance:.3f}",
        "fitted_after_K": f"{second.rms(after=True, held_out=False):.2f}",
        "held_out_after_K": f"{second.rms(after=True, held_out=True):.2f}",
    }  # fmt: skip
    os.environ["TYREFEM_EFFECTS"] = ""
    return row


def main() -> None:
    """Run the cases and write the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--case", choices=[*CASES, "all"], default="all")
    parser.add_argument("--size", default="8 mm", help="mesh of the study")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--all", action="store_true", help="the whole catalogue but effects of single sensors")
    parser.add_argument("--out", type=Path)
    given = parser.parse_args()
    rows = []
    for name in (*CASES,) if given.case == "all" else [given.case]:
        print(f"{name}: {CASES[name][1]}", flush=True)
        with tempfile.TemporaryDirectory() as folder:
            rows.append(case(name, given.size, given.seed, given.workers, Path(folder), whole=given.all))
        print(f"   {rows[-1]}", flush=True)
    if given.out:
        names = list(dict.fromkeys(key for row in rows for key in row))
        with given.out.open("w", newline="", encoding="utf-8") as stream:
            writer = csv.DictWriter(stream, names, lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)


if __name__ == "__main__":
    main()
