"""Order of the time integration, and global errors within the tolerance asked for."""

from __future__ import annotations

import numpy as np
import pytest
import skfem

from tyrefem.conduction import Conduction, Film, Fixed, Flux, Material, Radiation, Reservoir
from tyrefem.conduction.rosenbrock import ALPHA, DENSE, EMBEDDED, LOWER, NODE, SHIFT, WEIGHT, Step
from tyrefem.conduction.stage_matrix import GAMMA, StageMatrices
from tyrefem.conduction.statement import balance_of
from tyrefem.conduction.terms import State

RUBBER = Material(conductivity=0.21, heat_capacity=2.09e6)


def wall(nr: int = 16, nz: int = 4, thickness: float = 0.015):
    mesh = skfem.MeshTri.init_tensor(np.linspace(0.28, 0.28 + thickness, nr + 1), np.linspace(0, 0.01, nz + 1))
    ends = (0.28 + 1e-9, 0.28 + thickness - 1e-9)
    return mesh.with_subdomains({"rubber": np.arange(mesh.t.shape[1])}).with_boundaries(
        {"inside": lambda x: x[0] < ends[0], "outside": lambda x: x[0] > ends[1]}
    )


def hysteresis(x, t, T):
    return 3e5 * np.exp(-0.0148 * (T - 25)) * (1 + 40 * (x[0] - 0.28))


def test_coefficients_meet_the_order_conditions() -> None:
    """Third order for any Jacobian (second for the embedded weights), stiffly accurate, L-stable."""
    beta = ALPHA + LOWER
    for weights, known in ((WEIGHT, True), (EMBEDDED, False)):
        assert weights.sum() == pytest.approx(1, abs=1e-14)
        assert weights @ NODE == pytest.approx(1 / 2, abs=1e-14)
        assert weights @ SHIFT == pytest.approx(0, abs=1e-14)
        if known:
            assert weights @ NODE**2 == pytest.approx(1 / 3, abs=1e-14)
            assert weights @ ALPHA @ NODE == pytest.approx(1 / 6, abs=1e-14)
            for matrix, vector in ((ALPHA, SHIFT), (LOWER, NODE), (LOWER, SHIFT)):
                assert weights @ matrix @ vector == pytest.approx(0, abs=1e-14)
    assert pytest.approx(beta[3], abs=1e-14) == WEIGHT
    assert 1 - WEIGHT @ np.linalg.solve(beta, np.ones(4)) == pytest.approx(0, abs=1e-12)
    assert pytest.approx(1 / 6, abs=1e-14) == GAMMA**3 - 3 * GAMMA**2 + 1.5 * GAMMA
    assert DENSE.sum(axis=1) == pytest.approx(WEIGHT, abs=1e-13)
    z = 1j * np.logspace(-2, 3, 200)
    growth = [1 + s * WEIGHT @ np.linalg.solve(np.eye(4) - s * beta, np.ones(4)) for s in z]
    assert np.max(np.abs(growth)) <= 1 + 1e-12


def hot_wall(x, t):
    return 25 + 30 * np.sin(0.05 * t)


@pytest.mark.parametrize("case", ["film ramp", "variable material", "fixed", "radiation", "massless gas"])
def test_fixed_steps_converge_with_third_order(case: str) -> None:
    """The frozen Jacobian is wrong in every case, and the order must not care."""
    material = RUBBER
    boundaries = {"outside": [Film(h=lambda x, t: 40 + 0.6 * t, sink=25.0)], "inside": []}
    if case == "variable material":
        material = Material(lambda T: 0.21 + 0.001 * T, lambda T: 1.8e6 + 4e3 * T)
    elif case == "fixed":
        boundaries["inside"] = [Fixed(hot_wall)]
    elif case == "radiation":
        boundaries["inside"] = [Radiation(0.9, surroundings=hot_wall)]
    elif case == "massless gas":
        boundaries["inside"] = [Film(lambda x, t: 10 + 0.2 * t, "gas")]
    reservoirs = {"gas": Reservoir(0.0, exchanges=((0.3, lambda t: 25 + 0.5 * t),))} if "gas" in case else {}
    problem = Conduction(wall(8, 1), {"rubber": material}, boundaries, {"rubber": hysteresis}, reservoirs=reservoirs)

    def end(steps: int):
        balance = balance_of(
            problem.operators, problem.regions, problem.boundaries, problem.sources, problem.reservoirs
        )
        y = State(np.full(problem.operators.size, 25.0), np.full(len(reservoirs), 25.0))
        balance.balance_massless(0.0, y.u, y.g)
        balance.freeze(0.0, y)
        matrices, h = StageMatrices(), 160.0 / steps
        for i in range(steps):
            step = Step(balance, i * h, h, y)
            step.run(matrices.get(balance, h), 0.0, 160.0)
            y = step.at(1.0)
            balance.balance_massless((i + 1) * h, y.u, y.g)
        return np.concatenate((y.u, y.g))

    reference = end(640)
    coarse, fine = (np.abs(end(steps) - reference).max() for steps in (80, 160))
    assert np.log2(coarse / fine) > 2.8
    assert fine < 1e-4


