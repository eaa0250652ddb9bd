"""Loads of films, fluxes, radiation and natural convection on the unknowns."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from tyrefem.cache import read_only
from tyrefem.conduction.conditions import Convection, Film, Flux, Radiation
from tyrefem.conduction.datum import Datum, checked
from tyrefem.conduction.operators import Surface
from tyrefem.conduction.terms import SLOPE_STEP, STALE, LinearPart, Load, State
from tyrefem.errors import InputError

Array = NDArray[Any]

STEFAN_BOLTZMANN = 5.67e-8


class FilmLoad(Load):
    """h (sink - T), with a temperature or a reservoir as sink."""

    def __init__(self, surface: Surface, film: Film, field: str, reservoir: int | None) -> None:
        self.s, self.reservoir = surface, reservoir
        self.h = Datum(film.h, surface.x, f"{field}.h", low=0.0)
        self.sink = Datum(0.0 if reservoir is not None else film.sink, surface.x, f"{field}.sink")
        self.timed = not (self.h.constant and self.sink.constant)
        self.static = not self.timed
        self.h0: Any = 0.0

    def freeze(self, t: float, y: State, linear: LinearPart) -> None:
        self.h0 = self.h(t)
        self.row = linear.add_film(self.s, self.h0, self.reservoir)
        self.total = float(self.row.sum())

    def clear_cache(self) -> None:
        self.h.clear_cache()
        self.sink.clear_cache()

    def stale(self, t: float, y: State) -> bool:
        if self.h.constant:
            return False
        h = self.h(t)
        if isinstance(h, float) and isinstance(self.h0, float):
            return abs(h - self.h0) > STALE * max(h, self.h0)
        return bool(np.max(np.abs(h - self.h0)) > STALE * max(np.max(h), np.max(self.h0)))

    def remainder(self, t: float, y: State, G: Array, Gg: Array) -> float:
        s, r = self.s, self.reservoir
        flux, more = self.excess(t, y)
        changed = more != 0.0 if isinstance(more, float) else more.any()
        if r is not None and not changed:
            return 0.0
        load = s.load(flux)
        if changed:
            load = load - s.loss(more, y.u[s.dofs])
        G[s.dofs] += load
        power = float(load.sum())
        if r is not None:
            Gg[r] -= power
        return power

    def excess(self, t: float, y: State) -> tuple[Any, Any]:
        """Remainder beside the frozen part, q = flux - more T: W/m2 and W/m2/K, numbers or values at the points."""
        h = self.h(t)
        more = h - self.h0
        return (h * self.sink(t) if self.reservoir is None else more * float(y.g[self.reservoir])), more

    def linear_power(self, y: State) -> float:
        from_reservoir = 0.0 if self.reservoir is None else self.total * y.g[self.reservoir]
        return float(from_reservoir - self.row @ y.u[self.s.dofs])

    def coupling(self, t: float, u: Array) -> tuple[float, float]:
        """Integrals of h T and of h over the surface at this time, W and W/K."""
        weighted = self.s.weight * self.h(t)
        return float(weighted @ (self.s.trace @ u[self.s.dofs])), float(weighted.sum())


class FluxLoad(Load):
    """A given flux into the body, or one that depends on the surface's temperature."""

    def __init__(self, surface: Surface, flux: Flux, field: str) -> None:
        self.s, self._field = surface, f"{field}.q"
        self._of_temperature: Any = flux.q if flux.of_temperature else None
        self._datum = Datum(0.0 if flux.of_temperature else flux.q, surface.x, self._field)
        self.static = self._datum.constant and not flux.of_temperature
        self.timed = not self.static

    def clear_cache(self) -> None:
        self._datum.clear_cache()

    @property
    def of_temperature(self) -> bool:
        """True if the flux depends on the surface's temperature."""
        return self._of_temperature is not None

    def value(self, t: float, u: Array) -> Any:
        """The flux at the surface's points, W/m2: a number or (n,)."""
        if self._of_temperature is None:
            return self._datum(t)
        T = self.s.trace @ u[self.s.dofs]
        return checked(self._of_temperature(self.s.x, t, T), T.size, self._field, t)

    def remainder(self, t: float, y: State, G: Array, Gg: Array) -> float:
        load = self.s.load(self.value(t, y.u))
        G[self.s.dofs] += load
        return float(load.sum())

    def jacobian(self, t: float, y: State) -> csr_matrix | None:
        if not self.of_temperature:
            return None
        u, n = y.u, y.u.size
        dq = (self.value(t, u + SLOPE_STEP) - self.value(t, u - SLOPE_STEP)) / (2 * SLOPE_STEP)
        return self.s.film_matrix(dq, n)


