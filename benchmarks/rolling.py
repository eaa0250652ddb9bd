"""Rolling with friction: closed forms, power balance, and the measured 205/60R15 over its loads.

    python benchmarks/rolling.py [--closed-forms] [--loss] [--measured] [--standing] [--large] [--belt-angle]
        [--resistance] [--pictures] [--quick]

Writes docs/evidence/tables/rolling-closed-forms.csv, rolling-loss.csv, rolling-measured.csv,
rolling-standing.csv, rolling-large.csv, rolling-belt-angle.csv and rolling-resistance-friction.csv. Nothing is fitted.
With --quick, --measured and --large print the row at 4 kN and write nothing.
"""

from __future__ import annotations

import argparse
import csv
import math
import os
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import IO, Any

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

import tyrefem as tf
from tyrefem.mechanics.footprint.compliance import TreadCompliance
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.example_tyre import PlainTyre
from tyrefem.mechanics.footprint.road import Road
from tyrefem.mechanics.rolling.example_bodies import CYLINDER_RADIUS, bristles, cylinder, string
from tyrefem.mechanics.rolling.free_rolling import LossyTyre, rolling_resistance
from tyrefem.mechanics.rolling.friction import RollingContact
from tyrefem.mechanics.rolling.lossy_harmonics import LossyHarmonics
from tyrefem.mechanics.rolling.roll import settled
from tyrefem.mechanics.rolling.rolling_motion import RollingMotion
from tyrefem.mechanics.rolling.slip_curve import slip_stiffness
from tyrefem.mechanics.rolling.standing import DIRECTIONS, StandingTyre
from tyrefem.mechanics.rolling.steady_rolling import RollingLoads, SteadyRolling
from tyrefem.mechanics.rolling.tread_influence import TreadInfluence
from tyrefem.mechanics.rolling.wheel_on_road import wheel_on_road

ROOT = Path(__file__).resolve().parents[1]
TABLES = ROOT / "docs" / "evidence" / "tables"
PICTURES = ROOT / "docs" / "pictures"
STUDY = ROOT / "studies" / "measured-205-60r15" / "study.toml"
MEASURED = STUDY.parent / "summary.csv"
FRICTION = 0.3
#: Load, N, of the quick rows.
TYPICAL = 4000.0
#: Drum diameter, m; camber and slip angle, deg; torque, N m; path curvature, 1/m, of the power balances.
BALANCES = (
    (math.inf, 0, 1, 0, 0), (math.inf, 0, 3, 0, 0), (math.inf, 0, 8, 0, 0), (math.inf, 2, 2, 0, 0),
    (math.inf, -4, 4, 0, 0), (math.inf, 0, 0, 300, 0), (math.inf, 0, 2, -400, 0), (math.inf, 3, 6, 200, 0.02),
    (1.7, 0, 3, 0, 0), (1.7, 2, 4, -300, 0),
)  # fmt: skip
#: Harmonics and pushes, m, of the standing tyre.
HARMONICS, PUSHES = 80, (1e-3, 3e-3, 5e-3)
#: Slip angle, deg, and slip of the balances in large motion.
LARGE = ((1.0, 0.0), (3.0, 0.0), (0.0, -0.02), (0.0, -0.05))
#: Angles of the belts' cords to the circumference, deg, and loads, N, at which they are tried.
BELT_ANGLES, BELT_LOADS = (20, 23, 26), (2000.0, 4000.0, 6000.0)
#: Straight ahead without torque; tan delta of the tyre with loss.
STRAIGHT, TANGENT = (math.inf, 0, 0, 0, 0), 0.15


def measured_rows(quick: bool) -> list[dict[str, str]]:
    """The measured slopes of slip over load, or only those at the typical load."""
    with MEASURED.open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(line for line in stream if not line.startswith("#")))
    return [row for row in rows if not quick or float(row["load [N]"]) == TYPICAL]


def table_of(name: str, quick: bool) -> IO[str]:
    """The file of a table; nothing is kept of a quick run."""
    return (Path(os.devnull) if quick else TABLES / name).open("w", encoding="utf-8", newline="")


