"""Few load cases for a strain law that takes seconds per cycle: training repeats them, workers share the tables'.

Tan delta, conductivities, films and temperatures leave the footprint as it is: a process solves every load case once.
A surrogate of strain energies over load and pressure, with a certificate of its own, would take the place of
`TableTask`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.cycle_schedule import same_cycles
from tyrefem.mechanics.solved_cases import KnotSolver, changes_cycle, ramp_knots
from tyrefem.realtime.inputs import Box
from tyrefem.realtime.tables import Probe
from tyrefem.reduced.packed_model import base_of
from tyrefem.variants.outcomes import Failed
from tyrefem.variants.plan import Plan
from tyrefem.variants.schedulers import Scheduler
from tyrefem.variants.task import Bundle

Array = NDArray[np.float64]
#: Load cases of a table in one task.
TOGETHER = 3
#: Corners of the numbers that change the load case, beside the two ends and the middle, that training repeats.
CORNERS = 2


@dataclass(frozen=True, eq=False)
class FewPresses:
    """Places of the box at which training presses the tyre.

    Parameters
    ----------
    numbers : which of the varied numbers change the strain cycles. patterns : (k, len(numbers)) their places in [0, 1].
    """

    numbers: tuple[int, ...]
    patterns: Array

    def repeated(self, places: Sequence[Array]) -> list[Array]:
        """The places with the patterns for the numbers that change strain cycles; equal patterns stand together.

        >>> few = FewPresses((1,), np.array([[0.0], [1.0]]))
        >>> [place.tolist() for place in few.repeated([np.array([0.2, 0.3]), np.array([0.4, 0.9])])]
        [[0.2, 0.0], [0.4, 1.0]]
        """
        if not self.numbers:
            return list(places)
        repeated = [np.array(place) for place in places]
        for n, place in enumerate(repeated):
            place[list(self.numbers)] = self.patterns[n * len(self.patterns) // len(repeated)]
        return repeated


def few_presses(plan: Plan, rng: np.random.Generator) -> FewPresses:
    """The ends, the middle and two corners of the numbers of a plan that change strain cycles."""
    study = plan.study
    changed = [
        number
        for number, varied in enumerate(plan.varied)
        if any(changes_cycles(study.replace(varied.changes(varied.at(end))), study) for end in (0.0, 1.0))
    ]
    size = len(changed)
    corners = np.eye(2) if size == 2 else np.round(rng.random((CORNERS, size)))
    patterns = np.array([np.zeros(size), np.full(size, 0.5), np.ones(size), *corners])
    return FewPresses(tuple(changed), np.unique(patterns, axis=0))


def changes_cycles(study: StudyData, other: StudyData) -> bool:
    """Does a study need other strain cycles than another one?"""
    if _cases(study) != _cases(other):
        return True
    return not same_cycles(study.replace({"drive": other.data["drive"]}), other)


def _cases(study: StudyData) -> list[Any]:
    solver = KnotSolver(study)
    return [
        solver.case(number, fraction)
        for number, _ in enumerate(study.card.drive.phases)
        for fraction in ramp_knots(changes_cycle(study, number))
    ]


@dataclass(frozen=True, eq=False)
class TableTask:
    """Load cases of a table: the study packed, its changes, the box of inputs; speeds and pairs as in `Probe.at`."""

    packed: Bundle
    changes: Mapping[str, Any]
    box: Box
    speeds: Array
    pairs: Array


def perform_table(task: TableTask) -> tuple[Array, Array] | Failed:
    """Run in a worker: films and heat at load cases."""
    from tyrefem.conduction import SolverError

    base = base_of(task.packed)
    try:
        return Probe(base.study.replace(task.changes), task.box, base).at(task.speeds, task.pairs)
    except (InputError, SolverError) as error:
        return Failed(str(error))


def shared_pairs(
    scheduler: Scheduler, packed: Bundle, changes: Mapping[str, Any], box: Box, tick: Callable[[int, int], None]
) -> Callable[[Array, Array], tuple[Array, Array]]:
    """`Probe.at` whose load cases are solved by the workers of a scheduler, a few in a task, by pressure.

    Raises
    ------
    InputError : when called: a load that the tyre cannot carry.
    """

    def at(speeds: Array, pairs: Array) -> tuple[Array, Array]:
        order = np.lexsort((pairs[:, 0], pairs[:, 1]))
        parts = [order[n : n + TOGETHER] for n in range(0, len(order), TOGETHER)]
        tasks = [TableTask(packed, changes, box, speeds, pairs[part]) for part in parts]
        films: dict[int, Array] = {}
        heats: dict[int, Array] = {}
        for done, (number, outcome) in enumerate(scheduler.outcomes(perform_table, tasks), start=1):
            if isinstance(outcome, Failed):
                raise InputError(f"a load case of the box failed: {outcome.reason}", field="vary")
            films |= zip(parts[number].tolist(), outcome[0], strict=True)
            heats |= zip(parts[number].tolist(), outcome[1], strict=True)
            tick(done, len(tasks))
        places = range(len(pairs))
        return np.array([films[n] for n in places]), np.array([heats[n] for n in places])

    return at
