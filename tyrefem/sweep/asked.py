"""Variants that are asked for one round after the other, as a search needs them: each is answered once and kept."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Mapping, Sequence
from typing import Any

from tyrefem.sweep.answering import Answering, Outcome
from tyrefem.sweep.execution import Execution
from tyrefem.sweep.plan import Plan


class Asked(Answering):
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
        boxes = [dataclasses.asdict(one) for one in plan.varied]
        text = json.dumps([plan.packed.digest, boxes, plan.time_to], sort_keys=True, default=str)
        super().__init__(plan, how, [], hashlib.sha256(text.encode()).hexdigest()[:16])
        self._number: dict[str, int] = {}
        self._names: list[str] = []

    def name(self, number: int) -> str:
        """What the variant changes, and whether a full run was asked for where there is a model."""
        return self._names[number]

    def __call__(self, variants: Sequence[Mapping[str, Any]], *, full: bool = False) -> list[Outcome]:
        """Outcomes of some variants, in their order; ``full``: none by the reduced model."""
        numbers = [self._numbered(one, full) for one in variants]
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
