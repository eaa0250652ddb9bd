"""Synthetic data for blind tests, with a mesh, a time integration and sensors that differ from the diagnosis.

Two effects outside the catalogue serve blind tests of the verdict "unexplained".
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, Any, ClassVar

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.sparse.linalg import splu

from tyrefem.boundaries.contained_air import ContainedAirLaw
from tyrefem.conduction import Conduction
from tyrefem.conduction.points import located
from tyrefem.conduction.terms import State
from tyrefem.effects import Effect
from tyrefem.effects.combined import Acting
from tyrefem.effects.effect import Factor, Prior
from tyrefem.effects.tyre import Tyre
from tyrefem.geometry.meshing.gmsh import gmsh_works
from tyrefem.inputs.study import StudyData
from tyrefem.measured import MeasuredRun
from tyrefem.mechanics.cycle_schedule import CycleSchedule
from tyrefem.quantity import Unit
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.simulation.sensors import logged, recorded, true_places
from tyrefem.simulation.surroundings import GAS

Array = NDArray[np.float64]


#: Time step of the synthetic data, s.
STEP = 4.0


@functools.cache
def synthetic_mesh() -> dict[str, str]:
    """The mesh of synthetic data, finer than that of the diagnosis: quadratic triangles by gmsh.

    Without gmsh the triangles are those of the mapped mesher.
    """
    mesher = "gmsh" if gmsh_works() else "mapped"
    return {"mesh.mesher": mesher, "mesh.cell": "tri", "mesh.element": "P2", "mesh.size": "2.5 mm"}


@dataclass(frozen=True)
class Logger:
    """Recording of a run: random times about ``every`` s apart, Gaussian ``noise`` (K), and missing readings.

    ``gap``: probability that a sensor has a stretch without readings.
    """

    every: float = 10.0
    noise: float = 0.5
    gap: float = 0.6


def backward(problem: Conduction, times: Array, initial: float) -> tuple[Array, Array]:
    """Time integration by BDF2 with even steps and an extrapolated remainder: (values, reservoirs).

    The first step is backward Euler. The method differs from the solver's, so that synthetic data have other errors.
    """
    balance = problem._balance()
    state = problem._initial(balance, initial, float(times[0]), None)
    u, g = [state.u], [state.g]
    rest: list[tuple[Array, Array]] = []
    heat = balance.reservoir_capacity(state.g)
    key: tuple[int, float] | None = None
    for i, (before, after) in enumerate(pairwise(times)):
        h, t = after - before, after - 1e-9 * after
        now = State(u[-1], g[-1])
        jump = i == 0 or balance.stale(t, now)
        if jump:
            balance.freeze(t, now)
        G, Gg, _ = balance.remainder(t, now)
        even = not jump and i > 0 and abs((times[i] - times[i - 1]) - h) < 1e-9 * h
        if even and rest:
            first, firstg = 2 * G - rest[-1][0], 2 * Gg - rest[-1][1]
        else:
            first, firstg = G, Gg
        rest.append((G, Gg))
        c, past, pastg = (1.5, 2 * u[-1] - 0.5 * u[-2], 2 * g[-1] - 0.5 * g[-2]) if even else (1.0, u[-1], g[-1])
        M = balance.M
        if balance.variable_capacity:
            M, key = problem.operators.matrix(balance.mass(2 * now.u - u[-2] if even else now.u)), None
        if key != (balance.version, c / h):
            factor = splu(problem.operators.matrix(c / h * M.data + balance.S_data).tocsc())
            through = factor.solve(balance.B.copy())
            small = np.diag(c / h * heat) + balance.D - balance.B.T @ through
            key = balance.version, c / h
        body = factor.solve(M @ past / h + first)
        gas = np.linalg.solve(small, heat * pastg / h + firstg + balance.B.T @ body)
        u.append(body + through @ gas)
        g.append(gas)
    return np.array(u), np.array(g)


def theta_steps(problem: Conduction, times: Array, initial: float, theta: float = 0.6) -> tuple[Array, Array]:
    """Time integration by the theta method: (values, reservoirs).

    M (u' - u) / h = theta F(u') + (1 - theta) F(u) + G, with the linear part F, and the rest G in the middle of the
    step at extrapolated temperatures. Neither the solver nor the fit has this method.
    """
    balance = problem._balance()
    state = problem._initial(balance, initial, float(times[0]), None)
    u, g = [state.u], [state.g]
    heat = balance.reservoir_capacity(state.g)
    key: tuple[int, float] | None = None
    for i, (begin, end) in enumerate(pairwise(times)):
        h, middle, now = end - begin, (begin + end) / 2, State(u[-1], g[-1])
        if i == 0 or balance.stale(middle, now):
            balance.freeze(middle, now)
        ahead = now if i == 0 else State(1.5 * now.u - 0.5 * u[-2], 1.5 * now.g - 0.5 * g[-2])
        G, Gg, _ = balance.remainder(middle, ahead)
        M = balance.M
        if balance.variable_capacity:
            M, key = problem.operators.matrix(balance.mass(ahead.u)), None
        if key != (balance.version, h):
            factor = splu(problem.operators.matrix(M.data / h + theta * balance.S_data).tocsc())
            through = factor.solve(theta * balance.B)
            small = np.diag(heat / h) + theta * balance.D - theta * balance.B.T @ through
            key = balance.version, h
        flow = balance.B @ now.g - balance.S @ now.u
        flow_g = balance.B.T @ now.u - balance.D @ now.g
        body = factor.solve(M @ now.u / h + (1 - theta) * flow + G)
        gas = np.linalg.solve(small, heat * now.g / h + (1 - theta) * flow_g + Gg + theta * balance.B.T @ body)
        u.append(body + through @ gas)
        g.append(gas)
    return np.array(u), np.array(g)


@dataclass(frozen=True, eq=False)
class ExtraEffectsTyre(RollingTyre):
    """A study's tyre with further effects from outside the catalogue."""

    extra: tuple[Effect, ...] = ()

    @functools.cached_property
    def acting(self) -> Acting:
        """The study's effects, then the further effects."""
        return Acting(self, (*self.study.effects, *self.extra))


