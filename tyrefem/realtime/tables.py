"""Tables of a real-time model: films over speed, load and pressure; strain energy over load and pressure."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.strain_laws import strain_law
from tyrefem.realtime.inputs import NAMES, Box, BoxDrive
from tyrefem.realtime.settings import COSTLY, TablePoints
from tyrefem.realtime.tyre import STANDSTILL, CubicTable
from tyrefem.reduced.balance import ReducedBalance, reduced_balance
from tyrefem.reduced.model import ReducedModel
from tyrefem.simulation.heat_source import HeatSource
from tyrefem.simulation.rolling_tyre import RollingTyre

Array = NDArray[np.float64]
#: Points of the deflection's table over the root of load, and over pressure.
BENDS = 61, 13
#: Range of the table of tan delta, degC, and its spacing, K.
COLD, HOT, FINE = -60.0, 300.0, 0.5


@dataclass(frozen=True, eq=False)
class Tables:
    """Tables equally spaced in the root of speed, the root of deflection, and pressure; a fixed input has one point.

    The axis is deflection, not load: a kink of a strain law is at the same deflection for all pressures.

    Parameters
    ----------
    axes : name -> (n,) sqrt(m/s), sqrt(m), Pa. films : (n_speed, n_bend, n_pressure, n_exchanges) W/m2/K or W/K.
    standing : (n_exchanges,) films of a standing wheel. heat : (n_bend, n_pressure, nodes of all zones) W/m3 per m/s
    and unit of tan delta. sinks : (n_exchanges, 4): c, a, b, d of c + a ambient + b road + d initial temperature.
    bends : (n_load, n_pressure, 1) sqrt(m), the root of the deflection. bend_axes : the root of load, and Pa.
    """

    axes: dict[str, Array]
    films: Array
    standing: Array
    heat: Array
    sinks: Array
    bends: Array
    bend_axes: tuple[Array, Array]

    @property
    def _ends(self) -> Array:
        return _ends(*self.axes.values())

    def arrays(self, nodes: Array | slice = slice(None)) -> dict[str, Array]:
        """Arrays for the file, with the heat at these nodes."""
        return {
            "film_table": self.films,
            "film_axes": self._ends,
            "film_standing": self.standing,
            "heat_table": np.ascontiguousarray(self.heat[:, :, nodes]),
            "heat_axes": self._ends[1:],
            "sink": self.sinks,
            "bend_table": self.bends,
            "bend_axes": _ends(*self.bend_axes),
        }

    def errors(self, probe: Probe, count: int = 24, seed: int = 5) -> dict[str, float]:
        """Largest relative error of films and of heat sources at random inputs of the box."""
        places = probe.box.at(np.random.default_rng(seed).random((count, 5)))
        speeds = np.maximum(places[:, 0], 1e-3)
        films, heats = probe.at(speeds, places[:, 1:3])
        arrays = self.arrays()
        film, heat, bend = (
            CubicTable(arrays[f"{name}_table"], arrays[f"{name}_axes"]) for name in ("film", "heat", "bend")
        )
        off = np.zeros((count, 2))
        for k, (load, pressure) in enumerate(places[:, 1:3]):
            where = float(bend(float(np.sqrt(load)), float(pressure))[0]), float(pressure)
            off[k, 0] = np.abs(film(float(np.sqrt(speeds[k])), *where) - films[k, k]).max() / np.abs(films[k, k]).max()
            off[k, 1] = np.abs(heat(*where) - heats[k]).max() / np.abs(heats[k]).max()
        return {"films": float(off[:, 0].max()), "heat": float(off[:, 1].max())}


@dataclass(frozen=True, eq=False)
class Probe:
    """Evaluates films, sinks and strain energies of a study's tyre.

    Parameters
    ----------
    base : a tyre of the study; its mesh is used. points : of the tables; None: chosen by the cost of the strain law.
    """

    study: StudyData
    box: Box
    base: RollingTyre
    points: TablePoints | None = None

    def balance(self, drive: BoxDrive) -> ReducedBalance:
        """The tyre's heat balance on a drive, with the uniform mode only: films, sinks and sources are all it gives."""
        even = ReducedModel(self.base, np.ones((self.base.problem.operators.size, 1)), {}, np.zeros((0, 0)))
        return reduced_balance(even, RollingTyre(drive.study(self.study), self.base))

    def middle(self, initial: float | None = None, **inputs: float) -> ReducedBalance:
        """The tyre's heat balance with all inputs in the middle of the box, except those given."""
        values = self.box.at(np.full(5, 0.5))
        for name, value in inputs.items():
            values[NAMES.index(name)] = value
        start = self.study.card.drive.initial if initial is None else initial
        return self.balance(BoxDrive(np.array([0.0, 1.0]), values[None], values[None], start))

    def at(self, speeds: Array, pairs: Array) -> tuple[Array, Array]:
        """Films (n_pairs, n_speeds, n_exchanges) and heat (n_pairs, n_nodes) at pairs (load, pressure) and speeds.

        A single drive has a part of 1 s for every pair, in which the speed rises.
        """
        top = max(self.box.ranges["speed"][1], STANDSTILL)
        first = np.tile(self.box.at(np.full(5, 0.5)), (len(pairs) + 1, 1))
        # The first pair is repeated at the end, to detect films that depend on time.
        first[:, [NAMES.index("load"), NAMES.index("pressure")]] = np.vstack([pairs, pairs[:1]])
        last = first.copy()
        first[:, 0], last[:, 0] = 0.0, top
        balance = self.balance(BoxDrive(np.arange(len(first) + 1.0), first, last, float(first[0, 3])))
        plain(balance)
        # Speed 0 stands for a wheel that barely rolls; alone it stands for a standing wheel.
        least = 0.0 if len(speeds) == 1 and speeds[0] == 0 else 1e-9
        shares = np.clip(speeds / top, least, 1 - 1e-9)
        films = np.array([[balance.coefficients(k + share)[0] for share in shares] for k in range(len(first))])
        # Hardly rolling, times in late parts of the drive are rounded: small films count by the largest.
        if not np.allclose(films[0], films[-1], rtol=1e-6, atol=1e-6 * float(np.abs(films[0]).max())):
            raise InputError("films change with time; in a real-time model only the inputs may", field="effects")
        return films[:-1], np.array([_per_metre(balance.tyre, k + 0.5) for k in range(len(pairs))])

    def sinks(self) -> Array:
        """Coefficients c, a, b, d of every sink, c + a ambient + b road + d initial temperature: (n_exchanges, 4)."""

        def sinks(ambient: float, road: float, initial: float) -> Array:
            return self.middle(initial, ambient=ambient, road_temperature=road).coefficients(0.5)[1]

        still = sinks(20.0, 20.0, 20.0)
        slopes = [(sinks(*(20.0 + 10.0 * np.eye(3)[k])) - still) / 10.0 for k in range(3)]
        return np.column_stack([still - 20.0 * sum(slopes), *slopes])

    def tables(self, shared: Callable[[Array, Array], tuple[Array, Array]] | None = None) -> Tables:
        """The tables of the box. ``shared``: what evaluates the load cases in place of `at`, as workers do.

        Raises
        ------
        InputError : the tyre cannot carry a load at a pressure of the box; films change with time.
        """
        costly = strain_law(self.study).by_elements
        points = self.points or (COSTLY if costly else TablePoints())
        low, high = self.box.ranges["load"]
        least, most = self.box.ranges["pressure"]
        law, rating = self.study.card.mechanics.load_law, self.study.section.rating
        if rating is None:
            raise InputError("a real-time model needs the section's [rating]", field="section.rating")

        def bend(load: float, pressure: float) -> float:
            return float(np.sqrt(law.deflection(load, pressure, rating))) if load > 0 else 0.0

        if shared is None:
            # Corners of the box first: they raise the clear error of a load that the tyre cannot carry.
            self.at(np.ones(1), np.array([(load, pressure) for load in (low, high) for pressure in (least, most)]))
        axes = {
            "speed": _axis(*(float(np.sqrt(limit)) for limit in self.box.ranges["speed"]), count=points.speed),
            "bend": _axis(bend(low, most), bend(high, least), count=points.bend),
            "pressure": _axis(least, most, count=points.pressure),
        }
        pairs = np.array([(law.load(x**2, p, rating), p) for x in axes["bend"] for p in axes["pressure"]])
        films, heats = (shared or self.at)(axes["speed"] ** 2, pairs)
        counts = [len(axis) for axis in axes.values()]
        films = np.moveaxis(films.reshape(counts[1], counts[2], counts[0], -1), 2, 0)
        # Films of a standing wheel are those of any load; the middle is solved anyway.
        standing, _ = self.at(np.zeros(1), pairs[:1] if shared is None else self.box.at(np.full(5, 0.5))[None, 1:3])
        roots, pressures = _axis(np.sqrt(low), np.sqrt(high), count=BENDS[0]), _axis(least, most, count=BENDS[1])
        bends = np.array([[[bend(x**2, p)] for p in pressures] for x in roots])
        heat = heats.reshape(*counts[1:], -1)
        return Tables(axes, films, standing[0, 0], heat, self.sinks(), bends, (roots, pressures))


