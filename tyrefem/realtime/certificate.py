"""A real-time model trained on full runs of drives in its box, and certified on fresh ones.

Full runs that a real-time model learns from and is examined by.
"""

from __future__ import annotations

import tempfile
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.estimates import work as estimate
from tyrefem.inputs.study import StudyData
from tyrefem.output import versions
from tyrefem.realtime.export import arrays_of, outputs_of, write
from tyrefem.realtime.inputs import NAMES, Box, Course, box_of, random_course, steady
from tyrefem.realtime.settings import ExportSettings
from tyrefem.realtime.tables import Probe
from tyrefem.realtime.tyre import STANDSTILL, RealTimeTyre
from tyrefem.reduced.balance import reduced_balance
from tyrefem.reduced.model import NotReducibleError
from tyrefem.reduced.training import Snapshots, snapshots, trained
from tyrefem.requirements import Requirements
from tyrefem.simulation.estimate import RunEstimate
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.simulation.run import run
from tyrefem.variants.outcomes import Failed
from tyrefem.variants.schedulers import Here, Local, Scheduler
from tyrefem.variants.task import Bundle, bundle, unpacked

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Exam:
    """A drive to be run in full: what it teaches, and what a real-time model has to answer."""

    packed: Bundle
    course: Course
    every: float
    fields: int


@dataclass(frozen=True, eq=False)
class RealTimeCertificate:
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


@dataclass(frozen=True, eq=False)
class ExamRun:
    """What a full run of an exam's drive says.

    Parameters
    ----------
    snapshots : what it teaches. hot : nodes that are the hottest at some time. times : of its readings, (n,) s.
    answers : output -> (n,) degC, or N.
    """

    snapshots: Snapshots
    hot: NDArray[np.intp]
    times: Array
    answers: Mapping[str, Array]


class LastTyre(threading.local):
    """The tyre that a thread ran last, from which the next run takes what is the same; every thread has its own."""

    tyre: RollingTyre | None = None


_last = LastTyre()


def sit(exam: Exam) -> ExamRun | Failed:
    """Done in a worker: run the drive of an exam in full."""
    from tyrefem.conduction import SolverError

    try:
        study = exam.course.study(unpacked(exam.packed), exam.every)
        result = run(study, like=_last.tyre)
    except (InputError, SolverError) as error:
        return Failed(str(error))
    _last.tyre = result.tyre
    readings, values = result.readings, np.asarray(result.history.values)
    columns = {name: readings[name].to_numpy() for name in readings.columns if name != "time_s"}
    speed = np.array([result.tyre.motion(t).speed for t in result.times])
    power = result.heat_budget.power("generated")
    # A ramp to rest may end at a speed of rounding.
    resistance = np.divide(power, speed, out=np.zeros_like(power), where=speed >= STANDSTILL)
    answers = columns | {"hottest": values.max(axis=1), "rolling_resistance": resistance}
    return ExamRun(snapshots(result, exam.fields), np.unique(values.argmax(axis=1)), result.times, answers)


def differences(tyre: RealTimeTyre, course: Course, full: ExamRun, step: float = 1.0) -> dict[str, float]:
    """Output -> largest difference to a full run, at its readings on whole steps, K or N."""
    tyre.reset(course.initial)
    times, answers = full.times, full.answers
    due = {round(float(t) / step): i for i, t in enumerate(times) if abs(t / step - round(t / step)) < 1e-6 and t > 0}
    worst = dict.fromkeys(answers, 0.0)
    for number in range(1, max(due) + 1):
        outputs = tyre.step(step, *course.inputs((number - 1) * step, number * step))
        if number not in due:
            continue
        i = due[number]
        for name, value in zip(tyre.names, outputs, strict=True):
            # At a jump the heat of the full run is that before it, its speed that after it.
            if name in answers and (name != "rolling_resistance" or not course.jumps(number * step)):
                worst[name] = max(worst[name], abs(float(value) - float(answers[name][i])))
    return worst


