"""Heat of slip, slip angle and camber: the effects tread-slip, yaw and camber beside the tyre that rolls with friction.

    python benchmarks/slip_heat.py

Writes docs/evidence/tables/slip-heat.csv. The passenger's full section, coarse, linear motion, on its drum. Nothing is
fitted: an effect's amplitude is the sine of the slip angle, the slip ratio, or the camber.
"""

from __future__ import annotations

import csv
import math
import os
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

import tyrefem as tf

TABLE = Path(__file__).resolve().parents[1] / "docs" / "evidence" / "tables" / "slip-heat.csv"
STUDY = "passenger-205-55r16"
BASE = {
    "mesh.size": "8 mm", "mesh.section": "full", "mechanics.motion": "linear", "output.every": "300 s",
    "output.fields": 2,
}  # fmt: skip
#: Kind -> effect, its amplitude, the drive's quantity and unit, and values.
CASES: dict[str, tuple[str, str, str, tuple[float, ...]]] = {
    "slip angle": ("yaw", "slip", "slip_angle", (0.25, 0.5, 1.0, 2.0, 4.0, 6.0)),
    "slip": ("tread-slip", "slip", "slip_ratio", (0.0025, 0.005, 0.01, 0.02, 0.05, 0.1)),
    "camber": ("camber", "angle", "camber", (0.5, 1.0, 2.0, 4.0)),
}
#: s along the meridian, m, and share of the wall's thickness: both shoulders, in the tread and beside the belt's edge.
SHOULDER, DEPTHS = 0.068, (0.85, 0.35)


def amplitude(kind: str, value: float) -> Any:
    """What the effect takes for a value of the drive."""
    if kind == "camber":
        return f"{value:g} deg"
    return math.sin(math.radians(value)) if kind == "slip angle" else value


def written(kind: str, value: float) -> Any:
    """A value of the drive as in a study file."""
    return value if kind == "slip" else f"{value:g} deg"


def numbers(result: Any) -> dict[str, float]:
    """Heat at the end, W, and temperatures at both shoulders, degC."""
    section = result.study.section
    s = np.array([SHOULDER, -SHOULDER])
    temperatures = [result.at(section.place(s, share * section.total_thickness(np.abs(s))))[-1] for share in DEPTHS]
    budget = result.heat_budget
    effects = {effect for effect, *_ in CASES.values()}
    added = sum(float(-power[-1]) for (_, name), power in budget.powers.items() if name.split()[0] in effects)
    return {
        "friction_W": float(budget.power("sliding")[-1]) + added,
        "hysteresis_W": float(budget.power("generated")[-1]),
        **{
            f"{place}_{side}_degC": float(temperature[number])
            for place, temperature in zip(("tread", "belt_edge"), temperatures, strict=True)
            for number, side in enumerate(("left", "right"))
        },
    }


def rows() -> list[dict[str, Any]]:
    """A row per case: rise of heat and temperature over free rolling, by rolling and by the effect."""
    plain = tf.study(STUDY, BASE)
    rolling = plain.replace({"boundaries.sliding": "rolling"})
    free = {"rolling": numbers(rolling.run()), "effect": numbers(plain.run())}
    table = []
    for kind, (effect, name, quantity, values) in CASES.items():
        for value in values:
            entry = {"name": effect, name: amplitude(kind, value)}
            runs = {
                "rolling": rolling.replace({f"drive.{quantity}": written(kind, value)}),
                "effect": plain.replace({"effects": [entry]}),
            }
            row: dict[str, Any] = {"kind": kind, "effect": effect, "value": value}
            for way, study in runs.items():
                rises = {key: number - free[way][key] for key, number in numbers(study.run()).items()}
                row |= {f"{way}_{key}": round(rise, 3) for key, rise in rises.items()}
            table.append(row)
            print(row, flush=True)
    return table


def main() -> None:
    """Write the table."""
    table = rows()
    with TABLE.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, list(table[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(table)


if __name__ == "__main__":
    main()
