"""The worn shoulder: the face of the worn tread goes on past its last ring."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from tyrefem.geometry import Section

Array = NDArray[np.float64]
#: Distance between stations of the shoulder, m.
SPACING = 1e-4
#: Length of the tread's face, before its end, that gives its direction, m.
BEFORE = 5e-3


@dataclass(frozen=True, eq=False)
class WornShoulder:
    """Depth worn beyond the tread's last ring, at ``end``.

    No rubber beyond the last ring touched when the tyre was new. A worn edge lies lower, so the contact moves outwards.
    Assumed: the worn face goes straight on, parallel to the new face before the end, until it meets the new shoulder.

    Parameters
    ----------
    s : (n,) stations from the last ring outwards, m. places : (n, 2) of the new face in (r, z), m. normals : (n, 2).
    fall : (n,) of the new face below the straight line, never less than further in, m.
    share : (n,) cosine between the normals of the line and of the meridian.
    """

    s: Array
    places: Array
    normals: Array
    fall: Array
    share: Array

    @classmethod
    def of(cls, section: Section, end: float) -> WornShoulder:
        """Of the side z > 0 of a section whose last ring is at ``end``, m."""
        s = np.append(np.arange(end, section.line.length, SPACING), section.line.length)
        places, normals = section.place(s, section.total_thickness(s)), section.line.normal(s)
        near = max(end - BEFORE, 0.0)
        r, z = places[0] - section.place(near, section.total_thickness(near))
        across = np.array([z, -r]) / np.hypot(r, z)
        across = across * np.sign(across @ normals[0])
        share = normals @ across
        # A face that has turned away by 60 degrees is not cut along its normal.
        ends = int(np.argmax(share < 0.5)) or len(s)
        fall = np.maximum.accumulate((places[0] - places) @ across)[:ends]
        return cls(s[:ends], places[:ends], normals[:ends], np.maximum(fall, 0.0), share[:ends])

    def depths(self, worn: float) -> Array:
        """(n,) depth at the stations along the meridian's normal, m, where the last ring has worn by ``worn``, m."""
        return np.maximum(worn * self.share[0] - self.fall, 0.0) / self.share

    def depth(self, s: Array, worn: float) -> Array:
        """Depth at stations, m; 0 up to the last ring and beyond the worn shoulder."""
        return np.interp(s, self.s, self.depths(worn), left=0.0, right=0.0)

    def reach(self, worn: float) -> float:
        """Station at which the worn face meets the new one, m."""
        return float(np.interp(worn * self.share[0], self.fall, self.s))

    def volume(self, worn: float) -> float:
        """Rubber worn off both shoulders round the wheel, m3."""
        inner = self.places - self.depths(worn)[:, None] * self.normals
        # Corners of the quadrilaterals between two stations: out along the new face, back along the worn one.
        corners = np.stack([self.places[:-1], self.places[1:], inner[1:], inner[:-1]])
        (r, z), (r_next, z_next) = (np.moveaxis(c, -1, 0) for c in (corners, np.roll(corners, -1, axis=0)))
        areas = np.abs((r * z_next - r_next * z).sum(axis=0)) / 2
        return float(2 * (2 * np.pi * corners[..., 0].mean(axis=0) * areas).sum())
