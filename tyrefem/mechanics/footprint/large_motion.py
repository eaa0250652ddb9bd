"""A pressed tyre in large motion: balance at a deflection or load, from a nearby balance."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.folding import FoldingElements
from tyrefem.mechanics.footprint.footprint import Footprint
from tyrefem.mechanics.footprint.grid import ContactGrid
from tyrefem.mechanics.footprint.imbalance import Imbalance
from tyrefem.mechanics.footprint.newton import NewtonStep, SearchEnd, newton_step
from tyrefem.mechanics.footprint.nonlinear import NonlinearForces, Tangent
from tyrefem.mechanics.footprint.rotations import Rotations
from tyrefem.mechanics.footprint.taut_tyre import TautTyre
from tyrefem.mechanics.footprint.touching import Touching
from tyrefem.mechanics.solid.finite_law import FiniteLaw

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
#: Largest change of a displacement gradient: aimed at in the first Newton step, in later steps, and before damping.
AHEAD, CORRECTION, WILD = 0.35, 0.7, 2.0
#: A first Newton step that is larger than aimed at by more than this factor is made smaller.
LARGE_STEP = 1.6
#: Damping of the first Newton step to another deflection, and after an unstable step; number of unstable steps after
#: which the balance fails.
DAMPING, UNSTABLE = 0.1, 8
#: Least damping after a Newton step whose change of a displacement gradient is below `SMOOTH`; else it is `DAMPING`.
LEAST_DAMPING, SMOOTH = 0.005, 0.1
#: After a larger change folding elements are convex.
CONVEX = 0.1
#: Damping of the first Newton step where more harmonics refine a balance.
REFINING = 0.01
#: After a smaller change the last stiffness is used again.
ALIKE = 0.02
#: Newton steps. After the last, and after two changes below the smaller factor times the tolerance, a change and a
#: missed load of the larger factor times the tolerance are allowed.
STEPS, STILL, CYCLE = 12, 0.5, 3.0
#: After a Newton step the next one is smaller by more than this factor: a loose balance ends one step earlier.
NEXT = 10.0
#: In the last step the load changes by less than this times the tolerance. In a looser state it can be 20 % off.
LOAD_CHANGE = 20.0
#: Largest change of a displacement gradient in the last step.
LAST = 0.2
#: Above this tolerance, and below it, this share of the contacts may change in the last step.
LOOSE, FLIPPED = 5e-3, (0.1, 0.02)
#: Accuracy of conjugate gradients: residual of a Newton step; energy for a change of deflection and for the stiffness.
INNER, BORDER, STIFFNESS = 0.05, 0.03, 5e-3
#: Residual of a Newton step to a changed balance: it starts with that balance's forces.
INNER_CHANGE = 0.1
#: Residual that ends conjugate gradients, in the energy's norm, over the tolerance.
ENERGY = 0.4
#: The angles of possible contact are those of the deflection times this factor.
WIDER = 1.6
#: Largest deflection over that at which the crown meets the rim.
BEFORE_RIM = 0.999


@dataclass(frozen=True, eq=False)
class DeflectedState:
    """Amplitudes ``motion`` (harmonics + 1, n_dofs), m, and contact forces (k,) on a grid, N, at a deflection, m; the
    load of the whole tyre, N; ``rate``: motion, forces and load per metre of further deflection, None: not computed."""

    deflection: float
    motion: Array
    grid: ContactGrid
    forces: Array
    load: float = 0.0
    rate: tuple[Array, Array, float] | None = None

    @property
    def harmonics(self) -> int:
        """Highest harmonic."""
        return len(self.motion) - 1


@dataclass(frozen=True, eq=False)
class LargeMotion:
    """Newton steps on all harmonics together until internal and contact forces balance, with a new contact set in each.

    Parameters
    ----------
    pressing : the tyre and its road.
    law : stress; by default that of the state.
    before_rim : largest deflection over that at which the crown meets the rim.
    leading : the small motions that lead the search, of a tyre with the same mesh; None: those of this tyre.
    """

    pressing: Pressing
    law: FiniteLaw | None = None
    before_rim: float = BEFORE_RIM
    leading: TautTyre | None = None
    _forces: dict[int, NonlinearForces] = field(default_factory=dict, init=False, repr=False)
    _folding: FoldingElements = field(default_factory=FoldingElements, init=False, repr=False)
    _touching: list[Touching] = field(default_factory=list, init=False, repr=False)

    @functools.cached_property
    def factors(self) -> TautTyre:
        """The tyre in small motions that leads the search."""
        return self.leading or TautTyre(self.pressing)

    @property
    def _sides(self) -> float:
        """Sides of the tyre per side of the mesh."""
        return 2.0 if self.pressing.tread.half else 1.0

    @property
    def largest_deflection(self) -> float:
        """Largest deflection, m: just before the crown meets the rim."""
        return self.before_rim * self.pressing.bottoming

    def nonlinear(self, harmonics: int) -> NonlinearForces:
        """Internal forces with a number of harmonics; the last is kept."""
        if harmonics not in self._forces:
            self._forces.clear()
            self._forces[harmonics] = NonlinearForces(self.pressing.harmonics, harmonics, self.law)
        return self._forces[harmonics]

    def _grid(self, contact: int, deflection: float) -> ContactGrid:
        return self.pressing.grid(contact, min(WIDER * deflection, self.largest_deflection))

    def free(self, harmonics: int, contact: int, deflection: float) -> DeflectedState:
        """The tyre without contact, on a grid of ``contact`` harmonics for deflections up to the given one, m."""
        grid = self._grid(contact, deflection)
        motion = np.zeros((harmonics + 1, self.pressing.harmonics.elements.n_dofs))
        return DeflectedState(0.0, motion, grid, np.zeros(len(grid.areas)))

    def refined(self, moment: DeflectedState, harmonics: int, contact: int) -> DeflectedState:
        """The same motion and pressure with other numbers of harmonics of motion and contact."""
        old, grid = moment.grid, self._grid(contact, moment.deflection)
        if moment.harmonics == harmonics and old is grid:
            return moment

        def padded(motion: Array) -> Array:
            fitted = np.zeros((harmonics + 1, motion.shape[1]))
            count = min(len(fitted), len(motion))
            fitted[:count] = motion[:count]
            return fitted

        def spread(forces: Array) -> Array:
            per_area = (forces / (np.repeat(old.sides, len(old.tread.nodes)) * old.areas)).reshape(old.n_angles, -1)
            pressure = [np.interp(grid.angles, old.angles, values, right=0.0) for values in per_area.T]
            return np.asarray(
                np.stack(pressure, axis=1).ravel() * np.repeat(grid.sides, len(grid.tread.nodes)) * grid.areas
            )

        rate = None if moment.rate is None else (padded(moment.rate[0]), spread(moment.rate[1]), moment.rate[2])
        return replace(moment, motion=padded(moment.motion), grid=grid, forces=spread(moment.forces), rate=rate)

    def balance(
        self,
        start: DeflectedState,
        deflection: float,
        tolerance: float,
        load: float | None = None,
        kept: Imbalance | None = None,
    ) -> DeflectedState | None:
        """The balance at a deflection, m, or from there under a load, N; None without convergence.

        If the first step would move the tyre too far, the balance of a smaller deflection is solved instead.

        Parameters
        ----------
        start : a nearby balance. tolerance : last relative change of the motion, and of the load.
        kept : what it left, if it is of a tyre with another stiffness, and stays unbalanced.
        """
        search = _BalanceSearch(self, start, deflection, tolerance, kept)
        for _ in range(STEPS):
            if not search.advance() or (load is not None and not search.carry(load)):
                return None
            if search.settled:
                return search.balance
        return None

    def _rotations(self, outside: NonlinearForces, motion: Array) -> Rotations:
        """Rotations of a motion, in single precision: they only lead a search."""
        return Rotations.of(outside.round.within(np.float32), motion, self.factors.harmonics.held)

    def _road(self, moment: DeflectedState) -> tuple[Array, Array, Touching, Array]:
        """Gaps, m, their decrease per metre of deflection, the points of possible contact, and the tread's displacement
        (c, k), m."""
        pressing, grid = self.pressing, moment.grid
        distance = pressing.reach - moment.deflection
        displacements = grid.displacements(moment.motion)
        gaps, normals = pressing.gaps(grid, displacements, distance)
        if moment.forces.any():
            blocks = grid.blocks_above(moment.harmonics)
            pushed = grid.along(normals) * moment.forces
            displacements = displacements - np.einsum("akbl,bl->ak", blocks, pushed, optimize=True)
            gaps, normals = pressing.gaps(grid, displacements, distance)
        return gaps, pressing.road.normal @ normals, self._points(grid, grid.along(normals), moment), displacements

    def _points(self, grid: ContactGrid, direction: Array, moment: DeflectedState) -> Touching:
        """Points of possible contact; those of the last call, if they are the same (on a flat road)."""
        last = self._touching[0] if self._touching else None
        if last is None or last.grid is not grid or last.highest != moment.harmonics:
            last = Touching(self.factors, grid, direction, moment.harmonics)
        elif not np.allclose(last.direction, direction, rtol=0, atol=1e-12):
            last = last.turned(direction)
        self._touching[:] = [last]
        return last

    def _rate(
        self,
        touching: Touching,
        closed: Flags,
        tangent: Tangent,
        normal_components: Array,
        accuracy: float,
        rotations: Rotations,
        start: NewtonStep | None = None,
    ) -> NewtonStep:
        """Motion and forces per metre of deflection with a constant contact set; ``accuracy`` of its energy."""
        tangent = replace(tangent, forces=np.zeros_like(tangent.forces))
        return newton_step(touching, closed, tangent, -normal_components, SearchEnd(settled=accuracy), rotations, start)

    def footprint(self, moment: DeflectedState) -> Footprint:
        """The footprint of a balance, without its `stiffness`."""
        gaps, _, touching, displacements = self._road(moment)
        return Footprint(
            self.pressing, moment.grid, moment.deflection, moment.load, 0.0, moment.forces, touching.direction,
            displacements, gaps, balanced=moment.motion, rate=moment.rate,
        )  # fmt: skip

    def stiffness(self, moment: DeflectedState, accuracy: float = STIFFNESS) -> float:
        """d load / d deflection of a balance, N/m, with a constant contact set: the energy of the rate of motion, to
        ``accuracy``.

        Elements that fold at the balance have no positive stiffness, and the search for the rate no end: they take part
        with a convex one, if need be all elements. nan: it has no end even so.
        """
        _, normal_components, touching, _ = self._road(moment)
        outside = self.nonlinear(moment.harmonics)
        tangent = outside.at(moment.motion, np.float32)
        rotations = self._rotations(outside, moment.motion)
        start = None
        if moment.rate is not None:
            motion, forces, _ = moment.rate
            start = NewtonStep(motion, np.where(moment.forces > 0, forces, 0.0), 0, np.zeros_like(motion))
        closed = moment.forces > 0
        rate = self._rate(touching, closed, tangent, normal_components, accuracy, rotations, start)
        if rate.unstable is not None:
            self._folding.add(tangent, rate.unstable)
            exact, everywhere = tangent, np.ones(tangent.energies(rate.unstable).shape, dtype=bool)
            tangent = self._folding.convex(exact)
            rate = self._rate(touching, closed, tangent, normal_components, accuracy, rotations, start)
            if not rate.stable:
                tangent = exact.convex(everywhere)
                rate = self._rate(touching, closed, tangent, normal_components, accuracy, rotations, start)
            if not rate.stable:
                return math.nan
        energy = np.pi * self.factors.work(tangent.product(rate.motion), rate.motion)
        return self._sides * float(energy + rate.forces @ touching.tail @ rate.forces)


class _BalanceSearch:
    """Newton steps from a nearby balance ``start`` to one at a deflection, m, or from there under a load.

    ``moment``: the state so far. ``settled``: whether it is a balance. ``change``: of a displacement gradient in the
    latest step. ``last``, ``last_before``: relative changes of the motion in the latest two steps.
    """

    tangent: Tangent
    touching: Touching
    rotations: Rotations
    step: NewtonStep

    def __init__(
        self,
        tyre: LargeMotion,
        start: DeflectedState,
        deflection: float,
        tolerance: float,
        kept: Imbalance | None,
    ) -> None:
        self.tyre, self.start, self.tolerance, self.kept = tyre, start, tolerance, kept
        self.moved = deflection - start.deflection
        self.moment = replace(start, deflection=deflection)
        self.outside = tyre.nonlinear(start.harmonics)
        self.damping = DAMPING if self.moved else REFINING
        self.steps = self.unstable = 0
        self.change = self.last = self.last_before = np.inf
        self.convex = self.whole = self.settled = False
        #: Contact sets of the next step and of the latest one; gaps, m, and what a step's motion has to close of them;
        #: their decrease per metre of deflection.
        self.closed: Flags = np.zeros(0, dtype=bool)
        self.before = self.closed
        self.gaps = self.distance = self.normal_components = np.zeros(0)
        self.end = SearchEnd()

    @property
    def balance(self) -> DeflectedState:
        """The state so far; contact only presses."""
        return replace(self.moment, forces=np.maximum(self.moment.forces, 0.0))

    def advance(self) -> bool:
        """A Newton step at the deflection, damped until it is stable; False: it stays unstable.

        If the first step would move the tyre too far, the deflection becomes a smaller one.
        """
        self._linearise()
        self._solve()
        if not self.steps and self.change > LARGE_STEP * AHEAD and self.moved:
            self._deflect_less()
            self._solve()
        while not (self.step.stable and self.change < WILD):
            self.unstable += 1
            if self.unstable > UNSTABLE:
                return False
            self._stiffen()
            self._solve()
        self._take()
        return True

    def carry(self, load: float) -> bool:
        """Move along the rate of motion towards a load, N; False: the load does not rise with the deflection."""
        moment, tolerance = self.moment, self.tolerance
        motion, forces, slope = self._rate()
        if not slope > 0:
            return False
        now = moment.load
        missed = abs(load - now) / load
        # A contact that opens and closes in turn keeps the load from settling.
        still = self.steps == STEPS or max(self.last, self.last_before) <= STILL * tolerance
        self.settled &= missed <= tolerance
        self.settled |= still and self.whole and max(self.last, missed) <= CYCLE * tolerance
        if not self.settled:  # forces that the search leaves unbalanced do work on the rate: the load without them
            now -= self.tyre._sides * np.pi * self.tyre.factors.work(self.step.residual, motion)
        more = (load - now) / slope
        far = abs(more) * self._gradient_change(motion)
        if far > AHEAD:
            self.settled, more = False, more * AHEAD / far
        self.moment = replace(
            moment, deflection=moment.deflection + more, motion=moment.motion + more * motion,
            forces=moment.forces + more * np.where(self.before, forces, 0.0), load=now + more * slope,
            rate=(motion, forces, slope),
        )  # fmt: skip
        return True

    def _linearise(self) -> None:
        """Forces, stiffness and contact at the state; a stiffness nearly the same is used again."""
        tyre, moment = self.tyre, self.moment
        if self.steps and self.change <= ALIKE and not self.convex:
            self.tangent = replace(self.tangent, forces=self.outside.forces(moment.motion))
        else:
            self.tangent = self.outside.at(moment.motion, np.float32)
            self.convex = bool(tyre._folding) and self.change > CONVEX
            if self.convex:
                self.tangent = tyre._folding.convex(self.tangent)
        self.gaps, self.normal_components, self.touching, _ = tyre._road(moment)
        work = tyre.factors.work(self.tangent.forces, moment.motion)
        if self.kept is not None:
            self.tangent = replace(self.tangent, forces=self.tangent.forces - self.kept.forces)
            self.gaps = self.gaps - self.kept.gaps_at(moment.grid.n_angles)
        self.distance = self.gaps - self.touching.tail @ moment.forces
        self.rotations = tyre._rotations(self.outside, moment.motion)
        self.end = SearchEnd(INNER if self.kept is None else INNER_CHANGE, (ENERGY * self.tolerance) ** 2 * work)
        if not self.steps:
            self.closed = self.touching.closed(self.gaps, moment.forces, moment.forces > 0)

    def _solve(self) -> None:
        """The Newton step, and its change of a gradient."""
        start = None
        if self.kept is not None:  # a small change of these forces
            motion = np.zeros_like(self.moment.motion)
            start = NewtonStep(motion, self.moment.forces, 0, motion)
        self.step = newton_step(
            self.touching, self.closed, self.tangent, self.distance, self.end, self.rotations, start, self.damping
        )
        self.change = self._gradient_change(self.step.motion)

    def _gradient_change(self, motion: Array) -> float:
        """Largest change of a displacement gradient by a motion."""
        return float(np.abs(self.outside.round.within(np.float32).gradient(motion)).max())

    def _deflect_less(self) -> None:
        """Take the deflection at which a gradient changes by `AHEAD`."""
        moment, share = self.moment, AHEAD / self.change
        back = self.normal_components * (1 - share) * self.moved
        self.moment = replace(moment, deflection=self.start.deflection + share * self.moved)
        self.gaps, self.distance = self.gaps + back, self.distance + back
        self.closed = self.touching.closed(self.gaps, moment.forces, moment.forces > 0)

    def _stiffen(self) -> None:
        """After an unstable step: elements that fold in it become convex, or else the damping grows."""
        folding, direction = self.tyre._folding, self.step.unstable
        new = direction is not None and folding.add(self.tangent, direction)
        if new or (folding and not self.convex):
            self.tangent, self.convex = folding.convex(self.tangent), True
        else:
            self.damping *= 3

    def _take(self) -> None:
        """Move by the step, at most by `CORRECTION`; then see whether the tyre has settled at this deflection."""
        moment, step, touching, tolerance = self.moment, self.step, self.touching, self.tolerance
        share = min(1.0, CORRECTION / max(self.change, 1e-300))
        after = self.gaps - touching.into(step.motion) + touching.tail @ (step.forces - moment.forces)
        motion, forces = moment.motion + share * step.motion, moment.forces + share * (step.forces - moment.forces)
        self.before, self.closed = self.closed, touching.closed(after, step.forces, self.closed)
        load = self.tyre._sides * float(self.normal_components @ forces)
        if self.kept is not None:
            load += self.kept.load
        self.last_before = self.last
        self.last = share * float(np.abs(step.motion).max()) / max(float(np.abs(motion).max()), 1e-300)
        self.steps, self.whole = self.steps + 1, share == 1
        flipped = FLIPPED[0] if tolerance > LOOSE else FLIPPED[1]
        self.settled = (
            self.last <= (tolerance if tolerance <= LOOSE else NEXT * tolerance)
            and self.whole
            and self.damping < 2 * DAMPING  # a damped step is short also far from balance
            and abs(load - moment.load) <= LOAD_CHANGE * tolerance * abs(load)
            and self.change <= LAST
            and int((self.closed != self.before).sum()) <= max(1.0, flipped * int(self.closed.sum()))
        )
        self.damping = max(self.damping / 3, DAMPING if self.change > SMOOTH else LEAST_DAMPING)
        self.moment = replace(moment, motion=motion, forces=forces, load=load)

    def _rate(self) -> tuple[Array, Array, float]:
        """Motion, forces and load per metre of deflection, with the contact set of the latest step; computed once."""
        if self.moment.rate is not None:
            return self.moment.rate
        rate = self.tyre._rate(self.touching, self.before, self.tangent, self.normal_components, BORDER, self.rotations)
        return rate.motion, rate.forces, self.tyre._sides * float(self.normal_components @ rate.forces)
