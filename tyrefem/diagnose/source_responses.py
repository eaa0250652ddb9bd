"""Responses of the readings to heat sources whose strength follows a course in time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.fixed_steps import fixed_step_solution
from tyrefem.conduction.sensitivity import Perturbed, stage_times, tangents_over_time
from tyrefem.diagnose.fixed_step import FixedStepRun, ReadingSensitivities
from tyrefem.diagnose.sampling import DriveSampling
from tyrefem.diagnose.unknowns import Unknown, with_values
from tyrefem.simulation.rolling_tyre import RollingTyre

if TYPE_CHECKING:
    from tyrefem.diagnose.forward_model import ForwardModel

Array = NDArray[np.float64]
#: Time steps per interval between two knots.
STEPS = 2.5
#: Largest number of values that the sensitivities of one batch of sources may have.
MOST_VALUES = 8_000_000


def knots_of(model: ForwardModel, number: int, count: int) -> Array:
    """(count,) s: even times over a drive, up to its last reading."""
    sensors = model.drives[number].sensors
    last = max(float(sampling.times[-1]) for sampling in sensors)
    return np.linspace(0.0, min(last, model.base(number).times[-1]), count)


def source_responses(model: ForwardModel, number: int, sources: Sequence[Unknown], knots: Array) -> Array:
    """(n_blocks, n_sources, n_knots) K per unit of a source whose strength is a hat at one knot.

    About x = 0. The hats of a source add up to a source that is constant in time; see `tangents_over_time`.
    """
    run = _fine(model.base(number), float(np.diff(knots).min()) / STEPS)
    perturbed = []
    for source in sources:
        study = with_values(run.study, {source: source.step}, run.study)
        perturbed.append(Perturbed(RollingTyre(study, run.tyre).problem, source.step))
    each = max(int(MOST_VALUES / (run.values.size * len(knots))), 1)
    batches = [perturbed[first : first + each] for first in range(0, len(perturbed), each)]
    return np.concatenate([_batch(run, model.drives[number], batch, knots) for batch in batches], axis=1)


def _fine(base: FixedStepRun, longest: float) -> FixedStepRun:
    """A simulation with steps that resolve the hats."""
    drive = base.tyre.drive
    times = stage_times([*drive.starts, drive.end], longest=max(longest, 5.0))
    values = fixed_step_solution(base.tyre.problem, times, drive.initial)
    return FixedStepRun(base.study, base.tyre, times, *values, base.every)


def _batch(run: FixedStepRun, drive: DriveSampling, sources: Sequence[Perturbed], knots: Array) -> Array:
    derivatives = tangents_over_time(run.tyre.problem, run.times, run.values, run.reservoirs, sources, knots)
    count = len(sources) * len(knots)
    readings = ReadingSensitivities(run, (), {}, range(count), derivatives)
    slopes = readings.slopes([sampling.sensor for sampling in drive.sensors])
    blocks = [sampling.sampled(run.grid, slopes[sampling.sensor]) for sampling in drive.sensors]
    return np.concatenate(blocks).reshape(-1, len(sources), len(knots))
