"""Harmonic balance: Green's strains, frame indifference, the linear limit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from footprint_bodies import half_torus

from tyrefem.api import study
from tyrefem.errors import InputError
from tyrefem.geometry.meshing import build
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.elements import WheelAngles
from tyrefem.mechanics.footprint.example_tyre import PlainTyre, pressurised, stress_free
from tyrefem.mechanics.footprint.harmonic_balance import Balance
from tyrefem.mechanics.footprint.harmonics import Harmonics
from tyrefem.mechanics.footprint.large_motion import DeflectedState, LargeMotion
from tyrefem.mechanics.footprint.nonlinear import NonlinearForces
from tyrefem.mechanics.footprint.pressed_tyre import element_size
from tyrefem.mechanics.footprint.rotations import Rotations
from tyrefem.mechanics.footprint.strain_harmonics import StrainHarmonics
from tyrefem.mechanics.footprint.taut_tyre import TautTyre, tautened
from tyrefem.mechanics.solid.inflation import inflate


@pytest.fixture(scope="module")
def tyre() -> Pressing:
    return Pressing(PlainTyre().state(along=8))


def test_an_inflated_torus_turned_by_a_large_angle_stays_in_balance() -> None:
    """Rotation by 0.4 rad about a diameter: harmonics 0, 1, 2; linear and nonlinear forces and pressure cancel."""
    torus = Harmonics(pressurised(stress_free(half_torus(around=10, through=1), 1e6, 1e8, fixed=()), 2e5))
    r, z = torus.elements.nodes
    zero, c, s = np.zeros_like(r), np.cos(0.4) - 1, np.sin(0.4)
    u = np.zeros((5, torus.elements.n_dofs))
    u[0] = np.stack([c * r / 2, c * z, zero], axis=1).ravel()
    u[1] = np.stack([-s * z, s * r, s * z], axis=1).ravel()
    u[2] = np.stack([c * r / 2, zero, -c * r / 2], axis=1).ravel()
    linear = np.stack([torus.stiffness(n) @ part for n, part in enumerate(u)])
    outside = NonlinearForces(torus, 4)
    total = (linear + outside(u)).reshape(5, -1, 3)
    inside = np.abs(z) > 1e-9  # the mid plane is the other half's edge
    assert np.abs(total[:, inside]).max() < 1e-9 * np.abs(linear).max()
    e = np.stack([torus.elements.strain(n, part) for n, part in enumerate(u)]) + outside.second_strains(u)
    assert np.abs(e).max() < 1e-12


def test_nonlinear_forces_begin_at_second_order(tyre: Pressing) -> None:
    u = tyre.at_deflection(0.01, 12).amplitudes
    outside = NonlinearForces(tyre.harmonics, 12)
    sizes = [np.abs(outside(scale * u)).max() for scale in (1e-3, 2e-3)]
    assert sizes[1] == pytest.approx(4 * sizes[0], rel=0.02)


def test_nonlinear_forces_have_a_potential(tyre: Pressing) -> None:
    """v dg(u) w = w dg(u) v, work taken round the wheel: twice as much for n = 0."""
    outside = NonlinearForces(tyre.harmonics, 6)
    u = 0.5 * tyre.at_deflection(0.01, 6).amplitudes
    rng = np.random.default_rng(3)
    v, w = 1e-4 * rng.normal(size=(2, *u.shape))
    for x in (u, v, w):
        x[:, tyre.harmonics.held] = 0.0
        x.reshape(7, -1, 3)[0, :, 2] = 0.0
    share = np.ones((7, 1))
    share[0] = 2.0

    def slope(along: np.ndarray) -> np.ndarray:
        return (outside(u + 1e-4 * along) - outside(u - 1e-4 * along)) / 2e-4

    assert (share * v * slope(w)).sum() == pytest.approx((share * w * slope(v)).sum(), rel=1e-5)


def test_balance_is_the_linear_footprint_at_small_deflection_and_softer_at_large(tyre: Pressing) -> None:
    balance = Balance(tyre, 16, 16)
    ratios = {}
    for deflection in (0.0025, 0.008):
        footprint = balance.at_deflection(deflection)
        ratios[deflection] = footprint.load / tyre.at_deflection(deflection, 16).load
        assert footprint.pressure_integral == pytest.approx(footprint.load, rel=1e-12)
        assert footprint.gaps.min() > -1e-9
    assert ratios[0.0025] == pytest.approx(1.0, abs=0.05)
    assert 0.8 < ratios[0.008] < 0.98


def test_balanced_forces_leave_no_residual(tyre: Pressing) -> None:
    balance = Balance(tyre, 16, 16, tolerance=1e-6)
    footprint = balance.at_deflection(0.006)
    u = footprint.amplitudes
    inner = np.stack([tyre.harmonics.stiffness(n) @ part for n, part in enumerate(u)]) + balance.motion.nonlinear(16)(u)
    outer = np.zeros_like(inner)
    outer[:, tyre.tread.dofs.ravel()] = footprint.load_harmonics.reshape(17, -1)
    free = tyre.harmonics.free
    assert np.abs((inner - outer)[:, free]).max() < 1e-3 * np.abs(outer).max()


def test_balance_under_a_load(tyre: Pressing) -> None:
    footprint = Balance(tyre, 12, 12).at_load(600.0)
    assert footprint.load == pytest.approx(600.0, rel=1e-3)
    assert footprint.deflection > tyre.at_load(600.0, 12).deflection
    assert np.isfinite(StrainHarmonics(footprint).amplitudes).all()


def test_balances_are_those_of_exact_newton_steps(tyre: Pressing) -> None:
    """Numbers of an earlier solver with another preconditioner: the way must not alter the end."""
    balance = Balance(tyre, 12, 12, tolerance=1e-7)
    at_deflection, at_load = balance.at_deflection(0.012), balance.at_load(1000.0)
    assert at_deflection.load == pytest.approx(1394.5054469, rel=1e-6)
    assert at_deflection.work == pytest.approx(6.4258098408, rel=1e-6)
    assert at_deflection.area == pytest.approx(0.0080601363466, rel=1e-6)
    assert at_deflection.rolling_radius == pytest.approx(0.31523842578, rel=1e-6)
    assert at_load.deflection == pytest.approx(0.00944257174, rel=1e-6)
    assert at_load.area == pytest.approx(0.0068355106879, rel=1e-6)
    assert at_load.stiffness == pytest.approx(154168.03, rel=1e-5)


def test_contact_harmonics_beyond_the_motion_s_resolve_the_footprint(tyre: Pressing) -> None:
    """At a small deflection it is the linear footprint; length and area hardly depend on the motion's harmonics."""
    small = Balance(tyre, 12, 60).at_deflection(0.002)
    linear = tyre.at_deflection(0.002, 60)
    assert (small.harmonics, len(small.balanced), len(small.amplitudes)) == (60, 13, 61)
    assert small.load == pytest.approx(linear.load, rel=0.05)
    assert small.area == pytest.approx(linear.area, rel=0.05)
    few, many = (Balance(tyre, harmonics, 120).at_deflection(0.02) for harmonics in (24, 36))
    for name, share in (("load", 0.01), ("length", 0.02), ("area", 0.02)):
        assert getattr(few, name) == pytest.approx(getattr(many, name), rel=share), name
    assert np.isfinite(StrainHarmonics(few).amplitudes).all()


