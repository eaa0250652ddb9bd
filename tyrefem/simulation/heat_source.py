"""Heat source from strain energy x tan delta x revolutions per second, W/m3."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tyrefem.inputs.motion import WheelMotion
from tyrefem.materials.loss_tangent import Loss
from tyrefem.mechanics.cycle_schedule import CycleSchedule
from tyrefem.mechanics.strain_cycle import ORDERS

Array = NDArray[np.float64]


@dataclass(eq=False)
class HeatSource:
    """q = W f, W/m3, of one zone: W = pi U tan(delta)(T) lost per revolution (Clark & Dodge 1980, eq 25), f = v / (2 pi
    r_r) revolutions per second, so q = U tan(delta)(T) v / (2 r_r) (eq 26); twice that for ``sinusoid``.

    Where tan delta depends on frequency (``over_frequency``), q = pi f sum_n U_n tan(delta)(n f, T), U_n the part of
    the cycle with n periods per revolution; a strain law with one cycle has only n = 1.

    The conduction solver calls it with nodes x (2, n), time t, s, and temperatures T (n,), degC. The strain energy at
    the nodes is evaluated once per load case, because the solver passes the same x in every call.
    """

    zone: str
    schedule: CycleSchedule
    motion: WheelMotion
    loss_tangent: Callable[[Array], Array]
    loss_factor: float = 1.0
    over_frequency: Loss | None = None
    _nodes: Array | None = field(default=None, init=False, repr=False)
    _energies: dict[tuple[int, int], Array] = field(default_factory=dict, init=False, repr=False)
    _spectra: dict[tuple[int, int], Array] = field(default_factory=dict, init=False, repr=False)
    #: Latest moment (`CycleSchedule.moment`), revolutions per second and loss at the nodes.
    _losses: tuple[tuple[int, float], float, Array] | None = field(default=None, init=False, repr=False)

    @property
    def lost_per_revolution(self) -> float:
        """W / (U tan delta): energy lost per revolution over strain energy and loss tangent, pi or 2 pi (eq 25)."""
        return math.pi * self.loss_factor

    def energy_density(self, x: Array, t: float) -> Array:
        """U, J/m3, at nodes and a time."""
        self._meet(x)
        total: Array = np.zeros(x.shape[1])
        for phase, knot, weight in self.schedule.weights(t):
            if (phase, knot) not in self._energies:
                cycle = self.schedule.cycles[phase][knot]
                self._energies[phase, knot] = cycle.energy_density(self.zone, x)
            total = total + weight * self._energies[phase, knot]
        return total

    def spectrum(self, x: Array, t: float) -> Array:
        """(orders, n) U, J/m3, at nodes and a time, by periods per revolution: the first of `ORDERS`."""
        self._meet(x)
        parts = []
        for phase, knot, weight in self.schedule.weights(t):
            if (phase, knot) not in self._spectra:
                cycle = self.schedule.cycles[phase][knot]
                by_order = getattr(cycle, "spectrum", None)
                energies = cycle.energy_density(self.zone, x)[None] if by_order is None else by_order(self.zone, x)
                self._spectra[phase, knot] = np.asarray(energies)
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
        moment = self.schedule.moment(t)
        if self._nodes is not x or self._losses is None or self._losses[0] != moment:
            revolutions = self.motion(t).revolutions_per_second
            if revolutions == 0:
                return np.zeros(x.shape[1])
            work = self.energy_density if self.over_frequency is None else self.spectrum
            self._losses = moment, revolutions, self.lost_per_revolution * revolutions * work(x, t)
        _, revolutions, losses = self._losses
        if self.over_frequency is None:
            return losses * self.loss_tangent(T)
        heat: Array = np.zeros(x.shape[1])
        for order, loss in zip(ORDERS, losses, strict=False):
            if loss.any():
                heat += loss * self.over_frequency(order * revolutions, T)
        return heat
