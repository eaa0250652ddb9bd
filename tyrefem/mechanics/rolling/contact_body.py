"""A body in rolling contact: its compliance between points, and the way material goes from point to point."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
#: Components of force and displacement at a point: away from the road, along it, to the left.
COMPONENTS = 3
#: The material of such a point has not been at another point of the body before.
NOWHERE = -1


@dataclass(frozen=True, eq=False)
class ContactBody:
    """Displacement of k points under forces on them, and where each point's material was a step before.

    At every point the components are (away from the road, along it, to the left). The compliance may be that of a tyre
    by harmonics, of a half plane, of separate bristles: the contact does not ask.

    Parameters
    ----------
    compliance : (k, 3, k, 3) displacement per force of the road on the body, m/N.
    upstream : (k,) the point at which the material of a point was a step before; `NOWHERE`: none. Such points cannot
        touch.
    turns : (k, 3, 3) turn from the axes of the point upstream to those of the point; None: all axes are parallel.
    """

    compliance: Array
    upstream: Indices
    turns: Array | None = field(default=None)

    @property
    def n_points(self) -> int:
        """Number of points."""
        return len(self.upstream)

    @functools.cached_property
    def may_touch(self) -> NDArray[np.bool_]:
        """(k,) points with a point upstream."""
        return np.asarray(self.upstream != NOWHERE)

    @functools.cached_property
    def slip_compliance(self) -> Array:
        """(k, 2, k, 3) displacement in the road's plane from the point upstream to the point, per force, m/N."""
        size, before = self.n_points, self.upstream
        at = self.compliance.reshape(size, COMPONENTS, -1)
        came = at[before] if self.turns is None else self.turns @ at[before]
        change = at[:, 1:] - came[:, 1:]
        change[~self.may_touch] = 0.0
        return np.asarray(change.reshape(size, 2, size, COMPONENTS))

    def displacement(self, forces: Array) -> Array:
        """(k, 3) displacement, m, under forces (k, 3), N."""
        loaded = np.flatnonzero(np.any(forces != 0, axis=1))
        flat = self.compliance[:, :, loaded].reshape(COMPONENTS * self.n_points, -1)
        return np.asarray((flat @ forces[loaded].ravel()).reshape(-1, COMPONENTS))

    def change(self, values: Array) -> Array:
        """(k, 2) change in the road's plane, from the point upstream to the point, of vectors (k, 3)."""
        came = values[self.upstream]
        if self.turns is not None:
            came = np.einsum("kab,kb->ka", self.turns, came)
        change = (values - came)[:, 1:]
        change[~self.may_touch] = 0.0
        return np.asarray(change)