def rigid(count: int, slip: float, component: int) -> Any:
    """Rigid slip of a step at all points."""
    slips = np.zeros((count, 2))
    slips[:, component] = slip
    return slips


def carter() -> Iterator[tuple[str, float, float]]:
    """Case, computed, exact: force over mu times load, for the creeps that Carter gives."""
    for share in (0.25, 0.5, 0.75, 0.9, 0.99, 1.0):
        creep = FRICTION / CYLINDER_RADIUS * (1 - math.sqrt(1 - share)) * (1.2 if share == 1.0 else 1.0)
        _, load, contact = cylinder(401, creep, FRICTION)
        forces = contact.solve(values=[1 / CYLINDER_RADIUS])
        yield f"Carter, Q/(mu P) = {share:g}", -float(forces.forces[:, 1].sum()) / (FRICTION * load), share
        if share < 1:
            sticks, touches = (forces.states == 1).sum(), (forces.states > 0).sum()
            yield f"Carter, stick over contact, Q/(mu P) = {share:g}", float(sticks / touches), math.sqrt(1 - share)


def brush() -> Iterator[tuple[str, float, float]]:
    """Side force and moment of bristles."""
    count, normal, tangential = 801, 1e-3, 2e-3
    step = 2.2 / count
    x = (np.arange(count) - (count - 1) / 2) * step
    gaps = (x**2 - 1) / 2
    most = FRICTION * float((np.maximum(-gaps, 0) / normal).sum())
    body = bristles(count, normal, tangential)
    for s in (0.1, 0.3, 0.5, 0.7, 0.9):
        creep = 3 * most * s * tangential * step / 2
        problem = RollingContact(body, gaps, rigid(count, creep * step, 1), np.full(count, FRICTION))
        side = -problem.solve().forces[:, 2]
        yield f"brush, F/(mu Fz), s = {s:g}", float(side.sum()) / most, 3 * s - 3 * s**2 + s**3
        yield f"brush, Mz/(mu Fz a), s = {s:g}", -float((x * side).sum()) / most, s * (1 - s) ** 3


def belt() -> Iterator[tuple[str, float, float]]:
    """Cornering and aligning stiffness of a string on an elastic bed."""
    count, tension, bed, angle = 601, 2.0, 3.0, 1e-3
    step, sigma = 3.0 / count, math.sqrt(tension / bed)
    x = (np.arange(count) - (count - 1) / 2) * step
    body = string(count, step, tension, bed, 1e-3)
    problem = RollingContact(
        body, np.where(np.abs(x) < 1, -1.0, 1.0), rigid(count, angle * step, 1), np.full(count, 1e6)
    )
    side = -problem.solve().forces[:, 2]
    yield "string, cornering stiffness", float(side.sum()) / angle, 2 * bed * (sigma + 1) ** 2
    yield "string, aligning stiffness", -float((x * side).sum()) / angle, 2 * bed * (sigma * (sigma + 1) + 1 / 3)


def balances() -> Iterator[tuple[str, float, float]]:
    """Power of the axle and of friction, W, of the plain tyre."""
    for drum, camber, angle, torque, curvature in BALANCES:
        tyre = SteadyRolling(Pressing(PlainTyre().state(along=8), Road(drum)), math.radians(camber), 1.0)
        motion = RollingMotion(math.radians(angle), curvature, speed=20.0)
        rolled = tyre.roll(motion, RollingLoads(load=3000.0, torque=torque), 120, guess=(0.02, 0.314))
        road = "flat" if math.isinf(drum) else f"drum {drum:g} m"
        name = f"power, W: {road}, camber {camber}, slip angle {angle} deg, torque {torque} N m, path {curvature:g} 1/m"
        yield name, rolled.friction_power, rolled.lost_power


