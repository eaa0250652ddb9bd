"""The forward model: values of unknowns -> readings of the sensors, by fixed-step, reduced or full simulation."""

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
from tyrefem.cache import Cache
from tyrefem.diagnose.forward.fixed_step import FixedStepRun, fixed_step_run
from tyrefem.diagnose.forward.reading_sensitivities import ReadingSensitivities, sensitivities_about
from tyrefem.diagnose.forward.reduced_drive import Modes, ReducedDrive, modes_of
from tyrefem.diagnose.forward.sampling import DriveSampling
from tyrefem.diagnose.forward.source_responses import source_responses
from tyrefem.diagnose.forward.step_groups import possible_step, step_groups
from tyrefem.diagnose.forward.strain_law_study import heats_by_law, readings_by_law
from tyrefem.diagnose.settings import DEFAULT, DiagnosisSettings
from tyrefem.diagnose.unknowns.unknown import Unknown, with_values
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.nearby_cycles import NearbyCycles, SolvedCycles
from tyrefem.mechanics.strain_laws import strain_law
from tyrefem.reduced.model import NotReducibleError
from tyrefem.simulation.run import run_readings
from tyrefem.simulation.surroundings import GAS, RIM
from tyrefem.variants.answer_store import study_digest

Array = NDArray[np.float64]
Values = Mapping[Unknown, float]
#: Places, each by points (s, depth), m.
Places = tuple[tuple[tuple[float, float], ...], ...]
#: Status of a reduced model at a point: its readings hold; it cannot represent these effects; it has no answer at this
#: point (an impossible tyre, for example).
FOLLOWED, NOT_FOLLOWED, NO_ANSWER = 0, 1, 2
#: Tangents to more unknowns than this take double steps.
MANY = 16
#: Number of simulations of each drive that are kept.
LATEST = 8
#: Simulations at x = 0, by study, drive and readings: all diagnoses of one layout share them.
_BASES: Cache[FixedStepRun] = Cache(size=12)


