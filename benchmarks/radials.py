"""The tables of docs/evidence/constructions.md: the shipped radials as they run, are pressed and meshed.

    python benchmarks/radials.py [PART ...]

Parts: runs, press, meshes, tread, meshers, motions, estimates; all by default (about 20 minutes of one processor). Each
writes its table below docs/evidence/tables, or its rows of a table that has others too.
"""

from __future__ import annotations

import csv
import json
import resource
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

import tyrefem as tf
from tyrefem.geometry.meshing import build
from tyrefem.inputs.published import of_footprint
from tyrefem.materials.cord_layers import masses
from tyrefem.reports.figures.footprint import pressure_map

TABLES = Path("docs/evidence/tables")
#: Tyre -> its study.
RADIALS = {
    "passenger": "passenger-205-55r16",
    "truck": "truck-295-80r22.5",
    "aircraft": "aircraft-radial",
}
#: Share of the tread in grooves that are not drawn (an estimate), and usual masses, kg, from memory.
VOIDS = {"passenger": 0.05, "truck": 0.03, "aircraft": 0.1}
USUAL = {"passenger": "8 to 10", "truck": "55 to 66", "aircraft": ""}
ROADS = {"passenger": "drum of 2 m", "truck": "drum of 2 m", "aircraft": "flat road"}
#: What stands in a study's source -> the table's words.
SOURCES = {
    "Rhyne": "Rhyne 2005",
    "Pacejka": "Pacejka 2012",
    "Special Report 286": "NRC Special Report 286 (2006), label classes",
    "Wong": "Wong",
    "Tire and Rim": "Tire and Rim Association, design guide 3-24R2",
    "C3 tyres": "classes A to E of C3 tyres, Regulation (EC) 1222/2009",
    "TR R-64": "NASA TR R-64 (bias tyres)",
}
COLD = "rolling_resistance_coefficient"


def write(
    name: str, header: Sequence[str], rows: Sequence[Sequence[object]], keep: Callable[[list[str]], bool]
) -> None:
    """Replace the rows of a table that are not kept."""
    path = TABLES / name
    with path.open(encoding="utf-8", newline="") as file:
        kept = [row for row in list(csv.reader(file))[1:] if keep(row)]
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerows([header, *kept, *rows])


def columns(name: str) -> list[str]:
    """The header of a table as it is."""
    with (TABLES / name).open(encoding="utf-8", newline="") as file:
        return next(csv.reader(file))


def nothing(_: list[str]) -> bool:
    """Keep no row."""
    return False


def hottest_place(study: Any, hottest: dict[str, Any]) -> str:
    """Region and distance from the crown, and from the widest belt's end where that is near."""
    belts = [piece for piece in study.section.pieces if "belt" in piece.region]
    edge = max(belts, key=lambda piece: piece.end)
    beyond = 1e3 * (hottest["s_m"] - edge.end)
    words = f"{hottest['region'].replace('-', ' ')}, {1e3 * hottest['s_m']:.0f} mm from the crown"
    if abs(beyond) > 30:
        return words
    return f"{words}, {abs(beyond):.0f} mm {'beyond' if beyond > 0 else 'within'} the end of {edge.region}"


