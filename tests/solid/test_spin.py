"""A spinning body: growth of a ring, momentum flux as hoop stress, mass matrix of steady motions, rigid motions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import skfem

from tyrefem.mechanics.footprint.example_tyre import PlainTyre
from tyrefem.mechanics.footprint.harmonics import Harmonics
from tyrefem.mechanics.footprint.nonlinear import NonlinearForces
from tyrefem.mechanics.footprint.vibration import mass_matrix
from tyrefem.mechanics.solid.body import Body
from tyrefem.mechanics.solid.centrifugal import Centrifugal
from tyrefem.mechanics.solid.compounds import determinant, neo_hookean
from tyrefem.mechanics.solid.newton import equilibrium, spun_equilibrium
from tyrefem.mechanics.solid.parts import RegionMaterial
from tyrefem.mechanics.solid.spin import rolled

pytestmark = pytest.mark.fast
SHEAR, DENSITY = 1e8, 1200.0


def ring_body(radius: float, h: float, shear: float = SHEAR) -> Body:
    mesh = skfem.MeshQuad.init_tensor(np.linspace(radius - h / 2, radius + h / 2, 3), np.linspace(0.0, h, 2))
    mesh = mesh.with_boundaries({
        "contained_air": lambda x: x[0] < radius - h / 2 + 1e-9, "symmetry": lambda x: x[1] < 1e-9,
    }).with_subdomains({"rubber": np.arange(mesh.t.shape[1])})  # fmt: skip
    return Body(mesh, {"rubber": RegionMaterial(neo_hookean(shear))}, {"symmetry": "z"})


def spun(body: Body, angular_speed: float, pressure: float = 0.0) -> tuple[Body, np.ndarray]:
    density = np.full(body.rings.weights.shape, DENSITY)
    spinning = replace(body, centrifugal=Centrifugal(body.rings, density, angular_speed))
    return spinning, spun_equilibrium(spinning, equilibrium(body, pressure)).displacement


def test_growth_of_a_thin_ring() -> None:
    """u = rho W^2 R^3 / E in small motion; in large motion lambda^2 - 1/lambda = rho (W R)^2 lambda^2 / G."""
    radius, h = 1.0, 0.002
    body = ring_body(radius, h)
    modulus = 9 * body.bulk[0] * SHEAR / (3 * body.bulk[0] + SHEAR)
    for angular_speed in (2.0, 150.0):
        _, displacement = spun(body, angular_speed)
        growth = float(displacement[0].mean())
        load = DENSITY * angular_speed**2 * radius**2
        if angular_speed < 10:
            assert growth / radius == pytest.approx(load / modulus, rel=1e-3)
            continue
        # Incompressible: s_tt = G (l^2 - 1/l) = rho (W R l)^2; the bulk modulus of 100 G adds 0.4 %.
        stretch = 1 + growth / radius
        assert SHEAR * (stretch**2 - 1 / stretch) == pytest.approx(load * stretch**2, rel=5e-3)
        assert growth / radius > 1.05 * load / modulus


def test_force_and_its_derivative() -> None:
    body = ring_body(0.3, 0.02)
    load = Centrifugal(body.rings, np.full(body.rings.weights.shape, DENSITY), 50.0)
    places = body.rings.nodes
    volume_moment = DENSITY * 50.0**2 * (0.31**3 - 0.29**3) / 3 * 0.02
    assert load.force(places).reshape(-1, 2)[:, 0].sum() == pytest.approx(volume_moment, rel=1e-12)
    change = np.random.default_rng(0).normal(size=places.shape)
    moved = load.force(places + change) - load.force(places)
    assert moved == pytest.approx(load.stiffness @ change.T.ravel(), rel=1e-9, abs=1e-9)
    assert load.at(0.25).force(places) == pytest.approx(load.force(places) / 4)


@pytest.mark.parametrize("n", [0, 1, 2, 5])
def test_inertia_is_the_acceleration_of_a_turning_shape(n: int) -> None:
    """K_n - W^2 M_n with M_n = (n^2 + 1) on u_r and u_t, 2 n between them, n^2 on u_z."""
    state = PlainTyre().state(along=6)
    density = np.full(state.bulk.shape, 1100.0)
    mass = (
        mass_matrix(Harmonics(state).elements, density).toarray().reshape(-1, 3, Harmonics(state).elements.n_nodes, 3)
    )
    scalar = mass[:, 0, :, 0]
    expected = np.zeros_like(mass)
    expected[:, 0, :, 0] = expected[:, 2, :, 2] = (n**2 + 1) * scalar
    expected[:, 0, :, 2] = expected[:, 2, :, 0] = 2 * n * scalar
    expected[:, 1, :, 1] = n**2 * scalar
    speed = 40.0
    change = Harmonics(state).stiffness(n) - Harmonics(rolled(state, density, speed)).stiffness(n)
    size = change.shape[0]
    assert change.toarray() == pytest.approx(speed**2 * expected.reshape(size, size), rel=1e-9, abs=1e-6)
    assert rolled(state, density, 0.0) is state


def test_nothing_resists_rigid_motions_of_a_spinning_ring() -> None:
    """In equilibrium with its centrifugal load a free ring turns and shifts without force: n = 0 and n = 1."""
    body, displacement = spun(ring_body(0.3, 0.01), 100.0)
    state = body.state(displacement, 0.0)
    density = DENSITY / determinant(body.deformation(displacement))
    harmonics = Harmonics(rolled(replace(state, fixed=()), density, 100.0))
    r, _ = harmonics.elements.nodes
    turn, shift = np.zeros((2, len(r), 3))
    turn[:, 2] = r
    # A shifted ring that turns about its shifted axis: the load follows.
    shift[:, 0], shift[:, 2] = 1.0, -1.0
    for n, motion in ((0, turn), (1, shift)):
        force = harmonics.stiffness(n) @ motion.ravel()
        size = abs(harmonics.stiffness(n)) @ np.abs(motion.ravel())
        assert np.abs(force).max() < 1e-8 * size.max(), n


def test_large_motion_has_the_same_inertia() -> None:
    """Forces in large motion change by - W^2 M_n u, by the body's law and by Green's."""
    body, displacement = spun(ring_body(0.3, 0.01), 100.0)
    density = DENSITY / determinant(body.deformation(displacement))
    state = replace(body.state(displacement, 0.0), fixed=())
    still, turning = Harmonics(state), Harmonics(rolled(state, density, 100.0))
    motion = 1e-3 * np.random.default_rng(0).normal(size=(4, still.elements.n_dofs))
    motion[0, 2::3] = 0.0
    inertia = np.stack([
        (turning.stiffness(n) - still.stiffness(n)) @ part for n, part in enumerate(motion)
    ])  # fmt: skip
    for law in (state.law, None):
        before = NonlinearForces(Harmonics(replace(state, law=law)), 3)
        after = NonlinearForces(Harmonics(rolled(replace(state, law=law), density, 100.0)), 3)
        difference = after.forces(motion) - before.forces(motion)
        assert difference == pytest.approx(inertia, rel=1e-5, abs=1e-7 * np.abs(inertia).max())
        tangents = after.at(motion).product(motion) - before.at(motion).product(motion)
        assert tangents == pytest.approx(inertia, rel=1e-5, abs=1e-7 * np.abs(inertia).max())
