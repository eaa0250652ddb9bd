"""A tyre rolled step by step in time from rest: nodes turn with the rubber, meet the road, stick, slip and leave."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.mechanics.rolling.wheel_of_hexahedra import WheelOfHexahedra

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
#: Largest relative residual of a step; Newton steps before the search gives up; halvings of a step.
ACCURACY, ROUNDS, HALVINGS = 1e-8, 60, 4


@dataclass(frozen=True, eq=False)
class StepResult:
    """Nodes near the road at the end of a step.

    Parameters
    ----------
    turned : angle of the wheel since it stood, rad. first : level of the first node of the window.
    forces : (k, 3) of the road on the nodes: away from it, forward, left, N. places : (k, 2) forward and left, m.
    heights : (k,) of the wheel's centre above the nodes, m. power : that friction turned into heat in the step, W for
        a travelling speed of 1 m/s.
    """

    turned: float
    first: int
    forces: Array
    places: Array
    heights: Array
    power: float

    @property
    def values(self) -> Array:
        """(6,) F_x, F_y, F_z, M_z, torque of the axle, friction power at 1 m/s; SI, ISO 8855."""
        (up, forward, left), (x, y) = self.forces.T, self.places.T
        torque = (forward * self.heights + up * x).sum()
        return np.array([forward.sum(), left.sum(), up.sum(), (x * left - y * forward).sum(), torque, self.power])


@dataclass(frozen=True, eq=False)
class RollingInSteps:
    """A wheel pressed on a flat road at a given deflection, then rolled from rest with Coulomb friction.

    In every step the wheel turns by an angle. Nodes that touch at its end have moved over the road by

        w = (x - x_before) - road,

    x their place in the axes of the road, with their displacement. w = 0 where they stick, |t| = mu N against w where
    they slip (backward Euler). A node that lands in a step begins without shear. There is no steady state, no upstream
    point, no harmonic: material nodes carry their history. Small motion about the inflated tyre, no inertia.

    Parameters
    ----------
    deflection : m. travel : m that the wheel travels per radian of its turn. slip_angle : rad. friction : coefficient.
    substeps : steps in which the wheel turns by a level of nodes. window : angle on each side that may touch, rad.
    """

    wheel: WheelOfHexahedra
    deflection: float
    travel: float
    slip_angle: float
    friction: float
    substeps: int = 4
    window: float = 0.4

    def __post_init__(self) -> None:
        if self.substeps < 1:
            raise InputError(f"must be 1 or more, not {self.substeps}", field="substeps")
        if not 0 < self.window < math.pi / 2:
            raise InputError(f"must be between 0 and pi/2, not {self.window:g} rad", field="window")

    @property
    def step(self) -> float:
        """Angle of a step, rad."""
        return self.wheel.level / self.substeps

    @property
    def levels(self) -> int:
        """Number of levels in the window."""
        return 2 * math.ceil(self.window / self.wheel.level) + 1

    @functools.cached_property
    def _compliance(self) -> tuple[Array, Array]:
        """(3 k, 3 k) of windows that begin on a corner and on a middle."""
        size = 3 * self.levels * len(self.wheel.tread)
        corner, middle = (self.wheel.compliance(k, self.levels).reshape(size, size) for k in range(2))
        return corner, middle

    @functools.cached_property
    def _distance(self) -> float:
        """Of the wheel's centre from the road, m."""
        return float(self.wheel.places[0].max()) - self.deflection

    def run(self, turns: float) -> list[StepResult]:
        """The wheel at rest, without shear, then every step until it has turned by 2 pi ``turns``."""
        state = self._end(0, None)
        states = [state]
        for number in range(1, math.ceil(2 * math.pi * turns / self.step) + 1):
            state = self._end(number, state)
            states.append(state)
        return states

    def steady(self, states: list[StepResult]) -> tuple[Array, float]:
        """(6,) mean `StepResult.values` while the last sector passed; the largest change of a force from the sector
        before, over F_z. A sector is the period of what the mesh does to the forces."""
        pitch = 2 * self.substeps
        values = np.array([state.values for state in states[-2 * pitch :]]).reshape(2, pitch, -1).mean(axis=1)
        return values[1], float(np.abs(values[1] - values[0])[:3].max() / values[1, 2])

    def _end(self, number: int, before: StepResult | None) -> StepResult:
        """The state at the end of a step; ``before``: at its beginning."""
        turned = number * self.step
        first = number // self.substeps - self.levels // 2
        r, z = self.wheel.places
        m = len(r)
        angles = np.repeat((first + np.arange(self.levels)) * self.wheel.level - turned, m)
        radii, left = np.tile(r, self.levels), np.tile(z, self.levels)
        sin, cos = np.sin(angles), np.cos(angles)
        zero = np.zeros_like(sin)
        # Rows: away from the road, forward, left; columns: along r, z, t.
        axes = np.stack([np.stack([-cos, zero, sin], -1), np.stack([sin, zero, cos], -1),
                         np.stack([zero, zero + 1, zero], -1)], axis=1)  # fmt: skip
        free = np.stack([self._distance - radii * cos, radii * sin, left], axis=1)
        closed, came, forces = np.zeros(len(sin), dtype=bool), np.zeros((len(sin), 2)), np.zeros((len(sin), 3))
        if before is not None:
            shift = (first - before.first) * m
            kept = slice(shift, None) if shift else slice(None)
            count = len(sin) - shift
            forces[:count], came[:count] = before.forces[kept], before.places[kept]
            closed = forces[:, 0] > 0
        path = self.travel * self.step * np.array([-math.cos(self.slip_angle), -math.sin(self.slip_angle)])
        contact = _Step(self._compliance[first % 2], axes, free, came + path, closed, self.friction)
        now, ways = contact.solve(forces)
        places, gaps = contact.places(now)
        power = -float(((now[:, 1:] + forces[:, 1:]) / 2 * ways)[closed].sum()) / (self.travel * self.step)
        return StepResult(turned, first, now, places, self._distance - gaps, power)


