"""How much softer or stiffer the tread of a pressed tyre is than that of the inflated tyre."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from tyrefem.brief import Brief
from tyrefem.mechanics.footprint.elements import COMPONENTS
from tyrefem.mechanics.rolling.loaded_tyre import MotionFamily, TyreOnFootprint
from tyrefem.mechanics.rolling.points_on_wheel import PointsOnWheel

Array = NDArray[np.float64]
#: Share of the work of forces that is left unknown.
REST = 3e-4


@dataclass(frozen=True, eq=False)
class KnownMotions:
    """Forces q of a family and the motions under them.

    Parameters
    ----------
    forces : (k, n, 3, nodes) q on the tread, N per radian, with q_i . C q_j = 1 for i = j, else 0.
    inflated : (k, n, 3, nodes) C q, m. loaded : (k, n, n_dofs) C_t q of the whole section, m.
    turns : (k,) angle, rad, by which q turns the shape d in C q.
    """

    forces: Array
    inflated: Array
    loaded: Array
    turns: Array

    def with_more(self, other: KnownMotions) -> KnownMotions:
        """These and others."""
        parts = ((getattr(self, part.name), getattr(other, part.name)) for part in fields(self))
        return KnownMotions(*(np.concatenate(part) for part in parts))


@dataclass(frozen=True, eq=False)
class FootprintTurn:
    """Forces f0', N per radian, motion u0' and what d adds, d', m, per radian by which a footprint turns round the
    wheel; all at the tread."""

    family: MotionFamily
    forces: Array
    motion: Array
    shape: Array

    @classmethod
    def of(cls, family: MotionFamily) -> FootprintTurn:
        """Of the footprint of the symmetric odd family."""
        footprint = family.tyre.footprint
        per_radian = -np.arange(len(family.tyre.motion))[:, None, None]
        loads = footprint.grid.load_harmonics(-footprint.direction * footprint.forces)[: len(per_radian)]
        forces = np.zeros((len(per_radian), *family.tread.shape))
        forces[:, list(footprint.grid.tread.components)] = per_radian * loads
        forces, motion = family.free(forces), family.free(per_radian * family.tyre.motion[:, family.tread])
        return cls(family, forces, motion, motion - family.of_inflated(forces))

    @property
    def stiffness(self) -> float:
        """d' . f0', N m: what holds d."""
        return self.family.work(self.forces, self.shape)

    def without(self, forces: Array) -> Array:
        """Forces that do no work where the footprint turns."""
        whole = self.family.work(self.forces, self.motion)
        return forces - self.family.work(forces, self.motion) / whole * self.forces

    def angle(self, forces: Array) -> float:
        """Angle by which forces turn d, rad."""
        return self.family.work(forces, self.shape) / self.stiffness


@dataclass(frozen=True, eq=False)
class LoadedCompliance(Brief):
    """D = C_t - C: how forces move the tread about the footprint more than about the inflated tyre.

    `TyreOnFootprint` gives the motion C_t q under some forces q. From those that are known,

    D = (C_t q) (q . C_t q)^-1 (C_t q)' - (C q) (C q)',   q_i . C q_j = 1 for i = j, else 0.

    Forces q then move the tread by C_t q, and C + D is positive definite as C_t is (the update of quasi-Newton methods,
    of several directions at once). `SteadyRolling` makes the forces known that its solutions have. Harmonics above the
    motion's are those of the inflated tyre.

    C here is the compliance of the inflated tyre whose pressed shape d turns with the forces, C + d' d''/(d' . f0'), as
    `PressedShape` has it. Where the footprint turns round the wheel, f0', D is zero.

    Parameters
    ----------
    tyre : on its footprint. known : forces and motions by family.
    rest : forces are known if what is new in them does less than this share of their work on the inflated tyre.
    turning : False: no shape turns beside C, and D has all of C_t - C.
    """

    tyre: TyreOnFootprint
    known: Mapping[MotionFamily, KnownMotions] = field(default_factory=dict)
    rest: float = REST
    turning: bool = True

    @functools.cached_property
    def weights(self) -> Array:
        """(n, n) of all `motions`: forces f move the points by the sum over i, j of motion_i weights_ij (motion_j . f)
        more."""
        blocks = []
        for family, known in self.known.items():
            at_tread = known.loaded[:, :, family.tread]
            work = np.array([[family.work(force, motion) for motion in at_tread] for force in known.forces])
            blocks += [np.linalg.inv((work + work.T) / 2), -np.eye(len(work))]
        return np.asarray(block_diag(*blocks)) if blocks else np.zeros((0, 0))

    def motions(self, points: PointsOnWheel) -> Array:
        """(n_angles, 3, m, n) displacements of points along (r, z, t), m."""
        made = [
            points.displacements(family, np.concatenate([known.loaded[:, :, family.tread], known.inflated]))
            for family, known in self.known.items()
        ]
        if made:
            return np.concatenate(made, axis=-1)
        return np.zeros((len(points.angles), COMPONENTS, len(points.influence.places[0]), 0))

    def section_motions(self, points: PointsOnWheel, forces: Array) -> Iterator[tuple[MotionFamily, Array, Array]]:
        """What D makes of forces (n_angles, 3, m) along (r, z, t), N, of each family: forces on the tread
        (n, 3, nodes), N per radian, whose motion of the inflated tyre is taken off, and a motion of the whole section
        (n, n_dofs), m, that is added."""
        shares = self.weights @ np.tensordot(forces, self.motions(points), axes=3)
        for family, known in self.known.items():
            count = len(known.forces)
            more, less = shares[:count], -shares[count : 2 * count]
            shares = shares[2 * count :]
            taken, motion = np.tensordot(less, known.forces, axes=1), np.tensordot(more, known.loaded, axes=1)
            angle = float(less @ known.turns)
            if angle:
                taken = taken - angle * self._turn.forces
                motion = motion + angle * np.arange(len(motion))[:, None] * self.tyre.motion
            yield family, taken, motion

    def knowing(self, points: PointsOnWheel, forces: Array) -> LoadedCompliance:
        """With forces (n_angles, 3, m) along (r, z, t), N, beyond the footprint's; itself, if they are known.

        Raises
        ------
        InputError : the footprint is not stable.
        """
        rests = {}
        total = 0.0
        for family in self.tyre.families:
            force, motion = self._inflated(family, points.loads(family, forces, len(self.tyre.motion)))
            total += family.work(force, motion)
            known = self.known.get(family)
            if known is not None:
                shares = np.array([family.work(force, other) for other in known.inflated])
                force = force - np.tensordot(shares, known.forces, axes=1)
                motion = motion - np.tensordot(shares, known.inflated, axes=1)
            rests[family] = force, motion, family.work(force, motion)
        more = {family: rest for family, rest in rests.items() if rest[2] > self.rest * total}
        if not more:
            return self
        added = dict(self.known)
        for family, (force, motion, work) in more.items():
            force, motion = force / np.sqrt(work), motion / np.sqrt(work)
            turns = np.array([self._turn.angle(force) if self._turns(family) else 0.0])
            new = KnownMotions(force[None], motion[None], family.of_loaded(force)[None], turns)
            added[family] = new if family not in added else added[family].with_more(new)
        return replace(self, known=added)

    def _inflated(self, family: MotionFamily, force: Array) -> tuple[Array, Array]:
        """Forces without those of a turn round the wheel, and the motion C q."""
        if not self._turns(family):
            return force, family.of_inflated(force)
        force = self._turn.without(force)
        return force, family.of_inflated(force) + self._turn.angle(force) * self._turn.shape

    def _turns(self, family: MotionFamily) -> bool:
        """True if forces of a family turn the pressed shape."""
        return self.turning and family is self._turn.family and self._turn.stiffness > 0

    @functools.cached_property
    def _turn(self) -> FootprintTurn:
        families = self.tyre.families
        return FootprintTurn.of(next(family for family in families if family.odd and not family.antisymmetric))
