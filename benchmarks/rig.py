"""Identified conductivity and specific heat against the truth, on data made differently from how they are analysed.

Seeded cases from `tests/rig`: hexahedra on a doubly curved patch, BDF2, tabulated air, noise of 0.1 K (cameras) and
0.5 K (thermocouple), the spot, the thermocouple, films, absorptance and offsets as far off as the rig's card says.
Every second case has properties that are linear in temperature. Prints one line per case and, last, one JSON object.
Usage: python benchmarks/rig.py [--cases N] [--first SEED] [--jobs N] [--save FILE] [--tables FOLDER]
"""

# ruff: noqa: E402 - the number of BLAS threads must be set before numpy is loaded.
from __future__ import annotations

import os

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

import argparse
import json
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "rig"))

from cases import measured, properties, truth

from tyrefem.heating_test.readings import matched
from tyrefem.heating_test.selection import COVERAGE
from tyrefem.rig import identify, load


def case(seed: int, tables: str | None = None) -> dict[str, Any]:
    """One case: errors, half widths and hits of the four properties, and of the slopes' choice."""
    card, _ = load("trtlab")
    real = truth(seed, card, linear=seed % 2 == 1)
    start = time.perf_counter()
    runs = kept(seed, card, real, tables)
    made = time.perf_counter()
    found = identify(card, tests=[matched(card, run, list(card.sensors)) for run in runs])
    done = time.perf_counter()
    rows: dict[str, Any] = {}
    true = properties(card, real)
    for name, value in true.items():
        one = found.by_name[name]
        rows[name] = {
            "true": value,
            "error": one.value / value - 1,
            "relative_sd": one.relative_sd,
            "inside": one.holds(value),
            "z": float(np.log(one.value / value)) / (one.relative_sd or 1.0),
            "verdict": one.verdict,
        }
    slopes = {
        f"{layer.name}.{key}_slope": value
        for layer, own in zip(card.layers, real.layers, strict=True)
        for key, value in (("conductivity", own.k_slope), ("specific_heat", own.c_slope))
    }
    return {
        "seed": seed,
        "properties": rows,
        "slopes": {name: value for name, value in slopes.items() if value},
        "chosen": list(found.selection.chosen),
        "model_error": dict(found.fit.noise.model),
        "solutions": found.fit.solutions,
        "seconds": [made - start, done - made],
    }


def kept(seed: int, card: Any, real: Any, tables: str | None) -> list[Any]:
    """The case's tables, from the folder where they were kept, else made."""
    from tyrefem.measured import read_table

    if tables is None:
        return measured(seed, card, real)
    folder = Path(tables) / str(seed)
    if not (folder / "done").is_file():
        for run in measured(seed, card, real):
            run.write(folder / f"{run.name}.csv")
        (folder / "done").touch()
    return [read_table(folder / f"{name}.csv")[0] for name in card.runs]


def line(row: dict[str, Any]) -> str:
    """One case for people."""
    words = [
        f"{100 * one['error']:+6.1f} ±{100 * COVERAGE * one['relative_sd']:4.1f} %{' ' if one['inside'] else '*'}"
        for one in row["properties"].values()
    ]
    slopes = ", ".join(row["chosen"]) or "constant"
    return f"{row['seed']:4} {' '.join(words)}  {sum(row['seconds']):5.0f} s  {slopes}"


def rates(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """What the cases show together."""
    names = list(rows[0]["properties"])
    inside = np.array([[row["properties"][name]["inside"] for name in names] for row in rows])
    error = np.array([[abs(row["properties"][name]["error"]) for name in names] for row in rows])
    z = np.array([[row["properties"][name]["z"] for name in names] for row in rows])
    return {
        "cases": len(rows),
        "inside_95": dict(zip(names, inside.mean(axis=0).round(3).tolist(), strict=True)),
        "inside_95_of_all_numbers": round(float(inside.mean()), 3),
        "cases_with_all_inside": round(float(inside.all(axis=1).mean()), 3),
        "within_1.96_sd_of_all_numbers": round(float((np.abs(z) < 1.96).mean()), 3),
        "cases_with_all_within_1.96_sd": round(float((np.abs(z) < 1.96).all(axis=1).mean()), 3),
        "median_error": dict(zip(names, np.median(error, axis=0).round(4).tolist(), strict=True)),
        "largest_error": dict(zip(names, error.max(axis=0).round(4).tolist(), strict=True)),
        "sd_of_z": dict(zip(names, z.std(axis=0).round(2).tolist(), strict=True)),
        "seconds_per_identification": round(float(np.median([row["seconds"][1] for row in rows])), 1),
    }


def main() -> None:
    """Run the cases side by side."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=50)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--save", help="JSON file for every case")
    parser.add_argument("--tables", help="folder in which the cases' tables are kept, and taken from at the next run")
    given = parser.parse_args()
    seeds = range(given.first, given.first + given.cases)
    names = "tread k, tread c, carcass k, carcass c"
    print(f"seed  error ± half of the 95 % interval ({names}); * outside; time; linear properties chosen", flush=True)
    rows = []
    with ProcessPoolExecutor(given.jobs) as pool:
        for row in pool.map(case, seeds, [given.tables] * len(seeds)):
            rows.append(row)
            print(line(row), flush=True)
    if given.save:
        Path(given.save).write_text(json.dumps(rows, indent=1), encoding="utf-8")
    print(json.dumps(rates(rows)))


if __name__ == "__main__":
    main()
