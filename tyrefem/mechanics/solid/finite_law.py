"""Stress and tangent of a pre-stressed body in a further motion of any size: from its compounds and cords, or linear
in Green's strain."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.solid.compounds import Compound, determinant
from tyrefem.mechanics.solid.cords import CordLayer
from tyrefem.mechanics.solid.elements import Indices, Rings
from tyrefem.mechanics.solid.parts import RegionMaterial
from tyrefem.mechanics.solid.six_components import PAIRS, PLACE
from tyrefem.mechanics.solid.tread_blocks import TreadBlocks

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
#: Number of points computed together: their tensors stay in the processor's cache.
TOGETHER = 4000


@dataclass(frozen=True, eq=False)
class StressResponse:
    """First Piola stress P in the pre-stressed configuration and its derivative, both times r dA, at m angles.

    dP = A : dF + V kappa Proj(V : dF), V = dJ/dF: the dilatation is projected on 1, xi, eta of each element.

    Parameters
    ----------
    stress : (e, 9, q, m) P, N m per radian; components 3 k + i with direction k of the force and i of the gradient.
    tangent : (e, 9, 9, q m) A. volume : (e, 9, q, m) V, as precise as A. Empty if only the stress is computed.
    functions : (e, q, 3) 1, xi, eta. bulk : (e, 3, 3) bulk stiffness between them.
    """

    stress: Array
    tangent: Array
    volume: Array
    functions: Array
    bulk: Array

    def product(self, change: Array) -> Array:
        """(e, 9, q, m) change of the stress due to a change (e, 9, q, m) of the gradient."""
        precision = self.tangent.dtype
        change = change.astype(precision, copy=False)
        functions, bulk = self.functions.astype(precision), self.bulk.astype(precision)
        product = np.einsum("eijp,ejp->eip", self.tangent, change.reshape(len(change), 9, -1)).reshape(change.shape)
        dilatation = np.einsum("ecqm,ecqm->eqm", self.volume, change)
        moments = bulk @ (functions.transpose(0, 2, 1) @ dilatation)
        product += self.volume * (functions @ moments)[:, None]
        return np.asarray(product)

    def convex(self, flagged: Flags) -> StressResponse:
        """The response with |A| instead of A in some elements at some angles, flags (e, m): its eigenvalues become
        positive."""
        at = np.broadcast_to(flagged[:, None], (len(flagged), *self.volume.shape[2:])).reshape(len(flagged), -1)
        element, point = np.nonzero(at)
        matrices = self.tangent[element, :, :, point].astype(float)
        values, vectors = np.linalg.eigh(matrices)
        tangent = self.tangent.copy()
        tangent[element, :, :, point] = (vectors * np.abs(values)[:, None]) @ vectors.swapaxes(-1, -2)
        return replace(self, tangent=tangent)

    def stiffer(self, rings: Rings, gradient: Array, modulus: Array, bulk: Array) -> StressResponse:
        """The response with a tangent ``modulus`` (6, 6, e, q), Pa, more and the bulk stiffness times ``bulk`` (e,), at
        gradients (e, 9, q, m); stresses do not change: dP = F dc F' : dF more."""
        strains = _strain_gradients(_deformation(gradient))
        c = _points(modulus * rings.weights, 2)[:, :, None]
        more = (strains.swapaxes(-1, -2) @ (c @ strains)).transpose(0, 3, 4, 1, 2).reshape(self.tangent.shape)
        tangent = self.tangent + more.astype(self.tangent.dtype)
        return replace(self, tangent=tangent, bulk=self.bulk * bulk[:, None, None])


class FiniteLaw(Protocol):
    """Stress as a function of displacement gradients from a pre-stressed configuration."""

    def response(self, gradient: Array, tangent: type | None = float) -> StressResponse:
        """`StressResponse` at displacement gradients H (e, 9, q, m) from the pre-stressed configuration.

        ``tangent`` : precision of the tangent; None: only the stress.
        """
        ...  # pragma: no cover


def _deformation(gradient: Array) -> Array:
    """(3, 3, e, q, m) F = 1 + H."""
    e, _, q, m = gradient.shape
    f = np.ascontiguousarray(gradient.transpose(1, 0, 2, 3))
    f[[0, 4, 8]] += 1
    return f.reshape(3, 3, e, q, m)


