"""The critical plane of every point: that on which it lasts the shortest."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
#: Directions of the first search over the half sphere, about 7 degrees apart.
DIRECTIONS = 400
#: Directions round the best one in a refinement, refinements, and last step, rad.
AROUND, REFINEMENTS, LAST = 8, 14, np.radians(0.3)
#: First step of a refinement over the distance of the directions: a whole one leaves narrow hills.
FIRST = 0.5
#: Directions from which the search is refined, and the least angle between them, rad.
STARTS, DISTINCT = 5, np.radians(10.0)


def half_sphere(count: int = DIRECTIONS) -> Array:
    """(count, 3) unit vectors with z >= 0, evenly spread: a Fibonacci lattice. A plane has two normals; one suffices.

    >>> directions = half_sphere(100)
    >>> directions.shape, bool((directions[:, 2] > 0).all()), abs(directions.mean(axis=0)).round(2).tolist()
    ((100, 3), True, [0.0, 0.0, 0.5])
    """
    number = np.arange(count) + 0.5
    height = 1 - number / count
    angle = np.pi * (1 + np.sqrt(5)) * number
    radius = np.sqrt(1 - height**2)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), height], axis=-1)


def around(normals: Array, steps: Array) -> Array:
    """(points, `AROUND` + 1, 3) unit vectors: normals (points, 3), and a ring about each at an angle (points,), rad."""
    normals = np.asarray(normals, dtype=float)
    helper = np.zeros_like(normals)
    helper[np.arange(len(normals)), np.abs(normals).argmin(axis=1)] = 1.0
    first = np.cross(normals, helper)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(normals, first)
    turn = 2 * np.pi * np.arange(AROUND) / AROUND
    ring = np.cos(turn)[:, None] * first[:, None] + np.sin(turn)[:, None] * second[:, None]
    ring = np.cos(steps)[:, None, None] * normals[:, None] + np.sin(steps)[:, None, None] * ring
    return np.concatenate([normals[:, None], ring], axis=1)


def starts(values: Array, directions: Array) -> list[NDArray[np.int64]]:
    """`STARTS` directions of each point, (points,) each: the best ones that are at least `DISTINCT` from each other."""
    far = np.abs(directions @ directions.T) < np.cos(DISTINCT)
    remaining, chosen = values.copy(), []
    for _ in range(STARTS):
        chosen.append(remaining.argmax(axis=1))
        remaining = np.where(far[chosen[-1]], remaining, -1.0)
    return chosen


def critical_planes(damage: Callable[[Array], Array], points: int) -> tuple[Array, Array]:
    """Normals (points, 3) of the planes of greatest damage, and the damage (points,).

    The best ones of `half_sphere` move to the best of a ring about each; where one is itself the best, its ring is
    halved.

    Parameters
    ----------
    damage : a function from normals, (planes, 3) of all points or (points, planes, 3), to damage (points, planes) >= 0.
    """
    directions = half_sphere()
    values = damage(directions)
    refined = [_refined(damage, directions[start], points) for start in starts(values, directions)]
    normals, largest = (np.stack(parts) for parts in zip(*refined, strict=True))
    best, rows = largest.argmax(axis=0), np.arange(points)
    return normals[best, rows], largest[best, rows]


def _refined(damage: Callable[[Array], Array], normals: Array, points: int) -> tuple[Array, Array]:
    rows, steps = np.arange(points), np.full(points, FIRST * np.sqrt(2 * np.pi / DIRECTIONS))
    largest = np.zeros(points)
    for _ in range(REFINEMENTS):
        candidates = around(normals, steps)
        values = damage(candidates)
        best = values.argmax(axis=1)
        normals, largest = candidates[rows, best], values[rows, best]
        steps[best == 0] /= 2
        if (steps < LAST).all():
            break
    return normals, largest
