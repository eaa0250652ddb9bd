"""Measured tyres against computed ones: nothing is fitted, sections come from their sizes.

    python benchmarks/measured.py [PART ...] [--resume] [--quick]

Parts: moduli, passenger, radius, prints, pressure, numerics, sensitivities, aircraft; all by default. Each writes a
table measured-PART.csv to docs/evidence/tables, row by row; --resume keeps the rows that are there. --quick computes
one row of each data set on a coarse mesh and prints it beside the stored row. `python tools/make_measured_page.py`
makes docs/measured.md and its figures of the tables.
"""

from __future__ import annotations

import argparse
import csv
import os
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from measured_tyres import TEMPERATURES, Tyre, pressure_quarter

from tyrefem.errors import InputError
from tyrefem.inputs.loading import TrR64
from tyrefem.output import atomic_path
from tyrefem.sizes.data_book import FILE as DATA_BOOK
from tyrefem.sizes.section import drawn_of

ROOT = Path(__file__).resolve().parents[1]
TABLES = ROOT / "docs" / "evidence" / "tables"
PASSENGER, SPORTS = (
    str(ROOT / "studies" / name / "study.toml") for name in ("measured-205-60r15", "measured-255-40r17")
)
LBF, PSI, INCH = 4.4482216152605, 6894.757293168361, 0.0254
#: The RE-71R: tread as stated, body plies of the size's rule.
WORN = {"section.parameters": {"tread_gauge": "4.5 mm"}}
#: Mesh of the tables, the finer one of the numerical error, and the coarse one of moduli, sensitivities and --quick:
#: elements of the mechanics have 16, 10 and 24 mm.
MESH, FINE, COARSE = "8 mm", "4 mm", "12 mm"
#: More harmonics, of numerical error: of large motion, of its contact, of linear motion.
MORE = {"harmonics": 36, "contact": 180, "linear_harmonics": 144}
#: Motions of the tables; the first is that of the pressure and of --quick.
MOTIONS = ("large", "linear")
#: Number of a section or a card, and its standard deviation (relative): those of the cards, gauges 10 % by estimate.
UNCERTAIN: dict[str, tuple[str, float]] = {
    "tread gauge": ("section.tread_gauge", 0.05),
    "sidewall gauge": ("section.sidewall_gauge", 0.10),
    "ply gauge": ("section.ply_gauge", 0.10),
    "crown radius": ("section.crown_radius", 0.20),
    "tread radius": ("section.tread_radius", 0.20),
    "shoulder width": ("section.shoulder_width", 0.30),
    "tread width": ("section.tread_width", 0.03),
    "apex height": ("section.apex_height", 0.15),
    "modulus of the tread": ("rubber:tread", 0.20),
    "modulus of sidewall and chafer": ("rubber:sidewall,chafer,liner", 0.20),
    "modulus of the apex": ("rubber:apex", 0.20),
    "modulus of the layers' rubber": (
        "rubber:body-ply,turn-up,belt-1,belt-2,cap-ply,undertread,shoulder-cushion",
        0.20,
    ),
    "modulus of the body ply's cords": ("cords:body-ply,turn-up,bead-wrap", 0.15),
    "modulus of the belts' cords": ("cords:belt-1,belt-2", 0.15),
    "modulus of the cap ply's cords": ("cords:cap-ply", 0.15),
}
#: Relative standard deviation of every card's loss tangent; the compounds whose loss tangents vary together.
LOSS_TANGENT = 0.20
LOSSES = {
    "the tread": ("tread",),
    "sidewall, chafer and apex": ("sidewall", "chafer", "apex"),
    "the other compounds": (
        "liner", "body-ply", "turn-up", "bead-wrap", "belt-1", "belt-2", "cap-ply", "undertread", "shoulder-cushion",
    ),
}  # fmt: skip