def _inverse(f: Array) -> Array:
    """(3, 3, ...) inverse by cofactors."""
    inverse = np.empty_like(f)
    for i in range(3):
        for j in range(3):
            a, b, c, d = (i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3
            inverse[j, i] = f[a, c] * f[b, d] - f[a, d] * f[b, c]
    inverse /= (f[0] * inverse[:, 0]).sum(axis=0)
    return inverse


def _points(tensors: Array, axes: int) -> Array:
    """Tensors with their one or two component axes moved from the front to the end, contiguous."""
    return np.ascontiguousarray(np.moveaxis(tensors, range(axes), range(-axes, 0)))


def _components(tensors: Array) -> Array:
    """(e, 9, q, m) of components (e, q, m, 9)."""
    return np.ascontiguousarray(np.moveaxis(tensors, -1, 1))


def _strain_gradients(f: Array) -> Array:
    """(e, q, m, 6, 9) B of dE = B dF at deformations F (3, 3, e, q, m)."""
    strains = np.zeros((*f.shape[2:], 6, 9))
    for row, (i, j) in enumerate(PAIRS):
        for k in range(3):
            strains[..., row, 3 * k + j] += f[k, i]
            if i != j:
                strains[..., row, 3 * k + i] += f[k, j]
    return strains


def _tangent(strains: Array, stiffness: Array, initial: Array) -> Array:
    """(e, q, m, 9, 9) B' c B + 1 S of B (e, q, m, 6, 9), c (e, q, m or 1, 6, 6), S (e, q, m, 3, 3)."""
    tangent = strains.swapaxes(-1, -2) @ (stiffness @ strains)
    for k in range(3):
        tangent[..., 3 * k : 3 * k + 3, 3 * k : 3 * k + 3] += initial
    return np.asarray(tangent)


@dataclass(frozen=True, eq=False)
class GreenLaw:
    """S = s_0 + c : E + kappa Proj(tr E) 1, E = sym H + H'H/2: large rotations, moderate strains.

    Parameters
    ----------
    rings : shape functions of the pre-stressed configuration.
    initial, modulus, bulk_modulus : s_0 (6, e, q), c (6, 6, e, q), kappa (e, q), Pa.
    """

    rings: Rings
    initial: Array
    modulus: Array
    bulk_modulus: Array

    @functools.cached_property
    def _bulk(self) -> Array:
        functions, weights = self.rings.linear_functions, self.rings.weights
        return np.einsum("eqa,eq,eqb->eab", functions, weights * self.bulk_modulus, functions)

    def response(self, gradient: Array, tangent: type | None = float) -> StressResponse:
        """P = F S, A = F c F' + 1 S."""
        points = (*gradient.shape[:1], *gradient.shape[2:])
        f, functions, weights = _deformation(gradient), self.rings.linear_functions, self.rings.weights[..., None]
        green = [(f[:, i] * f[:, j]).sum(axis=0) - (i == j) for i, j in PAIRS]
        strain = np.stack([part / (2 if i == j else 1) for part, (i, j) in zip(green, PAIRS, strict=True)])
        six = np.einsum("ijeq,jeqm->ieqm", self.modulus, strain, optimize=True) + self.initial[..., None]
        moments = self._bulk @ (functions.transpose(0, 2, 1) @ (weights * strain[:3].sum(axis=0)))
        six[:3] += functions @ moments
        s = _points(six[PLACE] * weights, 2)
        stress = _components((_points(f, 2) @ s).reshape(*points, 9))
        if tangent is None:
            return StressResponse(stress, np.zeros(0), np.zeros(0), functions, self._bulk)
        strains = _strain_gradients(f)
        c = _points(self.modulus * self.rings.weights, 2)[:, :, None]
        volume = (f * weights).reshape(9, *points).transpose(1, 0, 2, 3)
        matrix = _tangent(strains, c, s).transpose(0, 3, 4, 1, 2)
        matrix = np.ascontiguousarray(matrix, dtype=tangent).reshape(len(gradient), 9, 9, -1)
        return StressResponse(stress, matrix, np.ascontiguousarray(volume, dtype=tangent), functions, self._bulk)


@dataclass(frozen=True, eq=False)
class BodyLaw:
    """The stress of a body's compounds and cords at F F_0; cords may be slack at some angles and taut at others.

    Parameters
    ----------
    rings : shape functions of the body before inflation.
    parts : region -> its material. members : region -> numbers of its elements.
    bulk_modulus : (e,) Pa. inflated : (3, 3, e, q) F_0.
    """

    rings: Rings
    parts: Mapping[str, RegionMaterial]
    members: Mapping[str, Indices]
    bulk_modulus: Array
    inflated: Array

    @functools.cached_property
    def _bulk(self) -> Array:
        return np.asarray(self.bulk_modulus[:, None, None] * np.eye(3))

    def slack(self) -> Array:
        """(6, 6, e, q) by how much more stiff slack cords would be if they were taut, in the pre-stressed
        configuration, Pa."""
        missing = np.zeros((6, 6, *self.inflated.shape[2:]))
        for name, part in self.parts.items():
            members = self.members[name]
            f = self.inflated[:, :, members]
            for layer in part.cords:
                taut = replace(layer, compression=max(layer.compression, 1.0), limit=np.inf)
                missing[:, :, members] += (taut.tangent(f) - layer.tangent(f)) / determinant(f)
        return missing

    def response(self, gradient: Array, tangent: type | None = float) -> StressResponse:
        """P and A of every region, in groups of elements."""
        e, _, q, m = gradient.shape
        stress = np.empty(gradient.shape)
        tangents = np.empty((e, 9, 9, q * m), dtype=tangent) if tangent else np.empty(0)
        volume = np.empty(gradient.shape if tangent else 0, dtype=tangent)
        count = max(1, TOGETHER // (q * m))
        for name, part in self.parts.items():
            members = np.asarray(self.members[name])
            for k in range(0, len(members), count):
                inside = slice(k, k + count)
                some = members[inside]
                group = _Group(self.rings, some, self.bulk_modulus[some], self.inflated[:, :, some], gradient[some])
                cords = tuple(
                    replace(
                        layer,
                        angle=layer.angle[inside],
                        meridian=layer.meridian[:, inside],
                        stiffness=layer.stiffness[inside][..., None],
                    )
                    for layer in part.cords
                )
                blocks = part.blocks
                if blocks is not None:
                    blocks = replace(blocks, normal=blocks.normal[:, inside], missing=blocks.missing[inside][..., None])
                made = group.response(part.compound, cords, blocks, tangent)
                stress[some] = made[0].transpose(1, 0, 2, 3)
                if tangent:
                    tangents[some] = made[1].reshape(9, 9, len(some), q * m).transpose(2, 0, 1, 3)
                    volume[some] = made[2].transpose(1, 0, 2, 3)
        return StressResponse(stress, tangents, volume, self.rings.linear_functions, self._bulk)


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
class _Group:
    """Elements of one region at all angles: F = 1 + H, F_0 (3, 3, e, q), and the elements' numbers and bulk moduli."""

    rings: Rings
    members: Indices
    bulk: Array
    inflated: Array
    gradient: Array

    def response(
        self, compound: Compound, cords: tuple[CordLayer, ...], blocks: TreadBlocks | None, precision: type | None
    ) -> tuple[Array, Array, Array]:
        """P (9, e, q, m), A (9, 9, e, q, m) and V (9, e, q, m), times r dA.

        With Q = F^-T, G = F_0 F_0', I1 = F : F G, c = J^(-2/3), s = 2 c W_1 and a = F d (d: cord after inflation):

        P = s F G + h Q + sum W'/l a d,  h = p J - s I1/3,
        A = s 1 G - 2/3 s (F G Q + Q F G) + (p J + 2/9 s I1) Q Q + 4 c^2 W_11 q q - h Q Q (crossed)
            + sum [(W'' - W'/l)/l^2 a d a d + W'/l 1 d d],  q = F G - I1/3 Q,

        and of blocks, B = a t + c n with a = F n, c = F t:  P = W' B,  A = W'' B B + W' 1 (t n + n t).
        """
        f = _deformation(self.gradient)
        functions = self.rings.linear_functions[self.members]
        weights = self.rings.weights[self.members][..., None]
        q_inverse = np.ascontiguousarray(_inverse(f).swapaxes(0, 1))
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
        taut = [cord for layer in cords for cord in self._taut(f, layer, weights)]
        for cord in taut:
            stress += (cord.pull * cord.along)[:, None] * cord.direction
        bent = None if blocks is None else self._bent(f, blocks, weights)
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
        inverse = _points(q_inverse, 2).swapaxes(-1, -2)
        strains = np.zeros((*inverse.shape[:3], 6, 9))
        for row, (i, m) in enumerate(PAIRS):
            strains[..., row, 3 * i : 3 * i + 3] += inverse[..., m]
            if i != m:
                strains[..., row, 3 * m : 3 * m + 3] += inverse[..., i]
        initial = inverse @ _points(tau, 2) @ inverse.swapaxes(-1, -2)
        matrix = _tangent(strains, _points(compound.tangent(whole) * weights, 2), initial)
        matrix = np.ascontiguousarray(np.moveaxis(matrix, (-2, -1), (0, 1)), dtype=precision)
        return stress, matrix.reshape(3, 3, 3, 3, *weights.shape[:2], -1)
