"""Motions kept from a search by conjugate gradients, and the searches that begin with them."""

from __future__ import annotations

import numpy as np

from tyrefem.mechanics.rolling.extreme_motions import KEPT, Direction, ExtremeMotions

SHAPE = (3, 100)
#: p K p/(p P^-1 p) of the coordinates, P = 1: a few far below and above all others.
RATIOS = np.concatenate([np.geomspace(1e-3, 0.05, 8), np.linspace(0.5, 4.0, 284), np.geomspace(20, 400, 8)])


def work(forces: np.ndarray, motion: np.ndarray) -> float:
    """n = 0 counts twice."""
    return float((forces * motion).sum() + forces[0] @ motion[0])


def stiffness(motion: np.ndarray) -> np.ndarray:
    return RATIOS.reshape(SHAPE) * motion


def search(forces: np.ndarray, known: ExtremeMotions, accuracy: float) -> tuple[np.ndarray, list[Direction]]:
    motion = known.balanced(forces)
    residual = forces - stiffness(motion)
    along, led = known.without(residual, residual)
    size, least = work(residual, residual), accuracy**2 * work(forces, forces)
    directions = []
    while size > least:
        bent = stiffness(along)
        energy = work(bent, along)
        directions.append(Direction.of(along, bent, led, energy))
        motion = motion + size / energy * along
        residual = residual - size / energy * bent
        size, before = work(residual, residual), size
        part, part_led = known.without(residual, residual)
        along, led = part + size / before * along, part_led + size / before * led
    return motion, directions


def test_a_search_from_what_is_kept_ends_at_the_same_motion_in_half_the_directions() -> None:
    generator = np.random.default_rng(2)
    none = ExtremeMotions.none(RATIOS.size)
    first, second = generator.normal(size=(2, *SHAPE))
    _, directions = search(first, none, 1e-6)
    kept = none.after(directions)
    fresh, without = search(second, none, 1e-4)
    motion, fewer = search(second, kept, 1e-4)
    exact = second / RATIOS.reshape(SHAPE)
    for answer in (fresh, motion):
        assert work(stiffness(answer - exact), answer - exact) < 1e-4 * work(second, exact)
    assert len(fewer) < 0.5 * len(without)


def test_what_is_kept_are_the_motions_of_extreme_ratio_conjugate_to_each_other() -> None:
    none = ExtremeMotions.none(RATIOS.size)
    _, directions = search(np.random.default_rng(3).normal(size=SHAPE), none, 1e-6)
    kept = none.after(directions)
    assert len(kept.motions) == KEPT
    assert np.abs(kept.motions @ kept.forces.T - np.eye(KEPT)).max() < 1e-3
    ratios = np.sort(1 / (kept.motions * kept.led).sum(axis=1))
    np.testing.assert_allclose(ratios[[0, 1, -2, -1]], RATIOS[[0, 1, -2, -1]], rtol=1e-2)


def test_a_search_no_longer_than_what_is_kept_leaves_it() -> None:
    none = ExtremeMotions.none(RATIOS.size)
    first, second = np.random.default_rng(6).normal(size=(2, *SHAPE))
    kept = none.after(search(first, none, 1e-6)[1])
    _, directions = search(second, none, 1e-6)
    assert len(directions) > KEPT
    assert kept.after(directions[:KEPT]) is kept
    assert kept.after(directions[: KEPT + 1]) is not kept
    assert none.after([]) is none


def test_forces_in_the_kept_motions_are_balanced_at_once() -> None:
    none = ExtremeMotions.none(RATIOS.size)
    _, directions = search(np.random.default_rng(4).normal(size=SHAPE), none, 1e-6)
    kept = none.after(directions)
    forces = np.random.default_rng(5).normal(size=SHAPE)
    left = forces - stiffness(kept.balanced(forces))
    assert np.linalg.norm(kept.balanced(left)) < 1e-3 * np.linalg.norm(kept.balanced(forces))
    conjugate, _ = kept.without(forces, forces)
    scaled = conjugate.copy()
    scaled[0] *= np.sqrt(2)
    assert np.abs(kept.forces @ scaled.ravel()).max() < 1e-3 * np.abs(kept.forces).max() * np.linalg.norm(forces)