def loss() -> None:
    """Write the power of axle, friction and rubber of the plain tyre with loss, and its free rolling."""
    state = PlainTyre().state(along=8)
    lossy = LossyHarmonics(state, angular_speed=20.0 / 0.31, tangents=lambda _: np.full(len(state.bulk), TANGENT))
    points, free = TreadInfluence(TreadCompliance(lossy)), LossyTyre(state, lossy=lossy)
    with (TABLES / "rolling-loss.csv").open("w", encoding="utf-8", newline="") as stream:
        table = csv.writer(stream, lineterminator="\n")
        table.writerow([
            "drum [m]", "camber [deg]", "slip angle [deg]", "torque [N m]", "path [1/m]", "friction", "harmonics",
            "friction power [W]", "power in the rubber [W]", "axle power [W]", "deviation [%]", "F_x [N]",
        ])  # fmt: skip
        for harmonics in (80, 120, 180, 270):
            resistance = rolling_resistance(free, harmonics, 0.02, load=3000.0)
            print(f"{harmonics} harmonics, free rolling without friction: {resistance.by_offset:.3f} N by offset, "
                  f"{resistance.by_loss:.3f} N by loss")  # fmt: skip
            cases = BALANCES if harmonics == 270 else BALANCES[:1]
            rows = [(*case, 1.0) for case in cases] + [(*STRAIGHT, friction) for friction in (0.0, 0.1, 1.0)]
            for drum, camber, angle, torque, curvature, friction in rows:
                tyre = SteadyRolling(Pressing(state, Road(drum)), math.radians(camber), friction, points)
                motion = RollingMotion(math.radians(angle), curvature, speed=20.0)
                along = {"torque": torque} if friction else {"travel": resistance.rolling_radius}
                rolled = tyre.roll(motion, RollingLoads(load=3000.0, **along), harmonics, guess=(0.02, 0.314))
                words = [f"{value:g}" for value in (drum, camber, angle, torque, curvature, friction, harmonics)]
                powers = (rolled.friction_power, rolled.loss_power, rolled.lost_power)
                words += [
                    *(f"{power:.1f}" for power in powers),
                    f"{100 * rolled.balance:+.2f}",
                    f"{rolled.force[0]:.2f}",
                ]
                table.writerow(words)
                print(*words, flush=True)


def closed_forms() -> None:
    """Write the table of deviations."""
    rows = [row for part in (carter, brush, belt, balances) for row in part()]
    with (TABLES / "rolling-closed-forms.csv").open("w", encoding="utf-8", newline="") as stream:
        table = csv.writer(stream, lineterminator="\n")
        table.writerow(["case", "computed", "exact", "deviation [%]"])
        for name, computed, exact in rows:
            deviation = 100 * (computed / exact - 1)
            table.writerow([name, f"{computed:.6g}", f"{exact:.6g}", f"{deviation:+.2f}"])
            print(f"{name:75} {computed:12.6g} {exact:12.6g} {deviation:+7.2f} %", flush=True)


def measured(quick: bool) -> None:
    """Write cornering stiffness, slip stiffness and trail over load beside the measured ones."""
    rows = measured_rows(quick)
    names = {
        "cornering_stiffness [kN/rad]": "cornering stiffness [kN/rad]",
        "longitudinal_slip_stiffness [kN]": "slip stiffness [kN]",
        "pneumatic_trail [mm]": "trail [mm]",
        "effective_rolling_radius [mm]": "rolling radius [mm]",
    }
    with table_of("rolling-measured.csv", quick) as stream:
        table = csv.writer(stream, lineterminator="\n")
        table.writerow(["load [N]", "friction", "quantity", "measured", "computed", "deviation [%]", "harmonics"])
        for line in rows:
            load = float(line["load [N]"])
            for friction in (1.0, 0.8, 1.2) if load == TYPICAL and not quick else (1.0,):
                wheel = wheel_on_road(tf.study(STUDY), load=load, friction=friction)
                rolled = settled(wheel, RollingMotion(math.radians(1.0)), {"torque": 0.0}, 0.05)
                stiffness = slip_stiffness(wheel, rolled.state.harmonics)
                values = (
                    stiffness.cornering / 1e3,
                    stiffness.slip / 1e3,
                    1e3 * stiffness.trail,
                    1e3 * rolled.rolling_radius,
                )
                for (key, name), value in zip(names.items(), values, strict=True):
                    known = float(line[key])
                    words = [f"{load:g}", f"{friction:g}", name, f"{known:g}", f"{value:.4g}",
                             f"{100 * (value / known - 1):+.1f}", str(rolled.state.harmonics)]  # fmt: skip
                    table.writerow(words)
                    print(*words, flush=True)


