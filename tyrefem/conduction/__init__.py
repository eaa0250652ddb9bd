"""Transient and steady heat conduction on any named mesh, with a closing heat budget.

It works on any mesh and material, without tyres. `tyrefem.conduction.equation` states the equation and assembles it.

A slab of 20 mm has an insulated face and a film on the other. If h = k z tan(z) / L, the temperature
T_sink + A cos(z x / L) keeps its shape and decays with exp(-z^2 a t / L^2), a = k / (rho c):

>>> import numpy as np, skfem
>>> from tyrefem.conduction import Conduction, Film, Material
>>> L, k, C, z, t = 0.02, 0.25, 2e6, np.pi / 4, 1200.0
>>> mesh = skfem.MeshQuad.init_tensor(np.linspace(0, L, 21), [0, 0.01])
>>> mesh = mesh.with_subdomains({"slab": lambda x: x[0] > 0}).with_boundaries({"face": lambda x: x[0] > 0.9999 * L})
>>> slab = Conduction(mesh, {"slab": Material(k, C)}, {"face": Film(h=k * z * np.tan(z) / L, sink=25.0)},
...                   axisymmetric=False, element="P2")
>>> start = 25.0 + 60.0 * np.cos(z * slab.operators.points[0] / L)
>>> history = slab.transient([0.0, t], start, tolerance=0.001)
>>> exact = 25.0 + 60.0 * np.cos(z / 2) * np.exp(-z**2 * k / C * t / L**2)
>>> round(float(history.at([(L / 2, 0.005)])[-1, 0]), 2), round(float(exact), 2)
(68.99, 68.99)
"""

from __future__ import annotations

from tyrefem.conduction.budget import Budget
from tyrefem.conduction.conditions import Convection, Film, Fixed, Flux, Material, Radiation, Reservoir
from tyrefem.conduction.errors import SolverError
from tyrefem.conduction.field import Field, History, Peak, Steps
from tyrefem.conduction.operators import Operators, operators_of
from tyrefem.conduction.problem import Conduction

__all__ = [
    "Budget",
    "Conduction",
    "Convection",
    "Field",
    "Film",
    "Fixed",
    "Flux",
    "History",
    "Material",
    "Operators",
    "Peak",
    "Radiation",
    "Reservoir",
    "SolverError",
    "Steps",
    "operators_of",
]
