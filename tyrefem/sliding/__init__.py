"""Heat of sliding friction: rubber on wood, ice and road (Roberts; Carslaw & Jaeger)."""

from __future__ import annotations

from tyrefem.sliding.contact import Passage
from tyrefem.sliding.locked_wheel import MILD, SEVERE, LockedWheel
from tyrefem.sliding.rise import (
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
from tyrefem.sliding.skid import half_space_surface
from tyrefem.sliding.slider import share_into_slider, share_of_like_solids
from tyrefem.sliding.solid import ASPHALT, ICE, RUBBER, SOLIDS, TEAK, Solid, solid
from tyrefem.sliding.tables import IceRow, WoodRow, ice_distance, ice_rows, wood_rows

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
