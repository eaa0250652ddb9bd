"""States that an effect keeps through a run: the temperature of a brake disc, water on a tread, wear."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
#: Value of a state, or its rate: a number, or one per place (n,). SI, temperatures in degC.
Value = float | Array
Values = Mapping[str, Value]


@dataclass(frozen=True)
class EffectState:
    """A state of an effect: a number, or one value per place.

    Parameters
    ----------
    unit, meaning : unit of its value; one line.
    scale : the change that matters as much as 1 K: errors in time are held below the study's tolerance times this.

    >>> EffectState("kg/m**2", "water on the tread", scale=1e-3).unit
    'kg/m**2'
    """

    unit: str
    meaning: str
    scale: float = 1.0


class TemperaturesOfTyre(Protocol):
    """Temperatures of the tyre at one time, degC: what a rate may depend on."""

    def surface(self, boundary: str) -> float:
        """Mean of ``road`` (the tread), ``outside_air``, ``contained_air`` or ``rim`` (the bead's seat)."""

    def region(self, name: str) -> float:
        """Mean of a region of the section."""

    def at(self, points: Array) -> Array:
        """At points (n_points, 2) in (r, z), m."""

    def reservoir(self, name: str) -> float:
        """Of the lumped ``rim``, or of the ``contained-air`` where it has a heat capacity."""
