"""Fourier harmonics: rigid motions, rings, shells, the following pressure."""

from __future__ import annotations

from contextlib import suppress

import numpy as np
import pytest
from footprint_bodies import block, half_torus
from scipy.sparse.linalg import spsolve

from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.elements import SectionElements
from tyrefem.mechanics.footprint.example_tyre import PlainTyre, pressurised, stress_free
from tyrefem.mechanics.footprint.harmonics import Harmonics, follower_stiffness, pressure_load


def rigid_motions(elements: SectionElements) -> dict[str, tuple[int, np.ndarray]]:
    r, z = elements.nodes
    zero, ones = np.zeros_like(r), np.ones_like(r)
    return {
        "axial translation": (0, np.stack([zero, ones, zero], axis=1).ravel()),
        "translation across": (1, np.stack([ones, zero, -ones], axis=1).ravel()),
        "rotation about a diameter": (1, np.stack([-z, r, z], axis=1).ravel()),
    }


@pytest.fixture(scope="module")
def torus() -> Harmonics:
    return Harmonics(pressurised(stress_free(half_torus(), 1e6, 1e8, fixed=()), 2e5))


@pytest.mark.parametrize("name", ["axial translation", "translation across", "rotation about a diameter"])
def test_rigid_motion_of_an_inflated_torus_costs_no_energy(torus: Harmonics, name: str) -> None:
    n, u = rigid_motions(torus.elements)[name]
    assert np.abs(torus.elements.strain(n, u)).max() < 1e-10
    parts = u @ (abs(torus.stiffness(n)) @ abs(u))
    assert abs(u @ torus.stiffness(n) @ u) < 1e-12 * parts
    # Not because there is no stress: without the following pressure the rotation would cost energy.
    assert np.abs(torus.state.stress).max() > 1e5


def test_rotation_needs_the_following_pressure(torus: Harmonics) -> None:
    from dataclasses import replace

    n, u = rigid_motions(torus.elements)["rotation about a diameter"]
    dead = Harmonics(replace(torus.state, pressure=0.0))
    volume = np.pi * 0.05**2 / 2 * 0.3  # enclosed by the half, per radian
    # int s_ij W_ki W_kj dV is p times enclosed volume times W : W less what turns about the axis.
    assert abs(u @ dead.stiffness(n) @ u) > 0.2 * 2e5 * volume


def ring(radius: float, h: float, b: float) -> Harmonics:
    mesh = block(np.linspace(radius - h / 2, radius + h / 2, 3), np.linspace(-b / 2, b / 2, 3))
    return Harmonics(stress_free(mesh, 1e6, 1e9, fixed=()))


def test_ring_under_opposed_forces_harmonic_by_harmonic() -> None:
    """w_n = q_n R^4 / (E I (n^2 - 1)^2); in sum 0.0744 P R^3/(E I) under each force."""
    radius, h, b = 1.0, 0.01, 0.01
    body = ring(radius, h, b)
    elements = body.elements
    young = 9 * 1e9 * 1e6 / (3 * 1e9 + 1e6)
    bending = young * b * h**3 / 12
    outer = np.flatnonzero(np.abs(elements.nodes[0] - radius) < 1e-9)  # mid surface
    total = 0.0
    for n in range(2, 13, 2):
        # A load density of 1 N/m along the ring at the mid surface: R per radian, on the middle node.
        middle = outer[np.argmin(np.abs(elements.nodes[1][outer]))]
        load = np.zeros(elements.n_dofs)
        load[3 * middle] = radius
        K = body.stiffness(n).tolil()
        # A slender ring is soft enough that only the axial drift needs a hold; symmetry forbids it, so no force acts.
        K[3 * middle + 1, 3 * middle + 1] += 1.0
        w = spsolve(K.tocsc(), load)[3 * middle]
        exact = radius**4 / (bending * (n * n - 1) ** 2)
        assert w == pytest.approx(exact, rel=1e-3 + 1.5 * (n * h / radius) ** 2)
        total += 2 / (np.pi * radius) * w
    assert total == pytest.approx((np.pi / 8 - 1 / np.pi) * radius**3 / bending, rel=2e-3)


