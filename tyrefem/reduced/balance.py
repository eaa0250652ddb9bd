"""Heat balance of a variant on the POD modes: masses, conduction, films and reservoirs."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction import Film, Material, Reservoir
from tyrefem.conduction.conditions import is_number
from tyrefem.geometry.meshing.topology import OtherTopologyError
from tyrefem.reduced.exchanges import Exchanges, Layout
from tyrefem.reduced.model import NotReducibleError, ReducedModel
from tyrefem.reduced.shaped_model import on_tyre
from tyrefem.simulation.rolling_resistance import RollingPhase
from tyrefem.simulation.rolling_tyre import RollingTyre

Array = NDArray[np.float64]


class ReducedBalance:
    """M y' = A(t) y + b(t) + sources, with y = (mode amplitudes a, reservoir temperatures)."""

    #: Inputs that are known without the tyre, by name; see `reduced.learnt_inputs`.
    known: Mapping[str, Array] | None = None

    def __init__(
        self,
        model: ReducedModel,
        tyre: RollingTyre,
        bodies: Mapping[str, tuple[float, float, float]],
        films: Sequence[tuple[str, int, Film]],
        reservoirs: Mapping[str, Reservoir],
    ) -> None:
        self.model, self.bodies, self.films, self.reservoirs = model, bodies, films, reservoirs
        self._made: RollingTyre | None = tyre
        m, names = model.size, list(reservoirs)
        n = m + len(names)
        conductances = [(name, pair) for name in names for pair in reservoirs[name].exchanges]
        self.layout: Layout = (
            tuple((side, _reservoir(film.sink)) for side, _, film in films),
            tuple((name, _reservoir(other)) for name, (_, other) in conductances),
            tuple(names),
        )
        #: (coefficient, sink) of every exchange: numbers or functions f(x, t).
        self.data = [(film.h, film.sink) for _, _, film in films]
        self.data += [(_timed(conductance), _timed(other)) for _, (conductance, other) in conductances]
        self.start = np.zeros(n)
        initial = tyre.drive.initial
        # The first mode is even: V a = initial.
        self.start[0] = initial / model.V[0, 0]
        for i, name in enumerate(names):
            initial_of = reservoirs[name].initial
            self.start[m + i] = initial if initial_of is None else initial_of

    @property
    def tyre(self) -> RollingTyre:
        """The variant's tyre."""
        assert self._made is not None
        return self._made

    @property
    def alike(self) -> RollingTyre:
        """A tyre with the same phases, load-case times, zones, section and sensors: here the tyre itself."""
        return self.tyre

    @property
    def rolling(self) -> Sequence[RollingPhase] | None:
        """The phases in which the tyre rolls; None: the tyre knows."""
        return None

    @property
    def answers(self) -> Mapping[str, Mapping[str, float]]:
        """Function of answers -> its answers, where they are known without the tyre."""
        return {}

    def pressure(self, t: float) -> float:
        """Gauge pressure of the drive at a time, Pa."""
        return float(self.tyre.drive.value("pressure", t) or 0.0)

    @property
    def fixed_gas(self) -> float:
        """Temperature of contained air that is not a reservoir, degC."""
        return float(self.tyre.study.card.boundaries.contained_air.fixed_temperature)

    def on(self, model: ReducedModel) -> ReducedBalance:
        """The same balance on other modes."""
        return ReducedBalance(model, self.tyre, self.bodies, self.films, self.reservoirs)

    @functools.cached_property
    def exchanges(self) -> Exchanges:
        """Matrices of all heat exchanges."""
        return self.model.exchanges(self.layout)

    @functools.cached_property
    def capacities(self) -> Array:
        """Heat capacities of the reservoirs, (m,) J/K: constant, as `reduced_balance` has checked."""
        return np.array([reservoir.heat_capacity for reservoir in self.reservoirs.values()], dtype=float)

    @functools.cached_property
    def M(self) -> Array:
        """Heat capacities, (n, n) J/K."""
        return matrices_of([self])[0][0]

    @functools.cached_property
    def K(self) -> Array:
        """Conduction, (n, n) W/K."""
        return matrices_of([self])[1][0]

    @property
    def stack(self) -> Array:
        """Exchange matrices, (n_exchanges, n, n), for a coefficient of 1 W/m2/K or 1 W/K."""
        return self.exchanges.matrices

    @property
    def loads(self) -> Array:
        """Load vectors of the given sinks, (n_exchanges, n)."""
        return self.exchanges.loads

    def coefficients(self, t: float, known: dict[int, float] | None = None) -> tuple[Array, Array]:
        """Films and conductances, and their sinks, at a time.

        ``known``: values at this time of functions, by `id`, which variants of a batch share; new ones are added.
        """
        values: dict[int, float] = {} if known is None else known
        h = np.array([_value(film[0], t, values) for film in self.data])
        sinks = np.array([0.0 if isinstance(film[1], str) else _value(film[1], t, values) for film in self.data])
        return h, sinks

    def source(self, t: float, a: Array) -> Array:
        """Heat source at the sample nodes, (n_samples,) W/m3."""
        model = self.model
        T = model.at_samples @ a
        q = np.empty(len(T))
        for zone, part in model.sample_slices.items():
            q[part] = self.tyre.sources[zone](model.sample_points[zone], t, T[part])
        return q

    def powers(self, t: float) -> list[float]:
        """Power into every reservoir from outside, W."""
        return [_value(_timed(reservoir.power), t, {}) for reservoir in self.reservoirs.values()]


