"""Lumped reservoirs: contained air and rim against closed forms and balances."""

from __future__ import annotations

import numpy as np
import pytest
import skfem

from tyrefem.conduction import Conduction, Film, Fixed, Material, Reservoir
from tyrefem.errors import InputError

pytestmark = pytest.mark.fast

STEEL = Material(conductivity=50.0, heat_capacity=4e6)


def ring():
    mesh = skfem.MeshTri.init_tensor(np.linspace(0.2, 0.21, 4), np.linspace(0, 0.1, 6))
    return mesh.with_subdomains({"wall": np.arange(mesh.t.shape[1])}).with_boundaries(
        {"inside": lambda x: x[0] < 0.2 + 1e-9, "outside": lambda x: x[0] > 0.21 - 1e-9}
    )


AREA = 2 * np.pi * 0.2 * 0.1


def test_gas_lags_a_surface_that_heats_linearly() -> None:
    """NASA appendix G, G3: surface c t, gas c t - (c/beta)(1 - exp(-beta t)), beta = h A / C."""
    c, h, capacity = 0.1, 4.18, 20.0
    ramp = Fixed(lambda x, t: 25 + c * t)
    problem = Conduction(
        ring(),
        {"wall": STEEL},
        {"inside": [Film(h, "gas"), ramp], "outside": ramp},
        reservoirs={"gas": Reservoir(capacity, initial=25.0)},
    )
    history = problem.transient(np.linspace(0, 600, 61), 25.0, 1e-4)
    beta, t = h * AREA / capacity, history.times
    exact = 25 + c * t - c / beta * (1 - np.exp(-beta * t))
    assert np.abs(history.reservoirs["gas"] - exact).max() < 1e-4
    assert history.budget.imbalance < 1e-9


def two_lumps(gas_capacity: float) -> Conduction:
    return Conduction(
        ring(),
        {"wall": STEEL},
        {"inside": Film(20.0, "gas")},
        reservoirs={
            "gas": Reservoir(gas_capacity, initial=90.0, exchanges=((3.0, "rim"),)),
            "rim": Reservoir(900.0, initial=40.0, exchanges=((0.5, 15.0),), power=12.0),
        },
    )


@pytest.mark.parametrize("gas_capacity", [60.0, 0.0])
def test_chain_of_reservoirs_follows_its_ordinary_differential_equations(gas_capacity: float) -> None:
    """A well-conducting wall is a third lump; the exact solution is a matrix exponential."""
    problem = two_lumps(gas_capacity)
    history = problem.transient(np.linspace(0, 2000, 21), 20.0, 1e-3)
    from scipy.linalg import expm

    volume = np.pi * (0.21**2 - 0.2**2) * 0.1
    hA, G, out = 20.0 * AREA, 3.0, 0.5
    flow = np.array([[-hA, hA, 0], [hA, -hA - G, G], [0, G, -G - out]])
    given = np.array([0.0, 0.0, out * 15.0 + 12.0])
    start = np.array([20.0, 90.0, 40.0])
    if gas_capacity == 0:
        keep, gone = [0, 2], 1
        lift = flow[keep, gone] / flow[gone, gone]
        flow = flow[np.ix_(keep, keep)] - np.outer(lift, flow[gone, keep])
        given, start = given[keep], start[keep]
        capacity = np.array([4e6 * volume, 900.0])
    else:
        capacity = np.array([4e6 * volume, gas_capacity, 900.0])
    A = flow / capacity[:, None]
    rest = -np.linalg.solve(flow, given)
    exact = np.array([rest + expm(A * t) @ (start - rest) for t in history.times])
    # The wall is not infinitely conductive: its Biot number h d / k = 0.004 limits the comparison.
    assert np.abs(history.reservoirs["rim"] - exact[:, -1]).max() < 0.05
    assert np.abs(history.values.mean(axis=1) - exact[:, 0]).max() < 0.05
    assert history.budget.imbalance < 1e-9
    if gas_capacity == 0:
        gas = history.reservoirs["gas"]
        inner = history.at([(0.2, 0.05)])[:, 0]
        assert gas == pytest.approx((hA * inner + G * history.reservoirs["rim"]) / (hA + G), abs=0.01)


def test_steady_state_of_a_chain() -> None:
    """All the power leaves through the last conductance: rim = 15 + 12/0.5, no flow inside."""
    field = two_lumps(60.0).steady()
    assert field.reservoirs == pytest.approx({"gas": 39.0, "rim": 39.0}, abs=1e-7)
    assert field.values == pytest.approx(39.0, abs=1e-7)
    assert field.flux_through("inside") == pytest.approx(0.0, abs=1e-7)


def test_capacity_that_depends_on_temperature() -> None:
    """C = a + b T: the heat stored is a dT + b d(T^2)/2, and it all came from the wall and the power."""
    problem = Conduction(
        ring(),
        {"wall": STEEL},
        {"inside": Film(30.0, "gas")},
        reservoirs={"gas": Reservoir(lambda T: 50 + 0.5 * T, initial=20.0, power=lambda t: 5 + 0.01 * t)},
    )
    history = problem.transient([0, 100, 600], 80.0, 1e-3)
    T = history.reservoirs["gas"]
    stored = 50 * (T - T[0]) + 0.25 * (T**2 - T[0] ** 2)
    assert history.budget.reservoir_stored["gas"] == pytest.approx(stored, rel=1e-9)
    assert history.budget.reservoir_gained["gas"] == pytest.approx(
        5 * history.times + 0.005 * history.times**2, rel=1e-9
    )
    assert history.budget.imbalance < 1e-4


def test_initial_temperatures_of_reservoirs() -> None:
    wall = {"wall": STEEL}
    inside = {"inside": Film(5.0, "gas")}
    problem = Conduction(ring(), wall, inside, reservoirs={"gas": Reservoir(5.0)})
    assert problem.transient([0, 1], 33.0).reservoirs["gas"][0] == pytest.approx(33.0)
    later = problem.transient([0, 1], 33.0, reservoirs_initial={"gas": 70.0})
    assert later.reservoirs["gas"][0] == 70.0
    resumed = problem.transient([1, 2], later.field(-1))
    assert resumed.reservoirs["gas"][0] == later.reservoirs["gas"][-1]
    with pytest.raises(InputError, match="did you mean 'gas'"):
        problem.transient([0, 1], reservoirs_initial={"gass": 70.0})


def test_isolated_massless_reservoir_is_refused() -> None:
    problem = Conduction(ring(), {"wall": STEEL}, {"outside": Fixed(0.0)}, reservoirs={"gas": Reservoir(0.0)})
    with pytest.raises(InputError, match="exchanges heat with nothing"):
        problem.transient([0, 1])


def test_a_capacity_over_temperature_beside_a_massless_reservoir() -> None:
    """The massless one follows the mean of its neighbours; no division by its capacity."""
    films = {"inside": Film(50.0, "gas"), "outside": Film(20.0, "shroud")}
    reservoirs = {
        "gas": Reservoir(lambda T: 50.0 + 0.1 * T, 80.0),
        "shroud": Reservoir(0.0, exchanges=((2.0, 25.0),)),
    }
    history = Conduction(ring(), {"wall": STEEL}, films, reservoirs=reservoirs).transient([0.0, 100.0, 900.0], 25.0)
    wall = history.field(2).at([(0.21, 0.05)])[0]
    G = 20.0 * 2 * np.pi * 0.21 * 0.1
    assert history.reservoirs["shroud"][-1] == pytest.approx((G * wall + 2.0 * 25.0) / (G + 2.0), abs=1e-3)
