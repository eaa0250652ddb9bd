"""Full runs of settings of a box: skins just after jumps for training, whole histories for the certificate."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.realtime.tyre import STANDSTILL
from tyrefem.reduced.packed_model import base_of
from tyrefem.reduced.training import Snapshots, snapshots, sources_at
from tyrefem.simulation.result import ResultData, warmed
from tyrefem.simulation.rolling_resistance import just_before
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.simulation.run import run
from tyrefem.simulation.surroundings import GAS
from tyrefem.variants.answers import answers
from tyrefem.variants.outcomes import Failed
from tyrefem.variants.schedulers import Scheduler
from tyrefem.variants.task import Bundle

Array = NDArray[np.float64]
#: Times after a jump at which the skin is taken, s; time error of these runs, K.
SKIN, SKIN_TOLERANCE = np.array([0.3, 1.0, 2.0, 4.0, 7.0, 12.0, 20.0, 35.0]), 0.05


@dataclass(frozen=True, eq=False)
class SettingTask:
    """A setting to be run in full: the study packed, its changes, and the number of fields for training."""

    packed: Bundle
    changes: Mapping[str, Any]
    fields: int = 40


@dataclass(frozen=True, eq=False)
class FullHistory:
    """What a certificate compares of a full run.

    Parameters
    ----------
    times : (n,) s. values : (n, nodes) degC. series : output -> (n,). answers : name -> value. snapshots : to learn.
    """

    times: Array
    values: Array
    series: Mapping[str, Array]
    answers: Mapping[str, Any]
    snapshots: Snapshots


def perform_history(task: SettingTask) -> FullHistory | Failed:
    """Run in a worker: a full run of a setting."""
    from tyrefem.conduction import SolverError

    base = base_of(task.packed)
    try:
        result = run(base.study.replace(task.changes), like=base)
    except (InputError, SolverError) as error:
        return Failed(str(error))
    values = np.asarray(result.history.values)
    return FullHistory(result.times, values, series_of(result), answers(result), snapshots(result, task.fields))


def perform_skin(task: SettingTask) -> Snapshots | Failed:
    """Run in a worker: fields in the first seconds of every phase."""
    from tyrefem.conduction import SolverError

    base = base_of(task.packed)
    try:
        tyre = RollingTyre(base.study.replace(task.changes), base)
        drive = tyre.drive
        after = [
            start + SKIN[0.5 * phase.duration > SKIN] for start, phase in zip(drive.starts, drive.phases, strict=True)
        ]
        times = np.unique(np.concatenate([[0.0], *after]))
        if len(times) == 1:
            # All phases are shorter than the first of these times.
            times = np.array([0.0, drive.end / 2])
        history = tyre.problem.transient(
            times, drive.initial, SKIN_TOLERANCE, breakpoints=[t for t in drive.starts[1:] if t < times[-1]]
        )
    except (InputError, SolverError) as error:
        return Failed(str(error))
    operators, fields = tyre.problem.operators, np.asarray(history.values)
    sources = [sources_at(operators, tyre, float(times[i]), fields[i]) for i in range(1, len(times), 4)]
    return Snapshots(fields[1:], np.array(sources))


def outcomes(scheduler: Scheduler, work: Any, tasks: Sequence[SettingTask], tick: Any) -> list[Any]:
    """Outcomes of tasks, in their order.

    Raises
    ------
    InputError : a run failed.
    """
    results: dict[int, Any] = {}
    for place, outcome in scheduler.outcomes(work, tasks):
        if isinstance(outcome, Failed):
            changes = ", ".join(f"{key} = {value}" for key, value in tasks[place].changes.items())
            raise InputError(f"a full run failed at {changes}: {outcome.reason}", field="vary")
        results[place] = outcome
        tick(len(results), len(tasks))
    return [results[place] for place in range(len(tasks))]


def series_of(result: ResultData) -> dict[str, Array]:
    """Outputs over the readings of a full run: name -> (n,) degC, Pa, W or N, as in `SettingTyre`.

    Gas pressure and powers at a jump are those before it.
    """
    readings, values, times = result.readings, np.asarray(result.history.values), result.times
    operators = result.tyre.problem.operators
    series: dict[str, Array] = {name: readings[name].to_numpy() for name in readings.columns if name != "time_s"}
    series[GAS] = np.asarray(result.gas_temperature)
    series["hottest"] = values.max(axis=1)
    series |= {f"{region} max": values[:, operators.dofs(region)].max(axis=1) for region in result.tyre.bodies}
    drive, gas = result.study.card.drive, series[GAS]
    cold = [drive.value("pressure", just_before(times, i)) or 0.0 for i in range(len(times))]
    series["gas_pressure"] = np.array([warmed(pressure, gas, i) for i, pressure in enumerate(cold)])
    return series | powers(result)


def powers(result: ResultData) -> dict[str, Array]:
    """Heat by region, by way out and stored, W, rolling resistance, N and 1; at a jump what was before it."""
    tyre, budget = result.tyre, result.heat_budget
    regions = {zone.title: str(zone.region) for zone in tyre.schedule.zones}
    series: dict[str, Array] = {}
    for (kind, name), power in budget.powers.items():
        key = {"generated": f"generated: {regions.get(name, name)}", "lost": f"lost: {name}"}.get(kind, kind)
        series[key] = series.get(key, np.zeros(len(result.times))) + np.asarray(power)
    speed = np.array([tyre.motion(just_before(result.times, i)).speed for i in range(len(result.times))])
    made = np.asarray(budget.power("generated"))
    left = np.asarray(budget.power("lost")) + np.asarray(budget.power("stored"))
    series |= {"generated": made, "lost and stored": left}
    force = np.divide(made, speed, out=np.zeros_like(made), where=speed >= STANDSTILL)
    load = np.array(
        [tyre.schedule.mean(lambda case: case.load, just_before(result.times, i)) for i in range(len(speed))]
    )
    coefficient = np.divide(force, load, out=np.zeros_like(force), where=load > 0)
    return series | {"rolling_resistance": force, "rolling_resistance_coefficient": coefficient}
