"""A note on computed readings that are too far apart in time: at measured times in between they are interpolated."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from tyrefem.compare.history import SensorHistory
from tyrefem.compare.interface import PhaseLike, ResultLike

Array = NDArray[np.float64]


def interpolation_note(run: str, result: ResultLike, histories: Sequence[SensorHistory]) -> list[str]:
    """A note on a run's sensors whose interpolation may be off by more than the noise of a reading."""
    saved = result.readings["time_s"].to_numpy(dtype=float)
    off = {}
    for history in histories:
        readings = result.readings[history.sensor].to_numpy(dtype=float)
        largest = float(bend(saved, readings, history.times, result.phases).max(initial=0.0))
        if largest > history.noise and len(history.times) > 1:
            off[history.sensor] = largest, float(np.median(np.diff(history.times)))
    if not off:
        return []
    worst = sorted(off, key=lambda sensor: -off[sensor][0])
    step = min(step for _, step in off.values())
    sensors = ", ".join(f"{sensor} {off[sensor][0]:.2g} K" for sensor in worst)
    return [
        f"Note: run '{run}': computed readings are interpolated between saved times, which may be off by about: "
        f'{sensors}; save them as often as they are measured, [output] every = "{step:.3g} s"'
    ]


def bend(saved: Array, readings: Array, times: Array, phases: Sequence[PhaseLike]) -> Array:
    """(n,) K, about how far linear interpolation of saved readings may be off at given times; 0 at saved times.

    A reading within a phase that lies d off the line through its two neighbours has d/4 in the middle of each interval
    beside it, as a parabola has. At the border of two phases the readings may have a kink, which is no error.
    """
    if len(saved) < 3 or not len(times):
        return np.zeros(len(times))
    share = (saved[1:-1] - saved[:-2]) / (saved[2:] - saved[:-2])
    line = readings[:-2] + share * (readings[2:] - readings[:-2])
    at_reading = np.zeros(len(saved))
    at_reading[1:-1] = np.abs(readings[1:-1] - line)
    at_reading[_at_border(saved, phases)] = 0.0
    left = np.clip(np.searchsorted(saved, times, side="right") - 1, 0, len(saved) - 2)
    within = np.clip((times - saved[left]) / (saved[left + 1] - saved[left]), 0.0, 1.0)
    worst: Array = np.maximum(at_reading[left], at_reading[left + 1]) * within * (1 - within)
    return worst


def _at_border(saved: Array, phases: Sequence[PhaseLike]) -> NDArray[np.bool_]:
    """(n,) whether a saved time is the start or the end of a phase."""
    borders = np.unique([time for phase in phases for time in (phase.start, phase.end)] or [-np.inf])
    slack = 1e-9 * max(abs(saved[-1]), 1.0)
    nearest = np.minimum(np.searchsorted(borders, saved - slack), len(borders) - 1)
    near: NDArray[np.bool_] = np.abs(borders[nearest] - saved) <= slack
    return near
