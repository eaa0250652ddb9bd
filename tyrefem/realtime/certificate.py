"""Training of a real-time model on full runs of drives in its box, and its certificate on validation runs."""

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
from tyrefem.inputs.origin import StudyOrigin
from tyrefem.inputs.study import StudyData
from tyrefem.realtime.export import arrays_of, outputs_of, write
from tyrefem.realtime.inputs import NAMES, PART, Box, BoxDrive, box_of, random_drive, steady
from tyrefem.realtime.settings import ExportSettings
from tyrefem.realtime.suitability import check_suitable
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
class DriveTask:
    """A drive to be run in full, for snapshots and for comparison with the real-time model.

    Parameters
    ----------
    packed : the study. drive : the inputs over time. every : interval of the readings, s. fields : snapshots to take.
    """

    packed: Bundle
    drive: BoxDrive
    every: float
    fields: int


@dataclass(frozen=True, eq=False)
class RealTimeCertificate:
    """Largest differences between the real-time model, stepped by 1 s, and full runs that were not used in training.

    Parameters
    ----------
    steady, driven : output -> K, or N, for steady inputs and for drives of steps and ramps. worst : of all
    temperatures, K. tolerance : allowed difference, K. cases : validation runs of either kind. trained_on : number of
    training runs. duration : of every drive, s. tables : largest relative error of films and of heat sources between
    the points of the tables.
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
class DriveRun:
    """Snapshots and outputs of a full run of a drive.

    Parameters
    ----------
    snapshots : fields and heat sources. hot : nodes that are the hottest at some time. times : of the readings, (n,) s.
    answers : output -> (n,) degC, or N.
    """

    snapshots: Snapshots
    hot: NDArray[np.intp]
    times: Array
    answers: Mapping[str, Array]


class LastTyre(threading.local):
    """The tyre that this thread ran last; the next run reuses the parts that are the same."""

    tyre: RollingTyre | None = None


_last = LastTyre()


def perform_drive(task: DriveTask) -> DriveRun | Failed:
    """Run in a worker: a full run of a drive."""
    from tyrefem.conduction import SolverError

    try:
        study = task.drive.study(unpacked(task.packed), task.every)
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
    return DriveRun(snapshots(result, task.fields), np.unique(values.argmax(axis=1)), result.times, answers)


def differences(tyre: RealTimeTyre, drive: BoxDrive, full: DriveRun, step: float = 1.0) -> dict[str, float]:
    """Output -> largest difference to a full run, K or N, at the readings that lie on whole steps."""
    tyre.reset(drive.initial)
    times, answers = full.times, full.answers
    due = {round(float(t) / step): i for i, t in enumerate(times) if abs(t / step - round(t / step)) < 1e-6 and t > 0}
    worst = dict.fromkeys(answers, 0.0)
    for number in range(1, max(due) + 1):
        outputs = tyre.step(step, *drive.inputs((number - 1) * step, number * step))
        if number not in due:
            continue
        i = due[number]
        for name, value in zip(tyre.names, outputs, strict=True):
            # At a jump the full run gives the heat before it and the speed after it.
            if name in answers and (name != "rolling_resistance" or not drive.jumps(number * step)):
                worst[name] = max(worst[name], abs(float(value) - float(answers[name][i])))
    return worst


def certificate(
    errors: Sequence[Mapping[str, float]], tolerance: float, trained: int, duration: float, tables: dict[str, float]
) -> RealTimeCertificate:
    """The certificate from errors of steady drives (first half) and of random drives (second half)."""
    half = len(errors) // 2
    kinds = [{name: max(error[name] for error in part) for name in part[0]} for part in (errors[:half], errors[half:])]
    worst = max(error for kind in kinds for name, error in kind.items() if name != "rolling_resistance")
    return RealTimeCertificate(
        kinds[0], kinds[1], worst, tolerance, (half, len(errors) - half), trained, duration, tables
    )


#: Requirements of a real-time model on a study.
NEEDS = Requirements("a real-time model")


#: Cost: equivalent full runs of one phase, strain cycles by finite elements for the tables, and s of stepping per s of
#: a drive (8PR at 12 and 3 mm, drives of 60 to 20 000 s: 0.8 to 1.2 times the measured time).
RUNS, CYCLES, STEPPING = 25.0, 10.0, 2e-3


#: Readings of a full run at most.
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
    path : ``.npz`` file. ranges : input -> (from, to), see `box_of`. tolerance : K, of every temperature in the
    validation runs. duration : of all drives, s; default: duration of the study's drive. settings : numbers of the
    method.

    Raises
    ------
    InputError : the study is a campaign; the tyre cannot carry a load of the box; a reduced model cannot follow the
        study; the tolerance was not reached, or is below `numerics.tolerance`; drives shorter than a second; the memory
        is too small.
    """
    NEEDS.check(study)
    check_suitable(study)
    report = progress or (lambda what, done, total: None)
    scheduler, settings = scheduler or Here(), settings or ExportSettings()
    if tolerance < study.tolerance:
        raise InputError(
            f"{tolerance:g} K is less than the time error of the full runs; must be at least numerics.tolerance, "
            f"{study.tolerance:g} K",
            field="tolerance",
        )
    box, horizon = box_of(study, ranges), float(study.card.drive.end if duration is None else duration)
    # Differences are taken at whole seconds.
    if not horizon >= 1:
        raise InputError(f"{horizon:g} s is too short for drives: must be a second or more", field="duration")
    report("tables", 0, 1)
    try:
        training = _Training(study, box, horizon, settings, report, scheduler)
    except InputError as refused:
        raise _of_box(refused, ranges or {}) from None
    report("tables", 1, 1)
    seed, count = settings.seed, settings.fresh
    cube = np.random.default_rng(seed).random((settings.rounds * count, 5))
    drives = [steady(box, place, horizon) for place in _corners()]
    drives += [random_drive(box, horizon, 1000 * seed + k) for k in range(settings.training)]
    runs, between = training.full(drives, "training"), training.tables.errors(training.probe)
    for number in range(settings.rounds):
        arrays = training.model(runs)
        fresh = [steady(box, place, horizon) for place in cube[number * count : (number + 1) * count]]
        fresh += [random_drive(box, horizon, 2000 * seed + number * count + k) for k in range(count)]
        full = training.full(fresh, "certifying")
        about = training.about()
        with tempfile.TemporaryDirectory() as folder:
            tyre = RealTimeTyre(write(Path(folder) / "tyre.npz", arrays, about))
        errors = [differences(tyre, drive, history) for drive, history in zip(fresh, full, strict=True)]
        checked = certificate(errors, tolerance, len(runs), horizon, between)
        if checked.worst <= tolerance:
            write(path, arrays, {**about, "certificate": vars(checked)})
            return checked
        runs += full
    name, error = max(
        ((n, e) for history in errors for n, e in history.items() if n != "rolling_resistance"), key=_second
    )
    raise NotReducibleError(
        f"after {checked.trained_on} training runs the error in the validation runs is {error:.3g} K at '{name}'; "
        f"allowed: {tolerance:g} K: choose a smaller box or a larger tolerance"
    )


