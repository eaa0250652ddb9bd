"""Slopes of slip of the measured 205/60R15 in large motion: blocks of the tread, and bands from uncertain numbers.

    python benchmarks/rolling_bands.py [--blocks] [--inflated] [--cords] [--sensitivities] [--bands] [--picture]

Writes docs/evidence/tables/rolling-blocks.csv (a solid tread and one with transverse grooves and sipes, over load),
rolling-inflated.csv (the solid tread, where friction moves it as the inflated tyre), rolling-cords.csv (strains of
cords in the footprint), rolling-sensitivities.csv (each uncertain number one standard deviation away, on a coarse mesh)
and rolling-bands.csv beside the measured values; docs/pictures/rolling-bands.png. Rows that a table has are not
computed again. Nothing is fitted.
"""

from __future__ import annotations

import argparse
import csv
import itertools
import math
import os
import time
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from measured import UNCERTAIN, rows_of, scaled, text_of

import tyrefem as tf
from tyrefem.mechanics.rolling.slip_curve import slip_stiffness
from tyrefem.mechanics.rolling.wheel_on_road import wheel_on_road
from tyrefem.output import atomic_path

ROOT = Path(__file__).resolve().parents[1]
TABLES = ROOT / "docs" / "evidence" / "tables"
STUDY = ROOT / "studies" / "measured-205-60r15" / "study.toml"
#: Transverse grooves: ink prints of the 255/40ZR17 have 0.69 to 0.73 of their area in contact, mean 0.713, and its
#: section has 22 % of circumferential grooves; 1 - 0.713/0.78 is 0.09. Blocks, an estimate: 60 to 80 pitches of
#: 1.95 m, each with a groove and a sipe.
VOID, BLOCK = 0.09, 13e-3
BLOCKS = {
    "section.pattern.void": VOID,
    "section.pattern.block_length": f"{1e3 * BLOCK:g} mm",
    "section.pattern.source": "net over gross area of ink prints; estimate: 60 to 80 pitches, each with a sipe",
}
#: Loads, N, of the measured tyre, and those at which numbers are varied; elements of 16 and 24 mm; harmonics.
LOADS, VARIED = (2000.0, 3000.0, 4000.0, 5000.0, 6000.0), (6000.0, 2000.0)
FINE, COARSE, HARMONICS = "8 mm", "12 mm", 80
#: Numbers of `measured.py` that are varied. Left out as small: cords, gauges of walls, ply and apex, width of the
#: tread, friction and pressure.
CHOSEN = (
    "modulus of the tread", "modulus of the layers' rubber", "modulus of sidewall and chafer", "tread radius",
    "shoulder width", "tread gauge",
)  # fmt: skip
#: Regions whose cords are looked at, and distance from the mid plane, m.
CROWN, MIDDLE = ("body-ply", "belt-1", "belt-2", "cap-ply"), 0.015
#: Coefficient of friction. Uncertainty of the numbers: slopes change by 1 to 5 % with mesh and harmonics.
FRICTION, NUMERICAL = 1.0, 0.05
#: Standard uncertainty of measured slopes and trails, an estimate: the file gives none.
MEASUREMENT = 0.05
#: Column of the tables -> column of the measured file.
QUANTITIES = {
    "cornering stiffness [kN/rad]": "cornering_stiffness [kN/rad]",
    "slip stiffness [kN]": "longitudinal_slip_stiffness [kN]",
    "trail [mm]": "pneumatic_trail [mm]",
}
GOAL = 0.20


def variations(nominal: Any, motion: str) -> Iterator[tuple[str, str, dict[str, Any]]]:
    """Number, its change, changes of the study: the angle in large motion, all else linear."""
    yield "nominal", "", {}
    if motion == "large":
        yield from angles()
        return
    for number in CHOSEN:
        where, deviation = UNCERTAIN[number]
        yield number, f"+{100 * deviation:g} %", scaled(nominal, where, 1 + deviation)
    yield "void of transverse grooves", "+0.03", {"section.pattern.void": VOID + 0.03}
    yield "length of blocks", "-5 mm", {"section.pattern.block_length": f"{1e3 * BLOCK - 5:g} mm"}


def angles() -> Iterator[tuple[str, str, dict[str, Any]]]:
    """The belts' angle 3 deg more and less."""
    for sign, words in ((1, "+3 deg"), (-1, "-3 deg")):
        angle = f"{20 + 3 * sign} deg"
        yield "angle of the belts' cords", words, {f"materials.belt-{ply}.cords.angle": angle for ply in (1, 2)}


