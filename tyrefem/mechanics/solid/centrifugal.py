"""Centrifugal load of a spinning axisymmetric body."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.solid.elements import Rings

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Centrifugal:
    """Load of a body that spins with W, N per radian: f_i = W^2 int rho_0 N_i r r_0 dA_0 along r.

    The place r = R + u_r is interpolated with the same functions N, so f = W^2 M (R + u_r), linear in u.

    Parameters
    ----------
    rings : shape functions of the undeformed body.
    density : (n_elements, n_points) kg/m3 of the undeformed volume.
    angular_speed : W, rad/s.
    """

    rings: Rings
    density: Array
    angular_speed: float

    @functools.cached_property
    def mass(self) -> Any:
        """M, sparse (n_nodes, n_nodes), kg per radian."""
        import scipy.sparse as sp

        rings = self.rings
        local = np.einsum("eq,qa,qb->eab", self.density * rings.weights, rings.values, rings.values)
        nodes, n = rings.element_nodes, rings.n_nodes
        place = (np.repeat(nodes, nodes.shape[1], axis=1).ravel(), np.tile(nodes, (1, nodes.shape[1])).ravel())
        return sp.coo_matrix((local.ravel(), place), shape=(n, n)).tocsc()

    def force(self, places: Array) -> Array:
        """(2 n_nodes,) force on nodes at places (2, n_nodes), m, N per radian."""
        forces = np.zeros(places.shape)
        forces[0] = self.angular_speed**2 * (self.mass @ places[0])
        return forces.T.ravel()

    @property
    def stiffness(self) -> Any:
        """Derivative of `force` by the displacement: sparse (2 n_nodes, 2 n_nodes), N/m per radian."""
        import scipy.sparse as sp

        return sp.kron(self.angular_speed**2 * self.mass, sp.diags([1.0, 0.0]), format="csc")

    def at(self, share: float) -> Centrifugal:
        """A share of the load."""
        return replace(self, angular_speed=self.angular_speed * float(np.sqrt(share)))
