"""Waves of rings, growth by spin, beam on an elastic bed, Hertz, and identities of the rolling tyre, with deviations.

    python benchmarks/rolling_verified.py        # writes docs/evidence/tables/rolling-verified.csv, half a minute

Carter, brush, string and power balance stand in rolling-closed-forms.csv (`benchmarks/rolling.py`), the energy of
cracks in life-closed-forms.csv (`benchmarks/life_closed_forms.py`).
"""

from __future__ import annotations

import csv
import math
import os
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
import skfem

from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.example_tyre import PlainTyre
from tyrefem.mechanics.footprint.road import Road
from tyrefem.mechanics.rolling.example_bodies import CYLINDER_RADIUS, beam, cylinder
from tyrefem.mechanics.rolling.example_rings import ElasticRing
from tyrefem.mechanics.rolling.friction import RollingContact
from tyrefem.mechanics.rolling.rolling_motion import RollingMotion
from tyrefem.mechanics.rolling.steady_rolling import RollingLoads, SteadyRolling
from tyrefem.mechanics.solid.body import Body
from tyrefem.mechanics.solid.centrifugal import Centrifugal
from tyrefem.mechanics.solid.compounds import neo_hookean
from tyrefem.mechanics.solid.newton import equilibrium, spun_equilibrium
from tyrefem.mechanics.solid.parts import RegionMaterial

TABLE = Path(__file__).resolve().parents[1] / "docs" / "evidence" / "tables" / "rolling-verified.csv"
#: Case, closed form, computed, exact.
Row = tuple[str, str, float, float]
SHEAR, DENSITY = 1e8, 1200.0


def standing_waves() -> Iterator[Row]:
    """Critical speeds of rings: bending, string, elastic bed."""
    for n in (2, 3, 4):
        ring = ElasticRing(0.02)
        yield f"free ring, {n} waves, rad/s", "n^2 EI/(rho A R^4)", ring.slowest(n), ring.critical(n)
    for n in (2, 3, 6):
        ring = ElasticRing(0.002)
        ring = replace(ring, tension=800.0 * ring.bending * n**2)
        yield f"string, {n} waves, rad/s", "sqrt(N/(rho A))/R, bending 0.1 % of N", ring.slowest(n), ring.critical(n)
    ring = ElasticRing(0.01, tension=20.0, bed=500.0)
    formula = "(EI n^2/R^2 + N)(n^2-1)^2 + k n^2 R^2"
    for n in range(2, 11):
        yield f"ring under tension on a bed, {n} waves, rad/s", formula, ring.slowest(n), ring.critical(n)
    least = (min(speed(n) for n in range(2, 11)) for speed in (ring.slowest, ring.critical))
    yield "the same, critical speed, rad/s", "least over n", *least


def rotating_waves() -> Iterator[Row]:
    """Splitting of a rotating ring's waves."""
    spin, ring = 3.0, ElasticRing(0.02)
    ring = replace(ring, tension=ring.line_density * (spin * ring.radius) ** 2)
    for n in (2, 3):
        computed, exact = ring.splitting(n, spin), ring.rotating(n, spin)
        for name, ours, theirs in zip(("backward", "forward"), computed, exact, strict=True):
            yield f"rotating ring, {n} waves, {name}, rad/s", "Bryan 1890", ours, theirs
        yield f"rotating ring, {n} waves, splitting, rad/s", "4 n W/(n^2 + 1)", sum(computed), sum(exact)


def growth() -> Iterator[Row]:
    """A thin ring that spins, in small and in large motion."""
    radius, h = 1.0, 0.002
    mesh = skfem.MeshQuad.init_tensor(np.linspace(radius - h / 2, radius + h / 2, 3), np.linspace(0.0, h, 2))
    mesh = mesh.with_boundaries({
        "contained_air": lambda x: x[0] < radius - h / 2 + 1e-9, "symmetry": lambda x: x[1] < 1e-9,
    }).with_subdomains({"rubber": np.arange(mesh.t.shape[1])})  # fmt: skip
    body = Body(mesh, {"rubber": RegionMaterial(neo_hookean(SHEAR))}, {"symmetry": "z"})
    young = 9 * body.bulk[0] * SHEAR / (3 * body.bulk[0] + SHEAR)
    for spin in (2.0, 150.0):
        density = np.full(body.rings.weights.shape, DENSITY)
        spinning = replace(body, centrifugal=Centrifugal(body.rings, density, spin))
        strain = float(spun_equilibrium(spinning, equilibrium(body, 0.0)).displacement[0].mean()) / radius
        load = DENSITY * (spin * radius) ** 2
        if spin < 10:
            yield "growth of a spinning ring", "rho W^2 R^2/E", strain, load / young
        else:
            stretch = 1 + strain
            stress = SHEAR * (stretch**2 - 1 / stretch)
            yield "the same at 11 % stretch, stress, Pa", "rho (W R)^2 l^2", stress, load * stretch**2


