"""Transient and steady heat conduction on any named mesh, with a closing heat budget.

Knows no tyres: any mesh, any material.
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