@dataclass(frozen=True, eq=False)
class ForwardModel(Brief):
    """A study and its measured drives: readings of the sensors at one drive for given values of the unknowns.

    The coarse simulation and the reduced model of every drive are kept.

    Parameters
    ----------
    drives : drives of the measured runs, with the times of the readings.
    folder : folder in which processes share strain cycles by finite elements.
    """

    study: StudyData
    drives: tuple[DriveSampling, ...]
    folder: Path | None = None
    settings: DiagnosisSettings = DEFAULT

    def __reduce__(self) -> tuple[Any, ...]:
        """A pickled copy has the inputs only, without simulations."""
        return ForwardModel, (self.study, self.drives, self.folder, self.settings)

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
    def _bases(self) -> Cache[FixedStepRun]:
        """Number of the drive -> simulation of the coarse study."""
        return Cache(max(len(self.drives), 1))

    @functools.cached_property
    def _numbers(self) -> Cache[Any]:
        """Numbers of the study and its cards as they are written."""
        return Cache(512)

    def with_values(self, study: StudyData, values: Values, like: StudyData | None = None) -> StudyData:
        """See `tyrefem.diagnose.unknowns.unknown.with_values`; effects in other runs than the study's are left out."""
        return with_values(study, _acting(study, values), like, self._numbers)

    def driven(self, study: StudyData, number: int) -> StudyData:
        """The study at the drive of a run."""
        return study.at_run(self.drives[number].run, self.drives[number].drive)

    def base(self, number: int) -> FixedStepRun:
        """The coarse study simulated at a drive."""
        return self._bases.get(number, lambda: self._based(number))

    def _based(self, number: int) -> FixedStepRun:
        """All drives share the mesh and the operators of the drive that was simulated first."""
        first = next((other for other in range(len(self.drives)) if other in self._bases), None)
        like = None if first is None else self.base(first).tyre
        driven, every = self.driven(self.coarse, number), self.settings.readings_every

        def compute() -> FixedStepRun:
            return fixed_step_run(driven, like, self.nearby(driven), every=every)

        # Strain cycles in a folder of worker processes last as long as these.
        return compute() if self.folder else _BASES.get((study_digest(driven), every), compute)

    def nearby(self, driven: StudyData) -> NearbyCycles | None:
        """Strain cycles near those of the coarse study at a drive; None if the strain law is not by finite elements."""
        if not strain_law(driven).by_elements:
            return None
        return NearbyCycles(driven, self._solved)

    @functools.cached_property
    def _solved(self) -> SolvedCycles:
        """Strain cycles with one changed number, of all drives."""
        return SolvedCycles(self.folder)

    def blocks(self, number: int, times: Array, readings: Mapping[str, Any]) -> Array:
        """Block means at a drive from readings at ``times``."""
        return np.concatenate(
            [
                sampling.sampled(times, np.asarray(readings[sampling.sensor], dtype=float))
                for sampling in self.drives[number].sensors
            ]
        )

    def history(self, study: StudyData) -> Array:
        """(1 + n_sensors, n_times): times, s, and readings of `sensors` by a full run; ``study``: at a drive."""
        columns = run_readings(study)
        return np.array([columns[name] for name in ("time_s", *self.sensors)])

    def blocks_of(self, number: int, history: Array) -> Array:
        """Block means at a drive from a `history`."""
        times, *readings = history
        return self.blocks(number, times, dict(zip(self.sensors, readings, strict=True)))

    def full(self, number: int, study: StudyData) -> Array:
        """Block means at a drive from a full run; ``study``: the study at that drive."""
        return self.blocks_of(number, self.history(study))

    @property
    def sensors(self) -> tuple[str, ...]:
        """All possible sensors: the study's sensors, the contained air, a lumped rim."""
        lumped = isinstance(self.study.card.boundaries.rim, LumpedRim)
        return (*self.study.sensors, GAS, RIM) if lumped else (*self.study.sensors, GAS)

    def base_readings(self, number: int) -> tuple[Array, Array]:
        """Times (n,), s, and readings (n_sensors, n) of `sensors` at x = 0, by the fixed-step simulation."""
        base = self.base(number)
        return base.grid, np.array([base.readings[sensor] for sensor in self.sensors])

    def response(self, number: int, unknowns: Sequence[Unknown]) -> tuple[Array, Array, Array, Array]:
        """Times and readings of `base_readings`, slopes stacked by sensor, and modes: see `DriveResponse`."""
        base = self.base(number)
        varied = self._sensitivities(base, base.study, unknowns, {})
        slopes = varied.slopes(self.sensors)
        stacked = np.array([slopes[sensor] for sensor in self.sensors])
        modes = modes_of(base, varied.of_tangents, varied.tangents, self.settings)
        return (*self.base_readings(number), stacked, modes)

    def jacobian(self, number: int, unknowns: Sequence[Unknown], at: Values) -> Array:
        """(n_blocks, n_unknowns): d(block mean)/dx with unknowns at ``at``.

        On the mesh of x = 0 tangents to many unknowns take steps twice as long, and are corrected by what these leave
        out at x = 0, which is computed once.
        """
        base, here, samplings = self.base(number), self._simulated(number, at), self.drives[number].sensors
        sensors = tuple(each.sensor for each in samplings)
        double = here.tyre.mesh is base.tyre.mesh and len(unknowns) > MANY
        slopes = self._sensitivities(here, base.study, unknowns, at, double=double).slopes(sensors)
        if double:
            left_out = self._left_out(base, unknowns, sensors)
            slopes = {sensor: slopes[sensor] + left_out[place] for place, sensor in enumerate(sensors)}
        return np.concatenate([each.sampled(here.grid, slopes[each.sensor]) for each in samplings])

    def _sensitivities(
        self, here: FixedStepRun, origin: StudyData, unknowns: Sequence[Unknown], at: Values, *, double: bool = False
    ) -> ReadingSensitivities:
        """`sensitivities_about` a simulation with unknowns at ``at``; ``origin``: the study at x = 0."""

        def study_of(values: Values) -> StudyData:
            return self.with_values(origin, values, here.study)

        return sensitivities_about(here, unknowns, at, study_of, double=double)

    def _left_out(self, base: FixedStepRun, unknowns: Sequence[Unknown], sensors: tuple[str, ...]) -> Array:
        """(n_sensors, n_grid, n_unknowns): what double steps leave out of the slopes of the readings at x = 0."""
        new = [unknown for unknown in unknowns if (sensors, unknown) not in base.left_out]
        columns: dict[Unknown, Array] = {}
        if new:
            fine, double = (
                self._sensitivities(base, base.study, new, {}, double=each).slopes(sensors) for each in (False, True)
            )
            off = np.nan_to_num(np.array([fine[sensor] - double[sensor] for sensor in sensors]))
            columns = {unknown: off[:, :, column] for column, unknown in enumerate(new)}
        every = [
            base.left_out.get((sensors, unknown), functools.partial(columns.__getitem__, unknown))
            for unknown in unknowns
        ]
        return np.stack(every, axis=-1) if every else np.zeros((len(sensors), len(base.grid), 0))

    def source_responses(self, number: int, sources: tuple[Unknown, ...], knots: tuple[float, ...]) -> Array:
        """Block means at a drive by source and knot; see `tyrefem.diagnose.forward.source_responses`."""
        return source_responses(self.base(number), self.drives[number], sources, np.array(knots))

    def drive_variables(self, number: int, times: tuple[float, ...], places: Places) -> Array:
        """(5 + n_places, n_times) at a drive: speed, load, pressure, deflection, ambient; then temperatures, degC.

        ``places``: for each, the (s, depth) in m whose mean temperature is asked for. SI units.
        """
        base = self.base(number)
        tyre, schedule = base.tyre, base.tyre.schedule
        at = np.array(times)
        rows = [
            np.array([law(float(t)) for t in at])
            for law in (
                tyre.speed,
                lambda t: schedule.mean(lambda case: case.load, t),
                lambda t: schedule.mean(lambda case: case.pressure, t),
                lambda t: schedule.mean(lambda case: case.deflection, t),
                tyre.ambient,
            )
        ]
        for points in places:
            s, depth = np.array(points).T
            rows.append(np.interp(at, base.grid, base.at(s, depth).mean(axis=1)))
        return np.array(rows)

    def predict(self, number: int, values: Values) -> Array:
        """Block means at a drive with unknowns at ``values``, by fixed-step simulation; NaN for an impossible tyre."""
        try:
            simulated = self._simulated(number, values)
        except InputError:
            # For example a load that the tyre cannot carry: the fit will try a shorter step.
            return np.full(self.drives[number].size, np.nan)
        return self.blocks(number, simulated.grid, simulated.readings)

    def displaced(self, number: int, values: Values, shift: Array) -> Array:
        """(3, n_blocks): change of the block means if sensors move at the temperatures of a simulation, K; slopes, K/m.

        Rows 1 and 2: slopes at the new places along the meridian and in depth. ``shift`` (n_sensors, 2) m: along the
        meridian and in depth; sensors as in the study. NaN for an impossible tyre.
        """
        try:
            here = self._simulated(number, values)
        except InputError:
            return np.full((3, self.drives[number].size), np.nan)
        changes = here.at_displaced(shift)
        parts = [
            each.sampled(here.grid, change.T)
            if (change := changes.get(each.sensor)) is not None
            else np.zeros((len(each.starts), 3))
            for each in self.drives[number].sensors
        ]
        return np.concatenate(parts).T

    def _simulated(self, number: int, values: Values) -> FixedStepRun:
        """Fixed-step simulation on the mesh and with the operators of `base`; the latest ones are kept."""
        base = self.base(number)

        def compute() -> FixedStepRun:
            study = self.with_values(base.study, values)
            same = all(x == 0.0 or unknown.measures for unknown, x in _acting(base.study, values).items())
            return base.as_measured_by(study) if same else fixed_step_run(study, base.tyre, every=base.every)

        return self._latest.get((number, frozenset(values.items())), compute)

    @functools.cached_property
    def _latest(self) -> Cache[FixedStepRun]:
        """The latest simulations of fits: sensitivities are taken where a fit was simulated."""
        return Cache(LATEST * max(len(self.drives), 1))

    def change_by_law(self, number: int, law: str, level: float = 0.0, mesh: str = "") -> Array:
        """Block means at a drive with another strain law, minus those of the study, at x = 0; NaN if it cannot run.

        ``level``: ln of a factor on the heat by the other law. ``mesh``: size of the elements for both; default: those
        of the fit.
        """
        remeshed = mesh if mesh != self.settings.mesh_size else ""
        pair = readings_by_law(self.base(number), law, level, remeshed)
        if pair is None:
            return np.full(self.drives[number].size, np.nan)
        stated, other = (self.blocks(number, *history) for history in pair)
        return other - stated

    def heat_by_law(self, number: int, law: str, mesh: str) -> Array:
        """(2, n) W in equal stretches from crown to bead as the tyre begins to turn: the study's law, another law.

        NaN if the law cannot run. ``mesh``: size of the elements.
        """
        return heats_by_law(self.base(number).study, law, mesh)

    def simulate(self, number: int, values: Values) -> FixedStepRun:
        """Fixed-step simulation of a drive with unknowns at ``values``; it has temperatures at any place."""
        study = self.with_values(self.driven(self.coarse, number), values)
        return fixed_step_run(study, every=self.settings.readings_every)

    def differences(self, number: int, unknowns: Sequence[Unknown], at: Values) -> Array:
        """(n_blocks, n_unknowns): difference quotients of two fixed-step simulations."""
        here = self.predict(number, at)
        columns = [
            (self.predict(number, {**at, unknown: at.get(unknown, 0.0) + unknown.step}) - here) / unknown.step
            for unknown in unknowns
        ]
        return np.column_stack(columns) if columns else np.zeros((len(here), 0))

    def reduced(self, number: int, modes: Modes, points: Sequence[Values]) -> tuple[Array, Array]:
        """Status (n_points,), see `FOLLOWED`, and block means (n_points, n_blocks) by the drive's reduced model.

        Block means = fixed-step simulation at x = 0 + change from x = 0 to the point by the reduced model.
        """
        base, drive = self.base(number), self._reduced_drive(number, modes)
        status = np.full(len(points), NO_ANSWER)
        means = np.full((len(points), self.drives[number].size), np.nan)
        studies: dict[int, StudyData] = {}
        for place, values in enumerate(points):
            with contextlib.suppress(InputError):
                studies[place] = self.with_values(base.study, values, base.study)
        try:
            correction = self.blocks(number, base.grid, base.readings) - self.blocks(number, base.grid, drive.unchanged)
        except NotReducibleError:
            return np.full(len(points), NOT_FOLLOWED), means
        readings, not_followed = drive.readings(list(studies.values()))
        for order, (place, of_study) in enumerate(zip(studies, readings, strict=True)):
            if of_study is not None:
                status[place], means[place] = FOLLOWED, self.blocks(number, base.grid, of_study) + correction
            elif order in not_followed:
                status[place] = NOT_FOLLOWED
        return status, means

    def reduced_jacobian(
        self, number: int, modes: Modes, unknowns: Sequence[Unknown], at: Values
    ) -> tuple[Array, Array]:
        """Status (1,), see `FOLLOWED`, and `jacobian` by difference quotients of the drive's reduced model.

        Columns of unknowns that the model does not follow are NaN, and those of a further effect with which no tyre can
        be built.
        """
        base, drive = self.base(number), self._reduced_drive(number, modes)
        here = self.with_values(base.study, at, base.study)
        there: dict[tuple[int, ...], tuple[StudyData, bool]] = {}
        back: set[tuple[int, ...]] = set()
        for group in step_groups(unknowns, here):
            unknown = unknowns[group[0]]
            step = possible_step(unknowns, group, at, lambda values, _: self.with_values(base.study, values, here))
            if step is not None:
                there[group] = step[0], unknown.measures or not unknown.acts_in(base.study.card.run)
                back |= {group} if step[1] < 0 else set()
        changes = drive.changes(here, list(there.values()))
        jacobian = np.full((self.drives[number].size, len(unknowns)), np.nan)
        if changes is None:
            return np.array([NOT_FOLLOWED]), jacobian
        parts = self.drives[number].parts()
        for group, change in zip(there, changes, strict=True):
            if change is None:
                continue
            blocks = self.blocks(number, base.grid, change)
            for column in group:
                unknown = unknowns[column]
                rows = slice(None) if len(group) == 1 else parts.get(unknown.only_sensor or "", slice(0))
                jacobian[:, column] = 0.0
                jacobian[rows, column] = blocks[rows] / (-unknown.step if group in back else unknown.step)
        return np.array([FOLLOWED]), jacobian

    @functools.cached_property
    def _reduced(self) -> Cache[ReducedDrive]:
        """Reduced models by drive and modes."""
        return Cache(2 * max(len(self.drives), 1))

    def _reduced_drive(self, number: int, modes: Modes) -> ReducedDrive:
        return self._reduced.get((number, modes.digest), lambda: ReducedDrive(self.base(number), modes, self.settings))


def _acting(study: StudyData, values: Values) -> Values:
    """The values of the unknowns that act in the study's run."""
    return {unknown: x for unknown, x in values.items() if unknown.acts_in(study.card.run)}
