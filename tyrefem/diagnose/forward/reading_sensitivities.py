"""Sensitivities of readings about a simulated drive: from tangents, a second simulation or a second measurement."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.sensitivity import Perturbed, Tangents, tangents
from tyrefem.diagnose.forward.fixed_step import FixedStepRun, run_of_tyre
from tyrefem.diagnose.forward.step_groups import of_further_effect, possible_step, step_groups
from tyrefem.diagnose.unknowns.unknown import Unknown
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.simulation.sensors import logged, recorded_change
from tyrefem.simulation.surroundings import GAS, RIM

Array = NDArray[np.float64]
Values = Mapping[Unknown, float]


@dataclass(frozen=True, eq=False)
class ReadingSensitivities:
    """Sensitivities of the readings of a simulated drive.

    Parameters
    ----------
    again : numbers of unknowns -> second simulation or measurement with them one step further; of several, see
        `step_groups`, each changes the reading of its sensor only. back : those of them with a step back instead.
    columns : numbers of the other unknowns. tangents : dT/dx of these unknowns, in this order.
    moved : number of an unknown that moves one sensor -> the sensor, and the direction (0: along, 1: in depth).
    failed : numbers of unknowns with which no tyre can be built; their sensitivities are NaN.
    """

    base: FixedStepRun
    unknowns: tuple[Unknown, ...]
    again: Mapping[tuple[int, ...], FixedStepRun]
    columns: Sequence[int]
    tangents: Tangents | None
    failed: Sequence[int] = ()
    moved: Mapping[int, tuple[str, int]] = field(default_factory=dict)
    back: frozenset[tuple[int, ...]] = frozenset()

    @property
    def of_tangents(self) -> list[Unknown]:
        """The unknowns whose sensitivities come from tangents."""
        return [self.unknowns[column] for column in self.columns]

    def slopes(self, sensors: Sequence[str]) -> dict[str, Array]:
        """Sensor -> (n_grid, n_unknowns) d(reading)/dx."""
        base = self.base
        slopes = {sensor: np.zeros((len(base.grid), len(self.unknowns))) for sensor in sensors}
        for sensor in sensors:
            slopes[sensor][:, list(self.failed)] = np.nan
        for column, (sensor, direction) in self.moved.items():
            if sensor in slopes:
                slopes[sensor][:, column] = self._over_places[sensor][:, direction]
        for group, other in self.again.items():
            for sensor in sensors:
                change = other.readings[sensor] - base.readings[sensor]
                change = -change if group in self.back else change
                for column in group:
                    unknown = self.unknowns[column]
                    if len(group) == 1 or unknown.only_sensor == sensor:
                        slopes[sensor][:, column] = change / unknown.step
        if self.tangents is not None:
            for sensor, of_tangents in self._from_tangents(self.tangents, sensors).items():
                slopes[sensor][:, self.columns] = of_tangents
        return slopes

    @cached_property
    def _over_places(self) -> dict[str, Array]:
        """Sensor -> (n_grid, 2) d(reading)/d(place) along the meridian and in depth, K/m."""
        still = np.zeros((len(self.base.study.stated_places), 2))
        return {name: each[1:].T for name, each in self.base.at_displaced(still).items()}

    def _from_tangents(self, tangents: Tangents, sensors: Sequence[str]) -> dict[str, Array]:
        base, gas, slopes = self.base, list(self.base.tyre.problem.reservoirs), {}
        for sensor in sensors:
            if sensor in (GAS, RIM):
                known = sensor in gas
                column = tangents.reservoirs[:, :, gas.index(sensor)] if known else np.zeros(tangents.values.shape[:2])
                slopes[sensor] = logged(base.study, base.grid, base.dense(column.T, tangents.times))
        if len(slopes) < len(sensors):
            at_sensors = base.dense(np.moveaxis(tangents.at(base.sensor_points), 0, -1), tangents.times)
            changes = recorded_change(base.study, base.grid, at_sensors)
            slopes |= {name: changes[name] for name in sensors if name not in slopes}
        return slopes


def sensitivities_about(
    base: FixedStepRun,
    unknowns: Sequence[Unknown],
    at: Values,
    study_of: Callable[[Values], StudyData],
    *,
    double: bool = False,
) -> ReadingSensitivities:
    """Sensitivities about a solution: tangents if the unknown keeps the mesh, else a second simulation.

    ``base``: the solution with unknowns at ``at``. ``study_of``: values of unknowns -> the study. ``double``: tangents
    in steps twice as long, which takes half the time. A number at its limit steps back. Sensitivities of a further
    effect with which no tyre can be built are NaN, those of an effect in other runs 0.

    Raises
    ------
    InputError : no tyre can be built with an unknown that is no further effect.
    """
    again: dict[tuple[int, ...], FixedStepRun] = {}
    failed: list[int] = []
    columns: list[int] = []
    perturbed: list[Perturbed] = []
    moved: dict[int, tuple[str, int]] = {}
    back: set[tuple[int, ...]] = set()
    swapped = any(effect.overrides("channel") for effect in base.study.effects)
    acting = [column for column, unknown in enumerate(unknowns) if unknown.acts_in(base.study.card.run)]
    if not swapped:
        moved = {column: move for column in acting if (move := unknowns[column].moves_sensor) is not None}
    still = [column for column in acting if column not in moved]
    for numbers in step_groups([unknowns[column] for column in still], base.study):
        group = tuple(still[number] for number in numbers)
        column, *_ = group
        unknown = unknowns[column]
        step = possible_step(unknowns, group, at, partial(_changed, base, study_of, unknown))
        if step is None:
            failed += group
            continue
        change, sign = step
        if isinstance(change, Perturbed):
            perturbed.append(change)
            columns.append(column)
        else:
            again[group] = change
            back |= {group} if sign < 0 else set()
    derivatives: Tangents | None = None
    try:
        derivatives = _tangents(base, perturbed, double=double)
    except InputError:
        alone = {column: each for column, each in zip(columns, perturbed, strict=True) if _possible(base, each)}
        without = [column for column in columns if column not in alone]
        if not all(of_further_effect(unknowns[column]) for column in without):
            raise
        failed += without
        columns = list(alone)
        derivatives = _tangents(base, list(alone.values()), double=double)
    return ReadingSensitivities(base, tuple(unknowns), again, columns, derivatives, failed, moved, frozenset(back))


def _changed(
    base: FixedStepRun, study_of: Callable[[Values], StudyData], unknown: Unknown, values: Values, sign: float
) -> FixedStepRun | Perturbed:
    """The run after a step of an unknown to ``values``, or the changed problem if it has the base's unknowns."""
    study = study_of(values)
    if unknown.measures:
        return base.as_measured_by(study)
    tyre = RollingTyre(study, base.tyre)
    # The state of an effect adds unknowns that the base solution does not have.
    if tyre.mesh is base.tyre.mesh and tyre.states is None and base.tyre.states is None:
        return Perturbed(tyre.problem, sign * unknown.step, tyre.drive.initial)
    return run_of_tyre(study, tyre, every=base.every)


def _tangents(base: FixedStepRun, perturbed: Sequence[Perturbed], *, double: bool = False) -> Tangents | None:
    if not perturbed:
        return None
    solution = base.in_double_steps() if double else (base.times, base.values, base.reservoirs)
    return tangents(base.tyre.problem, *solution, perturbed)


def _possible(base: FixedStepRun, perturbed: Perturbed) -> bool:
    """Whether the tangents of one changed parameter can be computed."""
    try:
        _tangents(base, [perturbed])
    except InputError:
        return False
    return True
