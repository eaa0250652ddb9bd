"""The rim that a size is drawn on: seat, flange, and the circle on which the bead's outside lies."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

Point = tuple[float, float]


@dataclass(frozen=True)
class Rim:
    """Contour of a rim, m and rad.

    ``diameter``: at the heel, where seat and flange meet; ``width``: between the flanges; ``height``: of the flange
    above the
    heel; ``radius``: of its rounding; ``taper``: of the seat. ``least``: straight part of the bead's outside above
    the heel.
    """

    diameter: float
    width: float
    height: float
    radius: float
    taper: float
    least: float = 2e-3

    @property
    def heel(self) -> Point:
        """(r, z)."""
        return self.diameter / 2, self.width / 2

    @property
    def straight(self) -> float:
        """Length of the bead's outside from the heel, at right angles to the seat, up to the rounding."""
        t = self.taper
        return float(max((self.height - self.radius * (1 + np.sin(t))) / np.cos(t), self.least))

    @property
    def centre(self) -> Point:
        """(r, z) of the rounding's centre: it touches the bead's outside."""
        t, h, c = self.taper, self.straight, self.radius
        return (
            float(self.heel[0] + h * np.cos(t) + c * np.sin(t)),
            float(self.heel[1] - h * np.sin(t) + c * np.cos(t)),
        )