def reduced_balance(model: ReducedModel, tyre: RollingTyre) -> ReducedBalance:
    """The heat balance of a tyre on the modes of a model.

    Raises
    ------
    NotReducibleError : the tyre has another mesh, properties that depend on temperature, fluxes, radiation, sliding,
        or effects with states.
    """
    if tyre.study.card.mechanics.feedback is not None and tyre.cycles is None:
        raise NotReducibleError("strain cycles that follow the temperature need full runs")
    if tyre.acting.with_states:
        names = ", ".join(f"'{effect.name}'" for effect in tyre.acting.with_states)
        raise NotReducibleError(f"a reduced model cannot follow effects with states: {names}")
    try:
        model = on_tyre(model, tyre)
    except OtherTopologyError as error:
        raise NotReducibleError(f"the mesh has another topology: {error.message}") from None
    bodies = {region: _constant(region, body) for region, body in tyre.bodies.items()}
    if model.on_reference.shapes is not None:
        for region, (along, across, _) in bodies.items():
            if along != across and region not in model.on_reference.shapes.directed:
                raise NotReducibleError(
                    f"'{region}' conducts along plies here, and in all directions in the base study"
                )
    films: list[tuple[str, int, Film]] = []
    for side, conditions in tyre.boundaries.items():
        for number, condition in enumerate(conditions):
            if not isinstance(condition, Film):
                kind = {"Flux": "given heat", "Radiation": "radiation"}.get(type(condition).__name__, "a condition")
                raise NotReducibleError(f"a reduced model has films only: it cannot follow {kind} at '{side}'")
            films.append((side, number, condition))
    reservoirs = tyre._reservoirs()
    for name, reservoir in reservoirs.items():
        if not is_number(reservoir.heat_capacity) or not float(reservoir.heat_capacity) > 0:
            raise NotReducibleError(f"the heat capacity of '{name}' is not positive, or depends on temperature")
    return ReducedBalance(model, tyre, bodies, films, reservoirs)


def _constant(region: str, body: Material) -> tuple[float, float, float]:
    """Conductivity along and across the direction, W/m/K, and heat capacity, J/m3/K."""
    k = body.conductivity
    if callable(k) or not is_number(body.heat_capacity):
        raise NotReducibleError(f"the conductivity or heat capacity of '{region}' depends on temperature")
    along, across = k if isinstance(k, tuple | list) else (k, k)
    return float(along), float(across), float(body.heat_capacity)


def matrices_of(balances: Sequence[ReducedBalance]) -> tuple[Array, Array]:
    """M and K of B variants on the same modes, (B, n, n) each."""
    first = balances[0]
    model, m, regions = first.model, first.model.size, list(first.model.mass)
    n = m + len(first.reservoirs)
    M, K = np.zeros((len(balances), n, n)), np.zeros((len(balances), n, n))
    of_bodies = np.array([[balance.bodies[region] for region in regions] for balance in balances])
    if all(balance.model is model for balance in balances):
        masses, pairs = model.stacked
        M[:, :m, :m] = np.tensordot(of_bodies[:, :, 2], masses, axes=1)
        K[:, :m, :m] = np.tensordot(of_bodies[:, :, :2], pairs, axes=2)
    else:
        for b, balance in enumerate(balances):
            masses, pairs = balance.model.stacked
            M[b, :m, :m] = np.tensordot(of_bodies[b, :, 2], masses, axes=1)
            K[b, :m, :m] = np.tensordot(of_bodies[b, :, :2], pairs, axes=2)
    for i in range(len(first.reservoirs)):
        M[:, m + i, m + i] = [balance.capacities[i] for balance in balances]
    return M, K


def _reservoir(sink: Any) -> str | None:
    return sink if isinstance(sink, str) else None


def _timed(datum: Any) -> Any:
    return (lambda _x, t: datum(t)) if callable(datum) else datum


def _value(datum: Any, t: float, known: dict[int, float]) -> float:
    """The value at a time of a number or of a function of time that is uniform in space."""
    if not callable(datum):
        return float(datum)
    if id(datum) not in known:
        known[id(datum)] = float(datum(None, t))
    return known[id(datum)]
