"""Stiffness of a standing tyre along the road: the wheel is pushed sideways or forward while the tread sticks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tyrefem.mechanics.rolling.contact_body import COMPONENTS, ContactBody
from tyrefem.mechanics.rolling.friction import OPEN, States
from tyrefem.mechanics.rolling.rolled import RolledTyre


@dataclass(frozen=True)
class StandingStiffness:
    """Force of the road per small displacement of the wheel, N/m, that does not turn: forward, and to the left."""

    longitudinal: float
    lateral: float


def standing_stiffness(body: ContactBody, states: States) -> StandingStiffness:
    """Stiffness of the points that touch, all of which stick and stay closed: C f = d, sum of f over d.

    So long as the push is small no point slips or opens: this is the slope at zero of the force over displacement.

    Parameters
    ----------
    body : compliance (k, 3, k, 3). states : (k,) of the contact.

    >>> bristles = ContactBody(np.eye(6).reshape(2, 3, 2, 3) / 1e5, np.array([1, -1]))
    >>> stiffness = standing_stiffness(bristles, np.array([1, 1], dtype=np.int8))
    >>> round(stiffness.longitudinal), round(stiffness.lateral)
    (200000, 200000)
    """
    index = np.flatnonzero(states != OPEN)
    size = COMPONENTS * len(index)
    compliance = body.compliance[index][:, :, index].reshape(size, size)
    pushed = np.zeros((size, 2))
    pushed[1::COMPONENTS, 0] = pushed[2::COMPONENTS, 1] = 1.0
    forces = np.linalg.solve(compliance, pushed)
    along, left = (float(pushed[:, k] @ forces[:, k]) for k in (0, 1))
    return StandingStiffness(along, left)


def standing(rolled: RolledTyre) -> StandingStiffness:
    """Stiffness of a tyre that stands where it rolled."""
    grid = rolled.grid
    body = ContactBody(grid.compliance(rolled.axes), grid.upstream, grid.turns(rolled.axes))
    return standing_stiffness(body, rolled.contact.states)
