"""A certified model of all settings of a box of numbers: trained, made into arrays, compared with fresh full runs."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.boundaries.rim import LumpedRim
from tyrefem.brief import Brief
from tyrefem.errors import InputError, nearest
from tyrefem.estimates.work import warn_if_long
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.strain_laws import strain_law
from tyrefem.realtime.box_certificate import BoxCertificate, certified, is_temperature
from tyrefem.realtime.box_runs import SettingTask, outcomes, perform_history, perform_skin
from tyrefem.realtime.default_box import default_box
from tyrefem.realtime.drive_inputs import DriveInputs, drive_inputs
from tyrefem.realtime.few_presses import few_presses, shared_pairs
from tyrefem.realtime.number_factors import PartsProbe, number_factors, product_errors
from tyrefem.realtime.setting_arrays import rounded, setting_arrays, step_arrays
from tyrefem.realtime.setting_solution import Solution
from tyrefem.realtime.setting_tyre import SettingTyre
from tyrefem.realtime.settings import FEWEST, TablePoints
from tyrefem.realtime.suitability import check_suitable
from tyrefem.realtime.tables import Probe
from tyrefem.realtime.tyre import STANDSTILL
from tyrefem.reduced.model import NotReducibleError, ReducedModel
from tyrefem.reduced.surrogate import LEAST_RUN_TOLERANCE, TRAINING_FACTOR, check_varied
from tyrefem.reduced.training import ReducedFineness, trained
from tyrefem.reduced.training_rounds import Training
from tyrefem.requirements import Requirements
from tyrefem.simulation.estimate import RunEstimate
from tyrefem.variants.answers import highest_name
from tyrefem.variants.card import flat
from tyrefem.variants.plan import Plan, plan_of
from tyrefem.variants.samples import changes_at
from tyrefem.variants.schedulers import Here, Local, Scheduler

Array = NDArray[np.float64]
#: Error of the modes over the allowed error: the fewest modes that keep it are taken. In training: the middle.
MODES_SHARES = (0.4, 0.2, 0.1)
#: Fresh settings inside the box, and at random corners of it, that are run in full; certificates that are tried.
INSIDE, CORNERS, TRIALS = 3, 3, 3
#: Corners at which the skins just after jumps are taken.
SKINS = 8
#: Rounds of corrections before the first certificate.
ROUNDS = 3
#: Fineness of the steps that is tried, in this order.
FINENESSES = (1, 2)
#: Settings at which the places of the hottest nodes are searched.
SEARCHED = 60
#: Cost: equivalent full runs of training, certificate and search, and strain cycles by finite elements.
RUNS, CYCLES = 16.0, 20.0
#: K: footprints by finite elements differ by up to 2 % with their number of harmonics, which depends on the load.
PRESSED_TOLERANCE = 1.0
#: Requirements of an exploration on a study.
NEEDS = Requirements("an exploration")


@dataclass(frozen=True, eq=False)
class BoxModel(Brief):
    """The model of all settings of a box.

    Parameters
    ----------
    plan : the study and its varied numbers. reduced : the modes. inputs : the drive. axes : numbers of the safe
        envelope; None: load and speed. arrays, about : of `SettingTyre`.
    """

    plan: Plan
    reduced: ReducedModel
    inputs: DriveInputs
    axes: tuple[str, str] | None
    arrays: Mapping[str, Array]
    about: Mapping[str, Any]
    certificate: BoxCertificate

    def _title(self) -> str:
        return f"of {self.study.name}"

    def _facts(self) -> Mapping[str, Any]:
        return {
            "numbers": [number.key for number in self.plan.varied],
            "modes": self.reduced.size,
            "certificate": f"{self.certificate.worst:.2g} K on {self.certificate.cases} fresh full runs",
        }

    @property
    def study(self) -> StudyData:
        """The study, nominal."""
        return self.plan.study

    @functools.cached_property
    def tyre(self) -> SettingTyre:
        """The model that is marched."""
        return SettingTyre(self.arrays, self.about)

    def numbers(self, place: Sequence[float] | Array) -> Array:
        """Numbers, in their units, at a place of the unit cube."""
        return _numbers(self.plan, place)

    def solve(self, numbers: Sequence[float] | Array) -> Solution:
        """The drive at a setting."""
        return self.tyre.solve(np.asarray(numbers, dtype=float))


def explored(
    study: StudyData,
    vary: Mapping[str, Any] | None = None,
    *,
    limits: Mapping[str, Any] | None = None,
    axes: tuple[str, str] | None = None,
    tolerance: float | None = None,
    scheduler: Scheduler | None = None,
    progress: Callable[[str, int, int], None] | None = None,
) -> BoxModel:
    """A certified model of all settings of a box about a study.

    Parameters
    ----------
    vary : dotted name -> range, as in a sweep; default: the study's ``[explore]``, else `default_box`. limits : answer
        -> below, above. axes : numbers of the safe envelope. tolerance : K, of every temperature in the certificate.

    Raises
    ------
    InputError : a number, range, limit or axis that is not allowed; a campaign; a study that does not go with a model
        in real time. NotReducibleError : the tolerance was not reached.
    """
    NEEDS.check(study)
    choice = study.card.explore
    ranges = vary or choice.vary or default_box(study)
    try:
        _refuse_levels(ranges)
        plan = plan_of(
            study,
            ranges,
            limits=limits or choice.limits or None,
            sample="sobol",
            count=1,
        )
    except InputError as error:
        raise error if vary or not choice.vary else error.within(field="explore") from None
    pair = axes or choice.axes
    keys = [number.key for number in plan.varied]
    if pair is not None and not (isinstance(pair, list | tuple) and len(set(pair)) == len(pair) == 2):
        raise InputError(f"must be two different numbers that vary, not {pair!r:.60}", field="axes")
    for key in pair or ():
        if key not in keys:
            raise InputError(f"'{key}' does not vary{nearest(key, keys)}", field="axes")
    return box_model(
        plan, axes=pair, tolerance=tolerance or default_tolerance(study), scheduler=scheduler, progress=progress
    )


def _refuse_levels(ranges: Mapping[str, Any]) -> None:
    """Raise `InputError` for levels of a range: a slider has all its values."""
    for key, entry in flat(dict(ranges)).items():
        if (isinstance(entry, tuple) and len(entry) == 3) or (isinstance(entry, Mapping) and "levels" in entry):
            raise InputError("a slider has no levels: give FROM:TO alone", field=f"vary.{key}")


def default_tolerance(study: StudyData) -> float:
    """Allowed error of the temperatures, K: that of the study's ``[explore]``; else 0.3, or `PRESSED_TOLERANCE`.

    >>> import tyrefem
    >>> [default_tolerance(tyrefem.study(name)) for name in ("nasa-22x5.5-8pr", "passenger-205-55r16")]
    [0.3, 1.0]
    """
    choice = study.card.explore
    chosen = "tolerance" in choice.model_fields_set
    return PRESSED_TOLERANCE if strain_law(study).by_elements and not chosen else choice.tolerance


def box_model(
    plan: Plan,
    *,
    axes: tuple[str, str] | None = None,
    tolerance: float = 0.3,
    scheduler: Scheduler | None = None,
    points: TablePoints | None = None,
    seed: int = 7,
    progress: Callable[[str, int, int], None] | None = None,
) -> BoxModel:
    """Train a model of all settings of a plan's box, and certify it on fresh full runs.

    Parameters
    ----------
    plan : its `varied` spans the box. axes : see `BoxModel`. tolerance : K, of every temperature in the fresh runs.
    points : of the tables.

    Raises
    ------
    InputError : the study or a number does not go with a model in real time. NotReducibleError : the tolerance was not
        reached.
    """
    report = progress or (lambda what, done, total: None)
    scheduler = scheduler or Here()
    check_explored(plan, tolerance)
    check_cost(plan.study, scheduler)
    inputs = drive_inputs(plan.study, plan.varied)
    fineness = [ReducedFineness.of(share * tolerance) for share in MODES_SHARES]
    training = Training(plan, scheduler, fineness[1], report, seed)
    rng = np.random.default_rng(1000 + seed)
    count = len(plan.varied)
    ends = [np.zeros(count), np.ones(count)]
    few = few_presses(plan, rng) if strain_law(plan.study).by_elements else None
    if few is not None:
        training.repeated = few.repeated
    training.run(ends, TRAINING_FACTOR * max(tolerance, LEAST_RUN_TOLERANCE), "training", with_answers=False)
    corners = [*ends, *training.repeated(list(np.round(rng.random((SKINS, count)))))]
    tasks = [SettingTask(plan.packed, training.variant(place)) for place in corners]
    training.snapshots += outcomes(scheduler, perform_skin, tasks, lambda done, total: report("skins", done, total))
    tables = _Tables(training, inputs, points or (None if few is None else FEWEST), few is not None)
    for trial in range(TRIALS):
        if trial and few is not None and points is None:
            tables = _Tables(training, inputs, None, True)
        training.correction_rounds(1 if trial else ROUNDS, MODES_SHARES[1] * tolerance)
        places = [*rng.random((INSIDE, count)), *np.round(rng.random((CORNERS, count)))]
        fresh = outcomes(
            scheduler,
            perform_history,
            [SettingTask(plan.packed, training.variant(place)) for place in places],
            lambda done, total: report("certifying", done, total),
        )
        settings = [_numbers(plan, place) for place in places]
        for fine in fineness:
            model = trained(training.base, training.snapshots, fine)
            arrays, about = tables.arrays(model)
            for steps in FINENESSES:
                stepped, counts = with_hottest(model, arrays | step_arrays(inputs, steps), about, plan, seed)
                named = about | {"hot": counts}
                tyre = SettingTyre(stepped, named)
                pairs = [(tyre.solve(numbers), full) for numbers, full in zip(settings, fresh, strict=True)]
                checked = certified(model, pairs, tolerance, len(training.snapshots), about["products"])
                if checked.worst <= tolerance:
                    return BoxModel(plan, model, inputs, axes, stepped, named, checked)
        training.snapshots += [full.snapshots for full in fresh]
    name, error = max(((n, e) for n, e in checked.errors.items() if is_temperature(n)), key=lambda pair: pair[1])
    part, off = max(checked.products.items(), key=lambda pair: pair[1], default=("", 0.0))
    hint = f"; '{part}' is no product of the numbers, by {100 * off:.2g} %" if off > 1e-3 else ""
    raise NotReducibleError(
        f"the error in fresh full runs is {max(error, checked.field):.3g} K ({error:.3g} K at '{name}'); allowed: "
        f"{tolerance:g} K: choose a smaller box or a larger tolerance{hint}"
    )


#: What a slider can move.
POSSIBLE = (
    "Sliders move speed, load, pressure, ambient, road_temperature and initial of the drive or of a phase; "
    "loss_tangent, conductivity, specific_heat and density of materials.REGION; numbers of the laws in boundaries"
)


def check_explored(plan: Plan, tolerance: float) -> None:
    """Raise `InputError` if a plan's box cannot be explored."""
    NEEDS.check(plan.study)
    check_suitable(plan.study)
    for number in plan.varied:
        table, last = number.key.split(".")[0], number.key.rpartition(".")[2]
        field = f"vary.{number.key}"
        if number.values:
            raise InputError(
                f"a list has no slider: give a range or a factor, or make a page of each. {POSSIBLE}", field=field
            )
        if last == "duration":
            raise InputError(f"a duration has no slider: all settings share their times. {POSSIBLE}", field=field)
        if table in ("section", "mesh", "output", "numerics", "mechanics"):
            raise InputError(f"has no slider: it needs another mesh or other strain cycles. {POSSIBLE}", field=field)
    check_varied(plan)
    known = limited_answers(plan.study)
    for name in plan.limits:
        if name not in known:
            words = f"'{name}' is an answer of a sweep only, a page does not compute it; allowed: {', '.join(known)}"
            raise InputError(words, field="limits")
    if tolerance < plan.study.tolerance:
        raise InputError(
            f"{tolerance:g} K is less than the time error of the full runs; must be at least numerics.tolerance, "
            f"{plan.study.tolerance:g} K",
            field="tolerance",
        )


