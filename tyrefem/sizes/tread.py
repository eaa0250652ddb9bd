"""The tread's surface of a radial: an arc, rounded off at its shoulders by smaller ones."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.sizes.meridian import SizedMeridian

Array = NDArray[np.float64]
#: Samples of the line up to the widest place in which the tread's edge is looked for.
SAMPLES = 800


@dataclass(frozen=True)
class TreadSurface:
    """The tread over the plies' ``line``, m: overall ``diameter``, ``width``, ``radius`` of its arc.

    ``rounding``: radius of the arc of each shoulder, over the outer ``rounding_width`` of each side.
    """

    line: SizedMeridian
    diameter: float
    width: float
    radius: float
    rounding: float
    rounding_width: float

    @cached_property
    def edge(self) -> float:
        """Where the tread's surface is half the tread's width from the mid plane, m along the line.

        Raises
        ------
        InputError : the tread is wider than the section.
        """
        s = np.linspace(0.0, self.line.widest_s * 0.999, SAMPLES)
        _, z, phi = self.line.at(s)
        beyond = np.flatnonzero(z + np.cos(phi) * self.distance(s) > self.width / 2)
        if not len(beyond):
            raise InputError("is wider than the section", field="parameters.tread_width")
        return float(s[beyond[0]])

    def distance(self, s: Array) -> Array:
        """From the line to the surface along the line's normal, m: the tread's arc, then the shoulder's."""
        r, z, phi = self.line.at(s)
        normal = np.stack([np.sin(phi), np.cos(phi)])
        centre = np.array([self.diameter / 2 - self.radius, 0.0])
        angle = np.arcsin((self.width / 2 - self.rounding_width) / self.radius)
        turn = np.array([np.cos(angle), np.sin(angle)])

        def along(to: Array, of: float) -> Array:
            away = np.stack([r - to[0], z - to[1]])
            distance = (away * normal).sum(axis=0)
            return np.asarray(np.sqrt(np.maximum(of**2 - (away**2).sum(axis=0) + distance**2, 0.0)) - distance)

        tread = along(centre, self.radius)
        beyond = z + tread * normal[1] > self.radius * turn[1]
        return np.where(beyond, along(centre + (self.radius - self.rounding) * turn, self.rounding), tread)
