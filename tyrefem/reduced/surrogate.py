"""A reduced model for a box of variants: trained, tried on fresh full runs, and only then used."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.reduced.batch import Batch
from tyrefem.reduced.model import NotReducibleError, ReducedModel
from tyrefem.reduced.train import Fineness, Snapshots, snapshots, source_snapshots, trained
from tyrefem.reduced.work import Packed
from tyrefem.result import Result
from tyrefem.rolling import RollingTyre, output_times, run
from tyrefem.studies import Study
from tyrefem.sweep.answers import answers
from tyrefem.sweep.bundle import Bundle
from tyrefem.sweep.plan import Plan
from tyrefem.sweep.schedulers import Here, Scheduler
from tyrefem.sweep.task import Task, unpacked
from tyrefem.sweep.varied import Varied

Array = NDArray[np.float64]
#: Variants marched side by side.
SIDE_BY_SIDE = 64
#: Full runs to begin with per number that varies, and at least; fresh ones to certify with; rounds at most.
PER_NUMBER, LEAST, FRESH, ROUNDS = 1.5, 5, 4, 3
#: Time error of the training runs over the study's: snapshots need not be that good, certification is.
COARSER = 20.0
#: Variants whose heat sources are looked at without running them.
SOURCES = 24


@dataclass(frozen=True, eq=False)
class Lesson:
    """Work of a training run: the answers and snapshots of one variant."""

    task: Task
    fields: int
    coarser: float = 1.0


def learn(lesson: Lesson) -> dict[str, Any]:
    """Done in a worker: ``{"snapshots", "answers"}`` or ``{"failure"}``."""
    from tyrefem.conduction import SolverError

    task = lesson.task
    try:
        study = unpacked(task.packed).replace(task.changes)
        if lesson.coarser > 1:
            study = study.replace({"numerics.tolerance": f"{study.tolerance * lesson.coarser:.6g} delta_degC"})
        result = run(study)
        return {"snapshots": snapshots(result, lesson.fields), "answers": answers(result, task.time_to)}
    except (InputError, SolverError) as error:
        return {"failure": str(error)}


@dataclass(frozen=True, eq=False)
class Certificate:
    """What fresh full runs say of a reduced model.

    Parameters
    ----------
    errors : answer -> largest difference to full runs that it had not learnt from. cases : how many of them.
    worst : largest error of any temperature answer, K. tolerance : what was asked for, K. trained_on : full runs.
    """

    errors: Mapping[str, float]
    cases: int
    worst: float
    tolerance: float
    trained_on: int

    @property
    def good(self) -> bool:
        """Is it within the tolerance?"""
        return self.worst <= self.tolerance


@dataclass(frozen=True, eq=False)
class Surrogate:
    """A certified reduced model and the box it may be used in."""

    model: ReducedModel
    varied: tuple[Varied, ...]
    certificate: Certificate
    time_to: float | None = None

    def packed(self, base: Bundle) -> Packed:
        """To be sent to other processes; ``base`` is the study it was made for."""
        return Packed(base, self.model.V, self.model.samples, self.model.nodes_from_samples)

    def answers(self, studies: Sequence[Study]) -> list[dict[str, Any]]:
        """Outcomes of variants, marched side by side; one that cannot be reduced says so in ``not_reducible``."""
        return reduced_answers(self.model, studies, self.time_to)


def reduced_answers(model: ReducedModel, studies: Sequence[Study], time_to: float | None) -> list[dict[str, Any]]:
    """``{"answers"}``, ``{"failure"}`` or ``{"not_reducible"}`` per study."""
    found: list[dict[str, Any]] = [{} for _ in studies]
    groups: dict[Any, list[tuple[int, Any]]] = {}
    for number, study in enumerate(studies):
        tyre = RollingTyre(study, model.base)
        try:
            balance = model.balance(tyre)
        except NotReducibleError as error:
            found[number] = {"not_reducible": str(error)}
        except InputError as error:
            found[number] = {"failure": str(error)}
        else:
            key = tyre.drive.starts, tyre.drive.end, tuple(balance.reservoirs)
            groups.setdefault(key, []).append((number, balance))
    for members in groups.values():
        for first in range(0, len(members), SIDE_BY_SIDE):
            part = members[first : first + SIDE_BY_SIDE]
            marched = Batch(model, [balance for _, balance in part]).march()
            for place, (number, balance) in enumerate(part):
                tyre = balance.tyre
                times, fields = output_times(tyre)
                result = Result(tyre.study, tyre, marched.history(place, times), fields, 0.0)
                found[number] = {"answers": answers(result, time_to)}
    return found


def temperature_error(one: Mapping[str, Any], other: Mapping[str, Any]) -> float:
    """Largest difference of two variants' temperature answers, K."""
    return max((abs(one[name] - other[name]) for name in one if name.endswith("_degC") and name in other), default=0.0)


