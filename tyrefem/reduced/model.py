"""The rolling tyre on a few modes: conduction, films, capacity projected; heat sources known from a few places."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction import Film, Material, Reservoir
from tyrefem.conduction.conditions import is_number
from tyrefem.conduction.operators import Operators
from tyrefem.errors import InputError
from tyrefem.rolling import RollingTyre

Array = NDArray[np.float64]


class NotReducibleError(InputError):
    """Something of a study is not in the reduced model: run it in full."""


@dataclass(frozen=True, eq=False)
class ReducedModel:
    """A tyre's heat balance on modes u = V a; gas and rim keep their own states.

    M a' = -sum_i k_i K_i a - sum_j h_j (R_j a - r_j T_j) + sum_z V^T S_z q_z(T),  q_z from `samples` of the nodes.

    Parameters
    ----------
    base : the tyre it was made for; others must be on its mesh. V : (n, m) modes.
    samples : zone -> numbers of the nodes (among the zone's) where its source is evaluated.
    nodes_from_samples : (all zones' nodes, all samples) that tells the source everywhere.
    """

    base: RollingTyre
    V: Array
    samples: Mapping[str, Array]
    nodes_from_samples: Array

    @property
    def operators(self) -> Operators:
        """Of the full model."""
        return self.base.problem.operators

    @property
    def size(self) -> int:
        """Number of modes."""
        return int(self.V.shape[1])

    @functools.cached_property
    def mass(self) -> dict[str, Array]:
        """Region -> (m, m), for a heat capacity of 1 J/m3/K."""
        ops = self.operators
        return {region: self._projected(ops.mass(region)) for region in self.base.bodies}

    @functools.cached_property
    def stored_row(self) -> dict[str, Array]:
        """Region -> (m,): J/K of the mean temperature, for a heat capacity of 1 J/m3/K."""
        ops = self.operators
        ones = np.ones(ops.size)
        return {region: (ops.matrix(ops.mass(region)) @ ones) @ self.V for region in self.base.bodies}

    @functools.cached_property
    def conduction(self) -> dict[str, tuple[Array, Array]]:
        """Region -> (m, m) along and across, for 1 W/m/K."""
        ops = self.operators
        return {
            region: tuple(self._projected(one) for one in ops.conduction(region, body.direction))  # type: ignore[misc]
            for region, body in self.base.bodies.items()
        }

    @functools.cached_property
    def surfaces(self) -> dict[str, tuple[Array, Array, float]]:
        """Side -> R (m, m), r (m,) and area (m2), for a film of 1 W/m2/K."""
        ops, found = self.operators, {}
        for side in self.base.boundaries:
            surface = ops.surface(side)
            data = np.zeros(ops.nnz)
            where, value = surface.even_exchange
            np.add.at(data, where, value)
            row = np.zeros(ops.size)
            row[surface.dofs] = surface.load(1.0)
            found[side] = (self._projected(data), row @ self.V, float(row.sum()))
        return found

    @functools.cached_property
    def zones(self) -> list[str]:
        """Strain zones, in the order of the samples."""
        return list(self.samples)

    @functools.cached_property
    def sample_points(self) -> dict[str, Array]:
        """Zone -> (2, k) m: always the same arrays, so that a source remembers what it found there."""
        ops = self.operators
        return {zone: np.ascontiguousarray(ops.nodes(zone)[:, chosen]) for zone, chosen in self.samples.items()}

    @functools.cached_property
    def sample_slices(self) -> dict[str, slice]:
        """Zone -> its part of all samples."""
        ends = np.cumsum([0, *(len(one) for one in self.samples.values())])
        return {zone: slice(int(a), int(b)) for zone, a, b in zip(self.zones, ends[:-1], ends[1:], strict=True)}

    @functools.cached_property
    def at_samples(self) -> Array:
        """(n_samples, m): modes at the samples."""
        ops = self.operators
        return np.vstack([self.V[ops.dofs(zone)[chosen]] for zone, chosen in self.samples.items()])

    @functools.cached_property
    def _zone_rows(self) -> dict[str, slice]:
        ends = np.cumsum([0, *(len(self.operators.dofs(zone)) for zone in self.zones)])
        return {zone: slice(int(a), int(b)) for zone, a, b in zip(self.zones, ends[:-1], ends[1:], strict=True)}

    @functools.cached_property
    def load(self) -> Array:
        """(m, n_samples): heat into the modes of the sources at the samples."""
        found = np.zeros((self.size, self.nodes_from_samples.shape[1]))
        for zone, rows in self._zone_rows.items():
            found += (self.operators.source(zone).T @ self.V).T @ self.nodes_from_samples[rows]
        return found

    @functools.cached_property
    def power(self) -> Array:
        """(n_zones, n_samples): W of every zone from the sources at the samples."""
        rows = []
        for zone, part in self._zone_rows.items():
            row = np.asarray(self.operators.source(zone).sum(axis=0)).ravel()
            rows.append(row @ self.nodes_from_samples[part])
        return np.array(rows)

    def _projected(self, data: Array) -> Array:
        return np.asarray(self.V.T @ (self.operators.matrix(data) @ self.V))

    def balance(self, tyre: RollingTyre) -> ReducedBalance:
        """The heat balance of a tyre on these modes.

        Raises
        ------
        NotReducibleError : another mesh, properties that depend on temperature, fluxes, radiation, sliding.
        """
        if tyre.mesh is not self.base.mesh:
            raise NotReducibleError("another mesh: geometry, strain zones or [mesh] differ")
        bodies = {region: _constant(region, body) for region, body in tyre.bodies.items()}
        films: list[tuple[str, int, Film]] = []
        for side, conditions in tyre.boundaries.items():
            for number, condition in enumerate(conditions):
                if not isinstance(condition, Film):
                    raise NotReducibleError(f"{type(condition).__name__} at '{side}'")
                films.append((side, number, condition))
        reservoirs = tyre._reservoirs()
        for name, one in reservoirs.items():
            if not is_number(one.heat_capacity) or not float(one.heat_capacity) > 0:  # type: ignore[arg-type]
                raise NotReducibleError(f"heat capacity of '{name}' is none, or depends on temperature")
        return ReducedBalance(self, tyre, bodies, films, reservoirs)


def _constant(region: str, body: Material) -> tuple[float, float, float]:
    """Conductivity along, across, and heat capacity."""
    k = body.conductivity
    if callable(k) or not is_number(body.heat_capacity):
        raise NotReducibleError(f"conductivity or heat capacity of '{region}' depends on temperature")
    along, across = k if isinstance(k, tuple | list) else (k, k)
    return float(along), float(across), float(body.heat_capacity)  # type: ignore[arg-type]


class ReducedBalance:
    """M y' = A(t) y + b(t) + sources, y = (a, reservoirs)."""

    def __init__(
        self,
        model: ReducedModel,
        tyre: RollingTyre,
        bodies: Mapping[str, tuple[float, float, float]],
        films: Sequence[tuple[str, int, Film]],
        reservoirs: Mapping[str, Reservoir],
    ) -> None:
        self.model, self.tyre, self.bodies, self.films, self.reservoirs = model, tyre, bodies, films, reservoirs
        m, names = model.size, list(reservoirs)
        n = m + len(names)
        self.M = np.zeros((n, n))
        self.K = np.zeros((n, n))
        for region, (along, across, capacity) in bodies.items():
            self.M[:m, :m] += capacity * model.mass[region]
            first, second = model.conduction[region]
            self.K[:m, :m] += along * first + across * second
        for i, name in enumerate(names):
            self.M[m + i, m + i] = float(reservoirs[name].heat_capacity)  # type: ignore[arg-type]
        #: (coefficient(t), sink(t) or None, matrix (n, n), load (n,)) of everything that exchanges heat.
        self.exchanges: list[tuple[Any, Any, Array, Array]] = []
        for side, _, film in films:
            R, r, area = model.surfaces[side]
            matrix, load = np.zeros((n, n)), np.zeros(n)
            matrix[:m, :m] = R
            if isinstance(film.sink, str):
                g = m + names.index(film.sink)
                matrix[:m, g] = -r
                matrix[g, :m] = -r
                matrix[g, g] = area
            else:
                load[:m] = r
            self.exchanges.append((film.h, None if isinstance(film.sink, str) else film.sink, matrix, load))
        for i, name in enumerate(names):
            for conductance, other in reservoirs[name].exchanges:
                matrix, load = np.zeros((n, n)), np.zeros(n)
                matrix[m + i, m + i] = 1.0
                if isinstance(other, str):
                    j = m + names.index(other)
                    matrix[m + i, j] = matrix[j, m + i] = -1.0
                    matrix[j, j] = 1.0
                else:
                    load[m + i] = 1.0
                self.exchanges.append(
                    (_timed(conductance), None if isinstance(other, str) else _timed(other), matrix, load)
                )
        self.stack = np.array([one[2] for one in self.exchanges]).reshape(len(self.exchanges), n, n)
        self.loads = np.array([one[3] for one in self.exchanges]).reshape(len(self.exchanges), n)
        self.start = np.zeros(n)
        initial = tyre.drive.initial
        # The first mode is even: V a = initial.
        self.start[0] = initial / model.V[0, 0]
        for i, name in enumerate(names):
            own = reservoirs[name].initial
            self.start[m + i] = initial if own is None else own

    def coefficients(self, t: float) -> tuple[Array, Array]:
        """(films and conductances, their sinks) at a time."""
        h = np.array([_value(one[0], t) for one in self.exchanges])
        sinks = np.array([0.0 if one[1] is None else _value(one[1], t) for one in self.exchanges])
        return h, sinks

    def source(self, t: float, a: Array) -> Array:
        """(n_samples,) W/m3 at the samples."""
        model = self.model
        T = model.at_samples @ a
        q = np.empty(len(T))
        for zone, part in model.sample_slices.items():
            q[part] = self.tyre.sources[zone](model.sample_points[zone], t, T[part])
        return q

    def powers(self, t: float) -> list[float]:
        """W put into every reservoir from outside."""
        return [_value(_timed(one.power), t) for one in self.reservoirs.values()]


def _timed(datum: Any) -> Any:
    return (lambda _x, t: datum(t)) if callable(datum) else datum


def _value(datum: Any, t: float) -> float:
    """A number, or a function of time that does not vary in space."""
    return float(datum(None, t)) if callable(datum) else float(datum)
