"""Where the diagnosis simulates: predictions and tangents of every trial, in this process or in several."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.boundaries.rim import Lumped
from tyrefem.conduction.tangent import Perturbed, tangents
from tyrefem.diagnose.lean import Lean, lean
from tyrefem.diagnose.progress_store import ProgressStore
from tyrefem.diagnose.trials import Trial
from tyrefem.diagnose.unknowns import Unknown, with_values
from tyrefem.errors import InputError
from tyrefem.processes import processes
from tyrefem.result import GAS, RIM, Result
from tyrefem.rolling import RollingTyre, run
from tyrefem.sensors import recorded_change
from tyrefem.studies import Study

Array = NDArray[np.float64]
Values = Mapping[Unknown, float]
#: Mesh and tolerance of the fit; what they leave is corrected by one run with the study's own (at x = 0).
COARSE = {
    "mesh.size": "3.5 mm",
    "mesh.element": "P1",
    "numerics.tolerance": "0.05 delta_degC",
    "output.fields": 2,
}


@dataclass(frozen=True, eq=False)
class Response:
    """How a study's readings at one drive respond to unknowns, on an even grid of times; independent of any data.

    Parameters
    ----------
    times : (n,) s. readings : sensor -> (n,) degC at x = 0, by the lean simulation. correction : sensor -> (n,) K that
        the study's own mesh and error control add. slopes : sensor -> (n, n_unknowns) d(reading)/dx at x = 0.
    """

    unknowns: tuple[Unknown, ...]
    times: Array
    readings: dict[str, Array]
    correction: dict[str, Array]
    slopes: dict[str, Array]

    def blocks(self, trial: Trial) -> tuple[Array, Array, Array]:
        """Block means of a trial's series: lean readings, correction, slopes (n_blocks, n_unknowns)."""
        parts = [
            [one.sampled(self.times, values[one.sensor]) for one in trial.series]
            for values in (self.readings, self.correction, self.slopes)
        ]
        first, second, third = (np.concatenate(part) for part in parts)
        return first, second, third