def standing() -> None:
    """Write the stiffness of the standing tyre forward and sideways, beside the measured one."""
    with (STUDY.parent / "structure.csv").open(encoding="utf-8") as stream:
        known = {
            row["quantity"]: float(row["value"]) for row in csv.DictReader(line for line in stream if line[0] != "#")
        }
    measured = [known["longitudinal stiffness"], known["lateral stiffness"]]
    with (TABLES / "rolling-standing.csv").open("w", encoding="utf-8", newline="") as stream:
        table = csv.writer(stream, lineterminator="\n")
        table.writerow(["contact", "moduli", *(
            f"{name} [{unit}]" for name in ("forward", "sideways") for unit in ("N/mm", "% of measured, less 100")
        )])  # fmt: skip

        def row(contact: str, moduli: str, *stiffnesses: float) -> None:
            words = [contact, moduli]
            for stiffness, value in zip(stiffnesses, measured, strict=True):
                words += [f"{stiffness / 1e3:.1f}", f"{100 * (stiffness / 1e3 / value - 1):+.1f}"]
            table.writerow(words)
            print(*words, flush=True)

        for motion in ("linear", "large"):
            wheel = wheel_on_road(tf.study(STUDY), load=4000.0, friction=1.0, motion=motion)
            tyre = StandingTyre(wheel.pressed, wheel.free(HARMONICS))
            cycle = {region: law.modulus_amplitude for region, law in tyre.laws.items()}
            for moduli, amplitude in (("of a revolution", cycle), ("at 0.1 % of shear", 1e-3), ("at 1 %", 1e-2)):
                stiffness = tyre.stiffness(amplitude)
                row(motion, moduli, stiffness.longitudinal, stiffness.lateral)
            for push in PUSHES if motion == "linear" else ():
                forward, left = (tyre.pushed(push, direction)[0] for direction in DIRECTIONS)
                row(motion, f"of a push by {1e3 * push:g} mm", forward, left)


def large(quick: bool) -> None:
    """Write slopes and the balance of powers of rolling on the footprint in large motion, over load."""
    rows = measured_rows(quick)
    names = ("cornering_stiffness [kN/rad]", "longitudinal_slip_stiffness [kN]", "pneumatic_trail [mm]",
             "effective_rolling_radius [mm]")  # fmt: skip
    with table_of("rolling-large.csv", quick) as stream:
        table = csv.writer(stream, lineterminator="\n")
        balances = [f"balance at {angle:g} deg, slip {slip:g} [%]" for angle, slip in LARGE]
        table.writerow(
            [
                "load [N]",
                *(word for name in names for word in (name, f"{name.split(' [')[0]}, deviation [%]")),
                *balances,
            ]
        )
        for line in rows:
            wheel = wheel_on_road(tf.study(STUDY), load=float(line["load [N]"]), friction=1.0, motion="large")
            free, stiffness = wheel.free(HARMONICS), slip_stiffness(wheel, HARMONICS)
            values = (stiffness.cornering / 1e3, stiffness.slip / 1e3, 1e3 * stiffness.trail, 1e3 * free.travel)
            words = [line["load [N]"]]
            for name, value in zip(names, values, strict=True):
                words += [f"{value:.4g}", f"{100 * (value / float(line[name]) - 1):+.1f}"]
            for angle, slip in LARGE:
                along = {"slip": slip} if slip else {"torque": 0.0}
                motion = RollingMotion(math.radians(angle), speed=wheel.speed)
                words.append(f"{100 * wheel.roll(motion, along, HARMONICS, free).balance:+.2f}")
            table.writerow(words)
            print(*words, flush=True)


