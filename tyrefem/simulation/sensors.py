"""The measurement operator: place and lag of thermocouples, and errors of the logger."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import solve_banded

if TYPE_CHECKING:
    from tyrefem.effects.effect import Effect
    from tyrefem.inputs.study import StudyData

Array = NDArray[np.float64]


def lagged(times: Array, temperatures: Array, lag: float) -> Array:
    """Reading of a first-order sensor, lag dy/dt + y = T, that starts in equilibrium.

    Exact if the temperature is linear between the times.

    Parameters
    ----------
    times : (n,) s; temperatures : (n, ...) degC; lag : time constant, s.

    >>> t = np.linspace(0.0, 10.0, 11)
    >>> bool(abs(lagged(t, 2.0 * t, 1.0)[-1] - (20.0 - 2.0 * (1 - np.exp(-10.0)))) < 1e-12)
    True
    """
    if lag <= 0 or len(times) < 2:
        return np.array(temperatures, dtype=float)
    temperatures = np.asarray(temperatures, dtype=float)
    steps = np.diff(times).reshape(-1, *(1,) * (temperatures.ndim - 1))
    behind = lag * np.diff(temperatures, axis=0) / steps
    before, after, decay = temperatures[:-1] - behind, temperatures[1:] - behind, np.exp(-steps / lag)
    # Particular solution T - lag * slope, plus what is left of the old offset: a recursion, solved as a band of two.
    bands = np.ones((2, len(times)))
    bands[1, :-1] = -decay.reshape(-1)
    given = np.concatenate([temperatures[:1], after - before * decay])
    solution = solve_banded((1, 0), bands, given.reshape(len(given), -1), check_finite=False)
    return np.asarray(solution).reshape(given.shape)


def true_places(study: StudyData) -> dict[str, tuple[float, float]]:
    """(r, z) of every sensor, m: the stated places, displaced by the study's effects, kept in the rubber."""
    stated = study.stated_places
    section, true = study.section, dict(stated)
    worn_away = () if section.as_built is None else [name for name in stated if not section.contains([stated[name]])[0]]
    displaced = displacements(study)
    moved = {name: displaced[name] for name in stated if displaced[name] != (0.0, 0.0) or name in worn_away}
    if moved:
        s, depth = section.locate(np.array([stated[name] for name in moved]))
        along_by, deeper_by = np.array(list(moved.values())).T
        places = section.place(*section.clamp(s + along_by, depth + deeper_by, 0.0))
        true |= {name: (float(r), float(z)) for name, (r, z) in zip(moved, places, strict=True)}
    return true


def displacements(study: StudyData) -> dict[str, tuple[float, float]]:
    """Distance of every sensor from its stated place by the study's effects, along the meridian and in depth, m."""
    effects = _acting_at("displacement", study)
    moves = {name: [effect.displacement(name) for effect in effects] for name in study.stated_places}
    return {name: (sum(along for along, _ in each), sum(deeper for _, deeper in each)) for name, each in moves.items()}


def recorded(study: StudyData, times: Array, temperatures: ArrayLike) -> dict[str, Array]:
    """Recorded readings for temperatures (n_times, n_sensors, ...) at the sensors, degC, in the study's order.

    Lag first, then the effects of measurement: a further lag, swapped channels, offset, offset of the logger's clock.
    """
    values = np.asarray(temperatures, dtype=float)
    slower, swapping, off = (_acting_at(port, study) for port in ("lag_addend", "channel", "offset"))
    lags = {
        name: sensor.lag + sum(effect.lag_addend(name) for effect in slower) for name, sensor in study.sensors.items()
    }
    # Sensors with one lag are read together.
    of_lag: dict[float, list[str]] = {}
    for name, lag in lags.items():
        of_lag.setdefault(lag, []).append(name)
    place = {name: column for column, name in enumerate(lags)}
    read: dict[str, Array] = {}
    for lag, names in of_lag.items():
        together = lagged(times, values[:, [place[name] for name in names]], lag)
        read |= {name: together[:, column] for column, name in enumerate(names)}
    readings = {}
    for name in lags:
        channel = name
        for effect in swapping:
            channel = effect.channel(channel)
        readings[name] = read[channel] + sum(effect.offset(name) for effect in off)
    late = _late(study)
    return {name: _later(times, column, late) for name, column in readings.items()} if late else readings


def _acting_at(port: str, study: StudyData) -> list[Effect]:
    """The study's effects that act at a port; most of a diagnosis's many effects do not act on a sensor."""
    return [effect for effect in study.effects if effect.overrides(port)]


def logged(study: StudyData, times: Array, temperatures: Array) -> Array:
    """Temperatures (n_times, ...) by the logger's clock, which all channels have, also contained air and rim."""
    late = _late(study)
    return _later(times, temperatures, late) if late else temperatures


def _late(study: StudyData) -> float:
    """How late the logger's clock is, s."""
    return sum(effect.clock() for effect in _acting_at("clock", study))


def _later(times: Array, readings: Array, late: float) -> Array:
    """Readings (n, ...) at ``late`` (s) after each of the times; constant beyond the last time."""
    if readings.ndim == 1:
        return np.interp(times + late, times, readings)
    return np.column_stack([np.interp(times + late, times, column) for column in readings.T])


def recorded_change(study: StudyData, times: Array, temperatures: ArrayLike) -> dict[str, Array]:
    """Change of the recorded readings, K, for a change of the sensors' temperatures (n_times, n_sensors, ...), K.

    `recorded` is linear, except for the constant offsets of channels.
    """
    readings = recorded(study, times, temperatures)
    return {name: column - sum(effect.offset(name) for effect in study.effects) for name, column in readings.items()}
