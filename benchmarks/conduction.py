"""Speed and accuracy of a transient conduction run against a plain scikit-fem loop, same mesh, same physics.

A curved thin ring section (tyre-like, about 15 : 1) with films on both faces, a lower road film on the crown and a
source q0 exp(-0.0148 (T - 25)) heats up from 25 degC for 1200 s.

- ours: `Conduction.transient`, tolerance 0.01 K;
- plain: scikit-fem assembly, `scipy.sparse.linalg.splu` with its defaults, backward Euler at 1 s, nodal source.

Both are compared with a run at 1e-5 K. Prints a table and, as the last line, one JSON object.

With --peers PETSc solves the same matrices (`petsc_peers.py`): by a Cholesky factor with steps of 1 s, and by its
adaptive Rosenbrock-W method. Our time at a peer's error is interpolated between our runs at several tolerances.

With --save they also write docs/evidence/tables/conduction-peers.csv and docs/pictures/conduction-peers.png.

Usage: python benchmarks/conduction.py [--quick] [--repeat N] [--peers [PYTHON] [--save]]
"""

# ruff: noqa: E402 - the number of BLAS threads must be set before numpy is loaded.
from __future__ import annotations

import os

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

import argparse
import json
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import skfem
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import splu
from skfem.helpers import dot, grad

from tyrefem.conduction import Conduction, Film, Material

END, OUTPUTS = 1200.0, np.array([0.0, 60.0, 200.0, 433.0, 777.0, 1200.0])
CARCASS, TREAD = Material(0.25, 2.1e6), Material(0.21, 2.09e6)
INSIDE, OUTSIDE, ROAD = Film(6.0, 40.0), Film(20.0, 25.0), Film(150.0, 30.0)
FORM = {"carcass": 1.5e5, "tread": 2.5e5}


#: Our tolerances and those of PETSc's adaptive method, K, for curves of time over error.
TOLERANCES, PEER_TOLERANCES = (0.3, 0.1, 0.03, 0.01, 0.003), (0.1, 0.03, 0.01, 0.003, 0.001)
#: Where Debian keeps petsc4py.
DEBIAN = "petscdir/*/*/lib/python3/dist-packages"


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


def equation(mesh):
    """M, S, f and (M_r, region) of M du/dt = -S u + f + sum M_r q, by scikit-fem."""
    element = skfem.ElementTriP1()
    mass = skfem.BilinearForm(lambda u, v, w: 2 * np.pi * w.x[0] * u * v)
    conduct = skfem.BilinearForm(lambda u, v, w: 2 * np.pi * w.x[0] * dot(grad(u), grad(v)))
    load = skfem.LinearForm(lambda v, w: 2 * np.pi * w.x[0] * v)
    M = S = 0
    sources = []
    for name, material in (("carcass", CARCASS), ("tread", TREAD)):
        basis = skfem.Basis(mesh, element, elements=name)
        m = mass.assemble(basis)
        M = M + material.heat_capacity * m
        S = S + material.conductivity * conduct.assemble(basis)
        sources.append((m, name))
    f = np.zeros(S.shape[0])
    for name, film in (("inside", INSIDE), ("outside", OUTSIDE), ("road", ROAD)):
        basis = skfem.FacetBasis(mesh, element, facets=name)
        S = S + film.h * mass.assemble(basis)
        f += film.h * film.sink * load.assemble(basis)
    return M, S, f, sources


def plain(mesh, step: float = 1.0):
    """What one writes with scikit-fem in an afternoon: 1200 backward-Euler steps, one SuperLU factorisation."""
    mesh = fresh(mesh)
    start = time.perf_counter()
    M, S, f, regions = equation(mesh)
    sources = [(m, law(name)) for m, name in regions]
    A = (M / step + S).tocsc()
    M = (M / step).tocsr()
    assembled = time.perf_counter()
    lu = splu(A)
    factored = time.perf_counter()
    u = np.full(S.shape[0], 25.0)
    values = [u]
    for i in range(round(END / step)):
        right = f + M @ u
        for m, q in sources:
            right += m @ q(mesh.p, i * step, u)
        u = lu.solve(right)
        if np.any(np.isclose(OUTPUTS, (i + 1) * step)):
            values.append(u)
    return Timing(assembled - start, factored - assembled, time.perf_counter() - factored), np.array(values)


def on_pattern(pattern: csr_matrix, matrix: csr_matrix):
    """Values of a matrix on a larger pattern."""
    matrix.sum_duplicates()

    def places(A):
        return np.repeat(np.arange(A.shape[0], dtype=np.int64), np.diff(A.indptr)) * A.shape[1] + A.indices

    values = np.zeros(pattern.nnz)
    values[np.searchsorted(places(pattern), places(matrix))] = matrix.data
    return values


