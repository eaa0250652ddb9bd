"""Stress and tangent of some elements of one region at F F_0: of its compound, its cords and its tread blocks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.solid.compounds import Compound, determinant
from tyrefem.mechanics.solid.cords import CordLayer
from tyrefem.mechanics.solid.elements import Indices, Rings
from tyrefem.mechanics.solid.finite_deformation import at_points, deformation, inverted, material_tangent
from tyrefem.mechanics.solid.parts import RegionMaterial
from tyrefem.mechanics.solid.six_components import PAIRS, PLACE
from tyrefem.mechanics.solid.tread_blocks import TreadBlocks

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class _FirstInvariant:
    """A compound without c01: F G (3, 3, e, q, m), I1 = F : F G, s = 2 c W_1 and 4 c^2 W_11 (e, q, m), times r dA."""

    fg: Array
    first: Array
    slope: Array
    curvature: Array


@dataclass(frozen=True, eq=False)
class _TautCords:
    """Cords of one direction: a = F d and d (3, e, q, m), W'/l and (W'' - W'/l)/l^2 (e, q, m), times r dA / 2."""

    along: Array
    direction: Array
    pull: Array
    stiff: Array

    def add_to(self, matrix: Array, initial: dict[tuple[int, int], Array], precision: type) -> None:
        """Add their terms of A to ``matrix``, and W'/l d d to ``initial``, which acts on every direction of force."""
        dyad: Array = (self.along[:, None] * self.direction).astype(precision)
        stiffened: Array = (self.stiff * dyad).astype(precision)
        matrix += stiffened[:, :, None, None] * dyad
        for i in range(3):
            for j in range(3):
                before = initial.get((i, j), np.zeros(()))
                initial[i, j] = before + self.pull * (self.direction[i] * self.direction[j])


@dataclass(frozen=True, eq=False)
class _BentBlocks:
    """Blocks of a tread: B (3, 3, e, q, m), W'' and W' (e, q, m), W' (t n + n t) (3, 3, e, q, m), times r dA."""

    moved: Array
    stiff: Array
    slope: Array
    turned: Array

    def add_to(self, matrix: Array, initial: dict[tuple[int, int], Array], precision: type) -> None:
        """Add their terms of A to ``matrix`` and ``initial``, as `_TautCords.add_to`."""
        matrix += (self.stiff * self.moved).astype(precision)[:, :, None, None] * self.moved.astype(precision)
        for i in range(3):
            for j in range(3):
                initial[i, j] = initial.get((i, j), np.zeros(())) + self.turned[i, j]


