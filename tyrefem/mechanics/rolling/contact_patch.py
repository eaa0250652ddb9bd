"""Size and pressure of the contact of a rolling tyre."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.footprint.footprint import BEYOND

if TYPE_CHECKING:
    from tyrefem.mechanics.rolling.rolling_grid import RollingGrid

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ContactPatch:
    """The contact of a tyre that rolls with friction, as `Footprint` has that without.

    Parameters
    ----------
    length : greatest, m. width : axial extent with the grooves between, m. area : without grooves, m2.
    mean_pressure : load over area, Pa. peak_pressure : at a point of the tread, Pa.
    """

    length: float
    width: float
    area: float
    mean_pressure: float
    peak_pressure: float

    @classmethod
    def of(cls, grid: RollingGrid, pressure: Array, load: float) -> ContactPatch:
        """Of a pressure (n_angles, m), Pa, at the points of a grid; load: N."""
        influence = grid.influence
        lengths = contact_angles(pressure) * grid.step * influence.places[0]
        area = float(lengths @ influence.axial_widths)
        touching = np.flatnonzero(lengths > 0)
        width = 0.0
        if len(touching):
            first, last = influence.places[1, [touching[0], touching[-1]]]
            low, high = influence.grooves.T
            within = (low > first - 1e-6) & (high < last + 1e-6)
            width = float(influence.axial_widths[touching[0] : touching[-1] + 1].sum() + (high - low)[within].sum())
        mean = load / area if area > 0 else 0.0
        return cls(float(lengths.max(initial=0.0)), width, area, mean, float(pressure.max()))


def contact_angles(pressure: Array) -> Array:
    """(m,) length of contact of each ring in steps of the angle, for a pressure (n_angles, m), Pa.

    Both ends lie where those of a footprint do (`Footprint.half_lengths`).
    """
    return np.array([_length(column) for column in pressure.T])


def _length(pressure: Array) -> float:
    """Of a pressure (n,): a point alone has one step."""
    touching = np.flatnonzero(pressure > 0)
    if len(touching) < 2:
        return float(len(touching))
    first, last = int(touching[0]), int(touching[-1])
    ends = ((pressure[first], pressure[first + 1]), (pressure[last], pressure[last - 1]))
    return last - first + sum(float(end / max(end, inner)) + BEYOND for end, inner in ends)
