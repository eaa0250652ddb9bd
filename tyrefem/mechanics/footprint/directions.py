"""Directions that conjugate gradients has searched: a better preconditioner for the next Newton step."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Short = NDArray[np.float32]
#: Largest number of directions that are kept, and of their values.
KEPT, VALUES = 72, 8_000_000


@dataclass(frozen=True, eq=False)
class _Block:
    """Conjugate directions S (k, size) of one Newton step, Y = J S and s J s (k,); n = 0 counts twice in products."""

    moved: Short
    bent: Short
    energies: Array


@dataclass(eq=False)
class SearchedDirections:
    """The directions S of the last Newton steps with their forces Y = J S, in single precision.

    The next stiffness J is similar, so S and Y correct the preconditioner P of the linear tyre (block BFGS):

        H = (1 - S D^-1 Y') P (1 - Y D^-1 S') + S D^-1 S',  D = S' Y.

    H is symmetric and positive wherever P is. It maps into motions without displacement of the closed points if S does
    (`projected`).
    """

    _blocks: list[_Block] = field(default_factory=list)

    def add(self, moved: list[Short], bent: list[Short], energies: list[float]) -> None:
        """Keep the directions of a Newton step; the oldest are dropped."""
        if not moved:
            return
        kept = min(KEPT, VALUES // moved[0].size)
        count = max(kept // 2, 1)
        latest = _Block(np.stack(moved[-count:]), np.stack(bent[-count:]), np.array(energies[-count:]))
        self._blocks.append(latest)
        while sum(len(block.energies) for block in self._blocks) > kept:
            self._blocks.pop(0)

    def clear(self) -> None:
        """Forget all directions."""
        self._blocks.clear()

    def project(self, projected: Callable[[Short], Short]) -> None:
        """Replace every direction (k, highest + 1, n_dofs) by its part without displacement of the closed points."""
        for at, block in enumerate(self._blocks):
            self._blocks[at] = _Block(projected(block.moved), block.bent, block.energies)

    def refine(self, highest: int) -> None:
        """Fit the directions to another highest harmonic."""

        def fitted(fields: Short) -> Short:
            new = np.zeros((len(fields), highest + 1, fields.shape[2]), dtype=fields.dtype)
            count = min(highest + 1, fields.shape[1])
            new[:, :count] = fields[:, :count]
            return new

        for at, block in enumerate(self._blocks):
            if block.moved.shape[1] != highest + 1:
                self._blocks[at] = _Block(fitted(block.moved), fitted(block.bent), block.energies)

    def corrected(self, residual: Array, solve: Callable[[Array], Array], depth: int = 0) -> Array:
        """H r (highest + 1, n_dofs) of a residual, where ``solve`` is P."""
        if depth == len(self._blocks):
            return solve(residual)
        block = self._blocks[-1 - depth]
        shares = _works(block.moved, residual) / block.energies
        motion = self.corrected(residual - _sum(block.bent, shares), solve, depth + 1)
        return motion + _sum(block.moved, shares - _works(block.bent, motion) / block.energies)


def _works(fields: Short, other: Array) -> Array:
    """(k,) products with another field; n = 0 counts twice."""
    short = other.astype(np.float32)
    short[0] *= 2
    return np.asarray(fields.reshape(len(fields), -1) @ short.ravel(), dtype=float)


def _sum(fields: Short, shares: Array) -> Array:
    total = shares.astype(np.float32) @ fields.reshape(len(fields), -1)
    return np.asarray(total.reshape(fields.shape[1:]), dtype=float)
