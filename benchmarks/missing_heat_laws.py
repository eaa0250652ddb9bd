"""What a diagnosis makes of causes that are not in the catalogue: law, draft effect, and gap before and after.

    python benchmarks/missing_heat_laws.py [--case payne] [--seeds 1 2 3] [--records results/missing-heat-laws]
    python benchmarks/hidden_law_table.py

Tyre and sensors are those of `hidden-effect`: five fitted runs and one held out, of 600 s rolling and 200 s at rest.
Data come from another mesh, with 0.5 K noise. Each case is diagnosed twice: without, and with the draft effect of the
first diagnosis, as it was written. The catalogue has eight effects (``--all``: all but those of single sensors).

Finished diagnoses are kept below the folder of records: the same command goes on where it was interrupted.
"""

from __future__ import annotations

import argparse
import json
import os
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import tomli_w

import tyrefem as tf
from tyrefem.diagnose import DiagnosisData
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.words.draft_effect import EFFECTS, draft_effects
from tyrefem.diagnose.words.record import record
from tyrefem.effects import catalogue, use_effects
from tyrefem.output import atomic_path
from tyrefem.plugins.environment import FOLDERS
from tyrefem.simulation.surroundings import GAS

HIDDEN = Path(__file__).parent / "hidden_laws"
RECORDS = Path("results/missing-heat-laws")
NOISE, EVERY = 0.5, 10.0
#: Meshes of the study and of the data. Few blocks and a coarse mesh of the fits save time.
SIZE, SIZE_OF_DATA = "8 mm", "5 mm"
SETTINGS = DiagnosisSettings(looks=1, largest=1, mesh_size="6 mm", blocks=20, readings_every=10.0)
PHASES = [
    {"name": "rolling", "duration": "600 s"},
    {"name": "standing", "speed": "0 mph", "duration": "200 s"},
]
#: Effects that compete unless ``--all`` is given.
RIVALS = {"hot-road", "sun", "radiation", "loss-speed-exponent", "loss-temperature-law", "under-inflation-flexing",
          "belt-edge-shear", "wet-road"}  # fmt: skip
OF_SENSORS = ["sensor-lag", "sensor-misplaced", "sensor-offset", "swapped-channels", "clock-offset"]
#: Further fitted runs: three runs leave two ratios, too few for exponents of speed, load and pressure.
FURTHER: tuple[dict[str, Any], ...] = (
    {"run": "E", "drive": {"load": "2000 lbf", "phases.rolling.speed": "35 mph"}},
    {"run": "F", "drive": {"load": "3400 lbf", "pressure": "115 psi", "phases.rolling.speed": "14 mph"}},
)
#: Case -> hidden entry, effects that the catalogue does not have.
CASES: Mapping[str, tuple[dict[str, Any], list[str]]] = {
    "payne": ({"name": "hidden-payne", "gain": 1.0}, []),
    "delamination": ({"name": "hidden-delamination", "heat": "100 kW/m**3"}, []),
    "evaporation": ({"name": "hidden-evaporation", "film": "60 W/m**2/K"}, []),
    "belt-edge": ({"name": "hidden-belt-edge", "heat": "150 kW/m**3"}, ["belt-edge-shear"]),
}


def measured(folder: Path, case: str, seed: int, *, whole: bool) -> tf.Study:
    """The study with tables that a hidden effect made, on a finer mesh; made once."""
    if (folder / "study.toml").exists():
        return tf.study(folder / "study.toml")
    entry, exclude = CASES[case]
    left_out = OF_SENSORS if whole else [effect for effect in catalogue() if effect not in RIVALS]
    base = tf.study("hidden-effect").replace({"drive.phases": PHASES})
    runs = [*(dict(each) for each in base.data["measured"]), *(dict(each) for each in FURTHER)]
    use_effects(HIDDEN)
    hidden = base.replace({"mesh.size": SIZE_OF_DATA, "effects": [dict(entry)], "measured": []})
    rng = np.random.default_rng(seed)
    folder.mkdir(parents=True, exist_ok=True)
    for run in runs:
        readings = hidden.with_drive(run.get("drive", {})).run().readings
        times = np.arange(0.0, float(readings["time_s"].iloc[-1]) + 1e-6, EVERY)
        columns = {"time [s]": times}
        for sensor in (*base.sensors, GAS):
            computed = np.interp(times, readings["time_s"], readings[sensor])
            columns[f"{sensor} [degC]"] = np.round(computed + NOISE * rng.normal(size=len(times)), 2)
        pd.DataFrame(columns).to_csv(folder / f"{run['run']}.csv", index=False)
        run["table"] = f"{run.pop('run')}.csv"
    os.environ[FOLDERS] = ""
    study = base.replace({"mesh.size": SIZE, "measured": runs, "diagnosis.exclude": sorted({*exclude, *left_out})})
    with atomic_path(folder / "study.toml") as temporary:
        temporary.write_text(tomli_w.dumps(dict(study.data)), encoding="utf-8")
    return tf.study(folder / "study.toml")


def diagnosed(study: tf.Study, folder: Path, name: str, effects: Path | None = None) -> dict[str, Any]:
    """The record of a diagnosis: from its file, if it is finished, else made and kept with its draft effect."""
    file = folder / f"{name}.json"
    if not file.exists():
        began = time.process_time()
        diagnosis: DiagnosisData = study.diagnose(settings=SETTINGS, workers=1, effects=effects)
        contents = record(diagnosis) | {"processor_s": time.process_time() - began}
        for source, text in draft_effects(diagnosis).items() if effects is None else ():
            (folder / EFFECTS).mkdir(exist_ok=True)
            (folder / EFFECTS / source).write_text(text, encoding="utf-8")
        with atomic_path(file) as temporary:
            temporary.write_text(json.dumps(contents), encoding="utf-8")
    contents = json.loads(file.read_text(encoding="utf-8"))
    print("  ", *contents["summary"], sep="\n   ", flush=True)
    print(f"   {contents['processor_s']:.0f} s of processor time", flush=True)
    return contents


def case_records(case: str, seed: int, records: Path, *, whole: bool) -> None:
    """One hidden law, diagnosed without and with its draft effect."""
    folder = records / f"{case}-{seed}"
    study = measured(folder, case, seed, whole=whole)
    diagnosed(study, folder, "first")
    if (folder / EFFECTS).exists():
        diagnosed(study, folder, "second", folder / EFFECTS)
        os.environ[FOLDERS] = ""


def main() -> None:
    """Run the cases."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--case", choices=[*CASES, "all"], default="all")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1])
    parser.add_argument("--all", action="store_true", help="the whole catalogue but effects of single sensors")
    parser.add_argument("--records", type=Path, default=RECORDS, help="folder of data and finished diagnoses")
    given = parser.parse_args()
    for seed in given.seeds:
        for case in CASES if given.case == "all" else [given.case]:
            print(f"{case}, seed {seed}", flush=True)
            case_records(case, seed, given.records, whole=given.all)


if __name__ == "__main__":
    main()