@dataclass(frozen=True, eq=False)
class _Step:
    """Contact at the end of a step. ``stuck`` : (k, 2) where the nodes are that stick; ``closed`` : touched before."""

    compliance: Array
    axes: Array
    free: Array
    stuck: Array
    closed: Flags
    friction: float

    def _moved(self, forces: Array) -> Array:
        """(k, 3) free places with the displacement under forces."""
        loaded = np.flatnonzero(forces.any(axis=1))
        turned = np.einsum("kax,ka->kx", self.axes[loaded], forces[loaded])
        columns = (3 * loaded[:, None] + np.arange(3)).ravel()
        moved = (self.compliance[:, columns] @ turned.ravel()).reshape(-1, 3)
        return np.asarray(self.free + np.einsum("kax,kx->ka", self.axes, moved))

    def places(self, forces: Array) -> tuple[Array, Array]:
        """(k, 2) forward and left, and (k,) gaps, m."""
        moved = self._moved(forces)
        return moved[:, 1:], moved[:, 0]

    @functools.cached_property
    def _stiffness(self) -> float:
        """About that of a node, N/m: it leads the search only."""
        return float(1 / np.diag(self.compliance).mean())

    def _residual(self, forces: Array) -> tuple[Array, Flags, Flags, Array]:
        """(k, 3) forces less those that the road would give, flags of touching and slipping nodes, slips (k, 2)."""
        moved = self._moved(forces)
        normal = forces[:, 0] - self._stiffness * moved[:, 0]
        slips = np.where(self.closed[:, None], moved[:, 1:] - self.stuck, 0.0)
        touches = normal > 0
        pull = forces[:, 1:] - self._stiffness * slips
        length = np.hypot(*pull.T)
        limit = self.friction * np.maximum(normal, 0)
        sliding = touches & self.closed & (length > limit)
        road = np.zeros_like(forces)
        road[touches, 0] = normal[touches]
        held = touches & self.closed
        share = np.minimum(1.0, limit / np.maximum(length, 1e-300))
        road[held, 1:] = share[held, None] * pull[held]
        return forces - road, touches, sliding, np.asarray(slips)

    def solve(self, forces: Array) -> tuple[Array, Array]:
        """Forces (k, 3) and slips (k, 2) of the step, by Newton's method from similar forces."""
        residual, touches, sliding, slips = self._residual(forces)
        for _ in range(ROUNDS):
            size = float(np.linalg.norm(residual))
            if size <= ACCURACY * max(float(np.linalg.norm(forces)), 1.0):
                return forces, slips
            wanted = self._newton(forces, touches, sliding)
            share = 1.0
            for _ in range(HALVINGS):
                trial = forces + share * (wanted - forces)
                new = self._residual(trial)
                if np.linalg.norm(new[0]) < size:
                    break
                share /= 2
            else:
                trial = wanted
                new = self._residual(trial)
            forces, (residual, touches, sliding, slips) = trial, new
        raise InputError("a step of the rolling contact does not settle: take smaller steps")

    def _newton(self, forces: Array, touches: Flags, sliding: Flags) -> Array:
        """The forces that the linearised conditions give."""
        wanted = np.where(touches[:, None], forces, 0.0)
        moved = self._moved(wanted)
        at = np.flatnonzero(touches)
        count, stiffness = len(at), self._stiffness
        columns = (3 * at[:, None] + np.arange(3)).ravel()
        block = self.compliance[np.ix_(columns, columns)].reshape(count, 3, count, 3)
        turned = np.einsum("iax,ixjy->iajy", self.axes[at], block, optimize=True)
        compliance = np.einsum("iajy,jby->iajb", turned, self.axes[at], optimize=True)
        matrix, target = compliance.copy(), np.zeros((count, 3))
        target[:, 0] = -moved[at, 0]
        target[:, 1:] = (self.stuck - moved[:, 1:])[at]
        lands = np.flatnonzero(~self.closed[at])
        matrix[lands, 1:] = 0.0
        for component in (1, 2):
            matrix[lands, component, lands, component] = 1.0
        target[lands, 1:] = -forces[at[lands], 1:]
        slides = np.flatnonzero(sliding[at])
        nodes = at[slides]
        pull = forces[nodes, 1:] - stiffness * (moved[nodes, 1:] - self.stuck[nodes])
        length = np.hypot(*pull.T)
        along = pull / length[:, None]
        normal = np.maximum(forces[nodes, 0] - stiffness * moved[nodes, 0], 0.0)
        # t = mu n pull/|pull|, n the normal force that the road would give.
        across = np.eye(2) - along[:, :, None] * along[:, None, :]
        turning = (self.friction * normal / length)[:, None, None] * across
        rows = np.einsum("kab,kbjc->kajc", turning, compliance[slides, 1:])
        rows += self.friction * along[:, :, None, None] * compliance[slides, None, 0]
        matrix[slides, 1:] = stiffness * rows
        matrix[slides, 1:, slides, 1:] += np.eye(2) - turning
        matrix[slides, 1:, slides, 0] -= self.friction * along
        target[slides, 1:] = self.friction * normal[:, None] * along - forces[nodes, 1:]
        step = np.linalg.solve(matrix.reshape(3 * count, 3 * count), target.ravel())
        wanted[at] += step.reshape(count, 3)
        return wanted