def runs() -> None:
    """What the three studies give, and their published ranges."""
    rows: list[list[object]] = []
    ranges: list[list[object]] = []
    for tyre, name in RADIALS.items():
        study = tf.study(name)
        began = time.process_time()
        result = study.run()
        seconds = time.process_time() - began
        given = study.replace({"mechanics.strain": "given"}).run()
        readings, summary = result.readings.iloc[-1], result.summary()
        row, given_row = summary["hottest"], given.summary()["hottest"]
        resistance = summary["rolling_resistance"]
        drive = study.card.drive.phases[0]
        rows.append([
            tyre, f"{drive.load.start:.0f} N, {drive.pressure.start / 1e3:.0f} kPa, {ROADS[tyre]}",
            f"{row['temperature_degC']:.1f}", hottest_place(study, row),
            *(f"{readings[sensor]:.0f}" if sensor in readings else "" for sensor in
              ("crown-inner" if tyre == "aircraft" else "crown-liner", "belt-edge",
               "sidewall-inner" if tyre == "aircraft" else "sidewall-middle", "apex")),
            f"{summary['contained_air']['temperature_degC']:.0f}", f"{resistance['coefficient']:.4f}",
            f"{resistance['cold_coefficient']:.4f}", f"{seconds:.0f}",
            f"{given.rolling_resistance.coefficient:.4f}", f"{given_row['temperature_degC']:.0f}",
            f"{1e3 * given_row['s_m']:.0f}",
        ])  # fmt: skip
        for entry in summary["published"]:
            quantity, scale, digits = {
                "vertical_stiffness": ("secant stiffness [N/mm]", 1e-3, 0),
                "footprint_length": ("footprint length [mm]", 1e3, 0),
                "footprint_width": ("footprint width [mm]", 1e3, 0),
                "footprint_area": ("footprint area without grooves [cm2]", 1e4, 0),
                COLD: ("coefficient, warm", 1.0, 4),
            }[entry["quantity"]]
            values = {quantity: entry["value"]}
            if entry["quantity"] == COLD:
                values = {"coefficient, cold": resistance["cold_coefficient"], **values}
            low, high = entry["low"], entry["high"]
            for words, value in values.items():
                ranges.append([
                    f"{tyre}, {ROADS[tyre]}", words, f"{value * scale:.{digits}f}", f"{low * scale:g}",
                    f"{high * scale:g}", next(short for known, short in SOURCES.items() if known in entry["source"]),
                    "yes" if low <= value <= high else "no",
                ])  # fmt: skip
    header = [
        "tyre", "drive", "hottest [degC]", "hottest place", "crown liner [degC]", "belt edge [degC]", "sidewall [degC]",
        "apex [degC]", "contained air [degC]", "coefficient, warm", "coefficient, cold", "processor time [s]",
        "given energies: coefficient (put in)", "given energies: hottest [degC]",
        "given energies: hottest place from the crown [mm]",
    ]  # fmt: skip
    write("radials-run.csv", header, rows, nothing)
    header = ["tyre", "quantity", "computed", "published from", "published to", "source", "inside"]
    write("radials-published.csv", header, ranges, nothing)


def press() -> None:
    """The shipped radials on the road, in large motion and linear: rows of pressed-tyres.csv and radials-linear.csv."""
    names = {"passenger": "205/55R16", "truck": "295/80R22.5", "aircraft": "22x5.5 radial"}
    rows, linear = [], []
    for tyre, name in RADIALS.items():
        study = tf.study(name)
        began = time.process_time()
        pressed = study.press()
        seconds = time.process_time() - began
        values, F = pressed.summary(), pressed.tyre.deformation
        least = float(np.linalg.det(np.moveaxis(F, (0, 1), (-2, -1))).min())
        flange = max((float(f.pressure(pressed.tyre.places).max()) for f in pressed.tyre.body.flanges), default=0.0)
        rows.append([
            names[tyre], f"{values['pressure_Pa'] / 1e3:.0f}", f"{values['load_N']:.0f}",
            "drum 2 m" if np.isfinite(values["drum_diameter_m"]) else "flat", f"{1e3 * values['deflection_m']:.1f}",
            f"{values['secant_stiffness_N_m'] / 1e3:.0f}", f"{values['tangent_stiffness_N_m'] / 1e3:.0f}",
            f"{1e3 * values['footprint_length_m']:.0f}", f"{1e3 * values['footprint_width_m']:.0f}",
            f"{1e4 * values['footprint_area_m2']:.0f}", f"{values['mean_contact_pressure_Pa'] / 1e3:.0f}",
            f"{values['peak_contact_pressure_Pa'] / 1e3:.0f}", f"{values['rolling_resistance_coefficient']:.4f}",
            f"{least:.2f}", ", ".join(map(str, values["unstable_harmonics"])) or "none", f"{flange / 1e6:.2g}",
            values["harmonics"], f"{100 * values['error']:.1f}", f"{seconds:.0f}",
        ])  # fmt: skip
        for motion, shown in (("large", pressed), ("linear", study.press(motion="linear"))):
            quantities = of_footprint(shown.footprint) | {"rolling_resistance_coefficient": shown.loss.coefficient}
            linear.append([
                tyre, motion, f"{quantities['vertical_stiffness'] / 1e3:.0f}",
                f"{1e3 * quantities['footprint_length']:.0f}", f"{1e3 * quantities['footprint_width']:.0f}",
                f"{1e4 * quantities['footprint_area']:.0f}",
                f"{quantities['rolling_resistance_coefficient']:.4f}",
                f"{1e3 * shown.tyre.radius_growth:.2f}", f"{1e3 * shown.tyre.width_growth:.2f}",
            ])  # fmt: skip
    write("pressed-tyres.csv", columns("pressed-tyres.csv"), rows, lambda row: row[0] not in names.values())
    header = [
        "tyre", "motion", "secant stiffness [N/mm]", "footprint length [mm]", "footprint width [mm]",
        "area without grooves [cm2]", "coefficient at 25 degC", "growth of radius [mm]", "growth of width [mm]",
    ]  # fmt: skip
    (TABLES / "radials-linear.csv").touch()
    write("radials-linear.csv", header, linear, nothing)


