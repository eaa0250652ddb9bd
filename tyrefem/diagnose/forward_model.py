"""A study and the runs it is held against: simulates one at a time, lean, on a few modes, or in full."""

from __future__ import annotations

import contextlib
import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.boundaries.rim import LumpedRim
from tyrefem.brief import Brief
from tyrefem.conduction.sensitivity import Perturbed, tangents
from tyrefem.diagnose.fast_simulation import Lean, Varied, lean
from tyrefem.diagnose.reduced_forward import Modes, ReducedDrive, modes_of
from tyrefem.diagnose.runs import Trial
from tyrefem.diagnose.settings import DEFAULT, DiagnosisSettings
from tyrefem.diagnose.unknowns import Unknown, with_values
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.nearby_cycles import NearbyCycles, SolvedCycles
from tyrefem.mechanics.strain_laws import strain_law
from tyrefem.reduced.model import NotReducibleError
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.simulation.run import run
from tyrefem.simulation.surroundings import GAS, RIM

Array = NDArray[np.float64]
Values = Mapping[Unknown, float]
#: A drive's reduced model follows a point; it never can, for such effects; it says nothing of this one, as of a tyre
#: that cannot be.
FOLLOWED, NOT_FOLLOWED, UNSAID = 0, 1, 2


@dataclass(frozen=True, eq=False)
class Response(Brief):
    """How a study's readings at one drive respond to unknowns, on an even grid of times; independent of any data.

    Parameters
    ----------
    times : (n,) s. readings : sensor -> (n,) degC at x = 0, by the lean simulation. correction : sensor -> (n,) K that
        the study's own mesh and error control add. slopes : sensor -> (n, n_unknowns) d(reading)/dx at x = 0.
    modes : for the drive's reduced model; learnt from the same tangents.
    """

    unknowns: tuple[Unknown, ...]
    times: Array
    readings: dict[str, Array]
    correction: dict[str, Array]
    slopes: dict[str, Array]
    modes: Modes

    def blocks(self, trial: Trial) -> tuple[Array, Array, Array]:
        """Block means of a trial's series: lean readings, correction, slopes (n_blocks, n_unknowns)."""
        parts = [
            [one.sampled(self.times, values[one.sensor]) for one in trial.series]
            for values in (self.readings, self.correction, self.slopes)
        ]
        first, second, third = (np.concatenate(part) for part in parts)
        return first, second, third


