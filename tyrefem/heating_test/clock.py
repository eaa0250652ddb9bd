"""The computed times of a test: dense after each switch of the laser."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyrefem.heating_test.card import HeatingPhases

Array = NDArray[Any]
#: Time scale after a switch of the laser, s, and number of steps of a phase in logarithmic time.
SCALE, STEP = 0.5, 0.16


def since_switch(duration: float) -> Array:
    """Times from 0 to `duration`, dense after the switch: equal steps in ln(1 + t/0.5 s).

    >>> since_switch(1050.0).size
    49
    """
    span = np.log1p(duration / SCALE)
    return np.asarray(SCALE * np.expm1(np.linspace(0.0, span, max(5, int(np.ceil(span / STEP)) + 1))))


@dataclass(frozen=True)
class Clock:
    """Computed times of a test up to `end`; index 0 is the time at which the laser is switched on.

    Attributes
    ----------
    heating, cooling : times since the switch, s; cooling is empty if the test ends before.
    beyond : computed time after `end`, s: a table's clock may be late or early, and its last readings lie there.
    """

    phases: HeatingPhases
    end: float
    beyond: float = 0.0

    @cached_property
    def heating(self) -> Array:
        """Times since the laser was switched on, s."""
        return since_switch(min(self.phases.heating, max(self.end + self.beyond - self.phases.idle, 1.0)))

    @cached_property
    def cooling(self) -> Array:
        """Times since the laser was switched off, s, without 0."""
        left = self.end + self.beyond - self.phases.idle - self.phases.heating
        return since_switch(left)[1:] if left > 0 else np.zeros(0)

    @cached_property
    def times(self) -> Array:
        """All computed times of the test, s."""
        on = self.phases.idle + self.heating
        return np.concatenate([on, self.phases.idle + self.phases.heating + self.cooling])

    def matrix(self, times: ArrayLike) -> Array:
        """Interpolation matrix (times, computed times): cubic splines in logarithmic time; start before heating."""
        from scipy.interpolate import CubicSpline

        t = np.asarray(times, dtype=float) - self.phases.idle
        on = self.heating
        matrix = np.zeros((t.size, on.size + self.cooling.size))
        early, late = t <= 0, t > on[-1]
        matrix[early, 0] = 1.0
        spline = CubicSpline(np.log1p(on / SCALE), np.eye(on.size))
        matrix[~early & ~late, : on.size] = spline(np.log1p(t[~early & ~late] / SCALE))
        if self.cooling.size:
            off = np.concatenate([[0.0], self.cooling])
            spline = CubicSpline(np.log1p(off / SCALE), np.eye(off.size))
            after = np.clip(t[late] - on[-1], 0.0, off[-1])
            matrix[np.ix_(late, range(on.size - 1, matrix.shape[1]))] = spline(np.log1p(after / SCALE))
        else:
            matrix[late, -1] = 1.0
        return matrix

    def lagged(self, values: Array, lag: float) -> Array:
        """Readings with first-order lag (n_times, ...), exact for values linear between computed times."""
        if lag <= 0:
            return values
        out = np.array(values, dtype=float)
        for i, dt in enumerate(np.diff(self.times), 1):
            keep = np.exp(-dt / lag)
            mean = (1.0 - keep) * lag / dt
            out[i] = keep * out[i - 1] + (mean - keep) * values[i - 1] + (1.0 - mean) * values[i]
        return out