def surrogate(
    plan: Plan,
    *,
    tolerance: float = 0.01,
    scheduler: Scheduler | None = None,
    choice: Fineness | None = None,
    seed: int = 7,
    progress: Callable[[str, int, int], None] | None = None,
) -> Surrogate:
    """Train a reduced model for a plan's box, and try it on fresh full runs.

    Parameters
    ----------
    plan : its `varied` says which box. tolerance : K, of every temperature answer of the fresh runs.

    Raises
    ------
    NotReducibleError : the box varies what a reduced model cannot follow, or the tolerance was not reached.
    """
    if not plan.varied:
        raise NotReducibleError("variants from a list have no box to train in")
    for one in plan.varied:
        if one.key.split(".")[0] in ("section", "mesh", "output", "numerics"):
            raise NotReducibleError(f"'{one.key}' changes the mesh or the numbers' precision")
    scheduler, choice = scheduler or Here(), choice or Fineness()
    tick = progress or (lambda what, done, total: None)
    from scipy.stats import qmc

    count = max(int(np.ceil(PER_NUMBER * len(plan.varied))) + 2, LEAST)
    base = RollingTyre(plan.study)
    cube = qmc.Halton(len(plan.varied), seed=seed).random(count + ROUNDS * FRESH + SOURCES)
    training, rest = [*_corners(len(plan.varied)), *cube[:count]], list(cube[count:])
    # Learnt points are stretched to the faces of the box: inside is then interpolation.
    training = [np.clip(0.5 + 1.15 * (place - 0.5), 0.0, 1.0) for place in training]

    def variant(place: Array) -> dict[str, Any]:
        return {one.key: one.at(float(u)) for one, u in zip(plan.varied, place, strict=True)}

    def taught(places: Sequence[Array], coarser: float, what: str) -> list[dict[str, Any]]:
        lessons = [
            Lesson(Task(n, plan.packed, variant(place), plan.time_to), choice.fields, coarser)
            for n, place in enumerate(places)
        ]
        outcomes: dict[int, dict[str, Any]] = {}
        for place, outcome in scheduler.outcomes(learn, lessons):
            outcomes[place] = outcome
            tick(what, len(outcomes), len(lessons))
        found = [outcomes[n] for n in range(len(lessons)) if "failure" not in outcomes[n]]
        if not found:
            raise NotReducibleError(f"no training run succeeded: {outcomes[0].get('failure')}")
        return found

    learnt: list[Snapshots] = [one["snapshots"] for one in taught(training, COARSER, "training")]
    certificate: Certificate | None = None
    for _ in range(ROUNDS):
        fresh, rest = rest[:FRESH], rest[FRESH:]
        more = _more_sources(plan, base, variant, rest[-SOURCES:], learnt)
        model = trained(base, learnt, more, choice)
        full = taught(fresh, 1.0, "certifying")
        studies = [plan.study.replace(variant(place)) for place in fresh]
        outcomes = reduced_answers(model, studies, plan.time_to)
        refused = next((one["not_reducible"] for one in outcomes if "not_reducible" in one), None)
        if refused is not None:
            raise NotReducibleError(refused)
        pairs = [(a["answers"], b["answers"]) for a, b in zip(outcomes, full, strict=True) if "answers" in a]
        errors = {
            name: max(abs(a[name] - b[name]) for a, b in pairs)
            for name in pairs[0][1]
            if isinstance(pairs[0][1][name], float)
        }
        worst = max(temperature_error(a, b) for a, b in pairs)
        certificate = Certificate(errors, len(pairs), worst, tolerance, len(learnt))
        if certificate.good:
            return Surrogate(model, plan.varied, certificate, plan.time_to)
        learnt += [one["snapshots"] for one in full]
    assert certificate is not None
    raise NotReducibleError(
        f"after {certificate.trained_on} training runs fresh ones are still off by {certificate.worst:.3g} K;"
        f" allowed: {tolerance:g} K"
    )


def _corners(count: int) -> list[Array]:
    """The middle, and the two opposite corners."""
    return [np.full(count, 0.5), np.zeros(count), np.ones(count)]


def _more_sources(
    plan: Plan,
    base: RollingTyre,
    variant: Callable[[Array], Mapping[str, Any]],
    places: Sequence[Array],
    learnt: Sequence[Snapshots],
) -> Array | None:
    """Heat sources of further variants at the hottest and the coldest end fields that were learnt."""
    ends = np.array([one.fields[-1] for one in learnt])
    order = np.argsort(ends.max(axis=1))
    likely = ends[[order[0], order[len(order) // 2], order[-1]]]
    found = []
    for place in places:
        try:
            tyre = RollingTyre(plan.study.replace(variant(place)), base)
            found.append(source_snapshots(tyre, likely))
        except InputError:
            continue
    return np.vstack(found) if found else None