def _second(pair: tuple[str, float]) -> float:
    return pair[1]


def _corners() -> list[Array]:
    """The middle of the box, its warmest and its coldest corner."""
    warm = np.array([name != "pressure" for name in NAMES], dtype=float)
    return [np.full(5, 0.5), warm, 1 - warm]


def _of_box(error: InputError, given: Mapping[str, Any]) -> InputError:
    """The error of a drive within the box with its input as field: no file has the phases of such a drive."""
    field = error.field or ""
    if not field.startswith(f"drive.phases.{PART}"):
        return error
    name = field.rpartition(".")[2]
    if name == "deflection":
        name = "pressure" if "pressure" in given and "load" not in given else "load"
    return InputError(error.message, field=name)


@dataclass(eq=False)
class _Training:
    study: StudyData
    box: Box
    horizon: float
    settings: ExportSettings
    report: Callable[[str, int, int], None]
    scheduler: Scheduler

    def __post_init__(self) -> None:
        self.every = max(1.0, float(np.ceil(self.horizon / READINGS)))
        middle = steady(self.box, np.full(5, 0.5), self.horizon).study(self.study, self.every)
        self._check_cost(middle)
        self.base = RollingTyre(middle)
        self.probe = Probe(self.study, self.box, self.base, self.settings.points)
        self.tables = self.probe.tables()
        self.packed = bundle(self.study)

    def _check_cost(self, study: StudyData) -> None:
        """Raise `InputError` if the parallel runs do not fit in memory; warn of long work."""
        run, workers = RunEstimate.of(study), getattr(self.scheduler, "workers", 1)
        if isinstance(self.scheduler, Here | Local):
            run.check(workers)

        def seconds(run: RunEstimate) -> float:
            return RUNS * run.transient_run.time / workers + CYCLES * run.mechanics.time + STEPPING * self.horizon

        what = f"training and certifying a real-time model of {self.study.name}"
        estimate.warn_if_long(seconds(run), what, lambda: run.quick_look(seconds))

    def full(self, drives: Sequence[BoxDrive], what: str) -> list[DriveRun]:
        """Full runs of drives, in their order."""
        tasks = [DriveTask(self.packed, drive, self.every, self.settings.fineness.fields) for drive in drives]
        runs: dict[int, DriveRun] = {}
        for place, outcome in self.scheduler.outcomes(perform_drive, tasks):
            if isinstance(outcome, Failed):
                raise InputError(f"a full run failed: {outcome.reason}")
            runs[place] = outcome
            self.report(what, len(runs), len(tasks))
        return [runs[place] for place in range(len(tasks))]

    def model(self, runs: Sequence[DriveRun]) -> dict[str, Any]:
        """Arrays of a model trained on full runs."""
        snapshot_sets = [run.snapshots for run in runs]
        none = np.zeros((0, snapshot_sets[0].fields.shape[1]))
        self.reduced = trained(
            self.base, [*snapshot_sets, Snapshots(none, self._sources(snapshot_sets))], fineness=self.settings.fineness
        )
        hot = np.unique(np.concatenate([run.hot for run in runs]))
        return arrays_of(self.reduced, self.probe, self.tables, hot)

    def _sources(self, snapshot_sets: Sequence[Snapshots]) -> Array:
        """Heat sources at all loads and pressures of the tables, for a cold, a medium and a hot field."""
        ends = np.array([snapshot_set.fields[-1] for snapshot_set in snapshot_sets])
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
            ramp, value = getattr(phase, name), (low + high) / 2
            if ramp is None and name == "road_temperature":
                road = self.study.card.boundaries.road.temperature
                value = phase.ambient.start if road is None else road
            start[name] = min(max(value if ramp is None else ramp.start, low), high)
        return start

    def about(self) -> dict[str, Any]:
        """Data about the model for the file: what made it, box, outputs, start values."""
        balance = reduced_balance(self.reduced, self.base)
        made_by = StudyOrigin(self.study, simulated=True, random_seed=self.settings.seed)
        return made_by.summary() | {
            "box": {name: list(self.box.ranges[name]) for name in NAMES},
            "outputs": outputs_of(self.study, balance),
            "initial": self.study.card.drive.initial,
            "start": self._start(),
            "modes": self.reduced.size,
        }
