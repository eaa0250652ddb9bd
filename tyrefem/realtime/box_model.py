"""A certified model of all settings of a box of numbers: trained, made into arrays, compared with fresh full runs."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.errors import InputError, nearest
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.strain_laws import strain_law
from tyrefem.realtime.box_certificate import BoxCertificate, certified, is_temperature
from tyrefem.realtime.box_checks import NEEDS, check_cost, check_explored, default_tolerance, refuse_levels
from tyrefem.realtime.box_runs import SettingTask, outcomes, perform_history, perform_skin
from tyrefem.realtime.default_box import default_box
from tyrefem.realtime.drive_inputs import DriveInputs, drive_inputs
from tyrefem.realtime.few_presses import few_presses, shared_pairs
from tyrefem.realtime.number_factors import PartsProbe, number_factors, product_errors
from tyrefem.realtime.setting_arrays import rounded, setting_arrays, step_arrays
from tyrefem.realtime.setting_solution import Solution
from tyrefem.realtime.setting_tyre import SettingTyre
from tyrefem.realtime.settings import FEWEST, TablePoints
from tyrefem.realtime.tables import Probe
from tyrefem.realtime.tyre import STANDSTILL
from tyrefem.reduced.model import NotReducibleError, ReducedModel
from tyrefem.reduced.surrogate import LEAST_RUN_TOLERANCE, TRAINING_FACTOR
from tyrefem.reduced.training import ReducedFineness, trained
from tyrefem.reduced.training_rounds import Training
from tyrefem.variants.plan import Plan, plan_of
from tyrefem.variants.samples import changes_at
from tyrefem.variants.schedulers import Here, Scheduler

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
    if tolerance is not None and not (isinstance(tolerance, Real) and 0 < tolerance < math.inf):
        raise InputError(f"must be a positive number of kelvins, not {tolerance!r:.60}", field="tolerance")
    if scheduler is not None and not hasattr(scheduler, "outcomes"):
        raise InputError(f"must be Here, Local or Dask, not {scheduler!r:.60}", field="scheduler")
    if not isinstance(vary, Mapping | None):
        example = "{'drive.speed': ('10 mph', '40 mph')}"
        raise InputError(f"must be a mapping like {example}, not {vary!r:.60}", field="vary")
    plan, pair = _box(study, vary, limits, axes)
    return box_model(
        plan, axes=pair, tolerance=tolerance or default_tolerance(study), scheduler=scheduler, progress=progress
    )


def check_explore(study: StudyData) -> None:
    """Check a study's table ``[explore]`` without any run.

    Raises
    ------
    InputError : a number, range, limit or axis of the table that is not allowed.
    """
    try:
        plan, _ = _box(study, None, None, None)
        check_explored(plan, default_tolerance(study))
    except InputError as error:
        of_table = (error.field or "").partition(".")[0] in type(study.card.explore).model_fields
        raise error.within(field="explore" if of_table else None, file=study.file) from None


def _box(
    study: StudyData,
    vary: Mapping[str, Any] | None,
    limits: Mapping[str, Any] | None,
    axes: tuple[str, str] | None,
) -> tuple[Plan, tuple[str, str] | None]:
    """The plan of a box, and the axes of its envelope: as given, or of the study's ``[explore]``."""
    choice = study.card.explore
    ranges = vary or choice.vary or default_box(study)
    try:
        refuse_levels(ranges)
        plan = plan_of(
            study,
            ranges,
            limits=limits or choice.limits or None,
            sample="sobol",
            count=1,
        )
    except InputError as error:
        of_limits = (error.field or "").partition(".")[0] == "limits"
        of_study = choice.limits and not limits if of_limits else choice.vary and not vary
        raise error.within(field="explore") if of_study else error from None
    pair = axes or choice.axes
    keys = [number.key for number in plan.varied]
    if pair is not None and not (isinstance(pair, list | tuple) and len(set(pair)) == len(pair) == 2):
        raise InputError(f"must be two different numbers that vary, not {pair!r:.60}", field="axes")
    for key in pair or ():
        if key not in keys:
            raise InputError(f"'{key}' does not vary{nearest(key, keys)}", field="axes")
    return plan, pair


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
        for model, stepped, named in _models(training, tables, fineness, seed):
            tyre = SettingTyre(stepped, named)
            pairs = [(tyre.solve(numbers), full) for numbers, full in zip(settings, fresh, strict=True)]
            checked = certified(model, pairs, tolerance, len(training.snapshots), named["products"])
            if checked.worst <= tolerance:
                return BoxModel(plan, model, inputs, axes, stepped, named, checked)
        training.snapshots += [full.snapshots for full in fresh]
    raise _not_reducible(checked, tolerance)


def _models(
    training: Training, tables: _Tables, fineness: Sequence[ReducedFineness], seed: int
) -> Iterator[tuple[ReducedModel, dict[str, Any], dict[str, Any]]]:
    """Models of the snapshots, the quickest first: modes, arrays with steps, and what names the arrays."""
    for fine in fineness:
        model = trained(training.base, training.snapshots, fine)
        arrays, about = tables.arrays(model)
        for steps in FINENESSES:
            stepped = arrays | step_arrays(tables.inputs, steps)
            hottest, counts = with_hottest(model, stepped, about, tables.plan, seed)
            yield model, hottest, about | {"hot": counts}


def _not_reducible(checked: BoxCertificate, tolerance: float) -> NotReducibleError:
    """The error of the finest model, with the part that is no product of the numbers."""
    name, error = max(((n, e) for n, e in checked.errors.items() if is_temperature(n)), key=lambda pair: pair[1])
    part, off = max(checked.products.items(), key=lambda pair: pair[1], default=("", 0.0))
    hint = f"; '{part}' is no product of the numbers, by {100 * off:.2g} %" if off > 1e-3 else ""
    return NotReducibleError(
        f"the error in fresh full runs is {max(error, checked.field):.3g} K ({error:.3g} K at '{name}'); allowed: "
        f"{tolerance:g} K: choose a smaller box or a larger tolerance{hint}"
    )


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
