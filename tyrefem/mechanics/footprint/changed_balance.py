"""Balances in large motion of tyres with another stiffness: only what changes is searched for."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.footprint.elements import COMPONENTS
from tyrefem.mechanics.footprint.footprint import Footprint
from tyrefem.mechanics.footprint.large_motion import DeflectedState, LargeMotion
from tyrefem.mechanics.footprint.newton import NewtonStep, Preconditioner, SearchEnd, newton_step
from tyrefem.mechanics.footprint.nonlinear import NonlinearForces, Tangent

Array = NDArray[np.float64]
#: Residual of the first Newton step over what it balances, and of later steps over the change, in the energy's norm.
FIRST, ACCURACY = 0.15, 0.05
#: The change has settled where it began a step with less than this share of its work unbalanced; with more than the
#: second one there is no convergence.
SETTLED, FAR = 0.04, 0.2
#: Newton steps, and the largest change of a displacement gradient in one.
STEPS, WILD = 5, 0.7
#: After a smaller change of a displacement gradient the last stiffness is used again.
ALIKE = 0.05


@dataclass(frozen=True, eq=False)
class Imbalance:
    """What the search for a balance left: ``forces`` g + B' f (highest + 1, n_dofs), N per radian; ``gaps`` of its
    closed points (n_angles, nodes), m; ``load``: that of the balance minus the sum of its contact forces, N."""

    forces: Array
    gaps: Array
    load: float

    @classmethod
    def of(cls, near: Footprint) -> Imbalance:
        """Of a footprint in large motion."""
        assert near.balanced is not None
        grid = near.grid
        forces = NonlinearForces(near.pressing.harmonics, len(near.balanced) - 1).forces(near.balanced)
        pushed = grid.load_harmonics(near.direction * near.forces)[: len(forces)]
        for of, component in enumerate(grid.tread.components):
            forces[:, COMPONENTS * grid.tread.nodes + component] += pushed[:, of]
        gaps = np.where(near.forces > 0, near.gaps, 0.0).reshape(grid.n_angles, -1)
        return cls(forces, gaps, near.load - near.pressure_integral)

    def gaps_at(self, n_angles: int) -> Array:
        """(k,) gaps with another number of angles."""
        fitted = np.zeros((n_angles, self.gaps.shape[1]))
        count = min(n_angles, len(self.gaps))
        fitted[:count] = self.gaps[:count]
        return fitted.ravel()


@dataclass(frozen=True, eq=False)
class ChangedBalances:
    """Balances of tyres that differ from the tyre of a footprint in their stiffness.

    A balance of loose tolerance is off by some d, mostly in motions that hardly any stiffness holds. Those of the
    changed tyres keep what it left (`Imbalance`), so that they are off by nearly the same d, and their differences by
    little. Such a search can be loose: 5 % of the change, where a search for the balance anew leaves 0.1 % of the
    whole motion, as much as a small change.

    Parameters
    ----------
    near : the footprint. accuracy : residual of a Newton step over the change of the motion, in the energy's norm.
    """

    near: Footprint
    accuracy: float = ACCURACY

    @functools.cached_property
    def kept(self) -> Imbalance:
        """What the balance of the footprint left."""
        return Imbalance.of(self.near)

    def balance(self, tyre: LargeMotion, start: DeflectedState, load: float | None) -> DeflectedState | None:
        """The balance of another tyre at the footprint's deflection, or under a load, N; None without convergence.

        ``start`` : the footprint, on a grid of that tyre.
        """
        search = _ChangeSearch(self, tyre, start, load)
        for _ in range(STEPS):
            if not search.advance():
                return None
            if search.settled:
                return replace(search.moment, forces=np.maximum(search.moment.forces, 0.0))
        return None


class _ChangeSearch:
    """Newton steps from a footprint to the balance of a changed tyre, beside what the footprint left unbalanced.

    ``moment``: the state so far. ``settled``: whether it is a balance. ``change``: of a displacement gradient in the
    latest step.
    """

    tangent: Tangent
    lead: Preconditioner
    gaps: Array
    normal_components: Array

    def __init__(self, near: ChangedBalances, tyre: LargeMotion, start: DeflectedState, load: float | None) -> None:
        self.kept, self.accuracy, self.tyre, self.start, self.load = near.kept, near.accuracy, tyre, start, load
        self.moment = start
        self.outside = tyre.nonlinear(start.harmonics)
        self.end = SearchEnd(FIRST)
        self.change, self.steps, self.settled = np.inf, 0, False
        #: Contact sets of the next step and of the latest one.
        self.closed = self.before = start.forces > 0

    def advance(self) -> bool:
        """A Newton step; then see whether the change has settled. False: it is unstable or too far."""
        self._linearise()
        moment, tyre, lead = self.moment, self.tyre, self.lead
        right = replace(self.tangent, forces=self.tangent.forces - self.kept.forces)
        distance = self.gaps - lead.touching.tail @ moment.forces
        start = NewtonStep(np.zeros_like(moment.motion), self._carried(), 0, right.forces)
        step = newton_step(lead, right, distance, self.end, start)
        self.change = float(np.abs(self.outside.round.within(np.float32).gradient(step.motion)).max())
        if not step.stable or self.change > WILD or step.started > self.end.most:
            return False
        self.gaps = distance - lead.touching.into(step.motion) + lead.touching.tail @ step.forces
        deflection = lead.deflection(self.gaps[self.closed])
        self.gaps = self.gaps - deflection * self.normal_components
        self.before, self.closed = self.closed, lead.touching.closed(self.gaps, step.forces, self.closed)
        self.moment = replace(
            moment, deflection=moment.deflection + deflection, motion=moment.motion + step.motion, forces=step.forces,
            load=tyre.sides * float(self.normal_components @ step.forces) + self.kept.load,
        )  # fmt: skip
        whole = self.moment.motion - self.start.motion
        work = tyre.factors.work(self.tangent.product(whole), whole)
        self.end, self.steps = SearchEnd(least=self.accuracy**2 * work, most=FAR * work), self.steps + 1
        self.settled = self.steps > 1 and step.started <= SETTLED * work
        return True

    def _carried(self) -> Array:
        """(k,) contact forces of the closed points, N, with the load."""
        forces = np.where(self.closed, self.moment.forces, 0.0)
        if self.load is not None:
            normal = np.where(self.closed, self.normal_components, 0.0)
            wanted = (self.load - self.kept.load) / self.tyre.sides
            forces += (wanted - normal @ forces) / (normal @ normal) * normal
        return forces

    def _linearise(self) -> None:
        """Forces, stiffness and contact at the state; a stiffness nearly the same is used again."""
        moment, tyre = self.moment, self.tyre
        if self.change <= ALIKE:
            self.tangent = replace(self.tangent, forces=self.outside.forces(moment.motion))
            if np.array_equal(self.closed, self.before):
                return
            touching, rotations = self.lead.touching, self.lead.rotations
        else:
            self.tangent = self.outside.at(moment.motion, np.float32)
            gaps, self.normal_components, touching, _ = tyre.at_road(moment)
            self.gaps = gaps - self.kept.gaps_at(moment.grid.n_angles)
            rotations = tyre.rotations(self.outside, moment.motion)
            if not self.steps:
                self.closed = touching.closed(self.gaps, moment.forces, self.closed)
        normal = None if self.load is None else self.normal_components
        self.lead = Preconditioner(touching, np.flatnonzero(self.closed), rotations, normal)
