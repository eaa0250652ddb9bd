"""A reduced model for a box of variants: trained, and used only after validation on fresh full runs."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from tyrefem.brief import Brief
from tyrefem.errors import InputError
from tyrefem.inputs.changes import all_changed, value_at
from tyrefem.inputs.study import StudyData
from tyrefem.reduced.answers import ReducedOutcome, reduced_answers
from tyrefem.reduced.learnt_balance import learnt_inputs
from tyrefem.reduced.model import NotReducibleError, ReducedModel
from tyrefem.reduced.packed_model import PackedModel, pack
from tyrefem.reduced.shapes import shape_numbers
from tyrefem.reduced.training import ReducedFineness
from tyrefem.reduced.training_rounds import Training, check_reducible
from tyrefem.reduced.training_tasks import FullRun
from tyrefem.variants.execution import ProgressCallback, SweepSettings
from tyrefem.variants.outcomes import Answered, Failed, NotReducible
from tyrefem.variants.plan import Plan
from tyrefem.variants.samples import changes_at
from tyrefem.variants.schedulers import Here, Scheduler
from tyrefem.variants.task import Bundle
from tyrefem.variants.varied import Varied

#: Time error of the training runs over the wanted tolerance: snapshots may be coarse, validation runs may not.
TRAINING_FACTOR = 100.0
#: K: smallest time error of a full run.
LEAST_RUN_TOLERANCE = 1e-3
#: K: smallest tolerance of a certificate; full runs differ by more from each other.
LEAST_TOLERANCE = 1e-6
#: The rounds end when the largest correction over the tolerance is at most this; the error left is a part of it.
CORRECTION_FACTOR = 1.0
#: Largest error of the validation runs over the tolerance: a few runs do not show the worst case.
SAFETY = 0.8


#: Share of the tolerance for the modes where the shape varies: the rest is left to the difference of the meshes.
SHAPES_SHARE = 0.5


#: Tables of a study that do not affect temperatures.
IRRELEVANT_TABLES = ("title", "measured", "cases", "diagnosis", "uncertainty", "explore")


@dataclass(frozen=True, eq=False)
class SurrogateCertificate(Brief):
    """Errors of a reduced model in validation runs: full runs that were not used in training.

    Parameters
    ----------
    errors : answer -> largest difference to the validation runs, of those in which both have a number: a time that is
        not reached has none. cases : number of validation runs.
    worst : largest error of any temperature answer, K. tolerance : allowed error, K. trained_on : number of successful
        training runs and corrections. amended : number of corrections. own_mesh : where shapes share a mesh, the
        largest error of any temperature answer against runs on the variants' own meshes, K. meshes : largest difference
        of full runs on both, K. energies : relative error of the strain energies, where they are learnt from presses.
    """

    errors: Mapping[str, float]
    cases: int
    worst: float
    tolerance: float
    trained_on: int
    amended: int = 0
    own_mesh: float | None = None
    meshes: float = 0.0
    energies: float | None = None

    def error_of(self, estimate: float | None) -> float:
        """Error of a variant's temperatures, K: its estimate, the difference of the meshes, and with learnt strain
        energies the largest error in the validation runs, which pressed. Without an estimate that error alone."""
        if estimate is None:
            return self.error
        return estimate + self.meshes + (0.0 if self.energies is None else self.worst)

    @property
    def good(self) -> bool:
        """Is the largest error at most `SAFETY` x tolerance, and against runs on own meshes at most the tolerance?"""
        return self.worst <= SAFETY * self.tolerance and (self.own_mesh or 0.0) <= self.tolerance

    @property
    def error(self) -> float:
        """Largest error of any temperature answer in the validation runs, K."""
        return max(self.worst, self.own_mesh or 0.0)


@dataclass(frozen=True, eq=False)
class Surrogate(Brief):
    """A certified reduced model and the box of variants in which it is valid."""

    model: ReducedModel
    varied: tuple[Varied, ...]
    certificate: SurrogateCertificate
    time_to: float | None = None

    def _title(self) -> str:
        return self.model._title()

    def _facts(self) -> Mapping[str, Any]:
        certificate = self.certificate
        return {
            **self.model._facts(),
            "varied": [each.label for each in self.varied],
            "certificate": f"{certificate.error:.2g} K on {certificate.cases} fresh full runs, "
            f"{certificate.tolerance:g} K wanted",
        }

    def packed(self, base: Bundle) -> PackedModel:
        """The model packed for other processes; ``base``: the study that it was made for."""
        return pack(self.model, base)

    def answers(self, studies: Sequence[StudyData]) -> list[ReducedOutcome]:
        """The outcomes of studies, in their order.

        A study outside the box, or with a difference that the box does not vary, gives `NotReducible`.
        """
        reasons = [why_outside(study, self.model.base.study, self.varied) for study in studies]
        answered: list[ReducedOutcome] = [NotReducible(why) for why in reasons]
        inside = [number for number, why in enumerate(reasons) if not why]
        outcomes = reduced_answers(self.model, [studies[number] for number in inside], self.time_to)
        for number, outcome in zip(inside, outcomes, strict=True):
            answered[number] = outcome
        return answered


def why_outside(study: StudyData, base: StudyData, varied: Sequence[Varied]) -> str:
    """Why a study is outside the box around a base study; empty: the study is inside."""
    for number in varied:
        try:
            value, *others = (value_at(study.data, key, study.folder) for key in number.keys)
        except InputError as error:
            return str(error)
        if not number.contains(value):
            return f"'{number.key}' = {value!r} is outside the box of the reduced model"
        beside = number.keys[1:]
        if not number.together(value, dict(zip(beside, others, strict=True))):
            return f"'{beside[0]}' does not change with '{number.key}', as the reduced model assumes"
    same = changes_at(varied, [0.5] * len(varied))
    study_data, base_data = (all_changed(each.data, same) for each in (study, base))
    for key in dict.fromkeys([*study_data, *base_data]):
        if key not in IRRELEVANT_TABLES and study_data.get(key) != base_data.get(key):
            name = next((f"{key}.{k}" for k in _keys(study_data, base_data, key)), key)
            return f"'{name}' differs from the study that the reduced model was made for"
    return ""


def _keys(study_data: Mapping[str, Any], base_data: Mapping[str, Any], key: str) -> list[str]:
    first, second = study_data.get(key), base_data.get(key)
    if not isinstance(first, Mapping) or not isinstance(second, Mapping):
        return []
    return [k for k in dict.fromkeys([*first, *second]) if first.get(k) != second.get(k)]


def temperature_error(first: Mapping[str, Any], second: Mapping[str, Any]) -> float:
    """Largest difference between the temperature answers of two variants, K."""
    return max(
        (abs(first[name] - second[name]) for name in first if name.endswith("_degC") and name in second), default=0.0
    )


def surrogate(
    plan: Plan,
    *,
    tolerance: float = 0.01,
    scheduler: Scheduler | None = None,
    fineness: ReducedFineness | None = None,
    seed: int = 7,
    progress: ProgressCallback | None = None,
    settings: SweepSettings | None = None,
) -> Surrogate:
    """Train a reduced model for a plan's box, and validate it on fresh full runs.

    Parameters
    ----------
    plan : its `varied` defines the box. tolerance : K, of every temperature answer of the validation runs.
    settings : numbers of validation runs, certificates and rounds of corrections.

    Raises
    ------
    NotReducibleError : a reduced model cannot follow what the box varies, or the tolerance was not reached.
    """
    settings = settings or SweepSettings()
    check_varied(plan)
    if tolerance < LEAST_TOLERANCE:
        raise NotReducibleError(
            f"no reduced model is certified to {tolerance:g} K; allowed: {LEAST_TOLERANCE:g} K or more"
        )
    report = progress or (lambda what, done, total: None)
    if fineness is None:
        fineness = ReducedFineness.of(SHAPES_SHARE * tolerance if shape_numbers(plan.varied) else tolerance)
    training = Training(plan, scheduler or Here(), fineness, report, seed)
    # Full runs at two opposite corners; residual corrections cover the rest of the box.
    places = [np.zeros(len(plan.varied)), np.ones(len(plan.varied))]
    training.run(places, TRAINING_FACTOR * max(tolerance, LEAST_RUN_TOLERANCE), "training", with_answers=False)
    training.learn_cycles(tolerance)
    certificate: SurrogateCertificate | None = None
    for trial in range(settings.trials):
        rounds = 1 if trial else settings.rounds
        model = training.correction_rounds(rounds, CORRECTION_FACTOR * tolerance, search=True)
        model = training.over_shapes(model)
        places = training.fresh_places(settings.fresh)
        known = len(training.snapshots)
        full_runs = training.run(
            places, min(plan.study.tolerance, max(tolerance, LEAST_RUN_TOLERANCE)), "certifying", with_answers=True
        )
        reduced = answers_of_changes(model, plan, [training.variant(place) for place in places])
        check_reducible(reduced)
        certificate = _certificate(training, reduced, full_runs, tolerance, known)
        if certificate.good:
            model = replace(model, inputs=learnt_inputs(model, plan.varied, len(plan.variants)))
            return Surrogate(model, plan.varied, certificate, plan.time_to)
    assert certificate is not None
    if certificate.worst <= SAFETY * tolerance:
        raise NotReducibleError(
            f"the shapes' common mesh and their own meshes differ by {certificate.own_mesh:.3g} K; allowed:"
            f" {tolerance:g} K; a smaller mesh.size brings them together"
        )
    raise NotReducibleError(
        f"after {certificate.amended} corrections the error in the validation runs is {certificate.worst:.3g} K;"
        f" allowed: {SAFETY:g} x {tolerance:g} K"
    )


def answers_of_changes(model: ReducedModel, plan: Plan, variants: Sequence[Mapping[str, Any]]) -> list[ReducedOutcome]:
    """The outcomes of variants, given by their changes; two numbers may fit alone but not together: `Failed`."""
    studies: dict[int, StudyData] = {}
    outcomes: dict[int, ReducedOutcome] = {}
    for number, changes in enumerate(variants):
        try:
            studies[number] = plan.study.replace(changes)
        except InputError as error:
            outcomes[number] = Failed(str(error))
    outcomes |= zip(studies, reduced_answers(model, list(studies.values()), plan.time_to), strict=True)
    return [outcomes[number] for number in range(len(variants))]


def _certificate(
    training: Training, reduced: Sequence[ReducedOutcome], full_runs: Sequence[object], tolerance: float, known: int
) -> SurrogateCertificate:
    """The reduced answers against the full runs of the same variants; ``known``: snapshots of the model."""
    both = [
        (reduced_outcome.answers, full_run)
        for reduced_outcome, full_run in zip(reduced, full_runs, strict=True)
        if isinstance(reduced_outcome, Answered) and isinstance(full_run, FullRun)
    ]
    if not both:
        raise NotReducibleError("all validation runs failed")
    pairs = [(answered, full_run.answers) for answered, full_run in both]
    on_own_mesh = [(answered, full_run.own_answers) for answered, full_run in both if full_run.own_answers is not None]
    return replace(
        certified(pairs, tolerance, known, training.correction_count, on_own_mesh),
        meshes=between_meshes(full_runs),
        energies=None if training.cycles is None else training.cycles.error,
    )


#: Answers of the reduced model and of a full run.
Pair = tuple[Mapping[str, Any], Mapping[str, Any]]


def between_meshes(full_runs: Sequence[object]) -> float:
    """Largest difference of temperature answers between full runs on the common and on their own meshes, K."""
    runs = [run for run in full_runs if isinstance(run, FullRun) and run.own_answers is not None]
    return max((temperature_error(run.answers, run.own_answers or {}) for run in runs), default=0.0)


def certified(
    pairs: Sequence[Pair], tolerance: float, trained_on: int, amended: int, on_own_mesh: Sequence[Pair] = ()
) -> SurrogateCertificate:
    """The certificate from pairs of answers (reduced model, full run); ``on_own_mesh``: on the variants' meshes."""
    names = [name for name, value in pairs[0][1].items() if isinstance(value, float)]
    gaps = {name: [abs(a[name] - b[name]) for a, b in (*pairs, *on_own_mesh) if {name} <= a.keys() & b.keys()]
            for name in names}  # fmt: skip
    known = {name: list(filter(math.isfinite, each)) for name, each in gaps.items()}
    errors = {name: max(each) for name, each in known.items() if each}
    worst = max(temperature_error(a, b) for a, b in pairs)
    own_mesh = max((temperature_error(a, b) for a, b in on_own_mesh), default=None)
    return SurrogateCertificate(errors, len(pairs), worst, tolerance, trained_on, amended, own_mesh)


def check_varied(plan: Plan) -> None:
    """Raise `NotReducibleError` if a plan varies the mesh's fineness, or needs strain cycles that change in a run."""
    if not plan.varied:
        raise NotReducibleError("variants from a list span no box for training")
    for number in plan.varied:
        for key in number.keys:
            if key.split(".")[0] in ("mesh", "output", "numerics"):
                raise NotReducibleError(f"'{key}' changes the mesh or the numerical precision")
    if plan.study.card.mechanics.feedback is not None:
        raise NotReducibleError("strain cycles that follow the temperature need full runs")
