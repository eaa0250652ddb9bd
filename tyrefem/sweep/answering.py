"""Variants answered and kept: by a certified reduced model where there is one, by full runs otherwise.

Variants that are asked for one round after the other, as a search needs them: each is answered once and kept.
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

#: Fewer variants than this per number that varies are run in full: training would cost as much.
WORTH_TRAINING = 12


#: Under this name a sweep's folder keeps the certificate of the reduced model.
CERTIFICATE = "certificate"


class Answering:
    """Answers variants of one study by number.

    Parameters
    ----------
    plan : the study, what varies (the box of a reduced model) and the time to a temperature.
    how : see `Execution`. variants : number -> changes. digest : of what the folder may hold the outcomes of.

    ``outcomes``: number -> `Answered` or `Failed`.
    ``certificate``: of the reduced model. ``reduced``: does it answer? ``why_full``: why there is none.
    ``taken_up``: how many the folder had.
    """

    #: Before the number of variants that is told beforehand.
    at_most = ""

    def __init__(self, plan: Plan, how: Execution, variants: Sequence[Mapping[str, Any]], digest: str) -> None:
        self.plan, self.how, self.variants = plan, how, variants
        self.outcomes: dict[int, Outcome] = {}
        self.certificate: SurrogateCertificate | None = None
        self.why_full = ""
        self.taken_up = 0
        self.reduced = False
        self._digest = digest
        self._model: Surrogate | None = None
        self._store: Store | None = None

    def __enter__(self) -> Self:
        """Open the folder.

        Raises
        ------
        InputError : it holds the outcomes of something else, or cannot be written.
        """
        if self.how.folder is not None:
            self._store = Store(self.how.folder, f"{self._digest}-{self.how.reduced}-{self.how.tolerance:g}")
            self.taken_up = self._store.open(restart=self.how.restart)
            self.certificate = _certificate(self._store.notes.get(CERTIFICATE))
        return self

    def __exit__(self, *_: object) -> None:
        if self._store is not None:
            self._store.close()

    def name(self, number: int) -> Name:
        """Under what the folder keeps a variant."""
        return number

    def take_up(self, number: int) -> None:
        """Let a variant have the outcome that the folder has."""
        known = None if self._store is None else self._store.done.get(self.name(number))
        if known is not None:
            self.outcomes[number] = outcome_of(known)

    def train(self, expected: int) -> None:
        """Let a reduced model answer, if asked for and worth it, and certified within the tolerance.

        One whose certificate the folder has is made again when a variant is missing.

        Raises
        ------
        NotReducibleError : there is none, and nothing else is allowed.
        """
        self._expect(expected)
        if self.how.reduced == "never":
            return
        if not self._trains(expected):
            self.why_full = f"{expected} variants are too few to train for"
            return
        self.reduced = True
        if self.certificate is None:
            self._make()

    def _trains(self, expected: int) -> bool:
        """Is a reduced model allowed, and worth training?"""
        enough = WORTH_TRAINING * max(len(self.plan.varied), 1)
        return self.how.reduced == "always" or (self.how.reduced == "auto" and expected >= enough)

    def _expect(self, expected: int) -> None:
        """Refuse runs that do not fit side by side in memory; warn of long work."""
        where, run = self.how.where, RunEstimate.of(self.plan.study)
        workers = max(min(getattr(where, "workers", 1), expected), 1)
        if isinstance(where, Here | Local):
            run.check(workers)
        full = expected * run.total.time / workers
        time, more = full, ""
        if self._trains(expected):
            time = (estimate.TRAINING * run.total.time + expected * estimate.REDUCED) / workers
            more = f" by a reduced model, or {estimate.duration(full)} by full runs if none can be certified"
        estimate.warn_if_long(time, f"{self.at_most}{expected:,} variants of {self.plan.study.name}", more)

    def _make(self) -> None:
        from tyrefem.reduced.model import NotReducibleError
        from tyrefem.reduced.surrogate import surrogate

        how = self.how
        try:
            self._model = surrogate(
                self.plan, tolerance=how.tolerance, scheduler=how.where, progress=how.tick, settings=how.settings
            )
        except NotReducibleError as error:
            if how.reduced == "always":
                raise
            self.reduced, self.why_full = False, str(error)
            return
        self.certificate = self._model.certificate
        if self._store is not None:
            self._store.note(CERTIFICATE, asdict(self.certificate))

    def answer(self, numbers: Sequence[int], *, full: bool = False) -> Iterator[int]:
        """Answer variants; yields how many are finished after every piece. ``full``: none by the reduced model."""
        if self.reduced and self._model is None and not full and numbers:
            self._make()
        if self._model is not None and not full and numbers:
            variants = [self.variants[n] for n in numbers]
            for by_place in by_model(self._model, self.plan, variants, self.how):
                yield self._keep({numbers[place]: outcome for place, outcome in by_place.items()})
        yield from self._run([n for n in numbers if n not in self.outcomes], self.how.settings.piece)

    def _run(self, left: Sequence[int], most: int) -> Iterator[int]:
        """Run variants in full, so many together that a scheduler is not kept busy by counting them."""
        where, size = self.how.where, min(max(len(left) // self.how.settings.single, 1), most)
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
            # One of them took its worker down: the others are not to suffer for it.
            yield from self._run(lost, 1)

    def _task(self, number: int) -> Task:
        return Task(number, self.plan.packed, self.variants[number], self.plan.time_to)

    def _keep(self, outcomes: Mapping[int, Outcome]) -> int:
        """Take outcomes into memory and onto disk."""
        self.outcomes.update(outcomes)
        if self._store is not None:
            self._store.add({self.name(n): outcome.entry for n, outcome in outcomes.items()})
        return len(self.outcomes)


def by_model(
    trained: Surrogate, plan: Plan, variants: Sequence[Mapping[str, Any]], how: Execution
) -> Iterator[dict[int, Outcome]]:
    """Outcomes of variants, by place, as pieces are finished; what could not be reduced is left out, for full runs."""
    from tyrefem.reduced.training_rounds import ReducedTask, perform_reduced

    packed, piece = trained.packed(plan.packed), how.settings.piece
    firsts = range(0, len(variants), piece)
    tasks = [ReducedTask(list(variants[first : first + piece]), plan.time_to) for first in firsts]
    for number, outcomes in how.where.outcomes(perform_reduced, tasks, packed):
        if isinstance(outcomes, Failed):
            yield {}
            continue
        numbered = enumerate(outcomes, firsts[number])
        yield {place: outcome for place, outcome in numbered if not isinstance(outcome, NotReducible)}


def _certificate(noted: Mapping[str, Any] | None) -> SurrogateCertificate | None:
    from tyrefem.reduced.surrogate import SurrogateCertificate

    return None if noted is None else SurrogateCertificate(**noted)


class Evaluator(Answering):
    """Answers of variants of one study, by what they change.

    Parameters
    ----------
    plan : the study, what varies (the box of a reduced model) and the time to a temperature; it needs no variants.
    how : see `Execution`. A search that asks for something else within the same box takes up what the folder has.
    """

    #: What was asked for, in its order.
    variants: list[Mapping[str, Any]]
    at_most = "up to "

    def __init__(self, plan: Plan, how: Execution) -> None:
        boxes = [dataclasses.asdict(varied) for varied in plan.varied]
        text = json.dumps([plan.packed.digest, boxes, plan.time_to], sort_keys=True, default=str)
        super().__init__(plan, how, [], hashlib.sha256(text.encode()).hexdigest()[:16])
        self._number: dict[str, int] = {}
        self._names: list[str] = []

    def name(self, number: int) -> str:
        """What the variant changes, and whether a full run was asked for where there is a model."""
        return self._names[number]

    def __call__(self, variants: Sequence[Mapping[str, Any]], *, full: bool = False) -> list[Outcome]:
        """Outcomes of some variants, in their order; ``full``: none by the reduced model."""
        numbers = [self._numbered(changes, full) for changes in variants]
        missing = [n for n in dict.fromkeys(numbers) if n not in self.outcomes]
        for _ in self.answer(missing, full=full):
            pass
        return [self.outcomes[n] for n in numbers]

    def _numbered(self, changes: Mapping[str, Any], full: bool) -> int:
        name = json.dumps(dict(changes), sort_keys=True, default=str) + (" full" if full and self.reduced else "")
        if name not in self._number:
            number = self._number[name] = len(self.variants)
            self.variants.append(dict(changes))
            self._names.append(name)
            self.take_up(number)
        return self._number[name]

    @property
    def margins(self) -> Mapping[str, float]:
        """Answer -> largest error of the reduced model in fresh full runs; empty without one."""
        return {} if self.certificate is None else self.certificate.errors

    @property
    def table_plan(self) -> Plan:
        """A plan of what was asked for, in its order: what a table of it needs."""
        names = tuple(str(n + 1) for n in range(len(self.variants)))
        return dataclasses.replace(self.plan, variants=tuple(self.variants), names=names)
