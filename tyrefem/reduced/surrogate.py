"""A reduced model for a box of variants: trained, tried on fresh full runs, and only then used."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.inputs.changes import all_changed, value_at
from tyrefem.inputs.study import StudyData
from tyrefem.reduced.answers import ReducedOutcome, reduced_answers
from tyrefem.reduced.model import NotReducibleError, ReducedModel
from tyrefem.reduced.training import ReducedFineness
from tyrefem.reduced.training_rounds import Learnt, Packed, School, Tick, check_reducible, pack
from tyrefem.variants.execution import SweepSettings
from tyrefem.variants.outcomes import Answered, NotReducible
from tyrefem.variants.plan import Plan
from tyrefem.variants.samples import changes_at
from tyrefem.variants.schedulers import Here, Scheduler
from tyrefem.variants.task import Bundle
from tyrefem.variants.varied import Varied

Array = NDArray[np.float64]
#: Time error of the training runs over the wanted tolerance: snapshots need not be good, certification is.
COARSER = 100.0
#: K: no full run is asked for a smaller time error. What is to be nearer than that fails for a reason.
FINEST = 1e-3
#: K: the full runs that a certificate compares with do not agree so well among themselves, whatever is learnt.
HOPELESS = 1e-6
#: Largest correction of a round over the tolerance that ends the rounds: what is left is a fraction of it.
ENOUGH = 1.0
#: Share of the tolerance that the fresh runs may take up: the few of them do not show the worst case.
SAFETY = 0.8


#: Tables of a study that no temperature depends on.
UNSEEN = ("title", "measured", "cases", "diagnosis", "uncertainty")


@dataclass(frozen=True, eq=False)
class SurrogateCertificate(Brief):
    """What fresh full runs say of a reduced model.

    Parameters
    ----------
    errors : answer -> largest difference to full runs that it had not learnt from. cases : how many of them.
    worst : largest error of any temperature answer, K. tolerance : what was asked for, K. trained_on : full runs, or
        what is left of them where some failed, and corrections. amended : corrections alone.
    """

    errors: Mapping[str, float]
    cases: int
    worst: float
    tolerance: float
    trained_on: int
    amended: int = 0

    @property
    def good(self) -> bool:
        """Is it within the tolerance, with some room?"""
        return self.worst <= SAFETY * self.tolerance


@dataclass(frozen=True, eq=False)
class Surrogate(Brief):
    """A certified reduced model and the box it may be used in."""

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
            "varied": [each.key for each in self.varied],
            "certificate": f"{certificate.worst:.2g} K on {certificate.cases} fresh full runs, "
            f"{certificate.tolerance:g} K wanted",
        }

    def packed(self, base: Bundle) -> Packed:
        """To be sent to other processes; ``base`` is the study it was made for."""
        return pack(self.model, base)

    def answers(self, studies: Sequence[StudyData]) -> list[ReducedOutcome]:
        """What becomes of studies, marched side by side; one is `NotReducible` outside the box, or where it differs in
        something that the box does not vary."""
        reasons = [outside(study, self.model.base.study, self.varied) for study in studies]
        answered: list[ReducedOutcome] = [NotReducible(why) for why in reasons]
        inside = [number for number, why in enumerate(reasons) if not why]
        outcomes = reduced_answers(self.model, [studies[number] for number in inside], self.time_to)
        for number, outcome in zip(inside, outcomes, strict=True):
            answered[number] = outcome
        return answered


def outside(study: StudyData, base: StudyData, varied: Sequence[Varied]) -> str:
    """Why a study is not in a box about another; empty: it is."""
    for number in varied:
        value = value_at(study.data, number.key, study.folder)
        if not number.contains(value):
            return f"'{number.key}' = {value!r} is outside the box of the reduced model"
        if not number.together(value, {key: value_at(study.data, key, study.folder) for key, _ in number.also}):
            return f"'{number.also[0][0]}' does not follow '{number.key}', as it did for the reduced model"
    same = changes_at(varied, [0.5] * len(varied))
    mine, theirs = (all_changed(each.data, same) for each in (study, base))
    for key in dict.fromkeys([*mine, *theirs]):
        if key not in UNSEEN and mine.get(key) != theirs.get(key):
            name = next((f"{key}.{k}" for k in _keys(mine, theirs, key)), key)
            return f"'{name}' is not what it was in the study that the reduced model was made for"
    return ""


def _keys(mine: Mapping[str, Any], theirs: Mapping[str, Any], key: str) -> list[str]:
    first, second = mine.get(key), theirs.get(key)
    if not isinstance(first, Mapping) or not isinstance(second, Mapping):
        return []
    return [k for k in dict.fromkeys([*first, *second]) if first.get(k) != second.get(k)]


def temperature_error(first: Mapping[str, Any], second: Mapping[str, Any]) -> float:
    """Largest difference of two variants' temperature answers, K."""
    return max(
        (abs(first[name] - second[name]) for name in first if name.endswith("_degC") and name in second), default=0.0
    )


