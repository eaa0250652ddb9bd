"""Evaluation of variants by a certified reduced model or by full runs; finished variants are stored.

`VariantEvaluation` evaluates the numbered variants of a plan, `Evaluator` the successive variants of a search.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any, Self

from tyrefem.estimates import work as estimate
from tyrefem.simulation.estimate import RunEstimate
from tyrefem.variants.execution import Execution
from tyrefem.variants.outcomes import Failed, NotReducible, Outcome, outcome_of
from tyrefem.variants.plan import Plan
from tyrefem.variants.schedulers import Here, Local
from tyrefem.variants.store import Name, Store
from tyrefem.variants.task import Task, perform, perform_all

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

    ``outcomes``: number -> `Answered` or `Failed`.
    ``certificate``: of the reduced model. ``reduced``: is it used? ``why_full``: reason if it is not.
    ``resumed``: number of outcomes that the folder had.
    """

    #: Word before the number of variants in the warning of long work.
    at_most = ""

    def __init__(self, plan: Plan, execution: Execution, variants: Sequence[Mapping[str, Any]], digest: str) -> None:
        self.plan, self.execution, self.variants = plan, execution, variants
        self.outcomes: dict[int, Outcome] = {}
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
        return self

    def __exit__(self, *_: object) -> None:
        if self._store is not None:
            self._store.close()

    def name(self, number: int) -> Name:
        """Key of a variant in the folder."""
        return number

    def resume(self, number: int) -> None:
        """Take a variant's outcome from the folder, if it is there."""
        known = None if self._store is None else self._store.done.get(self.name(number))
        if known is not None:
            self.outcomes[number] = outcome_of(known)

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
            self.why_full = f"{expected} variants are too few to train for"
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

        estimate.warn_if_long(time(run), f"{self.at_most}{expected:,} variants of {self.plan.study.name}", more)

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

    def evaluate(self, numbers: Sequence[int], *, full: bool = False) -> Iterator[int]:
        """Evaluate variants; yields the number of finished variants after every task. ``full``: by full runs only."""
        if self.reduced and self._model is None and not full and numbers:
            self._train_model()
        if self._model is not None and not full and numbers:
            variants = [self.variants[n] for n in numbers]
            for by_place in by_model(self._model, self.plan, variants, self.execution):
                yield self._keep({numbers[place]: outcome for place, outcome in by_place.items()})
        yield from self._run_in_full([n for n in numbers if n not in self.outcomes], self.execution.settings.piece)

    def _run_in_full(self, left: Sequence[int], most: int) -> Iterator[int]:
        """Run variants in full, several in a task if they are many, to limit the scheduler's load."""
        where, size = self.execution.where, min(max(len(left) // self.execution.settings.single, 1), most)
        if size == 1:
            for place, outcome in where.outcomes(perform, [self._task(n) for n in left]):
                yield self._keep({left[place]: outcome})
            return
        pieces = [left[first : first + size] for first in range(0, len(left), size)]
        lost: list[int] = []
        for place, outcomes in where.outcomes(perform_all, [[self._task(n) for n in piece] for piece in pieces]):
            if isinstance(outcomes, Failed):
                lost += pieces[place]
            else:
                yield self._keep(dict(zip(pieces[place], outcomes, strict=True)))
        if lost:
            # A variant ended its worker: run the variants of this task separately.
            yield from self._run_in_full(lost, 1)

    def _task(self, number: int) -> Task:
        return Task(number, self.plan.packed, self.variants[number], self.plan.time_to)

    def _keep(self, outcomes: Mapping[int, Outcome]) -> int:
        """Store outcomes in memory and in the folder; returns the number of finished variants."""
        self.outcomes.update(outcomes)
        if self._store is not None:
            self._store.add({self.name(n): outcome.entry for n, outcome in outcomes.items()})
        return len(self.outcomes)


def by_model(
    trained: Surrogate, plan: Plan, variants: Sequence[Mapping[str, Any]], execution: Execution
) -> Iterator[dict[int, Outcome]]:
    """Outcomes of variants by place, as tasks finish; variants that are `NotReducible` are left to full runs."""
    from tyrefem.reduced.training_rounds import ReducedTask, perform_reduced

    packed, piece = trained.packed(plan.packed), execution.settings.piece
    firsts = range(0, len(variants), piece)
    tasks = [ReducedTask(list(variants[first : first + piece]), plan.time_to) for first in firsts]
    for number, outcomes in execution.where.outcomes(perform_reduced, tasks, packed):
        if isinstance(outcomes, Failed):
            yield {}
            continue
        numbered = enumerate(outcomes, firsts[number])
        yield {place: outcome for place, outcome in numbered if not isinstance(outcome, NotReducible)}


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

    def name(self, number: int) -> str:
        """Key of a variant in the folder: its changes, and "full" if a full run replaces the reduced model."""
        return self._names[number]

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
            self.resume(number)
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
