"""The conduction problem of a user: mesh, materials, conditions, sources, reservoirs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyrefem.brief import lines
from tyrefem.conduction.added_states import AddedStates
from tyrefem.conduction.balance import HeatBalance
from tyrefem.conduction.budget import Tally
from tyrefem.conduction.conditions import (
    Condition,
    Film,
    Material,
    Reservoir,
    is_number,
)
from tyrefem.conduction.field import Field, History, Steps
from tyrefem.conduction.function_space import kind_of
from tyrefem.conduction.operators import operators_of
from tyrefem.conduction.statement import balance_of, check_partition
from tyrefem.conduction.steady import anchored, solve_steady
from tyrefem.conduction.terms import State
from tyrefem.conduction.transient import Integration
from tyrefem.errors import InputError, nearest
from tyrefem.estimates.work import check_memory, history, matrices, rounded_down, smallest_tolerance
from tyrefem.threads import one_thread

Array = NDArray[Any]


#: Share of the heat that a body holds above 0 degC: a budget with a smaller throughput contains only rounding.
NEGLIGIBLE = 1e-6


class Conduction:
    """Heat conduction C dT/dt = div(k grad T) + q on a mesh with named subdomains and boundaries.

    Parameters
    ----------
    mesh : scikit-fem triangle or quadrilateral mesh, coordinates (r, z) or (x, y) in m.
    regions : subdomain -> `Material`; they must cover every element exactly once.
    boundaries : boundary -> `Film`, `Flux`, `Radiation`, `Convection`, `Fixed`, or a list of them that add up.
            Boundaries without a condition are insulated. A node of two `Fixed` boundaries has the first one's value.
    sources : subdomain (any) -> W/m3, a number or f(x, t, T) with x (2, n), T (n,) at its nodes; overlapping
            subdomains add. x is the same array object at every call.
    axisymmetric : coordinates (r, z) and the full ring; otherwise planar, one metre deep.
    element : "P1" or "P2".
    reservoirs : name -> `Reservoir`, coupled by films whose sink is that name.
    states : additional unknowns with a rate.

    Arrays given to functions are read-only. Raises InputError for names, materials or conditions that are inconsistent
    with the mesh.

    >>> import numpy as np, skfem
    >>> from tyrefem.conduction import Film, Fixed
    >>> mesh = skfem.MeshQuad.init_tensor(np.linspace(0.30, 0.35, 21), np.linspace(0, 0.01, 3))
    >>> mesh = mesh.with_subdomains({"wall": lambda x: x[0] > 0}).with_boundaries(
    ...     {"inside": lambda x: x[0] < 0.3001, "outside": lambda x: x[0] > 0.3499})
    >>> problem = Conduction(mesh, {"wall": Material(1.0, 2e6)},
    ...                      {"inside": Fixed(100.0), "outside": Film(h=500.0, sink=17.034444)})
    >>> field = problem.steady()
    >>> field.at([(0.32, 0.005)]).round(2)
    array([66.51])
    >>> area = 2 * np.pi * 0.35 * 0.01
    >>> round(field.flux_through("outside") / area, 1)
    1482.8
    """

    def __init__(
        self,
        mesh: Any,
        regions: Mapping[str, Material],
        boundaries: Mapping[str, Condition | Sequence[Condition]] | None = None,
        sources: Mapping[str, Any] | None = None,
        *,
        axisymmetric: bool = True,
        element: str = "P1",
        reservoirs: Mapping[str, Reservoir] | None = None,
        states: AddedStates | None = None,
    ) -> None:
        kind_of(mesh)
        _check_memory(mesh, element)
        tables = {"boundaries": boundaries or {}, "sources": sources or {}, "reservoirs": reservoirs or {}}
        for name, table in {"regions": regions, **tables}.items():
            if not isinstance(table, Mapping):
                raise InputError(f"must be a mapping of names, not {table!r:.60}", field=name)
        for name, reservoir in tables["reservoirs"].items():
            if not isinstance(reservoir, Reservoir):
                raise InputError(f"must be a Reservoir, not {reservoir!r:.60}", field=f"reservoirs.{name}")
        self.operators = operators_of(mesh, element, axisymmetric)
        self.regions, self.sources = dict(regions), dict(sources or {})
        self.reservoirs, self.states = dict(reservoirs or {}), states
        self.boundaries: dict[str, list[Any]] = {
            name: list(c) if isinstance(c, (list, tuple)) else [c] for name, c in (boundaries or {}).items()
        }
        check_partition(self.operators, self.regions)
        # Checks all names now, so that the error comes with the input.
        if not self._balance().fixed.free.size:
            raise InputError("give every node a temperature: nothing is left to compute", field="boundaries")

    @property
    def mesh(self) -> Any:
        """The scikit-fem mesh."""
        return self.operators.mesh

    def __repr__(self) -> str:
        conditions = {
            name: " + ".join(type(condition).__name__ for condition in each) for name, each in self.boundaries.items()
        }
        return lines(
            "Conduction",
            {
                "unknowns": f"{self.operators.size} of {self.operators.element} on {self.mesh.nelements} elements, "
                + ("axisymmetric" if self.operators.axisymmetric else "planar"),
                "regions": self.regions,
                "sources": self.sources,
                "reservoirs": self.reservoirs,
                **{f"at {name}": words for name, words in conditions.items()},
            },
        )

    def points(self, subdomain: str) -> Array:
        """Points (2, n) at which the source of a subdomain is evaluated (its nodes), always the same array."""
        return self.operators.nodes(subdomain)

    def _balance(self) -> HeatBalance:
        return balance_of(self.operators, self.regions, self.boundaries, self.sources, self.reservoirs, self.states)

    def _initial(self, balance: HeatBalance, initial: Any, t: float, given: Mapping[str, float] | None) -> State:
        size = self.operators.size
        before = dict(initial.reservoirs) if isinstance(initial, Field) else {}
        values = initial.values if isinstance(initial, Field) else initial
        u = _numbers(values, "initial", f"a finite number or array ({size},)")
        if u.shape not in ((), (size,)) or not np.isfinite(u).all():
            raise InputError(f"must be a finite number or array ({size},), not {u.shape}", field="initial")
        u = np.full(size, float(u)) if u.ndim == 0 else u
        weight = self.operators.mean_weight()
        for name in given or {}:
            if name not in self.reservoirs:
                raise InputError(
                    f"unknown reservoir {name!r}{nearest(name, self.reservoirs)}", field="reservoirs_initial"
                )
        g = np.empty(len(self.reservoirs))
        for i, (name, reservoir) in enumerate(self.reservoirs.items()):
            start = reservoir.initial if reservoir.initial is not None else float(weight @ u)
            g[i] = {name: start, **before, **(given or {})}[name]
        if self.states is not None:
            g = np.concatenate([g, self.states.initial / self.states.scale])
        y = State(u, g)
        balance.balance_massless(t, y.u, y.g)
        return y

    def steady(self, initial: Any = 25.0, *, time: float = 0.0) -> Field:
        """The steady temperature field for the data of one time.

        Parameters
        ----------
        initial : first guess, degC: number, array (n,) or `Field`.
        time : s, at which functions of time are evaluated.

        Raises InputError if no condition fixes the temperature level, SolverError without convergence.
        """
        if self.states is not None:
            raise InputError("states that follow a rate have a transient only", field="states")
        balance = self._balance()
        outside = self._anchored_reservoirs()
        if not anchored(balance, outside, time):
            raise InputError(
                "a steady problem needs a Fixed, Film or Radiation boundary, or a Convection", field="boundaries"
            )
        y = solve_steady(balance, self._initial(balance, initial, time, None), time)
        power = balance.powers(time, y, np.zeros(y.u.size))
        generated: dict[str, float] = {}
        lost: dict[str, float] = {}
        for (kind, name, _), W in zip(balance.entries, power, strict=True):
            if kind == "source":
                generated[name] = generated.get(name, 0.0) + float(W)
            elif kind == "boundary":
                lost[name] = lost.get(name, 0.0) - float(W)
        return Field(self.operators, self.regions, y.u, self._temperatures_by_name(y.g), generated, lost)

    def _anchored_reservoirs(self) -> set[int]:
        names = list(self.reservoirs)
        links = [
            (name, other)
            for name, r in self.reservoirs.items()
            for conductance, other in r.exchanges
            if callable(conductance) or conductance > 0
        ]
        held = {name for name, other in links if not isinstance(other, str)}
        for _ in names:
            held |= {a for a, b in links if b in held} | {b for a, b in links if a in held and isinstance(b, str)}
        return {names.index(name) for name in held}

    def _temperatures_by_name(self, g: Array) -> dict[str, float]:
        return {name: float(T) for name, T in zip(self.reservoirs, g, strict=True)}

    def transient(
        self,
        times: ArrayLike,
        initial: Any = 25.0,
        tolerance: float = 0.01,
        *,
        breakpoints: Sequence[float] | Array = (),
        progress: Callable[[float], None] | None = None,
        max_step: float | None = None,
        reservoirs_initial: Mapping[str, float] | None = None,
        partial: bool = False,
    ) -> History:
        """Integrate from times[0] to times[-1] with error control.

        Parameters
        ----------
        times : s, strictly increasing, at least two; the first is the initial time.
        initial : degC: number, array (n,) or `Field` (with its reservoirs).
        tolerance : K, target for the largest error in time of all nodal temperatures at all times.
        breakpoints : times where data jump; a step ends there and uses data from the left, the next one from the right.
        progress : called with t after every accepted step. max_step : s.
        reservoirs_initial : name -> degC, instead of the reservoirs' values.
        partial : on Ctrl-C return the finished part with `interrupted` True; otherwise Ctrl-C is raised.

        Raises InputError for bad times, tolerance or initial values and for more times than memory holds,
        SolverError if the step vanishes, and KeyboardInterrupt without ``partial``: a part is never taken for the
        complete run by mistake.
        """
        when = _checked_times(times)
        balance = self._balance()
        names = list(self.reservoirs)
        into = {
            (name, i): c.sink
            for name, conditions in self.boundaries.items()
            for i, c in enumerate(conditions)
            if isinstance(c, Film) and isinstance(c.sink, str)
        }
        between: dict[tuple[str, int], tuple[str, str | None]] = {(name, -1): (name, None) for name in names}
        for name, r in self.reservoirs.items():
            for i, (_, other) in enumerate(r.exchanges):
                between[name, i] = (name, other if isinstance(other, str) else None)
        tally = Tally(balance.entries, list(self.regions), names, into, between)
        start = self._initial(balance, initial, float(when[0]), reservoirs_initial)
        tally.floor = NEGLIGIBLE * abs(float(np.sum(balance.stored(np.zeros_like(start.u), start.u))))
        run = _integration(balance, when, start, tolerance, breakpoints, max_step, tally)
        interrupted = False
        try:
            with one_thread():
                run.run(progress)
        except KeyboardInterrupt:
            if not partial or not run.gas:
                raise
            interrupted = True
        # Ctrl-C may come between the parts of one time: a time with all of them is finished.
        done = min(len(tally.kept), len(run.values), len(run.gas))
        when = when[:done]
        gas = np.array(run.gas[:done])
        peaks = run.peaks()
        return History(
            operators=self.operators,
            materials=self.regions,
            times=when,
            values=np.array(run.values[:done]),
            reservoirs={name: gas[:, i] for i, name in enumerate(names)},
            budget=tally.budget(when),
            maximum=peaks[0],
            region_maximum=dict(zip(self.regions, peaks[1:], strict=True)),
            steps=Steps(run.accepted, run.rejected, run.matrices.factorisations, run.matrices.solves),
            interrupted=interrupted,
            states=np.zeros((done, 0)) if self.states is None else gas[:, len(names) :] * self.states.scale,
        )

    def temperatures(
        self,
        times: ArrayLike,
        initial: Any = 25.0,
        tolerance: float = 0.01,
        *,
        breakpoints: Sequence[float] | Array = (),
    ) -> tuple[Array, dict[str, Array]]:
        """Temperatures (n_times, n) and those of the reservoirs by name (n_times,), degC, as `transient` gives them.

        The steps are the same; heat budget and hottest points, a fifth of the work, are left out. Parameters and errors
        as in `transient`.
        """
        when, balance = _checked_times(times), self._balance()
        start = self._initial(balance, initial, float(when[0]), None)
        run = _integration(balance, when, start, tolerance, breakpoints, None, None)
        with one_thread():
            run.run(None)
        gas = np.array(run.gas)
        return np.array(run.values), {name: gas[:, i] for i, name in enumerate(self.reservoirs)}


def _numbers(values: Any, field: str, wanted: str) -> Array:
    """A new array of numbers."""
    try:
        return np.array(values, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"must be {wanted}, not {values!r:.60}", field=field) from None


def _checked_times(times: ArrayLike) -> Array:
    """Times of a transient as an array, s."""
    when = _numbers(times, "times", "at least two finite, strictly increasing times")
    if when.ndim != 1 or when.size < 2 or not np.isfinite(when).all() or np.any(np.diff(when) <= 0):
        raise InputError("must be at least two finite, strictly increasing times", field="times")
    return when


def _integration(
    balance: HeatBalance,
    when: Array,
    start: State,
    tolerance: float,
    breakpoints: Sequence[float] | Array,
    max_step: float | None,
    tally: Tally | None,
) -> Integration:
    """The integration from a state; checks the numbers that say how."""
    if not (is_number(tolerance) and np.isfinite(tolerance) and tolerance > 0):
        raise InputError(f"must be positive, not {tolerance!r}", field="tolerance")
    _check_kept(balance.ops.size, when.size)
    jumps = _numbers(breakpoints, "breakpoints", "finite times")
    if jumps.ndim != 1 or not np.isfinite(jumps).all():
        raise InputError("must be finite times", field="breakpoints")
    if max_step is not None and not (is_number(max_step) and max_step > 0):
        raise InputError(f"must be positive, not {max_step!r}", field="max_step")
    least = smallest_tolerance(float(np.abs(start.u).max()))
    if tolerance < least:
        raise InputError(
            f"{tolerance:g} K is lost in the rounding of temperatures: must be at least {least:.0e} K",
            field="tolerance",
        )
    return Integration(balance, when, start, float(tolerance), jumps, max_step or np.inf, tally)


def _check_memory(mesh: Any, element: str) -> None:
    """Raise `InputError` for a mesh whose matrices do not fit into memory."""
    unknowns = mesh.p.shape[1] + (mesh.facets.shape[1] + mesh.t.shape[1] if element == "P2" else 0)
    try:
        check_memory(matrices(unknowns), f"{unknowns:,} unknowns", "a coarser mesh or linear elements would fit")
    except InputError as error:
        raise error.within(field="mesh") from None


def _check_kept(unknowns: int, times: int) -> None:
    """Raise `InputError` for more times than fit into memory."""
    try:
        check_memory(
            history(unknowns, times),
            f"{times:,} times of {unknowns:,} unknowns",
            lambda free: f"{rounded_down(free / history(unknowns, 1)):,.0f} times would fit",
        )
    except InputError as error:
        raise error.within(field="times") from None
