"""Bodies whose answer is known: ring, tube, hollow torus."""

from __future__ import annotations

from typing import Any

import numpy as np
import skfem


def block(r: Any, z: Any, **boundaries: Any) -> skfem.MeshQuad:
    """Rectangles on a grid of r and z; boundaries: name -> function of (r, z) of the facets' middles."""
    mesh = skfem.MeshQuad.init_tensor(np.asarray(r, dtype=float), np.asarray(z, dtype=float))
    middles = mesh.p[:, mesh.facets].mean(axis=1)
    return mesh.with_boundaries({name: np.flatnonzero(law(*middles)) for name, law in boundaries.items()})


def half_torus(
    centre: float = 0.3, inner: float = 0.05, outer: float = 0.06, around: int = 16, through: int = 2
) -> Any:
    """Upper half of a hollow torus, closed by its mid plane z = 0."""
    flat = skfem.MeshQuad.init_tensor(np.linspace(inner, outer, through + 1), np.linspace(0, np.pi, around + 1))
    rho, angle = flat.p
    mesh = skfem.MeshQuad(np.array([centre + rho * np.cos(angle), rho * np.sin(angle)]), flat.t, sort_t=False)
    rho, angle = flat.p[:, flat.facets].mean(axis=1)
    return mesh.with_boundaries({
        "contained_air": np.flatnonzero(rho < inner + 1e-9),
        "symmetry": np.flatnonzero((angle < 1e-9) | (angle > np.pi - 1e-9)),
    })  # fmt: skip
