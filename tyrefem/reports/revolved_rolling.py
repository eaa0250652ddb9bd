"""The whole rolling tyre as a VTK file: deformed, with its energies and the friction of its contact."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.rolling.rolled_footprint import RolledFootprint
from tyrefem.mechanics.rolling.rolled_loss import strain_losses
from tyrefem.reports.revolved import FINE, RevolvedSection, wheel_angles

if TYPE_CHECKING:
    from tyrefem.mechanics.footprint.loss import RevolutionLoss
    from tyrefem.mechanics.footprint.strain_harmonics import StrainHarmonics
    from tyrefem.mechanics.rolling.roll import RolledStudy

Array = NDArray[Any]
#: A temperature, degC: one number, or a function of places (2, ...) in (r, z), m.
Temperature = float | Callable[[Array], Array]


@dataclass(frozen=True, eq=False)
class RevolvedRolling(RevolvedSection):
    """The whole rolling tyre as it stands in space: x forward, y to the left, z up from the contact centre, m.

    These are the axes of the forces and of ``contact.vtu``. Rubber runs through the picture: under the wheel's axis it
    moves backwards.

    Parameters
    ----------
    rolled : the rolling tyre. temperature : of the loss, and written if given; by default that of the study's regions,
        else the drive's initial one.
    """

    rolled: RolledStudy | None = None
    temperature: Temperature | None = None

    @classmethod
    def of(cls, rolled: RolledStudy, temperature: Temperature | None = None) -> RevolvedRolling:
        """Of a rolling tyre."""
        return cls(rolled.wheel.pressed, rolled=rolled, temperature=temperature)

    @property
    def _rolled(self) -> RolledStudy:
        assert self.rolled is not None
        return self.rolled

    @cached_property
    def _footprint(self) -> RolledFootprint:
        return RolledFootprint.of_rolled(self._rolled, 1.0)

    @cached_property
    def angles(self) -> Array:
        """(n,) from the lowest point, rad; with all angles of the contact."""
        grid = self._rolled.state.grid
        fine = grid.step / np.ceil(grid.step / FINE)
        return wheel_angles(float(np.abs(grid.angles).max()) + fine, fine)

    @cached_property
    def motions(self) -> tuple[Array, ...]:
        """Amplitudes of the rolling tyre."""
        return tuple(self._footprint.motion_of(side) for side in range(len(self._footprint.sides)))

    @cached_property
    def strains(self) -> tuple[StrainHarmonics, ...]:
        """Strains over a revolution."""
        return self._footprint.sides

    @cached_property
    def losses(self) -> tuple[RevolutionLoss, ...]:
        """Losses of the strains by the cards."""
        return strain_losses(self._rolled, self._warm, self._footprint)

    @cached_property
    def _warm(self) -> Array:
        """(n_elements, n_points) temperature, degC."""
        rings, study = self.pressed.tyre.body.rings, self.pressed.study
        if callable(self.temperature):
            places = rings.points.reshape(2, -1)
            return np.asarray(self.temperature(places), dtype=float).reshape(rings.weights.shape)
        warm = np.full(rings.weights.shape, study.card.drive.initial if self.temperature is None else self.temperature)
        if self.temperature is None:
            for region, degrees in (study.parts.temperatures or {}).items():
                if region in self.pressed.tyre.body.parts:
                    warm[np.asarray(self.pressed.tyre.body.mesh.subdomains[region])] = degrees
        return np.asarray(warm, dtype=float)

    def in_space(self, places: Array) -> Array:
        """(3, ...) places (x forward, y down, z along the axis) as (forward, left, up) from the contact centre."""
        state = self._rolled.state
        road = state.grid.road
        x, down, left = road.in_road_axes(places)
        return np.stack([x, left + state.loaded_radius * np.tan(road.camber), state.loaded_radius - down])

    @cached_property
    def _columns(self) -> dict[tuple[int, int], int]:
        influence = self._rolled.state.grid.influence
        nodes, sides = influence.source
        numbers = influence.tread.nodes[nodes]
        return {(int(node), int(side)): column for column, (node, side) in enumerate(zip(numbers, sides, strict=True))}

    def _contact(self, values: Array) -> Array:
        """(n_points,) of values (n_angles, m) of the contact."""
        return self.on_tread(self.angles, self._rolled.state.grid.angles, values, self._columns)

    @cached_property
    def point_data(self) -> dict[str, Array]:
        """``pressure_Pa``; ``traction_Pa`` and ``sliding_m_s`` (forward, left, 0); ``state``: 0 open, 1 sticks,
        2 slips."""
        state = self._rolled.state
        grid = state.grid
        nearest = np.clip(np.rint((self.angles - grid.angles[0]) / grid.step), 0, len(grid.angles) - 1).astype(int)
        states = self.on_tread(self.angles, self.angles, state.states[nearest], self._columns)

        def level(vectors: Array) -> Array:
            x, y = (self._contact(vectors[..., component]) for component in (0, 1))
            return np.column_stack([x, y, np.zeros_like(x)])

        return {
            "pressure_Pa": self._contact(state.pressure),
            "traction_Pa": level(state.traction),
            "sliding_m_s": level(state.sliding_velocity),
            "state": np.rint(states).astype(np.int32),
        }

    @property
    def cell_data(self) -> dict[str, Array]:
        """``temperature_degC``, where the study or the user gives it."""
        if self.temperature is None and not self.pressed.study.parts.temperatures:
            return {}
        weights = self.pressed.tyre.body.rings.weights
        return {"temperature_degC": self.of_elements((self._warm * weights).sum(axis=1) / weights.sum(axis=1))}