def limited_answers(study: StudyData) -> list[str]:
    """Names of the answers that a limit may have: those of `setting_solution`.

    >>> import tyrefem
    >>> limited_answers(tyrefem.study("nasa-22x5.5-8pr"))[:3]
    ['hottest_degC', 'carcass_max_degC', 'bead_max_degC']
    """
    regions = study.section.regions
    return [
        "hottest_degC",
        *(f"{region}_max_degC" for region in regions),
        *(name for sensor in study.sensors for name in (f"{sensor}_degC", highest_name(sensor, regions))),
        *(["rim_degC"] if isinstance(study.card.boundaries.rim, LumpedRim) else []),
        *("contained-air_degC", "gas_pressure_Pa", "rolling_resistance_N", "rolling_resistance_coefficient"),
    ]


def check_cost(study: StudyData, scheduler: Scheduler) -> None:
    """Raise `InputError` if the parallel runs do not fit in memory; warn of long work."""
    run, workers = RunEstimate.of(study), getattr(scheduler, "workers", 1)
    if isinstance(scheduler, Here | Local):
        run.check(workers)

    def seconds(run: RunEstimate) -> float:
        return (RUNS * run.transient_run.time + CYCLES * run.mechanics.time) / workers

    warn_if_long(seconds(run), f"exploring {study.name}", lambda: run.quick_look(seconds))


