"""Motions that conjugate gradients search for longest: kept from one search, the next needs not look for them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
#: Motions that are kept.
KEPT = 24
#: Directions of a search are independent down to this share of their largest energy.
INDEPENDENT = 1e-4


@dataclass(frozen=True, eq=False)
class Direction:
    """A direction p of a search, K p and P^-1 p, P the preconditioner, for p K p = 1: rows (n n_dofs) in single
    precision, n = 0 times sqrt 2."""

    motion: Array
    forces: Array
    led: Array

    @classmethod
    def of(cls, motion: Array, forces: Array, led: Array, energy: float) -> Direction:
        """Of fields (n, n_dofs) with any ``energy`` p K p."""
        size = np.float32(1 / np.sqrt(abs(energy) or 1.0))
        return cls(*(size * _flat(part) for part in (motion, forces, led)))

    def field(self, like: Array) -> Array:
        """The motion (n, n_dofs)."""
        return _field(self.motion, like)


@dataclass(frozen=True, eq=False)
class ExtremeMotions:
    """Motions w of a stiffness K with extreme ratios of w K w to w P^-1 w, P the preconditioner: w_i K w_j = 1 for
    i = j, else 0.

    Conjugate gradients that stay conjugate to them converge as if these ratios were not there (deflation: Nicolaides
    1987; Saad, Yeung, Erhel and Guyomarc'h 2000). The answer is that of all motions: forces are balanced in w first.

    Parameters
    ----------
    motions, forces, led : (k, n n_dofs) w, K w and P^-1 w in single precision, n = 0 times sqrt 2.
    """

    motions: Array
    forces: Array
    led: Array

    @classmethod
    def none(cls, size: int) -> ExtremeMotions:
        """Without motions of fields with ``size`` numbers."""
        return cls(*np.zeros((3, 0, size), dtype=np.float32))

    def balanced(self, forces: Array) -> Array:
        """The motion in the span of w under forces (n, n_dofs): w (w . f) summed."""
        return _field(self.motions.T @ (self.motions @ _flat(forces)), forces)

    def without(self, motion: Array, led: Array) -> tuple[Array, Array]:
        """The part of a motion (n, n_dofs) that is conjugate to all w, and P^-1 of it, for P^-1 of the motion."""
        shares = self.forces @ _flat(motion)
        if not len(shares):
            return motion, led
        return motion - _field(self.motions.T @ shares, motion), led - _field(self.led.T @ shares, motion)

    def after(self, directions: Sequence[Direction]) -> ExtremeMotions:
        """The extreme motions among these and the directions of a search (Rayleigh and Ritz).

        These themselves after a short search: its directions have little that they do not know.
        """
        if len(directions) <= min(len(self.motions), KEPT):
            return self
        motions, forces, led = (
            np.stack([*known, *(getattr(direction, name) for direction in directions)])
            for known, name in ((self.motions, "motion"), (self.forces, "forces"), (self.led, "led"))
        )
        stiffness, other = ((motions @ part.T).astype(float) for part in (forces, led))
        energies, vectors = np.linalg.eigh((stiffness + stiffness.T) / 2)
        use = energies > INDEPENDENT * energies[-1]
        vectors = vectors[:, use] / np.sqrt(energies[use])
        inverse, turned = np.linalg.eigh(vectors.T @ (other + other.T) @ vectors / 2)
        ratios = np.log(np.maximum(inverse, np.finfo(np.float32).eps * inverse[-1]))
        extreme = np.argsort(-np.abs(ratios - np.median(ratios)))[:KEPT]
        shares = (vectors @ turned[:, extreme]).T.astype(np.float32)
        return ExtremeMotions(shares @ motions, shares @ forces, shares @ led)


def _flat(field: Array) -> Array:
    """A field (n, n_dofs) in a row, in single precision: products of rows are works over pi."""
    row: Array = np.array(field, dtype=np.float32)
    row[0] *= np.float32(np.sqrt(2))
    return row.ravel()


def _field(row: Array, like: Array) -> Array:
    """The field (n, n_dofs) of a row."""
    field = row.reshape(like.shape).astype(float)
    field[0] /= np.sqrt(2)
    return field
