"""A contact whose points all stick while the wheel is pushed along the road: forces, and compliance in large motion."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.rolling.contact_body import COMPONENTS, ContactBody
from tyrefem.mechanics.rolling.friction import OPEN, States
from tyrefem.mechanics.rolling.loaded_compliance import LoadedCompliance
from tyrefem.mechanics.rolling.loaded_tyre import TyreOnFootprint
from tyrefem.mechanics.rolling.rolling_grid import RollingGrid

Array = NDArray[np.float64]
#: Most rounds in which forces of a push become known.
ROUNDS = 6


def push_forces(body: ContactBody, states: States) -> Array:
    """(2, k, 3) forces of the road on the points, N/m, per displacement of the road forward, and to the left."""
    index = np.flatnonzero(states != OPEN)
    size = COMPONENTS * len(index)
    compliance = body.compliance[index][:, :, index].reshape(size, size)
    pushed = np.zeros((size, 2))
    pushed[1::COMPONENTS, 0] = pushed[2::COMPONENTS, 1] = 1.0
    forces = np.zeros((2, len(states), COMPONENTS))
    forces[:, index] = np.linalg.solve(compliance, pushed).T.reshape(2, -1, COMPONENTS)
    return forces


def pushed_body(grid: RollingGrid, axes: Array, states: States, tyre: TyreOnFootprint | None) -> ContactBody:
    """Compliance of the points along their ``axes`` (k, 3, 3) under pushes, where ``states`` (k,) are not open.

    ``tyre``: in its footprint in large motion. The forces of both pushes then move the points as it does:
    `LoadedCompliance` makes them known. None: small motion about the inflated tyre.

    Raises
    ------
    InputError : the footprint is not stable.
    """
    inflated = grid.compliance(axes)
    body = ContactBody(inflated, grid.upstream, grid.turns(axes))
    if tyre is None:
        return body
    # The motions are those of K: no shape turns beside them.
    points, loaded = grid.points_on_wheel(), LoadedCompliance(tyre, turning=False)
    for _ in range(ROUNDS):
        before = loaded
        for forces in push_forces(body, states):
            vectors = np.einsum("kax,ka->kx", axes, forces).reshape(len(grid.angles), -1, COMPONENTS)
            loaded = loaded.knowing(points, np.einsum("jpx,jcx->jcp", vectors, grid.wheel_axes))
        if loaded is before:
            break
        motions = np.einsum("jcx,jcpn->jpxn", grid.wheel_axes, loaded.motions(points))
        along = np.einsum("kax,kxn->kan", axes, motions.reshape(grid.n_points, COMPONENTS, -1))
        more = np.einsum("kan,nm,lbm->kalb", along, loaded.weights, along, optimize=True)
        body = ContactBody(inflated + more, grid.upstream, grid.turns(axes))
    return body