def test_pinched_cylinder_against_the_published_value() -> None:
    """Belytschko et al. 1985: 1.8248e-5 under P = 1, R = 300, L = 600, t = 3, E = 3e6, nu = 0.3, end diaphragms."""
    radius, t, young = 300.0, 3.0, 3e6
    z = 300 * np.linspace(0, 1, 15) ** 1.7
    mesh = block([radius - t / 2, radius + t / 2], z, symmetry=lambda r, z: z < 1e-9)
    body = Harmonics(stress_free(mesh, young / 2.6, young / 1.2, fixed=()))
    r, z = body.elements.nodes
    ends = np.flatnonzero(z > 300 - 1e-9)
    held = np.unique(np.concatenate([3 * ends, 3 * ends + 2, body.held]))
    free = np.setdiff1d(np.arange(body.elements.n_dofs), held)
    load = np.zeros(body.elements.n_dofs)
    load[3 * int(np.argmin(abs(r - radius) + z))] = 0.5  # half of P on the half cylinder
    middle = 3 * int(np.argmin(abs(r - radius) + z))
    total = 0.0
    for n in range(0, 81, 2):
        u = spsolve(body.stiffness(n)[free][:, free].tocsc(), load[free])
        # Two opposed forces: P/pi cos n t for even n, half of it for n = 0.
        total += u[np.searchsorted(free, middle)] * (1 / np.pi if n == 0 else 2 / np.pi)
    assert total == pytest.approx(1.8248e-5, rel=0.02)


def test_follower_stiffness_is_the_change_of_the_load() -> None:
    """For n = 0: -P_0 u is the central difference of the load on the moved wall, exact to h^2."""
    import skfem

    rng = np.random.default_rng(1)
    mesh = half_torus(around=6, through=1)
    moved = rng.normal(size=(2, mesh.p.shape[1])) * 1e-5
    moved[1, mesh.p[1] < 1e-9] = 0.0

    def load(sign: float) -> np.ndarray:
        there = skfem.MeshQuad(mesh.p + sign * moved, mesh.t, sort_t=False).with_boundaries(mesh.boundaries)
        return pressure_load(SectionElements(there), "contained_air")

    elements = SectionElements(mesh)
    basis = elements.basis
    there = SectionElements(skfem.MeshQuad(mesh.p + moved, mesh.t, sort_t=False))
    u = np.zeros((basis.N, 3))
    u[:, :2] = (there.nodes - elements.nodes).T
    dofs, constant, _ = follower_stiffness(elements, "contained_air")
    change = np.zeros(elements.n_dofs)
    np.add.at(change, dofs, np.einsum("fij,fj->fi", constant, u.ravel()[dofs]))
    difference = (load(1) - load(-1)) / 2
    free = np.ones((basis.N, 3), dtype=bool)
    free[elements.boundary_nodes("symmetry"), 1] = False
    free = free.ravel()
    assert np.abs(-change - difference)[free].max() < 1e-4 * np.abs(difference).max()


def test_incompressible_rubber_does_not_lock() -> None:
    """Bending of a ring hardly changes when the bulk modulus grows from 10^2 to 10^6 times G."""
    compliances = []
    for bulk in (1e8, 1e12):
        mesh = block(np.linspace(0.95, 1.05, 2), np.linspace(-0.05, 0.05, 2))
        body = Harmonics(stress_free(mesh, 1e6, bulk, fixed=()))
        load = np.zeros(body.elements.n_dofs)
        load[3 * int(np.argmin(abs(body.elements.nodes[0] - 1) + abs(body.elements.nodes[1])))] = 1.0
        K = body.stiffness(3).tolil()
        K[1, 1] += 1.0
        compliances.append(load @ spsolve(K.tocsc(), load))
    assert compliances[1] == pytest.approx(compliances[0], rel=0.02)


