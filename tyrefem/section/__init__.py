"""Cross-sections of tyres: a meridian and layers along it, read from ``geometry/NAME.toml``."""

from tyrefem.section.builder import build, load
from tyrefem.section.card import SectionCard
from tyrefem.section.division import Division
from tyrefem.section.layer import Layer, Piece, Rating
from tyrefem.section.line import Line, TwoArcs
from tyrefem.section.profile import Profile
from tyrefem.section.section import Section
from tyrefem.section.spline import SplineLine

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