@dataclass(frozen=True, eq=False)
class ElementGroup:
    """Elements of one region at all angles: F = 1 + H, F_0 (3, 3, e, q), and the elements' numbers and bulk moduli."""

    rings: Rings
    members: Indices
    bulk: Array
    inflated: Array
    gradient: Array

    def response(self, part: RegionMaterial, precision: type | None) -> tuple[Array, Array, Array]:
        """P (9, e, q, m), A (9, 9, e, q, m) and V (9, e, q, m), times r dA.

        With Q = F^-T, G = F_0 F_0', I1 = F : F G, c = J^(-2/3), s = 2 c W_1 and a = F d (d: cord after inflation):

        P = s F G + h Q + sum W'/l a d,  h = p J - s I1/3,
        A = s 1 G - 2/3 s (F G Q + Q F G) + (p J + 2/9 s I1) Q Q + 4 c^2 W_11 q q - h Q Q (crossed)
            + sum [(W'' - W'/l)/l^2 a d a d + W'/l 1 d d],  q = F G - I1/3 Q,

        and of blocks, B = a t + c n with a = F n, c = F t:  P = W' B,  A = W'' B B + W' 1 (t n + n t).
        """
        f, compound = deformation(self.gradient), part.compound
        functions = self.rings.linear_functions[self.members]
        weights = self.rings.weights[self.members][..., None]
        q_inverse = np.ascontiguousarray(inverted(f).swapaxes(0, 1))
        volume = determinant(f) * determinant(self.inflated)[..., None]
        moments = functions.transpose(0, 2, 1) @ (weights * (volume - 1))
        pressed = (functions @ (self.bulk[:, None, None] * moments)) * volume * weights
        metric = np.einsum("ik...,jk...->ij...", self.inflated, self.inflated)[..., None]
        along = [(i, j) for i in range(3) for j in range(3) if metric[i, j].any()]
        matrix: Array | None = None
        direct: _FirstInvariant | None = None
        if compound.c01:
            h = pressed
            stress, matrix = self._general(f, q_inverse, compound, weights, precision)
            stress += h * q_inverse
        else:
            fg = np.zeros_like(f)
            for i, j in along:
                fg[:, j] += f[:, i] * metric[i, j]
            first = (f * fg).sum(axis=(0, 1))
            c = np.cbrt(volume) ** -2
            slope, curvature = compound.slopes(c * first)
            direct = _FirstInvariant(fg, first, 2 * c * slope * weights, 4 * c**2 * curvature * weights)
            h = pressed - direct.slope * first / 3
            stress = direct.slope * fg + h * q_inverse
        taut = [cord for layer in part.cords for cord in self._taut(f, layer, weights)]
        for cord in taut:
            stress += (cord.pull * cord.along)[:, None] * cord.direction
        bent = None if part.blocks is None else self._bent(f, part.blocks, weights)
        if bent is not None:
            stress += bent.slope * bent.moved
        if precision is None:
            return stress.reshape(9, *volume.shape), np.zeros(0), np.zeros(0)
        matrix = self._matrix(q_inverse, direct, pressed, h, precision, matrix)
        initial: dict[tuple[int, int], Array] = {}
        if direct is not None:
            initial = {(i, j): direct.slope * metric[i, j] for i, j in along}
        for cord in taut:
            cord.add_to(matrix, initial, precision)
        if bent is not None:
            bent.add_to(matrix, initial, precision)
        for (i, j), value in initial.items():
            for k in range(3):
                matrix[k, i, k, j] += value
        shape = (9, *volume.shape)
        return stress.reshape(shape), matrix.reshape(9, *shape), (volume * weights * q_inverse).reshape(shape)

    def _taut(self, f: Array, layer: CordLayer, weights: Array) -> Iterator[_TautCords]:
        """The cords of a layer, by direction."""
        for before in layer.directions:
            d = np.einsum("ij...,j...->i...", self.inflated, before)[..., None]
            a = f[:, 0] * d[0] + f[:, 1] * d[1] + f[:, 2] * d[2]
            length = np.sqrt((a * a).sum(axis=0))
            slope, curvature = layer.slopes(length)
            pull = slope / length * weights / 2
            yield _TautCords(a, d, pull, (curvature * weights / 2 - pull) / length**2)

    def _bent(self, f: Array, blocks: TreadBlocks, weights: Array) -> _BentBlocks:
        """The blocks of a patterned tread."""
        n, t = (np.einsum("ij...,j...->i...", self.inflated, d)[..., None] for d in blocks.directions)
        a, c = (f[:, 0] * d[0] + f[:, 1] * d[1] + f[:, 2] * d[2] for d in (n, t))
        moved, stiff = a[:, None] * t + c[:, None] * n, -blocks.missing * weights
        slope = stiff * (a * c).sum(axis=0)
        return _BentBlocks(moved, stiff, slope, slope * (t[:, None] * n + n[:, None] * t))

    @staticmethod
    def _matrix(
        q_inverse: Array,
        direct: _FirstInvariant | None,
        pressed: Array,
        h: Array,
        precision: type,
        matrix: Array | None,
    ) -> Array:
        """The terms of A with F^-T."""
        q: Array = q_inverse.astype(precision)
        half: Array = pressed / 2 * q_inverse
        crossed: Array = (h * q_inverse).astype(precision)
        bent: Array | None = None
        curves = np.zeros(())
        if direct is not None:
            half += (direct.slope * direct.first / 9) * q_inverse - (2 / 3 * direct.slope) * direct.fg
            if np.any(direct.curvature):
                whole = direct.fg - direct.first / 3 * q_inverse
                bent, curves = whole.astype(precision), (direct.curvature * whole).astype(precision)
        x: Array = half.astype(precision)
        matrix = np.zeros((3, 3, *q.shape), dtype=precision) if matrix is None else matrix
        for k in range(3):
            for i in range(3):
                row = matrix[k, i]
                row += x[k, i] * q
                row += q[k, i] * x
                row -= q[:, None, i] * crossed[None, k]
                if bent is not None:
                    row += curves[k, i] * bent
        return matrix

    def _general(
        self, f: Array, q_inverse: Array, compound: Compound, weights: Array, precision: type | None
    ) -> tuple[Array, Array | None]:
        """Isochoric P = tau F^-T (3, 3, ...) and A = F^-1 (J c + tau 1) F^-T of any compound."""
        whole = np.einsum("ijeqm,jkeq->ikeqm", f, self.inflated)
        tau = compound.stress(whole)[PLACE] * weights
        stress = np.einsum("ij...,jk...->ik...", tau, q_inverse)
        if precision is None:
            return stress, None
        inverse = at_points(q_inverse, 2).swapaxes(-1, -2)
        strains = np.zeros((*inverse.shape[:3], 6, 9))
        for row, (i, m) in enumerate(PAIRS):
            strains[..., row, 3 * i : 3 * i + 3] += inverse[..., m]
            if i != m:
                strains[..., row, 3 * m : 3 * m + 3] += inverse[..., i]
        initial = inverse @ at_points(tau, 2) @ inverse.swapaxes(-1, -2)
        matrix = material_tangent(strains, at_points(compound.tangent(whole) * weights, 2), initial)
        matrix = np.ascontiguousarray(np.moveaxis(matrix, (-2, -1), (0, 1)), dtype=precision)
        return stress, matrix.reshape(3, 3, 3, 3, *weights.shape[:2], -1)
