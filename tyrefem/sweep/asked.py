"""Variants that are asked for one round after the other, as a search needs them: each is answered once and kept."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.sweep.plan import Plan
from tyrefem.sweep.schedulers import Scheduler
from tyrefem.sweep.store import Store
from tyrefem.sweep.task import Task, perform

if TYPE_CHECKING:
    from tyrefem.reduced.surrogate import Certificate, Surrogate

Outcome = dict[str, Any]


class Asked:
    """Answers of variants of one study, by what they change.

    Parameters
    ----------
    plan : the study, what varies (the box of a reduced model) and the time to a temperature; it needs no variants.
    scheduler : where variants run. folder : where finished ones are kept; None: nowhere.
    reduced, tolerance : as of `tyrefem.sweep.sweep.sweep`. expected : how many variants will be asked for.
    progress : called with (what is done, finished, of how many).
    """

    def __init__(
        self,
        plan: Plan,
        scheduler: Scheduler,
        *,
        folder: Path | None = None,
        restart: bool = False,
        reduced: str = "never",
        tolerance: float = 0.01,
        expected: int = 0,
        progress: Callable[[str, int, int], None] | None = None,
    ) -> None:
        self.plan, self.scheduler, self.expected = plan, scheduler, expected
        self.reduced, self.tolerance = reduced, tolerance
        self.tick = progress or (lambda what, done, total: None)
        #: Changes and outcome of every variant, in the order in which they were asked for.
        self.variants: list[Mapping[str, Any]] = []
        self.outcomes: dict[int, Outcome] = {}
        self.why_full = ""
        self.certificate: Certificate | None = None
        self._number: dict[str, int] = {}
        self._keys: list[str] = []
        self._model: Surrogate | None = None
        self._known: dict[str, Outcome] = {}
        self._store: Store | None = None
        if folder is not None:
            self._store = Store(folder, f"{self._digest()}-{reduced}-{tolerance:g}")
            self._store.open(restart=restart)
            self._known = {
                str(one["key"]): {key: value for key, value in one.items() if key not in ("variant", "key")}
                for one in self._store.done.values()
            }
        self.taken_up = len(self._known)

    def _digest(self) -> str:
        boxes = [dataclasses.asdict(one) for one in self.plan.varied]
        text = json.dumps([self.plan.packed.digest, boxes, self.plan.time_to], sort_keys=True, default=str)
        return hashlib.sha256(text.encode()).hexdigest()[:16]

    def train(self) -> None:
        """Make a reduced model for the box, if asked for and worth it; the tolerance says whether it is used."""
        from tyrefem.reduced.model import NotReducibleError
        from tyrefem.reduced.surrogate import surrogate
        from tyrefem.sweep.sweep import WORTH_TRAINING

        if self.reduced == "never":
            return
        if self.reduced == "auto" and self.expected < WORTH_TRAINING * max(len(self.plan.varied), 1):
            self.why_full = f"{self.expected} variants are too few to train for"
            return
        try:
            self._model = surrogate(self.plan, tolerance=self.tolerance, scheduler=self.scheduler, progress=self.tick)
            self.certificate = self._model.certificate
        except NotReducibleError as error:
            if self.reduced == "always":
                raise
            self.why_full = str(error)

    def __call__(self, variants: Sequence[Mapping[str, Any]], *, full: bool = False) -> list[Outcome]:
        """Outcomes of some variants, in their order; ``full``: none by the reduced model."""
        numbers = [self._numbered(one, full) for one in variants]
        missing = [n for n in dict.fromkeys(numbers) if n not in self.outcomes]
        if self._model is not None and not full and missing:
            self._by_model(missing)
            missing = [n for n in missing if n not in self.outcomes]
        tasks = [Task(n, self.plan.packed, self.variants[n], self.plan.time_to) for n in missing]
        for place, outcome in self.scheduler.outcomes(perform, tasks):
            self._keep(missing[place], outcome if "failure" in outcome else {**outcome, "by": "full"})
        return [self.outcomes[n] for n in numbers]

    def _numbered(self, changes: Mapping[str, Any], full: bool) -> int:
        key = json.dumps(dict(changes), sort_keys=True, default=str) + (" full" if full and self._model else "")
        if key not in self._number:
            number = self._number[key] = len(self.variants)
            self.variants.append(dict(changes))
            self._keys.append(key)
            if key in self._known:
                self.outcomes[number] = self._known[key]
        return self._number[key]

    def _by_model(self, missing: Sequence[int]) -> None:
        from tyrefem.sweep.sweep import by_model

        assert self._model is not None
        for found in by_model(self._model, self.plan, [self.variants[n] for n in missing], self.scheduler):
            for place, outcome in found.items():
                self._keep(missing[place], outcome)

    def _keep(self, number: int, outcome: Outcome) -> None:
        self.outcomes[number] = outcome
        if self._store is not None:
            self._store.add({len(self._store.done): {**outcome, "key": self._keys[number]}})

    @property
    def margins(self) -> Mapping[str, float]:
        """Answer -> largest error of the reduced model in fresh full runs; empty without one."""
        return {} if self.certificate is None else self.certificate.errors

    @property
    def table_plan(self) -> Plan:
        """A plan of what was asked for, in its order: what a table of it needs."""
        names = tuple(str(n + 1) for n in range(len(self.variants)))
        return dataclasses.replace(self.plan, variants=tuple(self.variants), names=names)

    def close(self) -> None:
        """Nothing more will be asked."""
        if self._store is not None:
            self._store.close()

    def __enter__(self) -> Asked:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
