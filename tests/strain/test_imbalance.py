"""The balance of a tyre with another stiffness keeps what the nearby balance left: differences are right, though both
balances are loose."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.example_tyre import PlainTyre
from tyrefem.mechanics.footprint.footprint import Footprint
from tyrefem.mechanics.footprint.harmonic_balance import Balance
from tyrefem.mechanics.footprint.imbalance import Imbalance
from tyrefem.mechanics.footprint.nearby_balance import nearby_balance
from tyrefem.mechanics.footprint.road import Road

LOAD, TIGHT, LOOSE = 2500.0, 3e-5, 5e-3
#: Of motion and contact.
HARMONICS = (12, 12)
ROADS = (Road(), Road(drum_diameter=1.7))
Stiff = Callable[[float, Road], Pressing]


@pytest.fixture(scope="module")
def pressing() -> Stiff:
    """A plain tyre with a factor of its moduli, on a road."""
    state = PlainTyre().state(along=14)

    def stiff(factor: float, road: Road) -> Pressing:
        return Pressing(replace(state, tangent=factor * state.tangent), road)

    return stiff


def change(near: Footprint, far: Footprint) -> np.ndarray:
    assert near.balanced is not None
    assert far.balanced is not None
    return np.asarray(far.balanced - near.balanced)


@pytest.mark.parametrize("road", ROADS)
@pytest.mark.parametrize("given", ["load", "deflection"])
def test_a_loose_change_is_the_difference_of_tight_balances(pressing: Stiff, road: Road, given: str) -> None:
    soft, hard = pressing(1.0, road), pressing(1.1, road)
    loose = Balance(soft, *HARMONICS, LOOSE).solve(load=LOAD, tolerance=0.0)
    tight = Balance(soft, *HARMONICS, TIGHT).solve(load=LOAD, tolerance=0.0)
    wanted = {given: getattr(loose, given)}
    changed = nearby_balance(Balance(hard, *HARMONICS, 1e-3), loose, **wanted)
    exact = Balance(hard, *HARMONICS, TIGHT).solve(**{given: getattr(tight, given)}, tolerance=0.0)
    assert changed is not None
    assert getattr(changed, given) == pytest.approx(wanted[given], rel=1e-9)
    expected = change(tight, exact)
    assert np.abs(change(loose, changed) - expected).max() < 0.025 * np.abs(expected).max()
    stiffer = exact.load - tight.load, tight.deflection - exact.deflection
    assert (changed.load - loose.load, loose.deflection - changed.deflection) == pytest.approx(stiffer, rel=0.03)


def test_gaps_go_over_to_another_number_of_angles() -> None:
    left = Imbalance(np.zeros((2, 6)), np.array([[1.0, 2.0], [3.0, 4.0]]), 0.0)
    assert left.gaps_at(3).tolist() == [1.0, 2.0, 3.0, 4.0, 0.0, 0.0]
    assert left.gaps_at(1).tolist() == [1.0, 2.0]
