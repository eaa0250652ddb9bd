"""Measured and computed readings of one sensor in one run at the same times, with their uncertainties."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.compare.experiment import Experiment
from tyrefem.compare.interface import PhaseLike, ResultLike, StudyLike
from tyrefem.compare.sensors import sensor_of
from tyrefem.errors import InputError, nearest

Array = NDArray[np.float64]
#: The row over all phases.
ALL = "all"


@dataclass(frozen=True, eq=False)
class SensorHistory:
    """Readings of one sensor in one run that lie within the simulated span; n readings.

    Parameters
    ----------
    times, measured, computed : (n,) s, degC, degC.
    phases : (n,) name of the drive's phase of each reading; "" between phases.
    gradient : (n,) K/m, magnitude of the computed temperature gradient at the sensor.
    changes : dotted key -> (n,) K, change of the computed reading when that input is one sd higher.
    noise, accuracy : K; standard deviation of one reading, and of the offset that all readings share.
    position_sd : m. ``numerical`` : K, standard uncertainty of the computation.
    """

    run: str
    sensor: str
    hold_out: bool
    times: Array
    measured: Array
    computed: Array
    phases: NDArray[np.object_]
    gradient: Array
    changes: Mapping[str, Array]
    noise: float
    accuracy: float
    position_sd: float
    numerical: float

    @property
    def error(self) -> Array:
        """(n,) K, E = computed - measured."""
        return self.computed - self.measured

    @property
    def reading_uncertainty(self) -> Array:
        """(n,) K, standard validation uncertainty of each single reading."""
        inputs = sum((change**2 for change in self.changes.values()), np.zeros(len(self.times)))
        steady = self.numerical**2 + self.noise**2 + self.accuracy**2
        return np.sqrt(steady + (self.position_sd * self.gradient) ** 2 + inputs)

    def stretches(self) -> Iterator[tuple[str, NDArray[np.bool_]]]:
        """Each phase that has readings, then all readings, as masks."""
        for name in dict.fromkeys(self.phases):
            if name:
                yield str(name), self.phases == name
        yield ALL, np.ones(len(self.times), dtype=bool)


def histories(
    experiment: Experiment,
    study: StudyLike,
    result: ResultLike,
    perturbed: Mapping[str, ResultLike],
) -> tuple[list[SensorHistory], int]:
    """The histories of a run's sensors, and the number of measured times outside the simulated span.

    Computed readings are interpolated linearly between saved times and never extrapolated.

    Raises
    ------
    InputError : a measured sensor has no computed reading.
    """
    run = experiment.run
    simulated = result.readings["time_s"].to_numpy(dtype=float)
    slack = 1e-9 * max(abs(simulated[-1]), 1.0)
    inside = (run.times >= simulated[0] - slack) & (run.times <= simulated[-1] + slack)
    compared = []
    for sensor in run.sensors:
        if sensor not in result.readings:
            known = [str(name) for name in result.readings if name != "time_s"]
            raise InputError(f"no computed reading of sensor '{sensor}'{nearest(sensor, known)}", file=run.file)
        readings = run.temperatures[sensor].to_numpy(dtype=float)
        used = inside & np.isfinite(readings)
        times = run.times[used]
        computed = at_times(result, sensor, times)
        card = sensor_of(study, sensor)
        compared.append(
            SensorHistory(
                run=run.name,
                sensor=sensor,
                hold_out=experiment.hold_out,
                times=times,
                measured=readings[used],
                computed=computed,
                phases=phase_names(times, result.phases),
                gradient=_gradient(result, sensor, times),
                changes={key: at_times(other, sensor, times) - computed for key, other in perturbed.items()},
                noise=experiment.noise_of(sensor, study),
                accuracy=card.accuracy,
                position_sd=card.position_sd,
                numerical=float(np.hypot(study.tolerance, study.numerical_sd)),
            )
        )
    return [history for history in compared if len(history.times)], int((~inside).sum())


def at_times(result: ResultLike, sensor: str, times: Array) -> Array:
    """(n,) degC, computed readings of a sensor at given times.

    Raises
    ------
    InputError : the computed readings are not finite.
    """
    saved = result.readings["time_s"].to_numpy(dtype=float)
    readings = result.readings[sensor].to_numpy(dtype=float)
    if not np.isfinite(readings).all():
        raise InputError(f"the computed readings of sensor '{sensor}' are not finite")
    return np.interp(times, saved, readings)


def _gradient(result: ResultLike, sensor: str, times: Array) -> Array:
    table = result.gradient_at_sensors
    if sensor not in table:
        return np.zeros(len(times))
    saved = table["time_s"].to_numpy(dtype=float)
    return np.nan_to_num(np.interp(times, saved, table[sensor].to_numpy(dtype=float)))


def phase_names(times: Array, phases: Sequence[PhaseLike]) -> NDArray[np.object_]:
    """(n,) name of the phase of each time; a time at a border belongs to the phase that ends there.

    Phases with the same name get numbers; "all" is reserved for all phases together.
    """
    names = np.full(len(times), "", dtype=object)
    taken = {ALL: 1}
    for phase in phases:
        taken[phase.name] = taken.get(phase.name, 0) + 1
        name = phase.name if taken[phase.name] == 1 else f"{phase.name} {taken[phase.name]}"
        slack = 1e-9 * max(abs(phase.end), 1.0)
        within = (times >= phase.start - slack) & (times <= phase.end + slack)
        names[within & (names == "")] = name
    return names