def test_rotations_are_those_of_the_motion_and_turn_back_as_the_transpose() -> None:
    """A torus turned by 0.4 rad about a diameter: R is that rotation everywhere; forward and backward do equal work."""
    torus = Harmonics(pressurised(stress_free(half_torus(around=10, through=1), 1e6, 1e8, fixed=()), 2e5))
    around = WheelAngles(torus.elements, 8)
    r, z = torus.elements.nodes
    zero, c, s = np.zeros_like(r), np.cos(0.4) - 1, np.sin(0.4)
    u = np.zeros((9, torus.elements.n_dofs))
    u[0] = np.stack([c * r / 2, c * z, zero], axis=1).ravel()
    u[1] = np.stack([-s * z, s * r, s * z], axis=1).ravel()
    u[2] = np.stack([c * r / 2, zero, -c * r / 2], axis=1).ravel()
    rotations = Rotations.of(around, u, np.zeros(0, dtype=np.int64))
    angle = np.arccos((np.trace(rotations.matrices) - 1) / 2)
    assert angle == pytest.approx(0.4, abs=1e-9)
    rng = np.random.default_rng(6)
    force, motion = rng.normal(size=(2, *u.shape))
    for field in (force, motion):
        field.reshape(9, -1, 3)[0, :, 2] = 0.0  # sin 0
    work = TautTyre.work
    assert work(force, rotations.forward(motion)) == pytest.approx(work(rotations.backward(force), motion), rel=1e-12)


def test_the_taut_tyre_is_never_softer(tyre: Pressing) -> None:
    """Slack cords count as taut; a state without cords is not altered."""
    bias = study("nasa-22x5.5-8pr")
    state = inflate(bias, None, build(bias.section, size=18e-3, through=1)).state
    added = np.moveaxis(tautened(state).tangent - state.tangent, (0, 1), (-2, -1))
    scale = np.abs(state.tangent).max()
    assert np.linalg.eigvalsh(added).min() > -1e-9 * scale
    assert added.max() > 1e-3 * scale
    assert tautened(replace(state, law=None)).tangent is state.tangent
    assert tautened(tyre.state) is tyre.state


def test_out_of_reach_says_how_far_it_got(tyre: Pressing) -> None:
    with pytest.raises(InputError, match=r"reaches .* mm \(.* N\), not 90 mm.*; mechanics.motion = .linear. is"):
        Balance(tyre, 8, steps=1).at_deflection(0.09)


def test_a_deflection_whose_last_bit_is_rounded_is_reached(tyre: Pressing) -> None:
    """Load steps add up to a deflection only within rounding."""

    class Rounded(LargeMotion):
        def balance(
            self, start: DeflectedState, deflection: float, tolerance: float, load: float | None = None
        ) -> DeflectedState:
            return replace(start, deflection=float(np.nextafter(deflection, 0)), load=1.0)

    balance = Balance(tyre, 6, 12)
    balance.__dict__["motion"] = Rounded(tyre)
    reached = balance._load_steps(0.01, None, 6)
    assert reached.deflection == pytest.approx(0.01, rel=1e-12)
    assert len(balance.path) == 2


def test_nine_node_elements_are_larger_than_the_mesh_but_not_where_it_is_coarse() -> None:
    """2.5 times, then 1/18 of the meridian, then twice; never smaller for a coarser mesh."""
    section = study("nasa-22x5.5-8pr").section
    limit = section.line.length / 18
    sizes = [element_size(section, share * limit) for share in (0.1, 0.4, 0.45, 0.5, 1.0)]
    assert [size / limit for size in sizes] == pytest.approx([0.25, 1.0, 1.0, 1.0, 2.0])
    assert sizes == sorted(sizes)
