"""A measured drive on a few modes: what its sensors read with other numbers and effects, at a tenth of the cost."""

from __future__ import annotations

import contextlib
import functools
import hashlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.sensitivity import Tangents
from tyrefem.diagnose.fixed_step import FixedStepRun, read, sensor_points
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns import Unknown
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
    """V (n, m) of a drive on the mesh of the fit; m = 0: no reduced model follows the drive."""

    V: Array

    @functools.cached_property
    def digest(self) -> str:
        """Of the numbers."""
        return hashlib.sha256(np.ascontiguousarray(self.V).tobytes()).hexdigest()[:16]

    def __repr__(self) -> str:
        return f"Modes({self.V.shape[1]}, {self.digest})"


def modes_of(
    base: FixedStepRun, unknowns: Sequence[Unknown], tangents: Tangents | None, settings: DiagnosisSettings
) -> Array:
    """(n, m) modes of a drive and of what unknowns change in it, from tangents that are at hand.

    Tangents say what the mesh does with every unknown to first order; how far, and how two of them act together, is
    left to the reduced equations.
    """
    tyre, last = base.tyre, len(base.times) - 1
    try:
        reduced_balance(ReducedModel(tyre, np.ones((len(base.values[0]), 1)), {}, np.zeros((0, 0))), tyre)
    except NotReducibleError:
        return np.zeros((len(base.values[0]), 0))
    rows = [base.values[np.unique(np.linspace(0, last, settings.drive_fields).round().astype(int))]]
    if tangents is not None:
        # Early and evenly: what changes the start of a phase is gone later.
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
    """A drive's reduced model. Heat sources are evaluated at every node: on the mesh of the fit there are few."""

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
        """Readings of the drive as the study has it."""
        (readings,), _ = self.readings([self.base.study])
        if readings is None:
            raise NotReducibleError("the drive as it is")
        return readings

    def readings(self, studies: Sequence[StudyData]) -> tuple[list[Readings | None], list[int]]:
        """Readings on the drive's grid by study, None where there are none; numbers of those it can never follow."""
        readings: list[Readings | None] = [None] * len(studies)
        marched, refused = self._marched([RollingTyre(study, self.base.tyre) for study in studies])
        for numbers, part in marched:
            states = part.states(self.base.grid)
            for place, number in enumerate(numbers):
                readings[number] = self.read(studies[number], part.batch.balances[place], states[:, place])
        return readings, refused

    def slopes(
        self, here: StudyData, there: Sequence[tuple[StudyData, bool]], steps: Sequence[float]
    ) -> list[Readings] | None:
        """d(reading)/dx of the studies ``there``, each a step from ``here``; None where the model cannot follow.

        All are marched together, with the same steps and sweeps: differences are smooth however short the way.

        Parameters
        ----------
        there : the study, and whether it only measures the tyre of ``here`` in another way.
        """
        moved = [number for number, (_, measures) in enumerate(there) if not measures]
        tyre = RollingTyre(here, self.base.tyre)
        tyres = [tyre, *(RollingTyre(there[number][0], tyre) for number in moved)]
        groups, _ = self._marched(tyres)
        if len(groups) != 1 or len(groups[0][0]) != len(tyres):
            return None
        numbers, marched = groups[0]
        states, balances = marched.states(self.base.grid), marched.batch.balances
        place = {number: where for where, number in enumerate(numbers)}
        at = {number: place[order] for order, number in enumerate(moved, start=1)}

        def reading(study: StudyData, where: int) -> Readings:
            return self.read(study, balances[where], states[:, where])

        first = reading(here, place[0])
        others = [reading(study, at.get(number, place[0])) for number, (study, _) in enumerate(there)]
        return [
            {name: (changed[name] - first[name]) / step for name in first}
            for changed, step in zip(others, steps, strict=True)
        ]

    def _marched(self, tyres: Sequence[RollingTyre]) -> tuple[list[tuple[list[int], BatchSolution]], list[int]]:
        """Those that can be marched, together; numbers of those that the model cannot follow."""
        solutions: list[tuple[list[int], BatchSolution]] = []
        refused: list[int] = []
        tolerance, together = self.settings.reduced_time_tolerance, self.settings.marched_together
        # Where one of them takes no step any more, the fixed-step simulation says what is wrong with it.
        with contextlib.suppress(InputError):
            for numbers, part in batch_solutions(self.model, tyres, tolerance, together):
                if isinstance(part, BatchSolution):
                    solutions.append((numbers, part))
                elif isinstance(part, NotReducible):
                    refused += numbers
        return solutions, refused

    def read(self, study: StudyData, balance: ReducedBalance, states: Array) -> Readings:
        """What the study's logger records of states (n_grid, n): modes, then reservoirs."""
        m = self.model.size
        at_sensors = None
        if study.sensors:
            at_sensors = states[:, :m] @ self.model.rows(sensor_points(study, self.base.tyre)).T
        names = list(balance.reservoirs)
        lumped = {name: states[:, m + names.index(name)] for name in (GAS, RIM) if name in names}
        return read(study, self.base.grid, at_sensors, lumped)
