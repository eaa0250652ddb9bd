"""Variants of a sweep by a reduced model: tasks of many variants, whose outcomes come back packed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.variants.blocks import PackedOutcomes, packed
from tyrefem.variants.execution import Execution
from tyrefem.variants.outcomes import Failed, NotReducible, Outcome
from tyrefem.variants.plan import Plan
from tyrefem.variants.task_list import TaskList, task_size

if TYPE_CHECKING:
    from tyrefem.reduced.surrogate import Surrogate
    from tyrefem.reduced.training_rounds import PackedModel


@dataclass(frozen=True, eq=False)
class PiecesTask:
    """Variants for the reduced model, computed ``piece`` by piece; other parameters as in `ReducedTask`."""

    changes: Sequence[Mapping[str, Any]]
    time_to: float | None
    piece: int


def perform_pieces(task: PiecesTask, model: PackedModel) -> PackedOutcomes:
    """Run in a worker: the outcomes by place in the task; those that are `NotReducible` are left out."""
    from tyrefem.reduced.training_rounds import ReducedTask, perform_reduced

    outcomes: dict[int, Outcome] = {}
    for first in range(0, len(task.changes), task.piece):
        part = ReducedTask(task.changes[first : first + task.piece], task.time_to)
        numbered = enumerate(perform_reduced(part, model), first)
        outcomes |= {place: outcome for place, outcome in numbered if not isinstance(outcome, NotReducible)}
    return packed(outcomes)


def by_model(
    trained: Surrogate, plan: Plan, variants: Sequence[Mapping[str, Any]], execution: Execution
) -> Iterator[PackedOutcomes]:
    """Outcomes of variants by place, as tasks finish; variants that are `NotReducible` are left to full runs."""
    where, piece = execution.where, execution.settings.piece
    size = task_size(len(variants), max(getattr(where, "workers", 1), 1), piece)
    firsts = range(0, len(variants), size)
    tasks = TaskList(
        len(firsts), lambda place: PiecesTask(variants[firsts[place] : firsts[place] + size], plan.time_to, piece)
    )
    for place, outcomes in where.outcomes(perform_pieces, tasks, trained.packed(plan.packed)):
        if not isinstance(outcomes, Failed):
            yield outcomes.numbered(np.arange(firsts[place], firsts[place] + size))