def cases() -> dict[str, dict]:
    pulse = {"outside": Film(h=lambda x, t: 300.0 if t < 200 else 30.0, sink=lambda x, t: 25.0 if t < 400 else 5.0)}
    return {
        "self-heating": {"boundaries": {"outside": Film(60.0, 25.0)}, "sources": {"rubber": hysteresis}},
        "switched film": {
            "boundaries": pulse | {"inside": Film(4.2, "gas")},
            "sources": {"rubber": lambda x, t, T: hysteresis(x, t, T) if t < 400 else np.zeros_like(T)},
            "reservoirs": {"gas": Reservoir(30.0)},
            "breakpoints": (200.0, 400.0),
        },
        "ramped film": {
            "boundaries": {"outside": Film(lambda x, t: 5 + 0.3 * t, lambda x, t: 25 + 10 * np.sin(t / 60))},
            "sources": {"rubber": hysteresis},
        },
        "insulated": {"boundaries": {}, "sources": {"rubber": hysteresis}},
        "quenched": {"boundaries": {"outside": Film(4000.0, 60.0), "inside": Flux(500.0)}},
        "prescribed": {"boundaries": {"inside": Fixed(lambda x, t: 25 + 40 * np.sin(t / 50))}},
        "variable": {
            "boundaries": {"outside": [Film(30.0, 25.0), Radiation(0.9, 20.0)]},
            "sources": {"rubber": hysteresis},
            "material": Material(lambda T: 0.21 + 0.001 * T, lambda T: 1.8e6 + 4e3 * T),
        },
    }


@pytest.mark.parametrize("name", list(cases()))
def test_global_error_stays_within_the_tolerance(name: str) -> None:
    """Every node and reservoir, at times that no step aims at, against a run 50 times tighter."""
    case = cases()[name]
    breakpoints = case.pop("breakpoints", ())
    material = case.pop("material", RUBBER)
    problem = Conduction(wall(12, 1), {"rubber": material}, **case)
    times = np.concatenate(([0.0], np.sort(np.random.default_rng(3).uniform(1, 599, 40)), [600.0]))

    def solve(tolerance: float):
        history = problem.transient(times, 25.0, tolerance, breakpoints=breakpoints)
        return np.column_stack([history.values, *history.reservoirs.values()]), history

    reference, _ = solve(2e-5)
    for tolerance in (0.1, 0.01, 0.001):
        values, history = solve(tolerance)
        error = np.abs(values - reference).max()
        assert error <= tolerance, f"{error:.2g} K at tolerance {tolerance} ({history.steps})"


def test_many_output_times_do_not_shorten_the_steps() -> None:
    problem = Conduction(wall(), {"rubber": RUBBER}, {"outside": Film(60.0, 25.0)}, {"rubber": hysteresis})
    few = problem.transient([0.0, 600.0])
    many = problem.transient(np.linspace(0, 600, 1201))
    assert many.steps == few.steps
    assert many.values[-1] == pytest.approx(few.values[-1], abs=1e-12)


def test_breakpoints_are_landed_on_and_seen_from_the_right_side() -> None:
    """A source that is on for exactly 100 s heats an insulated body by exactly q t / C."""
    seen: list[float] = []

    def switched(x, t, T):
        seen.append(t)
        return np.full_like(T, 2.09e5 if 100.0 <= t < 200.0 else 0.0)

    problem = Conduction(wall(), {"rubber": RUBBER}, {}, {"rubber": switched})
    steps: list[float] = []
    history = problem.transient([0.0, 100.0, 150.0, 200.0, 300.0], breakpoints=[100.0, 200.0], progress=steps.append)
    exact = np.array([25.0, 25.0, 30.0, 35.0, 35.0])
    assert np.abs(history.values - exact[:, None]).max() < 1e-6
    assert {100.0, 200.0, 300.0} <= set(steps)
    assert not {100.0, 200.0} & set(seen)


def test_largest_step_is_respected() -> None:
    problem = Conduction(wall(), {"rubber": RUBBER}, {"outside": Film(60.0, 30.0)})
    ends: list[float] = [0.0]
    problem.transient([0.0, 300.0], max_step=7.0, progress=ends.append)
    assert np.max(np.diff(ends)) <= 7.0
