"""Bias aircraft tyres of the data book by finite elements in large motion, row by row; nothing is fitted.

    python benchmarks/measured_aircraft.py [PART ...]

Parts: rated, bottoming, sensitivities; all by default. They write measured-aircraft-fe.csv,
measured-aircraft-bottoming.csv and measured-aircraft-sensitivities.csv in docs/evidence/tables. Rows that a table
already has are not computed again: delete the table to begin anew.

Rule of the rows, stated before anything was computed:

- Rows of the data book that are equal in size, ply rating, load, pressure and all dimensions count once: 348 of 395.
- Chosen: the three 22x5.5, and by rising rated load every tenth of the others, from the fifth on: 38 rows.
- If a rule of the sizes changes because of a computed row, only rows of the group `used` may be looked at: the
  three 22x5.5 and the 1st, 3rd, 5th, ... of the others. The group `judged` judges.
- Each section has its row's diameter, width, rim, ply rating, load and pressure; all else is by the rules of its kind.
- Elements are in proportion to the section: 0.114 widths (16 mm for the 22x5.5).
"""

from __future__ import annotations

import argparse
import csv
import math
import os
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.harmonic_balance import Balance
from tyrefem.mechanics.footprint.pressed_tyre import mechanical_mesh
from tyrefem.mechanics.solid.inflation import Inflation, inflate
from tyrefem.output import atomic_path
from tyrefem.sizes.data_book import FILE as DATA_BOOK
from tyrefem.sizes.rules import UNITS
from tyrefem.sizes.section import draw_size

TABLES = Path(__file__).resolve().parents[1] / "docs" / "evidence" / "tables"
LBF, PSI, INCH = 4.4482216152605, 6894.757293168361, 0.0254
FIRST_SIZE, FIRST, EVERY = "22x5.5", 4, 10
#: Size of the study's mesh over the section width; nine-node elements are twice as large.
MESH = 0.057
#: Harmonics and tolerance of a balance.
HARMONICS, TOLERANCE = 24, 1e-3
#: Harmonics at the bottoming radius: fewer where a way to it ends early.
WAYS = (24, 16, 12)
#: Largest deflection over that at which the crown meets the rim.
BEFORE_RIM = 0.99
#: Number of a section or a card, and its standard deviation (relative): estimates.
UNCERTAIN: dict[str, tuple[str, float]] = {
    "outer diameter": ("outer_diameter", 0.008),
    "section width": ("section_width", 0.018),
    "crown angle of the cords, and the width with it": ("cord_angle", 0.05),
    "plies": ("ply_gauge", 0.15),
    "tread gauge": ("tread_gauge", 0.15),
    "sidewall gauge": ("sidewall_gauge", 0.20),
    "tread width": ("tread_width", 0.05),
    "turn-up height": ("turn_up_height", 0.15),
    "bead height": ("bead_height", 0.15),
    "flange radius": ("flange_radius", 0.20),
    "modulus of the cords": ("materials.carcass.cord.ply_shear_modulus", 0.20),
    "modulus of the plies' rubber": ("materials.carcass.shear_modulus.value", 0.20),
    "modulus of the tread": ("materials.tread.shear_modulus.value", 0.20),
    "modulus of the sidewall": ("materials.sidewall.shear_modulus.value", 0.20),
}
#: Tyres of `used` whose sensitivities are worked out: a small and a middle one.
SENSITIVE = ("22x5.5 10PR", "40x12 20PR")