def surrogate(
    plan: Plan,
    *,
    tolerance: float = 0.01,
    scheduler: Scheduler | None = None,
    choice: ReducedFineness | None = None,
    seed: int = 7,
    progress: Tick | None = None,
    settings: SweepSettings | None = None,
) -> Surrogate:
    """Train a reduced model for a plan's box, and try it on fresh full runs.

    Parameters
    ----------
    plan : its `varied` says which box. tolerance : K, of every temperature answer of the fresh runs.
    settings : how many fresh runs, certificates and rounds of corrections.

    Raises
    ------
    NotReducibleError : the box varies what a reduced model cannot follow, or the tolerance was not reached.
    """
    settings = settings or SweepSettings()
    check_varied(plan)
    if tolerance < HOPELESS:
        raise NotReducibleError(f"no reduced model is certified to {tolerance:g} K; allowed: {HOPELESS:g} K or more")
    tick = progress or (lambda what, done, total: None)
    lesson = School(plan, scheduler or Here(), choice or ReducedFineness.of(tolerance), tick, seed)
    # Two opposite corners: the rest of the box is learnt from residuals.
    places = [np.zeros(len(plan.varied)), np.ones(len(plan.varied))]
    lesson.run(places, COARSER * max(tolerance, FINEST), "training", with_answers=False)
    certificate: SurrogateCertificate | None = None
    for trial in range(settings.trials):
        model = lesson.rounds(1 if trial else settings.rounds, ENOUGH * tolerance)
        places = lesson.fresh(settings.fresh)
        known = len(lesson.learnt)
        full = lesson.run(places, min(plan.study.tolerance, max(tolerance, FINEST)), "certifying", with_answers=True)
        reduced = reduced_answers(model, [plan.study.replace(lesson.variant(place)) for place in places], plan.time_to)
        check_reducible(reduced)
        pairs = [
            (mine.answers, theirs.answers)
            for mine, theirs in zip(reduced, full, strict=True)
            if isinstance(mine, Answered) and isinstance(theirs, Learnt)
        ]
        if not pairs:
            raise NotReducibleError("no run to certify with succeeded")
        certificate = certified(pairs, tolerance, known, lesson.amended)
        if certificate.good:
            return Surrogate(model, plan.varied, certificate, plan.time_to)
    assert certificate is not None
    raise NotReducibleError(
        f"after {certificate.amended} corrections fresh runs are still off by {certificate.worst:.3g} K;"
        f" allowed: {SAFETY:g} x {tolerance:g} K"
    )


def certified(
    pairs: Sequence[tuple[Mapping[str, Any], Mapping[str, Any]]], tolerance: float, trained_on: int, amended: int
) -> SurrogateCertificate:
    """The certificate of pairs (reduced, full) of answers."""
    names = [name for name, value in pairs[0][1].items() if isinstance(value, float)]
    errors = {name: max(abs(a[name] - b[name]) for a, b in pairs) for name in names}
    worst = max(temperature_error(a, b) for a, b in pairs)
    return SurrogateCertificate(errors, len(pairs), worst, tolerance, trained_on, amended)


def check_varied(plan: Plan) -> None:
    """Raise `NotReducibleError` where what a plan varies cannot be followed on one mesh."""
    if not plan.varied:
        raise NotReducibleError("variants from a list have no box to train in")
    for number in plan.varied:
        if number.key.split(".")[0] in ("section", "mesh", "output", "numerics"):
            raise NotReducibleError(f"'{number.key}' changes the mesh or the numbers' precision")
    if plan.study.card.mechanics.feedback is not None:
        raise NotReducibleError("strain cycles that follow the temperature")
