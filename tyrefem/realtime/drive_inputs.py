"""A study's drive as inputs of a real-time model, and how they follow the numbers that vary."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.realtime.inputs import NAMES, Box
from tyrefem.realtime.tyre import STANDSTILL
from tyrefem.variants.samples import changes_at
from tyrefem.variants.varied import Varied

Array = NDArray[np.float64]
#: Relative rounding of written values (`tyrefem.variants.varied.DIGITS`).
ROUNDING = 1e-7


def inputs_of(study: StudyData) -> tuple[Array, float]:
    """Inputs (n_phases, 2, 5) at the start and end of every phase, ordered as `NAMES`, and the initial temperature.

    Raises
    ------
    InputError : a phase gives a deflection in place of a load.
    """
    road = study.card.boundaries.road.temperature
    phases = []
    for phase in study.card.drive.phases:
        if phase.load is None:
            raise InputError(
                "gives a deflection: a model in real time needs a load", field=f"drive.phases.{phase.name}"
            )
        ramps = [phase.speed, phase.load, phase.pressure, phase.ambient, phase.road_temperature or phase.ambient]
        ends = [[ramp.start for ramp in ramps], [ramp.end for ramp in ramps]]
        if phase.road_temperature is None and road is not None:
            ends[0][-1] = ends[1][-1] = road
        phases.append(ends)
    return np.array(phases), float(study.card.drive.initial)


@dataclass(frozen=True, eq=False)
class DriveInputs:
    """Inputs of a drive, affine in the numbers that vary: inputs = constant + numbers @ slopes.

    Parameters
    ----------
    durations : (n_phases,) s. constant : (n_phases * 10 + 1,): inputs of `inputs_of` row by row, then the initial
        temperature. slopes : (n_numbers, n_phases * 10 + 1). low, high : (n_numbers,) ends of the numbers.
    """

    durations: Array
    constant: Array
    slopes: Array
    low: Array
    high: Array

    def at(self, numbers: Array) -> tuple[Array, float]:
        """Inputs (n_phases, 2, 5) and initial temperature at numbers (n_numbers,) in their units."""
        values = self.constant + numbers @ self.slopes
        return values[:-1].reshape(-1, 2, 5), float(values[-1])

    def box(self) -> Box:
        """Ranges of the inputs over the whole box; of speed, load and pressure in phases that do not stand."""
        low, high = self.low[:, None] * self.slopes, self.high[:, None] * self.slopes
        least = (self.constant + np.minimum(low, high).sum(axis=0))[:-1].reshape(-1, 2, 5)
        most = (self.constant + np.maximum(low, high).sum(axis=0))[:-1].reshape(-1, 2, 5)
        rolls = most[:, :, 0].max(axis=1) > STANDSTILL
        rolls = rolls if rolls.any() else np.ones(len(rolls), bool)
        ranges = {}
        for k, name in enumerate(NAMES):
            phases = rolls if name in ("speed", "load", "pressure") else np.ones(len(rolls), bool)
            ends = float(least[phases, :, k].min()), float(most[phases, :, k].max())
            # Ends that differ by rounding only are a fixed input.
            ranges[name] = ends if ends[1] - ends[0] > ROUNDING * max(abs(ends[0]), abs(ends[1])) else (ends[0],) * 2
        return Box(ranges)


def drive_inputs(study: StudyData, varied: Sequence[Varied]) -> DriveInputs:
    """How the inputs of a study's drive follow the numbers that vary.

    Raises
    ------
    InputError : a number changes the duration of a phase; inputs are not affine in the numbers.
    """

    def values(place: Array) -> Array:
        changed = study.replace(changes_at(varied, place))
        inputs, initial = inputs_of(changed)
        _same_durations(study, changed)
        return np.append(inputs.ravel(), initial)

    middle = np.full(len(varied), 0.5)
    low, high = (np.array([number.number(end) for number in varied]) for end in (0.0, 1.0))
    slopes = np.array([(values(middle + step) - values(middle - step)) for step in 0.5 * np.eye(len(varied))])
    slopes = slopes / (high - low)[:, None]
    at_middle, numbers = values(middle), np.array([number.number(0.5) for number in varied])
    inputs = DriveInputs(
        np.array([phase.duration for phase in study.card.drive.phases]), at_middle - numbers @ slopes, slopes, low, high
    )
    place = np.random.default_rng(3).random(len(varied))
    inside = np.array([number.number(u) for number, u in zip(varied, place, strict=True)])
    off = np.abs(inputs.constant + inside @ slopes - values(place))
    if (off > ROUNDING * np.maximum(np.abs(at_middle), 1.0) * 100).any():
        raise InputError("the drive is not linear in the numbers that vary", field="vary")
    return inputs


def _same_durations(study: StudyData, changed: StudyData) -> None:
    pairs = zip(study.card.drive.phases, changed.card.drive.phases, strict=True)
    if any(before.duration != after.duration for before, after in pairs):
        raise InputError("a duration cannot vary here: all settings share their times", field="vary")