@dataclass(frozen=True, eq=False)
class Bench(Brief):
    """A study and the trials it is held against; simulates one trial at a time.

    ``folder``: where strain cycles by finite elements are left for other processes.
    """

    study: StudyData
    trials: tuple[Trial, ...]
    folder: Path | None = None
    settings: DiagnosisSettings = DEFAULT

    def __reduce__(self) -> tuple[Any, ...]:
        """Another process starts with what was stated, not with what was simulated."""
        return Bench, (self.study, self.trials, self.folder, self.settings)

    @functools.cached_property
    def coarse(self) -> StudyData:
        """The study on the mesh of the fit."""
        settings = self.settings
        coarse = {
            "mesh.size": settings.mesh_size,
            "mesh.element": settings.mesh_element,
            "numerics.tolerance": settings.tolerance,
            "output.fields": 2,
        }
        if self.study.card.mesh.file is not None:
            coarse = {key: value for key, value in coarse.items() if key != "mesh.size"}
        return self.study.replace(coarse)

    @functools.cached_property
    def _bases(self) -> dict[int, Lean]:
        return {}

    def driven(self, study: StudyData, number: int) -> StudyData:
        """The study at the drive of a trial."""
        drive = self.trials[number].drive
        return study.with_drive(drive) if drive else study

    def base(self, number: int) -> Lean:
        """The coarse study simulated at a trial's drive."""
        if number not in self._bases:
            like = next((one.tyre for one in self._bases.values()), None)
            driven = self.driven(self.coarse, number)
            self._bases[number] = lean(driven, like, self.nearby(driven), every=self.settings.readings_every)
        return self._bases[number]

    def nearby(self, driven: StudyData) -> NearbyCycles | None:
        """Strain cycles near those of the coarse study at a trial's drive; None where each costs next to nothing."""
        if not strain_law(driven).by_elements:
            return None
        return NearbyCycles(driven, self._solved)

    @functools.cached_property
    def _solved(self) -> SolvedCycles:
        """Strain cycles with a number moved, of all drives."""
        return SolvedCycles(self.folder)

    def blocks(self, number: int, times: Array, readings: Mapping[str, Any]) -> Array:
        """Block means of a trial from readings at ``times``."""
        return np.concatenate(
            [one.sampled(times, np.asarray(readings[one.sensor], dtype=float)) for one in self.trials[number].series]
        )

    def full(self, number: int, study: StudyData) -> Array:
        """Block means of a trial from a run of a study (at the trial's drive) with error control on its own mesh."""
        readings = run(study).readings
        times = readings["time_s"].to_numpy(dtype=float)
        return self.blocks(number, times, {str(name): readings[name] for name in readings})

    @property
    def sensors(self) -> tuple[str, ...]:
        """Everything that can be read: the study's sensors, the contained air, a lumped rim."""
        lumped = isinstance(self.study.card.boundaries.rim, LumpedRim)
        return (*self.study.sensors, GAS, RIM) if lumped else (*self.study.sensors, GAS)

    def response(self, number: int, unknowns: Sequence[Unknown]) -> tuple[Array, Array, Array, Array, Array]:
        """What a `Response` is made of: times; by sensor readings, correction and slopes, stacked; modes."""
        base = self.base(number)
        fine = run(self.driven(self.study, number)).readings
        times = fine["time_s"].to_numpy(dtype=float)
        readings = np.array([base.readings[one] for one in self.sensors])
        exact = np.array([np.interp(base.grid, times, fine[one].to_numpy(dtype=float)) for one in self.sensors])
        varied = self._varied(base, base.study, unknowns, {})
        slopes = varied.slopes(self.sensors)
        stacked = np.array([slopes[one] for one in self.sensors])
        return (
            base.grid,
            readings,
            exact - readings,
            stacked,
            modes_of(base, varied.moved, varied.tangents, self.settings),
        )

    def jacobian(self, number: int, unknowns: Sequence[Unknown], at: Values) -> Array:
        """(n_blocks, n_unknowns): d(block mean)/dx with unknowns at ``at``."""
        base = self.base(number)
        here = lean(with_values(base.study, at), base.tyre, every=base.every)
        series = self.trials[number].series
        slopes = self._varied(here, base.study, unknowns, at).slopes([one.sensor for one in series])
        return np.concatenate([one.sampled(here.grid, slopes[one.sensor]) for one in series])

    def predict(self, number: int, values: Values) -> Array:
        """Block means of a trial with unknowns at ``values``, by the lean simulation; NaN where no tyre can be so."""
        base = self.base(number)
        try:
            study = with_values(base.study, values)
            same = all(unknown.measures or x == 0.0 for unknown, x in values.items())
            found = base.as_measured_by(study) if same else lean(study, base.tyre, every=base.every)
        except InputError:
            # A load that the tyre cannot carry, say: the fit has stepped too far and will try a shorter step.
            return np.full(len(self.trials[number].measured), np.nan)
        return self.blocks(number, found.grid, found.readings)

    def simulate(self, number: int, values: Values) -> Lean:
        """A trial's drive with unknowns at ``values``, by the lean simulation: temperatures at any place."""
        study = with_values(self.driven(self.coarse, number), values)
        return lean(study, every=self.settings.readings_every)

    def differences(self, number: int, unknowns: Sequence[Unknown], at: Values) -> Array:
        """(n_blocks, n_unknowns): difference quotients by simulating again."""
        here = self.predict(number, at)
        columns = [
            (self.predict(number, {**at, one: at.get(one, 0.0) + one.step}) - here) / one.step for one in unknowns
        ]
        return np.column_stack(columns) if columns else np.zeros((len(here), 0))

    def reduced(self, number: int, modes: Modes, points: Sequence[Values]) -> tuple[Array, Array]:
        """(n_points,) `FOLLOWED` or what else, and (n_points, n_blocks) block means by the drive's reduced model.

        They are the lean simulation's at x = 0 and what the model says that unknowns at each of ``points`` change.
        """
        base, drive = self.base(number), self._reduced_drive(number, modes)
        status = np.full(len(points), UNSAID)
        found = np.full((len(points), len(self.trials[number].measured)), np.nan)
        studies: dict[int, StudyData] = {}
        for place, values in enumerate(points):
            with contextlib.suppress(InputError):
                studies[place] = with_values(base.study, values, base.study)
        try:
            own = self.blocks(number, base.grid, base.readings) - self.blocks(number, base.grid, drive.own)
        except NotReducibleError:
            return np.full(len(points), NOT_FOLLOWED), found
        readings, refused = drive.readings(list(studies.values()))
        for order, (place, one) in enumerate(zip(studies, readings, strict=True)):
            if one is not None:
                status[place], found[place] = FOLLOWED, self.blocks(number, base.grid, one) + own
            elif order in refused:
                status[place] = NOT_FOLLOWED
        return status, found

    def reduced_jacobian(
        self, number: int, modes: Modes, unknowns: Sequence[Unknown], at: Values
    ) -> tuple[Array, Array]:
        """(1,) `FOLLOWED` or not, and `jacobian` by differences of the drive's reduced model."""
        base, drive = self.base(number), self._reduced_drive(number, modes)
        here = with_values(base.study, at, base.study)
        there = [
            (with_values(base.study, {**at, one: at.get(one, 0.0) + one.step}, base.study), one.measures)
            for one in unknowns
        ]
        slopes = drive.slopes(here, there, [one.step for one in unknowns])
        if slopes is None:
            return np.array([NOT_FOLLOWED]), np.zeros((len(self.trials[number].measured), len(unknowns)))
        return np.array([FOLLOWED]), np.column_stack([self.blocks(number, base.grid, one) for one in slopes])

    @functools.cached_property
    def _drives(self) -> dict[tuple[int, str], ReducedDrive]:
        return {}

    def _reduced_drive(self, number: int, modes: Modes) -> ReducedDrive:
        key = number, modes.digest
        if key not in self._drives:
            self._drives[key] = ReducedDrive(self.base(number), modes, self.settings)
        return self._drives[key]

    def _varied(self, base: Lean, origin: StudyData, unknowns: Sequence[Unknown], at: Values) -> Varied:
        """What unknowns change about a solution; from its operators where the mesh stays."""
        again: dict[int, Lean] = {}
        columns: list[int] = []
        perturbed: list[Perturbed] = []
        for column, one in enumerate(unknowns):
            study = with_values(origin, {**at, one: at.get(one, 0.0) + one.step}, base.study)
            if one.measures:
                again[column] = base.as_measured_by(study)
                continue
            tyre = RollingTyre(study, base.tyre)
            # States that an effect keeps are unknowns that the base solution does not have.
            if tyre.mesh is base.tyre.mesh and tyre.states is None and base.tyre.states is None:
                columns.append(column)
                perturbed.append(Perturbed(tyre.problem, one.step, tyre.drive.initial))
            else:
                again[column] = lean(study, base.tyre if tyre.mesh is base.tyre.mesh else None, every=base.every)
        found = tangents(base.tyre.problem, base.times, base.values, base.reservoirs, perturbed) if perturbed else None
        return Varied(base, tuple(unknowns), again, columns, found)
