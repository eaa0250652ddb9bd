"""The next experiment: the sensor place and the drive that best separate the two most probable sets."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.diagnose.fitting.fits import FittedSet
from tyrefem.diagnose.forward.fixed_step import FixedStepRun
from tyrefem.diagnose.forward.forward_model import ForwardModel
from tyrefem.diagnose.forward.sampling import DriveSampling, SensorSampling
from tyrefem.diagnose.unknowns.candidates import Members
from tyrefem.diagnose.verdicts.verdict import Judgement, RankedSet
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.simulation.surroundings import GAS

Array = NDArray[np.float64]
#: Feasible drives: factors on the numbers of the study's drive.
DRIVES = {
    "half the speed": {"speed": 0.5},
    "1.5 times the speed": {"speed": 1.5},
    "twice the speed": {"speed": 2.0},
    "three quarters of the load": {"load": 0.75},
    "1.25 times the load": {"load": 1.25},
    "four fifths of the pressure": {"pressure": 0.8},
}
STATIONS = 9
#: Standard deviation of a reading without a sensor's card (new sensor, contained air), K.
NOISE = 0.5
#: Smallest distance between a thermocouple and a surface, m.
SKIN = 1e-3


def next_experiment(
    model: ForwardModel, judgement: Judgement, fit_of: Callable[[Members], FittedSet]
) -> dict[str, Any]:
    """The sensor place and the drive that separate the two most probable sets best.

    The expected gain of a further history is the ln of the odds that it adds to the true set:
    delta^T (C + position and offset of a new sensor)^-1 delta / 2, with delta the difference of the two predictions at
    their fits. Base numbers are not fitted to the new history, so the gain is an upper estimate.

    Returns
    -------
    ``between`` (two sets), ``sensors`` and ``drives`` in order of gain; empty if only one set is left.
    """
    sets = compared_sets(judgement)
    if len(sets) < 2:
        return {}
    fits = [entry.fit or fit_of(entry.members) for entry in sets]
    first, second = (fit.values for fit in fits)
    sensors: dict[str, dict[str, Any]] = {}
    for number in range(len(model.drives)):
        pair = [model.simulate(number, values) for values in (first, second)]
        for name, position, delta, spread, times in _places(model.study, pair):
            gain = _gain(times, delta, spread, model.study)
            row = sensors.setdefault(name, {"place": name, **position, "gain": 0.0, "largest_K": 0.0, "run": ""})
            row["gain"] += gain
            if np.abs(delta).max() > row["largest_K"]:
                row["largest_K"], row["run"] = float(np.abs(delta).max()), model.drives[number].name
    drives = [drive_gain(model, name, factors, first, second) for name, factors in DRIVES.items()]
    return {
        "between": [sets[0].key, sets[1].key],
        "sensors": sorted(sensors.values(), key=lambda place: -place["gain"])[:5],
        "drives": sorted((drive for drive in drives if drive), key=lambda drive: -drive["gain"]),
    }


def compared_sets(judgement: Judgement) -> list[RankedSet]:
    """The best set and the most probable one that lacks one of its effects, as a plan compares them.

    If all others contain it: the next one.
    """
    sets = [entry for entry in judgement.credible if not entry.outside]
    for other in sets[1:]:
        if not set(sets[0].members) <= set(other.members):
            return [sets[0], other]
    return sets[:2]


def _places(study: StudyData, pair: list[FixedStepRun]) -> list[tuple[str, dict[str, float], Array, Array, Array]]:
    """(name, position, difference (n,) K, sd from the position (n,) K, times) at every feasible sensor place."""
    section = study.section
    s = np.repeat(np.linspace(0.0, section.line.length * 0.98, STATIONS), 3)
    total = np.asarray(section.rubber_thickness(s))
    depth = np.where(np.arange(len(s)) % 3 == 0, SKIN, np.where(np.arange(len(s)) % 3 == 1, total / 2, total - SKIN))
    values = [simulation.at(s, depth) for simulation in pair]
    gradient = np.zeros_like(values[0])
    for along, deeper in ((SKIN / 2, 0.0), (0.0, SKIN / 2)):
        moved = pair[0].at(*section.clamp(s + along, depth + deeper, SKIN / 4))
        gradient = gradient + ((moved - values[0]) / (SKIN / 2)) ** 2
    spread = np.sqrt(gradient) * 1e-3
    level = ("inside", "middle", "outside")
    places = [
        (
            f"s = {s[i] * 1e3:.0f} mm, {level[i % 3]}",
            {"s_m": float(s[i]), "depth_m": float(depth[i])},
            values[0][:, i] - values[1][:, i],
            spread[:, i],
            pair[0].grid,
        )
        for i in range(len(s))
    ]
    gas = pair[0].readings[GAS] - pair[1].readings[GAS]
    if GAS not in study.sensors:
        places.append(("contained air", {}, gas, np.zeros_like(gas), pair[0].grid))
    return places


def _gain(
    times: Array, delta: Array, spread: Array, study: StudyData, noise: float = NOISE, accuracy: float = 1.0
) -> float:
    choice = study.card.diagnosis
    thinned = slice(None, None, max(len(times) // 60, 1))
    t, d, g = times[thinned], delta[thinned], spread[thinned]
    apart = np.abs(t[:, None] - t[None, :])
    covariance = noise**2 * np.eye(len(t)) + choice.discrepancy**2 * np.exp(-apart / choice.correlation_time)
    covariance += accuracy**2 + np.outer(g, g)
    return float(d @ np.linalg.solve(covariance, d) / 2)


def drive_gain(model: ForwardModel, name: str, factors: Mapping[str, float], *values: Any) -> dict[str, Any] | None:
    """Gain of a drive with the study's sensors, or else with the contained air; None for an impossible drive."""
    from tyrefem.inputs.changes import scaled

    drive = model.study.data["drive"]
    try:
        changed = {key: scaled(drive[key], factor) for key, factor in factors.items() if key in drive}
        if not changed:
            return None
        study = model.study.with_drive(changed)
        times = np.arange(0.0, study.card.drive.end + 1e-9, 10.0)
        noises = {name: sensor.noise for name, sensor in study.sensors.items()} or {GAS: NOISE}
        sensors = tuple(SensorSampling(name, times, sd, 0.1, 100.0) for name, sd in noises.items())
        pair = [
            ForwardModel(model.study, (DriveSampling(name, changed, True, sensors),)).simulate(0, fitted)
            for fitted in values
        ]
    except InputError:
        return None
    gain, largest, where = 0.0, 0.0, ""
    for sensor, sd in noises.items():
        a, b = (simulation.readings for simulation in pair)
        delta = a[sensor] - b[sensor]
        # The existing sensors keep their fitted positions and offsets, so only a small offset remains.
        gain += _gain(pair[0].grid, delta, np.zeros_like(delta), study, sd, 0.1)
        if np.abs(delta).max() > largest:
            largest, where = float(np.abs(delta).max()), sensor
    return {"drive": name, "changes": changed, "gain": gain, "largest_K": largest, "sensor": where}