def certificate(
    errors: Sequence[Mapping[str, float]], tolerance: float, trained: int, duration: float, tables: dict[str, float]
) -> RealTimeCertificate:
    """Of errors of steady drives, the first half, and of changing ones."""
    half = len(errors) // 2
    kinds = [
        {name: max(course[name] for course in part) for name in part[0]} for part in (errors[:half], errors[half:])
    ]
    worst = max(error for kind in kinds for name, error in kind.items() if name != "rolling_resistance")
    return RealTimeCertificate(
        kinds[0], kinds[1], worst, tolerance, (half, len(errors) - half), trained, duration, tables
    )


#: What a real-time model needs of a study.
NEEDS = Requirements("a real-time model")


#: What it costs: full runs of drives of several phases in runs of one, strain cycles by finite elements for the tables,
#: s of stepping per s of a drive (8PR at 12 and 3 mm, drives of 60 to 20 000 s: 0.8 to 1.2 times what was measured).
RUNS, CYCLES, STEPPING = 25.0, 10.0, 2e-3


#: Readings of a full run at most: the longer the drive, the rarer.
READINGS = 900


def export(
    study: StudyData,
    path: str | Path,
    *,
    ranges: Mapping[str, tuple[Any, Any]] | None = None,
    tolerance: float = 0.2,
    duration: float | None = None,
    scheduler: Scheduler | None = None,
    progress: Callable[[str, int, int], None] | None = None,
    settings: ExportSettings | None = None,
) -> RealTimeCertificate:
    """Train a real-time model of a study, certify it, and write it to one file.

    Parameters
    ----------
    path : ``.npz`` file. ranges : input -> (from, to), see `box_of`. tolerance : K, of every temperature of fresh full
    runs. duration : of the drives it learns from and is certified with, s; that of the study's drive.
    settings : numbers of the method.

    Raises
    ------
    InputError : a campaign; the box holds loads that the tyre cannot carry; a study that a reduced model cannot follow;
        the tolerance was not reached, or is less than the study's own; more than there is memory for.
    """
    NEEDS.check(study)
    if study.card.mechanics.feedback is not None:
        raise InputError("a real-time model has no feedback of temperature on the strain cycle", field="mechanics")
    tick = progress or (lambda what, done, total: None)
    scheduler, settings = scheduler or Here(), settings or ExportSettings()
    if tolerance < study.tolerance:
        raise InputError(
            f"{tolerance:g} K is less than the time error of the full runs themselves: must be at least "
            f"numerics.tolerance, {study.tolerance:g} K",
            field="tolerance",
        )
    box, horizon = box_of(study, ranges), float(duration or study.card.drive.end)
    tick("tables", 0, 1)
    tool = _Tool(study, box, horizon, settings, tick, scheduler)
    tick("tables", 1, 1)
    seed, count = settings.seed, settings.fresh
    cube = np.random.default_rng(seed).random((settings.rounds * count, 5))
    courses = [steady(box, place, horizon) for place in _corners()]
    courses += [random_course(box, horizon, 1000 * seed + k) for k in range(settings.learn)]
    learnt, between = tool.full(courses, "training"), tool.tables.errors(tool.probe)
    for number in range(settings.rounds):
        arrays = tool.model(learnt)
        fresh = [steady(box, place, horizon) for place in cube[number * count : (number + 1) * count]]
        fresh += [random_course(box, horizon, 2000 * seed + number * count + k) for k in range(count)]
        full = tool.full(fresh, "certifying")
        about = tool.about()
        with tempfile.TemporaryDirectory() as folder:
            tyre = RealTimeTyre(write(Path(folder) / "tyre.npz", arrays, about))
        errors = [differences(tyre, course, history) for course, history in zip(fresh, full, strict=True)]
        checked = certificate(errors, tolerance, len(learnt), horizon, between)
        if checked.worst <= tolerance:
            write(path, arrays, {**about, "certificate": vars(checked)})
            return checked
        learnt += full
    name, error = max(
        ((n, e) for history in errors for n, e in history.items() if n != "rolling_resistance"), key=_second
    )
    raise NotReducibleError(
        f"after {checked.trained_on} full runs fresh ones still differ by {error:.3g} K at '{name}'; allowed: "
        f"{tolerance:g} K: a smaller box or a larger tolerance"
    )


