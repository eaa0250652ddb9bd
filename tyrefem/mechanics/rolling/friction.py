"""Rolling contact with Coulomb friction: which points are open, stick and slip, and their forces, exactly."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.mechanics.rolling.contact_body import COMPONENTS, ContactBody

Array = NDArray[np.float64]
States = NDArray[np.int8]
#: States of a point.
OPEN, STICK, SLIP = 0, 1, 2
#: Largest residual over the largest force (or over that force times the compliance of its point) of an exact contact.
ACCURACY = 1e-9
#: Newton steps before the search gives up, and halvings of a step that makes the residual larger.
STEPS, HALVINGS = 120, 5


@dataclass(frozen=True, eq=False)
class Control:
    """A number that is sought together with the forces, so that a sum of the forces has a given value.

    The sum is f . (arms + levers u) over all points, u the displacement of the point. Deflection for a load, travel per
    step for a torque are such numbers.

    Parameters
    ----------
    gaps : (k,) change of the gaps per unit of the number. slips : (k, 2) change of the slip of a step per unit.
    arms : (k, 3). levers : (k, 3, 3); None: zero.
    target : value of the sum.
    """

    gaps: Array
    slips: Array
    arms: Array
    target: float
    levers: Array | None = None

    def sum(self, forces: Array, displacement: Array) -> float:
        """The sum for forces and displacements (k, 3)."""
        arms = self.arms
        if self.levers is not None:
            arms = arms + np.einsum("kab,kb->ka", self.levers, displacement)
        return float((forces * arms).sum())

    def slope(self, forces: Array, displacement: Array, loaded: NDArray[np.int64], block: Array) -> Array:
        """(l, 3) derivative of the sum by the forces of the ``loaded`` points, which alone have forces.

        ``block``: (l, 3, l, 3) compliance between them.
        """
        if self.levers is None or not len(loaded):
            return np.asarray(self.arms[loaded])
        slope = self.arms[loaded] + np.einsum("kab,kb->ka", self.levers[loaded], displacement[loaded])
        pulled = np.einsum("kab,ka->kb", self.levers[loaded], forces[loaded])
        size = len(loaded) * COMPONENTS
        return np.asarray(slope + (pulled.ravel() @ block.reshape(size, size)).reshape(-1, COMPONENTS))


@dataclass(frozen=True, eq=False)
class FrictionForces:
    """Forces of a rolling contact. Made by `RollingContact.solve`.

    Parameters
    ----------
    forces : (k, 3) of the road on the body: away from the road, along it, to the left, N.
    displacement : (k, 3), m. gaps : (k,), m. ways : (k, 2) motion of a step relative to the road, m; slips : (k, 2) of
        the share of the step in which the point touched.
    states : (k,) `OPEN`, `STICK`, `SLIP`.
    controls : values of the controls. steps : number of Newton steps.
    """

    forces: Array
    displacement: Array
    gaps: Array
    ways: Array
    slips: Array
    states: States
    controls: tuple[float, ...]
    steps: int


@dataclass(frozen=True, eq=False)
class RollingContact:
    """Forces N, t of a body that rolls steadily, with Coulomb friction:

    N >= 0, gap >= 0, N gap = 0;   |t| <= mu N;   w = 0 where |t| < mu N;   t = -mu N w/|w| where it slips,

    w the slip in a step: the point's displacement since its material was upstream, plus the rigid slip. The conditions
    are two equations without inequality, for any positive numbers a and b:

    N = max(0, N - gap/a),   t = projection of t - w/b on the disc of radius mu N.

    Newton's method on these ends at the exact answer; a and b only lead the search.

    Parameters
    ----------
    body : compliance and way of the material.
    gaps : (k,) without forces, m. slips : (k, 2) rigid slip of a step, m.
    friction : (k,) coefficient mu. controls : numbers sought with the forces.
    scale : a and b over the compliance of each point itself. accuracy : residual at which the search ends.

    Raises
    ------
    InputError : no contact with these forces exists.
    """

    body: ContactBody
    gaps: Array
    slips: Array
    friction: Array
    controls: Sequence[Control] = ()
    scale: float = 1.0
    accuracy: float = ACCURACY

    @functools.cached_property
    def _stiffness(self) -> tuple[Array, Array]:
        """1/a and 1/b, (k,), N/m."""
        at = self.body.local
        return 1 / (self.scale * at[:, 0, 0]), 2 / (self.scale * (at[:, 1, 1] + at[:, 2, 2]))

    def solve(self, start: FrictionForces | None = None, values: Sequence[float] | None = None) -> FrictionForces:
        """The contact; ``start``: a similar one; ``values``: first guess of the controls.

        Raises
        ------
        InputError : Newton's method does not end: a load or a force that the contact cannot carry.
        """
        size = self.body.n_points
        forces = np.zeros((size, COMPONENTS)) if start is None else start.forces.copy()
        numbers = np.array(values if values is not None else start.controls if start else [], dtype=float)
        now = _State(self, forces, numbers)
        for step in range(STEPS):
            if now.exact:
                return FrictionForces(
                    now.forces,
                    now.displacement,
                    now.gaps,
                    now.ways,
                    now.slips,
                    now.states,
                    tuple(map(float, now.numbers)),
                    step,
                )
            now = self._stepped(now)
        raise InputError(f"the contact does not settle in {STEPS} steps: residual {now.size:.2g}")

    def _stepped(self, now: _State) -> _State:
        moved_forces, moved_numbers = now.newton()
        share, best = 1.0, None
        for _ in range(HALVINGS):
            trial = _State(
                self,
                now.forces + share * (moved_forces - now.forces),
                now.numbers + share * (moved_numbers - now.numbers),
            )
            if trial.size < now.size:
                return trial
            if best is None or trial.size < best.size:
                best = trial
            share /= 2
        assert best is not None
        return best


@dataclass(frozen=True, eq=False)
class _State:
    """Forces and controls on the way to the contact, with residuals."""

    contact: RollingContact
    forces: Array
    numbers: Array

    @functools.cached_property
    def displacement(self) -> Array:
        return self.contact.body.displacement(self.forces)

    @functools.cached_property
    def gaps(self) -> Array:
        gaps = self.contact.gaps + self.displacement[:, 0]
        for control, number in zip(self.contact.controls, self.numbers, strict=True):
            gaps = gaps + number * control.gaps
        return np.asarray(gaps)

    @functools.cached_property
    def ways(self) -> Array:
        ways = self.contact.slips + self.contact.body.change(self.displacement)
        for control, number in zip(self.contact.controls, self.numbers, strict=True):
            ways = ways + number * control.slips
        return np.asarray(ways)

    @functools.cached_property
    def slips(self) -> Array:
        return self.contact.body.touching(self.ways)

    @functools.cached_property
    def predicted(self) -> Array:
        """(k,) N - gap/a."""
        normal, _ = self.contact._stiffness
        predicted = self.forces[:, 0] - normal * self.gaps
        predicted[~self.contact.body.may_touch] = 0.0
        return np.asarray(predicted)

    @functools.cached_property
    def pull(self) -> Array:
        """(k, 2) t - w/b."""
        _, tangential = self.contact._stiffness
        return np.asarray(self.forces[:, 1:] - tangential[:, None] * self.slips)

    @functools.cached_property
    def states(self) -> States:
        limit = self.contact.friction * np.maximum(self.predicted, 0.0)
        slips = np.hypot(*self.pull.T) > limit
        touches = self.predicted > 0
        if not touches.any():
            # A start too far from the road: the points that have a force close.
            touches, slips = self.contact.body.may_touch & (self.forces[:, 0] > 0), np.zeros_like(slips)
        return np.where(touches, np.where(slips, SLIP, STICK), OPEN).astype(np.int8)

    @functools.cached_property
    def residuals(self) -> tuple[Array, Array]:
        """(k, 3) in N, and of each control in its own unit."""
        normal = np.maximum(self.predicted, 0.0)
        limit = self.contact.friction * np.maximum(self.forces[:, 0], 0.0)
        length = np.hypot(*self.pull.T)
        share = np.minimum(1.0, limit / np.maximum(length, 1e-300))
        wanted = np.concatenate([normal[:, None], share[:, None] * self.pull], axis=1)
        wanted[self.states == OPEN] = 0.0
        sums = [control.sum(self.forces, self.displacement) - control.target for control in self.contact.controls]
        return self.forces - wanted, np.array(sums)

    @functools.cached_property
    def size(self) -> float:
        """Norm of the residuals over the forces, that of the controls over their arms."""
        forces, sums = self.residuals
        largest = max(float(np.linalg.norm(self.forces)), 1e-12)
        total = float((forces**2).sum())
        for control, left in zip(self.contact.controls, sums, strict=True):
            total += float(left / max(np.linalg.norm(control.arms) / np.sqrt(len(control.arms)), 1e-300)) ** 2
        return float(np.sqrt(total)) / largest

    @functools.cached_property
    def exact(self) -> bool:
        return self.size < self.contact.accuracy

    def newton(self) -> tuple[Array, Array]:
        """Forces and controls after a full step of Newton's method.

        In contact the gap closes. A point that sticks has w = 0. One that slips, with d = pull/|pull|, has

        t - mu N d - beta P (change of the pull) = 0,   beta = mu N/|pull|,   P = 1 - e d',   e = t/max(mu N, |t|):

        at the answer e = d; on the way e keeps the matrix regular (Hueeber, Stadler and Wohlmuth 2008).
        """
        contact, body = self.contact, self.contact.body
        index = np.flatnonzero(self.states != OPEN)
        count, many = len(index), len(contact.controls)
        size = COMPONENTS * count
        matrix, right = np.zeros((size + many, size + many)), np.zeros(size + many)
        normal, tangential = (stiffness[index] for stiffness in contact._stiffness)
        turning, along, friction = self._turning(index)
        loaded = np.flatnonzero((self.states != OPEN) | np.any(self.forces != 0, axis=1))
        compliance = body.block(loaded, loaded)
        touching = np.searchsorted(loaded, index)
        to_touching = compliance if count == len(loaded) else compliance[:, :, touching]
        rows = np.empty((count, COMPONENTS, size))
        rows[:, 0] = normal[:, None] * to_touching[touching, 0].reshape(count, size)
        change = body.slip_block(index, loaded, to_touching).reshape(count, 2, size)
        turned = tangential[:, None, None] * turning
        rows[:, 1:] = turned @ change
        block, here = rows.reshape(count, COMPONENTS, count, COMPONENTS), np.arange(count)
        slipping = (self.states[index] == SLIP)[:, None, None]
        block[here, 1:, here, 1:] += np.where(slipping, np.eye(2) - turning, 0.0)
        block[here, 1:, here, 0] -= friction[:, None] * along
        matrix[:size, :size] = rows.reshape(size, size)
        targets = np.empty((count, COMPONENTS))
        targets[:, 0] = -normal * contact.gaps[index]
        targets[:, 1:] = -np.einsum("kab,kb->ka", turned, body.touching(contact.slips)[index])
        targets[:, 1:] -= np.where(slipping[..., 0], np.einsum("kab,kb->ka", turning, self.pull[index]), 0.0)
        right[:size] = targets.ravel()
        for number, control in enumerate(contact.controls):
            column = matrix[:size, size + number].reshape(count, COMPONENTS)
            column[:, 0] = normal * control.gaps[index]
            column[:, 1:] = np.einsum("kab,kb->ka", turned, body.touching(control.slips)[index])
            slope = np.zeros_like(self.forces)
            slope[loaded] = control.slope(self.forces, self.displacement, loaded, compliance)
            matrix[size + number, :size] = slope[index].ravel()
            linear = float((slope * self.forces).sum())
            right[size + number] = control.target - control.sum(self.forces, self.displacement) + linear
        try:
            answer = np.linalg.solve(matrix, right)
        except np.linalg.LinAlgError:
            raise InputError("nothing holds the rolling contact: does the body touch the road?") from None
        forces = np.zeros_like(self.forces)
        forces[index] = answer[:size].reshape(count, COMPONENTS)
        return forces, np.asarray(answer[size:], dtype=float)

    def _turning(self, index: NDArray[np.int64]) -> tuple[Array, Array, Array]:
        """beta P (n, 2, 2), 1 where a point sticks; d (n, 2) and mu (n,), 0 where it sticks; of some points."""
        forces, pull = self.forces[index], self.pull[index]
        slipping = self.states[index] == SLIP
        friction = np.where(slipping, self.contact.friction[index], 0.0)
        length = np.maximum(np.hypot(*pull.T), 1e-300)
        along = pull / length[:, None]
        limit = friction * np.maximum(forces[:, 0], 0.0)
        beta = np.minimum(limit / length, 1.0)
        held = forces[:, 1:] / np.maximum(np.maximum(limit, np.hypot(*forces[:, 1:].T)), 1e-300)[:, None]
        turning = beta[:, None, None] * (np.eye(2) - held[:, :, None] * along[:, None, :])
        turning[~slipping] = np.eye(2)
        return turning, along, friction