def record(
    study: StudyData,
    name: str,
    logger: Logger,
    rng: np.random.Generator,
    extra: tuple[Effect, ...] = (),
    *,
    cycles: CycleSchedule | None = None,
    integrate: Callable[[Conduction, Array, float], tuple[Array, Array]] = backward,
    step: float = STEP,
) -> MeasuredRun:
    """A run as a logger records it.

    ``study``: with the hidden effects; ``extra``: further effects. ``cycles``: strain cycles in place of the study's.
    ``integrate``: time integration with even steps of about ``step`` s.
    """
    tyre = ExtraEffectsTyre(study, cycles=cycles, extra=extra)
    edges = [*tyre.drive.starts, tyre.drive.end]
    times = np.unique(np.concatenate([np.linspace(a, b, round((b - a) / step) + 1) for a, b in pairwise(edges)]))
    values, reservoirs = integrate(tyre.problem, times, tyre.drive.initial)
    section, places = study.section, list(true_places(study).values())
    at = np.zeros((len(times), 0))
    if places:
        s, depth = section.locate(np.array(places))
        points = section.place(*section.clamp(s, depth, tyre.mesh.size**2 / 0.1))
        at = (located(tyre.problem.operators, points).value() @ values.T).T
    clean: dict[str, Any] = dict(recorded(study, times, at))
    law: ContainedAirLaw = study.card.boundaries.contained_air
    names = list(tyre.problem.reservoirs)
    gas = reservoirs[:, names.index(GAS)] if GAS in names else np.full(len(times), law.temperature)  # type: ignore[attr-defined]
    clean[GAS] = logged(study, times, gas)
    count = int(times[-1] / logger.every)
    clock = np.sort(rng.uniform(0.0, times[-1], count))
    clock = clock[np.diff(clock, prepend=-1.0) > 0.05]
    columns = {}
    for sensor, history in clean.items():
        readings = np.interp(clock, times, history) + rng.normal(0.0, logger.noise, len(clock))
        if rng.random() < logger.gap:
            start = rng.uniform(0.0, 0.9) * times[-1]
            readings[(clock > start) & (clock < start + rng.uniform(0.03, 0.12) * times[-1])] = np.nan
        columns[sensor] = readings
    return MeasuredRun(name, clock, pd.DataFrame(columns))


class HotRing(Effect):
    """Heat in a ring of the wall between two stations, as by a rubbing delamination: q += heat (v/v_0)^n."""

    name: ClassVar[str] = "uncatalogued-hot-ring"
    family: ClassVar[str] = "heat"
    sentence: ClassVar[str] = "A delaminated ring rubs and generates heat."
    source: ClassVar[str] = "estimate: made up for blind tests"

    start: Annotated[float, Unit("m", ge=0)]
    end: Annotated[float, Unit("m", gt=0)]
    outer: bool
    exponent: float
    heat: Annotated[float, Prior("W/m**3", "heat at 10 m/s", 1e5, 0.0, 1e7)] = 0.0

    def heat_addend(self, tyre: Tyre, zone: str, x: Array, t: float, T: Array) -> Factor:
        """W/m3 in one half of the thickness, between the stations."""
        s, depth = tyre.places(x)
        middle = np.asarray(tyre.study.section.total_thickness(s)) / 2
        inside = (s > self.start) & (s < self.end) & ((depth > middle) == self.outer)
        return np.asarray(self.heat * (tyre.speed(t) / 10.0) ** self.exponent * inside)


class Lamp(Effect):
    """Radiation of a hot object beside the tyre on a stretch of the outer wall, until a given time."""

    name: ClassVar[str] = "uncatalogued-lamp"
    family: ClassVar[str] = "boundary"
    sentence: ClassVar[str] = "A hot body beside the tyre, an exhaust say, shines on a stretch of the wall."
    source: ClassVar[str] = "estimate: made up for blind tests"
    surfaces: ClassVar[tuple[str, ...]] = ("road", "outside_air")

    start: Annotated[float, Unit("m", ge=0)]
    end: Annotated[float, Unit("m", gt=0)]
    until: Annotated[float, Unit("s", gt=0)]
    shine: Annotated[float, Prior("W/m**2", "flux", 500.0, 0.0, 1e5)] = 0.0

    def flux(self, tyre: Tyre, surface: str, x: Array, t: float) -> Factor:
        """W/m2 between the stations before the time ``until``."""
        s, _ = tyre.places(x.reshape(2, -1))
        return np.asarray(self.shine * ((s > self.start) & (s < self.end)) * (t < self.until))
