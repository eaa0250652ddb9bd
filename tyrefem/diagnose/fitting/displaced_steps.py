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
from tyrefem.diagnose.forward.multifidelity import Predictions

Array = NDArray[np.float64]
#: Trials of one step at most.
ROUNDS = 8
#: After a bad trial the sensors whose readings were predicted worst move less: those off by this share of the worst.
WORST = 0.3


@dataclass
class _Trial:
    """The search for a state's next point at fixed temperatures.

    ``moved``: numbers of the displacements among the unknowns -> number of the sensor, number of the direction.
    ``y``, ``r``, ``J``: best point so far, residuals and linear model there. ``at_y`` (n, n_sensors): whitened change
    of each sensor's readings there. ``reach`` (n_sensors,): box about it for displacements, prior sd. ``failed``: there
    is no simulation at the state's point.
    """

    state: FitState
    residuals: Residuals
    moved: dict[int, tuple[int, int]]
    y: Array
    r: Array
    J: Array
    trial: Array
    at_y: Array
    reach: Array
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
        still, free = np.zeros((len(state.r), len(sensors))), np.full(len(sensors), np.inf)
        return cls(state, residuals, moved, state.x, state.r, state.J, state.next_point, still, free)

    def shift(self) -> Array:
        """(n_sensors, 2) m of the trial from the state's places."""
        shift = np.zeros((len(self.residuals.study.stated_places), 2))
        for place, (sensor, direction) in self.moved.items():
            shift[sensor, direction] += self.trial[place] - self.state.x[place]
        return shift

    def answered(self, changes: Sequence[Array]) -> None:
        """Take change and slopes (3, n_blocks) of the block means of every fitted run; propose the next trial."""
        if not all(np.isfinite(of_run).all() for of_run in changes):
            self.failed = self.ended = True
            return
        state, settings = self.state, self.state.settings
        moved = list(self.moved)
        step = self.trial - state.x
        step[moved] = 0.0
        of_sensors = self._by_sensor([of_run[0] for of_run in changes])
        r = state.r - state.J @ step - of_sensors.sum(axis=1)
        off = float(np.linalg.norm(self.r - self.J @ (self.trial - self.y) - r))
        gain = state.misfit(self.r, self.y) - state.misfit(r, self.trial)
        if gain > 0:
            self.J = self._with_columns(changes)
            self.y, self.r, self.at_y = self.trial, r, of_sensors
            self.ended = off < settings.close_prediction or gain < settings.least_reduction
        else:
            self._shorten(of_sensors)
        if not self.ended:
            self._propose()

    def _shorten(self, of_sensors: Array) -> None:
        """Let the sensors move less whose readings (n, n_sensors) differ most from what the slopes say."""
        predicted, moves = self.at_y.copy(), np.zeros(of_sensors.shape[1])
        for place, (sensor, _) in self.moved.items():
            change = self.trial[place] - self.y[place]
            predicted[:, sensor] += self.J[:, place] * change
            moves[sensor] = max(moves[sensor], abs(change) / self.state.prior[0][place])
        off = np.linalg.norm(of_sensors - predicted, axis=0)
        worst = (off >= WORST * off.max()) & (moves > 0)
        self.reach[worst] = self.state.settings.trust_shorter * moves[worst]
        self.ended = not worst.any() or moves[worst].max() < self.state.settings.trust_smallest

    def _propose(self) -> None:
        state, moved, (sd, low, high) = self.state, list(self.moved), self.state.prior
        reach = self.reach[[sensor for sensor, _ in self.moved.values()]] * sd[moved]
        low, high = np.maximum(low, state.x - state.radius * sd), np.minimum(high, state.x + state.radius * sd)
        low[moved] = np.maximum(low[moved], self.y[moved] - reach)
        high[moved] = np.minimum(high[moved], self.y[moved] + reach)
        self.trial = state.best_within(self.r + self.J @ self.y, self.J, low, high)
        expected = self.r - self.J @ (self.trial - self.y)
        gain = state.misfit(self.r, self.y) - state.misfit(expected, self.trial)
        self.ended = gain < state.settings.least_reduction

    def _with_columns(self, changes: Sequence[Array]) -> Array:
        """J with the slopes over the sensors' places at the trial."""
        names = list(self.residuals.study.stated_places)
        columns = []
        for number, of_run in zip(self.residuals.fitted, changes, strict=True):
            slopes, parts = of_run[1:], self.residuals.runs[number].parts()
            table = np.zeros((of_run.shape[1], len(self.moved)))
            for column, (sensor, direction) in enumerate(self.moved.values()):
                rows = parts.get(names[sensor], slice(0))
                table[rows, column] = slopes[direction, rows]
            columns.append(table)
        J = self.J.copy()
        J[:, list(self.moved)] = self._whitened(columns)
        return J

    def _by_sensor(self, by_run: Sequence[Array]) -> Array:
        """(n, n_sensors) whitened change of each sensor's readings, from that of all readings by run (n_blocks,), K."""
        columns = []
        for number, change in zip(self.residuals.fitted, by_run, strict=True):
            parts = self.residuals.runs[number].parts()
            table = np.zeros((len(change), len(self.reach)))
            for column, name in enumerate(self.residuals.study.stated_places):
                rows = parts.get(name, slice(0))
                table[rows, column] = change[rows]
            columns.append(table)
        return self._whitened(columns)

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
        questions = [(number, trial.state.current_values, trial.shift()) for trial in active for number in numbers]
        answers = predictions.evaluations.of("displaced", questions)
        for place, trial in enumerate(active):
            trial.answered(answers[place * len(numbers) : (place + 1) * len(numbers)])
    return [
        state if trial is None or trial.failed else state.expecting(trial.y, trial.r, trial.J)
        for state, trial in zip(states, trials, strict=True)
    ]
