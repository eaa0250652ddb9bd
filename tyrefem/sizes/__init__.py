"""A section from a tyre's size: designation, rules by kind, carcass line in equilibrium, a section's file.

Knows no meshes and no studies: it gives the plain data of a section's file and the names of its material cards.
"""

from tyrefem.sizes.designation import TyreSize, looks_like_size, parse_size
from tyrefem.sizes.drawn import Drawn
from tyrefem.sizes.section import (
    completed_materials,
    draw_size,
    drawn_of,
    gauge_of,
    is_size,
    section_of_size,
    with_numbers,
)

__all__ = [
    "Drawn",
    "TyreSize",
    "completed_materials",
    "draw_size",
    "drawn_of",
    "gauge_of",
    "is_size",
    "looks_like_size",
    "parse_size",
    "section_of_size",
    "with_numbers",
]