def slopes(study: Any, load: float, motion: str, inflated: bool = False) -> dict[str, float]:
    """Cornering and slip stiffness and trail; ``inflated``: with the compliance of the inflated tyre."""
    wheel = wheel_on_road(study, load=load, friction=FRICTION, motion=motion)
    if inflated:
        wheel = replace(wheel, rolling=replace(wheel.rolling, shape=replace(wheel.rolling.shape, loaded=None)))
    made, contact = slip_stiffness(wheel, HARMONICS), wheel.pressed.footprint
    return {
        "cornering stiffness [kN/rad]": made.cornering / 1e3,
        "slip stiffness [kN]": made.slip / 1e3,
        "trail [mm]": 1e3 * made.trail,
        "deflection [mm]": 1e3 * contact.deflection,
        "length [mm]": 1e3 * contact.length,
    }


class Rows:
    """A table that is written after every row; rows with known keys are not computed again."""

    def __init__(self, name: str) -> None:
        self.path = TABLES / f"{name}.csv"
        self.rows = rows_of(self.path) if self.path.is_file() else []

    def add(
        self, keys: Mapping[str, Any], study: Any, load: float, motion: str = "large", inflated: bool = False
    ) -> None:
        """Append keys and slopes, unless a row has these keys."""
        cells = text_of(keys)
        if any(cells.items() <= row.items() for row in self.rows):
            return
        began = time.process_time()
        self.rows.append({**cells, **text_of(slopes(study, load, motion, inflated))})
        write(self.path, self.rows)
        print(*self.rows[-1].values(), f"{time.process_time() - began:.0f} s", flush=True)


