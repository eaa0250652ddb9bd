"""A tyre at any setting of the numbers that vary: its drive marched with numpy, as the page of `tyrefem explore` does.

The step is that of `tyrefem.realtime.tyre`. Its JavaScript twin is `tyrefem/reports/explore_model.js`.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from tyrefem.realtime.setting_coefficients import Coefficients
from tyrefem.realtime.setting_data import SettingData
from tyrefem.realtime.setting_solution import Solution

Array = NDArray[np.float64]
#: Shortest step after a jump, s; steps of one length before it doubles; steps of a phase at least, with ramps.
FIRST, REPEATED, LEAST, LEAST_RAMP = 1.0, 3, 8, 24


def step_lengths(duration: float, *, ramp: bool, fineness: int = 1) -> list[float]:
    """Lengths of the steps of a phase, s: short after its start, doubling until there are enough.

    >>> [round(length, 1) for length in step_lengths(60.0, ramp=False)]
    [1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 3.9, 3.9, 3.9, 3.9, 3.9, 3.9, 3.9, 3.9, 3.9, 3.9, 3.9, 3.9, 3.9]
    """
    least = fineness * (LEAST_RAMP if ramp else LEAST)
    lengths: list[float] = []
    length, left = min(FIRST / fineness, duration / least), duration
    while 2 * length * REPEATED < left and 2 * length * least <= duration:
        lengths += [length] * REPEATED
        left -= length * REPEATED
        length *= 2
    count = math.ceil(left / length - 1e-9)
    return lengths + [left / count] * count


class SettingTyre(SettingData):
    """The model of all settings of a box: it marches the drive."""

    def solve(self, numbers: Array) -> Solution:
        """March the drive at a setting; ``numbers``: (n_numbers,) in their units."""
        c = Coefficients(self, np.asarray(numbers, dtype=float))
        lengths, phases = self.arrays["step_lengths"], self.arrays["step_phases"].astype(int)
        y = np.concatenate([c.initial * self.arrays["even"], c.lumped_start])
        lags = self.arrays["lag"][self.lagging]
        states, late, first = [y], [np.full(len(lags), c.initial)], [0]
        elapsed = 0.0
        for number, (h, phase) in enumerate(zip(lengths.tolist(), phases.tolist(), strict=True)):
            if number and phase != phases[number - 1]:
                first.append(number)
                elapsed = 0.0
            start, end = c.inputs[phase]
            now, later = (start + (end - start) * (t / self.durations[phase]) for t in (elapsed, elapsed + h))
            after = c.step(h, now, later, y)
            read, ahead = (self.arrays["read"][self.lagging] @ each for each in (y, after))
            behind = lags * (ahead - read) / h
            late.append(ahead - behind + (late[-1] - read + behind) * np.exp(-h / lags))
            y = after
            states.append(y)
            elapsed += h
        times = np.concatenate([[0.0], np.cumsum(lengths)])
        return Solution(self, c, times, tuple(first), np.array(states), np.array(late))