def meshes() -> None:
    """Quality, areas and masses."""
    rows = []
    for tyre, name in RADIALS.items():
        study = tf.study(name)
        section, size = study.section, study.card.mesh.size
        mapped, triangles = (build(section, mesher=mesher, size=size, through=1) for mesher in ("mapped", "gmsh"))
        error = max(abs(mapped.area(region) / section.area(region) - 1) for region in section.regions)
        by_region = masses(section, study.materials)
        whole = sum(by_region.values())
        rows.append([
            tyre, f"{1e3 * size:g}", mapped.n_elements, f"{mapped.quality['scaled_jacobian']:.2f}",
            f"{mapped.quality['edge_ratio']:.1f}", triangles.n_elements, f"{triangles.quality['scaled_jacobian']:.2f}",
            f"{triangles.quality['edge_ratio']:.1f}", f"{100 * error:.2f}", f"{whole:.1f}",
            f"{whole - VOIDS[tyre] * by_region['tread']:.1f}", f"{100 * VOIDS[tyre]:.0f}", USUAL[tyre],
        ])  # fmt: skip
    write("radials-meshes.csv", columns("radials-meshes.csv"), rows, nothing)


def tread() -> None:
    """Grooves and the radius of the tread's surface on the truck, elements of 28 mm, linear motion."""
    rows = [_truck(width, radius) for width in ("0 mm", None) for radius in ("700 mm", None)]
    header = [
        "tread", "radius of the surface [mm]", "hottest place", "hottest [degC]", "base of the middle rib [degC]",
        "edge of belt-2 [degC]", "innermost belt at the crown [degC]", "coefficient",
        "pressure at z = 0 mm [MPa]", "pressure at z = 100 mm [MPa]",
    ]  # fmt: skip
    write("truck-tread.csv", header, rows, nothing)


def _truck(width: str | None, radius: str | None) -> list[object]:
    size = {"size": "295/80R22.5 152/148M", "parameters": {"tread_radius": radius} if radius else {}}
    sensors = {
        "rib": {"s": "0 mm", "depth": "17.6 mm"},
        "edge": {"s": "98 mm", "depth": "9 mm"},
        "belt": {"s": "0 mm", "depth": "5.4 mm"},
    }
    changes: dict[str, Any] = {"section": size, "sensors": sensors, "mesh.size": "28 mm", "mechanics.motion": "linear"}
    changes |= {"made_for": None, "output.every": "300 s"}
    study = tf.study(RADIALS["truck"]).replace(changes)
    if width is not None:
        study = study.replace({"section.grooves": {"width": width}})
    result = study.run()
    row, readings = result.summary()["hottest"], result.readings.iloc[-1]
    x, z, pressure = pressure_map(result.tyre.schedule.cycles[0][0].footprint)
    middle = pressure[:, int(np.abs(x).argmin())]
    pressures = [f"{np.interp(at, z, middle) / 1e6:.1f}" for at in (0.0, 0.1)]
    return [
        "smooth" if width else "grooves" + ("" if radius else " (shipped)"), radius.split()[0] if radius else "1032.5",
        f"{row['region'].replace('-', ' ')}, {1e3 * row['s_m']:.0f} mm from the crown",
        f"{row['temperature_degC']:.1f}", *(f"{readings[sensor]:.0f}" for sensor in sensors),
        f"{result.rolling_resistance.coefficient:.4f}", *pressures,
    ]  # fmt: skip


def meshers() -> None:
    """The passenger in linear motion on the mapped mesh and on gmsh's quadrilaterals."""
    gmsh = {"mesh.mesher": "gmsh", "mesh.cell": "quad", "mesh.size": "8 mm"}
    rows = []
    for words, changes in (("mapped", {}), ("gmsh, 8 mm", gmsh)):
        began = time.process_time()
        pressed = tf.study(RADIALS["passenger"], changes).press(motion="linear")
        values, mesh = pressed.summary(), pressed.summary()["mesh"]
        rows.append([
            words, mesh["elements"], mesh["nodes_of_nine_node_elements"], f"{1e3 * values['radius_growth_m']:.2f}",
            f"{1e3 * values['width_growth_m']:.2f}", f"{values['bead_tension_N'] / 1e3:.2f}",
            f"{1e3 * values['deflection_m']:.2f}", f"{values['secant_stiffness_N_m'] / 1e3:.1f}",
            f"{1e3 * values['footprint_length_m']:.0f}", f"{1e3 * values['footprint_width_m']:.0f}",
            f"{1e4 * values['footprint_area_m2']:.1f}", f"{values['rolling_resistance_coefficient']:.5f}",
            f"{time.process_time() - began:.0f}",
        ])  # fmt: skip
    write("passenger-meshers.csv", columns("passenger-meshers.csv"), rows, nothing)


