"""Bodies whose rolling contact is known in closed form: a half plane, bristles, string and beam on an elastic bed."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.rolling.contact_body import COMPONENTS, NOWHERE, ContactBody
from tyrefem.mechanics.rolling.friction import Control, RollingContact

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
#: Radius of the example cylinder, m.
CYLINDER_RADIUS = 50.0


def line_upstream(count: int) -> Indices:
    """(count,) point upstream of points in a line whose material enters at the last.

    >>> line_upstream(3).tolist()
    [1, 2, -1]
    """
    return np.append(np.arange(1, count), NOWHERE)


def half_plane(count: int, step: float, modulus: float) -> ContactBody:
    """Points ``step`` (m) apart on an incompressible elastic half plane, forces per metre of width.

    A uniform traction q over a step moves the surface at x by -2 q/(pi E*) int ln|x - s| ds, alike along and across the
    surface, which do not couple. ``modulus``: E* = E/(1 - nu^2), Pa. Lateral forces are left out: a line moves to
    the side with the same compliance.
    """
    distance = step * np.abs(np.subtract.outer(np.arange(count), np.arange(count)))
    before, after = distance - step / 2, distance + step / 2

    def primitive(x: Array) -> Array:
        return np.asarray(x * np.log(np.abs(x) / (count * step)) - x)

    kernel = -2 / (np.pi * modulus * step) * (primitive(after) - primitive(before))
    return ContactBody(_uncoupled(kernel, kernel), line_upstream(count))


def cylinder(
    count: int, creep: float, friction: float, *, component: int = 0, scale: float = 1.0
) -> tuple[Array, float, RollingContact]:
    """Places (count,) over half the contact's length a = 1 m, load, N/m, and contact of an elastic cylinder on a plane.

    Radius 50 m, E* = 1 Pa, under the load pi a^2 E*/(4 R) of Hertz. ``creep``: slip over travel, along (component 0) or
    across (1) the travel. ``scale``: as of `RollingContact`. Solve it with values near [1 / 50].
    """
    radius, step = CYLINDER_RADIUS, 2.4 / count
    x = np.asarray((np.arange(count) - (count - 1) / 2) * step, dtype=float)
    load, arms, slips = np.pi / (4 * radius), np.zeros((count, 3)), np.zeros((count, 2))
    arms[:, 0], slips[:, component] = 1.0, creep * step
    sought = Control(-np.ones(count), np.zeros((count, 2)), arms, load)
    body = half_plane(count, step, 1.0)
    gaps = x**2 / (2 * radius)
    return x, load, RollingContact(body, gaps, slips, np.full(count, friction), [sought], scale)


def bristles(count: int, normal: float, tangential: float) -> ContactBody:
    """Separate bristles in a line, compliances m/N."""
    unit = np.eye(count)
    return ContactBody(_uncoupled(normal * unit, tangential * unit), line_upstream(count))


def string(count: int, step: float, tension: float, bed: float, normal: float) -> ContactBody:
    """An endless string under ``tension`` (N) on an elastic ``bed`` (N/m2), points ``step`` (m) apart; a normal
    compliance of separate points, m/N.

    A force F moves it by F exp(-|x|/sigma)/(2 bed sigma), sigma = sqrt(tension/bed).
    """
    length = np.sqrt(tension / bed)
    distance = step * np.abs(np.subtract.outer(np.arange(count), np.arange(count)))
    return ContactBody(
        _uncoupled(normal * np.eye(count), np.exp(-distance / length) / (2 * bed * length)), line_upstream(count)
    )


def beam(count: int, step: float, bending: float, bed: float, normal: float) -> ContactBody:
    """An endless beam of ``bending`` stiffness E I (N m2) on an elastic ``bed`` (N/m2), else as `string`.

    A force F moves it by F b exp(-b|x|) (cos b|x| + sin b|x|)/(2 bed), b^4 = bed/(4 bending).
    """
    inverse = (bed / (4 * bending)) ** 0.25
    turned = inverse * step * np.abs(np.subtract.outer(np.arange(count), np.arange(count)))
    kernel = inverse * np.exp(-turned) * (np.cos(turned) + np.sin(turned)) / (2 * bed)
    return ContactBody(_uncoupled(normal * np.eye(count), kernel), line_upstream(count))


def _uncoupled(normal: Array, tangential: Array) -> Array:
    count = len(normal)
    compliance = np.zeros((count, COMPONENTS, count, COMPONENTS))
    compliance[:, 0, :, 0] = normal
    for component in (1, 2):
        compliance[:, component, :, component] = tangential
    return compliance
