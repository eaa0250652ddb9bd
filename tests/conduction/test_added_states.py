"""States beside the temperatures: exact solutions, the order in time, and the same body as a reservoir."""

from __future__ import annotations

import numpy as np
import pytest
import skfem

from tyrefem.conduction import Conduction, Film, Flux, Material, Reservoir
from tyrefem.conduction.added_states import AddedStates
from tyrefem.conduction.rosenbrock import Step
from tyrefem.conduction.sensitivity import Perturbed, tangents
from tyrefem.conduction.stage_matrix import StageMatrices
from tyrefem.conduction.terms import State
from tyrefem.errors import InputError

TIMES = np.linspace(0.0, 600.0, 13)


class Shown:
    """The states as data functions see them."""

    def __init__(self) -> None:
        self.z = np.zeros(0)

    def show(self, z: np.ndarray) -> None:
        """From now on z."""
        self.z = z


def slab(states: AddedStates | None, boundaries: dict | None = None, **more: object) -> Conduction:
    """A slab of 10 mm of rubber, insulated unless told otherwise."""
    mesh = skfem.MeshQuad.init_tensor(np.linspace(0.0, 0.01, 7), [0.0, 0.01])
    mesh = mesh.with_subdomains({"rubber": lambda x: x[0] > -1}).with_boundaries(
        {"face": lambda x: x[0] > 0.00999, "back": lambda x: x[0] < 1e-5}
    )
    return Conduction(mesh, {"rubber": Material(0.25, 2e6)}, boundaries, axisymmetric=False, states=states, **more)


def alone(rate, initial, scale=1.0) -> AddedStates:
    """States that nothing depends on."""
    initial = np.atleast_1d(np.asarray(initial, dtype=float))
    return AddedStates(initial, np.full(initial.size, scale), rate, lambda z: None)


def test_an_exponential_and_a_logistic_curve_are_met_within_the_tolerance() -> None:
    """dz/dt = -z / 80 s and dz/dt = z (1 - z / 50) / 60 s, exact solutions known; one fast, one nonlinear."""
    states = alone(lambda t, z, T: np.array([-z[0] / 80.0, z[1] * (1 - z[1] / 50.0) / 60.0]), [100.0, 1.0])
    decay, grown = slab(states).transient(TIMES, 25.0, 0.01).states.T
    assert decay == pytest.approx(100.0 * np.exp(-TIMES / 80.0), abs=0.01)
    assert grown == pytest.approx(50.0 / (1 + 49.0 * np.exp(-TIMES / 60.0)), abs=0.01)


def test_the_scale_says_how_exact_a_state_is() -> None:
    """A film of water in kg/m2 is small in number: its error is held by its own scale."""
    exact = 0.05 * np.exp(-TIMES / 80.0)
    states = alone(lambda t, z, T: -z / 80.0, 0.05, scale=1e-3)
    coarse, fine = (slab(states).transient(TIMES, 25.0, tolerance).states[:, 0] for tolerance in (0.1, 0.001))
    assert np.abs(coarse - exact).max() < 0.1 * 1e-3
    assert np.abs(fine - exact).max() < 0.001 * 1e-3
    assert np.abs(fine - exact).max() < 0.1 * np.abs(coarse - exact).max()


def test_a_stiff_decay_does_not_shorten_the_steps() -> None:
    """A time constant of 10 ms that follows a slow one: dz/dt = (sin(t / 200 s) - z) / 0.01 s."""
    fast = slab(alone(lambda t, z, T: (np.sin(t / 200.0) - z) / 0.01, 0.0)).transient(TIMES, 25.0, 0.01)
    assert fast.states[:, 0] == pytest.approx(np.sin(TIMES / 200.0), abs=0.01)
    assert fast.steps.accepted < 200


H, AREA, HEAT = 60.0, 0.01, 40.0


def as_state() -> Conduction:
    """A body of 40 J/K behind a film at the face, its temperature a state."""
    shown = Shown()
    states = AddedStates(
        np.array([90.0]), np.ones(1), lambda t, z, T: H * AREA * (T.surface("face") - z) / HEAT, shown.show
    )
    return slab(states, {"face": Film(H, lambda x, t: float(shown.z[0])), "back": Flux(lambda x, t: 200.0 * t / 600.0)})


def as_reservoir() -> Conduction:
    """The same body as a reservoir."""
    film = {"face": Film(H, "body"), "back": Flux(lambda x, t: 200.0 * t / 600.0)}
    return slab(None, film, reservoirs={"body": Reservoir(HEAT, 90.0)})


def test_a_body_as_a_state_is_the_body_as_a_reservoir() -> None:
    """Two formulations of one problem, coupled both ways; the reservoir is in the matrices, the state in functions."""
    state, reservoir = as_state().transient(TIMES, 25.0, 1e-3), as_reservoir().transient(TIMES, 25.0, 1e-3)
    assert state.states[:, 0] == pytest.approx(reservoir.reservoirs["body"], abs=2e-3)
    assert np.abs(state.values - reservoir.values).max() < 2e-3


def test_what_a_state_gives_the_body_takes_up() -> None:
    """Flux in = heat stored in the slab + heat stored in the state."""
    history = as_state().transient(TIMES, 25.0, 1e-4)
    flux = 200.0 * AREA * TIMES**2 / 2 / 600.0
    stored = history.budget.stored["rubber"] + HEAT * (history.states[:, 0] - 90.0)
    assert stored == pytest.approx(flux, abs=1e-4 * flux[-1])
    assert history.budget.imbalance < 1e-9


@pytest.mark.parametrize("nonlinear", [False, True])
def test_states_and_temperatures_converge_together_with_third_order(nonlinear) -> None:
    """Fixed steps. A film that a state thickens, whose growth depends on the temperature of the surface."""
    shown = Shown()

    def rate(t, z, T):
        wear = (T.surface("face") - 25.0) / 500.0
        return wear - (z**2 if nonlinear else z) / 100.0

    states = AddedStates(np.array([1.0]), np.array([1.0]), rate, shown.show)
    film = Film(lambda x, t: 40.0 + 30.0 * float(shown.z[0]), lambda x, t: 25.0 + 0.2 * t)
    problem = slab(states, {"face": film})

    def end(steps: int) -> np.ndarray:
        balance = problem._balance()
        y = State(np.full(problem.operators.size, 60.0), states.initial.copy())
        balance.freeze(0.0, y)
        matrices, h = StageMatrices(), 160.0 / steps
        for i in range(steps):
            step = Step(balance, i * h, h, y)
            step.run(matrices.get(balance, h), 0.0, 160.0)
            y = step.at(1.0)
        return np.concatenate((y.u, 10.0 * y.g))

    reference = end(640)
    coarse, fine = (np.abs(end(steps) - reference).max() for steps in (80, 160))
    assert np.log2(coarse / fine) > 2.7
    assert fine < 1e-4


def test_what_cannot_follow_a_state_says_so() -> None:
    problem = slab(alone(lambda t, z, T: -z, 1.0), {"face": Film(H, 25.0)})
    with pytest.raises(InputError, match="transient only"):
        problem.steady()
    times = np.array([0.0, 1.0, 2.0])
    with pytest.raises(InputError, match="have no tangents"):
        tangents(problem, times, np.zeros((3, problem.operators.size)), np.zeros((3, 1)), [Perturbed(problem, 1.0)])