@dataclass(frozen=True)
class CatalogueTyre:
    """A row of the data book, SI; ``number``: its place in the book; ``group``: used or judged."""

    number: int
    size: str
    ply_rating: int
    load: float
    pressure: float
    diameter: tuple[float, float]
    width: tuple[float, float]
    rim_diameter: float
    rim_width: float
    flange_height: float
    loaded_radius: float
    bottoming_load: float
    bottoming_radius: float
    group: str = "judged"

    @property
    def name(self) -> str:
        """Size and ply rating."""
        return f"{self.size} {self.ply_rating}PR"

    @property
    def radius(self) -> float:
        """Mean of least and largest outer radius, m."""
        return sum(self.diameter) / 4

    @property
    def deflection(self) -> float:
        """At the rated load, m."""
        return self.radius - self.loaded_radius

    @property
    def uncertainty(self) -> float:
        """Standard uncertainty of the deflection, relative: a radius anywhere between least and largest, a loaded
        radius rounded to 0.05 in."""
        of_radius = (self.diameter[1] - self.diameter[0]) / 4 / math.sqrt(3)
        return math.hypot(of_radius, 0.05 * INCH / math.sqrt(3)) / self.deflection

    def study(self, changes: Mapping[str, Any] | None = None) -> StudyData:
        """The study of the row; ``changes``: numbers of the section, or dotted names of materials."""
        changes = dict(changes or {})
        materials: dict[str, Any] = {}
        for key in [key for key in changes if key.startswith("materials.")]:
            place = materials
            *way, last = key.split(".")[1:]
            for step in way:
                place = place.setdefault(step, {})
            place[last] = changes.pop(key)
        data = {
            "title": self.name,
            "section": {"size": self.name, "parameters": {**self.numbers, **changes}},
            "materials": materials,
            "mesh": {"size": f"{MESH * sum(self.width) / 2 * 1e3:.4g} mm", "through": 1},
            "drive": {
                "speed": "20 mph",
                "load": f"{self.load:.9g} N",
                "pressure": f"{self.pressure:.9g} Pa",
                "duration": "60 s",
                "ambient": "25 degC",
            },
        }
        return StudyData("measured-aircraft", data, None, Path())

    @property
    def numbers(self) -> dict[str, str]:
        """The row as numbers of a section."""
        lengths = {
            "outer_diameter": sum(self.diameter) / 2,
            "section_width": sum(self.width) / 2,
            "rim_diameter": self.rim_diameter,
            "rim_width": self.rim_width,
            "flange_height": self.flange_height,
        }
        return {
            **{name: f"{value / INCH:.9g} in" for name, value in lengths.items()},
            "rated_load": f"{self.load:.9g} N",
            "rated_pressure": f"{self.pressure:.9g} Pa",
        }


