"""Bodies and films as a linear system: plateaus, and times to 63 % of the way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.lumped.card import SURROUNDINGS, LumpedRun, ThermalCard

Array = NDArray[np.float64]
#: Share of the way that is left after one time constant.
LEFT = np.exp(-1.0)


@dataclass(frozen=True, eq=False)
class LumpedNetwork:
    """C dT/dt = s P + sum over films of G (T_other - T), per body.

    Parameters
    ----------
    card : bodies and films. capacities : C of each body, J/K. at_rest, rise : of each film, W/K and W/K per m/s.
    shares : s of each body.
    """

    card: ThermalCard
    capacities: Array
    at_rest: Array
    rise: Array
    shares: Array

    def system(self, run: LumpedRun, speed: float, heat: float) -> tuple[Array, Array]:
        """K (n, n), W/K, and f (n,), W, of C dT/dt = f - K T."""
        names = list(self.card.bodies)
        K, f = np.zeros((len(names), len(names))), self.shares * heat
        for film, at_rest, rise in zip(self.card.films, self.at_rest, self.rise, strict=True):
            conductance = at_rest + rise * speed
            for body, other in (film.between, film.between[::-1]):
                if body in SURROUNDINGS:
                    continue
                i = names.index(body)
                K[i, i] += conductance
                if other in SURROUNDINGS:
                    f[i] += conductance * run.surroundings(other)
                else:
                    K[i, names.index(other)] -= conductance
        return K, f

    def plateau(self, run: LumpedRun) -> Array:
        """Temperature of each body, degC."""
        K, f = self.system(run, run.speed, run.heat)
        return np.asarray(np.linalg.solve(K, f), dtype=float)

    def warm_up(self, run: LumpedRun) -> Array:
        """Time of each body to 63 % of its way from the start to the plateau, s."""
        start = np.full(len(self.capacities), run.air if run.start is None else run.start)
        return self._times(*self.system(run, run.speed, run.heat), start)

    def cool_down(self, run: LumpedRun) -> Array:
        """Time of each body to 63 % of its way from the plateau, without heat, s."""
        return self._times(*self.system(run, run.cool_down_speed, 0.0), self.plateau(run))

    def _times(self, K: Array, f: Array, start: Array) -> Array:
        root = np.sqrt(self.capacities)
        rates, modes = np.linalg.eigh(K / np.outer(root, root))
        end = np.linalg.solve(K, f)
        # left(t) of body i: sum over modes of parts[i, m] exp(-rate_m t), as a share of the whole way.
        parts = (modes / root[:, None]) * (modes.T @ (root * (start - end)))[None, :]
        way = start - end
        return np.array([_crossing(part / gone, rates) if abs(gone) > 1e-9 else np.nan
                         for part, gone in zip(parts, way, strict=True)])  # fmt: skip


def _crossing(parts: Array, rates: Array) -> float:
    """First time at which the sum of parts exp(-rates t) falls to 1/e."""
    from scipy.optimize import brentq

    def above(t: float) -> float:
        return float(parts @ np.exp(-rates * t)) - LEFT

    times = np.geomspace(1e-3 / rates.max(), 50.0 / rates.min(), 200)
    values = np.exp(-np.outer(times, rates)) @ parts - LEFT
    below = int(np.argmax(values < 0))
    return float(brentq(above, times[below - 1] if below else 0.0, times[below], xtol=1e-9 * times[below]))
