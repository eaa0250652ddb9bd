"""Elements that fold on the way to a balance: convex stiffness there, and nowhere else."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.example_tyre import PlainTyre
from tyrefem.mechanics.footprint.folding import FoldingElements
from tyrefem.mechanics.footprint.harmonic_balance import Balance
from tyrefem.mechanics.footprint.large_motion import DeflectedState
from tyrefem.mechanics.footprint.nonlinear import NonlinearForces, Tangent

N = 4


@pytest.fixture(scope="module")
def pressing() -> Pressing:
    return Pressing(PlainTyre().state(along=6))


@pytest.fixture(scope="module")
def folded(pressing: Pressing) -> Tangent:
    """A rough motion in which some elements have negative energies."""
    return NonlinearForces(pressing.harmonics, N).at(2e-4 * change(pressing, 1))


def change(pressing: Pressing, seed: int) -> np.ndarray:
    """Random amplitudes that hold what is held."""
    u = np.random.default_rng(seed).normal(size=(N + 1, pressing.harmonics.elements.n_dofs))
    u[:, pressing.harmonics.held] = 0.0
    return u


def softest(tangent: Tangent, pressing: Pressing) -> np.ndarray:
    """Of random changes the one with the least energy in an element."""
    changes = [change(pressing, seed) for seed in range(2, 12)]
    return min(changes, key=lambda u: tangent.energies(u).min())


def test_energies_are_those_of_the_product(folded: Tangent, pressing: Pressing) -> None:
    """Their sum over elements and angles is the work of the product; the ends of the half turn count half."""
    u = change(pressing, 20)
    round_wheel = folded.outside.round
    inside = round_wheel.forces(folded.response.product(round_wheel.gradient(u)))
    weights = np.ones(len(round_wheel.angles))
    weights[[0, -1]] = 0.5
    mean = float(folded.energies(u).sum(axis=0) @ weights) / (len(weights) - 1)
    work = (float(np.vdot(u, inside)) + float(np.vdot(u[0], inside[0]))) / 2
    assert mean == pytest.approx(work, rel=1e-9)


def test_convex_elements_have_no_negative_energy_and_others_are_as_before(folded: Tangent, pressing: Pressing) -> None:
    u = softest(folded, pressing)
    before = folded.energies(u)
    assert before.min() < 0
    flagged = before < 0
    after = folded.convex(flagged).energies(u)
    assert after[flagged].min() >= 0
    np.testing.assert_array_equal(after[~flagged], before[~flagged])
    assert folded.convex(np.zeros_like(flagged)) is folded


def test_a_convex_stiffness_stays_as_it_is(pressing: Pressing) -> None:
    """Turning signs twice changes nothing more."""
    outside = NonlinearForces(pressing.harmonics, N)
    tangent = outside.at(2e-4 * change(pressing, 1))
    flagged = np.ones_like(tangent.energies(change(pressing, 3)), dtype=bool)
    once = tangent.convex(flagged)
    twice = once.convex(flagged)
    scale = np.abs(once.response.tangent).max()
    np.testing.assert_allclose(twice.response.tangent, once.response.tangent, atol=1e-9 * scale)


def test_folding_elements_are_kept_and_reach_round_the_contact(folded: Tangent, pressing: Pressing) -> None:
    folding = FoldingElements()
    assert not folding
    assert folding.convex(folded) is folded
    u = softest(folded, pressing)
    assert folding.add(folded, u)
    assert not folding.add(folded, u)
    energies = folding.convex(folded).energies(u)
    assert energies.min() >= 1e-3 * folded.energies(u).min()
    assert ((folding.reach >= 0) & (folding.reach <= 1)).all()


def test_the_balance_does_not_depend_on_which_elements_are_convex(pressing: Pressing) -> None:
    """Where all elements are convex on the way, the balance is the same."""
    plain, convex = Balance(pressing, 12, 12, tolerance=1e-6), Balance(pressing, 12, 12, tolerance=1e-6)
    still = NonlinearForces(pressing.harmonics, 0).at(np.zeros((1, pressing.harmonics.elements.n_dofs)))
    convex.motion._folding.reach = np.ones(len(still.response.stress))
    first, second = plain.at_deflection(0.01), convex.at_deflection(0.01)
    assert second.load == pytest.approx(first.load, rel=1e-5)


def test_the_stiffness_of_a_folded_state_is_positive(pressing: Pressing) -> None:
    """The search for its rate breaks off at a negative stiffness; with convex elements it ends."""
    balance = Balance(pressing, 12, 12, tolerance=1e-4)
    footprint = balance.at_deflection(0.01)
    rough = 5e-5 * np.random.default_rng(1).normal(size=footprint.balanced.shape)
    rough[:, pressing.harmonics.held] = 0.0
    smooth = DeflectedState(0.01, footprint.balanced, footprint.grid, footprint.forces, footprint.load)
    assert balance.motion.stiffness(smooth) == pytest.approx(footprint.stiffness, rel=1e-3)
    assert not balance.motion._folding
    stiffness = balance.motion.stiffness(replace(smooth, motion=footprint.balanced + rough))
    assert balance.motion._folding
    # Roughness stretches the tyre, which makes it stiffer.
    assert footprint.stiffness < stiffness < 10 * footprint.stiffness
