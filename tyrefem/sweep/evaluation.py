"""Evaluation of variants by a certified reduced model or by full runs; finished variants are stored.

`VariantEvaluation` evaluates the numbered variants of a plan, `Evaluator` the successive variants of a search.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from tyrefem.brief import counted
from tyrefem.estimates import work as estimate
from tyrefem.simulation.estimate import RunEstimate
from tyrefem.sweep.reduced_tasks import by_model
from tyrefem.variants.blocks import Numbers, PackedOutcomes
from tyrefem.variants.execution import Execution
from tyrefem.variants.outcome_table import OutcomeTable
from tyrefem.variants.outcomes import Failed, Outcome
from tyrefem.variants.plan import Plan
from tyrefem.variants.samples import chosen
from tyrefem.variants.schedulers import Here, Local
from tyrefem.variants.store import Store
from tyrefem.variants.task import Task, perform, perform_all
from tyrefem.variants.task_list import TaskList

if TYPE_CHECKING:
    from tyrefem.reduced.surrogate import Surrogate, SurrogateCertificate

#: With fewer variants than this per varied number, training would cost as much as full runs.
WORTH_TRAINING = 12


#: Name of the note with the reduced model's certificate in a sweep's folder.
CERTIFICATE = "certificate"


class VariantEvaluation:
    """Evaluates variants of a study by number.

    Parameters
    ----------
    plan : the study, its varied numbers (the box of a reduced model), and ``time_to``.
    execution : see `Execution`. variants : number -> changes. digest : identifies what the folder's outcomes belong to.

    ``outcomes``: number -> `Answered` or `Failed`; packed, and beyond some size only in the folder.
    ``certificate``: of the reduced model. ``reduced``: is it used? ``why_full``: reason if it is not.
    ``resumed``: number of outcomes that the folder had.
    """

    #: Word before the number of variants in the warning of long work.
    at_most = ""

    def __init__(self, plan: Plan, execution: Execution, variants: Sequence[Mapping[str, Any]], digest: str) -> None:
        self.plan, self.execution, self.variants = plan, execution, variants
        self.outcomes = OutcomeTable()
        self.certificate: SurrogateCertificate | None = None
        self.why_full = ""
        self.resumed = 0
        self.reduced = False
        self._digest = digest
        self._model: Surrogate | None = None
        self._store: Store | None = None

    def __enter__(self) -> Self:
        """Open the folder.

        Raises
        ------
        InputError : the folder holds outcomes of another plan, or cannot be written.
        """
        if self.execution.folder is not None:
            self._store = Store(
                self.execution.folder, f"{self._digest}-{self.execution.reduced}-{self.execution.tolerance:g}"
            )
            self.resumed = self._store.open(restart=self.execution.restart)
            self.certificate = _certificate(self._store.notes.get(CERTIFICATE))
            self._take_up(self._store)
        return self

    def __exit__(self, *_: object) -> None:
        if self._store is not None:
            self._store.close()

    def _take_up(self, store: Store) -> None:
        """Take the outcomes of the folder: the store holds them for both."""
        self.outcomes = store.outcomes

    def train(self, expected: int) -> None:
        """Train a reduced model if it is allowed, worth its cost, and certified within the tolerance.

        If the folder has its certificate, the model is trained again only when variants are missing.

        Raises
        ------
        NotReducibleError : ``reduced`` is ``always``, and no model could be certified.
        """
        self._check_cost(expected)
        if self.execution.reduced == "never":
            return
        if not self._trains(expected):
            self.why_full = f"{counted(expected, 'variant')} {'is' if expected == 1 else 'are'} too few to train for"
            return
        self.reduced = True
        if self.certificate is None:
            self._train_model()

    def _trains(self, expected: int) -> bool:
        """Is a reduced model allowed and worth its training?"""
        enough = WORTH_TRAINING * max(len(self.plan.varied), 1)
        return self.execution.reduced == "always" or (self.execution.reduced == "auto" and expected >= enough)

    def _check_cost(self, expected: int) -> None:
        """Raise `InputError` if the parallel runs do not fit in memory; warn of long work."""
        where, run = self.execution.where, RunEstimate.of(self.plan.study)
        workers = max(min(getattr(where, "workers", 1), expected), 1)
        if isinstance(where, Here | Local):
            run.check(workers)
        trains = self._trains(expected)

        def full(run: RunEstimate) -> float:
            return expected * run.total.time / workers

        def time(run: RunEstimate) -> float:
            reduced = (estimate.TRAINING * run.total.time + expected * estimate.REDUCED) / workers
            return reduced if trains else full(run)

        def more() -> str:
            fails = f" by a reduced model, or {estimate.duration(full(run))} by full runs if none can be certified"
            return f"{fails if trains else ''}{run.quick_look(time)}"

        estimate.warn_if_long(
            time(run), f"{self.at_most}{counted(expected, 'variant')} of {self.plan.study.name}", more
        )

    def _train_model(self) -> None:
        from tyrefem.reduced.model import NotReducibleError
        from tyrefem.reduced.surrogate import surrogate

        execution = self.execution
        try:
            self._model = surrogate(
                self.plan,
                tolerance=execution.tolerance,
                scheduler=execution.where,
                progress=execution.report_progress,
                settings=execution.settings,
            )
        except NotReducibleError as error:
            if execution.reduced == "always":
                raise
            self.reduced, self.why_full = False, str(error)
            return
        self.certificate = self._model.certificate
        if self._store is not None:
            self._store.note(CERTIFICATE, asdict(self.certificate))

    def evaluate(self, numbers: Sequence[int] | Numbers, *, full: bool = False) -> Iterator[int]:
        """Evaluate variants; yields the number of finished variants after every task. ``full``: by full runs only."""
        if self.reduced and self._model is None and not full and len(numbers):
            self._train_model()
        wanted = np.asarray(numbers, dtype=np.intp)
        if self._model is not None and not full and len(wanted):
            for outcomes in by_model(self._model, self.plan, chosen(self.variants, wanted), self.execution):
                yield self._keep(outcomes.numbered(wanted))
        yield from self._run_in_full(self.outcomes.without(wanted), self.execution.settings.piece)

    def _run_in_full(self, left: Numbers, most: int) -> Iterator[int]:
        """Run variants in full, several in a task if they are many, to limit the scheduler's load."""
        where, size = self.execution.where, min(max(len(left) // self.execution.settings.single, 1), most)
        if size == 1:
            for place, outcome in where.outcomes(perform, TaskList(len(left), lambda n: self._task(left[n]))):
                yield self._keep({int(left[place]): outcome})
            return
        pieces = TaskList(math.ceil(len(left) / size), lambda place: left[place * size : (place + 1) * size].tolist())
        tasks = TaskList(len(pieces), lambda place: [self._task(n) for n in pieces[place]])
        lost: list[int] = []
        for place, outcomes in where.outcomes(perform_all, tasks):
            if isinstance(outcomes, Failed):
                lost += pieces[place]
            else:
                yield self._keep(dict(zip(pieces[place], outcomes, strict=True)))
        if lost:
            # A variant ended its worker: run the variants of this task separately.
            yield from self._run_in_full(np.array(lost, dtype=np.intp), 1)

    def _task(self, number: int) -> Task:
        return Task(int(number), self.plan.packed, self.variants[int(number)], self.plan.time_to)

    def _keep(self, outcomes: Mapping[int, Outcome] | PackedOutcomes) -> int:
        """Store outcomes in the folder, if there is one, and in memory; returns the number of finished variants."""
        if self._store is not None:
            self._store.add(outcomes)
        else:
            self.outcomes.update(outcomes)
        return len(self.outcomes)


def _certificate(noted: Mapping[str, Any] | None) -> SurrogateCertificate | None:
    from tyrefem.reduced.surrogate import SurrogateCertificate

    if noted is None:
        return None
    # What is missing comes back from a file as not a number.
    return SurrogateCertificate(**{key: value for key, value in noted.items() if value == value and value is not None})


class Evaluator(VariantEvaluation):
    """Evaluates variants of a study by their changes, for a search; each variant is evaluated once.

    Parameters
    ----------
    plan : the study, its varied numbers (the box of a reduced model), and ``time_to``; its variants are not used.
    execution : see `Execution`. Searches within the same box share the outcomes in the folder.
    """

    #: Changes of all evaluated variants, in the order of the search.
    variants: list[Mapping[str, Any]]
    at_most = "up to "

    def __init__(self, plan: Plan, execution: Execution) -> None:
        boxes = [dataclasses.asdict(varied) for varied in plan.varied]
        text = json.dumps([plan.packed.digest, boxes, plan.time_to], sort_keys=True, default=str)
        super().__init__(plan, execution, [], hashlib.sha256(text.encode()).hexdigest()[:16])
        self._number: dict[str, int] = {}
        self._names: list[str] = []

    def _take_up(self, store: Store) -> None:
        """Outcomes are taken from the folder when the search asks for their variants."""

    def _keep(self, outcomes: Mapping[int, Outcome] | PackedOutcomes) -> int:
        """Store outcomes by name: the changes, and "full" if a full run replaces the reduced model."""
        before = self.outcomes.numbers
        self.outcomes.update(outcomes)
        if self._store is not None:
            new = np.setdiff1d(self.outcomes.numbers, before).tolist()
            self._store.add_by_name({self._names[n]: self.outcomes[n] for n in new})
        return len(self.outcomes)

    def __call__(self, variants: Sequence[Mapping[str, Any]], *, full: bool = False) -> list[Outcome]:
        """Outcomes of variants, in their order; ``full``: by full runs only."""
        numbers = [self._numbered(changes, full) for changes in variants]
        missing = [n for n in dict.fromkeys(numbers) if n not in self.outcomes]
        for _ in self.evaluate(missing, full=full):
            pass
        return [self.outcomes[n] for n in numbers]

    def _numbered(self, changes: Mapping[str, Any], full: bool) -> int:
        name = json.dumps(dict(changes), sort_keys=True, default=str) + (" full" if full and self.reduced else "")
        if name not in self._number:
            number = self._number[name] = len(self.variants)
            self.variants.append(dict(changes))
            self._names.append(name)
            known = None if self._store is None else self._store.by_name.get(name)
            # Of another search in this folder, by a reduced model that this one does not have.
            if known is not None and (name.endswith(" full") or self.reduced or getattr(known, "by", "full") == "full"):
                self.outcomes.update({number: known})
        return self._number[name]

    @property
    def margins(self) -> Mapping[str, float]:
        """Answer -> largest error of the reduced model in the validation runs; empty without a model."""
        return {} if self.certificate is None else self.certificate.errors

    @property
    def table_plan(self) -> Plan:
        """A plan with all evaluated variants, in the order of the search, for a table of them."""
        names = tuple(str(n + 1) for n in range(len(self.variants)))
        return dataclasses.replace(self.plan, variants=tuple(self.variants), names=names)