def motions() -> None:
    """Linear and large motion side by side: 8PR on two meshes, passenger."""
    cases = [("8PR, 83 psi, 2700 lbf", "nasa-22x5.5-8pr", {}, motion, 5) for motion in ("linear", "large")]
    cases.append(("8PR, 83 psi, 2700 lbf", "nasa-22x5.5-8pr", {}, "large", 3))
    strong = {"drive.load": "4350 lbf", "drive.pressure": "156 psi"}
    cases.append(("8PR, 156 psi, 4350 lbf", "nasa-22x5.5-8pr", strong, "large", 5))
    cases.extend(("passenger", RADIALS["passenger"], {}, motion, 0) for motion in ("linear", "large"))
    book = {"83": ("30.0", "400", "441"), "156": ("27.6", "", "")}
    rows = []
    for words, name, changes, motion, size in cases:
        began = time.process_time()
        pressed = tf.study(name, {**changes, **({"mesh.size": f"{size} mm"} if size else {})}).press(motion=motion)
        values = pressed.summary()
        known = next((entry for pressure, entry in book.items() if f" {pressure} psi" in words), ("", "", ""))
        rows.append([
            words, motion, f"{1e3 * values['mesh']['size_m']:g}", f"{1e3 * values['deflection_m']:.1f}",
            f"{values['secant_stiffness_N_m'] / 1e3:.0f}", f"{values['tangent_stiffness_N_m'] / 1e3:.0f}",
            f"{1e3 * values['footprint_length_m']:.0f}", f"{1e3 * values['footprint_width_m']:.0f}",
            f"{1e4 * values['footprint_area_m2']:.0f}", f"{values['mean_contact_pressure_Pa'] / 1e3:.0f}",
            f"{values['rolling_resistance_coefficient']:.4f}", f"{1e3 * values['rolling_radius_m']:.1f}",
            values["harmonics"], f"{100 * values['error']:.1f}", f"{time.process_time() - began:.0f}", *known,
        ])  # fmt: skip
    write("linear-and-large-motion.csv", columns("linear-and-large-motion.csv"), rows, nothing)


def estimates() -> None:
    """Estimates of shipped studies beside what they take, each in a process of its own."""
    rows = []
    for name in [
        row.split(",")[0].split(" ")[0] for row in (TABLES / "work-estimates.csv").read_text().split("\n")[1:]
    ]:
        if name:
            command = [sys.executable, __file__, "measure", name]
            rows.append(json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout))
    write("work-estimates.csv", columns("work-estimates.csv"), rows, nothing)


def peak_memory() -> float:
    """Largest memory of this process, MiB (Linux: resource's number is that of the parent process if it was larger)."""
    status = Path("/proc/self/status")
    if not status.is_file():
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    line = next(line for line in status.read_text(encoding="utf-8").splitlines() if line.startswith("VmHWM:"))
    return int(line.split()[1]) / 1024


def measure(name: str) -> None:
    """One row of the estimates, as JSON."""
    import pandas  # noqa: F401 - the memory of libraries is not the run's
    import scipy.sparse.linalg  # noqa: F401

    from tyrefem.conduction.operators import operators_of
    from tyrefem.simulation.estimate import RunEstimate

    study = tf.study(name)
    words = f"{name} (a case)" if study.is_campaign else name
    if study.is_campaign:
        campaign = study.campaign()
        study = campaign.case_study(campaign.cases[0])
    estimate, total = RunEstimate.of(study), RunEstimate.of(study).total
    unknowns = operators_of(study.mesh().mesh, study.card.mesh.element).size
    peak, began = peak_memory(), time.process_time()
    study.run()
    memory = peak_memory() - peak
    print(json.dumps([
        words, f"{estimate.unknowns:.0f}", unknowns, f"{total.memory / 2**20:.0f}", f"{memory:.0f}",
        f"{total.time:.2g}", f"{time.process_time() - began:.2g}",
    ]))  # fmt: skip


PARTS = {part.__name__: part for part in (runs, press, meshes, tread, meshers, motions, estimates)}


def main() -> None:
    """Make the tables."""
    if sys.argv[1:2] == ["measure"]:
        measure(sys.argv[2])
        return
    for name in sys.argv[1:] or PARTS:
        if name not in PARTS:
            raise SystemExit(f"unknown part '{name}'; allowed: {', '.join(PARTS)}")
        PARTS[name]()


if __name__ == "__main__":
    main()
