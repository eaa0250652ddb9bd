"""What unknowns change about a simulated drive: from tangents, or by simulating or measuring again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.tangent import Tangents
from tyrefem.diagnose.lean import Lean
from tyrefem.diagnose.unknowns import Unknown
from tyrefem.result import GAS, RIM
from tyrefem.sensors import recorded_change

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Varied:
    """What unknowns change about a solution.

    Parameters
    ----------
    again : number of an unknown -> simulated again, or measured again, with the unknown a step further.
    columns : the numbers of all others; tangents : theirs, in this order.
    """

    base: Lean
    unknowns: tuple[Unknown, ...]
    again: Mapping[int, Lean]
    columns: Sequence[int]
    tangents: Tangents | None

    @property
    def moved(self) -> list[Unknown]:
        """The unknowns of the tangents."""
        return [self.unknowns[column] for column in self.columns]

    def slopes(self, sensors: Sequence[str]) -> dict[str, Array]:
        """Sensor -> (n_grid, n_unknowns) d(reading)/dx."""
        base = self.base
        found = {one: np.zeros((len(base.grid), len(self.unknowns))) for one in sensors}
        for column, other in self.again.items():
            for sensor in sensors:
                change = other.readings[sensor] - base.readings[sensor]
                found[sensor][:, column] = change / self.unknowns[column].step
        if self.tangents is not None:
            for sensor, slopes in self._from_tangents(self.tangents, sensors).items():
                found[sensor][:, self.columns] = slopes
        return found

    def _from_tangents(self, found: Tangents, sensors: Sequence[str]) -> dict[str, Array]:
        base, gas, slopes = self.base, list(self.base.tyre.problem.reservoirs), {}
        for sensor in sensors:
            if sensor in (GAS, RIM):
                known = sensor in gas
                column = found.reservoirs[:, :, gas.index(sensor)] if known else np.zeros(found.values.shape[:2])
                slopes[sensor] = base.dense(column.T)
        if len(slopes) < len(sensors):
            at_sensors = base.dense(np.moveaxis(found.at(base.sensor_points), 0, -1))
            each = [recorded_change(base.study, base.grid, at_sensors[:, :, k]) for k in range(len(self.columns))]
            slopes |= {name: np.column_stack([one[name] for one in each]) for name in sensors if name not in slopes}
        return slopes
