from __future__ import annotations

import time as clock
from collections.abc import Callable

import numpy as np

from tyrefem.simulation.readings import contained_air, logged_columns, temperatures_at, within
from tyrefem.simulation.result import ResultData
from tyrefem.simulation.rolling_tyre import Array, RollingTyre
from tyrefem.simulation.sensors import recorded, true_places
from tyrefem.simulation.surroundings import GAS, RIM


def simulate(
    tyre: RollingTyre, progress: Callable[[float], None] | None = None, *, partial: bool = False
) -> ResultData:
    """Simulate a tyre's drive with its present strain cycles; parameters as in `run`."""
    began = clock.perf_counter()
    study = tyre.study
    times, fields = output_times(tyre)
    history = tyre.problem.transient(
        times,
        tyre.drive.initial,
        study.tolerance,
        breakpoints=breakpoints(tyre),
        progress=progress,
        partial=partial,
    )
    if tyre.states is not None:
        tyre.states.record(history.times, history.states)
    return ResultData(study, tyre, history, fields, clock.perf_counter() - began)


def simulated_readings(tyre: RollingTyre) -> dict[str, Array]:
    """`ResultData.reading_columns` of `simulate`, by the same steps, without heat budget and hottest points."""
    study, (times, _) = tyre.study, output_times(tyre)
    values, reservoirs = tyre.problem.temperatures(
        times, tyre.drive.initial, study.tolerance, breakpoints=breakpoints(tyre)
    )
    places = list(true_places(study).values())
    sensors = recorded(study, times, temperatures_at(tyre, values, within(tyre, places))) if places else {}
    lumped = {GAS: contained_air(study, times, reservoirs)}
    if RIM in reservoirs:
        lumped[RIM] = reservoirs[RIM]
    return logged_columns(study, times, sensors, lumped)


def breakpoints(tyre: RollingTyre) -> list[float]:
    """Times at which data of a drive jump, s: begins of phases, and jumps of effects."""
    jumps = {time for effect in tyre.study.effects for time in effect.jumps if 0 < time < tyre.drive.end}
    return sorted({*tyre.drive.starts[1:], *jumps})


def output_times(tyre: RollingTyre) -> tuple[Array, Array]:
    """Times of the readings, and of the fields that are written out, s.

    The starts of phases are exact: a rounded one may lie after the jump, whose reading states the power before it.
    """
    end, output = tyre.drive.end, tyre.study.card.output
    fields = np.linspace(0.0, end, output.fields)
    exact = np.array([*tyre.drive.starts, end])
    readings = np.round(np.concatenate([np.arange(0.0, end, output.every), tyre.sliding.readings, fields]), 9)
    return np.union1d(exact, readings[~np.isin(readings, np.round(exact, 9))]), fields
