"""Equilibrium of a body inside a rigid frictionless cylinder: Newton with an active set, no penalty."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.solid.body import Body
from tyrefem.mechanics.solid.compounds import determinant
from tyrefem.mechanics.solid.elements import Indices
from tyrefem.mechanics.solid.newton import ROUND_OFF, StuckError, out_of_balance, place_words

Array = NDArray[np.float64]
#: A contact is closed when the gap is below this share of the cylinder's radius.
CLOSED = 1e-12


@dataclass(frozen=True)
class CylinderChoice:
    """Settings of the search for equilibrium. ``tolerance``: unbalanced force over that of pressure and contact.
    ``iterations``: most per step. ``first_step``, ``smallest_step``: of the deflection, over the radius. ``halvings``:
    most of a Newton step that folds the mesh."""

    tolerance: float = 1e-9
    iterations: int = 25
    first_step: float = 0.015
    smallest_step: float = 1e-4
    halvings: int = 3


def equilibrium_inside(
    body: Body, pressure: float, nodes: Indices, start: Array, forces: Array, radius: float, choice: CylinderChoice
) -> tuple[Array, Array, tuple[float, ...]]:
    """The body inside one cylinder: displacement, contact forces, history of the unbalanced force.

    u_r <= radius - r and inward force >= 0 at every node of the contact, never both. A node is closed where
    force - stiffness * gap > 0 (primal-dual active set; Hintermuller, Ito & Kunisch 2003); a Newton step closes its
    gap.

    Parameters
    ----------
    pressure : of the gas, Pa, constant. nodes : of the contact. radius : of the cylinder, m.
    start, forces : displacement (2, n_nodes), m, and inward forces (n_contact_nodes,), N per radian, to start from.

    Raises
    ------
    StuckError : no balance, or the mesh folds.
    """
    from scipy.sparse.linalg import splu

    now, history = start, []
    closed, largest_change = np.zeros(len(nodes), dtype=bool), np.inf
    for _ in range(choice.iterations + 1):
        if (at := _folded(body, now)) is not None:
            raise StuckError(at)
        residual = body.residual(now, pressure)
        matrix = body.stiffness(now, pressure)
        gaps = radius - body.rings.nodes[0, nodes] - now[0, nodes]
        before = closed
        # Any positive stiffness gives the same sets once gaps or forces vanish; the matrix's diagonal has the right
        # units.
        closed = forces - matrix.diagonal()[2 * nodes] * gaps > 0
        held = 2 * nodes[closed]
        free = np.setdiff1d(body.free, held)
        size = pressure * np.linalg.norm(body.load(now)[body.free]) + np.linalg.norm(residual[held])
        history.append(float(np.linalg.norm(residual[free]) / size) if size else 0.0)
        gaps_closed = np.abs(gaps[closed]).max(initial=0.0) <= CLOSED * radius
        converged = history[-1] <= choice.tolerance or largest_change <= ROUND_OFF * radius
        if converged and gaps_closed and np.isfinite(largest_change) and (closed == before).all():
            return now, np.where(closed, -residual[2 * nodes], 0.0), tuple(history)
        if not np.isfinite(history[-1]):
            break
        change = np.zeros(residual.shape)
        change[held] = gaps[closed]
        try:
            change[free] = -splu(matrix[free][:, free].tocsc()).solve((residual + matrix @ change)[free])
        except RuntimeError:
            raise StuckError("nothing holds the body: its stiffness is singular") from None
        share = 1.0
        for _ in range(choice.halvings):
            if _folded(body, now + share * change.reshape(-1, 2).T) is None:
                break
            share /= 2
        now, largest_change = now + share * change.reshape(-1, 2).T, float(np.abs(change).max())
        forces = np.where(closed, -(residual + matrix @ change)[2 * nodes], 0.0)
    raise StuckError(out_of_balance(body, residual, free))


def _folded(body: Body, displacement: Array) -> str | None:
    """Description of a place where an element is inverted; None: there is none."""
    f = body.deformation(displacement)
    volume = np.minimum(determinant(f), f[2, 2])
    if (volume > 0).all():
        return None
    element = int(np.unravel_index(int(volume.argmin()), volume.shape)[0])
    return f"the mesh folds {place_words(body, body.rings.points[:, element].mean(axis=-1), element)}"
