"""Drag from hysteresis; friction of sliding is not in it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from tyrefem.result import Result

#: A wheel that turns slower than this share of its free speed hardly rolls (a judgement).
TURNS = 0.01


@dataclass(frozen=True)
class RollingResistance:
    """Drag from hysteresis, F = (total heat) / v, N, and coefficient F / F_z.

    ``force`` and ``coefficient`` are at the end of ``phase``, the rolling phase that made the most heat; ``cold_*``
    then, but with every point at the drive's initial temperature. All zero for a tyre that never rolls. With slip it
    is still the hysteresis per metre of the road, without the friction.
    """

    phase: str
    force: float
    coefficient: float
    cold_force: float
    cold_coefficient: float


def rolling_reading(result: Result) -> int | None:
    """Number of the last reading of the rolling phase that made the most heat; None for a tyre that never rolls."""
    drive, energy = result.study.card.drive, np.zeros(len(result.times))
    for (kind, _), series in result.heat_budget.energies.items():
        energy = energy + series if kind == "generated" else energy
    best: tuple[float, int] | None = None
    for start, phase, state in zip(drive.starts, drive.phases, result.phases, strict=True):
        if phase.speed.end <= 0 or state.load <= 0 or start >= result.times[-1]:
            continue
        if result.tyre.rolling_speed(state.end * (1 - 1e-12)) <= TURNS * state.speed:
            continue
        end = min(start + phase.duration, float(result.times[-1]))
        first, last = (int(np.searchsorted(result.times, t - 1e-6)) for t in (start, end))
        heat = float(energy[last] - energy[first])
        best = max(best, (heat, last)) if best else (heat, last)
    return None if best is None else best[1]


def rolling_resistance(result: Result) -> RollingResistance:
    """Force, N, and coefficient at the `rolling_reading`."""
    i = result.rolling_reading
    if i is None:
        return RollingResistance("", 0.0, 0.0, 0.0, 0.0)
    t, drive, tyre = result.just_before(i), result.study.card.drive, result.tyre
    phase = drive.phases[drive.locate(t)[0]].name
    speed, load = tyre.speed(t), float(tyre.schedule.mean(lambda case: case.load, t))
    force, cold = float(result.heat_budget.power("generated")[i]) / speed, _cold_power(result, t) / speed
    return RollingResistance(phase, force, force / load, cold, cold / load)


def _cold_power(result: Result, t: float) -> float:
    problem, initial = result.tyre.problem, result.study.card.drive.initial
    total = 0.0
    for zone, source in result.tyre.sources.items():
        nodes = problem.points(zone)
        q = source(nodes, t, np.full(nodes.shape[1], initial))
        total += float((problem.operators.source(zone) @ q).sum())
    return total * (2.0 if result.study.section.half else 1.0)
