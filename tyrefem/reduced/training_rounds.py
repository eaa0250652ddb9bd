"""Training of a reduced model by full runs and residual corrections, in parallel."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.reduced.learnt_cycles import LearntCycles, Press, learnt, mechanical_numbers, press_count
from tyrefem.reduced.model import NotReducibleError, ReducedModel
from tyrefem.reduced.packed_model import PackedModel, pack, remember
from tyrefem.reduced.shapes import counts_of, shape_count, tyre_of, with_shapes
from tyrefem.reduced.training import ReducedFineness, Snapshots, trained
from tyrefem.reduced.training_tasks import (
    CandidateTask,
    Correction,
    CorrectionTask,
    FullRun,
    FullRunTask,
    PressTask,
    perform_corrections,
    perform_estimates,
    perform_full_run,
    perform_press,
)
from tyrefem.variants.execution import ProgressCallback
from tyrefem.variants.outcomes import Failed, NotReducible
from tyrefem.variants.plan import Plan
from tyrefem.variants.samples import changes_at
from tyrefem.variants.schedulers import Result, Scheduler
from tyrefem.variants.task import Task

Array = NDArray[np.float64]


#: Variants corrected by residuals in a round: per number that varies, and at least.
CORRECTIONS_PER_NUMBER, LEAST_CORRECTIONS = 2.0, 10


#: Variants corrected in one task: few enough to occupy several processes.
CORRECTIONS_PER_TASK = 5


#: Candidates for every place that is chosen by its estimated error; candidates in one task.
CANDIDATES, CANDIDATES_PER_TASK = 6, 32


#: Batches of presses at most. Strain cycles are learnt if their relative error times the rise of temperature is at most
#: so many times the tolerance: errors of single nodes are larger than those of the heat around them.
PRESS_BATCHES, PRESS_FACTOR = 2, 3.0


#: Times tau of the corrections over the duration of a phase, used in turn.
HORIZONS = (0.1, 0.5)


#: Sample points are stretched about the middle of the box, so that its corners need no extrapolation.
STRETCH = 1.25


def check_reducible(outcomes: Sequence[object]) -> None:
    """Raise `NotReducibleError` if the reduced model cannot follow one of the variants."""
    for outcome in outcomes:
        if isinstance(outcome, NotReducible):
            raise NotReducibleError(outcome.reason)


class Training:
    """Training of a reduced model: full runs and residual corrections give the snapshots."""

    def __init__(
        self, plan: Plan, scheduler: Scheduler, fineness: ReducedFineness, report: ProgressCallback, seed: int
    ) -> None:
        from scipy.stats import qmc

        self.plan, self.scheduler, self.fineness, self.report = plan, scheduler, fineness, report
        self.counts = counts_of(plan)
        self.base = tyre_of(plan.study, self.counts)
        remember(plan.packed, self.base)
        self.snapshots: list[Snapshots] = []
        self.cycles: LearntCycles | None = None
        self.correction_count = 0
        self.round_size = max(LEAST_CORRECTIONS, int(np.ceil(CORRECTIONS_PER_NUMBER * len(plan.varied))))
        self.sequence = qmc.Halton(len(plan.varied), seed=seed)
        #: Places of corrections -> places that repeat load cases, where these are costly.
        self.repeated: Callable[[list[Array]], list[Array]] = list

    def fresh_places(self, count: int) -> list[Array]:
        """New points of the unit box, from a Halton sequence."""
        return list(self.sequence.random(count))

    def variant(self, place: Array) -> dict[str, Any]:
        """The variant's changes at a point of the unit box."""
        return changes_at(self.plan.varied, place)

    def run(
        self, places: Sequence[Array], time_tolerance: float, what: str, with_answers: bool
    ) -> list[FullRun | Failed]:
        """Outcomes of full runs at points of the box, in order; their snapshots are added to the training."""
        tasks = [
            FullRunTask(
                Task(n, self.plan.packed, self.variant(place), self.plan.time_to),
                self.fineness.fields,
                time_tolerance,
                with_answers,
                self.counts,
            )
            for n, place in enumerate(places)
        ]
        outcomes = self._outcomes(perform_full_run, tasks, what)
        full_runs = [outcome for outcome in outcomes if isinstance(outcome, FullRun)]
        failed = [outcome for outcome in outcomes if isinstance(outcome, Failed)]
        if failed and not full_runs:
            raise NotReducibleError(f"all runs for {what} failed: {failed[0].reason}")
        self.snapshots += [outcome.snapshots for outcome in full_runs]
        return outcomes

    def correction_rounds(self, most: int, enough: float, *, search: bool = False) -> ReducedModel:
        """A model trained on corrections at new points, until the largest correction is at most ``enough`` K.

        ``search``: from the second round on, half of the points are those with the largest estimated errors of many.
        """
        for number in range(most):
            searching = search and number > 0 and self.counts is None
            model = self._trained(further=searching)
            packed = pack(model, self.plan.packed)
            places = self.repeated(self._worst(packed) if searching else self._stretched(self.round_size))
            changes = [self.variant(place) for place in places]
            shares = [HORIZONS[n % len(HORIZONS)] for n in range(len(places))]
            firsts = range(0, len(places), CORRECTIONS_PER_TASK)
            work = [
                CorrectionTask(changes[n : n + CORRECTIONS_PER_TASK], shares[n : n + CORRECTIONS_PER_TASK])
                for n in firsts
            ]
            parts = self._outcomes(perform_corrections, work, "correcting", packed)
            # A task that failed as a whole, e.g. because its process died, gives no snapshots.
            outcomes = [outcome for part in parts for outcome in ((part,) if isinstance(part, Failed) else part)]
            check_reducible(outcomes)
            corrected = [outcome for outcome in outcomes if isinstance(outcome, Correction)]
            self.snapshots += [outcome.snapshots for outcome in corrected]
            self.correction_count += len(outcomes)
            if max((outcome.largest for outcome in corrected), default=0.0) <= enough:
                break
        return self._trained(further=True)

    def _trained(self, *, further: bool) -> ReducedModel:
        return replace(trained(self.base, self.snapshots, self.fineness, further=further), cycles=self.cycles)

    def learn_cycles(self, tolerance: float) -> None:
        """Learn the strain cycles from presses, where every variant would cost one.

        Where their error would change temperatures by more than the tolerance, K, every variant is pressed.
        """
        numbers = mechanical_numbers(self.plan.study, self.plan.varied)
        if not numbers:
            return
        fields = [snapshot.fields for snapshot in self.snapshots]
        rise = max(float(np.ptp(field)) for field in fields)
        known: list[tuple[Array, Press]] = []
        for _ in range(PRESS_BATCHES):
            known += self._pressed(numbers, len(known))
            at = np.array([place[numbers] for place, _ in known])
            varied = [self.plan.varied[number] for number in numbers]
            cycles = learnt(self.base, varied, at, [press for _, press in known])
            if cycles.error * rise <= PRESS_FACTOR * tolerance:
                self.cycles = cycles
                return

    def _pressed(self, numbers: Sequence[int], known: int) -> list[tuple[Array, Press]]:
        """Presses at new places."""
        places = self._stretched(press_count(len(numbers)))
        if len(numbers) == 1:
            # Many places of a line would lie on its ends; those of the next batch lie between those of the first.
            even = np.linspace(0.0, 1.0, len(places))
            for place, part in zip(places, even if not known else (even[:-1] + even[1:]) / 2, strict=False):
                place[numbers] = part
        tasks = [PressTask(self.plan.packed, self.variant(place), self.counts) for place in places]
        outcomes = self._outcomes(perform_press, tasks, "pressing")
        pressed = [(place, press) for place, press in zip(places, outcomes, strict=True) if isinstance(press, Press)]
        if len(pressed) < len(places):
            raise NotReducibleError(next(outcome.reason for outcome in outcomes if isinstance(outcome, Failed)))
        return pressed

    def over_shapes(self, model: ReducedModel) -> ReducedModel:
        """The model with projected operators over the box's shapes, if the section varies."""
        if self.counts is None:
            return model
        studies = []
        for place in self._stretched(shape_count(self.plan.varied)):
            try:
                studies.append(self.plan.study.replace(self.variant(place)))
            except InputError:
                continue
        return with_shapes(model, studies)

    def _worst(self, packed: PackedModel) -> list[Array]:
        """New points of the unit box: half of them those with the largest estimated errors of many."""
        some = self.round_size // 2
        candidates = self._stretched(CANDIDATES * some)
        firsts = range(0, len(candidates), CANDIDATES_PER_TASK)
        tasks = [
            CandidateTask([self.variant(place) for place in candidates[n : n + CANDIDATES_PER_TASK]]) for n in firsts
        ]
        parts = self._outcomes(perform_estimates, tasks, "searching", packed)
        errors = np.concatenate([[] if isinstance(part, Failed) else part for part in parts])
        if len(errors) < len(candidates):
            return self._stretched(self.round_size)
        worst = [candidates[int(n)] for n in np.argsort(errors)[::-1][:some]]
        return worst + self._stretched(self.round_size - some)

    def _stretched(self, count: int) -> list[Array]:
        """New points of the unit box; many lie on its faces."""
        return [np.clip(0.5 + STRETCH * (place - 0.5), 0.0, 1.0) for place in self.fresh_places(count)]

    def _outcomes(
        self, work: Callable[..., Result], tasks: Sequence[Any], what: str, common: Any = None
    ) -> list[Result | Failed]:
        outcomes: dict[int, Result | Failed] = {}
        for place, outcome in self.scheduler.outcomes(work, tasks, common):
            outcomes[place] = outcome
            self.report(what, len(outcomes), len(tasks))
        return [outcomes[n] for n in range(len(tasks))]
