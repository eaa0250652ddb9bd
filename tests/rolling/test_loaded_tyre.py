"""Small motions about a footprint in large motion, and what they make of friction."""

from __future__ import annotations

import functools
import math
from dataclasses import replace

import numpy as np
import pytest

from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.example_tyre import PlainTyre
from tyrefem.mechanics.footprint.footprint import Footprint
from tyrefem.mechanics.footprint.harmonic_balance import Balance
from tyrefem.mechanics.footprint.nonlinear import NonlinearForces
from tyrefem.mechanics.rolling.loaded_compliance import LoadedCompliance
from tyrefem.mechanics.rolling.loaded_tyre import MotionFamily, TyreOnFootprint
from tyrefem.mechanics.rolling.points_on_wheel import PointsOnWheel
from tyrefem.mechanics.rolling.pressed_shape import PressedShape
from tyrefem.mechanics.rolling.rolled import RolledTyre
from tyrefem.mechanics.rolling.rolling_motion import RollingMotion
from tyrefem.mechanics.rolling.steady_rolling import RollingLoads, SteadyRolling
from tyrefem.mechanics.rolling.tread_influence import TreadInfluence

DEFLECTION, WAVES, HARMONICS = 0.015, 24, 120


@functools.lru_cache(1)
def pressing() -> Pressing:
    return Pressing(PlainTyre().state(along=6))


@functools.lru_cache(2)
def footprint(deflection: float = DEFLECTION) -> Footprint:
    return Balance(pressing(), WAVES, HARMONICS, tolerance=1e-4).at_deflection(deflection)


@functools.lru_cache(1)
def tyre() -> TyreOnFootprint:
    return TyreOnFootprint(footprint(), TreadInfluence(pressing().tread))


def family(odd: bool, antisymmetric: bool) -> MotionFamily:
    return next(f for f in tyre().families if (f.odd, f.antisymmetric) == (odd, antisymmetric))


def loads_of(footprint: Footprint) -> np.ndarray:
    """Amplitudes of the road's forces on the tread, N per radian."""
    grid = footprint.grid
    loads = grid.load_harmonics(-footprint.direction * footprint.forces)[: WAVES + 1]
    made = np.zeros((WAVES + 1, 3, len(grid.tread.nodes)))
    made[:, list(grid.tread.components)] = loads
    return made


def moved(motion: np.ndarray, others: np.ndarray) -> float:
    """Largest difference of two motions over the largest motion."""
    return float(np.abs(motion - others).max() / np.abs(others).max())


@pytest.mark.parametrize(
    ("odd", "harmonic", "amplitudes"),
    [(False, 1, (1, 0, -1)), (True, 1, (1, 0, -1)), (False, 0, (0, 1, 0))],
    ids=["down", "forward", "sideways"],
)
def test_the_loaded_tyre_moves_as_a_whole_without_forces(
    odd: bool, harmonic: int, amplitudes: tuple[int, int, int]
) -> None:
    inner = NonlinearForces(pressing().harmonics, WAVES)
    tangent = replace(inner.at(tyre().motion), outside=replace(inner, odd=odd))
    motion = np.zeros_like(tyre().motion)
    for component, amplitude in enumerate(amplitudes):
        motion[harmonic, component::3] = amplitude
    stretched = motion.copy()
    stretched[harmonic, 0::3] += 1e-2
    assert np.abs(tangent.product(motion)).max() < 1e-9 * np.abs(tangent.product(stretched)).max()


def test_forces_that_turn_with_the_footprint_turn_its_motion() -> None:
    """C_t f0' = u0': the forces of a footprint that turns round the wheel move the tread with it; the inflated tyre
    would move otherwise."""
    turning = family(True, False)
    per_radian = -np.arange(WAVES + 1)[:, None, None]
    forces = turning.free(per_radian * loads_of(footprint()))
    motion = turning.free(per_radian * tyre().motion[:, turning.tread])
    assert moved(turning.of_loaded(forces)[:, turning.tread], motion) < 0.03
    assert moved(turning.of_inflated(forces), motion) > 0.1


def test_more_load_moves_the_tread_as_a_small_motion() -> None:
    """Between two footprints 0.5 mm apart."""
    pressed, more = footprint(), footprint(DEFLECTION + 5e-4)
    down = family(False, False)
    assert more.balanced is not None
    forces = down.free(loads_of(more) - loads_of(pressed))
    motion = down.free(more.balanced[:, down.tread] - tyre().motion[:, down.tread])
    work, inflated = (
        down.work(forces, down.of_loaded(forces)[:, down.tread]),
        down.work(forces, down.of_inflated(forces)),
    )
    assert work == pytest.approx(down.work(forces, motion), rel=0.03)
    assert abs(inflated - down.work(forces, motion)) > 0.1 * work


