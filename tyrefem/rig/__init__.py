"""The laser rig (Allouis et al. 2016): simulate a heating test, find conductivity and specific heat of every layer.

The public interface; the computations are in `tyrefem.heating_test`.
"""

from __future__ import annotations

from typing import Any

from tyrefem.heating_test.card import RigCard
from tyrefem.heating_test.files import load
from tyrefem.heating_test.patch import Patch, PatchLayer, Property, air, natural_film, nusselt
from tyrefem.heating_test.readings import read
from tyrefem.heating_test.simulation import Simulation, simulate

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


def __getattr__(name: str) -> Any:
    """Import the identification and its methods on first use."""
    if name not in ("Identification", "identify"):
        raise AttributeError(f"module 'tyrefem.rig' has no attribute '{name}'")
    from tyrefem import api

    return getattr(api, name)


def __dir__() -> list[str]:
    return sorted(__all__)
