"""The state of an inflated body, as a small further motion sees it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief

if TYPE_CHECKING:
    from tyrefem.solid.finite_law import FiniteLaw

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Prestressed(Brief):
    """An axisymmetric body in its present (deformed) configuration.

    Components run rr, zz, tt, rz, rt, zt, with engineering shears; points are the 3 x 3 Gauss points of
    ``skfem.Basis(mesh, ElementQuad2(), intorder=5)``.

    Parameters
    ----------
    mesh : skfem ``MeshQuad``, (r, z) in m, subdomains and boundaries named.
    stress : (6, n_elements, n_points) Cauchy stress, Pa.
    tangent : (6, 6, n_elements, n_points) c with d(Truesdell stress) = c : e, Pa, without the bulk stiffness.
    bulk : (n_elements, n_points) bulk stiffness, Pa, that acts on the projected dilatation.
    storage : (6, 6, n_elements, n_points) the part of ``tangent`` that dissipates, Pa.
    pressure : gauge pressure, Pa, that follows the boundary ``pressurised``.
    fixed : boundaries that are held.
    pressurised, tread : boundaries under pressure, and that may touch the road.
    support : sparse (3 n_nodes, 3 n_nodes) stiffness of what the body lies on, N/m per radian, component c of (r, z, t)
        of node i at 3 i + c; alike for every harmonic. None: nothing but ``fixed``.
    rim_top : largest radius of the rim, m, where it is more than that of ``fixed``.
    symmetric : boundary on the mid plane of a half section, where u_z = 0; a mesh without it is a full section.
    law : stress in further motions of any size (`solid.finite_law`); None: linear in Green's strain.
    """

    mesh: Any
    stress: Array
    tangent: Array
    bulk: Array
    storage: Array
    pressure: float
    fixed: tuple[str, ...] = ("rim",)
    pressurised: str = "contained_air"
    tread: str = "road"
    symmetric: str = "symmetry"
    support: Any = None
    rim_top: float = 0.0
    law: FiniteLaw | None = None
