"""The laser rig (Allouis et al. 2016): simulate a heating test, find conductivity and specific heat of every layer.

Knows nothing of tyres, drives and studies.
"""

from __future__ import annotations

import importlib
from typing import Any

from tyrefem.rig.card import RigCard, load
from tyrefem.rig.patch import Patch, PatchLayer, Property, air, natural_film, nusselt
from tyrefem.rig.readings import read
from tyrefem.rig.simulation import Simulation, simulate

__all__ = [
    "Identification",
    "Patch",
    "PatchLayer",
    "Property",
    "RigCard",
    "Simulation",
    "air",
    "identify",
    "load",
    "natural_film",
    "nusselt",
    "read",
    "simulate",
]

#: What a person gets has the verbs of `tyrefem.api`; the data alone: `tyrefem.rig.identification`.
_WHERE = {"Identification": "tyrefem.api", "identify": "tyrefem.api"}


def __getattr__(name: str) -> Any:
    if name not in _WHERE:
        raise AttributeError(f"module 'tyrefem.rig' has no attribute '{name}'")
    return getattr(importlib.import_module(_WHERE[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
