"""Responses of the readings to heat sources whose strength follows a course in time."""

from __future__ import annotations

import functools
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from tyrefem.cache import Cache, Content
from tyrefem.conduction.fixed_steps import fixed_step_solution
from tyrefem.conduction.sensitivity import Perturbed, stage_times, tangents_over_time
from tyrefem.diagnose.forward.fixed_step import FixedStepRun
from tyrefem.diagnose.forward.reading_sensitivities import ReadingSensitivities
from tyrefem.diagnose.forward.sampling import DriveSampling
from tyrefem.diagnose.unknowns.unknown import Unknown, with_values
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.variants.answer_store import study_digest

Array = NDArray[np.float64]
#: Time steps per interval between two knots.
STEPS = 2.5
#: Largest number of values that the sensitivities of one batch of sources may have.
MOST_VALUES = 8_000_000
#: Histories by drive, source, sensors and knots, shared by many diagnoses of one layout: 0.1 to 0.5 MB each. A layout
#: has about 400, and as many by a better strain law.
_HISTORIES: Cache[Array] = Cache(size=1024)


def source_responses(base: FixedStepRun, drive: DriveSampling, sources: Sequence[Unknown], knots: Array) -> Array:
    """(n_blocks, n_sources, n_knots) K per unit of a source whose strength is a hat at one knot.

    About the simulation ``base`` of the drive. The hats of a source add up to a source that is constant in time; see
    `tangents_over_time`. The histories depend on no readings, so all diagnoses of one layout share them.
    """
    sensors = tuple(sampling.sensor for sampling in drive.sensors)
    of_drive = study_digest(base.study), base.every, sensors, Content.of(knots)
    missing = [source for source in sources if (*of_drive, source) not in _HISTORIES]
    computed = _histories(base, sensors, missing, knots)

    def history(source: Unknown) -> Array:
        if source in computed:
            return computed[source]
        return _histories(base, sensors, [source], knots)[source]

    histories = [_HISTORIES.get((*of_drive, source), functools.partial(history, source)) for source in sources]
    together = np.concatenate(histories, axis=2)
    blocks = [sampling.sampled(base.grid, each) for sampling, each in zip(drive.sensors, together, strict=True)]
    return np.concatenate(blocks).reshape(-1, len(sources), len(knots))


def _histories(
    base: FixedStepRun, sensors: Sequence[str], sources: Sequence[Unknown], knots: Array
) -> dict[Unknown, Array]:
    """Source -> (n_sensors, n_grid, n_knots) K per unit."""
    if not sources:
        return {}
    run = _fine(base, float(np.diff(knots).min()) / STEPS)
    each = max(int(MOST_VALUES / (run.values.size * len(knots))), 1)
    histories: dict[Unknown, Array] = {}
    for first in range(0, len(sources), each):
        batch = sources[first : first + each]
        slopes = _batch(run, sensors, batch, knots)
        stacked = np.array([slopes[sensor] for sensor in sensors])
        parts = np.split(stacked, len(batch), axis=2)
        histories |= zip(batch, map(np.ascontiguousarray, parts), strict=True)
    return histories


def _fine(base: FixedStepRun, longest: float) -> FixedStepRun:
    """A simulation with steps that resolve the hats."""
    drive = base.tyre.drive
    times = stage_times([*drive.starts, drive.end], longest=max(longest, 5.0))
    values = fixed_step_solution(base.tyre.problem, times, drive.initial)
    return FixedStepRun(base.study, base.tyre, times, *values, base.every)


def _batch(run: FixedStepRun, sensors: Sequence[str], sources: Sequence[Unknown], knots: Array) -> dict[str, Array]:
    """Sensor -> (n_grid, n_sources n_knots) K per unit."""
    perturbed = []
    for source in sources:
        study = with_values(run.study, {source: source.step}, run.study)
        perturbed.append(Perturbed(RollingTyre(study, run.tyre).problem, source.step))
    derivatives = tangents_over_time(run.tyre.problem, run.times, run.values, run.reservoirs, perturbed, knots)
    columns = tuple(source for source in sources for _ in knots)
    return ReadingSensitivities(run, columns, {}, range(len(columns)), derivatives).slopes(sensors)
