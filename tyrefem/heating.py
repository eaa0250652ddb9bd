"""Strain energy x tan delta x revolutions -> heat source in W/m3."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief, Stated
from tyrefem.drive import Drive
from tyrefem.footprint.loss_tangent import Loss
from tyrefem.loading import LoadCase
from tyrefem.strain import ORDERS, StrainCycle

Array = NDArray[np.float64]

#: Energy lost per cycle over U tan d / pi: the report's U stands for E' e0^2, the strict one for half of it (eq 25).
LOSS_FACTOR = {"nasa": 1.0, "sinusoid": 2.0}
#: Times of which a schedule keeps what it has worked out.
REMEMBERED = 512


@dataclass(frozen=True, eq=False)
class CycleSchedule(Brief, Stated):
    """The strain cycles of a drive: for each phase the load cases at ``knots`` fractions of it.

    Between knots the strain energy is interpolated linearly in time.
    """

    drive: Drive
    knots: tuple[tuple[float, ...], ...]
    cases: tuple[tuple[LoadCase, ...], ...]
    cycles: tuple[tuple[StrainCycle, ...], ...]

    def weights(self, time: float) -> list[tuple[int, int, float]]:
        """(phase, knot, weight) of the load cases that make up a time."""
        return self._moment(time)[0]

    def _moment(self, time: float) -> tuple[list[tuple[int, int, float]], float]:
        """Weights and revolutions per second of a time; remembered, as every zone and film asks for the same times."""
        if time not in self._moments:
            if len(self._moments) >= REMEMBERED:
                self._moments.clear()
            weights = self._weights(time)
            radius = sum(weight * self.cases[phase][knot].rolling_radius for phase, knot, weight in weights)
            self._moments[time] = weights, self.drive.slip(time).rolling_speed / (2 * math.pi * radius)
        return self._moments[time]

    @functools.cached_property
    def _moments(self) -> dict[float, tuple[list[tuple[int, int, float]], float]]:
        return {}

    def _weights(self, time: float) -> list[tuple[int, int, float]]:
        phase, fraction = self.drive.locate(time)
        knots = self.knots[phase]
        if len(knots) == 1:
            return [(phase, 0, 1.0)]
        right = int(np.clip(np.searchsorted(knots, fraction), 1, len(knots) - 1))
        share = (fraction - knots[right - 1]) / (knots[right] - knots[right - 1])
        return [(phase, right - 1, 1 - share), (phase, right, share)]

    def mean(self, quantity: Callable[[LoadCase], float], time: float) -> float:
        """A quantity of the load case at a time, e.g. its deflection."""
        return sum(weight * quantity(self.cases[phase][knot]) for phase, knot, weight in self.weights(time))

    @property
    def zones(self) -> tuple[Any, ...]:
        """The strain provider's zones."""
        return self.cycles[0][0].zones

    def revolutions_per_second(self, time: float) -> float:
        """v / (2 pi r_r), 1/s, v the speed of the tread on the rolling radius: the vehicle's less slip."""
        return self._moment(time)[1]


@dataclass(eq=False)
class HeatSource:
    """q = W f, W/m3, of one zone: W = pi U tan(delta)(T) lost per revolution (Clark & Dodge 1980, eq 25), f = v / (2 pi
    r_r) revolutions per second, so q = U tan(delta)(T) v / (2 r_r) (eq 26); twice that for ``sinusoid``.

    Where tan delta depends on frequency (``over_frequency``), q = pi f sum_n U_n tan(delta)(n f, T), U_n the share of
    the cycle that runs n times per revolution; one for all where the strain law knows one cycle only.

    Called by the conduction solver with nodes x (2, n), time t (s) and temperatures T (n,), degC. The strain energy at
    the nodes is evaluated once per load case, as the solver passes the same x at every call.
    """

    zone: str
    schedule: CycleSchedule
    loss_tangent: Callable[[Array], Array]
    loss_factor: float = 1.0
    over_frequency: Loss | None = None
    _nodes: Array | None = field(default=None, init=False, repr=False)
    _energies: dict[tuple[int, int], Array] = field(default_factory=dict, init=False, repr=False)
    _spectra: dict[tuple[int, int], Array] = field(default_factory=dict, init=False, repr=False)
    _losses: tuple[float, Array] | None = field(default=None, init=False, repr=False)

    @property
    def lost_per_revolution(self) -> float:
        """W / (U tan delta): energy lost per revolution over strain energy and loss tangent, pi or 2 pi (eq 25)."""
        return math.pi * self.loss_factor

    def energy_density(self, x: Array, t: float) -> Array:
        """U, J/m3, at nodes and time."""
        self._meet(x)
        total: Array = np.zeros(x.shape[1])
        for phase, knot, weight in self.schedule.weights(t):
            if (phase, knot) not in self._energies:
                cycle = self.schedule.cycles[phase][knot]
                self._energies[phase, knot] = cycle.energy_density(self.zone, x)
            total = total + weight * self._energies[phase, knot]
        return total

    def spectrum(self, x: Array, t: float) -> Array:
        """(orders, n) U, J/m3, at nodes and time, by how often per revolution it runs: the first of `strain.ORDERS`."""
        self._meet(x)
        parts = []
        for phase, knot, weight in self.schedule.weights(t):
            if (phase, knot) not in self._spectra:
                cycle = self.schedule.cycles[phase][knot]
                own = getattr(cycle, "spectrum", None)
                one = cycle.energy_density(self.zone, x)[None] if own is None else own(self.zone, x)
                self._spectra[phase, knot] = np.asarray(one)
            parts.append(weight * self._spectra[phase, knot])
        total: Array = np.zeros((max(len(part) for part in parts), x.shape[1]))
        for part in parts:
            total[: len(part)] += part
        return total

    def _meet(self, x: Array) -> None:
        if self._nodes is not x:
            self._nodes, self._losses = x, None
            self._energies.clear()
            self._spectra.clear()

    def __call__(self, x: Array, t: float, T: Array) -> Array:
        revolutions = self.schedule.revolutions_per_second(t)
        if revolutions == 0:
            return np.zeros(x.shape[1])
        if self._nodes is not x or self._losses is None or self._losses[0] != t:
            work = self.energy_density if self.over_frequency is None else self.spectrum
            self._losses = t, self.lost_per_revolution * revolutions * work(x, t)
        losses = self._losses[1]
        if self.over_frequency is None:
            return losses * self.loss_tangent(T)
        heat: Array = np.zeros(x.shape[1])
        for order, loss in zip(ORDERS, losses, strict=False):
            if loss.any():
                heat += loss * self.over_frequency(order * revolutions, T)
        return heat


def warming_knots(count: int) -> Sequence[float]:
    """Fractions of a phase at which strain cycles follow the temperature: closer at its start, where it rises fast.

    >>> warming_knots(5)
    (0.0, 0.0625, 0.25, 0.5625, 1.0)
    """
    return tuple(float(x) for x in np.linspace(0.0, 1.0, count) ** 2)


def ramp_knots(changes: bool, count: int = 9) -> Sequence[float]:
    """Fractions of a phase at which load cases are solved: one, or ``count`` where the load changes.

    Nine leave less than 0.2 % of the heat of a ramp between no load and the rated one (five: 1.3 %).
    """
    return tuple(np.linspace(0.0, 1.0, count)) if changes else (0.0,)
