"""Variants of a sweep by a reduced model: tasks of many variants, whose outcomes come back packed."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.variants.blocks import Numbers, PackedOutcomes, packed
from tyrefem.variants.execution import Execution
from tyrefem.variants.outcomes import Failed, NotReducible, Outcome
from tyrefem.variants.plan import Plan
from tyrefem.variants.samples import chosen
from tyrefem.variants.task_list import TaskList, task_size

if TYPE_CHECKING:
    from tyrefem.reduced.packed_model import PackedModel
    from tyrefem.reduced.surrogate import Surrogate


@dataclass(frozen=True, eq=False)
class PiecesTask:
    """Variants for the reduced model, computed ``piece`` by piece; other parameters as in `ReducedTask`."""

    changes: Sequence[Mapping[str, Any]]
    time_to: float | None
    piece: int


def perform_pieces(task: PiecesTask, model: PackedModel) -> PackedOutcomes:
    """Run in a worker: the outcomes by place in the task; those that are `NotReducible` are left out."""
    from tyrefem.reduced.packed_model import ReducedTask, perform_reduced

    outcomes: dict[int, Outcome] = {}
    for first in range(0, len(task.changes), task.piece):
        part = ReducedTask(task.changes[first : first + task.piece], task.time_to)
        numbered = enumerate(perform_reduced(part, model), first)
        outcomes |= {place: outcome for place, outcome in numbered if not isinstance(outcome, NotReducible)}
    return packed(outcomes)


def _task(
    variants: Sequence[Mapping[str, Any]], parts: Sequence[Numbers], time_to: float | None, piece: int, place: int
) -> PiecesTask:
    return PiecesTask(chosen(variants, parts[place]), time_to, piece)


def by_model(
    trained: Surrogate, plan: Plan, variants: Sequence[Mapping[str, Any]], execution: Execution
) -> Iterator[PackedOutcomes]:
    """Outcomes of variants by place, as tasks finish; variants that are `NotReducible` are left to full runs.

    The variants of a task that ends its worker are tried again in tasks of one piece, then left to full runs.
    """
    where, piece = execution.where, execution.settings.piece
    model = trained.packed(plan.packed)
    left: Numbers = np.arange(len(variants), dtype=np.intp)
    sizes = (task_size(len(left), max(getattr(where, "workers", 1), 1), piece), piece)
    for size in dict.fromkeys(sizes):
        parts = [left[first : first + size] for first in range(0, len(left), size)]
        tasks = TaskList(len(parts), functools.partial(_task, variants, parts, plan.time_to, piece))
        lost = []
        for place, outcomes in where.outcomes(perform_pieces, tasks, model):
            if isinstance(outcomes, Failed):
                lost.append(parts[place])
            else:
                yield outcomes.numbered(parts[place])
        if not lost:
            return
        left = np.concatenate(lost)
