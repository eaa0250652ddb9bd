"""Simulation of the rig: readings of every sensor in the card's tests."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from numbers import Integral, Real
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.errors import InputError
from tyrefem.estimates.work import check_readings
from tyrefem.heating_test.card import RigCard
from tyrefem.heating_test.clock import Clock
from tyrefem.heating_test.files import load
from tyrefem.heating_test.grid import USUAL, Fineness
from tyrefem.heating_test.parameters import clock_of, parameters_of
from tyrefem.heating_test.twin import Twin
from tyrefem.heating_test.verdict import HOT
from tyrefem.measured import MeasuredRun
from tyrefem.threads import one_thread

Array = NDArray[Any]
#: Largest number of readings per sensor.
_MOST = 200_000


@dataclass(frozen=True, eq=False)
class Simulation(Brief):
    """Simulated tests.

    Attributes
    ----------
    card, file : the rig. values : parameters of the simulation. runs : readings by run.
    twin, fields : the forward model, and nodal temperatures (computed times, unknowns) by run. clock : their times.
    seed : of the instruments' noise; None: no noise.
    """

    card: RigCard
    file: Path | None
    values: Mapping[str, float]
    runs: Mapping[str, MeasuredRun]
    twin: Twin
    clock: Clock
    fields: Mapping[str, Array]
    seed: int | None = None

    def _title(self) -> str:
        return f"of {self.card.title}"

    def _facts(self) -> Mapping[str, Any]:
        highest = {name: run.temperatures.max() for name, run in self.runs.items()}
        return {
            name: f"{self.card.runs[name].power:g} W, highest readings "
            + ", ".join(f"{sensor} {value:.1f}" for sensor, value in values.items())
            + " degC"
            for name, values in highest.items()
        }

    @property
    def words(self) -> tuple[str, ...]:
        """Warnings of temperatures that change rubber, and of heat at the patch's rim."""
        out = []
        grid = self.twin.grid(self.values)
        on = self.clock.heating.size - 1
        for name, fields in self.fields.items():
            peak, ambient = float(fields.max()), float(fields[0, 0])
            if peak > HOT:
                out.append(f"Run '{name}': the spot reaches {peak:.0f} degC; rubber changes at such temperatures.")
            rim = float((grid.at(grid.along[-1], grid.depths) @ fields.T).max()) - ambient
            if rim > 0.01 * (float(fields[on].max()) - ambient):
                out.append(f"Run '{name}': the patch's rim is {rim:.1f} K warm; patch.radius should be larger.")
        return tuple(out)


def simulate(
    rig: str | Path | RigCard,
    *,
    every: float = 5.0,
    seed: int | None = None,
    values: Mapping[str, float] | None = None,
    fineness: Fineness | None = None,
    progress: Callable[[], None] | None = None,
) -> Simulation:
    """Simulate the readings of every run of a rig's card.

    Parameters
    ----------
    rig : name, path or card. every : time between readings, s.
    seed : seed of the instruments' noise; None: no noise.
    values : parameters to change, by name, e.g. ``{"tread.conductivity": 0.3, "outer.offset": 0.1}``.

    Raises InputError if the rig is impossible, a number cannot be, or a parameter is unknown.

    >>> done = simulate("trtlab", every=60.0, fineness=Fineness(2, 5, 2))
    >>> readings = done.runs["high"].temperatures
    >>> sorted(readings, key=lambda sensor: readings[sensor].max())
    ['inner', 'interface', 'outer']
    """
    card, file = (rig, None) if isinstance(rig, RigCard) else load(rig)
    import pandas as pd

    if isinstance(every, bool) or not isinstance(every, Real):
        raise InputError(f"must be a number in s, not {every!r:.60}", field="every")
    if seed is not None and (not isinstance(seed, Integral) or seed < 0):
        raise InputError(f"must be a whole number of at least 0, not {seed!r:.60}", field="seed")
    check_readings(card.phases.end, every, "every", _MOST)
    if every > card.phases.end:
        raise InputError(f"{every:g} s leaves no reading after the first of {card.phases.end:g} s", field="every")
    sensors = tuple(card.sensors)
    parameters = parameters_of(card, sensors)
    known = parameters.values(np.zeros(len(parameters)))
    # The spot is at the mark by default; the centre of its prior is beside the mark.
    known["spot_across"] = 0.0
    for name in values or {}:
        if name not in known:
            from tyrefem.errors import nearest

            raise InputError(f"unknown number '{name}'{nearest(name, known)}", field="values")
    numbers = {**known, **(values or {})}
    beyond = max((0.0, *(-numbers[clock_of(name)] for name in card.runs)))
    twin, clock = Twin(card, sensors, fineness or USUAL), Clock(card.phases, card.phases.end, beyond)
    times = np.arange(0.0, card.phases.end + every / 2, every)
    times = times[times <= card.phases.end]
    rng = np.random.default_rng(seed)
    noise = np.array([card.sensors[name].noise for name in sensors])
    runs, kept = {}, {}
    for name, run in card.runs.items():
        with one_thread():
            kept[name] = twin.fields(numbers, run, clock)
        matrix = clock.matrix(times - numbers[clock_of(name)])
        readings = matrix @ twin.readings_of_fields(numbers, clock, kept[name])
        if seed is not None:
            readings = readings + noise * rng.normal(size=readings.shape)
        comment = f"SIMULATED with tyrefem rig simulate: {card.title}, run {name}, {run.power:g} W"
        comment += f", noise of seed {seed}" if seed is not None else ", no noise"
        frame = pd.DataFrame(np.round(readings, 4), columns=list(sensors))
        runs[name] = MeasuredRun(name, times, frame, None, (comment,))
        if progress:
            progress()
    return Simulation(card, file, numbers, runs, twin, clock, kept, seed)
