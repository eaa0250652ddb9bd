"""Where the diagnosis simulates: predictions and tangents of every trial, in this process or in several."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.tangent import Perturbed, tangents
from tyrefem.diagnose.lean import Lean, lean
from tyrefem.diagnose.trials import Trial
from tyrefem.diagnose.unknowns import Unknown, with_values
from tyrefem.result import GAS, RIM, Result
from tyrefem.rolling import RollingTyre, run
from tyrefem.sensors import lagged
from tyrefem.studies import Study

Array = NDArray[np.float64]
Values = Mapping[Unknown, float]
#: Mesh and tolerance of the fit; what they leave is corrected by one run with the study's own (at x = 0).
COARSE = {
    "mesh.size": "4 mm",
    "mesh.element": "P1",
    "numerics.tolerance": "0.05 delta_degC",
    "output.fields": 2,
}


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
        """Block means of a trial from a run with error control on the study's own mesh."""
        readings = run(self.driven(study, number)).readings
        return self.blocks(number, readings["time_s"].to_numpy(dtype=float), readings)

    def predict(self, number: int, values: Values) -> Array:
        """Block means of a trial with unknowns at ``values``, by the lean simulation."""
        base = self.base(number)
        own = with_values(base.study, {unknown: x for unknown, x in values.items() if not unknown.measures})
        found = base if own.data == base.study.data else lean(own, base.tyre)
        found = found.as_measured_by(with_values(base.study, values))
        return self.blocks(number, found.grid, found.readings)

    def simulate(self, number: int, values: Values) -> Result:
        """The result of a trial's drive with unknowns at ``values``, on the coarse mesh with error control."""
        return run(with_values(self.driven(self.coarse, number), values))

    def prepared(self, number: int, unknowns: Sequence[Unknown]) -> tuple[Array, Array, Array]:
        """Of a trial at x = 0: lean block means, what the study's own mesh and error control add, the jacobian."""
        base = self.base(number)
        here = self.blocks(number, base.grid, base.readings)
        return here, self.full(number, self.study) - here, self.jacobian(number, unknowns)

    def differences(self, number: int, unknowns: Sequence[Unknown], at: Values) -> Array:
        """(n_blocks, n_unknowns): difference quotients by simulating again."""
        here = self.predict(number, at)
        columns = [
            (self.predict(number, {**at, one: at.get(one, 0.0) + one.step}) - here) / one.step for one in unknowns
        ]
        return np.column_stack(columns) if columns else np.zeros((len(here), 0))

    def jacobian(self, number: int, unknowns: Sequence[Unknown]) -> Array:
        """(n_blocks, n_unknowns): d(block mean)/dx at x = 0, from the assembled operators where the mesh stays."""
        base = self.base(number)
        here = self.blocks(number, base.grid, base.readings)
        found = np.zeros((len(here), len(unknowns)))
        columns: list[int] = []
        perturbed: list[Perturbed] = []
        for column, one in enumerate(unknowns):
            study = with_values(base.study, {one: one.step})
            if one.measures:
                seen = base.as_measured_by(study)
                found[:, column] = (self.blocks(number, seen.grid, seen.readings) - here) / one.step
                continue
            tyre = RollingTyre(study, base.tyre)
            if tyre.mesh is base.tyre.mesh:
                columns.append(column)
                perturbed.append(Perturbed(tyre.problem, one.step, tyre.drive.initial))
            else:
                found[:, column] = self.differences(number, [one], {})[:, 0]
        if columns:
            found[:, columns] = self._tangents(number, base, perturbed)
        return found

    def _tangents(self, number: int, base: Lean, perturbed: Sequence[Perturbed]) -> Array:
        found = tangents(base.tyre.problem, base.times, base.values, base.reservoirs, perturbed)
        gas, places, sensors = list(base.tyre.problem.reservoirs), list(base.study.sensors), base.study.sensors
        at_sensors = found.at(base.sensor_points) if places else None
        blocks = []
        for one in self.trials[number].series:
            if one.sensor in (GAS, RIM):
                known = one.sensor in gas
                column = found.reservoirs[:, :, gas.index(one.sensor)] if known else np.zeros(found.values.shape[:2])
            else:
                assert at_sensors is not None
                column = at_sensors[:, :, places.index(one.sensor)]
            dense = base.dense(column.T)
            if one.sensor in sensors:
                dense = np.column_stack([lagged(base.grid, each, sensors[one.sensor].lag) for each in dense.T])
            blocks.append(one.sampled(base.grid, dense))
        return np.concatenate(blocks)


_BENCH: list[Bench] = []


def _install(bench: Bench) -> None:
    _BENCH[:] = [bench]


def _task(name: str, arguments: tuple[Any, ...]) -> Any:
    return getattr(_BENCH[0], name)(*arguments)


@dataclass(frozen=True, eq=False)
class Laboratory:
    """Simulations for a bench, side by side if it has workers. Results come in the order of the questions."""

    bench: Bench
    pool: Executor | None = None

    def ask(self, name: str, questions: Sequence[tuple[Any, ...]], tick: Callable[[], None] | None = None) -> list[Any]:
        """The answers of a method of `Bench` to several questions (arguments)."""
        if self.pool is None:
            found = []
            for one in questions:
                found.append(getattr(self.bench, name)(*one))
                if tick:
                    tick()
            return found
        futures = [self.pool.submit(_task, name, one) for one in questions]
        found = []
        for future in futures:
            found.append(future.result())
            if tick:
                tick()
        return found


@contextmanager
def laboratory(bench: Bench, workers: int = 1) -> Iterator[Laboratory]:
    """A laboratory with so many processes; 1: in this one."""
    if workers <= 1:
        yield Laboratory(bench)
        return
    with ProcessPoolExecutor(workers, initializer=_install, initargs=(bench,)) as pool:
        try:
            yield Laboratory(bench, pool)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
