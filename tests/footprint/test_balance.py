"""Harmonic balance: Green's strains, frame indifference, the linear limit."""

from __future__ import annotations

import numpy as np
import pytest
from footprint_bodies import half_torus

from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.directions import SearchedDirections
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


def test_balances_are_those_of_exact_newton_steps(tyre: Pressing) -> None:
    """Numbers of this solver before it kept directions, rates and short tangents: the way must not alter the end."""
    balance = Balance(tyre, 12, tolerance=1e-7)
    at_deflection, at_load = balance.at_deflection(0.012), balance.at_load(1000.0)
    assert at_deflection.load == pytest.approx(1394.5054469, rel=1e-6)
    assert at_deflection.work == pytest.approx(6.4258098408, rel=1e-6)
    assert at_deflection.area == pytest.approx(0.0080601363466, rel=1e-6)
    assert at_deflection.rolling_radius == pytest.approx(0.31523842578, rel=1e-6)
    assert at_load.deflection == pytest.approx(0.00944257174, rel=1e-6)
    assert at_load.area == pytest.approx(0.0068355106879, rel=1e-6)
    assert at_load.stiffness == pytest.approx(154168.03, rel=1e-5)


def test_searched_directions_solve_what_they_span() -> None:
    """H J s = s for the directions of the last block; H stays symmetric and positive with an older block."""
    rng = np.random.default_rng(4)
    size, shape = 24, (2, 12)
    weights = np.repeat([2.0, 1.0], 12)  # work counts n = 0 twice
    root = rng.normal(size=(size, size))
    stiffness = root @ root.T + size * np.eye(size)  # of the work; forces are those over the weights
    values, vectors = np.linalg.eigh(stiffness)
    searched = SearchedDirections()
    for part, factor in ((slice(0, 4), 1.1), (slice(3, 9), 1.0)):
        moved = vectors[:, part].T / np.sqrt(values[part])[:, None]
        bent = factor * moved @ stiffness / weights
        searched.add(
            [s.reshape(shape) for s in moved.astype(np.float32)],
            [y.reshape(shape) for y in bent.astype(np.float32)],
            [1.0] * len(moved),
        )

    def corrected(force: np.ndarray) -> np.ndarray:
        return searched.corrected(force.reshape(shape), lambda right: right * weights.reshape(shape) / 30).ravel()

    for s in moved:
        assert corrected(stiffness @ s / weights) == pytest.approx(s, abs=1e-5 * np.abs(s).max())
    matrix = np.stack([corrected(row / weights) for row in np.eye(size)])
    assert matrix == pytest.approx(matrix.T, abs=1e-5 * np.abs(matrix).max())
    assert np.linalg.eigvalsh((matrix + matrix.T) / 2).min() > 0


def test_out_of_reach_says_how_far_it_got(tyre: Pressing) -> None:
    with pytest.raises(InputError, match=r"reaches .* mm \(.* N\), not 90 mm.*; mechanics.motion = .linear. is"):
        Balance(tyre, 8, steps=1).at_deflection(0.09)