def peers(mesh, reference, repeat: int, python: str) -> list[tuple[str, float, float]]:
    """(solver, seconds of factors and steps, error in K) of PETSc on the same matrices."""
    M, S, f, sources = equation(mesh)
    pattern = (abs(M) + abs(S)).tocsr()
    pattern.sort_indices()
    given = {
        "indptr": pattern.indptr, "indices": pattern.indices, "M": on_pattern(pattern, M), "S": on_pattern(pattern, S),
        "sources": np.array([on_pattern(pattern, m) for m, _ in sources]), "q0": [FORM[name] for _, name in sources],
        "load": f, "times": OUTPUTS, "tolerances": PEER_TOLERANCES, "repeat": repeat,
    }  # fmt: skip
    with tempfile.TemporaryDirectory() as folder:
        system, answers = Path(folder) / "system.npz", Path(folder) / "answers.npz"
        np.savez(system, **given)
        debian = [str(path) for path in Path("/usr/lib").glob(DEBIAN)]
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(debian)}
        program = [python, str(Path(__file__).with_name("petsc_peers.py")), str(system), str(answers)]
        if subprocess.run(program, env=environment, check=False).returncode:
            sys.exit(f"{python} has no petsc4py that works; on Debian: apt install python3-petsc4py-real")
        with np.load(answers) as made:
            return [
                (str(name), float(seconds), float(np.abs(values - reference).max()))
                for name, seconds, values in zip(made["names"], made["seconds"], made["values"], strict=True)
            ]


def beside_peers(nodes: int, repeat: int, python: str) -> list[dict]:
    """Rows of every run, ours at several tolerances and the peers': seconds, error, and the ratio to ours there."""
    mesh = section(nodes)
    _, tight = ours(mesh, 1e-5)
    rows = []
    for tolerance in TOLERANCES:
        best, history = min((ours(mesh, tolerance) for _ in range(repeat)), key=lambda run: run[0].total)
        off = float(np.abs(history.values - tight.values).max())
        rows.append(
            {"solver": "tyrefem", "run": f"{tolerance:g} K", "seconds": best.total, "error_K": off, "ratio": 1.0}
        )
    error, seconds = np.log(np.array(sorted((row["error_K"], row["seconds"]) for row in rows)).T)
    for name, took, off in peers(mesh, tight.values, repeat, python):
        here = float(np.exp(np.interp(np.log(off), error, seconds)))
        solver, run = name.split(", ", 1)
        rows.append({"solver": solver, "run": run, "seconds": took, "error_K": off, "ratio": took / here})
    count = int(mesh.p.shape[1])
    for row in rows:
        print(
            f"{count:7d} {row['solver']:<16}{row['run']:<24}{row['seconds']:9.4f} s{row['error_K']:11.5f} K"
            f"{row['ratio']:8.2f} times ours at this error",
            flush=True,
        )
    return [{"nodes": count, **row} for row in rows]


def save_peers(rows: list[dict]) -> None:
    """Write the table and the picture of the runs beside PETSc."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import pandas as pd

    docs = Path(__file__).resolve().parents[1] / "docs"
    table = pd.DataFrame(rows)
    table.to_csv(docs / "evidence/tables/conduction-peers.csv", index=False, float_format="%.4g", lineterminator="\n")
    figure, axes = plt.subplots(figsize=(7, 4.2), layout="constrained")
    styles = {"tyrefem": ("#1f6f8b", "o-"), "TSROSW ra34pw2": ("#c8553d", "s--"), "Cholesky": ("#777777", "^")}
    for (nodes, solver), part in table.groupby(["nodes", "solver"]):
        color, style = styles[solver]
        label = f"PETSc {solver}" if solver != "tyrefem" else solver
        first = nodes == table["nodes"].min()
        axes.loglog(part["error_K"], part["seconds"], style, color=color, ms=4, label=label if first else None)
        if solver == "tyrefem":
            last = part.loc[part["error_K"].idxmin()]
            axes.annotate(
                f"{nodes:,} nodes", (last["error_K"], last["seconds"]), (-6, 3), textcoords="offset points", ha="right"
            )
    axes.set(xlabel="largest error at six times, K", ylabel="seconds, one core")
    axes.set_xlim(left=table["error_K"].min() / 4)
    axes.legend(frameon=False)
    axes.grid(which="major", color="#dddddd")
    figure.savefig(docs / "pictures/conduction-peers.png", dpi=130)


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
    parser.add_argument(
        "--peers", nargs="?", const="/usr/bin/python3", metavar="PYTHON",
        help="beside PETSc alone, run by a Python with petsc4py (default /usr/bin/python3)",
    )  # fmt: skip
    parser.add_argument("--save", action="store_true", help="of --peers: write the table and the picture of the docs")
    options = parser.parse_args()
    sizes = [1000, 2000, 5000] if options.quick else [2000, 10000, 50000]
    repeat = options.repeat or (1 if options.quick else 3)
    if options.peers:
        ours(section(400))
        runs = [row for nodes in sizes for row in beside_peers(nodes, repeat, options.peers)]
        ratios: dict[str, dict[int, float]] = {}
        for row in runs:
            of_solver = ratios.setdefault(row["solver"], {})
            of_solver[row["nodes"]] = round(min(row["ratio"], of_solver.get(row["nodes"], np.inf)), 2)
        if options.save:
            save_peers(runs)
        print(json.dumps({"smallest ratio": ratios}))
        return
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
