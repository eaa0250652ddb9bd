"""Full runs that a real-time model learns from and is examined by."""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from tyrefem.errors import InputError
from tyrefem.realtime import STANDSTILL, RealTimeTyre
from tyrefem.reduced.driving import Course
from tyrefem.reduced.train import snapshots
from tyrefem.rolling import run
from tyrefem.sweep.bundle import Bundle
from tyrefem.sweep.task import unpacked


@dataclass(frozen=True, eq=False)
class Exam:
    """A drive to be run in full: what it teaches, and what a real-time model has to answer."""

    packed: Bundle
    course: Course
    every: float
    fields: int


@dataclass(frozen=True, eq=False)
class Certificate:
    """Largest differences between the real-time model, stepped by 1 s, and full runs that it had not learnt from.

    Parameters
    ----------
    steady, driven : output -> K, or N, under steady inputs and under drives of steps and ramps. worst : of all
    temperatures, K. tolerance : what was asked for, K. cases : fresh runs of either kind. trained_on : full runs.
    duration : of every drive, s. tables : largest error of a film and of a heat source between the tables' points,
    over the largest there.
    """

    steady: Mapping[str, float]
    driven: Mapping[str, float]
    worst: float
    tolerance: float
    cases: tuple[int, int]
    trained_on: int
    duration: float
    tables: Mapping[str, float]


_last = threading.local()


def sit(exam: Exam) -> dict[str, Any]:
    """Done in a worker: ``{"snapshots", "hot", "times", "answers"}`` or ``{"failure"}``."""
    from tyrefem.conduction import SolverError

    try:
        study = exam.course.study(unpacked(exam.packed), exam.every)
        result = run(study, like=getattr(_last, "tyre", None))
    except (InputError, SolverError) as error:
        return {"failure": str(error)}
    _last.tyre = result.tyre
    readings, values = result.readings, np.asarray(result.history.values)
    columns = {name: readings[name].to_numpy() for name in readings.columns if name != "time_s"}
    speed = np.array([study.card.drive.value("speed", t) for t in result.times])
    power = result.heat_budget.power("generated")
    # A ramp to rest may end at a speed of rounding.
    resistance = np.divide(power, speed, out=np.zeros_like(power), where=speed >= STANDSTILL)
    return {
        "snapshots": snapshots(result, exam.fields),
        "hot": np.unique(values.argmax(axis=1)),
        "times": result.times,
        "answers": columns | {"hottest": values.max(axis=1), "rolling_resistance": resistance},
    }


def differences(tyre: RealTimeTyre, course: Course, full: Mapping[str, Any], step: float = 1.0) -> dict[str, float]:
    """Output -> largest difference to a full run, at its readings on whole steps, K or N."""
    tyre.reset(course.initial)
    times, answers = full["times"], full["answers"]
    due = {round(float(t) / step): i for i, t in enumerate(times) if abs(t / step - round(t / step)) < 1e-6 and t > 0}
    worst = dict.fromkeys(answers, 0.0)
    for number in range(1, max(due) + 1):
        found = tyre.step(step, *course.inputs((number - 1) * step, number * step))
        if number not in due:
            continue
        i = due[number]
        for name, value in zip(tyre.names, found, strict=True):
            # At a jump the heat of the full run is that before it, its speed that after it.
            if name in answers and (name != "rolling_resistance" or not course.jumps(number * step)):
                worst[name] = max(worst[name], abs(float(value) - float(answers[name][i])))
    return worst


def certificate(
    errors: Sequence[Mapping[str, float]], tolerance: float, trained: int, duration: float, tables: dict[str, float]
) -> Certificate:
    """Of errors of steady drives, the first half, and of changing ones."""
    half = len(errors) // 2
    kinds = [{name: max(one[name] for one in part) for name in part[0]} for part in (errors[:half], errors[half:])]
    worst = max(error for kind in kinds for name, error in kind.items() if name != "rolling_resistance")
    return Certificate(kinds[0], kinds[1], worst, tolerance, (half, len(errors) - half), trained, duration, tables)
