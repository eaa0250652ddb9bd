"""Small motions of a tyre about its footprint in large motion."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.elements import COMPONENTS
from tyrefem.mechanics.footprint.folding import FoldingElements
from tyrefem.mechanics.footprint.footprint import Footprint
from tyrefem.mechanics.footprint.harmonics import Harmonics
from tyrefem.mechanics.footprint.nonlinear import NonlinearForces, Tangent
from tyrefem.mechanics.footprint.rotations import Rotations
from tyrefem.mechanics.footprint.taut_tyre import TautTyre, tautened
from tyrefem.mechanics.rolling.extreme_motions import Direction, ExtremeMotions
from tyrefem.mechanics.rolling.tread_influence import MIRROR, AntisymmetricHarmonics, TreadInfluence

Array = NDArray[np.float64]
#: Residual of conjugate gradients, and most iterations.
ACCURACY, ITERATIONS = 1e-2, 600


@dataclass(frozen=True, eq=False)
class AntisymmetricTaut(TautTyre):
    """The taut tyre in motions antisymmetric about the mid plane of a half section."""

    @functools.cached_property
    def harmonics(self) -> Harmonics:
        """Stiffness of every harmonic."""
        return AntisymmetricHarmonics(tautened(self.tyre.state))


@dataclass(frozen=True, eq=False)
class TyreOnFootprint(Brief):
    """Small motions K u = f about a footprint in large motion.

    K is the derivative of the inner forces at the footprint's motion, at every angle: there cords are taut or slack,
    and the section is flattened and turned. The forces f keep their direction.

    Parameters
    ----------
    footprint : in large motion. influence : compliance of the inflated tyre without loss.
    accuracy : residual of conjugate gradients over that of no motion, in the norm of what leads them.
    """

    footprint: Footprint
    influence: TreadInfluence
    accuracy: float = ACCURACY

    @property
    def motion(self) -> Array:
        """(highest + 1, n_dofs) the footprint's motion, m."""
        assert self.footprint.balanced is not None
        return self.footprint.balanced

    @property
    def half(self) -> bool:
        """True if the mesh is one half of a symmetric tyre."""
        return self.footprint.pressing.tread.half

    @functools.cached_property
    def tangent(self) -> Tangent:
        """K of motions that are even about the lowest point, in single precision."""
        forces = NonlinearForces(self.footprint.pressing.harmonics, len(self.motion) - 1)
        return forces.at(self.motion, np.float32)

    @functools.cached_property
    def rotations(self) -> Rotations:
        """Rotations of the footprint's motion."""
        round_wheel = self.tangent.outside.round.within(np.float32)
        return Rotations.of(round_wheel, self.motion, self.footprint.pressing.harmonics.held)

    @functools.cached_property
    def taut(self) -> tuple[TautTyre, TautTyre]:
        """The taut tyre in symmetric and in antisymmetric motions."""
        pressing = self.footprint.pressing
        return TautTyre(pressing), AntisymmetricTaut(pressing)

    @functools.cached_property
    def families(self) -> tuple[MotionFamily, ...]:
        """Families of motions, of which none moves another."""
        sides = (False, True) if self.half else (False,)
        return tuple(MotionFamily(self, odd, antisymmetric) for odd in (False, True) for antisymmetric in sides)


