"""Where the diagnosis simulates: predictions and tangents of every trial, in this process or in several."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.tangent import Perturbed, stage_times, tangents
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
    "output.every": "5 s",
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
    def _bases(self) -> dict[int, tuple[Study, Result]]:
        return {}

    def driven(self, study: Study, number: int) -> Study:
        """The study at the drive of a trial."""
        drive = self.trials[number].drive
        return study.with_drive(drive) if drive else study

    def base(self, number: int) -> tuple[Study, Result]:
        """The coarse study at a trial's drive, and its result."""
        if number not in self._bases:
            study = self.driven(self.coarse, number)
            like = next((result.tyre for _, result in self._bases.values()), None)
            self._bases[number] = study, run(study, like=like)
        return self._bases[number]

    def blocks(self, number: int, result: Result) -> Array:
        """The block means that a result predicts for a trial."""
        readings = result.readings
        times = readings["time_s"].to_numpy(dtype=float)
        return np.concatenate(
            [one.sampled(times, readings[one.sensor].to_numpy(dtype=float)) for one in self.trials[number].series]
        )

    def predict(self, number: int, values: Values) -> Array:
        """Block means of a trial with unknowns at ``values``, on the coarse mesh."""
        return self.blocks(number, self.simulate(number, values))

    def simulate(self, number: int, values: Values) -> Result:
        """The result of a trial's drive with unknowns at ``values``, on the coarse mesh."""
        study, base = self.base(number)
        changing = {unknown: x for unknown, x in values.items() if not unknown.measures}
        own = with_values(study, changing)
        result = base if own.data == study.data else run(own, like=base.tyre)
        return dataclasses.replace(result, study=with_values(study, values))

    def correction(self, number: int) -> Array:
        """What the study's own mesh and tolerance change of the block means, at x = 0."""
        fine = self.driven(self.study, number)
        return self.blocks(number, run(fine)) - self.blocks(number, self.base(number)[1])

    def rerun(self, number: int, study: Study) -> Array:
        """Block means of another study (the amended one, on its own mesh) at a trial's drive."""
        return self.blocks(number, run(self.driven(study, number)))

    def jacobian_and_base(self, number: int, unknowns: Sequence[Unknown]) -> tuple[Array, Array]:
        """`jacobian`, and the block means at x = 0 on the coarse mesh."""
        return self.jacobian(number, unknowns), self.blocks(number, self.base(number)[1])

    def differences(self, number: int, unknowns: Sequence[Unknown], at: Values) -> Array:
        """(n_blocks, n_unknowns): difference quotients by simulating again."""
        here = self.predict(number, at)
        columns = [
            (self.predict(number, {**at, one: at.get(one, 0.0) + one.step}) - here) / one.step for one in unknowns
        ]
        return np.column_stack(columns) if columns else np.zeros((len(here), 0))

    def jacobian(self, number: int, unknowns: Sequence[Unknown]) -> Array:
        """(n_blocks, n_unknowns): d(block mean)/dx at x = 0, from the assembled operators where the mesh stays."""
        study, base = self.base(number)
        here = self.blocks(number, base)
        found = np.zeros((len(here), len(unknowns)))
        columns: list[int] = []
        perturbed: list[Perturbed] = []
        for column, one in enumerate(unknowns):
            step = one.step
            if one.measures:
                seen = dataclasses.replace(base, study=with_values(study, {one: step}))
                found[:, column] = (self.blocks(number, seen) - here) / step
                continue
            tyre = RollingTyre(with_values(study, {one: step}), base.tyre)
            if tyre.mesh is base.tyre.mesh:
                columns.append(column)
                perturbed.append(Perturbed(tyre.problem, step, tyre.drive.initial))
            else:
                found[:, column] = self.differences(number, [one], {})[:, 0]
        if columns:
            found[:, columns] = self._tangents(number, study, base, perturbed)
        return found

    def _tangents(self, number: int, study: Study, base: Result, perturbed: Sequence[Perturbed]) -> Array:
        drive = study.card.drive
        times = stage_times([*drive.starts, drive.end])
        history = base.tyre.problem.transient(times, drive.initial, study.tolerance, breakpoints=drive.starts[1:])
        gas = list(history.reservoirs)
        states = np.column_stack([history.reservoirs[name] for name in gas]) if gas else np.zeros((len(times), 0))
        found = tangents(base.tyre.problem, times, history.values, states, perturbed)
        at_sensors = found.at(base.sensor_points) if len(study.sensors) else None
        places = list(study.sensors)
        blocks = []
        for one in self.trials[number].series:
            if one.sensor in (GAS, RIM):
                known = one.sensor in gas
                column = found.reservoirs[:, :, gas.index(one.sensor)] if known else np.zeros(found.values.shape[:2])
            else:
                assert at_sensors is not None
                lag = study.sensors[one.sensor].lag
                column = np.array([lagged(times, row, lag) for row in at_sensors[:, :, places.index(one.sensor)]])
            blocks.append(one.sampled(times, column.T))
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
