"""Harmonic balance: Green's strains, frame indifference, the linear limit."""

from __future__ import annotations

import numpy as np
import pytest
from footprint_bodies import half_torus

from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.example_tyre import PlainTyre, pressurised, stress_free
from tyrefem.mechanics.footprint.harmonic_balance import Balance
from tyrefem.mechanics.footprint.harmonics import Harmonics
from tyrefem.mechanics.footprint.nonlinear import NonlinearForces
from tyrefem.mechanics.footprint.strain_harmonics import StrainHarmonics


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
    balance = Balance(tyre, 16)
    ratios = {}
    for deflection in (0.0025, 0.008):
        footprint = balance.at_deflection(deflection)
        ratios[deflection] = footprint.load / tyre.at_deflection(deflection, 16).load
        assert footprint.pressure_integral == pytest.approx(footprint.load, rel=1e-12)
        assert footprint.gaps.min() > -1e-12
    assert ratios[0.0025] == pytest.approx(1.0, abs=0.05)
    assert 0.8 < ratios[0.008] < 0.98


def test_balanced_forces_leave_no_residual(tyre: Pressing) -> None:
    balance = Balance(tyre, 16, tolerance=1e-6)
    footprint = balance.at_deflection(0.006)
    u = footprint.amplitudes
    inner = np.stack([tyre.harmonics.stiffness(n) @ part for n, part in enumerate(u)]) + balance.motion.nonlinear(16)(u)
    outer = np.zeros_like(inner)
    outer[:, tyre.tread.dofs.ravel()] = footprint.load_harmonics.reshape(17, -1)
    free = tyre.harmonics.free
    assert np.abs((inner - outer)[:, free]).max() < 1e-3 * np.abs(outer).max()


def test_balance_under_a_load(tyre: Pressing) -> None:
    footprint = Balance(tyre, 12).at_load(600.0)
    assert footprint.load == pytest.approx(600.0, rel=1e-3)
    assert footprint.deflection > tyre.at_load(600.0, 12).deflection
    assert np.isfinite(StrainHarmonics(footprint).amplitudes).all()


def test_out_of_reach_says_how_far_it_got(tyre: Pressing) -> None:
    with pytest.raises(InputError, match=r"reaches .* mm \(.* N\), not 90 mm"):
        Balance(tyre, 8, steps=1).at_deflection(0.09)
