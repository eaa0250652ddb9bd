"""Speed and accuracy of a transient conduction run against a plain scikit-fem loop, same mesh, same physics.

A curved thin ring section (tyre-like, about 15 : 1) with films on both faces, a lower road film on the crown and a
source q0 exp(-0.0148 (T - 25)) heats up from 25 degC for 1200 s.

- ours: `Conduction.transient`, tolerance 0.01 K;
- plain: scikit-fem assembly, `scipy.sparse.linalg.splu` with its defaults, backward Euler at 1 s, nodal source.

Both are compared with a run at 1e-5 K. Prints a table and, as the last line, one JSON object.
Usage: python benchmarks/conduction.py [--quick] [--repeat N]
"""

# ruff: noqa: E402 - the number of BLAS threads must be set before numpy is loaded.
from __future__ import annotations

import os

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

import argparse
import json
import time
from dataclasses import dataclass

import numpy as np
import skfem
from scipy.sparse.linalg import splu
from skfem.helpers import dot, grad

from tyrefem.conduction import Conduction, Film, Material

END, OUTPUTS = 1200.0, np.array([0.0, 60.0, 200.0, 433.0, 777.0, 1200.0])
CARCASS, TREAD = Material(0.25, 2.1e6), Material(0.21, 2.09e6)
INSIDE, OUTSIDE, ROAD = Film(6.0, 40.0), Film(20.0, 25.0), Film(150.0, 30.0)
FORM = {"carcass": 1.5e5, "tread": 2.5e5}


@dataclass
class Timing:
    """Seconds of one run, and its largest error in K."""

    assembly: float
    factor: float
    stepping: float
    error: float = 0.0

    @property
    def total(self) -> float:
        """Whole run, s."""
        return self.assembly + self.factor + self.stepping


