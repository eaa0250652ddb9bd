"""Contracts of what an effect says of itself by `of_place`, `of_drive`, `heat_of_temperature` and `jumps`.

Simulations keep its values by these flags: a false one would give a wrong temperature without a word.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tyrefem.contracts.contract import Contract, kept
from tyrefem.effects import Effect
from tyrefem.effects.combined import SURROUNDING
from tyrefem.effects.effect import FILMS, SINKS
from tyrefem.mechanics.user_cycle import points_of
from tyrefem.simulation.effect_trials import TEMPERATURES
from tyrefem.simulation.surroundings import Surroundings

Array = NDArray[np.float64]
HEAT = ("heat_factor", "heat_addend")
#: Shares of a phase at which values are compared.
SHARES = (0.1, 0.37, 0.9)
#: Times between two known jumps at which a port is evaluated; halvings of the interval with the largest change, and the
#: share of it that must remain in the end to be a jump.
SAMPLES, HALVINGS, REMAINS = 33, 30, 0.5


def flag_contracts(tyre: Surroundings, effect: Effect) -> Iterator[Contract]:
    """The contracts of an effect's flags on a tyre."""
    if effect.of_place and effect.overrides("heat_factor"):
        words = "of_place: its factor on the heat is the same at all times and temperatures"
        yield kept(words, lambda: _same_heat(tyre, effect, ("heat_factor",), _moments(tyre)))
    heats = tuple(name for name in HEAT if effect.overrides(name))
    if not effect.heat_of_temperature and heats:
        words = "heat_of_temperature = False: its heat is the same at all temperatures"
        yield kept(words, lambda: _same_heat(tyre, effect, heats, _moments(tyre)[:1]))
    of_time = {} if effect.states else _ports_over_time(tyre, effect)
    if not of_time:
        return
    surrounding = {name: port for name, port in of_time.items() if name.split("(")[0] in SURROUNDING}
    if effect.of_drive and surrounding:
        words = "of_drive: films, sinks and the rim's power are constant in steady phases"
        yield kept(words, lambda: _constant(tyre, surrounding))
    yield kept("its ports jump over time at its jumps only", lambda: _jump(tyre, effect, of_time))


def _moments(tyre: Surroundings) -> list[float]:
    """Times within each phase, s."""
    borders = [*tyre.drive.starts, tyre.drive.end]
    return [start + share * (end - start) for start, end in pairwise(borders) for share in SHARES]


def _same_heat(tyre: Surroundings, effect: Effect, ports: tuple[str, ...], moments: list[float]) -> str | None:
    for zone in tyre.schedule.zones:
        x = points_of(tyre.study.section, zone)
        for name in ports:
            values = [
                (t, temperature, np.broadcast_to(getattr(effect, name)(tyre, zone.name, x, t, T), T.shape))
                for t in moments
                for temperature in TEMPERATURES
                for T in [np.full(x.shape[1], temperature)]
            ]
            t_0, temperature_0, first = values[0]
            for t, temperature, value in values[1:]:
                if not np.allclose(value, first, rtol=1e-9, atol=0):
                    at = int(np.argmax(np.abs(value - first)))
                    return (
                        f"{name} in zone '{zone.name}' gives {first[at]:.6g} at {t_0:g} s and {temperature_0:g} degC, "
                        f"{value[at]:.6g} at {t:g} s and {temperature:g} degC"
                    )
    return None


def _ports_over_time(tyre: Surroundings, effect: Effect) -> dict[str, Callable[[float], Array]]:
    """Name -> values over time of every port that has a time, of each film, sink, surface or zone."""
    points = {zone.name: points_of(tyre.study.section, zone) for zone in tyre.schedule.zones}
    everywhere = np.concatenate(list(points.values()), axis=1)
    places = {"film": FILMS, "sink": SINKS, "surface": effect.surfaces, "zone": tuple(points)}

    def over_time(port: str, names: list[str], place: str | None) -> Callable[[float], Array]:
        x = points.get(place or "", everywhere)
        known = {"tyre": tyre, "x": x, "T": np.full(x.shape[1], 60.0)}

        def values(t: float) -> Array:
            arguments = [t if name == "t" else known.get(name, place) for name in names]
            return np.ravel(np.asarray(getattr(effect, port)(*arguments), dtype=float))

        return values

    ports: dict[str, Callable[[float], Array]] = {}
    for port in effect.ports():
        names = [name for name in inspect.signature(getattr(Effect, port)).parameters if name != "self"]
        if "t" not in names:
            continue
        of = next((places[name] for name in names if name in places), (None,))
        ports |= {f"{port}({'' if place is None else repr(place)})": over_time(port, names, place) for place in of}
    return ports


def _constant(tyre: Surroundings, ports: dict[str, Callable[[float], Array]]) -> str | None:
    """The first port that changes within a phase whose drive is constant."""
    borders = [*tyre.drive.starts, tyre.drive.end]
    for number, (phase, (start, end)) in enumerate(zip(tyre.drive.phases, pairwise(borders), strict=True)):
        if not tyre.is_steady(number):
            continue
        first, *others = (start + share * (end - start) for share in SHARES)
        for name, port in ports.items():
            for t in others:
                before, now = port(first), port(t)
                if not np.allclose(now, before, rtol=1e-9, atol=1e-12):
                    at = int(np.argmax(np.abs(now - before)))
                    return (
                        f"{name} gives {before[at]:.6g} at {first:g} s and {now[at]:.6g} at {t:g} s, within phase "
                        f"'{phase.name}', in which nothing of the drive changes"
                    )
    return None


def _jump(tyre: Surroundings, effect: Effect, ports: dict[str, Callable[[float], Array]]) -> str | None:
    """The first jump of a port between the borders of phases and the effect's jumps."""
    end = tyre.drive.end
    knots = sorted({*tyre.drive.starts, end, *(time for time in effect.jumps if 0 < time < end)})
    for start, stop in pairwise(knots):
        inside = max(1e-9 * (stop - start), 4 * float(np.spacing(stop)))
        times = np.linspace(start + inside, stop - inside, SAMPLES)
        for name, port in ports.items():
            values = [port(float(t)) for t in times]
            changes = [float(np.abs(after - before).max()) for before, after in pairwise(values)]
            largest = int(np.argmax(changes))
            if changes[largest] <= 1e-9 * max(float(np.abs(value).max()) for value in values):
                continue
            early, late = float(times[largest]), float(times[largest + 1])
            before, after = values[largest], values[largest + 1]
            for _ in range(HALVINGS):
                middle = (early + late) / 2
                value = port(middle)
                if np.abs(value - before).max() >= np.abs(after - value).max():
                    late, after = middle, value
                else:
                    early, before = middle, value
            if np.abs(after - before).max() > REMAINS * changes[largest]:
                known = ", ".join(f"{time:g} s" for time in effect.jumps) or "none"
                return (
                    f"{name} jumps at {late:.6g} s; its jumps are: {known}; time steps must end there: "
                    f"jumps = ({late:.6g},), or a property"
                )
    return None
