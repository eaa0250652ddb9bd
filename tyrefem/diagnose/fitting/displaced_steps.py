"""Steps of a fit with the sensors' places taken exactly: a reading bends with the place of its sensor.

A thermocouple at the warmest place of the wall, or next to its surface, reads nearly the same if it is moved a little
and another temperature if it is moved more. At the known temperatures of the last point the readings of moved sensors
cost no simulation, so a step takes them as they are instead of their slopes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.diagnose.data.residuals import Residuals
from tyrefem.diagnose.fitting.gauss_newton import FitState
from tyrefem.diagnose.forward.fixed_step import QUOTIENT
from tyrefem.diagnose.forward.multifidelity import Predictions

Array = NDArray[np.float64]
#: Trials of one step at most.
ROUNDS = 6


@dataclass
class _Trial:
    """The search for a state's next point at fixed temperatures.

    ``moved``: numbers of the displacements among the unknowns -> number of the sensor, number of the direction.
    ``y``, ``r``, ``J``: best point so far, residuals and linear model there. ``reach``: box about it for displacements,
    prior sd. ``failed``: there is no simulation at the state's point.
    """

    state: FitState
    residuals: Residuals
    moved: dict[int, tuple[int, int]]
    y: Array
    r: Array
    J: Array
    trial: Array
    reach: float = np.inf
    ended: bool = False
    failed: bool = False

    @classmethod
    def of(cls, state: FitState, residuals: Residuals) -> _Trial | None:
        """The trial of a state; None if no sensor moves in its step."""
        if state.done or not state.simulated or any(member.presence for member in state.members):
            return None
        moving = {
            place: move for place, unknown in enumerate(state.unknowns) if (move := unknown.moves_sensor) is not None
        }
        if not any(state.next_point[place] != state.x[place] for place in moving):
            return None
        if any(effect.overrides("channel") for effect in residuals.study.card.effects):
            # A channel records another sensor.
            return None
        sensors = list(residuals.study.stated_places)
        moved = {place: (sensors.index(sensor), direction) for place, (sensor, direction) in moving.items()}
        return cls(state, residuals, moved, state.x, state.r, state.J, state.next_point)

    def shifts(self) -> Array:
        """(3, n_sensors, 2) m from the state's places: of the trial, and with all sensors a little further."""
        shifts = np.zeros((3, len(self.residuals.study.stated_places), 2))
        for place, (sensor, direction) in self.moved.items():
            shifts[:, sensor, direction] += self.trial[place] - self.state.x[place]
        shifts[1, :, 0] += QUOTIENT
        shifts[2, :, 1] += QUOTIENT
        return shifts

    def answered(self, changes: Sequence[Array]) -> None:
        """Take the changes (3, n_blocks) K of the block means of every fitted run; propose the next trial or end."""
        if not all(np.isfinite(of_run).all() for of_run in changes):
            self.failed = self.ended = True
            return
        state, settings = self.state, self.state.settings
        moved = list(self.moved)
        step = self.trial - state.x
        step[moved] = 0.0
        r = state.r - state.J @ step - self._whitened([of_run[0] for of_run in changes])
        off = float(np.linalg.norm(self.r - self.J @ (self.trial - self.y) - r))
        gain = state.misfit(self.r, self.y) - state.misfit(r, self.trial)
        if gain > 0:
            self.J = self._with_columns(changes)
            self.y, self.r = self.trial, r
            self.ended = off < settings.close_prediction or gain < settings.least_reduction
        else:
            sd = state.prior[0][moved]
            self.reach = settings.trust_shorter * float(np.abs((self.trial - self.y)[moved] / sd).max())
            self.ended = self.reach < settings.trust_smallest
        if not self.ended:
            self._propose()

    def _propose(self) -> None:
        state, moved, (sd, low, high) = self.state, list(self.moved), self.state.prior
        low, high = np.maximum(low, state.x - state.radius * sd), np.minimum(high, state.x + state.radius * sd)
        low[moved] = np.maximum(low[moved], self.y[moved] - self.reach * sd[moved])
        high[moved] = np.minimum(high[moved], self.y[moved] + self.reach * sd[moved])
        self.trial = state.best_within(self.r + self.J @ self.y, self.J, low, high)
        expected = self.r - self.J @ (self.trial - self.y)
        gain = state.misfit(self.r, self.y) - state.misfit(expected, self.trial)
        self.ended = gain < state.settings.least_reduction

    def _with_columns(self, changes: Sequence[Array]) -> Array:
        """J with the slopes over the sensors' places at the trial."""
        names = list(self.residuals.study.stated_places)
        columns = []
        for number, of_run in zip(self.residuals.fitted, changes, strict=True):
            slopes, parts = (of_run[1:] - of_run[0]) / QUOTIENT, self.residuals.runs[number].parts()
            table = np.zeros((of_run.shape[1], len(self.moved)))
            for column, (sensor, direction) in enumerate(self.moved.values()):
                rows = parts.get(names[sensor], slice(0))
                table[rows, column] = slopes[direction, rows]
            columns.append(table)
        J = self.J.copy()
        J[:, list(self.moved)] = self._whitened(columns)
        return J

    def _whitened(self, by_run: Sequence[Array]) -> Array:
        residuals, runs = self.residuals, self.residuals.runs
        return residuals.joined([runs[i].whitened(rows) for i, rows in zip(residuals.fitted, by_run, strict=True)])


def displaced_steps(
    residuals: Sequence[Residuals], predictions: Predictions, states: Sequence[FitState]
) -> list[FitState]:
    """The states with next points at which the sensors' places count exactly, at fixed temperatures."""
    trials = [_Trial.of(state, each) for state, each in zip(states, residuals, strict=True)]
    for _ in range(ROUNDS):
        active = [trial for trial in trials if trial is not None and not trial.ended]
        if not active:
            break
        numbers = active[0].residuals.fitted
        questions = [(number, trial.state.current_values, trial.shifts()) for trial in active for number in numbers]
        answers = predictions.evaluations.of("displaced", questions)
        for place, trial in enumerate(active):
            trial.answered(answers[place * len(numbers) : (place + 1) * len(numbers)])
    return [
        state if trial is None or trial.failed else state.expecting(trial.y, trial.r, trial.J)
        for state, trial in zip(states, trials, strict=True)
    ]
