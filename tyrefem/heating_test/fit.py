"""The most probable parameters of the rig: Gauss-Newton with Levenberg's damping and priors."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.heating_test.noise import Block, Noise, Normal, estimated, log_evidence, normal
from tyrefem.heating_test.parameters import Parameters, clock_of
from tyrefem.heating_test.readings import HeatingTest
from tyrefem.heating_test.twin import Twin

Array = NDArray[Any]
#: Step length that ends the fit, and one that ends a rough fit, in posterior standard deviations.
_CLOSE, _ROUGHLY = 0.1, 2.0
_MOST, _MOST_ROUGHLY = 25, 8
#: Largest step of a coordinate, because the problem is only locally linear.
_LONGEST = 1.5


@dataclass(frozen=True, eq=False)
class RigFit(Brief):
    """A finished fit.

    Attributes
    ----------
    parameters, x : free parameters and their coordinates (priors are N(0, 1)).
    covariance : of x, Laplace: (1 + J^T C^-1 J)^-1.
    noise : noise with the estimated model error.
    blocks : readings, computed readings and sensitivities at x.
    evidence : ln p(readings), Laplace.
    solutions : number of tests computed.
    """

    parameters: Parameters
    x: Array
    covariance: Array
    noise: Noise
    blocks: tuple[Block, ...]
    evidence: float
    solutions: int

    @property
    def values(self) -> dict[str, float]:
        """Name -> value of every parameter of the rig."""
        return self.parameters.values(self.x)


class Fitter:
    """Fits a rig's parameters to its tests; counts the solutions."""

    def __init__(self, twin: Twin, tests: Sequence[HeatingTest], progress: Callable[[], None] | None = None) -> None:
        self.twin, self.tests, self.progress = twin, tuple(tests), progress or (lambda: None)
        self.solutions = 0

    def predict(self, parameters: Parameters, x: Array) -> list[tuple[Array, Array]]:
        """(fields, readings at computed times) of every test."""
        values, out = parameters.values(x), []
        for test in self.tests:
            fields = self.twin.fields(values, test.run, test.clock)
            out.append((fields, self.twin.readings_of_fields(values, test.clock, fields)))
            self.solutions += 1
            self.progress()
        return out

    def blocks(self, parameters: Parameters, x: Array, predicted: list[tuple[Array, Array]]) -> tuple[Block, ...]:
        """Residuals and sensitivities of every series."""
        blocks = []
        for test, (fields, seen) in zip(self.tests, predicted, strict=True):
            slopes = self.twin.slopes(parameters, x, test.run, test.clock, fields, seen)
            late = parameters.values(x).get(clock_of(test.name), 0.0)
            for series in test.series:
                column = self.twin.sensors.index(series.sensor)
                matrix = series.at(late)
                rise = np.maximum(matrix @ (seen[:, column] - seen[0, column]), 0.0)
                along = matrix @ slopes[:, column]
                if clock_of(test.name) in parameters.names:
                    place = parameters.names.index(clock_of(test.name))
                    along[:, place] = series.clock_slope(late) @ seen[:, column] * parameters.free[place].spread
                blocks.append(Block(series, matrix @ seen[:, column], along, rise))
        return tuple(blocks)

    def _cost(
        self, parameters: Parameters, predicted: list[tuple[Array, Array]], x: Array, factors: list[Array]
    ) -> float:
        from scipy.linalg import solve_triangular

        total, k = float(x @ x), 0
        for test, (_, seen) in zip(self.tests, predicted, strict=True):
            late = parameters.values(x).get(clock_of(test.name), 0.0)
            for series in test.series:
                r = series.readings - series.at(late) @ seen[:, self.twin.sensors.index(series.sensor)]
                white = solve_triangular(factors[k], r, lower=True, check_finite=False)
                total, k = total + float(white @ white), k + 1
        return total

    def fit(self, parameters: Parameters, x: Array, noise: Noise, floor: float, *, rough: bool = False) -> RigFit:
        """Fit from coordinates x; when the fit has nearly converged, the model error is estimated twice.

        A rough fit ends early, close enough to find missing slopes of properties.
        """
        predicted = self.predict(parameters, x)
        damping, rounds = 0.1 if rough else 0.0, 0
        for count in range(_MOST + 1):
            blocks = self.blocks(parameters, x, predicted)
            eq = normal(blocks, noise)
            left = _length(eq, x)
            if left < 0.7 and rounds < 2 and not rough:
                noise, rounds = estimated(blocks, x, noise, floor), rounds + 1
                eq = normal(blocks, noise)
                left = _length(eq, x)
            done = left < _ROUGHLY or count == _MOST_ROUGHLY if rough else left < _CLOSE and rounds == 2
            if done or count == _MOST:
                break
            x, predicted, damping = self._step(parameters, x, predicted, eq, blocks, noise, damping)
        covariance = np.linalg.inv(np.eye(x.size) + eq.matrix)
        return RigFit(parameters, x, covariance, noise, blocks, log_evidence(eq, x), self.solutions)

    def _step(
        self,
        parameters: Parameters,
        x: Array,
        predicted: list[tuple[Array, Array]],
        eq: Normal,
        blocks: tuple[Block, ...],
        noise: Noise,
        damping: float,
    ) -> tuple[Array, list[tuple[Array, Array]], float]:
        """Make a step that lowers the cost; return also the damping for the next step."""
        factors = [noise.factor(block.series, block.rise) for block in blocks]
        before = self._cost(parameters, predicted, x, factors)
        for _ in range(6):
            H = np.eye(x.size) + eq.matrix + damping * np.diag(np.diag(eq.matrix))
            step = _bounded(H, eq.right - x)
            trial = self.predict(parameters, x + step)
            if self._cost(parameters, trial, x + step, factors) < before + 1e-3:
                return x + step, trial, damping / 10 if damping > 1e-3 else 0.0
            damping = max(10 * damping, 0.1)
        return x, predicted, damping


def _length(eq: Normal, x: Array) -> float:
    """Length of the Gauss-Newton step in posterior standard deviations."""
    g = eq.right - x
    return float(np.sqrt(np.maximum(g @ np.linalg.solve(np.eye(x.size) + eq.matrix, g), 0.0)))


def _bounded(H: Array, g: Array) -> Array:
    """The step H^-1 g with bounded coordinates: coordinates at a bound are fixed, and the rest is solved again."""
    step, held = np.zeros(g.size), np.zeros(g.size, dtype=bool)
    for _ in range(g.size):
        free = ~held
        step[free] = np.linalg.solve(H[np.ix_(free, free)], g[free] - H[np.ix_(free, held)] @ step[held])
        beyond = free & (np.abs(step) > _LONGEST)
        if not beyond.any():
            break
        worst = int(np.argmax(np.abs(step) * beyond))
        step[worst] = np.clip(step[worst], -_LONGEST, _LONGEST)
        held[worst] = True
    return step
