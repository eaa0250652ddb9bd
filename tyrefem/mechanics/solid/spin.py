"""Inertia of a steady motion through which a body turns: dynamic stiffness, law of large motions."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.solid.body import Prestressed
from tyrefem.mechanics.solid.body_law import BodyLaw
from tyrefem.mechanics.solid.elements import Rings
from tyrefem.mechanics.solid.finite_law import StressResponse

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SpinningLaw(BodyLaw):
    """The law of a body with the inertia of a steady motion: P_kt is less by rho (W r)^2 F_kt (see `rolled`).

    ``flux`` : (e, q) rho (W r)^2 r dA, N m per radian.
    """

    flux: Array | None = None

    def response(self, gradient: Array, tangent: type | None = float) -> StressResponse:
        """The response of `BodyLaw` with that of inertia, which is linear in the motion."""
        response = super().response(gradient, tangent)
        assert self.flux is not None
        flux = self.flux[..., None]
        e, _, q, m = gradient.shape
        for k in range(3):
            component = 3 * k + 2
            response.stress[:, component] -= flux * (gradient[:, component] + (k == 2))
            if tangent is not None:
                matrix = response.tangent[:, component, component].reshape(e, q, m)
                matrix -= flux.astype(matrix.dtype)
        return response


def rolled(state: Prestressed, density: Array, angular_speed: float) -> Prestressed:
    """The state whose stiffness K_n holds the inertia of a steady motion u(theta): K_n - W^2 M_n.

    The body turns with W through a shape that stands still, D/Dt = W d/dtheta. The acceleration of a point at r + u is
    a_r = W^2 (u_r'' - 2 u_t' - u_r - r), a_t = W^2 (u_t'' + 2 u_r' - u_t), a_z = W^2 u_z''. Its virtual work
    int rho a . v r dA is that of a hoop stress -rho (W r)^2, the flux of momentum: with the gradient's third column
    (u_r' - u_t, u_z', u_t' + u_r)/r it is - int rho (W r)^2 H_kt(u) H_kt(v) r dA. In harmonic n,

    v M_n u = int rho [(n^2 + 1)(u_r v_r + u_t v_t) + 2 n (u_r v_t + u_t v_r) + n^2 u_z v_z] r dA.

    So the hoop stress of the state is lowered by rho (W r)^2; the matrices keep their sparsity and stay real and
    symmetric. Inertia is linear in the motion, also if this is large. The state must carry the centrifugal load.

    Parameters
    ----------
    density : (n_elements, n_points) kg/m3 of the present volume. angular_speed : W, rad/s.
    """
    if not angular_speed:
        return state
    rings = Rings(state.mesh)
    stress = state.stress.copy()
    momentum = density * (angular_speed * rings.radii) ** 2
    stress[2] -= momentum
    law = state.law
    if isinstance(law, BodyLaw):
        parts = (law.rings, law.parts, law.members, law.bulk_modulus, law.inflated)
        law = SpinningLaw(*parts, flux=momentum * rings.weights)
    return replace(state, stress=stress, law=law)
