"""The standing tyre pushed along the road: moduli of small strain, amplitudes of a push, motion of the section."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from tyrefem import study
from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.compliance import TreadCompliance
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.example_tyre import PlainTyre
from tyrefem.mechanics.footprint.harmonics import Harmonics
from tyrefem.mechanics.rolling.contact_body import ContactBody
from tyrefem.mechanics.rolling.friction import OPEN
from tyrefem.mechanics.rolling.loaded_tyre import TyreOnFootprint
from tyrefem.mechanics.rolling.lossy_harmonics import LossyHarmonics
from tyrefem.mechanics.rolling.pushed_contact import push_forces, pushed_body
from tyrefem.mechanics.rolling.rolling_motion import RollingMotion
from tyrefem.mechanics.rolling.standing import StandingTyre, as_it_rolls, standing_stiffness
from tyrefem.mechanics.rolling.steady_rolling import RollingLoads, SteadyRolling
from tyrefem.mechanics.rolling.stiffened_footprint import StiffenedOnFootprint
from tyrefem.mechanics.rolling.tread_influence import PHASE, TreadInfluence
from tyrefem.mechanics.rolling.wheel_on_road import wheel_on_road
from tyrefem.mechanics.solid.stiffened import stiffened

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


@functools.lru_cache(1)
def on_footprint() -> StandingTyre:
    """In large motion; its cards have one modulus."""
    wheel = wheel_on_road(study("nasa-22x5.5-8pr", {"mesh.size": "16 mm"}), load=6000.0, motion="large")
    return StandingTyre(wheel.pressed, wheel.free(54))


def test_a_push_meets_the_compliance_of_the_footprint() -> None:
    """Forces that push the inflated tyre's compliance by 1 push the footprint by more, sideways; those of the standing
    tyre push it by 1."""
    rolled = on_footprint().rolled
    grid, axes, states = rolled.grid, rolled.axes, rolled.contact.states
    assert grid.shape is not None
    assert grid.shape.loaded is not None
    tyre, points = grid.shape.loaded.tyre, grid.points_on_wheel()
    inflated = ContactBody(grid.compliance(axes), grid.upstream)

    def pushed(forces: np.ndarray) -> np.ndarray:
        """Displacement of the points along their axes: of the footprint in the harmonics of its motion."""
        vectors = np.einsum("kax,ka->kx", axes, forces).reshape(len(grid.angles), -1, 3)
        along = np.einsum("jpx,jcx->jcp", vectors, grid.wheel_axes)
        more = np.zeros_like(along)
        for family in tyre.families:
            loads = points.loads(family, along, len(tyre.motion))
            motion = family.of_loaded(loads)[:, family.tread] - family.of_inflated(loads)
            more += points.displacements(family, motion[None])[..., 0]
        low = np.tensordot(inflated.compliance, forces, axes=2)
        return (low + grid.along(axes, grid.from_wheel(more)))[states != OPEN]

    for direction, less in ((0, 0.0), (1, 0.04)):
        wanted = np.eye(3)[1 + direction]
        forces = push_forces(pushed_body(grid, axes, states, tyre), states)[direction]
        assert np.abs(pushed(forces) - wanted).max() < 0.02
        before = push_forces(inflated, states)[direction]
        # The work of the push, over what it would be without the footprint.
        work = (before[states != OPEN] * pushed(before)).sum() / before[:, 1 + direction].sum()
        assert work > 1 + less


def test_without_laws_of_strain_the_tyre_stands_as_it_rolls_in_large_motion() -> None:
    stands, rolls = on_footprint().stiffness(), as_it_rolls(on_footprint().rolled)
    assert stands.lateral == pytest.approx(rolls.lateral, rel=1e-3)
    assert stands.longitudinal == pytest.approx(rolls.longitudinal, rel=1e-3)
    rolled = on_footprint().rolled
    inflated = ContactBody(rolled.grid.compliance(rolled.axes), rolled.grid.upstream)
    assert stands.lateral < 0.96 * standing_stiffness(inflated, rolled.contact.states).lateral


def test_stiff_rubber_leaves_stresses_as_they_are() -> None:
    """Without motion the tangent is the stiffness of the stiffened state; with it, only moduli are added."""
    pressing = Pressing(PlainTyre().state(along=4))
    state, count = pressing.state, 3
    stiff = stiffened(state, np.full(state.bulk.shape, 1.7))
    rng = np.random.default_rng(1)
    change = rng.standard_normal((count, pressing.harmonics.elements.n_dofs))
    flat = pressing.at_deflection(0.01, 24)
    still = replace(flat, balanced=np.zeros_like(change))
    tangent = StiffenedOnFootprint(still, TreadInfluence(pressing.tread), stiff=stiff).tangent
    products = tangent.product(change)
    # Components that no wave of n = 0 has.
    for n in range(1, count):
        wanted = Harmonics(stiff).stiffness(n) @ change[n]
        assert np.abs(products[n] - wanted).max() < 1e-4 * np.abs(wanted).max()
    bent = replace(flat, balanced=1e-3 * rng.standard_normal(change.shape))
    same = StiffenedOnFootprint(bent, TreadInfluence(pressing.tread), stiff=stiffened(state, np.ones(state.bulk.shape)))
    assert (
        np.abs(same.tangent.product(change) - TyreOnFootprint(bent, same.influence).tangent.product(change)).max() == 0
    )


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
