"""Measured tyres against computed ones: nothing is fitted, sections come from their sizes.

    python benchmarks/measured.py [PART ...]

Parts: passenger, radius, prints, sensitivities, aircraft; all by default. Each writes a table measured-PART.csv to
docs/evidence/tables. `python tools/make_measured_page.py` makes docs/measured.md and its figures of the tables.
"""

from __future__ import annotations

import argparse
import csv
import os
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

import tyrefem as tf
from tyrefem.inputs.loading import TrR64
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.footprint import Footprint
from tyrefem.mechanics.footprint.harmonic_balance import Balance
from tyrefem.mechanics.footprint.loss import RevolutionLoss
from tyrefem.mechanics.footprint.pressed_tyre import mechanical_mesh
from tyrefem.mechanics.footprint.strain_harmonics import StrainHarmonics
from tyrefem.mechanics.solid.inflation import Inflation, inflate
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
#: Harmonics on the way and at the end, and tolerance of a balance in large motion.
WAY, LAST, TOLERANCE = 16, 24, 1e-2
#: Harmonics that resolve a contact's length.
FINE = 96
#: Load at which the RE-71R's stiffness is judged, N.
JUDGED = 3560.0
#: Number of a section or a card, and its standard deviation (relative): those of the cards, gauges 10 % by estimate.
UNCERTAIN: dict[str, tuple[str, float]] = {
    "tread gauge": ("section.tread_gauge", 0.05),
    "sidewall gauge": ("section.sidewall_gauge", 0.10),
    "ply gauge": ("section.ply_gauge", 0.10),
    "crown radius": ("section.crown_radius", 0.20),
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


def measured_rows(path: Path) -> list[dict[str, str]]:
    """Rows of a data file; lines that begin with # are its source."""
    lines = [line for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


def write(name: str, rows: Iterable[Mapping[str, Any]]) -> None:
    """A table of docs/evidence/tables; numbers with five digits."""
    table = [{key: f"{v:.5g}" if isinstance(v, float) else v for key, v in row.items()} for row in rows]
    with atomic_path(TABLES / f"measured-{name}.csv") as path, open(path, "w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, table[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows(table)


def inflated(study: Any, pressure: float) -> tuple[Inflation, Pressing]:
    """The tyre under a pressure, Pa, and on a flat road."""
    tyre = inflate(study, pressure, mechanical_mesh(study))
    return tyre, Pressing(tyre.state)


def linear(pressing: Pressing, load: float) -> Footprint:
    """Linear about the inflated tyre."""
    return pressing.at_load(load, 36)


def large(pressing: Pressing, loads: Sequence[float]) -> Iterator[tuple[Footprint, float]]:
    """Footprints in large motion at increasing loads, N, each from the last; and the tangent stiffness, N/m."""
    motion = Balance(pressing, LAST).motion
    end = linear(pressing, loads[-1])
    now, slope = motion.free(WAY, end.deflection), 0.7 * end.load / end.deflection
    step = end.deflection / 3
    for load in loads:
        for _ in range(40):
            if abs(load - now.load) < 0.02 * load:
                break
            ahead = min(max((load - now.load) / slope, -step), step)
            reached = motion.balance(now, now.deflection + ahead, TOLERANCE)
            if reached is None:
                step /= 2
                continue
            if reached.deflection != now.deflection and now.load:
                slope = (reached.load - now.load) / (reached.deflection - now.deflection)
            now = reached
        start = motion.refined(now, LAST)
        exact = motion.balance(start, start.deflection, TOLERANCE, load)
        if exact is None:
            exact = motion.balance(start, start.deflection, TOLERANCE)
        if exact is None:
            print(f"no balance at {load:.0f} N", flush=True)
            continue
        yield motion.footprint(exact), motion.stiffness(exact, 0.02)


def hull_area(footprint: Footprint) -> float:
    """Area of the convex hull of the contact, m2."""
    from scipy.spatial import ConvexHull

    z, half = footprint.grid.tread.places[1], footprint.half_lengths
    axial = footprint.grid.tread.widths[1]
    points = [
        (side * (place + end * width / 2), sign * length)
        for place, width, length in zip(z, axial, half, strict=True)
        if length > 0
        for side in (1, -1)
        for sign in (1, -1)
        for end in (1, -1)
    ]
    return float(ConvexHull(np.array(points)).volume)


def values(footprint: Footprint, stiffness: float, growth: float) -> dict[str, float]:
    """What is compared, in the units of the tables."""
    return {
        "deflection [mm]": footprint.deflection * 1e3,
        "stiffness [N/mm]": stiffness / 1e3,
        "length [mm]": footprint.length * 1e3,
        "width [mm]": footprint.width * 1e3,
        "gross area [cm2]": hull_area(footprint) * 1e4,
        "net area [cm2]": footprint.area * 1e4,
        "loaded radius [mm]": footprint.loaded_radius * 1e3,
        "rolling radius [mm]": footprint.rolling_radius * 1e3,
        "growth [mm]": growth * 1e3,
    }


def coefficient(study: Any, tyre: Inflation, footprint: Footprint, speed: float, temperature: float) -> float:
    """Rolling resistance coefficient, every harmonic at its frequency."""
    laws = {region: study.materials[region].loss_tangent.over_frequency for region in tyre.body.parts}
    return RevolutionLoss(StrainHarmonics(footprint), laws, speed, temperature).coefficient


def mass(study: Any, tyre: Inflation) -> float:
    """Mass of the tyre as drawn, kg: density times volume of each region's elements."""
    elements = tyre.body.rings
    both = 2.0 if study.section.half else 1.0
    total = 0.0
    for region in tyre.body.parts:
        members = elements.mesh.subdomains[region]
        density = study.materials[region].density.law()
        volume = 2 * np.pi * float(elements.weights[members].sum())  # the weights contain the radius
        total += both * volume * (density(20.0) if callable(density) else density)
    return total


def presses(name: str, path: str, changes: Mapping[str, Any], cases: Mapping[float, Sequence[float]]) -> None:
    """Both motions at pressures, Pa, and loads, N."""
    rows: list[dict[str, Any]] = []
    study = tf.study(path, dict(changes))
    for pressure, loads in cases.items():
        tyre, pressing = inflated(study, pressure)
        for motion in ("linear", "large"):
            began = time.perf_counter()
            footprints = (
                large(pressing, loads)
                if motion == "large"
                else ((f := linear(pressing, n), f.stiffness) for n in loads)
            )
            for footprint, stiffness in footprints:
                rows.append(
                    {
                        "motion": motion,
                        "pressure [kPa]": pressure / 1e3,
                        "load [N]": footprint.load,
                        **values(footprint, stiffness, tyre.radius_growth),
                        "rolling resistance at 20 degC": coefficient(study, tyre, footprint, 60 / 3.6, 20.0),
                        "rolling resistance at 50 degC": coefficient(study, tyre, footprint, 60 / 3.6, 50.0),
                    }
                )
                print(
                    name,
                    motion,
                    f"{pressure / 1e3:.0f} kPa {footprint.load:.0f} N {footprint.deflection * 1e3:.2f} mm",
                    f"{time.perf_counter() - began:.0f} s",
                    flush=True,
                )
            write(name, rows)


def passenger() -> None:
    """205/60R15: five loads at 2.2 bar, and 4000 N at two more pressures."""
    loads = [2000.0, 3000.0, 4000.0, 5000.0, 6000.0]
    presses("passenger", PASSENGER, {}, {220e3: loads, 200e3: [4000.0], 240e3: [4000.0]})


def radius() -> None:
    """RE-71R: load against loaded radius at four pressures."""
    loads = [1800.0, JUDGED, 5000.0]
    presses("radius", SPORTS, WORN, {p * PSI: loads for p in (24, 33, 30, 27)})


def prints() -> None:
    """Contact of both tyres, linear with many harmonics: 24 in large motion have steps of 41 mm along the road."""
    rows: list[dict[str, Any]] = []
    loads = {
        "205/60R15": [2000.0, 3000.0, 4000.0, 5000.0, 6000.0],
        "255/40ZR17": [n * LBF for n in (500, 800, 1000, 1200, 1400)],
    }
    cases = [("205/60R15", PASSENGER, 220e3)]
    cases += [("255/40ZR17", SPORTS, psi * PSI) for psi in (28, 26, 30)]
    for label, path, pressure in cases:
        study = tf.study(path)
        tyre, pressing = inflated(study, pressure)
        for load in loads[label][::-1]:
            footprint = pressing.at_load(load, FINE)
            rows.append(
                {
                    "tyre": label,
                    "motion": "linear",
                    "harmonics": FINE,
                    "pressure [kPa]": pressure / 1e3,
                    "load [N]": footprint.load,
                    **values(footprint, footprint.stiffness, tyre.radius_growth),
                    "mass [kg]": mass(study, tyre),
                }
            )
            print(label, f"{pressure / 1e3:.0f} kPa {load:.0f} N {footprint.length * 1e3:.1f} mm", flush=True)
        write("prints", rows)


def changed(study: Any, where: str, factor: float) -> dict[str, Any]:
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


def sensitivities() -> None:
    """Relative change of each result by one standard deviation of each number: differences of linear presses."""
    rows: list[dict[str, Any]] = []
    for label, path, pressure, load in (
        ("205/60R15", PASSENGER, 220e3, 4000.0),
        ("255/40R17", SPORTS, 28 * PSI, 1000 * LBF),
    ):
        study = tf.study(path)

        def results(
            changes: Mapping[str, Any], path: str = path, pressure: float = pressure, load: float = load
        ) -> dict[str, float]:
            varied = tf.study(path, dict(changes))
            tyre, pressing = inflated(varied, pressure)
            footprint = linear(pressing, load)
            return {**values(footprint, footprint.stiffness, tyre.radius_growth), "mass [kg]": mass(varied, tyre)}

        nominal = results({})
        for name, (where, deviation) in UNCERTAIN.items():
            varied = results(changed(study, where, 1 + deviation))
            relative = {key.split(" [")[0]: varied[key] / nominal[key] - 1 for key in nominal if key != "growth [mm]"}
            rows.append({"tyre": label, "number": name, "standard deviation": deviation, **relative})
            print(label, name, {key: f"{value:+.3f}" for key, value in relative.items()}, flush=True)
            write("sensitivities", rows)


def aircraft() -> None:
    """395 bias aircraft tyres: TR R-64's load law at rated load and pressure, and at the bottoming load."""
    rows = []
    for row in measured_rows(DATA_BOOK):
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
        rows.append(
            {
                "size": row["size"].strip(),
                "ply rating": row["ply_rating"].strip(),
                "catalogue deflection [mm]": catalogue * 1e3,
                "computed deflection [mm]": deflection * 1e3,
                "computed over catalogue": deflection / catalogue,
                "bottoming load of the catalogue [lbf]": catalogued,
                "load at the bottoming radius [lbf]": computed,
            }
        )
    write("aircraft", rows)


class Rating:
    """Width and diameter, m, and rated pressure, Pa, as a load law reads them."""

    def __init__(self, width: float, diameter: float, pressure: float) -> None:
        self.width, self.diameter, self.pressure = width, diameter, pressure


PARTS = {
    "passenger": passenger,
    "radius": radius,
    "prints": prints,
    "sensitivities": sensitivities,
    "aircraft": aircraft,
}


def main() -> None:
    """Run the parts that the command names."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("parts", nargs="*", metavar="PART", help=", ".join(PARTS))
    names = parser.parse_args().parts or list(PARTS)
    for name in names:
        if name not in PARTS:
            parser.error(f"no part '{name}'; allowed: {', '.join(PARTS)}")
        PARTS[name]()


if __name__ == "__main__":
    main()