def _second(pair: tuple[str, float]) -> float:
    return pair[1]


def _corners() -> list[Array]:
    """The middle; all that warms together, and all that cools."""
    warm = np.array([name != "pressure" for name in NAMES], dtype=float)
    return [np.full(5, 0.5), warm, 1 - warm]


@dataclass(eq=False)
class _Tool:
    study: StudyData
    box: Box
    horizon: float
    settings: ExportSettings
    tick: Callable[[str, int, int], None]
    scheduler: Scheduler

    def __post_init__(self) -> None:
        self.every = max(1.0, float(np.ceil(self.horizon / READINGS)))
        middle = steady(self.box, np.full(5, 0.5), self.horizon).study(self.study, self.every)
        self._expect(middle)
        self.base = RollingTyre(middle)
        self.probe = Probe(self.study, self.box, self.base, self.settings.points)
        self.tables = self.probe.tables()
        self.packed = bundle(self.study)

    def _expect(self, study: StudyData) -> None:
        """Refuse full runs that do not fit side by side in memory; warn of long work."""
        run, workers = RunEstimate.of(study), getattr(self.scheduler, "workers", 1)
        if isinstance(self.scheduler, Here | Local):
            run.check(workers)
        seconds = RUNS * run.transient_run.time / workers + CYCLES * run.mechanics.time + STEPPING * self.horizon
        estimate.warn_if_long(seconds, f"training and certifying a real-time model of {self.study.name}")

    def full(self, courses: Sequence[Course], what: str) -> list[ExamRun]:
        """Full runs of drives."""
        exams = [Exam(self.packed, course, self.every, self.settings.fineness.fields) for course in courses]
        runs: dict[int, ExamRun] = {}
        for place, outcome in self.scheduler.outcomes(sit, exams):
            if isinstance(outcome, Failed):
                raise InputError(f"a full run failed: {outcome.reason}")
            runs[place] = outcome
            self.tick(what, len(runs), len(exams))
        return [runs[place] for place in range(len(exams))]

    def model(self, learnt: Sequence[ExamRun]) -> dict[str, Any]:
        """Arrays of a model of what was learnt."""
        taught = [run.snapshots for run in learnt]
        none = np.zeros((0, taught[0].fields.shape[1]))
        self.reduced = trained(
            self.base, [*taught, Snapshots(none, self._sources(taught))], fineness=self.settings.fineness
        )
        hot = np.unique(np.concatenate([run.hot for run in learnt]))
        return arrays_of(self.reduced, self.probe, self.tables, hot)

    def _sources(self, taught: Sequence[Snapshots]) -> Array:
        """Heat sources at all loads and pressures of the tables, at a cold, a middling and a hot field."""
        ends = np.array([lesson.fields[-1] for lesson in taught])
        order = np.argsort(ends.max(axis=1))
        ops, sources = self.base.problem.operators, []
        for field in ends[[order[0], order[len(order) // 2], order[-1]]]:
            laws = [source.loss_tangent(field[ops.dofs(zone)]) for zone, source in self.base.hysteresis.items()]
            sources.append(self.tables.heat.reshape(-1, self.tables.heat.shape[-1]) * np.concatenate(laws))
        return np.vstack(sources)

    def _start(self) -> dict[str, float]:
        """The study's inputs at its start, within the box."""
        phase, start = self.study.card.drive.phases[0], {}
        for name in NAMES:
            low, high = self.box.ranges[name]
            ramp = getattr(phase, name) or (phase.ambient if name == "road_temperature" else None)
            start[name] = min(max((low + high) / 2 if ramp is None else ramp.start, low), high)
        return start

    def about(self) -> dict[str, Any]:
        """What the file says of itself."""
        balance = reduced_balance(self.reduced, self.base)
        return {
            "study": self.study.name,
            "title": self.study.title,
            "box": {name: list(self.box.ranges[name]) for name in NAMES},
            "outputs": outputs_of(self.study, balance),
            "initial": self.study.card.drive.initial,
            "start": self._start(),
            "modes": self.reduced.size,
            "versions": versions(),
        }
