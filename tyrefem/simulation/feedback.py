"""Fixed-point iteration of temperatures and strain cycles, through pressure and moduli."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from tyrefem.simulation.feedback_outcome import FeedbackOutcome, InflationState
from tyrefem.simulation.warm_cycles import WarmCycles, Warmth

if TYPE_CHECKING:
    from tyrefem.inputs.loading import LoadCase
    from tyrefem.inputs.study import StudyData
    from tyrefem.mechanics.cycle_schedule import CycleSchedule
    from tyrefem.simulation.result import ResultData
    from tyrefem.simulation.rolling_tyre import RollingTyre

#: If a run reduces the difference to no less than this share of the last, the next step is halved.
SLOW, LEAST = 0.7, 1 / 16


def run(
    study: StudyData,
    progress: Callable[[float], None] | None = None,
    like: RollingTyre | None = None,
    start: Warmth | None = None,
    *,
    partial: bool = False,
) -> ResultData:
    """Simulate a study's drive repeatedly, until its temperatures are those of its strain cycles.

    T_(k+1) = run(cycles(T_k)): every run uses strain cycles at the temperatures of the run before. The first uses
    ``start``, by default the drive's initial temperatures. Slow convergence or divergence halves the steps. A result
    that has not converged after the allowed iterations is returned with a warning. ``partial``: see
    `tyrefem.simulation.run.run`; the finished part is of the latest run, all of it between two runs.

    Raises
    ------
    InputError : the section cannot carry its load at a pressure or modulus; names the phase.
    """
    from tyrefem.simulation.rolling_tyre import RollingTyre
    from tyrefem.simulation.simulate import simulate

    choice = study.card.mechanics.feedback
    assert choice is not None
    cycles = WarmCycles(study, choice, Warmth.even(study) if start is None else start)
    changes: list[float] = []
    share, first, wall_time = 1.0, like, 0.0
    while True:
        tyre = RollingTyre(study, first, cycles.schedule())
        result = simulate(tyre, progress, partial=partial)
        first, wall_time = first or tyre, wall_time + result.wall_time
        warmth = Warmth.of(result)
        changes.append(math.inf if result.history.interrupted else cycles.change(warmth))
        done = changes[-1] <= choice.tolerance or len(changes) == choice.iterations
        if done or result.history.interrupted:
            break
        if len(changes) > 1 and changes[-1] > SLOW * changes[-2]:
            share = max(share / 2, LEAST)
        try:
            cycles.update(warmth, share)
        except KeyboardInterrupt:
            if not partial:
                raise
            # The latest run is whole; only the next strain cycles are missing.
            result = replace(result, history=replace(result.history, interrupted=True))
            break
    end = float(result.times[-1])
    last = warmth.at(end)
    softened = {
        region: law(last.regions[region])
        for region in cycles.softening
        if (law := study.materials[region].softening) is not None
    }
    before, after = (_contact(tyre.schedule, t) for t in (0.0, end * (1 - 1e-12)))
    rubbing = None if cycles.rubbing is None else last.regions[cycles.rubbing]
    outcome = FeedbackOutcome(choice.tolerance, tuple(changes), before, after, softened, rubbing)
    return replace(result, feedback=outcome, wall_time=wall_time)


def _contact(schedule: CycleSchedule, time: float) -> InflationState:
    pressure, deflection = (schedule.mean(quantity, time) for quantity in (_pressure, _deflection))
    return InflationState(time, pressure, deflection)


def _pressure(case: LoadCase) -> float:
    return case.pressure


def _deflection(case: LoadCase) -> float:
    return case.deflection
