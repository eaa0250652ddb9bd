"""Simple bodies with known answers."""

from __future__ import annotations

import numpy as np
import skfem

from tyrefem.mechanics.solid.body import Body
from tyrefem.mechanics.solid.compounds import Compound, neo_hookean
from tyrefem.mechanics.solid.parts import RegionMaterial

END = 1e-9


def tube(
    n: int = 4, compound: Compound | None = None, *, inner: float = 1.0, outer: float = 2.0, height: float = 0.5
) -> Body:
    """A tube under inner pressure whose ends do not move along the axis; n x 2 elements."""
    mesh = skfem.MeshQuad.init_tensor(np.linspace(inner, outer, n + 1), np.linspace(0, height, 3))
    mesh = mesh.with_boundaries(
        {
            "contained_air": lambda x: x[0] < inner + END,
            "ends": lambda x: (x[1] < END) | (x[1] > height - END),
        }
    ).with_subdomains({"rubber": np.arange(mesh.t.shape[1])})
    return Body(mesh, {"rubber": RegionMaterial(compound or neo_hookean(1e6))}, {"ends": "z"})


def skewed(n: int = 3) -> skfem.MeshQuad:
    """A block of quadrilaterals with their inner nodes shifted."""
    mesh = skfem.MeshQuad.init_tensor(np.linspace(1, 2, n + 1), np.linspace(0, 1, n + 1))
    places = mesh.p.copy()
    inside = (abs(places[0] - 1.5) < 0.49) & (abs(places[1] - 0.5) < 0.49)
    places[:, inside] += np.random.default_rng(1).uniform(-0.08, 0.08, (2, inside.sum()))
    return skfem.MeshQuad(places, mesh.t).with_boundaries(
        {
            "outside": lambda x: (abs(x[0] - 1.5) > 0.5 - END) | (abs(x[1] - 0.5) > 0.5 - END),
            "contained_air": lambda x: x[0] < 1 + END,
        }
    ).with_subdomains({"rubber": np.arange(n * n)})  # fmt: skip


def torus(tube_radius: float, centre: float, thickness: float, n: int, compound: Compound) -> Body:
    """Half a closed thin torus (z >= 0), cut at the mid plane inside and outside."""
    rectangle = skfem.MeshQuad.init_tensor(np.linspace(-0.5, 0.5, 2), np.linspace(0, np.pi, n + 1))
    rho, angle = tube_radius + thickness * rectangle.p[0], rectangle.p[1]
    mesh = skfem.MeshQuad(np.array([centre + rho * np.cos(angle), rho * np.sin(angle)]), rectangle.t)
    inner = tube_radius - thickness / 2
    mesh = mesh.with_boundaries(
        {
            "contained_air": lambda x: np.hypot(x[0] - centre, x[1]) < inner + thickness / 4,
            "symmetry": lambda x: x[1] < END,
        }
    ).with_subdomains({"rubber": np.arange(n)})
    return Body(mesh, {"rubber": RegionMaterial(compound)}, {"symmetry": "z"})
