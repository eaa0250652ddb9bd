"""The speed at which one answer reaches its limit: false position kept within bisection."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

#: The speed is found to this share of the range searched, or the answer to this share of the limit.
FINE = 1e-3


class SpeedSearch:
    """The speed at which one answer reaches the limit."""

    def __init__(self, low: float, high: float, limit: float) -> None:
        self.low, self.high, self.limit, self.fine = low, high, limit, FINE * (high - low)
        self.at_low = self.at_high = math.nan
        self.failure, self.value, self._speed = "", math.nan, math.nan
        self.settled = self.bracketed = False
        self._kept = 0

    @property
    def next(self) -> float:
        """Speed to try."""
        if math.isnan(self.at_low):
            return self.low
        if math.isnan(self.at_high):
            return self.high
        a, b = self.at_low - self.limit, self.at_high - self.limit
        middle = self.low - a * (self.high - self.low) / (b - a)
        margin = 0.02 * (self.high - self.low)
        return min(max(middle, self.low + margin), self.high - margin)

    @property
    def speed(self) -> float:
        """Speed found; NaN: none."""
        return self._speed

    def take(self, outcome: Mapping[str, Any], answer: str) -> None:
        """An outcome at `next`."""
        speed = self.next
        if "failure" in outcome:
            self.failure, self.settled, self._speed = outcome["failure"], True, math.nan
            return
        value = float(outcome["answers"][answer])
        if math.isnan(self.at_low):
            self.at_low = value
            if value >= self.limit:
                self.settled, self.value = True, value
        elif math.isnan(self.at_high):
            self.at_high = value
            if value < self.limit:
                self.settled, self.value, self._speed = True, value, self.high
        elif value < self.limit:
            self.low, self.at_low, self.value, self._speed = speed, value, value, speed
            # Illinois: an end that stays twice counts half, so that the other one moves.
            self.at_high = self.limit + (self.at_high - self.limit) / 2 if self._kept > 0 else self.at_high
            self._kept = max(self._kept, 0) + 1
        else:
            self.high, self.at_high = speed, value
            self.at_low = self.limit + (self.at_low - self.limit) / 2 if self._kept < 0 else self.at_low
            self._kept = min(self._kept, 0) - 1
        if not self.settled and not math.isnan(self.at_high):
            self.bracketed = True
            close = self.high - self.low < self.fine or abs(self.value - self.limit) < FINE * abs(self.limit)
            self.settled = close and not math.isnan(self._speed)
