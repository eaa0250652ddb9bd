"""Checks that the layers fit the meridian: no folding, no crossing, no gaps."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.geometry.layer import Layered
from tyrefem.geometry.outlines import face, stations

Array = NDArray[np.float64]


def check_possible(section: Layered) -> None:
    """Raise `InputError` with field and reason if the layers cannot be laid along the meridian."""
    _check_ends(section)
    length = section.line.length
    s = stations(section, 0.0, length, length / 120)
    _check_folding(section, np.concatenate([s, _beside_kinks(section.breaks)]))
    _check_crossing(section, s)
    _check_belts(section, s)


def _beside_kinks(breaks: tuple[float, ...]) -> Array:
    """Stations just before and just after every kink, where the curvature may jump."""
    inner = np.asarray(breaks[1:-1])
    return np.concatenate([inner * (1 - 1e-12), inner * (1 + 1e-12)])


def _check_ends(section: Layered) -> None:
    length = section.line.length
    for layer in section.layers:
        if abs(layer.regions.ends[-1] - length) > 1e-9:
            raise InputError(
                f"regions of '{layer.name}' must end where the section ends, at {length:g} m", field="layers"
            )
    if abs(section.outer.ends[-1] - length) > 1e-9:
        raise InputError(f"must end where the section ends, at {length:g} m", field="boundaries")
    taken = {"contained_air", "symmetry"} & set(section.outer.names)
    if taken:
        raise InputError(f"'{taken.pop()}' is the name of another boundary", field="boundaries")


def _check_folding(section: Layered, s: Array) -> None:
    faces = section.interfaces(s)
    stretch = 1 + section.line.curvature(s) * faces
    if (stretch <= 1e-3).any():
        which, where = np.unravel_index(int(np.argmin(stretch)), stretch.shape)
        side = "inner" if faces[which, where] < 0 else "outer"
        raise InputError(
            f"the {side} surface folds at s = {s[where]:.4g} m: it lies {abs(faces[which, where]):.3g} m from a"
            f" meridian whose radius of curvature is {1 / abs(section.line.curvature(s)[where]):.3g} m",
            field="layers",
        )


def _check_belts(section: Layered, s: Array) -> None:
    """Check that regions with 'belt' in their name end before the section turns inwards."""
    widest = float(s[int(np.argmax(section.line.position(s)[:, 1]))])
    for index, layer in enumerate(section.layers):
        for name, _, end in layer.regions.parts():
            if "belt" in name and end > widest:
                raise InputError(
                    f"belt '{name}' is wider than the section: it ends {end:.4g} m from the crown, and the section"
                    f" turns inwards {widest:.4g} m from it",
                    field=f"layers.{index}.regions",
                )


def _check_crossing(section: Layered, s: Array) -> None:
    """Check that the half outline is above the axis and on its side of the mid plane, and does not cross itself."""
    inner, outer = face(section, 0, s), face(section, len(section.layers), s)
    both = np.concatenate([inner, outer])
    if both[:, 0].min() <= 0:
        raise InputError(
            f"the section reaches the wheel's axis: r = {both[:, 0].min():.3g} m", field="parameters.outer_diameter"
        )
    for which, points in (("inner", inner), ("outer", outer)):
        if points[1:, 1].min() <= 0:
            at = s[1 + int(np.argmax(points[1:, 1] <= 0))]
            raise InputError(
                f"the {which} surface crosses the mid plane at s = {at:.4g} m and would meet the other side",
                field="parameters",
            )
    if _crosses_itself(np.concatenate([inner, outer[::-1]])):
        raise InputError("the outline crosses itself: the layers overlap", field="parameters")


def _crosses_itself(polygon: Array) -> bool:
    """True if two edges of a closed polygon that are not neighbours cross."""
    n = len(polygon)
    along = np.roll(polygon, -1, axis=0) - polygon
    across = np.column_stack([-along[:, 1], along[:, 0]])
    # On which side of edge i corner j lies; the corners of the edge itself and of its neighbours count as on it.
    side = across @ polygon.T - np.sum(across * polygon, axis=1)[:, None]
    each = np.arange(n)
    side[each, each] = side[each, (each + 1) % n] = 0.0
    split = side * np.roll(side, -1, axis=1) < 0
    return bool((split & split.T).any())