@dataclass(frozen=True, eq=False)
class MotionFamily(Brief):
    """Small motions of one symmetry about a footprint, by conjugate gradients on all harmonics together, led by the
    taut tyre turned with the footprint (`newton`).

    Parameters
    ----------
    tyre : on its footprint.
    odd : about the lowest point, as `WheelAngles`. antisymmetric : about the mid plane of a half section.
    """

    tyre: TyreOnFootprint
    odd: bool
    antisymmetric: bool
    #: Extreme motions of earlier searches: the next begins with them.
    _extreme: list[ExtremeMotions] = field(default_factory=list, init=False, repr=False)

    @functools.cached_property
    def _held(self) -> NDArray[np.int64]:
        """Fixed degrees of freedom."""
        harmonics = self.tyre.footprint.pressing.harmonics
        if self.antisymmetric:
            return AntisymmetricHarmonics(harmonics.state, mirrored=harmonics).held
        return harmonics.held

    @property
    def signs(self) -> Array:
        """(3,) of the components (r, z, t) of the motion's mirror image in the mid plane."""
        return -MIRROR if self.antisymmetric else MIRROR

    @property
    def tread(self) -> NDArray[np.int64]:
        """(3, nodes) degrees of freedom of the tread."""
        return np.asarray(COMPONENTS * self.tyre.influence.tread.nodes + np.arange(COMPONENTS)[:, None])

    @functools.cached_property
    def inflated(self) -> Array:
        """(highest + 1, 3, nodes, 3, nodes) motion of the inflated tyre's tread, m, per force on it, N per radian."""
        influence = self.tyre.influence
        nodes, sides = influence.source
        near, other = np.flatnonzero(sides > 0), np.flatnonzero(sides < 0)
        made = []
        for n in range(len(self.tyre.motion)):
            solved = np.array(influence.solved(n)[:, near])
            here = solved[..., near]
            if self.tyre.half:
                alone = np.setdiff1d(np.arange(len(near)), influence.mirrored)
                here[..., alone] *= 2.0
                here[..., nodes[other]] += solved[..., other] * self.signs[:, None]
            made.append(here)
        free = ~np.isin(self.tread, self._held)
        inflated = np.stack(made) * free[:, :, None, None] * free
        inflated[0][list(self._still)] = 0.0
        inflated[0][:, :, list(self._still)] = 0.0
        return np.asarray(inflated)

    @property
    def _still(self) -> tuple[int, ...]:
        """Components that no wave of n = 0 has."""
        return (0, 1) if self.odd else (2,)

    @functools.cached_property
    def _tangent(self) -> Tangent:
        even = self.tyre.tangent
        return replace(even, outside=replace(even.outside, odd=self.odd))

    @functools.cached_property
    def _rotations(self) -> Rotations:
        round_wheel = self._tangent.outside.round.within(np.float32)
        return Rotations(round_wheel, self.tyre.rotations.matrices, self._held)

    def free(self, loads: Array) -> Array:
        """Forces (highest + 1, 3, nodes) on the tread without those that move nothing."""
        loads = loads * ~np.isin(self.tread, self._held)
        loads[0, list(self._still)] = 0.0
        return np.asarray(loads)

    def work(self, loads: Array, motion: Array) -> float:
        """Work on the whole tyre, J, of forces, N per radian, on a motion of the tread, m."""
        return (2 if self.tyre.half else 1) * np.pi * TautTyre.work(loads, motion)

    def of_inflated(self, loads: Array) -> Array:
        """(highest + 1, 3, nodes) motion of the inflated tyre's tread, m, under forces on it, N per radian."""
        return np.einsum("ncjdk,ndk->ncj", self.inflated, loads, optimize=True)

    def of_loaded(self, loads: Array) -> Array:
        """(highest + 1, n_dofs) motion about the footprint, m, under forces on the tread, N per radian.

        Raises
        ------
        InputError : the footprint is not stable.
        """
        forces = np.zeros_like(self.tyre.motion)
        forces[:, self.tread] = self.free(loads)
        folding = FoldingElements()
        tangent = self._tangent
        known = self._extreme[0] if self._extreme else ExtremeMotions.none(forces.size)
        while True:
            motion, directions, stable = self._search(tangent, forces, known)
            if stable:
                if not folding:
                    self._extreme[:] = [known.after(directions)]
                return motion
            if not folding.add(tangent, directions[-1].field(motion)):
                raise InputError("the tyre is not stable in its footprint: a small motion about it has no stiffness")
            tangent, known = folding.convex(self._tangent), ExtremeMotions.none(forces.size)

    def _moving(self, field: Array) -> Array:
        """A field (highest + 1, n_dofs) without held degrees of freedom and those that no wave of n = 0 has."""
        field = np.array(field, dtype=float)
        field[:, self._held] = 0.0
        for component in self._still:
            field[0, component::COMPONENTS] = 0.0
        return field

    def _search(self, tangent: Tangent, residual: Array, known: ExtremeMotions) -> tuple[Array, list[Direction], bool]:
        """Conjugate gradients: the motion, the directions of the search, and False if the last of them has no positive
        stiffness."""
        change = self._led(residual)
        least = self.tyre.accuracy**2 * TautTyre.work(residual, change)
        motion = known.balanced(residual)
        if motion.any():
            residual = residual - self._moving(tangent.product(motion))
            change = self._led(residual)
        size = TautTyre.work(residual, change)
        along, led = known.without(change, residual)
        directions: list[Direction] = []
        for _ in range(ITERATIONS):
            if size <= least:
                return motion, directions, True
            bent = self._moving(tangent.product(along))
            stiffness = TautTyre.work(bent, along)
            directions.append(Direction.of(along, bent, led, stiffness))
            if stiffness <= 0:
                return motion, directions, False
            motion += size / stiffness * along
            residual = residual - size / stiffness * bent
            change, before = self._led(residual), size
            size = TautTyre.work(residual, change)
            part = known.without(change, residual)
            along, led = (new + size / before * old for new, old in zip(part, (along, led), strict=True))
        raise InputError(f"small motions about the footprint are not found in {ITERATIONS} iterations")

    def _led(self, residual: Array) -> Array:
        """Motion of the turned taut tyre under a residual."""
        turned = self._moving(self._rotations.backward(residual))
        return self._moving(self._rotations.forward(self.tyre.taut[self.antisymmetric].solve(turned)))
