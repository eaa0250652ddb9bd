"""Deviations of crack energy, critical plane and life from closed forms (run from the root; seconds).

Writes docs/evidence/tables/life-closed-forms.csv, the table of docs/method/life.md.
"""

from __future__ import annotations

import csv
import os
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import quad

import tyrefem as tf
from tyrefem.fatigue.cracking_energy import CrackingEnergy, products, six
from tyrefem.fatigue.growth import cycles_to_failure
from tyrefem.fatigue.planes import critical_planes, half_sphere
from tyrefem.materials.fatigue import Fatigue

Array = NDArray[np.float64]
TABLE = Path("docs/evidence/tables/life-closed-forms.csv")
G, STEPS = 1.5e6, 400
CARD = {"tearing_energy": "10 kJ/m**2", "growth_rate": "10 um", "source": "closed forms"}
COARSE = {"mesh.size": "14 mm", "mechanics.strain": "fem", "mechanics.motion": "linear"}


def path(deformations: Array, pressures: Array) -> CrackingEnergy:
    """From rest through deformation gradients (steps, 3, 3) of a neo-Hookean body, s = G (b - p), and back."""
    b = deformations @ deformations.swapaxes(1, 2)
    values, vectors = np.linalg.eigh(b)
    strain = (vectors * np.log(values)[:, None] / 2) @ vectors.swapaxes(1, 2)
    stress = G * (b - pressures[:, None, None] * np.eye(3))
    return CrackingEnergy(*(six(np.concatenate([part, part[-2::-1]]))[None] for part in (stress, strain)))


def stretched(*stretches: Array) -> Array:
    """(steps, 3, 3) of principal stretches."""
    return np.asarray(np.stack(stretches, axis=1)[:, :, None] * np.eye(3))


def energy(deformation: Array) -> float:
    """W = G/2 (I1 - 3)."""
    return float(G / 2 * ((deformation**2).sum() - 3))


def searched(energies: CrackingEnergy) -> tuple[Array, float]:
    """Normal and peak on the plane of the largest peak."""
    normals, _ = critical_planes(lambda n: energies.extremes(products(n))[0], 1)
    return normals[0], float(energies.on(products(normals)[:, None]).peak[0, 0])


def plane_rows() -> list[tuple[str, str, float]]:
    """Uniaxial pull and compression, equibiaxial stretch, simple shear."""
    rows = []
    for name, end, share, wanted in (("pull to 1.3", 1.3, 1.0, 0.0), ("compression to 0.8", 0.8, 0.375, 45.0)):
        s = np.linspace(1, end, STEPS)
        f = stretched(s, s**-0.5, s**-0.5)
        normal, peak = searched(path(f, 1 / s))
        angle = np.degrees(np.arccos(min(abs(normal[0]), 1)))
        rows.append((f"uniaxial {name}: angle of the normal from the axis", f"{wanted:g} deg", angle - wanted))
        rows.append((f"uniaxial {name}: W_c/W", f"{share:g}", peak / energy(f[-1]) - share))
    s = np.linspace(1, 1.4, STEPS)
    f = stretched(s, s, s**-2)
    normal, peak = searched(path(f, s**-4))
    angle = np.degrees(np.arcsin(abs(normal[2])))
    rows.append(("equibiaxial to 1.4: angle of the plane from the thickness", "0 deg", angle))
    rows.append(("equibiaxial to 1.4: W_c/W", "0.5", peak / energy(f[-1]) - 0.5))
    for amount in (0.02, 0.2):
        f = np.tile(np.eye(3), (STEPS, 1, 1))
        f[:, 0, 1] = np.linspace(0, amount, STEPS)
        normal, peak = searched(path(f, np.ones(STEPS)))
        angle = np.degrees(np.arctan2(abs(normal[1]), abs(normal[0])))
        rows.append((f"simple shear of {amount:g}: angle of the normal from the shear", "45 deg", angle - 45))
        rows.append((f"simple shear of {amount:g}: W_c/W", "0.5", peak / energy(f[-1]) - 0.5))
    return rows


def life_rows() -> list[tuple[str, str, float]]:
    """The life's integral, temperature, Miner's sum, rotated axes."""
    worst = 0.0
    for exponent in (0.5, 1.0, 2.0, 4.3):
        card = Fatigue.check({**CARD, "exponent": exponent})
        a = 2 * 2.95 * 8e4 / 1e4
        integral, _ = quad(lambda c, a=a, f=exponent: 1 / (10e-6 * (a * c) ** f), card.flaw, card.crack, epsrel=1e-12)
        worst = max(worst, abs(float(cycles_to_failure(card, 8e4)) / integral - 1))
    rows = [("life from c_0 to c_1, exponents 0.5 to 4.3", "quadrature", worst)]
    study = tf.study("nasa-22x5.5-8pr", COARSE)
    warm, hot = (study.life(temperature=degrees) for degrees in (60.0, 110.0))
    members = warm.members("carcass")
    factor = np.exp(-50 * study.materials["carcass"].fatigue.temperature_rate)
    deviation = np.abs(hot.km[members] / warm.km[members] / factor - 1).max()
    rows.append(("carcass of the 8PR at 110 over 60 degC", "exp(-50 b)", float(deviation)))
    drive = dict(study.data["drive"])
    phases = [{"name": name, "duration": "100 s"} for name in ("a", "b", "c")]
    three = study.replace({"drive": {**drive, "phases": phases}}).life(temperature=60.0)
    deviation = np.abs(three.km[members] / warm.km[members] - 1).max()
    rows.append(("three phases of one load", "Miner's sum: one phase", float(deviation)))
    generator = np.random.default_rng(1)
    turned = np.linalg.qr(generator.normal(size=(3, 3)))[0]
    stress, strain = generator.normal(size=(21, 3, 3)), 0.05 * generator.normal(size=(21, 3, 3))
    stress, strain = (part + part.swapaxes(1, 2) for part in (stress, strain))
    stress[-1], strain[-1] = stress[0], strain[0]
    normals = half_sphere(60)
    here = CrackingEnergy(six(stress)[None], six(strain)[None]).on(products(normals)).peak
    there = [six(turned @ part @ turned.T)[None] for part in (stress, strain)]
    rotated = CrackingEnergy(there[0], there[1]).on(products(normals @ turned.T)).peak
    rows.append(("energy of any cycle in rotated axes", "the same", float(np.abs(rotated / here - 1).max())))
    return rows


def main() -> None:
    """Write and print the table."""
    rows = [*plane_rows(), *life_rows()]
    with TABLE.open("w", encoding="utf-8", newline="") as lines:
        writer = csv.writer(lines, lineterminator="\n")
        writer.writerow(["case", "closed form", "deviation"])
        for case, exact, deviation in rows:
            writer.writerow([case, exact, f"{deviation:.2g}"])
            print(f"{case:62} {exact:24} {deviation:+.2g}")


if __name__ == "__main__":
    main()
