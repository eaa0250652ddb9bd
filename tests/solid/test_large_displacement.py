"""Bodies under a following pressure against closed forms."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq
from solid_bodies import skewed, torus, tube

from tyrefem.errors import InputError
from tyrefem.mechanics.solid import newton
from tyrefem.mechanics.solid.body import Body
from tyrefem.mechanics.solid.compounds import mooney_rivlin, neo_hookean
from tyrefem.mechanics.solid.cords import CordLayer
from tyrefem.mechanics.solid.newton import NewtonChoice, equilibrium
from tyrefem.mechanics.solid.parts import RegionMaterial


def lame(body: Body, pressure: float, shear: float, bulk: float) -> tuple[np.ndarray, np.ndarray]:
    """Computed and exact u_r, plane strain: u = p/(2 G) (r (1 - 2 nu) + b^2/r) / (b^2 - 1), inner radius 1."""
    displacement = equilibrium(body, pressure, NewtonChoice(first_step=1.0)).displacement[0]
    r, nu, b = body.rings.nodes[0], (3 * bulk - 2 * shear) / (6 * bulk + 2 * shear), 2.0
    return displacement, pressure / (2 * shear) * (r * (1 - 2 * nu) + b**2 / r) / (b**2 - 1)


def random_motion(body: Body, size: float) -> np.ndarray:
    return size * np.random.default_rng(7).standard_normal((2, body.rings.n_nodes))


@pytest.mark.parametrize("bulk", [2e6, 1e9])
def test_patch(bulk: float) -> None:
    """A stretch along the axis with its hoop and radius alike: constant stress, inner nodes in balance anywhere."""
    mesh = skewed()
    body = Body(mesh, {"rubber": RegionMaterial(neo_hookean(1e6, bulk))}, {"outside": "rz"})
    exact = np.array([[-0.05], [0.1]]) * body.rings.nodes
    residual = body.residual(exact, 0.0)
    assert np.abs(residual[body.free]).max() < 1e-10 * np.abs(residual).max()
    stress = body.state(exact, 0.0).stress
    assert np.ptp(stress, axis=(1, 2)).max() < 1e-9 * np.abs(stress).max()


def test_lame_cylinder() -> None:
    displacement, exact = lame(tube(8, neo_hookean(1e6, 1e8)), 1.0, 1e6, 1e8)
    assert np.abs(displacement / exact - 1).max() < 2e-5


def test_lame_converges_with_the_third_order() -> None:
    errors = []
    for n in (2, 4, 8):
        displacement, exact = lame(tube(n, neo_hookean(1e6, 1e8)), 1.0, 1e6, 1e8)
        errors.append(float(np.sqrt(np.mean((displacement - exact) ** 2))))
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert (orders > 2.7).all()


def test_no_locking() -> None:
    """The error does not grow as nu goes from 0.4 to 0.49999."""
    errors = []
    for bulk in (4.67e6, 1e8, 1e9, 5e10):
        displacement, exact = lame(tube(4, neo_hookean(1e6, bulk)), 100.0, 1e6, bulk)
        errors.append(np.abs(displacement / exact - 1).max())
    assert max(errors) < 1e-3
    assert errors[-1] < 3 * errors[0]


def test_neo_hookean_tube() -> None:
    """Incompressible tube: p = int G (x^2 - x^-2) dr/r, x = r/R, r^2 - R^2 constant; blown up by two thirds."""
    shear, pressure = 1e6, 5e5

    def needed(k: float) -> float:
        return quad(lambda R: shear * ((1 + k / R**2) - 1 / (1 + k / R**2)) * R / (R * R + k), 1, 2)[0]

    exact = np.sqrt(1 + brentq(lambda k: needed(k) - pressure, 0, 10)) - 1
    errors = []
    for n in (3, 6):
        body = tube(n, neo_hookean(shear, 1e4 * shear))
        displacement = equilibrium(body, pressure).displacement[0, body.rings.boundary_nodes("contained_air")]
        errors.append(abs(displacement.mean() / exact - 1))
    assert exact > 0.65
    assert errors[1] < 2e-4
    assert errors[1] < errors[0]


def test_mooney_rivlin_tube_in_plane_strain_is_neo_hookean() -> None:
    """Where nothing moves along the axis I1 = I2: only c10 + c01 counts (incompressible)."""
    first, other = (
        equilibrium(tube(4, law), 4e5).displacement for law in (neo_hookean(1e6, 1e9), mooney_rivlin(3e5, 2e5, 1e9))
    )
    np.testing.assert_allclose(first, other, atol=2e-3 * np.abs(first).max())


def test_toroidal_membrane() -> None:
    """N_phi = (p r/2)(1 + b/R), Clark & Dodge 1980, appendix F: r of the tube, b of its centre, R of the point."""
    r, b, h, p = 0.1, 0.3, 5e-4, 1e4
    body = torus(r, b, h, 80, neo_hookean(1e9))
    state = body.state(equilibrium(body, p, NewtonChoice(first_step=1.0)).displacement, p)
    radius, z = body.rings.points
    sine, cosine = z / np.hypot(radius - b, z), (radius - b) / np.hypot(radius - b, z)
    rr, zz, _, rz, _, _ = state.stress
    along = rr * sine**2 + zz * cosine**2 - 2 * rz * sine * cosine
    # Mean over the thickness takes the bending away.
    weights = np.asarray(body.rings.basis.dx)
    force = h * (along * weights).sum(axis=1) / weights.sum(axis=1)
    exact = p * r / 2 * (1 + b / radius.mean(axis=1))
    away = np.abs(cosine.mean(axis=1)) > 0.35
    assert away.sum() > 40
    np.testing.assert_allclose(force[away], exact[away], rtol=0.01)


@pytest.mark.parametrize("law", [neo_hookean(1e6, 1e7), mooney_rivlin(3e5, 2e5, 1e7)])
def test_tangent_against_differences(law: object) -> None:
    """Stiffness of rubber, cords, projected dilatation and following pressure in a strained state."""
    plain = tube(3, law)  # type: ignore[arg-type]
    shape = plain.rings.weights.shape
    cords = CordLayer(np.full(shape, 0.6), np.array([0.0, 1.0])[:, None, None] * np.ones(shape), np.full(shape, 1e8))
    body = Body(plain.mesh, {"rubber": RegionMaterial(law, (cords,))}, plain.held)  # type: ignore[arg-type]
    now, change, h = random_motion(body, 1e-2), random_motion(body, 1.0), 1e-6
    slope = (body.residual(now + h * change, 3e5) - body.residual(now - h * change, 3e5)) / (2 * h)
    np.testing.assert_allclose(body.stiffness(now, 3e5) @ change.T.ravel(), slope, atol=1e-7 * np.abs(slope).max())
    work = (body.energy(now + h * change) - body.energy(now - h * change)) / (2 * h)
    assert work == pytest.approx(float(change.T.ravel() @ body.residual(now, 0.0)), rel=1e-6)


def test_newton_is_quadratic() -> None:
    solution = equilibrium(tube(4), 2e5, NewtonChoice(first_step=1.0, tolerance=1e-11))
    errors = [e for e in solution.residuals[-1] if 1e-9 < e < 0.5]
    assert len(errors) >= 2
    for before, after in pairwise(errors):
        assert after < 10 * before**1.8


def test_axial_translation_and_rigid_hoops_cost_nothing() -> None:
    plain = tube(3)
    shape = plain.rings.weights.shape
    cords = CordLayer(np.full(shape, 0.6), np.array([0.0, 1.0])[:, None, None] * np.ones(shape), np.full(shape, 1e9))
    body = Body(plain.mesh, {"rubber": RegionMaterial(neo_hookean(1e6), (cords,))}, {})
    moved = np.zeros((2, body.rings.n_nodes))
    moved[1] = 0.3
    assert body.energy(moved) < 1e-12 * 1e9
    assert np.abs(body.residual(moved, 0.0)).max() < 1e-9 * 1e9
    assert np.abs(body.state(moved, 0.0).stress).max() < 1e-6 * 1e9


def test_pressure_force_is_that_on_the_bore() -> None:
    """Per radian: p r h on a cylinder of radius r, height h, and its half sine in a strained place."""
    body = tube(2)
    force = body.load(np.zeros((2, body.rings.n_nodes))).reshape(-1, 2)
    assert force.sum(axis=0) == pytest.approx([1.0 * 0.5, 0.0])
    blown = np.zeros((2, body.rings.n_nodes))
    blown[0] = 0.2 * body.rings.nodes[0]
    assert body.load(blown).reshape(-1, 2).sum(axis=0) == pytest.approx([1.2 * 0.5, 0.0])


def test_a_burst_is_one_error_that_says_where() -> None:
    """A neo-Hookean tube bears at most G ln(b/a): beyond it grows without end."""
    with pytest.raises(
        InputError, match=r"no equilibrium beyond [\d.]+% of 900 kPa \(load step \d+\).*mm, region 'rubber'"
    ):
        equilibrium(tube(3, neo_hookean(1e6)), 9e5, NewtonChoice(smallest_step=0.02, iterations=12))


def test_a_first_step_that_fails_is_halved_without_being_tried_twice(monkeypatch: pytest.MonkeyPatch) -> None:
    tried: list[float] = []
    inner = newton._newton

    def recorded(body: Body, start: np.ndarray, pressure: float, choice: NewtonChoice) -> object:
        tried.append(pressure)
        return inner(body, start, pressure, choice)

    monkeypatch.setattr(newton, "_newton", recorded)
    solution = equilibrium(tube(3, neo_hookean(1e6)), 4e5, NewtonChoice(first_step=1.0, iterations=3))
    assert len(solution.steps) > 1
    assert solution.steps[-1] == 1.0
    # From rest there is one start only: the same failure again would cost twice.
    assert tried[:2] == [4e5, 2e5]


def test_unknown_names_are_named() -> None:
    body = tube(2)
    with pytest.raises(InputError, match="no region 'ruber'; did you mean 'rubber'"):
        Body(body.mesh, {"ruber": RegionMaterial(neo_hookean(1e6))}, {})
    with pytest.raises(InputError, match="no boundary 'end'"):
        _ = Body(body.mesh, body.parts, {"end": "z"}).free
