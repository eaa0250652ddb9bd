"""A rolling tyre: forces and moments, slip, friction power, and its maps over the footprint."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.cache import read_only
from tyrefem.mechanics.footprint.footprint import BEYOND
from tyrefem.mechanics.rolling.body_loss import BodyLoss
from tyrefem.mechanics.rolling.contact_patch import ContactPatch
from tyrefem.mechanics.rolling.friction import OPEN, SLIP, FrictionForces
from tyrefem.mechanics.rolling.rolling_grid import RollingGrid
from tyrefem.mechanics.rolling.rolling_motion import RollingMotion
from tyrefem.mechanics.rolling.section_fields import SectionFields, force_waves

Array = NDArray[np.float64]
#: The wheel's torque of a force f at a place p of (x forward, y down, z left) is f . (TORQUE p), N m.
TORQUE = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
#: A side force below this share of the load is the rounding of a tyre that has none.
ROUNDING = 1e-6


@dataclass(frozen=True, eq=False)
class RolledTyre(Brief):
    """A tyre in steady rolling. Made by `SteadyRolling.roll`.

    Forces and moments are those of the road on the tyre in ISO 8855 axes (x forward, y left, z up) at the contact
    centre, where the wheel's plane meets the road below the axle.

    Parameters
    ----------
    grid : points that may touch. motion : of the wheel. axes : (k, 3, 3) of each point, away from the road, along it,
        left. contact : forces, slips, states. friction : (k,) coefficient.
    deflection : m. travel : m the wheel travels per radian of its turn. reach : of the free tyre towards the road, m.
    """

    grid: RollingGrid
    motion: RollingMotion
    axes: Array
    contact: FrictionForces
    friction: Array
    deflection: float
    travel: float
    reach: float

    def _facts(self) -> Mapping[str, Any]:
        return {
            "F_x, F_y, F_z": f"{self.force[0]:.5g}, {self.force[1]:.5g}, {self.force[2]:.5g} N",
            "M_z": f"{self.moment[2]:.4g} N m",
            "torque": f"{self.torque:.4g} N m",
            "sliding": f"{100 * self.sliding_share:.3g} % of the load",
            "friction power": f"{self.friction_power:.4g} W",
        }

    @property
    def harmonics(self) -> int:
        """Highest harmonic."""
        return self.grid.harmonics

    @property
    def spin(self) -> float:
        """Speed of rotation, rad/s."""
        return self.motion.speed / self.travel

    @property
    def loaded_radius(self) -> float:
        """Distance of the wheel's centre from the road, m."""
        return self.reach - self.deflection

    @functools.cached_property
    def moved(self) -> Array:
        """(k, 3) displacement (x forward, y down, z left), m."""
        return np.asarray(np.einsum("kax,ka->kx", self.axes, self.contact.displacement))

    @functools.cached_property
    def vectors(self) -> Array:
        """(k, 3) forces (x forward, y down, z left), N."""
        return np.asarray(np.einsum("kax,ka->kx", self.axes, self.contact.forces))

    @functools.cached_property
    def places(self) -> Array:
        """(3, k) places of the points from the contact centre, m: x forward, y left, z up."""
        camber = self.grid.road.camber
        x, down, left = self.grid.road.in_road_axes((self.grid.free_places + self.moved).T)
        return np.stack([x, left + self.loaded_radius * math.tan(camber), self.loaded_radius - down])

    @functools.cached_property
    def _iso(self) -> Array:
        """(3, k) forces: x forward, y left, z up."""
        x, down, left = self.grid.road.in_road_axes(self.vectors.T)
        return np.stack([x, left, -down])

    @functools.cached_property
    def force(self) -> Array:
        """(3,) F_x, F_y, F_z, N."""
        return read_only(self._iso.sum(axis=1))

    @functools.cached_property
    def moment(self) -> Array:
        """(3,) overturning M_x, rolling M_y, aligning M_z, N m."""
        return read_only(np.cross(self.places.T, self._iso.T).sum(axis=0))

    @functools.cached_property
    def torque(self) -> float:
        """Torque of the axle on the wheel, N m; positive drives, negative brakes."""
        return float((self.vectors * ((self.grid.free_places + self.moved) @ TORQUE.T)).sum())

    @property
    def pneumatic_trail(self) -> float:
        """-M_z/F_y, m: how far behind the contact centre the side force acts; nan where there is none, but rounding."""
        _, side, load = self.force
        return float(-self.moment[2] / side) if abs(side) > ROUNDING * load else math.nan

    @functools.cached_property
    def patch(self) -> ContactPatch:
        """Size and pressure of the contact."""
        return ContactPatch.of(self.grid, self.pressure, float(self.force[2]))

    @property
    def sliding_share(self) -> float:
        """Share of the normal force that is on sliding points."""
        forces = self.contact.forces[:, 0]
        return float(forces[self.contact.states == SLIP].sum() / forces.sum())

    def _map(self, values: NDArray[Any]) -> NDArray[Any]:
        return values.reshape(len(self.grid.angles), -1, *values.shape[1:])

    @functools.cached_property
    def before(self) -> Array:
        """(k,) share of the last step before the material of a point touched, at the front of the contact.

        The front lies p_k/p_(k-1), at most 1, and `BEYOND` steps before the first point k with pressure, as the ends of
        a footprint do.
        """
        pressure = self.pressure
        ahead = np.zeros_like(pressure)
        ahead[:-1] = pressure[1:]
        behind = np.zeros_like(pressure)
        behind[1:] = pressure[:-1]
        first = (pressure > 0) & (ahead == 0)
        share = np.divide(pressure, np.maximum(behind, pressure), out=np.zeros_like(pressure), where=first)
        return np.where(first, np.maximum(1 - share - BEYOND, 0.0), 0.0).ravel()

    @property
    def pressure(self) -> Array:
        """(n_angles, m) contact pressure, Pa."""
        return self._map(self.contact.forces[:, 0] / self.grid.areas)

    @property
    def traction(self) -> Array:
        """(n_angles, m, 2) of the road on the tread, forward and to the left, Pa."""
        return self._map(self.contact.forces[:, 1:] / self.grid.areas[:, None])

    @property
    def sliding_velocity(self) -> Array:
        """(n_angles, m, 2) of the tread over the road, forward and to the left, m/s; zero at open points."""
        rate = self.spin / self.grid.step
        return self._map(np.where((self.contact.states == OPEN)[:, None], 0.0, rate * self.contact.slips))

    @property
    def sliding_speed(self) -> Array:
        """(n_angles, m) m/s."""
        return np.asarray(np.linalg.norm(self.sliding_velocity, axis=-1))

    @property
    def states(self) -> NDArray[np.int8]:
        """(n_angles, m) 0 open, 1 sticks, 2 slips."""
        return self._map(self.contact.states)

    @functools.cached_property
    def power_map(self) -> Array:
        """(n_angles, m) friction power, W: work of a step's mean force on the tread's motion relative to the road.

        At the ends of the contact a step is partly open. There the work on the changing gap corrects that on the slip:
        the elastic work of a revolution is zero only for their sum.
        """
        contact, upstream = self.contact, self.grid.upstream
        before = np.where((upstream >= 0)[:, None], contact.forces[upstream], 0.0)
        opened = np.where(upstream >= 0, contact.gaps - contact.gaps[upstream], 0.0)
        relative = np.column_stack([opened, contact.ways])
        work = -((contact.forces + before) / 2 * relative).sum(axis=1)
        return read_only(self._map(work * self.spin / self.grid.step))

    @property
    def power_by_ring(self) -> Array:
        """(m,) friction power of each point of the tread over the footprint, W."""
        return np.asarray(self.power_map.sum(axis=0))

    @property
    def friction_power(self) -> float:
        """Power that friction turns into heat, W."""
        return float(self.power_map.sum())

    @functools.cached_property
    def components(self) -> Array:
        """(n_angles, m, 3) forces along (r, z, t), N."""
        return np.asarray(np.einsum("jpx,jcx->jpc", self._map(self.vectors), self.grid.wheel_axes))

    @functools.cached_property
    def fields(self) -> SectionFields:
        """Small motion of the whole section under the contact forces."""
        return SectionFields.of(self.grid, self.components, self.deflection)

    @functools.cached_property
    def added_fields(self) -> SectionFields:
        """`fields`; beside a pressed shape, what they add to it: less the motion without loss under its forces, and
        with that of the loaded tyre."""
        shape, forces = self.grid.shape, self.grid.shape_forces
        if shape is None or forces is None:
            return self.fields
        pressed = np.moveaxis(forces, 1, 2)
        if shape.elastic is None:
            return self._beside(SectionFields.of(self.grid, self.components - pressed, self.deflection), 1.0)
        less = SectionFields.of(self.grid.under(shape.elastic), pressed)
        return replace(self.fields, less=self._beside(less, -1.0))

    def _beside(self, fields: SectionFields, sign: float) -> SectionFields:
        """Fields with ``sign`` times what the loaded tyre adds to the motion of the inflated one."""
        shape, forces = self.grid.shape, self.grid.shape_forces
        if shape is None or shape.loaded is None or forces is None or not shape.loaded.known:
            return fields
        loaded = shape.loaded
        n = np.arange(len(loaded.tyre.motion))
        sides = 1 if fields.antisymmetric is None else 2
        loads = np.zeros((sides, len(n), *fields.loads.shape[1:]), dtype=complex)
        motions = np.zeros((sides, *loaded.tyre.motion.shape), dtype=complex)
        points = self.grid.points_on_wheel()
        for family, taken, motion in loaded.section_motions(points, np.moveaxis(self.components, 2, 1) - forces):
            # An odd wave, (sin, sin, -cos), is an even one a quarter of it further.
            turn = sign * np.exp(1j * n * self.grid.turn) * (-1j if family.odd else 1)
            loads[int(family.antisymmetric)] += turn[:, None, None] * taken
            motions[int(family.antisymmetric)] += turn[:, None] * motion
        return fields.beside(tuple(loads), tuple(motions))

    @functools.cached_property
    def body_loss(self) -> BodyLoss:
        """Loss of the rubber; none where the stiffness has none."""
        return BodyLoss(self.grid.influence, force_waves(self.grid, self.components), self.fields)

    @property
    def loss_power(self) -> float:
        """Power that the rubber turns into heat, W."""
        return self.body_loss.energy * self.spin / (2 * np.pi)

    @property
    def lost_power(self) -> float:
        """Power of the axle, W: torque times spin, less what the road takes away: -F . velocity of the road."""
        x, _, left = self.grid.road.in_road_axes((self.grid.free_places + self.moved).T)
        road = self.motion.speed * self.motion.road_per_travel(x, left)
        taken = float((self.contact.forces[:, 1:] * road).sum())
        return self.torque * self.spin + taken

    @property
    def rolling_resistance(self) -> float:
        """Energy lost per metre travelled, N: power of the axle over speed, with that of friction."""
        return self.lost_power / self.motion.speed

    @property
    def balance(self) -> float:
        """What the axle puts in less what friction and rubber take out, over the latter."""
        taken = self.friction_power + self.loss_power
        return (self.lost_power - taken) / taken if taken else 0.0
