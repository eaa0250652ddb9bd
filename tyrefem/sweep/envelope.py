"""The safe operating envelope: over load and pressure, the largest speed that keeps the tyre below a limit."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from tyrefem.errors import InputError
from tyrefem.quantity import parse
from tyrefem.studies import Study
from tyrefem.sweep.plan import Plan
from tyrefem.sweep.schedulers import Here, Scheduler
from tyrefem.sweep.task import perform

if TYPE_CHECKING:
    import pandas as pd

#: The speed is found to this share of the range searched.
FINE = 1e-3
#: Rounds of bisection and interpolation at most.
ROUNDS = 14


@dataclass(frozen=True)
class Envelope:
    """What a tyre may be driven at.

    Parameters
    ----------
    table : load, pressure, ``speed_m_s`` (NaN: too hot at any speed searched), ``at_limit`` (False: below the limit
        even at the highest speed searched), the answer there, runs.
    limit : of the answer. answer : its name.
    """

    table: pd.DataFrame
    answer: str
    limit: float
    runs: int

    @property
    def tkph(self) -> pd.DataFrame:
        """Load x speed of every row, t km/h: the rating that earth-mover tyres are sold by, here from the model."""
        table = self.table[["load", "pressure"]].copy()
        table["tkph"] = self.table["load_N"] / 9.80665e3 * self.table["speed_m_s"] * 3.6
        return table


def envelope(
    study: Study,
    loads: Sequence[str],
    pressures: Sequence[str],
    *,
    limit: float,
    answer: str = "hottest_degC",
    slowest: str = "1 m/s",
    fastest: str = "60 m/s",
    fixed: Mapping[str, Any] | None = None,
    scheduler: Scheduler | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Envelope:
    """The largest speed at which an answer stays below a limit, for every load and pressure.

    The answer must rise with speed. All pairs are searched at once: each round runs one speed of every pair that is not
    settled, by false position kept within bisection (the Illinois rule).

    Parameters
    ----------
    loads, pressures : with units. limit : in the answer's unit. slowest, fastest : speeds searched.
    fixed : values changed first.

    Raises
    ------
    InputError : speeds that are no range.
    """
    import pandas as pd

    low, high = parse(slowest, "m/s"), parse(fastest, "m/s")
    if not 0 < low < high:
        raise InputError(f"'{slowest}' to '{fastest}' is no range of speeds", field="speed")
    study = study.replace(dict(fixed or {}))
    pairs = [(load, pressure) for load in loads for pressure in pressures]
    searches = [_Search(low, high, limit) for _ in pairs]
    scheduler, runs = scheduler or Here(), 0
    for _ in range(ROUNDS):
        asking = [n for n, one in enumerate(searches) if not one.settled]
        if not asking:
            break
        variants = tuple(
            {"drive.load": pairs[n][0], "drive.pressure": pairs[n][1], "drive.speed": f"{searches[n].next:.6g} m/s"}
            for n in asking
        )
        plan = Plan(study, (), variants, tuple(map(str, asking)), {}, None, {})
        for place, outcome in scheduler.outcomes(perform, [plan.task(k) for k in range(len(variants))]):
            searches[asking[place]].take(outcome, answer)
            runs += 1
            if progress is not None:
                progress(sum(one.settled for one in searches), len(searches))
    rows = [
        {
            "load": load,
            "pressure": pressure,
            "load_N": parse(load, "N"),
            "pressure_Pa": parse(pressure, "Pa"),
            "speed_m_s": one.speed,
            "at_limit": one.bracketed,
            answer: one.value,
            "failure": one.failure,
        }
        for (load, pressure), one in zip(pairs, searches, strict=True)
    ]
    return Envelope(pd.DataFrame(rows), answer, limit, runs)


class _Search:
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
            self.failure, self.settled = outcome["failure"], True
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
            close = self.high - self.low < self.fine or abs(self.value - self.limit) < 1e-3 * abs(self.limit)
            self.settled = close and not math.isnan(self._speed)
