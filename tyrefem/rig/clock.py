"""The times at which a test is computed, and the way from there to the times of a table."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyrefem.rig.card import Phases

Array = NDArray[Any]

#: First scale of time after the laser is switched, s, and steps in all of a phase's logarithmic time.
SCALE, STEP = 0.5, 0.16


def since_switch(duration: float) -> Array:
    """Times from 0 to `duration`, close together after the switch: even steps in ln(1 + t/0.5 s).

    >>> since_switch(1050.0).size
    49
    """
    span = np.log1p(duration / SCALE)
    return np.asarray(SCALE * np.expm1(np.linspace(0.0, span, max(5, int(np.ceil(span / STEP)) + 1))))


@dataclass(frozen=True)
class Clock:
    """Computed times of one test up to `end`; index 0 is the moment the laser is switched on.

    Attributes
    ----------
    heating, cooling : times since the switch, s; cooling is empty where the test ends before.
    """

    phases: Phases
    end: float

    @cached_property
    def heating(self) -> Array:
        """s since the laser was switched on."""
        return since_switch(min(self.phases.heating, max(self.end - self.phases.idle, 1.0)))

    @cached_property
    def cooling(self) -> Array:
        """s since the laser was switched off, without 0."""
        left = self.end - self.phases.idle - self.phases.heating
        return since_switch(left)[1:] if left > 0 else np.zeros(0)

    @cached_property
    def times(self) -> Array:
        """All computed times, s of the test."""
        on = self.phases.idle + self.heating
        return np.concatenate([on, self.phases.idle + self.phases.heating + self.cooling])

    def matrix(self, times: ArrayLike) -> Array:
        """Matrix (times, computed times): cubic splines in the logarithmic time of each phase; start before it."""
        from scipy.interpolate import CubicSpline

        t = np.asarray(times, dtype=float) - self.phases.idle
        on = self.heating
        found = np.zeros((t.size, on.size + self.cooling.size))
        early, late = t <= 0, t > on[-1]
        found[early, 0] = 1.0
        spline = CubicSpline(np.log1p(on / SCALE), np.eye(on.size))
        found[~early & ~late, : on.size] = spline(np.log1p(t[~early & ~late] / SCALE))
        if self.cooling.size:
            off = np.concatenate([[0.0], self.cooling])
            spline = CubicSpline(np.log1p(off / SCALE), np.eye(off.size))
            after = np.clip(t[late] - on[-1], 0.0, off[-1])
            found[np.ix_(late, range(on.size - 1, found.shape[1]))] = spline(np.log1p(after / SCALE))
        else:
            found[late, -1] = 1.0
        return found

    def lagged(self, values: Array, lag: float) -> Array:
        """First-order lag, exact for readings that are straight between computed times; (n_times, ...)."""
        if lag <= 0:
            return values
        out = np.array(values, dtype=float)
        for i, dt in enumerate(np.diff(self.times), 1):
            keep = np.exp(-dt / lag)
            mean = (1.0 - keep) * lag / dt
            out[i] = keep * out[i - 1] + (mean - keep) * values[i - 1] + (1.0 - mean) * values[i]
        return out
