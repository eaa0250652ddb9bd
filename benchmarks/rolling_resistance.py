"""Rolling resistance of the measured 205/60R15, cold and warm, over load and pressure: nothing is fitted.

    python benchmarks/rolling_resistance.py [--motion large|linear] [--quick] [--picture]

Each row is a run of studies/measured-205-60r15 with its temperatures: ``cold`` is the coefficient at the initial
temperature, ``warm`` that at the end. With ``moduli`` "constant" the cards' strain dependence is left out. Writes
docs/evidence/tables/measured-rolling.csv and prints the exponents over load and pressure. With --quick only the row at
4 kN is computed, and printed beside that of the table.
"""

from __future__ import annotations

import argparse
import csv
import os
from dataclasses import replace
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

import tyrefem as tf
from tyrefem.inputs.study import StudyData
from tyrefem.inputs.study_materials import StudyMaterials
from tyrefem.output import atomic_path

ROOT = Path(__file__).resolve().parents[1]
STUDY = ROOT / "studies" / "measured-205-60r15" / "study.toml"
TABLE = ROOT / "docs" / "evidence" / "tables" / "measured-rolling.csv"
PICTURE = ROOT / "docs" / "pictures" / "rolling-resistance.png"
MEASURED = STUDY.parent / "summary.csv"
#: Load, N, and pressure, kPa: of the quick row, and of all.
TYPICAL = (4000, 220)
CASES = ((2000, 220), (3000, 220), (4000, 220), (5000, 220), (6000, 220), (4000, 200), (4000, 240))


def constant(study: Any) -> Any:
    """The study with cards whose moduli do not depend on strain."""
    materials = study.parts.materials
    cards = {name: card.model_copy(update={"strain_dependence": None}) for name, card in materials.cards.items()}
    bare = StudyMaterials(materials.references, materials.folder, cards, materials.written)
    return type(study)(study.name, study.data, study.file, study.folder, built=replace(study.parts, materials=bare))


def row(study: StudyData, moduli: str, load: float, pressure: float) -> dict[str, Any]:
    """The coefficients of one load and pressure."""
    result: Any = study.run()  # type: ignore[attr-defined]
    resistance, hottest = result.rolling_resistance, result.extremes.temperature_degC.iloc[0]
    return {
        "moduli": moduli,
        "motion": study.card.mechanics.motion,
        "load [N]": load,
        "pressure [kPa]": pressure,
        "cold coefficient [1]": resistance.cold_coefficient,
        "warm coefficient [1]": resistance.coefficient,
        "hottest [degC]": float(hottest),
    }


def exponent(rows: list[dict[str, Any]], over: str, value: str) -> float:
    """Slope of the logarithms."""
    return float(np.polyfit(*(np.log([each[name] for each in rows]) for name in (over, value)), 1)[0])


def picture() -> None:
    """Coefficient over load at 220 kPa, of the table, beside the measured points."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    with open(TABLE, encoding="utf-8") as file:
        rows = [each for each in csv.DictReader(file) if each["pressure [kPa]"] == "220"]
    with open(MEASURED, encoding="utf-8") as file:
        points = list(csv.DictReader(line for line in file if not line.startswith("#")))
    figure, axes = plt.subplots(figsize=(6.4, 3.6), layout="constrained")
    name = "rolling_resistance_coefficient [1]"
    axes.plot([float(p["load [N]"]) for p in points], [float(p[name]) for p in points], "ko", label="measured")
    for moduli, words, style in (("secant", "", "-"), ("constant", ", moduli do not depend on strain", ":")):
        for value, colour in (("warm", "tab:red"), ("cold", "tab:blue")):
            of = [(float(r["load [N]"]), float(r[f"{value} coefficient [1]"])) for r in rows if r["moduli"] == moduli]
            axes.plot(*zip(*of, strict=True), style, color=colour, label=f"computed, {value}{words}")
    axes.set(xlabel="load, N", ylabel="rolling resistance coefficient", ylim=(0, 0.0105))
    axes.set_title("205/60R15, 60 km/h, 220 kPa", loc="left", fontsize=10)
    axes.legend(fontsize=8, frameon=False, ncols=2)
    with atomic_path(PICTURE) as path:
        figure.savefig(path, dpi=130, format="png")


def computed(moduli: str, load: float, pressure: float, motion: str) -> dict[str, Any]:
    """The row of a load, N, and a pressure, kPa."""
    changes = {"drive.load": f"{load} N", "drive.pressure": f"{pressure} kPa", "mechanics.motion": motion}
    study = tf.study(STUDY, {**changes, "mechanics.moduli": "card" if moduli == "constant" else moduli})
    return row(constant(study) if moduli == "constant" else study, moduli, load, pressure)


def quick(motion: str) -> None:
    """Print the row of the typical load and pressure beside that of the table."""
    load, pressure = TYPICAL
    with TABLE.open(encoding="utf-8") as file:
        stored = next(
            each for each in csv.DictReader(file)
            if (each["moduli"], each["load [N]"], each["pressure [kPa]"]) == ("secant", str(load), str(pressure))
        )  # fmt: skip
    for key, value in computed("secant", load, pressure, motion).items():
        print(f"{key:40s} {value:<12.5g} stored: {stored[key]}" if isinstance(value, float) else f"{key:40s} {value}")


def main() -> None:
    """Compute all rows."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--motion", choices=("large", "linear"), default="large")
    parser.add_argument("--picture", action="store_true", help="only the picture, of the present table")
    parser.add_argument("--quick", action="store_true", help="only the row at 4 kN and 220 kPa, printed")
    arguments = parser.parse_args()
    if arguments.quick:
        quick(arguments.motion)
        return
    if arguments.picture:
        picture()
        return
    motion = arguments.motion
    rows: list[dict[str, Any]] = []
    for moduli in ("secant", "constant"):
        for load, pressure in CASES:
            rows.append(computed(moduli, load, pressure, motion))
            print({key: f"{v:.5g}" if isinstance(v, float) else v for key, v in rows[-1].items()}, flush=True)
            with atomic_path(TABLE) as path, open(path, "w", encoding="utf-8", newline="") as file:
                writer = csv.DictWriter(file, rows[0], lineterminator="\n")
                writer.writeheader()
                writer.writerows(
                    {key: f"{v:.5g}" if isinstance(v, float) else v for key, v in each.items()} for each in rows
                )
        for value in ("cold coefficient [1]", "warm coefficient [1]"):
            here = [each for each in rows if each["moduli"] == moduli]
            over_load = [each for each in here if each["pressure [kPa]"] == 220]
            over_pressure = [each for each in here if each["load [N]"] == 4000]
            print(
                f"{moduli}, {value}: exponent over load {exponent(over_load, 'load [N]', value):+.2f}, "
                f"over pressure {exponent(over_pressure, 'pressure [kPa]', value):+.2f}"
            )
    picture()


if __name__ == "__main__":
    main()