def _numbers(plan: Plan, place: Sequence[float] | Array) -> Array:
    """Numbers, in their units, at a place of the unit cube."""
    return np.array([number.number(float(u)) for number, u in zip(plan.varied, place, strict=True)])


class _Tables:
    """What a box's models have in common: tables of films and strain energy, and the study in the middle.

    ``costly``: the workers solve the load cases of the tables.
    """

    def __init__(self, training: Training, inputs: DriveInputs, points: TablePoints | None, costly: bool) -> None:
        self.plan, self.inputs = training.plan, inputs
        report = training.report
        report("tables", 0, 1)
        changes = changes_at(self.plan.varied, [0.5] * len(self.plan.varied))
        self.middle = self.plan.study.replace(changes)
        self.probe = Probe(self.middle, inputs.box(), training.base, points)
        shared = shared_pairs(
            training.scheduler, self.plan.packed, changes, inputs.box(), functools.partial(report, "tables")
        )
        self.tables = self.probe.tables(shared if costly else None)
        report("tables", 1, 1)
        phases = inputs.at((inputs.low + inputs.high) / 2)[0]
        self.stands = bool((phases[:, :, 0].max(axis=1) < STANDSTILL).any())

    def arrays(self, model: ReducedModel) -> tuple[dict[str, Any], dict[str, Any]]:
        """Arrays of a model without steps, and what names them."""
        varied, middle = self.plan.varied, self.middle
        parts = PartsProbe(model, self.probe.box, self.tables.axes["speed"] ** 2, self.stands)
        factors = number_factors(parts, middle, varied)
        arrays, about = setting_arrays(model, self.inputs, varied, self.probe, self.tables, factors)
        return rounded(arrays), about | {"products": product_errors(parts, middle, varied, factors)}


