"""NAFEMS thermal benchmarks T2 and T3, through the public interface."""

from __future__ import annotations

import numpy as np
import pytest
import skfem

from tyrefem.conduction import Conduction, Fixed, Material, Radiation

pytestmark = pytest.mark.fast


def bar(n: int, cls: type = skfem.MeshTri):
    mesh = cls.init_tensor(np.linspace(0.0, 0.1, n + 1), np.linspace(0.0, 0.01, 3))
    return mesh.with_subdomains({"bar": np.arange(mesh.t.shape[1])}).with_boundaries(
        {"cold": lambda x: x[0] < 1e-9, "driven": lambda x: x[0] > 0.1 - 1e-9}
    )


@pytest.mark.parametrize(("element", "n"), [("P1", 100), ("P2", 20)])
def test_t3_transient_conduction_in_a_bar(element: str, n: int) -> None:
    """Printed target 36.60 degC; the series solution gives 36.603."""
    problem = Conduction(
        bar(n),
        {"bar": Material(conductivity=35.0, heat_capacity=7200 * 440.5)},
        {"cold": Fixed(0.0), "driven": Fixed(lambda x, t: 100 * np.sin(np.pi * t / 40))},
        axisymmetric=False,
        element=element,
    )
    history = problem.transient([0.0, 32.0], initial=0.0, tolerance=0.001)
    assert history.at([(0.08, 0.005)])[-1, 0] == pytest.approx(36.603, abs=0.01)
    assert history.budget.imbalance < 1e-9


@pytest.mark.parametrize("cls", [skfem.MeshTri, skfem.MeshQuad])
@pytest.mark.parametrize("element", ["P1", "P2"])
def test_t2_radiation_at_the_end_of_a_bar(element: str, cls: type) -> None:
    """Printed target 927 K; the quartic gives 926.97 K."""
    problem = Conduction(
        bar(10, cls),
        {"bar": Material(conductivity=55.563, heat_capacity=7850 * 460.0)},
        {"cold": Fixed(1000 - 273.15), "driven": Radiation(emissivity=0.98, surroundings=300 - 273.15)},
        axisymmetric=False,
        element=element,
    )
    field = problem.steady()
    end = field.at([(0.1, 0.0)])[0] + 273.15
    assert end == pytest.approx(926.97, abs=0.01)
    radiated = 0.98 * 5.67e-8 * (end**4 - 300.0**4) * 0.01
    assert field.flux_through("driven") == pytest.approx(radiated, rel=1e-9)
    assert field.flux_through("cold") == pytest.approx(-radiated, rel=1e-9)
