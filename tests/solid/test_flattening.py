"""An inflated body in a rigid cylinder: closed forms, complementarity, work and its derivatives."""

from __future__ import annotations

import functools
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad
from solid_bodies import END, tube

import tyrefem as tf
from tyrefem.errors import InputError
from tyrefem.geometry.meshing import build
from tyrefem.mechanics.solid.body import Body
from tyrefem.mechanics.solid.compounds import neo_hookean
from tyrefem.mechanics.solid.cylinder import CylinderChoice
from tyrefem.mechanics.solid.flattening import Flattened, bottoming, flatten
from tyrefem.mechanics.solid.inflation import Inflation, inflate
from tyrefem.mechanics.solid.newton import equilibrium

SHEAR, INNER, OUTER, HEIGHT = 1e6, 1.0, 2.0, 0.5


def ring(n: int = 6, bulk: float = 1e8, pressure: float = 0.0) -> Inflation:
    """A ring without ends (plane strain) whose outer side may touch."""
    plain = tube(n, neo_hookean(SHEAR, bulk), inner=INNER, outer=OUTER, height=HEIGHT)
    mesh = plain.mesh.with_boundaries({"road": lambda x: x[0] > OUTER - END})
    body = Body(mesh, plain.parts, plain.held)
    return Inflation(body, equilibrium(body, pressure), half=False)


@functools.cache
def bias_tyre(pressure: float = 572e3) -> Inflation:
    study = tf.study("nasa-22x5.5-8pr")
    return inflate(study, pressure, build(study.section, size=16e-3, through=1))


@functools.cache
def pressed(deflection: float) -> Flattened:
    return flatten(bias_tyre(), deflection)


def potential(flattened: Flattened) -> float:
    """Elastic energy less p V, J of the whole tyre; V per radian is int r^2 dz / 2 along the wall."""
    body, wall = flattened.tyre.body, flattened.tyre.body.wall
    (r, _, dz), _, _, weights = wall._along(flattened.places)
    volume = float((wall.outwards[:, None] * weights * r * r / 2 * dz).sum())
    sides = 2 if flattened.tyre.half else 1
    # The wall's outward normal points into the gas.
    return 2 * np.pi * sides * (body.energy(flattened.displacement) + flattened.tyre.pressure * volume)


def test_lame_ring_pressed_from_outside() -> None:
    """u = A r + B/r with u(b) = -D and no stress at r = a; pressure of the cylinder and strain energy likewise."""
    bulk, d = 1e8, 1e-6
    flattened = flatten(ring(8, bulk), d)
    lame, a, b = bulk - 2 * SHEAR / 3, INNER, OUTER
    # 2 (lambda + G) A = 2 G B / a^2
    ratio = a**2 * (lame + SHEAR) / SHEAR
    A = -d / (b + ratio / b)
    B = A * ratio
    r = flattened.tyre.body.rings.nodes[0]
    np.testing.assert_allclose(flattened.displacement[0], A * r + B / r, atol=2e-5 * d)
    pressure = -(2 * (lame + SHEAR) * A - 2 * SHEAR * B / b**2)
    assert flattened.force == pytest.approx(2 * np.pi * b * HEIGHT * pressure, rel=1e-4)
    assert flattened.stiffness == pytest.approx(flattened.force / d, rel=1e-4)
    points = flattened.tyre.body.rings.points[0]
    hoop, radial = A + B / points**2, A - B / points**2
    np.testing.assert_allclose(flattened.strain[2], hoop, atol=1e-3 * np.abs(hoop).max())
    np.testing.assert_allclose(flattened.strain[0], radial, atol=5e-3 * np.abs(radial).max())


def test_large_flattening_of_an_incompressible_ring() -> None:
    """r^2 = R^2 + k, pressure of the cylinder int G (x^2 - x^-2) dr/r, x = r/R, with k = (b - D)^2 - b^2."""
    d = 0.2
    k = (OUTER - d) ** 2 - OUTER**2

    def slope(R: float) -> float:
        x2 = 1 + k / R**2
        return SHEAR * (x2 - 1 / x2) * R / (R * R + k)

    exact = -quad(slope, INNER, OUTER)[0]
    # The bore is at 49 % of its radius; 1e5 is nearly incompressible (ten times less: ten times the error).
    force = flatten(ring(6, 1e5 * SHEAR), d).force
    assert force / (2 * np.pi * (OUTER - d) * HEIGHT) == pytest.approx(exact, rel=6e-4)


