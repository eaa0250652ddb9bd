"""Cross-sections of tyres: a meridian and layers along it, read from ``geometry/NAME.toml``.

This package does not import materials, drives and runs.
"""

from tyrefem.geometry.builder import build, load
from tyrefem.geometry.card import SectionCard
from tyrefem.geometry.layer import Division, Layer, Piece, Profile, Rating
from tyrefem.geometry.meridian import Line, TwoArcs
from tyrefem.geometry.section import Section
from tyrefem.geometry.spline import SplineLine

__all__ = [
    "Division",
    "Layer",
    "Line",
    "Piece",
    "Profile",
    "Rating",
    "Section",
    "SectionCard",
    "SplineLine",
    "TwoArcs",
    "build",
    "load",
]
