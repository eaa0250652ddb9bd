"""The system of equations against scikit-fem's own assembly, and against what must hold of it."""

from __future__ import annotations

import numpy as np
import pytest
import skfem
from skfem.helpers import dot, grad

from tyrefem.conduction import Conduction, Convection, Film, Flux, Material, Radiation, Reservoir
from tyrefem.conduction.equation import System
from tyrefem.conduction.terms import State

pytestmark = pytest.mark.fast

WIDTH, DEPTH = 0.05, 0.02
K, C, H, GAS = (0.5, 0.2), 2e6, 30.0, 12.0


def direction(x):
    """Unit vectors that turn with the place."""
    angle = 0.3 + 5.0 * x[1]
    return np.stack([np.cos(angle), np.sin(angle)])


def ring(kind: type = skfem.MeshTri):
    """A ring of rectangular section."""
    mesh = kind.init_tensor(np.linspace(0.3, 0.3 + WIDTH, 7), np.linspace(0.0, DEPTH, 4))
    return mesh.with_subdomains({"body": lambda x: x[0] > 0}).with_boundaries(
        {"inside": lambda x: x[0] < 0.3001, "outside": lambda x: x[0] > 0.3499, "top": lambda x: x[1] > 0.0199}
    )


def frozen(problem: Conduction, t: float = 0.0, y: State | None = None) -> System:
    """The problem's system, assembled at a state."""
    system = problem._balance()
    system.freeze(t, uneven(problem) if y is None else y)
    return system


def uneven(problem: Conduction, shift: float = 0.0) -> State:
    """A smooth state that is even in no direction."""
    x, y = problem.operators.points
    return State(40.0 + shift + 300.0 * (x - 0.3) - 900.0 * y, np.full(len(problem.reservoirs), 35.0) + shift)


@pytest.mark.parametrize("axisymmetric", [True, False])
@pytest.mark.parametrize("element", ["P1", "P2"])
@pytest.mark.parametrize("kind", [skfem.MeshTri, skfem.MeshQuad])
def test_mass_stiffness_and_border_are_those_of_the_weak_form_in_scikit_fem(kind, element, axisymmetric) -> None:
    """Written out here once more, with the weight 2 pi r in the forms, and assembled by scikit-fem itself."""
    problem = Conduction(
        ring(kind),
        {"body": Material(K, C, direction)},
        {"inside": Film(GAS, "gas"), "outside": Film(lambda x, t: H + 100.0 * x[1], 20.0)},
        axisymmetric=axisymmetric,
        element=element,
        reservoirs={"gas": Reservoir(50.0, exchanges=((2.0, "rim"), (0.5, 20.0))), "rim": Reservoir(70.0)},
    )
    system, space = frozen(problem), problem.operators

    def around(w):
        return 2 * np.pi * w.x[0] if axisymmetric else 1.0

    def k_grad(T, v, w):
        d = direction(w.x.reshape(2, -1)).reshape(w.x.shape)
        across = np.stack([-d[1], d[0]])
        return sum(k * dot(e, grad(T)) * dot(e, grad(v)) for k, e in zip(K, (d, across), strict=True))

    cells = skfem.Basis(space.mesh, space.skfem_element, intorder=space.intorder)
    inside, outside = (
        skfem.FacetBasis(space.mesh, space.skfem_element, facets=name, intorder=space.intorder)
        for name in ("inside", "outside")
    )
    mass = skfem.BilinearForm(lambda T, v, w: around(w) * C * T * v).assemble(cells)
    stiffness = (
        skfem.BilinearForm(lambda T, v, w: around(w) * k_grad(T, v, w)).assemble(cells)
        + skfem.BilinearForm(lambda T, v, w: around(w) * GAS * T * v).assemble(inside)
        + skfem.BilinearForm(lambda T, v, w: around(w) * (H + 100.0 * w.x[1]) * T * v).assemble(outside)
    )
    row = skfem.LinearForm(lambda v, w: around(w) * GAS * v).assemble(inside)
    for ours, theirs in ((system.M, mass), (system.S, stiffness)):
        assert abs(ours - theirs).max() < 1e-12 * abs(theirs).max()
    assert system.B[:, 0] == pytest.approx(row, abs=1e-12 * row.max())
    assert not system.B[:, 1].any()
    assert pytest.approx(np.array([[row.sum() + 2.5, -2.0], [-2.0, 2.0]]), rel=1e-12) == system.D
    assert list(system.C) == [50.0, 70.0]


def nonlinear(element: str = "P1") -> Conduction:
    """Every term that depends on temperature."""
    return Conduction(
        ring(),
        {"body": Material(lambda T: (0.3 + 1e-3 * T, 0.5 + 2e-3 * T), lambda T: 2e6 + 3e3 * T, direction)},
        {
            "inside": [Film(GAS, "gas"), Radiation(0.9, 20.0)],
            "outside": Flux(lambda x, t, T: 500.0 - 0.02 * T**2, of_temperature=True),
            "top": Convection(lambda T: 3.0 * np.abs(T - 10.0) ** 0.25, 10.0),
        },
        {"body": lambda x, t, T: 1e5 * np.exp(-0.01 * (T - 25.0))},
        element=element,
        reservoirs={"gas": Reservoir(50.0, exchanges=((2.0, "rim"),)), "rim": Reservoir(70.0, power=3.0)},
    )


def whole(system: System, y: State) -> np.ndarray:
    """Heat into every unknown, W."""
    return np.concatenate(system.heat(0.0, y))


@pytest.mark.parametrize("element", ["P1", "P2"])
def test_the_jacobian_is_the_slope_of_the_heat(element) -> None:
    """Against central differences, in a random direction of all unknowns."""
    problem = nonlinear(element)
    y = uneven(problem)
    system, n = frozen(problem, y=y), y.u.size
    way = np.random.default_rng(3).normal(size=n + y.g.size)
    ahead, back = (State(y.u + s * way[:n], y.g + s * way[n:]) for s in (1e-3, -1e-3))
    slope = (whole(system, ahead) - whole(system, back)) / 2e-3
    assert -system.jacobian(0.0, y) @ way == pytest.approx(slope, rel=1e-5, abs=1e-6 * np.abs(slope).max())


def test_the_frozen_part_does_not_change_the_heat() -> None:
    """What is linear is a choice of the solver: the heat at one state is the same, frozen 60 K away or there."""
    problem = nonlinear()
    y = uneven(problem)
    here, far = frozen(problem, y=y), frozen(problem, y=uneven(problem, 60.0))
    assert abs(here.S - far.S).max() > 0.02 * abs(here.S).max()
    assert whole(far, y) == pytest.approx(whole(here, y), rel=1e-9, abs=1e-9)


def test_even_temperatures_without_sources_exchange_no_heat() -> None:
    """Films to reservoirs and exchanges among them take from one unknown what they give to another."""
    problem = Conduction(
        ring(),
        {"body": Material(K, C, direction)},
        {"inside": Film(GAS, "gas"), "outside": Film(H, "rim")},
        reservoirs={"gas": Reservoir(50.0, exchanges=((2.0, "rim"),)), "rim": Reservoir(70.0)},
    )
    even = State(np.full(problem.operators.size, 40.0), np.full(2, 40.0))
    system = frozen(problem, y=even)
    largest = abs(system.S).max() * 40.0
    assert np.abs(whole(system, even)).max() < 1e-12 * largest
    # And whatever the temperatures, what leaves one unknown arrives at another.
    assert abs(whole(system, uneven(problem)).sum()) < 1e-10 * largest
