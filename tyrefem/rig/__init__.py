"""The laser rig (Allouis et al. 2016): simulate a heating test, find conductivity and specific heat of every layer."""

from __future__ import annotations

from tyrefem.rig.air import air, natural_film, nusselt
from tyrefem.rig.card import RigCard
from tyrefem.rig.find import load
from tyrefem.rig.identification import Identification, identify
from tyrefem.rig.patch import Layer, Patch, Property
from tyrefem.rig.readings import read
from tyrefem.rig.simulation import Simulation, simulate

__all__ = [
    "Identification",
    "Layer",
    "Patch",
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