def with_hottest(
    model: ReducedModel, arrays: Mapping[str, Array], about: Mapping[str, Any], plan: Plan, seed: int
) -> tuple[dict[str, Any], list[tuple[str, int]]]:
    """The arrays with rows of the nodes that are the hottest of their region somewhere; region -> number of them."""
    turn = arrays["turn"][: model.size, : model.size]
    rows = {region: model.V[dofs] @ turn for region, dofs in model.regions.items()}
    chosen: dict[str, set[int]] = {region: set() for region in rows}
    tyre = SettingTyre({**arrays, "hot": np.zeros((0, model.size))}, {**about, "hot": []})
    settings = np.random.default_rng(2000 + seed).random((SEARCHED, len(plan.varied)))
    settings[: SEARCHED // 2] = np.round(settings[: SEARCHED // 2])
    for place in settings:
        states = tyre.solve(_numbers(plan, place)).states
        for region, of_region in rows.items():
            chosen[region] |= set((of_region @ states[1:, : model.size].T).argmax(axis=0).tolist())
    order = {region: sorted(numbers) for region, numbers in chosen.items()}
    hot = np.vstack([rows[region][numbers] for region, numbers in order.items()])
    nodes = np.concatenate([model.regions[region][numbers] for region, numbers in order.items()])
    counts = [(region, len(numbers)) for region, numbers in order.items()]
    return {**arrays, **rounded({"hot": hot}), "hot_nodes": nodes}, counts