def write(path: Path, rows: list[dict[str, str]]) -> None:
    """Write all rows."""
    with atomic_path(path) as made, open(made, "w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, rows[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def blocks() -> None:
    """A solid tread and one with blocks at every measured load."""
    table, study = Rows("rolling-blocks"), tf.study(STUDY, {"mesh.size": FINE})
    for (tread, changes), load in itertools.product((("solid", {}), ("blocks", BLOCKS)), LOADS):
        table.add({"load [N]": f"{load:g}", "tread": tread}, study.replace(changes), load)


def inflated() -> None:
    """A solid tread that friction moves as that of the inflated tyre, at every measured load."""
    table, study = Rows("rolling-inflated"), tf.study(STUDY, {"mesh.size": FINE})
    for load in LOADS:
        table.add({"load [N]": f"{load:g}"}, study, load, inflated=True)


def cords() -> None:
    """Strain of the crown's cords: inflated, and in the middle of the footprint."""
    study, rows = tf.study(STUDY, {"mesh.size": "10 mm", "mechanics.motion": "large"}), []
    for load in LOADS[::2]:
        pressed = study.press(load=load)
        body, deformation = pressed.tyre.body, pressed.tyre.deformation
        for region in CROWN:
            members = np.asarray(body.mesh.subdomains[region])
            middle = np.abs(body.rings.points[1][members].mean(axis=-1)) < MIDDLE
            layer = body.parts[region].cords[0]
            stretch = layer.stretch(deformation[:, :, members])
            carried = np.einsum("ij...,j...->i...", deformation[:, :, members], layer.directions[0]) / stretch
            strain = pressed.cycle.along(carried, np.zeros(1), members)[..., 0]
            under = stretch * np.sqrt(1 + 2 * strain) - 1
            rows.append({
                "load [N]": f"{load:g}", "region": region, "inflated [%]": f"{100 * (stretch[middle].mean() - 1):.3f}",
                "in the footprint [%]": f"{100 * under[middle].mean():.3f}",
            })  # fmt: skip
            print(*rows[-1].values(), flush=True)
    write(TABLES / "rolling-cords.csv", rows)


def sensitivities() -> None:
    """Each uncertain number one standard deviation away, with blocks."""
    table = Rows("rolling-sensitivities")
    study = tf.study(STUDY, {"mesh.size": COARSE})
    for motion, load in itertools.product(("large", "linear"), VARIED):
        for number, change, changes in variations(study, motion):
            keys = {"load [N]": f"{load:g}", "motion": motion, "number": number, "change": change}
            table.add(keys, study.replace({**BLOCKS, **changes}), load, motion)


def band(name: str, load: float, by_load: Mapping[float, list[dict[str, str]]]) -> tuple[float, float]:
    """Relative standard uncertainty downwards and upwards: root of the sum of squares, between loads linear.

    A number counts both ways but for the belts' angle, of which each way has its own change.
    """
    parts = []
    for varied in VARIED:
        rows = by_load[varied]
        nominal = {row["motion"]: float(row[name]) for row in rows if row["number"] == "nominal"}
        down, up = NUMERICAL**2, NUMERICAL**2
        angles = [0.0]
        for row in rows:
            change = float(row[name]) / nominal[row["motion"]] - 1
            if row["number"].startswith("angle"):
                angles.append(change)
            else:
                down, up = down + change**2, up + change**2
        parts.append((math.sqrt(down + min(angles) ** 2), math.sqrt(up + max(angles) ** 2)))
    low, high = (float(np.interp(load, VARIED[::-1], part[::-1])) for part in zip(*parts, strict=True))
    return low, high


def bands() -> None:
    """Computed values with their bands beside the measured ones."""
    made = rows_of(TABLES / "rolling-blocks.csv")
    varied = rows_of(TABLES / "rolling-sensitivities.csv")
    by_load = {load: [row for row in varied if float(row["load [N]"]) == load] for load in VARIED}
    rows = []
    for line, (name, key) in itertools.product(rows_of(STUDY.parent / "summary.csv"), QUANTITIES.items()):
        load, known = float(line["load [N]"]), float(line[key])
        values = {row["tread"]: float(row[name]) for row in made if float(row["load [N]"]) == load}
        value = values["blocks"]
        low, high = band(name, load, by_load)
        error = value / known - 1
        # What reaches from the computed value towards the measured one.
        side = math.hypot((low if error > 0 else high) * value / known, MEASUREMENT)
        verdict = "within u" if abs(error) <= side else "within 2 u" if abs(error) <= 2 * side else "model error"
        rows.append({
            "load [N]": line["load [N]"], "quantity": name, "measured": f"{known:g}",
            "solid tread": f"{values['solid']:.4g}", "blocks": f"{value:.4g}",
            "u below [%]": f"{100 * low:.0f}", "u above [%]": f"{100 * high:.0f}",
            "deviation [%]": f"{100 * error:+.1f}",
            "within 20 %": "yes" if abs(error) <= GOAL else "no", "verdict": verdict,
        })  # fmt: skip
        print(*rows[-1].values(), flush=True)
    write(TABLES / "rolling-bands.csv", rows)


def picture() -> None:
    """Draw measured and computed values over load, the latter with their bands."""
    from tyrefem.reports.figures.style import INK, PALETTE, add_axes, figure, png

    rows = rows_of(TABLES / "rolling-bands.csv")
    drawn = figure(11.0, 3.6)
    axes = [add_axes(drawn, 0.65 + 3.6 * column, 0.55, 2.8, 2.85) for column in range(3)]
    for axis, name in zip(axes, QUANTITIES, strict=True):
        own = [row for row in rows if row["quantity"] == name]
        load, known, solid, cut, below, above = (
            np.array([float(row[key]) for row in own])
            for key in (
                "load [N]",
                "measured",
                "solid tread",
                "blocks",
                "u below [%]",
                "u above [%]",
            )
        )
        x = load / 1e3
        axis.fill_between(
            x, cut * (1 - below / 100), cut * (1 + above / 100), color=PALETTE[0], alpha=0.2, lw=0, label="band"
        )
        axis.plot(x, solid, ":", color=PALETTE[0], label="solid tread")
        axis.plot(x, cut, "-", color=PALETTE[0], label="blocks")
        axis.errorbar(x, known, GOAL * known, fmt="o", color=INK, capsize=3, label="measured, 20 %")
        axis.set(xlabel="load, kN", ylabel=name.replace(" [", ", ").rstrip("]"), xlim=(1.8, 6.2), ylim=(0, None))
    axes[0].legend(frameon=False, loc="upper left", fontsize=8)
    (TABLES.parents[1] / "pictures" / "rolling-bands.png").write_bytes(png(drawn))


def main() -> None:
    """Run the parts that are named, or all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parts = {
        "blocks": blocks,
        "inflated": inflated,
        "cords": cords,
        "sensitivities": sensitivities,
        "bands": bands,
        "picture": picture,
    }
    for name in parts:
        parser.add_argument(f"--{name}", action="store_true")
    chosen = vars(parser.parse_args())
    for part in [part for name, part in parts.items() if chosen[name]] or list(parts.values()):
        part()


if __name__ == "__main__":
    main()