def test_families_do_work_as_points_do() -> None:
    """Loads of a family are those of the forces on the points of both sides."""
    angles = np.linspace(-0.3, 0.3, 7)
    points = PointsOnWheel(tyre().influence, HARMONICS, angles)
    generator = np.random.default_rng(1)
    forces = generator.normal(size=(7, 3, len(tyre().influence.places[0])))
    for family in tyre().families:
        motion = family.free(generator.normal(size=(WAVES + 1, *family.tread.shape)))
        at_points = points.displacements(family, motion[None])[..., 0]
        assert family.work(points.loads(family, forces, WAVES + 1), motion) == pytest.approx(
            float((forces * at_points).sum())
        )


def rolled(friction: float, angle: float, loaded: bool, rest: float = 1e-3) -> RolledTyre:
    shape = PressedShape(footprint(), loaded=LoadedCompliance(tyre(), rest=rest) if loaded else None)
    pressed = footprint()
    steady = SteadyRolling(pressing(), friction=friction, shape=shape)
    guess = (pressed.deflection, pressed.rolling_radius)
    motion = RollingMotion(math.radians(angle), speed=20.0)
    along = {"torque": 0.0} if friction else {"travel": pressed.rolling_radius}
    return steady.roll(motion, RollingLoads(load=pressed.load, **along), HARMONICS, guess=guess)


def test_without_friction_it_is_the_footprint() -> None:
    state = rolled(0.0, 0.0, True)
    assert state.deflection == pytest.approx(footprint().deflection, rel=2e-3)
    assert state.pressure.max() == pytest.approx(footprint().pressure.max(), rel=0.02)


def test_the_loaded_tyre_yields_more_to_the_side_and_takes_no_work() -> None:
    soft, stiff = rolled(0.8, 1.0, True), rolled(0.8, 1.0, False)
    assert soft.grid.shape is not None
    assert soft.grid.shape.loaded is not None
    assert {key.antisymmetric for key in soft.grid.shape.loaded.known} == {False, True}
    assert abs(soft.force[1] - stiff.force[1]) > 0.005 * abs(stiff.force[1])
    assert abs(soft.balance) < 0.03


def test_forces_settle_with_what_is_known_of_the_loaded_tyre() -> None:
    states = [rolled(0.8, 1.0, True, rest) for rest in (1e-2, 1e-3, 1e-5)]
    sizes = [len(known.forces) for state in states for known in state.grid.shape.loaded.known.values()]  # type: ignore[union-attr]
    assert len(states[0].grid.shape.loaded.known) > 0  # type: ignore[union-attr]
    assert sizes[-1] > sizes[0]
    coarse, usual, fine = (state.force for state in states)
    assert np.linalg.norm(usual - fine) < 0.01 * np.linalg.norm(fine[:2])
    assert np.linalg.norm(usual - fine) < np.linalg.norm(coarse - fine)


def test_known_forces_move_the_tread_as_the_loaded_tyre() -> None:
    state = rolled(0.8, 1.0, True)
    shape, forces = state.grid.shape, state.grid.shape_forces
    assert shape is not None
    assert shape.loaded is not None
    assert forces is not None
    points = state.grid.points_on_wheel()
    added = np.moveaxis(state.components, 2, 1) - forces
    assert shape.loaded.knowing(points, added) is shape.loaded
    sideways = family(False, True)
    loads = points.loads(sideways, added, WAVES + 1)
    more = sideways.of_loaded(loads)[:, sideways.tread] - sideways.of_inflated(loads)
    weights, motions = shape.loaded.weights, shape.loaded.motions(points)
    model = motions @ (weights @ np.tensordot(added, motions, axes=3))
    wanted = float((added * points.displacements(sideways, more[None])[..., 0]).sum())
    alone = replace(shape.loaded, known={sideways: shape.loaded.known[sideways]})
    of_family = alone.motions(points)
    got = float((added * (of_family @ (alone.weights @ np.tensordot(added, of_family, axes=3)))).sum())
    assert got == pytest.approx(wanted, rel=0.05)
    assert np.isfinite(model).all()