def test_a_pressed_ring_takes_its_pressure_through() -> None:
    """At the deflection that undoes inflation the ring is unstrained in its bore: cylinder and gas press alike."""
    pressure = 2e5
    blown = ring(6, 1e4 * SHEAR, pressure)
    growth = blown.places[0].max() - OUTER
    flattened = flatten(blown, growth)
    # Incompressible and back at its own radius: stress is -p everywhere, and so is the cylinder's pressure.
    assert flattened.force / (2 * np.pi * OUTER * HEIGHT) == pytest.approx(pressure, rel=1e-3)


@pytest.mark.parametrize("deflection", [2e-3, 12e-3])
def test_complementarity(deflection: float) -> None:
    """No node beyond the cylinder, none pulled by it, and no force across a gap; the inside in balance."""
    flattened = pressed(deflection)
    assert flattened.gaps.min() > -1e-12
    assert flattened.forces.min() >= 0
    assert (flattened.forces * flattened.gaps).max() < 1e-12 * flattened.force * deflection
    touched = flattened.forces > 0
    assert 0 < touched.sum() < len(touched)
    body = flattened.tyre.body
    residual = body.residual(flattened.displacement, flattened.tyre.pressure)
    residual[2 * flattened.nodes] += flattened.forces
    assert np.abs(residual[body.free]).max() < 1e-8 * flattened.forces.sum()


def test_contact_spreads_with_the_deflection() -> None:
    assert 0 < pressed(2e-3).width < pressed(12e-3).width < 0.13


def test_force_is_the_derivative_of_the_potential() -> None:
    """d(elastic energy - p V)/dD = F, and dF/dD is the stiffness of the linearised contact."""
    h, flattened = 2e-5, pressed(12e-3)
    less, more = (flatten(bias_tyre(), 12e-3 + x, pressed(2e-3)) for x in (-h, h))
    slope = (potential(more) - potential(less)) / (2 * h)
    assert flattened.force == pytest.approx(slope, rel=1e-5)
    # No node comes into contact between the two.
    assert ((less.forces > 0) == (more.forces > 0)).all()
    assert flattened.stiffness == pytest.approx((more.force - less.force) / (2 * h), rel=1e-3)
    assert flattened.stiffness > 0


def test_newton_is_quadratic_once_the_contact_is_found() -> None:
    flattened = flatten(ring(4), 0.05)
    errors = [[e for e in history[1:] if 1e-8 < e < 0.3] for history in flattened.residuals]
    steps = [step for history in errors for step in pairwise(history)]
    assert len(steps) > 1
    for before, after in steps:
        assert after < 30 * before**1.8


def test_the_way_there_does_not_matter() -> None:
    """From a smaller deflection or from none: the same place."""
    direct, staged = pressed(12e-3), flatten(bias_tyre(), 12e-3, pressed(2e-3))
    np.testing.assert_allclose(direct.displacement, staged.displacement, atol=1e-8)
    assert staged.steps[: len(pressed(2e-3).steps)] == pressed(2e-3).steps


def test_a_tyre_pressed_at_another_pressure_is_a_start() -> None:
    """From 4 % less pressure and 1 mm less deflection, not to full accuracy: the same place, in fewer steps."""
    near = flatten(bias_tyre(550e3), 11e-3, choice=CylinderChoice(tolerance=1e-3))
    direct, started = pressed(12e-3), flatten(bias_tyre(), 12e-3, near=near)
    np.testing.assert_allclose(direct.displacement, started.displacement, atol=1e-8)
    assert direct.force == pytest.approx(started.force, rel=1e-8)
    assert len(started.steps) < len(direct.steps)
    # A deeper one is none: letting go of the cylinder frees all nodes at once.
    from_zero = flatten(bias_tyre(), 8e-3, near=near)
    assert from_zero.steps == flatten(bias_tyre(), 8e-3).steps


def test_no_deflection_is_the_inflated_tyre() -> None:
    flattened = flatten(bias_tyre(), 0.0)
    assert flattened.force == flattened.stiffness == flattened.width == 0
    assert np.abs(flattened.strain).max() < 1e-12


def test_impossible_deflections() -> None:
    tyre = bias_tyre()
    with pytest.raises(InputError, match=r"deflection of 200 mm is impossible; .* where the crown meets the rim"):
        flatten(tyre, 0.2)
    with pytest.raises(InputError, match="deflection of -1 mm is impossible"):
        flatten(tyre, -1e-3)
    with pytest.raises(InputError, match=r"no equilibrium beyond [\d.]+ mm; .* mm, region '\w+'"):
        flatten(ring(2), 0.2, choice=CylinderChoice(iterations=2, smallest_step=5e-3))
    assert 0.05 < bottoming(tyre) < 0.1