def section(nodes: int):
    """A circular-arc section, 15 times as long as thick, split in carcass and tread."""
    across = max(4, round((nodes / 15) ** 0.5) // 2 * 2)
    along = round(nodes / (across + 1)) - 1
    mesh = skfem.MeshTri.init_tensor(np.linspace(0, 1, along + 1), np.linspace(0, 1, across + 1))
    angle, depth = (mesh.p[0] - 0.5) * 2.4, 0.0166 * mesh.p[1]
    radius = 0.095 + depth
    place = np.stack([0.2 + radius * np.cos(angle), radius * np.sin(angle)])
    low, high = mesh.facets_satisfying(lambda x: x[1] < 1e-9), mesh.facets_satisfying(lambda x: x[1] > 1 - 1e-9)
    middle = np.abs(mesh.p[0, mesh.facets[:, high]].mean(axis=0) - 0.5) < 0.25
    level = mesh.p[1, mesh.t].mean(axis=0)
    return (
        skfem.MeshTri(place, mesh.t)
        .with_subdomains({"carcass": np.flatnonzero(level < 0.5), "tread": np.flatnonzero(level > 0.5)})
        .with_boundaries({"inside": low, "outside": high[~middle], "road": high[middle]})
    )


def law(region: str):
    """Heat source of a region, W/m3."""
    return lambda x, t, T: FORM[region] * np.exp(-0.0148 * (T - 25))


def fresh(mesh):
    """The same mesh as a new object: nothing that a solver or scikit-fem remembers comes along."""
    return type(mesh)(mesh.p, mesh.t, _boundaries=mesh.boundaries, _subdomains=mesh.subdomains)


def ours(mesh, tolerance: float = 0.01):
    """Our solver on a mesh object it has never seen; the split comes from one factorisation timed apart."""
    mesh = fresh(mesh)
    start = time.perf_counter()
    problem = Conduction(
        mesh,
        {"carcass": CARCASS, "tread": TREAD},
        {"inside": INSIDE, "outside": OUTSIDE, "road": ROAD},
        {"carcass": law("carcass"), "tread": law("tread")},
    )
    assembled = time.perf_counter()
    history = problem.transient(OUTPUTS, 25.0, tolerance)
    end = time.perf_counter()
    ops = problem.operators
    data = ops.mass("carcass") + ops.mass("tread")
    one = time.perf_counter()
    ops.ordering(np.arange(ops.size)).factor(data)
    factor = (time.perf_counter() - one) * history.steps.factorisations
    return Timing(assembled - start, factor, end - assembled - factor), history


def plain(mesh, step: float = 1.0):
    """What one writes with scikit-fem in an afternoon: 1200 backward-Euler steps, one SuperLU factorisation."""
    mesh = fresh(mesh)
    start = time.perf_counter()
    element = skfem.ElementTriP1()
    mass = skfem.BilinearForm(lambda u, v, w: 2 * np.pi * w.x[0] * u * v)
    conduct = skfem.BilinearForm(lambda u, v, w: 2 * np.pi * w.x[0] * dot(grad(u), grad(v)))
    load = skfem.LinearForm(lambda v, w: 2 * np.pi * w.x[0] * v)
    M = K = 0
    sources = []
    for name, material in (("carcass", CARCASS), ("tread", TREAD)):
        basis = skfem.Basis(mesh, element, elements=name)
        m = mass.assemble(basis)
        M = M + material.heat_capacity * m
        K = K + material.conductivity * conduct.assemble(basis)
        sources.append((m, law(name)))
    f = np.zeros(K.shape[0])
    for name, film in (("inside", INSIDE), ("outside", OUTSIDE), ("road", ROAD)):
        basis = skfem.FacetBasis(mesh, element, facets=name)
        K = K + film.h * mass.assemble(basis)
        f += film.h * film.sink * load.assemble(basis)
    A = (M / step + K).tocsc()
    M = (M / step).tocsr()
    assembled = time.perf_counter()
    lu = splu(A)
    factored = time.perf_counter()
    u = np.full(K.shape[0], 25.0)
    values = [u]
    for i in range(round(END / step)):
        right = f + M @ u
        for m, q in sources:
            right += m @ q(mesh.p, i * step, u)
        u = lu.solve(right)
        if np.any(np.isclose(OUTPUTS, (i + 1) * step)):
            values.append(u)
    return Timing(assembled - start, factored - assembled, time.perf_counter() - factored), np.array(values)


def measure(nodes: int, repeat: int) -> dict:
    """Best of `repeat` for both, errors against the tight run."""
    mesh = section(nodes)
    _, tight = ours(mesh, 1e-5)
    reference = tight.values
    best, history = min((ours(mesh) for _ in range(repeat)), key=lambda run: run[0].total)
    best.error = float(np.abs(history.values - reference).max())
    base, values = min((plain(mesh) for _ in range(repeat)), key=lambda run: run[0].total)
    base.error = float(np.abs(values - reference).max())
    return {"nodes": int(mesh.p.shape[1]), "ours": best, "plain": base, "steps": history.steps}


def main() -> None:
    """Run, print the table and the JSON line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="1k, 2k and 5k nodes only")
    parser.add_argument("--repeat", type=int, default=0, help="best of so many runs (default 3, quick 1)")
    options = parser.parse_args()
    sizes = [1000, 2000, 5000] if options.quick else [2000, 10000, 50000]
    repeat = options.repeat or (1 if options.quick else 3)
    print(f"{'nodes':>7} {'solver':<28}{'assembly':>9}{'factor':>9}{'stepping':>9}{'total s':>9}{'error K':>10}")
    rows = {}
    measure(400, 1)
    for nodes in sizes:
        row = rows[f"{nodes // 1000}k"] = measure(nodes, repeat)
        steps = row["steps"]
        names = {
            "ours": f"tyrefem ({steps.accepted} steps, {steps.factorisations} f.)",
            "plain": "scikit-fem + SuperLU, 1 s",
        }
        for key, label in names.items():
            t = row[key]
            print(
                f"{row['nodes']:7d} {label:<28}{t.assembly:9.3f}{t.factor:9.3f}{t.stepping:9.3f}"
                f"{t.total:9.3f}{t.error:10.5f}"
            )
    n, cost = (np.log([f(row) for row in rows.values()]) for f in (lambda r: r["nodes"], lambda r: r["ours"].total))
    result = {
        "speedup": {key: round(row["plain"].total / row["ours"].total, 2) for key, row in rows.items()},
        "error_K": {
            key: {"ours": round(row["ours"].error, 5), "plain": round(row["plain"].error, 5)}
            for key, row in rows.items()
        },
        "cost_exponent": round(float((cost[-1] - cost[0]) / (n[-1] - n[0])), 3),
        "nodes": {key: row["nodes"] for key, row in rows.items()},
        "seconds": {key: round(row["ours"].total, 4) for key, row in rows.items()},
    }
    print(json.dumps(result))


if __name__ == "__main__":
    main()