def belt_angle() -> None:
    """Write slopes of slip, trail, deflection and growth by spin over the angle of the belts' cords, linear motion."""
    with (TABLES / "rolling-belt-angle.csv").open("w", encoding="utf-8", newline="") as stream:
        table = csv.writer(stream, lineterminator="\n")
        table.writerow([
            "belt angle [deg]", "load [N]", "cornering stiffness [kN/rad]", "slip stiffness [kN]",
            "trail [mm]", "deflection [mm]", "length [mm]", "growth of radius by spin [mm]",
        ])  # fmt: skip
        for angle in BELT_ANGLES:
            cords = {f"materials.belt-{ply}.cords.angle": f"{angle} deg" for ply in (1, 2)}
            study = tf.study(STUDY).replace({"mesh.size": "10 mm", **cords})
            spinning = study.replace({"mechanics.rolling": True}).press(motion="linear")
            for load in BELT_LOADS:
                wheel = wheel_on_road(study, load=load, friction=1.0)
                slopes, contact = slip_stiffness(wheel, HARMONICS), wheel.pressed.footprint
                words = [str(angle), f"{load:g}", f"{slopes.cornering / 1e3:.1f}", f"{slopes.slip / 1e3:.1f}",
                         f"{1e3 * slopes.trail:.1f}", f"{1e3 * contact.deflection:.1f}", f"{1e3 * contact.length:.0f}",
                         f"{1e3 * spinning.turning.centrifugal_growth:.2f}"]  # fmt: skip
                table.writerow(words)
                print(*words, flush=True)


def resistance() -> None:
    """Write the rolling resistance of the measured tyre without and with friction."""
    study = tf.study(STUDY, {"mechanics.rolling": True})
    with (TABLES / "rolling-resistance-friction.csv").open("w", encoding="utf-8", newline="") as stream:
        table = csv.writer(stream, lineterminator="\n")
        table.writerow(["load [N]", "harmonics", *(
            f"{name} [N]" for name in (
                "free rolling by loss", "rubber without friction", "rubber with friction", "friction", "axle",
            )
        )])  # fmt: skip
        for load in (2000.0, 4000.0, 6000.0):
            wheel = wheel_on_road(study, load=load, friction=1.0)
            alone = wheel.pressed.turning.resistance.by_loss
            for harmonics in (80, 120):
                free = wheel.free(harmonics)
                smooth = replace(wheel.rolling, friction=0.0, influence=wheel.rolling.points)
                loads, guess = RollingLoads(load=load, travel=free.travel), (free.deflection, free.travel)
                slippery = smooth.roll(RollingMotion(speed=wheel.speed), loads, harmonics, guess=guess)
                powers = (slippery.loss_power, free.loss_power, free.friction_power, free.lost_power)
                forces = (alone, *(power / wheel.speed for power in powers))
                words = [f"{load:g}", str(harmonics), *(f"{force:.2f}" for force in forces)]
                table.writerow(words)
                print(*words, flush=True)


def pictures() -> None:
    """Draw the pictures of the pages."""
    from tyrefem.reports.figures.rolling import contact_figure, slip_curve_figure
    from tyrefem.reports.figures.style import png
    from tyrefem.reports.view3d import screenshot

    study = tf.study(STUDY)
    rolled = study.roll(slip_angle=math.radians(2.0), slip=0.01, camber=math.radians(1.0))
    (PICTURES / "rolling-contact.png").write_bytes(png(contact_figure(rolled)))
    with tempfile.TemporaryDirectory() as folder:
        screenshot(rolled.to_vtk(folder), PICTURES / "rolling-tyre.png")
    curve = study.slip_curve(slip_angle=np.radians(np.linspace(-12, 12, 25)).tolist())
    (PICTURES / "rolling-curve.png").write_bytes(png(slip_curve_figure(curve)))


def main() -> None:
    """Run the parts that are named, or the closed forms."""
    parser = argparse.ArgumentParser(description=__doc__)
    parts: dict[str, Callable[[], None]] = {
        "closed-forms": closed_forms,
        "loss": loss,
        "standing": standing,
        "belt-angle": belt_angle,
        "resistance": resistance,
        "pictures": pictures,
    }
    by_load: dict[str, Callable[[bool], None]] = {"measured": measured, "large": large}
    for name in (*parts, *by_load):
        parser.add_argument(f"--{name}", action="store_true")
    parser.add_argument("--quick", action="store_true", help="of --measured and --large: a single load, no table")
    chosen = vars(parser.parse_args())
    parts |= {name: partial(part, chosen["quick"]) for name, part in by_load.items()}
    named = [part for name, part in parts.items() if chosen[name.replace("-", "_")]]
    for part in named or [closed_forms]:
        part()


if __name__ == "__main__":
    main()
