"""Rolling contact with friction against closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tyrefem.errors import InputError
from tyrefem.mechanics.rolling.contact_body import ContactBody
from tyrefem.mechanics.rolling.example_bodies import CYLINDER_RADIUS, beam, bristles, cylinder, string
from tyrefem.mechanics.rolling.friction import OPEN, SLIP, STICK, Control, RollingContact
from tyrefem.mechanics.rolling.standing import standing_stiffness

pytestmark = pytest.mark.fast

#: Half length of the contact, m; friction.
A, MU = 1.0, 0.3


def positions(count: int, step: float) -> np.ndarray:
    return (np.arange(count) - (count - 1) / 2) * step


def rigid(count: int, step: float, creep: float, component: int) -> np.ndarray:
    slips = np.zeros((count, 2))
    slips[:, component] = creep * step
    return slips


def rolled_cylinder(creep: float, scale: float = 1.0, friction: float = MU, component: int = 0) -> tuple:
    """An elastic cylinder of radius 50 on a rigid plane under the load that makes the contact 2 A long."""
    x, load, problem = cylinder(161, creep * A / CYLINDER_RADIUS, friction, component=component, scale=scale)
    return problem.solve(values=[A**2 / CYLINDER_RADIUS]), load, x, x[1] - x[0]


@pytest.mark.parametrize("share", [0.25, 0.5, 0.75, 0.9, 0.99])
@pytest.mark.parametrize("component", [0, 1])
def test_carter(share: float, component: int) -> None:
    """Creep = mu a/R (1 - sqrt(1 - Q/(mu P))); the zone that sticks begins at the front: sqrt(1 - Q/(mu P)) of it."""
    contact, load, _, _ = rolled_cylinder(MU * (1 - np.sqrt(1 - share)), component=component)
    assert -contact.forces[:, 1 + component].sum() / (MU * load) == pytest.approx(share, rel=0.01)
    sticks = np.flatnonzero(contact.states == STICK)
    touching = np.flatnonzero(contact.states != OPEN)
    assert len(sticks) / len(touching) == pytest.approx(np.sqrt(1 - share), abs=0.02)
    assert sticks.max() >= touching.max() - 1
    assert (np.diff(sticks) == 1).all()


def test_carter_in_full_slip() -> None:
    contact, load, _, _ = rolled_cylinder(1.2 * MU)
    assert (contact.states != STICK).all()
    assert -contact.forces[:, 1].sum() == pytest.approx(MU * load, rel=1e-9)


def test_hertz() -> None:
    contact, load, x, step = rolled_cylinder(0.1 * MU)
    inside = np.abs(x) < 0.8 * A
    hertz = 2 * load / (np.pi * A) * np.sqrt(1 - (x[inside] / A) ** 2)
    assert contact.forces[inside, 0] / step == pytest.approx(hertz, rel=0.01)


def test_the_conditions_hold_point_by_point() -> None:
    contact, _load, _, _ = rolled_cylinder(0.3 * MU)
    normal, along = contact.forces[:, 0], contact.forces[:, 1]
    touching = contact.states != OPEN
    assert (normal[touching] > 0).all()
    assert (normal[~touching] == 0).all()
    assert np.abs(contact.gaps[touching]).max() < 1e-7 * A
    assert (contact.gaps[~touching][1:-1] > 0).all()
    slides = contact.states == SLIP
    assert np.abs(along[slides]) == pytest.approx(MU * normal[slides], rel=1e-6)
    assert (along[slides] * contact.slips[slides, 0] < 0).all()
    assert np.abs(contact.slips[contact.states == STICK]).max() < 1e-8 * A


def test_the_parameters_of_the_search_do_not_matter() -> None:
    """N - gap/a and t - w/b hold for any a and b: a factor 10 000 between them leaves the forces as they are."""
    small, large = (rolled_cylinder(0.4 * MU, scale)[0] for scale in (0.03, 300.0))
    assert np.abs(small.forces - large.forces).max() < 1e-7 * np.abs(large.forces).max()
    assert (small.states == large.states).all()


def brush(s: float, component: int = 1) -> tuple[float, float]:
    """Force over mu F_z and moment over mu F_z a of bristles under a parabolic pressure; s = C tan(a)/(3 mu F_z)."""
    count, friction = 401, 0.7
    step = 2.2 * A / count
    x, normal, tangential = positions(count, step), 1e-3, 2e-3
    gaps = (x**2 - A**2) / 2
    load = float((np.maximum(-gaps, 0) / normal).sum())
    stiffness = 2 * A**2 / (tangential * step)
    creep = 3 * friction * load * s / stiffness
    problem = RollingContact(
        bristles(count, normal, tangential), gaps, rigid(count, step, creep, component), np.full(count, friction)
    )
    forces = problem.solve().forces
    side = -forces[:, 1 + component]
    return side.sum() / (friction * load), float((x * side).sum()) / (friction * load * A)


@pytest.mark.parametrize("s", [0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0, 1.3])
@pytest.mark.parametrize("component", [0, 1])
def test_brush(s: float, component: int) -> None:
    """F/(mu F_z) = 3 s - 3 s^2 + s^3; M_z/(mu F_z a) = s (1 - s)^3."""
    force, moment = brush(s, component)
    part = min(s, 1.0)
    assert force == pytest.approx(3 * part - 3 * part**2 + part**3, rel=0.005)
    assert -moment == pytest.approx(part * (1 - part) ** 3, abs=0.001)


def test_string_on_an_elastic_bed() -> None:
    """Without sliding: cornering stiffness 2 c (sigma + a)^2, aligning stiffness 2 c a (sigma (sigma + a) + a^2/3)."""
    count, tension, bed, angle = 601, 2.0, 3.0, 1e-3
    step, sigma = 3.0 * A / count, np.sqrt(tension / bed)
    x = positions(count, step)
    gaps = np.where(np.abs(x) < A, -1.0, 1.0)
    problem = RollingContact(
        string(count, step, tension, bed, 1e-3), gaps, rigid(count, step, angle, 1), np.full(count, 1e6)
    )
    solved = problem.solve()
    side = -solved.forces[:, 2]
    assert side.sum() / angle == pytest.approx(2 * bed * (sigma + A) ** 2, rel=0.003)
    # The force rises at first with the stiffness of the contact that sticks: relaxation length sigma + a.
    lateral = standing_stiffness(problem.body, solved.states).lateral
    assert side.sum() / angle / lateral == pytest.approx(sigma + A, rel=0.003)
    assert -(x * side).sum() / angle == pytest.approx(2 * bed * A * (sigma * (sigma + A) + A**2 / 3), rel=0.005)


def test_beam_on_an_elastic_bed() -> None:
    """With 1/b in place of sigma the string's cornering stiffness, 2 c (a + 1/b)^2; aligning stiffness
    c (2 a^3/3 + 2 a^2/b + 2 a/b^2 + 1/b^3). The slope is continuous at the front, and no couple acts there."""
    count, bending, bed, angle = 601, 0.05, 3.0, 1e-3
    step, length = 3.0 * A / count, (4 * bending / bed) ** 0.25
    x = positions(count, step)
    gaps = np.where(np.abs(x) < A, -1.0, 1.0)
    body = beam(count, step, bending, bed, 1e-3)
    side = -RollingContact(body, gaps, rigid(count, step, angle, 1), np.full(count, 1e9)).solve().forces[:, 2]
    assert side.sum() / angle == pytest.approx(2 * bed * (A + length) ** 2, rel=0.004)
    aligning = bed * (2 * A**3 / 3 + 2 * A**2 * length + 2 * A * length**2 + length**3)
    assert -(x * side).sum() / angle == pytest.approx(aligning, rel=0.01)


def test_without_friction_nothing_pulls() -> None:
    contact, load, _, _ = rolled_cylinder(0.5 * MU, friction=0.0)
    assert np.abs(contact.forces[:, 1:]).max() == 0.0
    assert contact.forces[:, 0].sum() == pytest.approx(load, rel=1e-8)


def test_a_body_that_does_not_touch_is_refused() -> None:
    body = bristles(5, 1e-3, 1e-3)
    arms = np.zeros((5, 3))
    arms[:, 0] = 1.0
    load = Control(np.zeros(5), np.zeros((5, 2)), arms, 1.0)
    with pytest.raises(InputError, match="does the body touch"):
        RollingContact(body, np.ones(5), np.zeros((5, 2)), np.ones(5), [load]).solve(values=[0.0])


def test_a_start_far_from_the_road_ends_at_the_contact() -> None:
    """No point would touch at the first deflection: those that carried the load before close."""
    count, normal, load = 41, 1e-3, 50.0
    arms, touching = np.zeros((count, 3)), np.ones(count)
    arms[:, 0] = 1.0
    sought = Control(-touching, np.zeros((count, 2)), arms, load)
    problem = RollingContact(
        bristles(count, normal, 2e-3), positions(count, 0.05) ** 2, np.zeros((count, 2)), np.ones(count), [sought]
    )
    contact = problem.solve(values=[0.5])
    again = problem.solve(contact, values=[-100.0])
    np.testing.assert_allclose(again.forces, contact.forces, atol=1e-6)
    assert again.controls == pytest.approx(contact.controls)
    rough = replace(problem, accuracy=1e-2).solve(contact, values=[-100.0])
    assert rough.steps <= again.steps
    assert rough.forces[:, 0].sum() == pytest.approx(load, rel=0.02)


def test_a_step_that_is_half_open_drags_a_bristle_by_half() -> None:
    """A bristle at the front of the contact has been dragged only since it touched."""
    count, step, slip, tangential = 5, 1.0, 1e-3, 2e-3
    gaps = np.array([1.0, -1.0, -1.0, 1.0, 1.0])
    dragged = []
    for open_share in (0.0, 0.5):
        before = np.array([0.0, 0.0, open_share, 0.0, 0.0])
        body = bristles(count, 1e-3, tangential)
        body = ContactBody(body.compliance, body.upstream, before=before)
        contact = RollingContact(body, gaps, rigid(count, step, slip, 1), np.full(count, 1e6)).solve()
        dragged.append(-contact.forces[1:3, 2] * tangential / slip)
    assert dragged[0] == pytest.approx([2.0, 1.0], rel=1e-6)
    assert dragged[1] == pytest.approx([1.5, 0.5], rel=1e-6)


def test_a_block_of_the_compliance_moves_points_as_the_whole_does() -> None:
    """Forces on some points, the motion of others, with turned axes and common motions."""
    generator = np.random.default_rng(7)
    count, rows, columns = 6, np.array([1, 2, 5]), np.array([0, 2, 3, 4])
    root = generator.normal(size=(3 * count, 3 * count))
    axes = np.linalg.qr(generator.normal(size=(count, 3, 3)))[0]
    common = (generator.normal(size=(count, 3, 2)), np.array([[2.0, 0.3], [0.3, -1.0]]))
    body = ContactBody((root @ root.T).reshape(count, 3, count, 3), np.arange(count), axes=axes, common=common)
    forces = np.zeros((count, 3))
    forces[columns] = generator.normal(size=(len(columns), 3))
    moved = np.tensordot(body.block(rows, columns), forces[columns], axes=2)
    np.testing.assert_allclose(moved, body.displacement(forces)[rows], rtol=1e-10)