def test_three_assemblies_serve_any_harmonic(torus: Harmonics) -> None:
    """K_n is quadratic in n with symmetric parts."""
    a, b, c = torus.matrices
    assert abs(torus.stiffness(7) - (a + 7 * b + 49 * c)).max() < 1e-9 * abs(a).max()
    assert max(abs(part - part.T).max() for part in (a, b, c)) < 1e-12 * abs(a).max()


def test_full_section_and_half_give_the_same_harmonics() -> None:
    """A symmetric radial load on the crown: the same compliance, halved."""
    displacements = []
    for half in (True, False):
        body = Harmonics(PlainTyre(half=half).state(along=12))
        r, z = body.elements.nodes
        load = np.zeros(body.elements.n_dofs)
        crown = 3 * int(np.argmin(abs(z) - 1e-3 * r))
        load[crown] = 1.0
        displacements.append(body.solve(3, load[:, None])[crown, 0])
    assert displacements[0] == pytest.approx(2 * displacements[1], rel=1e-8)


def test_a_body_that_nothing_holds_is_refused() -> None:
    body = ring(1.0, 0.1, 0.1)
    load = np.zeros((body.elements.n_dofs, 1))
    load[3] = 1.0
    with pytest.raises(InputError, match="nothing holds"):
        body.solve(1, load)


def test_unknown_boundary_names_the_nearest() -> None:
    mesh = block([1.0, 1.1], [0.0, 0.1], rim=lambda r, z: z < 1e-9)
    with pytest.raises(InputError, match="did you mean 'rim'"):
        Harmonics(stress_free(mesh, 1e6, 1e8, fixed=("rims",)))


def test_buckling_is_found_where_the_hoop_is_compressed() -> None:
    """Hoop stress - s adds - s n^2/r^2 u^2: a ring's upper half, under more than rubber can bear, buckles there."""
    from dataclasses import replace

    mesh = block(np.linspace(0.9, 1.0, 3), np.linspace(0, 0.4, 9), low=lambda r, z: z < 1e-9)
    free = stress_free(mesh, 1e6, 1e8, fixed=("low",))
    stress = np.zeros_like(free.stress)
    upper = mesh.p[1, mesh.t].mean(axis=0) > 0.2
    stress[2, upper] = -2e6
    harmonics = Harmonics(replace(free, stress=stress))
    free_of_stress = Harmonics(free)
    free_of_stress.compliance(60, free_of_stress.free[:3])
    assert free_of_stress.negative_pivots[60] == 0
    assert not free_of_stress.buckling_place
    with suppress(InputError):
        harmonics.compliance(60, harmonics.free[:3])
    assert harmonics.negative_pivots[60] > 0
    assert harmonics.buckling_place[60][1] > 0.2


@pytest.mark.parametrize("hoop", [0.0, -2e6])
def test_motions_balance_their_loads_where_the_stiffness_is_positive_and_where_it_is_not(hoop: float) -> None:
    """A compressed hoop has motions with negative stiffness, which loads along the stiffest ones leave alone: K u = f
    to rounding."""
    from dataclasses import replace

    mesh = block(np.linspace(0.9, 1.0, 3), np.linspace(0, 0.4, 9), low=lambda r, z: z < 1e-9)
    state = stress_free(mesh, 1e6, 1e8, fixed=("low",))
    stress = np.zeros_like(state.stress)
    stress[2] = hoop
    body = Harmonics(replace(state, stress=stress))
    free = body.free
    stiffness = body.stiffness(60)[free][:, free].toarray()
    values, motions = np.linalg.eigh((stiffness + stiffness.T) / 2)
    assert (values[0] > 0) == (hoop == 0)
    loads = np.zeros((body.elements.n_dofs, 2))
    loads[free] = motions[:, -2:] * values[-2:]
    assert body.solve(60, loads)[free] == pytest.approx(motions[:, -2:], abs=1e-8)