@dataclass(frozen=True, eq=False)
class Bench:
    """A study and the trials it is held against; simulates one trial at a time."""

    study: Study
    trials: tuple[Trial, ...]

    def __reduce__(self) -> tuple[Any, ...]:
        """Another process starts with what was stated, not with what was simulated."""
        return Bench, (self.study, self.trials)

    @functools.cached_property
    def coarse(self) -> Study:
        """The study on the mesh of the fit."""
        coarse = dict(COARSE)
        if self.study.card.mesh.file is not None:
            coarse = {key: value for key, value in coarse.items() if key != "mesh.size"}
        return self.study.replace(coarse)

    @functools.cached_property
    def _bases(self) -> dict[int, Lean]:
        return {}

    def driven(self, study: Study, number: int) -> Study:
        """The study at the drive of a trial."""
        drive = self.trials[number].drive
        return study.with_drive(drive) if drive else study

    def base(self, number: int) -> Lean:
        """The coarse study simulated at a trial's drive."""
        if number not in self._bases:
            like = next((one.tyre for one in self._bases.values()), None)
            self._bases[number] = lean(self.driven(self.coarse, number), like)
        return self._bases[number]

    def blocks(self, number: int, times: Array, readings: Mapping[str, Any]) -> Array:
        """Block means of a trial from readings at ``times``."""
        return np.concatenate(
            [one.sampled(times, np.asarray(readings[one.sensor], dtype=float)) for one in self.trials[number].series]
        )

    def full(self, number: int, study: Study) -> Array:
        """Block means of a trial from a run of a study (at the trial's drive) with error control on its own mesh."""
        readings = run(study).readings
        times = readings["time_s"].to_numpy(dtype=float)
        return self.blocks(number, times, {str(name): readings[name] for name in readings})

    @property
    def sensors(self) -> tuple[str, ...]:
        """Everything that can be read: the study's sensors, the contained air, a lumped rim."""
        lumped = isinstance(self.study.card.boundaries.rim, Lumped)
        return (*self.study.sensors, GAS, RIM) if lumped else (*self.study.sensors, GAS)

    def response(self, number: int, unknowns: Sequence[Unknown]) -> tuple[Array, Array, Array, Array]:
        """What a `Response` is made of: times, and by sensor readings, correction and slopes, stacked."""
        base = self.base(number)
        fine = run(self.driven(self.study, number)).readings
        times = fine["time_s"].to_numpy(dtype=float)
        readings = np.array([base.readings[one] for one in self.sensors])
        exact = np.array([np.interp(base.grid, times, fine[one].to_numpy(dtype=float)) for one in self.sensors])
        slopes = self._slopes(base, base.study, unknowns, self.sensors, {})
        return base.grid, readings, exact - readings, np.array([slopes[one] for one in self.sensors])

    def jacobian(self, number: int, unknowns: Sequence[Unknown], at: Values) -> Array:
        """(n_blocks, n_unknowns): d(block mean)/dx with unknowns at ``at``."""
        base = self.base(number)
        here = lean(with_values(base.study, at), base.tyre)
        series = self.trials[number].series
        slopes = self._slopes(here, base.study, unknowns, [one.sensor for one in series], at)
        return np.concatenate([one.sampled(here.grid, slopes[one.sensor]) for one in series])

    def predict(self, number: int, values: Values) -> Array:
        """Block means of a trial with unknowns at ``values``, by the lean simulation; NaN where no tyre can be so."""
        base = self.base(number)
        try:
            study = with_values(base.study, values)
            same = all(unknown.measures or x == 0.0 for unknown, x in values.items())
            found = base.as_measured_by(study) if same else lean(study, base.tyre)
        except InputError:
            # A load that the tyre cannot carry, say: the fit has stepped too far and will try a shorter step.
            return np.full(len(self.trials[number].measured), np.nan)
        return self.blocks(number, found.grid, found.readings)

    def simulate(self, number: int, values: Values) -> Result:
        """The result of a trial's drive with unknowns at ``values``, on the coarse mesh with error control."""
        return run(with_values(self.driven(self.coarse, number), values))

    def differences(self, number: int, unknowns: Sequence[Unknown], at: Values) -> Array:
        """(n_blocks, n_unknowns): difference quotients by simulating again."""
        here = self.predict(number, at)
        columns = [
            (self.predict(number, {**at, one: at.get(one, 0.0) + one.step}) - here) / one.step for one in unknowns
        ]
        return np.column_stack(columns) if columns else np.zeros((len(here), 0))

    def _slopes(
        self, base: Lean, origin: Study, unknowns: Sequence[Unknown], sensors: Sequence[str], at: Values
    ) -> dict[str, Array]:
        """Sensor -> (n_grid, n_unknowns) d(reading)/dx about a solution; from its operators where the mesh stays."""
        found = {one: np.zeros((len(base.grid), len(unknowns))) for one in sensors}
        columns: list[int] = []
        perturbed: list[Perturbed] = []
        for column, one in enumerate(unknowns):
            study = with_values(origin, {**at, one: at.get(one, 0.0) + one.step}, base.study)
            if one.measures:
                other = base.as_measured_by(study)
            else:
                tyre = RollingTyre(study, base.tyre)
                if tyre.mesh is base.tyre.mesh:
                    columns.append(column)
                    perturbed.append(Perturbed(tyre.problem, one.step, tyre.drive.initial))
                    continue
                other = lean(study)
            for sensor in sensors:
                found[sensor][:, column] = (other.readings[sensor] - base.readings[sensor]) / one.step
        if columns:
            for sensor, slopes in self._tangents(base, perturbed, sensors).items():
                found[sensor][:, columns] = slopes
        return found

    def _tangents(self, base: Lean, perturbed: Sequence[Perturbed], sensors: Sequence[str]) -> dict[str, Array]:
        found = tangents(base.tyre.problem, base.times, base.values, base.reservoirs, perturbed)
        gas = list(base.tyre.problem.reservoirs)
        slopes = {}
        for sensor in sensors:
            if sensor in (GAS, RIM):
                known = sensor in gas
                column = found.reservoirs[:, :, gas.index(sensor)] if known else np.zeros(found.values.shape[:2])
                slopes[sensor] = base.dense(column.T)
        if len(slopes) < len(sensors):
            at_sensors = base.dense(np.moveaxis(found.at(base.sensor_points), 0, -1))
            each = [recorded_change(base.study, base.grid, at_sensors[:, :, k]) for k in range(len(perturbed))]
            slopes |= {name: np.column_stack([one[name] for one in each]) for name in sensors if name not in slopes}
        return slopes


_BENCH: list[Bench] = []


def _install(bench: Bench) -> None:
    _BENCH[:] = [bench]


def _task(name: str, arguments: tuple[Any, ...]) -> Any:
    return getattr(_BENCH[0], name)(*arguments)


@dataclass(frozen=True, eq=False)
class Laboratory:
    """Simulations for a bench, side by side if it has workers. Results come in the order of the questions.

    What ``store`` knows from an interrupted diagnosis is not simulated again.
    """

    bench: Bench
    pool: Executor | None = None
    store: ProgressStore | None = None

    def ask(self, name: str, questions: Sequence[tuple[Any, ...]], tick: Callable[[], None] | None = None) -> list[Any]:
        """The answers of a method of `Bench` to several questions (arguments)."""
        found = [self.store.known(name, one) if self.store else None for one in questions]
        open_ones = [number for number, answer in enumerate(found) if answer is None]
        for _ in range(len(found) - len(open_ones)):
            if tick:
                tick()
        for number, answer in self._answers(name, {number: questions[number] for number in open_ones}):
            found[number] = answer
            if self.store:
                self.store.keep(name, questions[number], answer)
            if tick:
                tick()
        return found

    def _answers(self, name: str, questions: Mapping[int, tuple[Any, ...]]) -> Iterator[tuple[int, Any]]:
        """Answers as they are ready, with their questions' numbers."""
        if self.pool is None:
            for number, one in questions.items():
                yield number, getattr(self.bench, name)(*one)
            return
        futures = {self.pool.submit(_task, name, one): number for number, one in questions.items()}
        for future in as_completed(futures):
            yield futures[future], future.result()


@contextmanager
def laboratory(bench: Bench, workers: int = 1, store: ProgressStore | None = None) -> Iterator[Laboratory]:
    """A laboratory with so many processes; 1: in this one."""
    if workers <= 1:
        yield Laboratory(bench, store=store)
        return
    with processes(workers, _install, bench) as pool:
        yield Laboratory(bench, pool, store)
