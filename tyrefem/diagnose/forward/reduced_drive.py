"""Reduced forward model of a measured drive: readings for other numbers and effects at a tenth of the cost."""

from __future__ import annotations

import contextlib
import functools
import hashlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.sensitivity import Tangents
from tyrefem.diagnose.forward.fixed_step import FixedStepRun, read, sensor_points
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns.unknown import Unknown
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.reduced.answers import batch_solutions
from tyrefem.reduced.balance import ReducedBalance, reduced_balance
from tyrefem.reduced.model import NotReducibleError, ReducedModel
from tyrefem.reduced.pod import modes
from tyrefem.reduced.solution import BatchSolution
from tyrefem.reduced.training import weight
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.simulation.surroundings import GAS, RIM
from tyrefem.variants.outcomes import NotReducible

Array = NDArray[np.float64]
Readings = dict[str, Array]


@dataclass(frozen=True, eq=False)
class Modes:
    """POD modes V (n, m) of a drive on the mesh of the fit; m = 0: the drive has no reduced model."""

    V: Array

    @functools.cached_property
    def digest(self) -> str:
        """Short SHA-256 digest of V."""
        return hashlib.sha256(np.ascontiguousarray(self.V).tobytes()).hexdigest()[:16]

    def __repr__(self) -> str:
        return f"Modes({self.V.shape[1]}, {self.digest})"


def modes_of(
    base: FixedStepRun, unknowns: Sequence[Unknown], tangents: Tangents | None, settings: DiagnosisSettings
) -> Array:
    """(n, m) POD modes of a drive's temperature fields and of their tangents dT/dx.

    The tangents give the first-order change of the fields with every unknown. The reduced equations give the size of
    the change, and the joint effect of several unknowns.
    """
    tyre, last = base.tyre, len(base.times) - 1
    try:
        reduced_balance(ReducedModel(tyre, np.ones((len(base.values[0]), 1)), {}, np.zeros((0, 0))), tyre)
    except NotReducibleError:
        return np.zeros((len(base.values[0]), 0))
    rows = [base.values[np.unique(np.linspace(0, last, settings.drive_fields).round().astype(int))]]
    if tangents is not None:
        # Early and even times: changes at the start of a phase fade later.
        when = np.unique(
            np.concatenate([np.arange(2, 10, 2), np.linspace(0, last, settings.tangent_fields)[1:].round().astype(int)])
        )
        rows += [
            tangent[when[when <= last]] * unknown.sd for unknown, tangent in zip(unknowns, tangents.values, strict=True)
        ]
    operators = tyre.problem.operators
    everywhere = {region: operators.dofs(region) for region in tyre.bodies}
    return modes(np.vstack(rows), weight(tyre, everywhere), settings.modes_left_out, settings.most_modes)


@dataclass(frozen=True, eq=False)
class ReducedDrive:
    """The reduced model of a drive. Heat sources are evaluated at all nodes, because the mesh of the fit is coarse."""

    base: FixedStepRun
    modes: Modes
    settings: DiagnosisSettings

    @functools.cached_property
    def model(self) -> ReducedModel:
        """The heat balance on the modes."""
        tyre = self.base.tyre
        operators = tyre.problem.operators
        samples = {zone: np.arange(len(operators.dofs(zone))) for zone in tyre.sources}
        everywhere = {region: operators.dofs(region) for region in tyre.bodies}
        count = sum(len(nodes) for nodes in samples.values())
        return ReducedModel(tyre, self.modes.V, samples, np.eye(count), everywhere)

    @functools.cached_property
    def unchanged(self) -> Readings:
        """Readings of the drive at x = 0."""
        (readings,), _ = self.readings([self.base.study])
        if readings is None:
            raise NotReducibleError("the unchanged drive")
        return readings

    def readings(self, studies: Sequence[StudyData]) -> tuple[list[Readings | None], list[int]]:
        """Readings on the drive's grid by study (None if there are none), and the numbers of irreducible studies."""
        readings: list[Readings | None] = [None] * len(studies)
        solutions, not_followed = self._integrated([RollingTyre(study, self.base.tyre) for study in studies])
        for numbers, part in solutions:
            states = part.states(self.base.grid)
            for place, number in enumerate(numbers):
                readings[number] = self.read(studies[number], part.batch.balances[place], states[:, place])
        return readings, not_followed

    def changes(self, here: StudyData, there: Sequence[tuple[StudyData, bool]]) -> list[Readings | None] | None:
        """Readings of the studies ``there`` minus those of ``here``; None if ``here`` is not reducible.

        All studies are integrated as one batch with the same time steps, so that differences of short steps are smooth.
        A study that does not fit into this batch has None in the list.

        Parameters
        ----------
        there : (study, whether it changes only the measurement of the tyre of ``here``).
        """
        moved = [number for number, (_, measures) in enumerate(there) if not measures]
        tyre = RollingTyre(here, self.base.tyre)
        tyres = [tyre, *(RollingTyre(there[number][0], tyre) for number in moved)]
        together = self._together(tyres)
        if together is None:
            return None
        numbers, solution = together
        states, balances = solution.states(self.base.grid), solution.batch.balances
        place = {number: where for where, number in enumerate(numbers)}
        at = {number: place.get(order) for order, number in enumerate(moved, start=1)}

        def reading(study: StudyData, where: int) -> Readings:
            return self.read(study, balances[where], states[:, where])

        first = reading(here, place[0])
        changes: list[Readings | None] = []
        for number, (study, _) in enumerate(there):
            where = at.get(number, place[0])
            changed = None if where is None else reading(study, where)
            changes.append(changed and {name: changed[name] - first[name] for name in first})
        return changes

    def _together(self, tyres: Sequence[RollingTyre]) -> tuple[list[int], BatchSolution] | None:
        """Numbers and solution of the tyres in one batch with the first; None if the first is not reducible."""
        tolerance, most = self.settings.reduced_time_tolerance, self.settings.batch_size
        with contextlib.suppress(InputError):
            for numbers, part in batch_solutions(self.model, tyres, tolerance, most):
                if 0 in numbers or isinstance(part, BatchSolution):
                    return (numbers, part) if 0 in numbers and isinstance(part, BatchSolution) else None
        return None

    def _integrated(self, tyres: Sequence[RollingTyre]) -> tuple[list[tuple[list[int], BatchSolution]], list[int]]:
        """(numbers of the tyres, solution) of each batch, and the numbers of irreducible tyres."""
        solutions: list[tuple[list[int], BatchSolution]] = []
        not_followed: list[int] = []
        tolerance, together = self.settings.reduced_time_tolerance, self.settings.batch_size
        # If the time integration of a tyre fails, the fixed-step simulation reports the error.
        with contextlib.suppress(InputError):
            for numbers, part in batch_solutions(self.model, tyres, tolerance, together):
                if isinstance(part, BatchSolution):
                    solutions.append((numbers, part))
                elif isinstance(part, NotReducible):
                    not_followed += numbers
        return solutions, not_followed

    def read(self, study: StudyData, balance: ReducedBalance, states: Array) -> Readings:
        """Readings of the study's logger from states (n_grid, n): mode amplitudes, then reservoirs."""
        m = self.model.size
        at_sensors = None
        if study.sensors:
            at_sensors = states[:, :m] @ self.model.rows(sensor_points(study, self.base.tyre)).T
        names = list(balance.reservoirs)
        lumped = {name: states[:, m + names.index(name)] for name in (GAS, RIM) if name in names}
        return read(study, self.base.grid, at_sensors, lumped)