def rows_of(path: Path) -> list[dict[str, str]]:
    """Rows of a data file; lines that begin with # are its source."""
    lines = [line for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


def text_of(row: Mapping[str, Any]) -> dict[str, str]:
    """Cells of a table; numbers with five digits."""
    return {key: f"{value:.5g}" if isinstance(value, float) else str(value) for key, value in row.items()}


class Table:
    """A table of docs/evidence/tables, written after every row. A row that is there is not computed again."""

    def __init__(self, name: str, resume: bool) -> None:
        self.path = TABLES / f"measured-{name}.csv"
        self.rows = rows_of(self.path) if resume and self.path.is_file() else []

    def add(self, keys: Mapping[str, Any], results: Callable[[], Mapping[str, Any]]) -> None:
        """Append keys and results as a row, unless a row has these keys; without an equilibrium, print why."""
        cells = text_of(keys)
        if any(cells.items() <= row.items() for row in self.rows):
            return
        began = time.process_time()
        try:
            row = text_of(results())
        except InputError as error:
            print(*cells.values(), error, flush=True)
            return
        self.rows.append({**cells, **row})
        self.write()
        print(*cells.values(), f"{time.process_time() - began:.1f} s", flush=True)

    def write(self) -> None:
        """Write all rows."""
        with atomic_path(self.path) as path, open(path, "w", encoding="utf-8", newline="") as file:
            writer = csv.DictWriter(file, self.rows[0], lineterminator="\n")
            writer.writeheader()
            writer.writerows(self.rows)


@dataclass(frozen=True)
class DataSet:
    """A measured tyre: table, study, changes of the study, and loads, N, by pressure, Pa."""

    table: str
    tyre: str
    study_file: str
    changes: Mapping[str, Any]
    loads: Mapping[float, tuple[float, ...]]
    #: Pressure and load of the row of --quick, and of the sensitivities.
    typical: tuple[float, float]
    _kept: dict[tuple[float, float], Tyre] = field(default_factory=dict, init=False, repr=False)

    def at(self, pressure: float, load: float) -> Tyre:
        """The tyre under a pressure with its moduli under a load; kept with its footprints."""
        if (pressure, load) not in self._kept:
            self._kept[pressure, load] = self.changed(pressure, load, {})
        return self._kept[pressure, load]

    def changed(self, pressure: float, load: float, changes: Mapping[str, Any]) -> Tyre:
        """The tyre under a pressure with its moduli under a load, and more changes."""
        every = {"mesh.size": MESH, **self.changes, **changes}
        return Tyre(self.study_file, every, pressure, self.amplitudes(load))

    def amplitudes(self, load: float) -> dict[str, float]:
        """Region -> strain amplitude of the stored table of moduli, at the typical pressure and a load, N."""
        row = next(
            (
                row
                for row in rows_of(TABLES / "measured-moduli.csv")
                if row["tyre"] == self.tyre and abs(float(row["load [N]"]) / load - 1) < 1e-3
            ),
            None,
        )
        if row is None:
            raise SystemExit(f"no moduli of {self.tyre} at {load:.0f} N: run the part 'moduli' first")
        marked = "amplitude of "
        return {key.removeprefix(marked): float(value) for key, value in row.items() if key.startswith(marked)}


def moduli(resume: bool) -> None:
    """Strain amplitudes of the regions under every load at the typical pressure, and the moduli there."""
    table = Table("moduli", resume)
    for data_set in DATA_SETS.values():
        pressure = data_set.typical[0]
        tyre = Tyre(data_set.study_file, {"mesh.size": COARSE, **data_set.changes}, pressure)
        for load in data_set.loads[pressure]:
            table.add({"tyre": data_set.tyre, "load [N]": load}, partial(moduli_row, tyre, load))


def moduli_row(tyre: Tyre, load: float) -> dict[str, float]:
    """Amplitude and modulus over that of the card, by region."""
    secant = tyre.secant_moduli(load)
    amplitudes = {f"amplitude of {region}": value for region, value in secant.amplitudes.items()}
    return {**amplitudes, **{f"modulus of {region}": value for region, value in secant.factors.items()}}


STEPS = (2000.0, 3000.0, 4000.0, 5000.0, 6000.0)
RADIUS_LOADS = (1800.0, 3560.0, 5000.0)
PRINT_LOADS = tuple(n * LBF for n in (500, 800, 1000, 1200, 1400))
DATA_SETS = {
    "passenger": DataSet(
        "passenger", "205/60R15", PASSENGER, {}, {220e3: STEPS, 200e3: (4000.0,), 240e3: (4000.0,)}, (220e3, 4000.0)
    ),
    "radius": DataSet(
        "radius", "255/40R17 RE-71R", SPORTS, WORN,
        {p * PSI: RADIUS_LOADS for p in (24, 27, 30, 33)}, (27 * PSI, 3560.0),
    ),
    "prints": DataSet(
        "prints", "255/40ZR17 ECF", SPORTS, {}, {p * PSI: PRINT_LOADS for p in (26, 28, 30)}, (28 * PSI, 1000 * LBF),
    ),
}  # fmt: skip


def presses(data_set: DataSet, resume: bool) -> None:
    """Both motions at every pressure and load of a data set."""
    table = Table(data_set.table, resume)
    for motion in MOTIONS:
        for pressure, loads in data_set.loads.items():
            for load in loads:
                keys = {"motion": motion, "pressure [kPa]": pressure / 1e3, "load [N]": load}
                table.add(keys, partial(data_set.at(pressure, load).pressed, motion, load))


def pressure_maps(resume: bool) -> None:
    """Contact pressure of the ECF, one quarter of the footprint, at three of its loads."""
    table = Table("pressure", resume)
    prints = DATA_SETS["prints"]
    for pressure, loads in prints.loads.items():
        for load in loads[::2]:
            keys = text_of({"inflation [kPa]": pressure / 1e3, "load [lbf]": load / LBF})
            if any(keys.items() <= row.items() for row in table.rows):
                continue
            footprint = prints.at(pressure, load).footprint(MOTIONS[0], load)
            table.rows += [{**keys, **text_of(point)} for point in pressure_quarter(footprint)]
            table.write()
            print(*keys.values(), "map", flush=True)


def scaled(study: Any, where: str, factor: float) -> dict[str, Any]:
    """Changes of a study that scale one uncertain number."""
    kind, _, names = where.partition(":")
    if where.startswith("section."):
        name = where.removeprefix("section.")
        return {f"section.parameters.{name}": f"{drawn_of(study.data['section']).rules[name].value * factor:.9g} m"}
    changes = {}
    for region in names.split(","):
        card = study.materials[region]
        if kind == "rubber":
            changes[f"materials.{region}.elasticity.shear_modulus"] = f"{card.elasticity.shear_modulus * factor:.9g} Pa"
        else:
            changes[f"materials.{region}.cords.modulus"] = f"{card.cords.modulus * factor:.9g} Pa"
    return changes


def numerics(resume: bool) -> None:
    """The typical row of two data sets with a finer mesh, and with more harmonics."""
    table = Table("numerics", resume)
    for data_set in (DATA_SETS["passenger"], DATA_SETS["prints"]):
        pressure, load = data_set.typical
        nominal = data_set.at(pressure, load)
        variants = {
            "elements of 16 mm": nominal,
            "elements of 10 mm": data_set.changed(pressure, load, {"mesh.size": FINE}),
            "{harmonics} harmonics, {contact} of the contact (linear: {linear_harmonics})".format(**MORE): replace(
                nominal, **MORE
            ),
        }
        for motion in MOTIONS:
            for name, tyre in variants.items():
                keys = {"tyre": data_set.tyre, "motion": motion, "number": name}
                table.add(keys, partial(tyre.pressed, motion, load))


def sensitivities(resume: bool) -> None:
    """The same rows in large motion with each uncertain number one standard deviation higher, on a coarse mesh."""
    table = Table("sensitivities", resume)
    for data_set in (DATA_SETS["passenger"], DATA_SETS["prints"]):
        load = data_set.typical[1]

        def coarse(changes: Mapping[str, Any], data_set: DataSet = data_set) -> Tyre:
            return data_set.changed(*data_set.typical, {"mesh.size": COARSE, **changes})

        nominal = coarse({})
        for number, (where, deviation) in {"nominal": ("", 0.0), **UNCERTAIN}.items():
            keys = {"tyre": data_set.tyre, "motion": "large", "number": number, "standard deviation": deviation}
            tyre = coarse(scaled(nominal.cards_study, where, 1 + deviation)) if where else nominal
            table.add(keys, partial(tyre.pressed, "large", load))
        for part, regions in LOSSES.items():
            keys = {
                "tyre": data_set.tyre,
                "motion": "large",
                "number": f"loss tangent of {part}",
                "standard deviation": LOSS_TANGENT,
            }
            table.add(keys, partial(with_more_loss, nominal, "large", load, regions))


def with_more_loss(tyre: Tyre, motion: str, load: float, regions: tuple[str, ...]) -> dict[str, float]:
    """Results with the loss tangent of some regions one standard deviation higher."""
    footprint = tyre.footprint(motion, load)
    results = tyre.pressed(motion, load)
    for temperature in TEMPERATURES:
        by_region = tyre.loss(footprint, temperature).by_region
        share = sum(by_region[region] for region in regions) / sum(by_region.values())
        results[f"rolling resistance at {temperature:.0f} degC"] *= 1 + LOSS_TANGENT * share
    return results


def aircraft(resume: bool) -> None:
    """395 bias aircraft tyres: TR R-64's load law at rated load and pressure, and at the bottoming load."""
    table = Table("aircraft", False)
    table.rows = [text_of(row) for row in aircraft_rows()]
    table.write()


def aircraft_rows() -> Iterator[dict[str, Any]]:
    """Rows of the data book with the load law."""
    for row in rows_of(DATA_BOOK):
        number = {
            key.split(" [")[0]: float(value) for key, value in row.items() if "[" in key and value and value.strip()
        }
        diameter = (number["outside_diameter_min"] + number["outside_diameter_max"]) / 2 * INCH
        width = (number["section_width_min"] + number["section_width_max"]) / 2 * INCH
        rating = Rating(width, diameter, number["rated_pressure"] * PSI)
        law = TrR64()
        deflection = law.deflection(number["rated_load"] * LBF, rating.pressure, rating)
        catalogue = diameter / 2 - number["static_loaded_radius_at_rated_load"] * INCH
        bottom, at_bottom = number.get("bottoming_load"), number.get("loaded_radius_at_bottoming")
        computed = catalogued = float("nan")
        if bottom and at_bottom:
            catalogued = bottom
            computed = law.load(diameter / 2 - at_bottom * INCH, rating.pressure, rating) / LBF
        yield {
            "size": row["size"].strip(),
            "ply rating": row["ply_rating"].strip(),
            "catalogue deflection [mm]": catalogue * 1e3,
            "computed deflection [mm]": deflection * 1e3,
            "computed over catalogue": deflection / catalogue,
            "bottoming load of the catalogue [lbf]": catalogued,
            "load at the bottoming radius [lbf]": computed,
        }


@dataclass(frozen=True)
class Rating:
    """Width and diameter, m, and rated pressure, Pa, as a load law reads them."""

    width: float
    diameter: float
    pressure: float


def quick_row(name: str) -> dict[str, tuple[float, float]]:
    """The typical row of a data set on a coarse mesh: quantity -> computed now, and stored."""
    data_set = DATA_SETS[name]
    pressure, load = data_set.typical
    now = data_set.changed(pressure, load, {"mesh.size": COARSE}).pressed(MOTIONS[0], load)
    stored = next(
        row
        for row in rows_of(TABLES / f"measured-{data_set.table}.csv")
        if row["motion"] == MOTIONS[0]
        and abs(float(row["pressure [kPa]"]) / pressure * 1e3 - 1) < 1e-3
        and abs(float(row["load [N]"]) / load - 1) < 1e-2
    )
    return {quantity: (value, float(stored[quantity])) for quantity, value in now.items()}


def quick() -> None:
    """Print one coarse row of each data set beside the stored one."""
    for name, data_set in DATA_SETS.items():
        pressure, load = data_set.typical
        case = f"{data_set.tyre}, {pressure / 1e3:.0f} kPa, {load:.0f} N, {MOTIONS[0]} motion"
        print(f"{case}: mesh of {COARSE}")
        for quantity, (now, stored) in quick_row(name).items():
            print(f"  {quantity:30s} {now:10.5g}   stored, elements of 16 mm: {stored:10.5g}")
    ratios = sorted(row["computed over catalogue"] for row in aircraft_rows())
    print(f"{len(ratios)} aircraft tyres: computed over catalogue deflection, median {ratios[len(ratios) // 2]:.3f}")


PARTS: dict[str, Callable[[bool], None]] = {
    "moduli": moduli,
    **{name: partial(presses, data_set) for name, data_set in DATA_SETS.items()},
    "pressure": pressure_maps,
    "numerics": numerics,
    "sensitivities": sensitivities,
    "aircraft": aircraft,
}


def main() -> None:
    """Run the parts that the command names."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("parts", nargs="*", metavar="PART", help=", ".join(PARTS))
    parser.add_argument("--resume", action="store_true", help="keep the rows that are in the tables")
    parser.add_argument("--quick", action="store_true", help="one coarse row of each data set, printed only")
    options = parser.parse_args()
    for name in options.parts:
        if name not in PARTS:
            parser.error(f"no part '{name}'; allowed: {', '.join(PARTS)}")
    if options.quick:
        quick()
        return
    for name in options.parts or PARTS:
        PARTS[name](options.resume)
    print(f"{time.process_time():.0f} s of processor time")


if __name__ == "__main__":
    main()
