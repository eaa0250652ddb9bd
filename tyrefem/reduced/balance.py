"""A variant's heat balance on modes: masses, conduction, and everything that exchanges heat."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.conduction import Film, Reservoir

if TYPE_CHECKING:
    from tyrefem.reduced.model import ReducedModel
    from tyrefem.rolling import RollingTyre

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Exchanges(Brief):
    """Everything that exchanges heat: sides in the order of their films, then the reservoirs among themselves.

    Parameters
    ----------
    matrices : (n_exchanges, n, n) for 1 W/m2/K, or 1 W/K. loads : (n_exchanges, n) of a given sink.
    rows : (n_exchanges, n) W into the body (or the owner) per kelvin. areas : (n_exchanges,) m2, or 1.
    given : whether the sink is a given temperature.
    """

    matrices: Array
    loads: Array
    rows: Array
    areas: Array
    given: NDArray[np.bool_]


#: (side, reservoir or None) of every film; (owner, other reservoir or None) of every exchange; names of reservoirs.
Layout = tuple[tuple[tuple[str, str | None], ...], tuple[tuple[str, str | None], ...], tuple[str, ...]]


def exchanges(model: ReducedModel, layout: Layout) -> Exchanges:
    """The exchanges of a layout, built once per model."""
    if layout not in model.layouts:
        films, among, names = layout
        m, n, count = model.size, model.size + len(names), len(films) + len(among)
        found = Exchanges(
            np.zeros((count, n, n)), np.zeros((count, n)), np.zeros((count, n)), np.ones(count), np.zeros(count, bool)
        )
        for j, (side, sink) in enumerate(films):
            R, r, area = model.surfaces[side]
            found.matrices[j, :m, :m], found.rows[j, :m], found.areas[j] = R, -r, area
            if sink is None:
                found.loads[j, :m], found.given[j] = r, True
            else:
                g = m + names.index(sink)
                found.matrices[j, :m, g] = found.matrices[j, g, :m] = -r
                found.matrices[j, g, g] = found.rows[j, g] = area
        for j, (owner, other) in enumerate(among, len(films)):
            i = m + names.index(owner)
            found.matrices[j, i, i], found.rows[j, i] = 1.0, -1.0
            if other is None:
                found.loads[j, i], found.given[j] = 1.0, True
            else:
                k = m + names.index(other)
                found.matrices[j, i, k] = found.matrices[j, k, i] = -1.0
                found.matrices[j, k, k] = found.rows[j, k] = 1.0
        model.layouts[layout] = found
    return model.layouts[layout]


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
        among = [(name, pair) for name in names for pair in reservoirs[name].exchanges]
        self.layout: Layout = (
            tuple((side, _reservoir(film.sink)) for side, _, film in films),
            tuple((name, _reservoir(other)) for name, (_, other) in among),
            tuple(names),
        )
        self.exchanges = exchanges(model, self.layout)
        #: (coefficient, sink) of every exchange: numbers or functions f(x, t).
        self.data = [(film.h, film.sink) for _, _, film in films]
        self.data += [(_timed(conductance), _timed(other)) for _, (conductance, other) in among]
        self.start = np.zeros(n)
        initial = tyre.drive.initial
        # The first mode is even: V a = initial.
        self.start[0] = initial / model.V[0, 0]
        for i, name in enumerate(names):
            own = reservoirs[name].initial
            self.start[m + i] = initial if own is None else own

    @functools.cached_property
    def M(self) -> Array:
        """(n, n) J/K."""
        return matrices([self])[0][0]

    @functools.cached_property
    def K(self) -> Array:
        """(n, n) W/K of conduction."""
        return matrices([self])[1][0]

    @property
    def stack(self) -> Array:
        """(n_exchanges, n, n), for 1 W/m2/K or 1 W/K."""
        return self.exchanges.matrices

    @property
    def loads(self) -> Array:
        """(n_exchanges, n) of given sinks."""
        return self.exchanges.loads

    def coefficients(self, t: float) -> tuple[Array, Array]:
        """(films and conductances, their sinks) at a time."""
        h = np.array([_value(one[0], t) for one in self.data])
        sinks = np.array([0.0 if isinstance(one[1], str) else _value(one[1], t) for one in self.data])
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


def matrices(balances: Sequence[ReducedBalance]) -> tuple[Array, Array]:
    """M and K of variants on the same modes, (B, n, n) each."""
    first = balances[0]
    model, m, regions = first.model, first.model.size, list(first.model.mass)
    n = m + len(first.reservoirs)
    M, K = np.zeros((len(balances), n, n)), np.zeros((len(balances), n, n))
    of_bodies = np.array([[one.bodies[region] for region in regions] for one in balances])
    masses, pairs = model.stacked
    M[:, :m, :m] = np.tensordot(of_bodies[:, :, 2], masses, axes=1)
    K[:, :m, :m] = np.tensordot(of_bodies[:, :, :2], pairs, axes=2)
    for i, name in enumerate(first.reservoirs):
        M[:, m + i, m + i] = [float(one.reservoirs[name].heat_capacity) for one in balances]  # type: ignore[arg-type]
    return M, K


def _reservoir(sink: Any) -> str | None:
    return sink if isinstance(sink, str) else None


def _timed(datum: Any) -> Any:
    return (lambda _x, t: datum(t)) if callable(datum) else datum


def _value(datum: Any, t: float) -> float:
    """A number, or a function of time that does not vary in space."""
    return float(datum(None, t)) if callable(datum) else float(datum)