def contacts() -> Iterator[Row]:
    """Hertz, and a beam on an elastic bed."""
    x, load, contact = cylinder(401, 0.0, 0.3)
    pressure = contact.solve(values=[1 / CYLINDER_RADIUS]).forces[:, 0] / (x[1] - x[0])
    for place in (0.0, 0.5, 0.8):
        k = int(np.abs(x - place).argmin())
        yield f"Hertz, pressure at {place:g} a, Pa", "2 P/(pi a) sqrt(1 - x^2/a^2)", float(pressure[k]), \
            2 * load / np.pi * math.sqrt(1 - x[k] ** 2)  # fmt: skip
    for count in (301, 1201):
        bending, bed, angle = 0.05, 3.0, 1e-3
        step, length = 3.0 / count, (4 * bending / bed) ** 0.25
        x = (np.arange(count) - (count - 1) / 2) * step
        slips = np.zeros((count, 2))
        slips[:, 1] = angle * step
        gaps = np.where(np.abs(x) < 1, -1.0, 1.0)
        contact = RollingContact(beam(count, step, bending, bed, 1e-3), gaps, slips, np.full(count, 1e9))
        side = -contact.solve().forces[:, 2]
        name = f"beam on an elastic bed, {int((np.abs(x) < 1).sum())} points in contact"
        yield f"{name}, cornering stiffness", "2 c (a + 1/b)^2", float(side.sum()) / angle, 2 * bed * (1 + length) ** 2
        yield f"{name}, aligning stiffness", "c (2 a^3/3 + 2 a^2/b + 2 a/b^2 + 1/b^3)", \
            -float((x * side).sum()) / angle, bed * (2 / 3 + 2 * length + 2 * length**2 + length**3)  # fmt: skip


def identities() -> Iterator[Row]:
    """Frictionless rolling is the footprint; a mirrored half section is the full one."""
    for drum in (math.inf, 1.7):
        road = "flat" if math.isinf(drum) else f"drum of {drum:g} m"
        pressing = Pressing(PlainTyre().state(along=12), Road(drum))
        footprint = pressing.at_deflection(0.02, 54)
        tyre = SteadyRolling(pressing, friction=0.0)
        rolled = tyre.roll(RollingMotion(0.05), RollingLoads(deflection=0.02, travel=0.31), 54)
        yield f"no friction, {road}, load, N", "frictionless footprint", float(rolled.force[2]), footprint.load
        yield f"no friction, {road}, largest pressure, Pa", "frictionless footprint", \
            float(rolled.pressure.max()), float(footprint.pressure.max())  # fmt: skip
        sections = []
        for half in (True, False):
            pressing = Pressing(PlainTyre(half=half).state(along=8), Road(drum))
            tyre = SteadyRolling(pressing, math.radians(2.0), 0.8)
            motion = RollingMotion(math.radians(1.5), turn_slip=0.05)
            sections.append(tyre.roll(motion, RollingLoads(load=3000.0, torque=-100.0), 30, guess=(0.02, 0.314)))
        for name, ours, theirs in (
            ("F_x, N", *(float(rolled.force[0]) for rolled in sections)),
            ("F_y, N", *(float(rolled.force[1]) for rolled in sections)),
            ("M_z, N m", *(float(rolled.moment[2]) for rolled in sections)),
        ):
            yield f"mirrored half section, {road}, {name}", "full section", ours, theirs


def main() -> None:
    """Write and print the table."""
    with TABLE.open("w", encoding="utf-8", newline="") as stream:
        table = csv.writer(stream, lineterminator="\n")
        table.writerow(["case", "exact form", "computed", "exact", "deviation [%]"])
        for part in (standing_waves, rotating_waves, growth, contacts, identities):
            for name, formula, computed, exact in part():
                deviation = 100 * (computed / exact - 1)
                words = "below 1e-6" if abs(deviation) < 1e-6 else f"{deviation:+.3f}"
                words = f"{deviation:+.0e}" if words.endswith("0.000") else words
                table.writerow([name, formula, f"{computed:.6g}", f"{exact:.6g}", words])
                print(f"{name:75} {computed:12.6g} {exact:12.6g} {words} %", flush=True)


if __name__ == "__main__":
    main()
