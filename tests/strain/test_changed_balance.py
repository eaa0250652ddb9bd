"""The balance of a tyre with another stiffness keeps what the nearby balance left: differences are right, though both
balances are loose."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from tyrefem.mechanics.footprint.changed_balance import ChangedBalances, Imbalance
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.example_tyre import PlainTyre
from tyrefem.mechanics.footprint.footprint import Footprint
from tyrefem.mechanics.footprint.harmonic_balance import Balance
from tyrefem.mechanics.footprint.large_motion import DeflectedState, LargeMotion
from tyrefem.mechanics.footprint.nearby_balance import nearby_balance
from tyrefem.mechanics.footprint.road import Road

LOAD, TIGHT, LOOSE = 2500.0, 3e-5, 5e-3
#: Of motion and contact.
HARMONICS = (12, 12)
ROADS = (Road(), Road(drum_diameter=1.7))


@pytest.fixture(scope="module")
def pressing() -> Callable[[float, Road], Pressing]:
    """A plain tyre with a factor of its moduli, on a road."""
    state = PlainTyre().state(along=14)

    def stiff(factor: float, road: Road) -> Pressing:
        return Pressing(replace(state, tangent=factor * state.tangent), road)

    return stiff


def changed_by(near: Footprint, pressing: Pressing, load: float | None, accuracy: float) -> Footprint | None:
    """The footprint of another tyre, from a nearby one."""
    assert near.balanced is not None
    motion = LargeMotion(pressing)
    start = DeflectedState(near.deflection, near.balanced, near.grid, near.forces, near.load, near.rate)
    start = motion.refined(start, start.harmonics, near.harmonics)
    reached = ChangedBalances(near, accuracy).balance(motion, start, load)
    return None if reached is None else motion.footprint(reached)


def change(near: Footprint, far: Footprint) -> np.ndarray:
    assert near.balanced is not None
    assert far.balanced is not None
    return np.asarray(far.balanced - near.balanced)


@pytest.mark.parametrize("road", ROADS)
@pytest.mark.parametrize(
    ("given", "accuracy", "most"), [("load", 0.01, 0.03), ("deflection", 0.01, 0.03), ("load", 0.05, 0.1)]
)
def test_a_loose_change_is_the_difference_of_tight_balances(
    pressing: Callable[[float, Road], Pressing],
    road: Road,
    given: str,
    accuracy: float,
    most: float,
) -> None:
    soft, hard = pressing(1.0, road), pressing(1.1, road)
    loose = Balance(soft, *HARMONICS, LOOSE).solve(load=LOAD, tolerance=0.0)
    tight = Balance(soft, *HARMONICS, TIGHT).solve(load=LOAD, tolerance=0.0)
    wanted = {given: getattr(loose, given)}
    changed = changed_by(loose, hard, wanted.get("load"), accuracy)
    exact = Balance(hard, *HARMONICS, TIGHT).solve(**{given: getattr(tight, given)}, tolerance=0.0)
    assert changed is not None
    assert getattr(changed, given) == pytest.approx(wanted[given], rel=1e-9)
    expected = change(tight, exact)
    off = np.abs(change(loose, changed) - expected).max() / np.abs(expected).max()
    assert off < most
    stiffer = exact.load - tight.load, tight.deflection - exact.deflection
    assert (changed.load - loose.load, loose.deflection - changed.deflection) == pytest.approx(stiffer, rel=2 * most)
    if given == "deflection":  # what two balances, each from the free tyre, are off by is larger
        anew = Balance(hard, *HARMONICS, LOOSE).solve(**wanted, tolerance=0.0)
        assert np.abs(change(loose, anew) - expected).max() / np.abs(expected).max() > 2 * off


def test_a_tyre_of_the_same_stiffness_stays_where_it_is(pressing: Callable[[float, Road], Pressing]) -> None:
    """With what a balance left, it is a balance; without, the search would go on."""
    soft = pressing(1.0, Road())
    loose = Balance(soft, *HARMONICS, LOOSE).solve(load=LOAD, tolerance=0.0)
    kept = Imbalance.of(loose)
    assert np.abs(kept.forces).max() > 0
    nearly = pressing(1.0 + 1e-9, Road())
    changed = nearby_balance(Balance(nearly, *HARMONICS, LOOSE), loose, load=loose.load)
    assert changed is not None
    assert loose.balanced is not None
    assert np.abs(change(loose, changed)).max() < 1e-6 * np.abs(loose.balanced).max()


def test_a_change_without_convergence_is_searched_for_as_another_balance(
    pressing: Callable[[float, Road], Pressing],
) -> None:
    loose = Balance(pressing(1.0, Road()), *HARMONICS).solve(load=LOAD, tolerance=0.0)
    much_softer = pressing(0.2, Road())
    assert changed_by(loose, much_softer, LOAD, 0.05) is None
    near = nearby_balance(Balance(much_softer, *HARMONICS), loose, load=LOAD)
    far = Balance(much_softer, *HARMONICS).solve(load=LOAD, tolerance=0.0)
    assert near is not None
    assert near.deflection == pytest.approx(far.deflection, rel=2e-3)
