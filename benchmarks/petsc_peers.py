"""The heat equation of `conduction.py` solved with PETSc, as a specialist would write it.

    python petsc_peers.py SYSTEM.npz ANSWERS.npz

`conduction.py --peers` runs it. It needs petsc4py and numpy alone, so that a Python with another numpy can run it
(Debian: python3-petsc4py-real).

    M du/dt = -S u + f + sum over regions of M_r q(u),    q = q0 exp(-0.0148 (u - 25)), between its nodal values

- ``cholesky``: backward Euler with steps of 1 s, one Cholesky factor.
- ``rosw``: TSROSW ra34pw2, adaptive, the Jacobian without the source's slope, by that Cholesky factor; for several
  tolerances.

Factors are PETSc's own in two orders and CHOLMOD's; of each run the fastest counts. Seconds count factors and steps,
not assembly.
"""

from __future__ import annotations

import sys
import time

import numpy as np
import petsc4py

petsc4py.init([])

from petsc4py import PETSc  # noqa: E402

#: (package, order) of Cholesky factors that are tried.
FACTORS = (("petsc", "rcm"), ("petsc", "nd"), ("cholmod", "nd"))


class HeatEquation:
    """Matrices and vectors of the system in PETSc."""

    def __init__(self, given) -> None:
        self.indptr, self.indices = given["indptr"].astype(PETSc.IntType), given["indices"].astype(PETSc.IntType)
        self.times = given["times"]
        self.M, self.S = self.matrix(given["M"]), self.matrix(given["S"])
        self.sources = [
            (self.matrix(values), float(q0)) for values, q0 in zip(given["sources"], given["q0"], strict=True)
        ]
        self.load = PETSc.Vec().createWithArray(given["load"].copy())
        self.heat, self.part = self.load.duplicate(), self.load.duplicate()

    def matrix(self, values):
        """A matrix on the common pattern."""
        size = len(self.indptr) - 1
        return PETSc.Mat().createAIJ((size, size), csr=(self.indptr, self.indices, values.copy()))

    def start(self):
        """25 degC everywhere."""
        u = self.load.duplicate()
        u.set(25.0)
        return u

    def add_heat(self, u, to) -> None:
        """Add f + sum of M_r q(u) to a vector."""
        factor = np.exp(-0.0148 * (u.getArray(readonly=True) - 25.0))
        to.axpy(1.0, self.load)
        for matrix, q0 in self.sources:
            self.heat.setArray(q0 * factor)
            matrix.mult(self.heat, self.part)
            to.axpy(1.0, self.part)

    def solver(self, matrix, package: str, order: str):
        """A linear solver by one Cholesky factor."""
        ksp = PETSc.KSP().create()
        ksp.setType("preonly")
        ksp.setOperators(matrix)
        with_factor(ksp.getPC(), package, order)
        return ksp


def with_factor(pc, package: str, order: str) -> None:
    """Let a preconditioner be a Cholesky factor."""
    pc.setType("cholesky")
    pc.setFactorSolverType(package)
    pc.setFactorOrdering(order)


def cholesky(equation: HeatEquation, package: str, order: str, step: float = 1.0):
    """Seconds and values of backward Euler."""
    begun = time.perf_counter()
    M = equation.M.copy()
    M.scale(1 / step)
    A = M.copy()
    A.axpy(1.0, equation.S, structure=PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
    A.setOption(PETSc.Mat.Option.SPD, True)
    solver = equation.solver(A, package, order)
    solver.setUp()
    u, right = equation.start(), equation.start()
    values = [u.getArray().copy()]
    for i in range(round(equation.times[-1] / step)):
        M.mult(u, right)
        equation.add_heat(u, right)
        solver.solve(right, u)
        if np.isclose(equation.times, (i + 1) * step).any():
            values.append(u.getArray().copy())
    return time.perf_counter() - begun, np.array(values)


def rosw(equation: HeatEquation, tolerance: float, package: str, order: str):
    """Seconds and values of the adaptive Rosenbrock-W method."""
    begun = time.perf_counter()
    J = equation.M.duplicate(copy=True)

    def function(ts, t, u, rate, residual) -> None:
        equation.M.mult(rate, residual)
        equation.S.multAdd(u, residual, residual)
        residual.scale(-1.0)
        equation.add_heat(u, residual)
        residual.scale(-1.0)

    def jacobian(ts, t, u, rate, shift, matrix, preconditioner) -> None:
        equation.S.copy(matrix, structure=PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
        matrix.axpy(shift, equation.M, structure=PETSc.Mat.Structure.SAME_NONZERO_PATTERN)

    ts = PETSc.TS().create()
    options = PETSc.Options()
    for name, value in {"ts_type": "rosw", "ts_rosw_type": "ra34pw2", "ts_adapt_type": "basic"}.items():
        options[name] = value
    ts.setIFunction(function, equation.load.duplicate())
    ts.setIJacobian(jacobian, J, J)
    J.setOption(PETSc.Mat.Option.SPD, True)
    ts.setTimeSpan(equation.times)
    ts.setExactFinalTime(PETSc.TS.ExactFinalTime.MATCHSTEP)
    ts.setTolerances(rtol=0.0, atol=tolerance)
    ts.setTimeStep(0.01)
    ts.setMaxSteps(100_000)
    ksp = ts.getSNES().getKSP()
    ksp.setType("preonly")
    with_factor(ksp.getPC(), package, order)
    ts.setFromOptions()
    u = equation.start()
    values = []

    def monitor(ts, step, t, u) -> None:
        if np.isclose(equation.times, t, rtol=0, atol=1e-9).any():
            values.append(u.getArray(readonly=True).copy())

    ts.setMonitor(monitor)
    ts.solve(u)
    return time.perf_counter() - begun, np.array(values)


def main() -> None:
    """Solve the system of a file and write the answers."""
    given = np.load(sys.argv[1])
    equation, repeat = HeatEquation(given), int(given["repeat"])
    ways = {"Cholesky, 1 s steps": lambda *factor: cholesky(equation, *factor)}
    for tolerance in given["tolerances"]:
        ways[f"TSROSW ra34pw2, {tolerance:g} K"] = lambda *factor, K=float(tolerance): rosw(equation, K, *factor)
    names, seconds, values = [], [], []
    for name, way in ways.items():
        runs = []
        for package, order in FACTORS:
            try:
                runs += [(*way(package, order), f"{package} {order}") for _ in range(repeat)]
            except PETSc.Error:
                continue
        best = min(runs, key=lambda run: run[0])
        names.append(f"{name}, {best[2]}")
        seconds.append(best[0])
        values.append(best[1])
    np.savez(sys.argv[2], names=names, seconds=seconds, values=np.array(values))


if __name__ == "__main__":
    main()
