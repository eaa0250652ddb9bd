"""What a parameter changes directly is the difference of two heat balances; tangents with heat capacities that vary."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import skfem

from tyrefem.conduction import Conduction, Film, Flux, Material, Radiation, Reservoir
from tyrefem.conduction.direct_sensitivity import DirectHeat, heat_of
from tyrefem.conduction.sensitivity import Perturbed, stage_times, tangents
from tyrefem.conduction.terms import State

VALUES = {
    "k": 0.25, "k_rise": 1e-3, "c": 2.0e6, "c_rise": 3e-3, "heat": 2.0e5, "loss": 6e-3, "film": 40.0, "uneven": 5.0,
    "sink": 30.0, "flux": 400.0, "emissivity": 0.9, "gas": 300.0, "gas_film": 15.0, "exchange": 2.0,
}  # fmt: skip


def ring(cells: int) -> Any:
    """A square ring of two layers."""
    mesh = skfem.MeshQuad.init_tensor(np.linspace(0.5, 0.53, cells + 1), np.linspace(0.0, 0.03, cells + 1))
    return mesh.with_subdomains({"inside": lambda x: x[0] < 0.515, "outside": lambda x: x[0] > 0.515}).with_boundaries(
        {
            "outer": lambda x: x[0] > 0.53 - 1e-9,
            "inner": lambda x: x[0] < 0.5 + 1e-9,
            "end": lambda x: x[1] > 0.03 - 1e-9,
        }
    )


def problem(mesh: Any, **changes: float) -> Conduction:
    """Every kind of load at once. Both layers heat by one law; ``heat`` is of the inner one."""
    p = VALUES | changes

    def warm(x: Any, t: float, T: Any) -> Any:
        return (1.0 + 1e-3 * t) * np.exp(-p["loss"] * (T - 25.0))

    return Conduction(
        mesh,
        {
            "inside": Material(p["k"], lambda T: p["c"] * (1 + p["c_rise"] * (T - 25.0))),
            "outside": Material(lambda T: p["k"] * (1 + p["k_rise"] * T), p["c"]),
        },
        {
            "outer": [
                Film(lambda x, t: p["film"] + 0.1 * t, lambda x, t: p["sink"] + 0.01 * t),
                Film(lambda x, t: p["uneven"] * (1 + x[1] / 0.03), p["sink"]),
                Radiation(p["emissivity"], 20.0),
            ],
            "inner": Film(lambda x, t: p["gas_film"] + 0.01 * t, "gas"),
            "end": Flux(lambda x, t: p["flux"] * x[0]),
        },
        {"inside": lambda x, t, T: p["heat"] * warm(x, t, T), "outside": lambda x, t, T: 1e5 * warm(x, t, T)},
        reservoirs={"gas": Reservoir(p["gas"], exchanges=((p["exchange"], 20.0),))},
    )


def test_direct_heat_is_the_difference_of_two_balances() -> None:
    mesh = ring(6)
    base = problem(mesh)
    steps = {name: 1e-3 * value for name, value in VALUES.items()}
    others = [problem(mesh, **{name: VALUES[name] + step})._balance() for name, step in steps.items()]
    points = base.operators.points
    start, y = (State(a + 400.0 * (points[0] - 0.5), np.array([b])) for a, b in ((25.0, 24.0), (60.0, 50.0)))
    heat = DirectHeat(base._balance(), others, list(steps.values()), 0.0, start)(200.0, y)
    # Frozen elsewhere and evaluated load by load: the same heat, put together in another way.
    frozen = base._balance()
    frozen.freeze(200.0, y)
    base_heat = heat_of(frozen, 200.0, y)
    rate = np.linalg.solve(frozen.M.toarray(), base_heat[:-1])
    rounding = 1e-12 * np.max(abs(frozen.S) @ np.abs(y.u))
    for number, (name, step) in enumerate(steps.items()):
        other = others[number]
        other.freeze(200.0, y)
        wanted = (heat_of(other, 200.0, y) - base_heat) / step
        wanted[:-1] -= (other.M - frozen.M) @ rate / step
        wanted[-1] -= (other.reservoir_capacity(y.g) - VALUES["gas"])[0] / step * base_heat[-1] / VALUES["gas"]
        assert np.abs(wanted).max() > 0, name
        close = rounding / step
        assert close < 1e-3 * np.abs(wanted).max(), name
        np.testing.assert_allclose(heat[:, number], wanted, rtol=1e-9, atol=close, err_msg=name)


def test_one_law_for_two_zones_changed_in_one() -> None:
    mesh, law = ring(4), lambda x, t, T: 1e5 * np.exp(-0.006 * (T - 25.0))

    def heated(outside: Any) -> Conduction:
        body = dict.fromkeys(("inside", "outside"), Material(0.25, 2e6))
        return Conduction(mesh, body, {"outer": Film(40.0, 30.0)}, {"inside": law, "outside": outside})

    base, other = heated(law), heated(lambda x, t, T: 1.1 * law(x, t, T))
    y = State(np.full(base.operators.size, 40.0), np.zeros(0))
    heat = DirectHeat(base._balance(), [other._balance()], [0.1], 0.0, y)(0.0, y)
    nodes = base.points("outside")
    assert heat.sum() == pytest.approx(
        (base.operators.source("outside") @ law(nodes, 0.0, np.full(nodes.shape[1], 40.0))).sum()
    )


def test_tangents_where_the_heat_capacity_varies() -> None:
    mesh, even = ring(4), {"k_rise": 0.0, "emissivity": 0.0}
    times = stage_times((0.0, 300.0), first=3.0, growth=1.4, longest=30.0)
    base = problem(mesh, **even)
    history = base.transient(times, 25.0, 1e-4)
    gas, names = history.reservoirs["gas"][:, None], ("c_rise", "heat", "film")
    steps = {name: 1e-4 * VALUES[name] for name in names}
    others = [Perturbed(problem(mesh, **even, **{name: VALUES[name] + step}), step) for name, step in steps.items()]
    sensitivities = tangents(base, times, history.values, gas, others).values
    for name, tangent in zip(names, sensitivities, strict=True):
        h = 0.02 * VALUES[name]
        runs = [problem(mesh, **even, **{name: VALUES[name] + x}).transient(times[::2], 25.0, 1e-4) for x in (h, -h)]
        wanted = (runs[0].values - runs[1].values) / (2 * h)
        assert np.abs(tangent[::2] - wanted).max() < 0.01 * np.abs(wanted).max(), name


def test_many_tangents_at_once_are_those_of_one() -> None:
    mesh = ring(10)
    base, times = problem(mesh), stage_times((0.0, 100.0), longest=20.0)
    history = base.transient(times, 25.0)
    gas = history.reservoirs["gas"][:, None]
    other = Perturbed(problem(mesh, heat=1.01 * VALUES["heat"]), 0.01 * VALUES["heat"])
    single, many = (tangents(base, times, history.values, gas, [other] * count).values for count in (1, 20))
    assert np.abs(single).max() > 0
    np.testing.assert_allclose(many, np.broadcast_to(single, many.shape), rtol=0, atol=1e-12 * np.abs(single).max())


def cooled_face(mesh: Any, **changes: float) -> Conduction:
    """A ring whose conductivity falls by half over 100 K, and that is rubbed the less the hotter its face is."""
    p = {"k": 0.3, "heat": 2e5, "rubbing": 1200.0} | changes
    material = Material(lambda T: (p["k"] * (1 - 0.005 * (T - 20.0)), 0.8 * p["k"] * (1 - 0.004 * (T - 20.0))), 2e6)
    return Conduction(
        mesh,
        {"inside": material, "outside": material},
        {
            "outer": [Film(60.0, 20.0), Radiation(0.9, 20.0)],
            "end": Flux(lambda x, t, T: p["rubbing"] * np.exp(-0.01 * (T - 20.0)), of_temperature=True),
        },
        {"inside": p["heat"]},
    )


@pytest.mark.parametrize("name", ["k", "heat", "rubbing"])
def test_tangents_where_conductivity_and_flux_vary(name: str) -> None:
    """Without their slopes over temperature these tangents are off by 8 to 23 %."""
    mesh, value = ring(4), {"k": 0.3, "heat": 2e5, "rubbing": 1200.0}[name]
    times = stage_times((0.0, 900.0), first=3.0, growth=1.4, longest=30.0)
    base = cooled_face(mesh)
    history = base.transient(times, 25.0, 1e-4)
    assert 80.0 < history.values.max() < 140.0
    step, h = 1e-4 * value, 0.02 * value
    other = Perturbed(cooled_face(mesh, **{name: value + step}), step)
    tangent = tangents(base, times, history.values, np.zeros((len(times), 0)), [other]).values[0]
    runs = [cooled_face(mesh, **{name: value + x}).transient(times[::2], 25.0, 1e-4).values for x in (h, -h)]
    wanted = (runs[0] - runs[1]) / (2 * h)
    assert np.abs(tangent[::2] - wanted).max() < 0.005 * np.abs(wanted).max()
