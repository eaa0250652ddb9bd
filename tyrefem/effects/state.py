"""States of an effect during a run, such as the temperature of a brake disc, water on a tread, wear."""

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
    unit, meaning : unit of the value; meaning in one line.
    scale : change that counts as 1 K: time errors are below the study's tolerance (in K) times ``scale``.

    >>> EffectState("kg/m**2", "water on the tread", scale=1e-3).unit
    'kg/m**2'
    """

    unit: str
    meaning: str
    scale: float = 1.0


class TemperaturesOfTyre(Protocol):
    """Temperatures of the tyre at a time, degC, as arguments of a rate."""

    def surface(self, boundary: str) -> float:
        """Mean temperature of ``road`` (the tread), ``outside_air``, ``contained_air`` or ``rim`` (the bead's seat)."""

    def region(self, name: str) -> float:
        """Mean temperature of a region of the section."""

    def at(self, points: Array) -> Array:
        """Temperatures at points (n_points, 2) in (r, z), m."""

    def reservoir(self, name: str) -> float:
        """Temperature of the lumped ``rim``, or of the ``contained-air`` if it has a heat capacity."""
