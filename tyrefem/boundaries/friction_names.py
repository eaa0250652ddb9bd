"""Heat of sliding friction: rubber on wood, ice and road (Roberts; Carslaw & Jaeger)."""

from __future__ import annotations

from tyrefem.boundaries.friction import (
    ASPHALT,
    ICE,
    RUBBER,
    SOLIDS,
    TEAK,
    Solid,
    share_into_slider,
    share_of_like_solids,
    solid,
)
from tyrefem.boundaries.friction_rise import (
    MEAN_OF_EXIT,
    distance_of_fall_off,
    exit_rise,
    exit_rise_of_stress,
    fall_off,
    heat_flux,
    largest_friction,
    share_into,
    shared_rise,
    surface_rise,
)
from tyrefem.boundaries.friction_tables import IceRow, WoodRow, ice_distance, ice_rows, wood_rows
from tyrefem.boundaries.skid import MILD, SEVERE, LockedWheel, Passage, half_space_surface

__all__ = [
    "ASPHALT",
    "ICE",
    "MEAN_OF_EXIT",
    "MILD",
    "RUBBER",
    "SEVERE",
    "SOLIDS",
    "TEAK",
    "IceRow",
    "LockedWheel",
    "Passage",
    "Solid",
    "WoodRow",
    "distance_of_fall_off",
    "exit_rise",
    "exit_rise_of_stress",
    "fall_off",
    "half_space_surface",
    "heat_flux",
    "ice_distance",
    "ice_rows",
    "largest_friction",
    "share_into",
    "share_into_slider",
    "share_of_like_solids",
    "shared_rise",
    "solid",
    "surface_rise",
    "wood_rows",
]