def catalogue() -> list[CatalogueTyre]:
    """Distinct rows by rising rated load."""
    lines = [line for line in DATA_BOOK.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    tyres: dict[tuple[Any, ...], CatalogueTyre] = {}
    for number, row in enumerate(csv.DictReader(lines), 1):

        def inches(name: str, row: Mapping[str, str] = row) -> float:
            text = row[f"{name} [in]"].strip()
            return float(text) * INCH if text else math.nan

        bottoming = row["bottoming_load [lbf]"].strip()
        tyre = CatalogueTyre(
            number,
            row["size"].strip().lstrip("*"),
            int(row["ply_rating"]),
            float(row["rated_load [lbf]"]) * LBF,
            float(row["rated_pressure [psi]"]) * PSI,
            (inches("outside_diameter_min"), inches("outside_diameter_max")),
            (inches("section_width_min"), inches("section_width_max")),
            inches("rim_diameter"),
            inches("rim_width_between_flanges"),
            inches("flange_height"),
            inches("static_loaded_radius_at_rated_load"),
            float(bottoming) * LBF if bottoming else math.nan,
            inches("loaded_radius_at_bottoming"),
        )
        tyres.setdefault(tuple(str(value) for value in vars(tyre).values())[1:], tyre)
    return sorted(tyres.values(), key=lambda tyre: (tyre.load, tyre.number))


def chosen() -> list[CatalogueTyre]:
    """The rows that are computed, by the rule above."""
    from dataclasses import replace

    tyres = catalogue()
    first = [replace(tyre, group="used") for tyre in tyres if tyre.size == FIRST_SIZE]
    others = [tyre for tyre in tyres if tyre.size != FIRST_SIZE][FIRST::EVERY]
    return first + [replace(tyre, group=("used", "judged")[n % 2]) for n, tyre in enumerate(others)]


def inflated(tyre: CatalogueTyre, changes: Mapping[str, Any] | None = None) -> tuple[Inflation, Pressing]:
    """The tyre at its rated pressure, and on a flat road."""
    study = tyre.study(changes)
    state = inflate(study, mesh=mechanical_mesh(study, large=True))
    return state, Pressing(state.state)


def label(tyre: CatalogueTyre) -> dict[str, Any]:
    """What names a row in a table."""
    return {
        "row": tyre.number,
        "size": tyre.size,
        "ply rating": tyre.ply_rating,
        "group": tyre.group,
        "load [N]": tyre.load,
        "pressure [kPa]": tyre.pressure / 1e3,
    }


def rated(tyre: CatalogueTyre) -> dict[str, Any]:
    """Deflection at the rated load in large motion and linear, and the inflated size beside the data book's."""
    row = {
        **label(tyre),
        "catalogue deflection [mm]": tyre.deflection * 1e3,
        "u of the catalogue, %": 100 * tyre.uncertainty,
    }
    names = (
        "computed deflection [mm]", "computed over catalogue", "linear deflection [mm]", "contact length [mm]",
        "contact width [mm]", "inflated diameter over largest", "inflated diameter over least",
        "inflated width over largest", "inflated width over least", "mean stretch of the cords", "nodes", "message",
    )  # fmt: skip
    row |= dict.fromkeys(names, "")
    try:
        state, pressing = inflated(tyre)
        diameter, width = 2 * state.places[0].max(), 2 * state.places[1].max()
        row |= {
            "linear deflection [mm]": pressing.at_load(tyre.load, 36).deflection * 1e3,
            "inflated diameter over largest": float(diameter / tyre.diameter[1]),
            "inflated diameter over least": float(diameter / tyre.diameter[0]),
            "inflated width over largest": float(width / tyre.width[1]),
            "inflated width over least": float(width / tyre.width[0]),
            "mean stretch of the cords": state.cord_tensions["carcass"].strain[1],
            "nodes": state.body.rings.n_nodes,
        }
        footprint = Balance(pressing, HARMONICS, tolerance=TOLERANCE).at_load(tyre.load)
    except InputError as error:
        return {**row, "message": str(error)}
    return {
        **row,
        "computed deflection [mm]": footprint.deflection * 1e3,
        "computed over catalogue": footprint.deflection / tyre.deflection,
        "contact length [mm]": footprint.length * 1e3,
        "contact width [mm]": footprint.width * 1e3,
    }


def bottoming(tyre: CatalogueTyre) -> dict[str, Any] | None:
    """Load at the catalogue's bottoming radius, or just before the crown meets the rim if that comes first; where no
    balance reaches it, the last one on the way."""
    deflection = tyre.radius - tyre.bottoming_radius
    if math.isnan(deflection + tyre.bottoming_load):
        return None
    row = {
        **label(tyre),
        "bottoming load [N]": tyre.bottoming_load,
        "deflection at the bottoming radius [mm]": deflection * 1e3,
        "reached deflection [mm]": "",
        "computed load [N]": "",
        "crown meets the rim at [mm]": "",
        "harmonics": "",
        "message": "",
    }
    try:
        pressing = inflated(tyre)[1]
    except InputError as error:
        return {**row, "message": str(error)}
    row["crown meets the rim at [mm]"] = pressing.bottoming * 1e3
    reached, load = 0.0, 0.0
    for harmonics in WAYS:
        balance = Balance(pressing, harmonics, tolerance=TOLERANCE)
        try:
            footprint = balance.at_deflection(min(deflection, BEFORE_RIM * pressing.bottoming))
            reached, load, row["message"] = footprint.deflection, footprint.load, ""
            break
        except InputError as error:
            row["message"] = str(error)
            reached, load = max((reached, load), balance.path[-1] if balance.path else (0.0, 0.0))
    return {**row, "reached deflection [mm]": reached * 1e3, "computed load [N]": load, "harmonics": harmonics}


def sensitivities(tyre: CatalogueTyre) -> Iterator[dict[str, Any]]:
    """Relative change of the deflection by one standard deviation of each number, in large motion."""

    def deflection(changes: Mapping[str, Any]) -> float:
        return Balance(inflated(tyre, changes)[1], HARMONICS, tolerance=TOLERANCE).at_load(tyre.load).deflection

    nominal = deflection({})
    rules = draw_size(tyre.name, tyre.numbers).rules
    study = tyre.study()
    for name, (where, deviation) in UNCERTAIN.items():
        if where.startswith("materials."):
            _, region, *path = where.split(".")
            value: Any = study.materials[region]
            value = value.cord.ply_shear_modulus if path[0] == "cord" else value.shear_modulus.value
            change = {where: f"{value * (1 + deviation):.9g} Pa"}
        else:
            unit = UNITS[rules[where].unit][0]
            change = {where: f"{rules[where].value * (1 + deviation):.9g} {unit}"}
        row = {"size": tyre.name, "number": name, "standard deviation": deviation, "deflection": "", "message": ""}
        try:
            yield {**row, "deflection": deflection(change) / nominal - 1}
        except InputError as error:
            yield {**row, "message": str(error)}


def table(name: str) -> list[dict[str, str]]:
    """Rows of a table of this script; none if it is not there."""
    path = TABLES / f"measured-aircraft-{name}.csv"
    if not path.is_file():
        return []
    with path.open(encoding="utf-8", newline="") as lines:
        return list(csv.DictReader(lines))


def write(name: str, rows: list[dict[str, Any]]) -> None:
    """A table of docs/evidence/tables; numbers with five digits."""
    path = TABLES / f"measured-aircraft-{name}.csv"
    with atomic_path(path) as temporary, open(temporary, "w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, rows[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows({k: f"{v:.5g}" if isinstance(v, float) else v for k, v in row.items()} for row in rows)


def remade(row: Mapping[str, Any]) -> bool:
    """A row that has a message in place of a result is computed again."""
    return bool(row["message"])


def computed(name: str, row_of: Callable[[CatalogueTyre], dict[str, Any] | None]) -> None:
    """Rows of the chosen tyres, each written as soon as it is there."""
    rows: list[dict[str, Any]] = [dict(row) for row in table(name) if not remade(row)]
    made = {int(row["row"]) for row in rows}
    tyres = chosen()
    for tyre in [tyre for part in range(3) for tyre in tyres[part::3]]:  # an unfinished table has all sizes of tyre
        if tyre.number in made:
            continue
        began = time.process_time()
        row = row_of(tyre)
        if row is None:
            continue
        rows.append(row)
        order = {tyre.number: place for place, tyre in enumerate(tyres)}
        rows.sort(key=lambda row: order[int(row["row"])])
        write(name, rows)
        print(tyre.name, row, f"{time.process_time() - began:.0f} s", flush=True)


def all_sensitivities() -> None:
    """Sensitivities of a few tyres."""
    rows: list[dict[str, Any]] = [dict(row) for row in table("sensitivities")]
    made = {row["size"] for row in rows}
    for tyre in chosen():
        if tyre.name in SENSITIVE and tyre.name not in made:
            for row in sensitivities(tyre):
                rows.append(row)
                write("sensitivities", rows)
                print(row, flush=True)


PARTS: dict[str, Callable[[], None]] = {
    "rated": lambda: computed("fe", rated),
    "bottoming": lambda: computed("bottoming", bottoming),
    "sensitivities": all_sensitivities,
}


def main() -> None:
    """Run the parts that the command names."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("parts", nargs="*", metavar="PART", help=", ".join(PARTS))
    for name in parser.parse_args().parts or list(PARTS):
        if name not in PARTS:
            parser.error(f"no part '{name}'; allowed: {', '.join(PARTS)}")
        PARTS[name]()


if __name__ == "__main__":
    main()