class RadiationLoad(Load):
    """eps sigma (Ts^4 - T^4); its frozen part is 4 eps sigma T^3 at the temperature of the last freeze."""

    def __init__(self, surface: Surface, radiation: Radiation, field: str) -> None:
        self.s, self.factor = surface, STEFAN_BOLTZMANN * float(radiation.emissivity)
        self.surroundings = Datum(radiation.surroundings, surface.x, f"{field}.surroundings", low=-273.15)
        self.timed = not self.surroundings.constant

    def clear_cache(self) -> None:
        self.surroundings.clear_cache()

    def slopes(self, t: float, y: State) -> Array:
        """Quadrature values of -dq/dT."""
        return 4 * self.factor * (self.s.trace @ y.u[self.s.dofs] + 273.15) ** 3

    def freeze(self, t: float, y: State, linear: LinearPart) -> None:
        self.h0 = self.slopes(t, y)
        self.row = linear.add_film(self.s, self.h0)

    def stale(self, t: float, y: State) -> bool:
        return bool(np.any(np.abs(self.slopes(t, y) - self.h0) > STALE * self.h0))

    def remainder(self, t: float, y: State, G: Array, Gg: Array) -> float:
        T = self.s.trace @ y.u[self.s.dofs]
        q = self.factor * ((self.surroundings(t) + 273.15) ** 4 - (T + 273.15) ** 4)
        load = self.s.trace_t @ (self.s.weight * (q + self.h0 * T))
        G[self.s.dofs] += load
        return float(load.sum())

    def linear_power(self, y: State) -> float:
        return float(-self.row @ y.u[self.s.dofs])


#: Half the temperature difference for the slope of the heat flux, K.
_BUMP = 0.05


class ConvectionLoad(Load):
    """h(T) (sink - T); its frozen part is the slope of h (T - sink) at the temperature of the last freeze."""

    def __init__(self, surface: Surface, convection: Convection, field: str) -> None:
        self.s, self.h, self.sink, self._field = surface, convection.h, float(convection.sink), f"{field}.h"

    def _loss(self, T: Array, t: float) -> Array:
        h = checked(self.h(read_only(T)), T.size, self._field, t)
        if np.min(h) < 0:
            raise InputError(f"is negative between {T.min():.6g} and {T.max():.6g} degC", field=self._field)
        return np.asarray(h * (T - self.sink))

    def _slopes(self, t: float, y: State) -> Array:
        """Quadrature values of -dq/dT, at least 0: a negative value would be unstable."""
        T = self.s.trace @ y.u[self.s.dofs]
        slopes = (self._loss(T + _BUMP, t) - self._loss(T - _BUMP, t)) / (2 * _BUMP)
        return np.asarray(np.maximum(slopes, 0.0))

    def freeze(self, t: float, y: State, linear: LinearPart) -> None:
        self.h0 = self._slopes(t, y)
        self.row = linear.add_film(self.s, self.h0)

    def stale(self, t: float, y: State) -> bool:
        # The largest film is the criterion: near the sink's temperature the slope of natural convection is steep but
        # small.
        now = self._slopes(t, y)
        return bool(np.max(np.abs(now - self.h0)) > STALE * max(np.max(now), np.max(self.h0)))

    def remainder(self, t: float, y: State, G: Array, Gg: Array) -> float:
        T = self.s.trace @ y.u[self.s.dofs]
        load = self.s.trace_t @ (self.s.weight * (self.h0 * T - self._loss(T, t)))
        G[self.s.dofs] += load
        return float(load.sum())

    def linear_power(self, y: State) -> float:
        return float(-self.row @ y.u[self.s.dofs])
