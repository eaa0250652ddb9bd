"""generated = stored + lost, entry by entry."""

from __future__ import annotations

import numpy as np
import pytest
import skfem

from tyrefem.conduction import Conduction, Film, Fixed, Flux, Material, Radiation, Reservoir

pytestmark = pytest.mark.fast

TREAD = Material(conductivity=0.25, heat_capacity=2e6)
CARCASS = Material(conductivity=(0.4, 0.2), heat_capacity=2.1e6)


def section(cls: type = skfem.MeshTri):
    mesh = cls.init_tensor(np.linspace(0.28, 0.295, 9), np.linspace(0, 0.03, 10))
    return mesh.with_subdomains(
        {
            "carcass": lambda x: x[0] < 0.2875,
            "tread": lambda x: x[0] >= 0.2875,
            "shoulder": lambda x: x[1] > 0.02,
        }
    ).with_boundaries(
        {
            "inside": lambda x: x[0] < 0.28 + 1e-9,
            "outside": lambda x: x[0] > 0.295 - 1e-9,
            "rim": lambda x: x[1] < 1e-9,
            "side": lambda x: x[1] > 0.03 - 1e-9,
        }
    )


def heat(x, t, T):
    return 3e5 * np.exp(-0.0148 * (T - 25)) * (1 + 0.2 * np.sin(t / 30))


def everything(element: str, cls: type, carcass: Material = CARCASS) -> Conduction:
    return Conduction(
        section(cls),
        {"carcass": carcass, "tread": TREAD},
        {
            "inside": Film(4.2, "gas"),
            "outside": [Film(lambda x, t: 50 + 0.1 * t, lambda x, t: 20 + 100 * x[1]), Radiation(0.9, 10.0)],
            "rim": Fixed(lambda x, t: 30 + 5 * np.sin(t / 100)),
            "side": Flux(lambda x, t: 100 + t),
        },
        {"carcass": heat, "tread": heat, "shoulder": 2e4},
        element=element,
        reservoirs={"gas": Reservoir(40.0, exchanges=((0.2, 25.0),), power=1.0)},
    )


@pytest.mark.parametrize("cls", [skfem.MeshTri, skfem.MeshQuad])
@pytest.mark.parametrize("element", ["P1", "P2"])
def test_budget_closes_to_rounding_at_every_time(element: str, cls: type) -> None:
    """Also between steps, with a jump of the fixed boundary from 25 to 30 degC at the start."""
    history = everything(element, cls).transient(np.linspace(0, 600, 38), 25.0, 0.05)
    budget = history.budget
    assert budget.imbalance < 1e-9
    assert set(budget.generated) == {"carcass", "tread", "shoulder"}
    assert set(budget.lost) == {"inside", "outside", "rim", "side"}
    assert set(budget.stored) == {"carcass", "tread"}
    generated = sum(E[-1] for E in budget.generated.values())
    assert abs(generated - sum(E[-1] for E in (*budget.stored.values(), *budget.lost.values()))) < 1e-9 * generated
    volume = np.pi * (0.295**2 - 0.28**2) * 0.03 / 3
    assert budget.generated["shoulder"] == pytest.approx(2e4 * volume * history.times, rel=1e-9)
    side = np.pi * (0.295**2 - 0.28**2)
    assert -budget.lost["side"] == pytest.approx(side * (100 * history.times + history.times**2 / 2), rel=1e-9)


def test_powers_are_the_slopes_of_the_energies() -> None:
    """Energies at the requested times against the integral of the powers (trapezium rule)."""
    history = everything("P1", skfem.MeshTri).transient(np.linspace(0, 600, 601), 30.0, 1e-3)
    budget = history.budget
    start = 50

    def integral(power):
        return np.concatenate(([0.0], np.cumsum((power[1:] + power[:-1]) / 2 * np.diff(history.times))))

    for energies, powers in (
        (budget.generated, budget.generated_power),
        (budget.lost, budget.lost_power),
        (budget.stored, budget.stored_power),
        (budget.lost_by_condition, budget.lost_power_by_condition),
    ):
        for name, energy in energies.items():
            change = integral(powers[name])[start:] - integral(powers[name])[start]
            scale = np.abs(energy).max()
            assert np.abs(change - (energy[start:] - energy[start])).max() < 2e-4 * scale, name


def test_variable_heat_capacity_closes_within_the_time_error() -> None:
    variable = Material((0.4, 0.2), lambda T: 1.9e6 + 5e3 * T)
    history = everything("P1", skfem.MeshTri, variable).transient([0, 100, 333, 600], 30.0, 0.01)
    assert history.budget.imbalance < 1e-4
    assert history.budget.stored["carcass"][-1] > 0


def test_steady_fluxes_balance_the_sources() -> None:
    case = everything("P2", skfem.MeshQuad)
    field = case.steady(time=50.0)
    total = sum(field.generated.values())
    through_gas = field.flux_through("inside")
    assert sum(field.lost.values()) == pytest.approx(total, rel=1e-9)
    assert through_gas + 1.0 == pytest.approx(0.2 * (field.reservoirs["gas"] - 25.0), rel=1e-9)


def test_transient_reaches_the_steady_state() -> None:
    case = Conduction(
        section(), {"carcass": CARCASS, "tread": TREAD}, {"outside": Film(40.0, 20.0)},
        {"carcass": lambda x, t, T: 1e5 * np.exp(-0.0148 * (T - 25))},
    )  # fmt: skip
    history = case.transient([0, 40000], 25.0, 1e-3)
    steady = case.steady()
    assert history.values[-1] == pytest.approx(steady.values, abs=2e-3)
    assert history.field(-1).flux_through("outside") == pytest.approx(steady.flux_through("outside"), rel=1e-4)


def test_hottest_points() -> None:
    case = Conduction(section(), {"carcass": CARCASS, "tread": TREAD}, {"outside": Film(40.0, 20.0)}, {"carcass": heat})
    history = case.transient([0, 300, 600], 25.0)
    peak = history.maximum
    assert peak.temperature == pytest.approx(history.values.max())
    assert history.at([peak.point])[-1, 0] == pytest.approx(peak.temperature)
    assert history.region_maximum["carcass"].temperature == peak.temperature
    assert history.region_maximum["tread"].temperature < peak.temperature
    assert history.region_maximum["tread"].point[0] >= 0.2875 - 1e-9
