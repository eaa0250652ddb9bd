"""Responses of the readings to heat sources whose strength follows a course in time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.fixed_steps import fixed_step_solution
from tyrefem.conduction.sensitivity import Perturbed, stage_times, tangents_over_time
from tyrefem.diagnose.fixed_step import FixedStepRun, ReadingSensitivities
from tyrefem.diagnose.sampling import DriveSampling
from tyrefem.diagnose.unknowns import Unknown, with_values
from tyrefem.simulation.rolling_tyre import RollingTyre

Array = NDArray[np.float64]
#: Time steps per interval between two knots.
STEPS = 2.5
#: Largest number of values that the sensitivities of one batch of sources may have.
MOST_VALUES = 8_000_000


def source_responses(base: FixedStepRun, drive: DriveSampling, sources: Sequence[Unknown], knots: Array) -> Array:
    """(n_blocks, n_sources, n_knots) K per unit of a source whose strength is a hat at one knot.

    About the simulation ``base`` of the drive. The hats of a source add up to a source that is constant in time; see
    `tangents_over_time`.
    """
    run = _fine(base, float(np.diff(knots).min()) / STEPS)
    each = max(int(MOST_VALUES / (run.values.size * len(knots))), 1)
    batches = [sources[first : first + each] for first in range(0, len(sources), each)]
    return np.concatenate([_batch(run, drive, batch, knots) for batch in batches], axis=1)


def _fine(base: FixedStepRun, longest: float) -> FixedStepRun:
    """A simulation with steps that resolve the hats."""
    drive = base.tyre.drive
    times = stage_times([*drive.starts, drive.end], longest=max(longest, 5.0))
    values = fixed_step_solution(base.tyre.problem, times, drive.initial)
    return FixedStepRun(base.study, base.tyre, times, *values, base.every)


def _batch(run: FixedStepRun, drive: DriveSampling, sources: Sequence[Unknown], knots: Array) -> Array:
    perturbed = []
    for source in sources:
        study = with_values(run.study, {source: source.step}, run.study)
        perturbed.append(Perturbed(RollingTyre(study, run.tyre).problem, source.step))
    derivatives = tangents_over_time(run.tyre.problem, run.times, run.values, run.reservoirs, perturbed, knots)
    columns = tuple(source for source in sources for _ in knots)
    slopes = ReadingSensitivities(run, columns, {}, range(len(columns)), derivatives).slopes(
        [sampling.sensor for sampling in drive.sensors]
    )
    blocks = [sampling.sampled(run.grid, slopes[sampling.sensor]) for sampling in drive.sensors]
    return np.concatenate(blocks).reshape(-1, len(sources), len(knots))