def _axis(low: float, high: float, *, count: int) -> Array:
    return np.linspace(low, high, count if high > low else 1)


def _ends(*axes: Array) -> Array:
    return np.array([(axis[0], axis[-1], len(axis)) for axis in axes])


def _per_metre(tyre: RollingTyre, t: float) -> Array:
    """Energy lost per metre of road and unit of tan delta, (nodes of all zones,) J/m3/m."""
    parts, motion = [], tyre.motion(t)
    for zone, source in tyre.hysteresis.items():
        rate = source.lost_per_revolution * motion.revolutions_per_second / motion.speed
        parts.append(rate * source.energy_density(tyre.problem.points(zone), t))
    return np.concatenate(parts)


def plain(balance: ReducedBalance) -> None:
    """Raise `InputError` if effects or laws act that a real-time model does not have."""
    for zone, source in balance.tyre.sources.items():
        if type(source) is not HeatSource:
            raise InputError(
                "effects act on the heat source; a real-time model has the strain cycle's heat only", field="effects"
            )
        if source.over_frequency is not None:
            raise InputError(
                f"tan delta of '{zone}' depends on frequency; in a real-time model it depends on temperature only",
                field="materials",
            )
    if any(balance.powers(0.0)):
        raise InputError("effects heat the rim or the air; a real-time model has no such heat", field="effects")


def loss_tables(tyre: RollingTyre, samples: Sequence[tuple[str, int]]) -> tuple[Array, Array]:
    """tan delta every `FINE` K, (n_laws, n_temperatures), and the law of every sample; ``samples``: (zone, count)."""
    grid = np.arange(COLD, HOT + FINE / 2, FINE)
    laws: dict[bytes, int] = {}
    rows: list[Array] = []
    of_sample: list[int] = []
    for zone, count in samples:
        source: Any = tyre.sources[zone]
        row = np.asarray(source.loss_tangent(grid), dtype=float)
        if row.tobytes() not in laws:
            laws[row.tobytes()] = len(rows)
            rows.append(row)
        of_sample += [laws[row.tobytes()]] * count
    return np.array(rows), np.array(of_sample)
