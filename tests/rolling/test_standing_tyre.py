"""The standing tyre pushed along the road: moduli of small strain, amplitudes of a push, motion of the section."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping

import numpy as np
import pytest

from tyrefem import study
from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.compliance import TreadCompliance
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.example_tyre import PlainTyre
from tyrefem.mechanics.rolling.contact_body import ContactBody
from tyrefem.mechanics.rolling.lossy_harmonics import LossyHarmonics
from tyrefem.mechanics.rolling.roll import wheel_on_road
from tyrefem.mechanics.rolling.rolling_motion import RollingMotion
from tyrefem.mechanics.rolling.standing import StandingTyre, as_it_rolls, standing_stiffness
from tyrefem.mechanics.rolling.steady_rolling import RollingLoads, SteadyRolling
from tyrefem.mechanics.rolling.tread_influence import PHASE, TreadInfluence

HARMONICS = 20


@functools.lru_cache(1)
def tyre() -> StandingTyre:
    wheel = wheel_on_road(study("passenger-205-55r16", {"mesh.size": "20 mm"}), load=3000.0)
    return StandingTyre(wheel.pressed, wheel.free(HARMONICS))


def test_small_strains_meet_stiff_rubber() -> None:
    small, larger, large = (tyre().stiffness(amplitude) for amplitude in (1e-3, 1e-2, 0.1))
    assert small.longitudinal > 1.02 * larger.longitudinal > 1.1 * large.longitudinal
    assert small.lateral > larger.lateral > 1.05 * large.lateral


def test_the_amplitude_of_the_cards_is_their_modulus() -> None:
    """There the stiffness is that of the compliance in which the tyre rolls."""
    rolled = tyre().rolled
    body = ContactBody(rolled.grid.compliance(rolled.axes), rolled.grid.upstream)
    rolls = standing_stiffness(body, rolled.contact.states)
    stands = tyre().stiffness({region: law.modulus_amplitude for region, law in tyre().laws.items()})
    assert as_it_rolls(rolled) == rolls
    assert stands.longitudinal == pytest.approx(rolls.longitudinal, rel=1e-9)
    assert stands.lateral == pytest.approx(rolls.lateral, rel=1e-9)


def test_a_longer_push_meets_softer_rubber(monkeypatch: pytest.MonkeyPatch) -> None:
    made, points = [], StandingTyre._points

    def noted(stands: StandingTyre, amplitudes: Mapping[str, float]) -> TreadInfluence:
        made.append(tuple(amplitudes.items()))
        return points(stands, amplitudes)

    monkeypatch.setattr(StandingTyre, "_points", noted)
    softest, stiffest = tyre().stiffness(0.1).longitudinal, tyre().stiffness(1e-5).longitudinal
    short, strains = tyre().pushed(1e-5, 0)
    longer, strained = tyre().pushed(2e-3, 0)
    assert short == pytest.approx(stiffest, rel=0.01)
    assert softest < longer < 0.97 * short
    # A sidewall 0.1 m long is sheared by about a hundredth per millimetre.
    assert 0.003 < strained["sidewall"] < 0.05
    assert strains["sidewall"] < 2e-4
    # A pass asks for stiffness and strains of one compliance, which takes seconds.
    assert len(made) == len(set(made)) > 2


def test_a_push_is_positive_and_an_amplitude_too() -> None:
    with pytest.raises(InputError, match="more than 0 mm"):
        tyre().pushed(0.0, 1)
    with pytest.raises(InputError, match="more than 0 to 100 %"):
        tyre().stiffness(0.0)


@pytest.mark.parametrize(("half", "tangent"), [(True, None), (True, 0.2), (False, None)])
def test_the_section_moves_the_tread_as_its_compliance_does(half: bool, tangent: float | None) -> None:
    state = PlainTyre(half=half).state(along=6)
    pressing, points = Pressing(state), None
    if tangent is not None:
        lossy = LossyHarmonics(state, angular_speed=50.0, tangents=lambda _: np.full(len(state.bulk), tangent))
        points = TreadInfluence(TreadCompliance(lossy))
    loads = RollingLoads(load=3000.0, torque=-200.0)
    rolling = SteadyRolling(pressing, math.radians(2.0), 1.0, points)
    rolled = rolling.roll(RollingMotion(0.03), loads, HARMONICS, guess=(0.02, 0.314))
    grid, fields = rolled.grid, rolled.fields
    nodes, signs = grid.influence.source
    n = np.arange(HARMONICS + 1)
    smooth = np.sinc(n * grid.step / (2 * np.pi)) ** 2
    turn = smooth[:, None] * np.exp(1j * np.multiply.outer(n, grid.angles))
    dofs = 3 * grid.influence.tread.nodes[nodes] + np.arange(3)[:, None]
    right = np.where(signs > 0, 0, len(fields.sides) - 1)
    amplitudes = np.stack([side[:, dofs] for side in fields.sides])[right, :, :, np.arange(len(nodes))]
    moved = np.einsum("nj,mnc->jmc", turn, amplitudes * PHASE).real
    moved[..., 1] *= np.where(signs < 0, -1.0, 1.0) if half else 1.0
    ours = np.einsum("jmc,jcx->jmx", moved, grid.wheel_axes).reshape(-1, 3)
    assert np.abs(ours - rolled.moved).max() < 1e-5 * np.abs(rolled.moved).max()
