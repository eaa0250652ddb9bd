"""A body in rolling contact: its compliance between points, and the way material goes from point to point."""

from __future__ import annotations

import functools
from dataclasses import dataclass

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
    before : (k,) share of the last step before the material of a point touched. In that share it moved over the road
        as in the step before; this does not count as slip. None: zero.
    axes : (k, 3, 3) turn from the axes of the compliance to those of each point; None: they are the same.
    common : (k, 3, n) motions g that all points share, and their weights (n, n): forces f move the points by the sum
        over i, j of g_i weights_ij (g_j . f) more. None: none.
    """

    compliance: Array
    upstream: Indices
    turns: Array | None = None
    before: Array | None = None
    axes: Array | None = None
    common: tuple[Array, Array] | None = None

    @property
    def n_points(self) -> int:
        """Number of points."""
        return len(self.upstream)

    @functools.cached_property
    def may_touch(self) -> NDArray[np.bool_]:
        """(k,) points with a point upstream."""
        return np.asarray(self.upstream != NOWHERE)

    def block(self, rows: Indices, columns: Indices) -> Array:
        """(n, 3, m, 3) compliance between some points."""
        every, size = np.arange(COMPONENTS), COMPONENTS * self.n_points
        at = np.ix_(*((COMPONENTS * points[:, None] + every).ravel() for points in (rows, columns)))
        block = self.compliance.reshape(size, size)[at].reshape(len(rows), COMPONENTS, len(columns), COMPONENTS)
        if self.axes is not None:
            n, m = len(rows), len(columns)
            turned = (self.axes[rows] @ block.reshape(n, COMPONENTS, m * COMPONENTS)).reshape(-1, m, COMPONENTS)
            turned = turned.transpose(1, 0, 2) @ self.axes[columns].transpose(0, 2, 1)
            block = turned.transpose(1, 0, 2).reshape(n, COMPONENTS, m, COMPONENTS)
        if self.common is not None:
            motions, weights = self.common
            block = block + np.tensordot(motions[rows] @ weights, motions[columns], axes=(2, 2))
        return np.asarray(block)

    @functools.cached_property
    def local(self) -> Array:
        """(k, 3, 3) compliance of each point under a force on itself, m/N."""
        every = np.arange(self.n_points)
        at = self.compliance[every, :, every, :]
        return np.asarray(at if self.axes is None else self.axes @ at @ self.axes.transpose(0, 2, 1))

    def slip_block(self, index: Indices, rows: Indices, block: Array) -> Array:
        """(n, 2, n, 3) slip of a step at some points that may touch, per force on them, m/N.

        ``block``: `block` of points ``rows``, in order, among them all of ``index``, and of the points ``index``.
        """

        def of_rows(wanted: Indices) -> Array:
            at = np.minimum(np.searchsorted(rows, wanted), len(rows) - 1)
            taken, others = block[at], np.flatnonzero(rows[at] != wanted)
            if len(others):
                taken[others] = self.block(wanted[others], index)
            return np.asarray(taken)

        def change(wanted: Indices) -> Array:
            came = of_rows(self.upstream[wanted])
            if self.turns is not None:
                size = (len(wanted), COMPONENTS, len(index) * COMPONENTS)
                came = (self.turns[wanted] @ came.reshape(size)).reshape(came.shape)
            moved = of_rows(wanted)[:, 1:] - came[:, 1:]
            moved[~self.may_touch[wanted]] = 0.0
            return np.asarray(moved)

        slip = change(index)
        if self.before is not None:
            entering = np.flatnonzero(self.before[index])
            slip[entering] -= self.before[index[entering]][:, None, None, None] * change(self.upstream[index[entering]])
        return slip

    def touching(self, change: Array) -> Array:
        """Changes (k, 2, ...) of a step, of the share of it in which the material touched."""
        if self.before is None:
            return change
        entering = np.flatnonzero(self.before)
        left = change.copy()
        share = self.before[entering].reshape(-1, *[1] * (change.ndim - 1))
        left[entering] -= share * change[self.upstream[entering]]
        return left

    def displacement(self, forces: Array) -> Array:
        """(k, 3) displacement, m, under forces (k, 3), N."""
        size = COMPONENTS * self.n_points
        turned = forces if self.axes is None else np.einsum("kax,ka->kx", self.axes, forces)
        loaded = np.flatnonzero(turned)
        columns = slice(loaded[0], loaded[-1] + 1) if len(loaded) else slice(0)
        moved = self.compliance.reshape(size, size)[:, columns] @ turned.ravel()[columns]
        moved = moved.reshape(-1, COMPONENTS)
        moved = moved if self.axes is None else np.einsum("kax,kx->ka", self.axes, moved)
        if self.common is None:
            return np.asarray(moved)
        motions, weights = self.common
        return np.asarray(moved + motions @ (weights @ np.tensordot(motions, forces, axes=((0, 1), (0, 1)))))

    def change(self, values: Array) -> Array:
        """(k, 2) change in the road's plane, from the point upstream to the point, of vectors (k, 3)."""
        came = values[self.upstream]
        if self.turns is not None:
            came = np.einsum("kab,kb->ka", self.turns, came)
        change = (values - came)[:, 1:]
        change[~self.may_touch] = 0.0
        return np.asarray(change)
