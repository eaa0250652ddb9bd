"""Answers: the numbers that are computed from every finished variant.

A function decorated with `answer` adds answers; the decorator takes their names. `FinishedRun` is the interface that
these functions may use: results of full runs and variants of reduced models have it.
"""

from __future__ import annotations

import fnmatch
import functools
from collections.abc import Callable, Iterable, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.boundaries.rim import LumpedRim
from tyrefem.errors import InputError, nearest
from tyrefem.inputs.drive import slides
from tyrefem.simulation.surroundings import GAS, RIM

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData
    from tyrefem.simulation.rolling_tyre import RollingTyre
    from tyrefem.variants.finished_run import FinishedRun

Answers = dict[str, Any]


#: This answer exists only if a temperature (``time_to``) is given.
TIME_TO = "time_to_limit_s"


#: s, in place of the time of a temperature that was not reached: later than any time.
NEVER = 1e9
Function = Callable[["FinishedRun", float | None], Answers]


#: Names of a function's answers for a study; ``*`` stands for any name.
Names = Callable[["StudyData"], list[str]]
_FUNCTIONS: list[tuple[Function, Names]] = []
#: Functions whose answers need no run.
_OF_INPUTS: dict[str, Callable[[RollingTyre], Answers]] = {}


def answer(names: Names) -> Callable[[Function], Function]:
    """Add a function to the answers of every variant; ``names``: gives their names for a study without a run."""

    def add(function: Function) -> Function:
        _FUNCTIONS.append((function, names))
        return function

    return add


def answer_of_inputs(names: Names) -> Callable[[Callable[[RollingTyre], Answers]], Function]:
    """Add a function of the tyre before any run to the answers of every variant; ``names`` as in `answer`."""

    def add(function: Callable[[RollingTyre], Answers]) -> Function:
        _OF_INPUTS[function.__name__] = function

        @answer(names)
        @functools.wraps(function)
        def of_run(result: FinishedRun, _: float | None) -> Answers:
            return function(result.tyre)

        return of_run

    return add


def input_answers(tyre: RollingTyre) -> dict[str, Answers]:
    """Function -> its answers, of the functions that need no run; empty where the study has none of its answers."""
    none: dict[str, Answers] = {function.__name__: {} for function, names in _FUNCTIONS if not names(tyre.study)}
    return none | {name: function(tyre) for name, function in _OF_INPUTS.items()}


def answers(
    result: FinishedRun, time_to: float | None = None, known: Mapping[str, Mapping[str, Any]] = MappingProxyType({})
) -> Answers:
    """All answers of a run: name, ending in its unit -> value in SI units or degC.

    Parameters
    ----------
    time_to : degC; `TIME_TO` is the time at which any point of the tyre first reaches this temperature.
    known : answers that need no run, as `input_answers`.
    """
    values: Answers = {}
    for function, _ in _FUNCTIONS:
        values |= known[function.__name__] if function.__name__ in known else function(result, time_to)
    return values


def comparable(name: str, values: Any) -> Any:
    """An answer, or many, as numbers to compare: a time that is not reached is `NEVER`; others without one stay NaN.

    >>> comparable("time_to_limit_s", [600.0, np.nan]), comparable("lost_rim_share", [0.5, np.nan])
    (array([6.e+02, 1.e+09]), array([0.5, nan]))
    """
    numbers = np.asarray(values, dtype=float)
    return np.where(np.isnan(numbers), NEVER, numbers) if name == TIME_TO else numbers


def answer_names(study: StudyData, time_to: float | None = None) -> list[str]:
    """Names of the numbers in `answers` of a study, without running it.

    >>> import tyrefem
    >>> answer_names(tyrefem.study("nasa-22x5.5-8pr"))[:3]
    ['hottest_degC', 'hottest_s_m', 'hottest_depth_m']
    """
    all_names = [name for _, names in _FUNCTIONS for name in names(study)]
    return all_names if time_to is not None else [name for name in all_names if name != TIME_TO]


def highest_name(sensor: str, regions: Iterable[str]) -> str:
    """Name of a sensor's highest temperature; a sensor named as a region leaves the plain name to the region.

    >>> highest_name("crown", ["tread"]), highest_name("tread", ["tread"])
    ('crown_max_degC', 'tread_sensor_max_degC')
    """
    return f"{sensor}_sensor_max_degC" if sensor in regions else f"{sensor}_max_degC"


def check_sensor_names(study: StudyData) -> None:
    """Raise `InputError` for a sensor whose last reading has the name of another answer, such as ``hottest_degC``."""
    everything = answer_names(study)
    for name in study.sensors:
        if everything.count(f"{name}_degC") > 1:
            message = f"'{name}_degC' would be an answer of this sensor and another one too: name the sensor otherwise"
            raise InputError(f"{message}, e.g. '{name}-sensor'", field=f"sensors.{name}")


def check_answer(name: str, study: StudyData, time_to: float | None = None) -> None:
    """Raise `InputError`, with the nearest name, if a study has no such answer."""
    known = answer_names(study, time_to)
    # A sensor's name may have brackets, which a pattern would read as a choice of letters.
    if name not in known and not any(fnmatch.fnmatchcase(name, pattern) for pattern in known):
        hint = "; it needs a temperature: 'time_to'" if name == TIME_TO else nearest(name, known)
        raise InputError(f"no answer '{name}'{hint}")


@answer(
    lambda study: [
        *("hottest_degC", "hottest_s_m", "hottest_depth_m", "hottest_time_s"),
        *(f"{region}_max_degC" for region in study.section.regions),
    ]
)
def hottest(result: FinishedRun, _: float | None) -> Answers:
    """Highest temperature over the run with its place and time, and the highest per region."""
    peaks = dict(result.peaks)
    peak = peaks.pop("tyre")
    along, depth = result.place_of(peak)
    return {
        "hottest_degC": float(peak.temperature),
        "hottest_region": max(peaks, key=lambda region: peaks[region].temperature),
        "hottest_s_m": along,
        "hottest_depth_m": depth,
        "hottest_time_s": float(peak.time),
        **{f"{region}_max_degC": float(region_peak.temperature) for region, region_peak in peaks.items()},
    }


@answer(
    lambda study: [
        *(f"{name}_degC" for name in study.sensors),
        *(highest_name(name, study.section.regions) for name in study.sensors),
    ]
)
def sensors(result: FinishedRun, _: float | None) -> Answers:
    """Temperature of every sensor at the end, and its maximum."""
    # The study of a result by a reduced model is made only when it is asked for.
    read, regions = result.recorded, result.peaks.keys() - {"tyre"}
    return {f"{name}_degC": float(series[-1]) for name, series in read.items()} | {
        highest_name(name, regions): float(series.max()) for name, series in read.items()
    }


@answer(
    lambda study: [
        *(f"{GAS}_degC", "gas_pressure_Pa"),
        *([f"{RIM}_degC"] if isinstance(study.card.boundaries.rim, LumpedRim) else []),
    ]
)
def gas(result: FinishedRun, _: float | None) -> Answers:
    """Contained air at the end, and a lumped rim."""
    values = {
        f"{GAS}_degC": float(result.gas_temperature[-1]),
        "gas_pressure_Pa": result.pressure_at(len(result.times) - 1),
    }
    rim = result.rim_temperature
    return values if rim is None else values | {f"{RIM}_degC": float(rim[-1])}


@answer(lambda _: ["gradient_K_m", "gradient_s_m"])
def gradient(result: FinishedRun, _: float | None) -> Answers:
    """Steepest mean gradient from the inner to the outer surface at the end, K/m, and its station, m."""
    s, steep = result.wall_gradient
    i = int(np.argmax(steep))
    return {"gradient_K_m": float(steep[i]), "gradient_s_m": float(s[i])}


@answer(
    lambda _: [f"rolling_resistance_{end}" for end in ("N", "coefficient", "coefficient_cold")],
)
def resistance(result: FinishedRun, _: float | None) -> Answers:
    """Rolling resistance of hysteresis, warm and cold."""
    resistance = result.rolling_resistance
    return {
        "rolling_resistance_N": resistance.force,
        "rolling_resistance_coefficient": resistance.coefficient,
        "rolling_resistance_coefficient_cold": resistance.cold_coefficient,
    }


@answer(
    lambda study: [
        *(f"stored_{region}_share" for region in study.section.regions),
        *(f"lost_{name}_share" for name in ("road contact", "air at the tread", "outside air", "contained air", "rim")),
        # Slip and effects may add other heat losses.
        *(["lost_*_share"] if study.effects or any(map(slides, study.card.drive.phases)) else []),
        "heat_J",
    ]
)
def shares(result: FinishedRun, _: float | None) -> Answers:
    """Shares of the heat budget in the total heat that entered the rubber."""
    budget = result.end_budget
    made = budget.made
    values = {
        f"{kind}_{name}_share": float(series[-1]) / made if made > 0 else float("nan")
        for (kind, name), series in budget.energies.items()
        if kind in ("lost", "stored")
    }
    return values | {"heat_J": made}


@answer_of_inputs(lambda _: ["mass_kg"])
def mass(tyre: RollingTyre) -> Answers:
    """Mass of the whole tyre, kg."""
    from tyrefem.materials.cord_layers import masses

    study = tyre.study
    return {"mass_kg": float(sum(masses(study.section, study.materials).values()))}


@answer_of_inputs(lambda _: ["load_N", "deflection_m"])
def drive(tyre: RollingTyre) -> Answers:
    """Load and deflection of the last phase."""
    schedule, end = tyre.schedule, tyre.drive.end * (1 - 1e-12)
    return {
        "load_N": schedule.mean(lambda case: case.load, end),
        "deflection_m": schedule.mean(lambda case: case.deflection, end),
    }


def life_names(study: StudyData) -> list[str]:
    """Names of the answers of `shortest_life`: none unless ``output.life = true``.

    Raises
    ------
    InputError : ``output.life`` in a study whose life cannot be computed.
    """
    if not study.card.output.life:
        return []
    from tyrefem.fatigue.life import check

    check(study)
    return ["life_km", "life_log10_km", "life_s_m", "life_place_degC", "life_peak_J_m3"]


@answer(life_names)
def shortest_life(result: FinishedRun, _: float | None) -> Answers:
    """Fatigue life of the element that fails first, its place along the meridian, temperature and cracking energy."""
    if not result.study.card.output.life:
        return {}
    from tyrefem.fatigue.life import life
    from tyrefem.fatigue.places import first_places

    (place,) = first_places(life(result.study, result=result), 1)
    return {
        "life_km": place.km,
        "life_log10_km": float(np.log10(place.km)),
        "life_region": place.region,
        "life_s_m": place.s,
        "life_place_degC": place.temperature,
        "life_peak_J_m3": place.peak,
    }


@answer(lambda _: [TIME_TO])
def time_to_limit(result: FinishedRun, time_to: float | None) -> Answers:
    """Time at which the hottest node first reaches a temperature, s, linear between readings; NaN: not reached."""
    if time_to is None:
        return {}
    highest = result.highest
    above = np.flatnonzero(highest >= time_to)
    if not len(above):
        return {TIME_TO: float("nan")}
    i, times = int(above[0]), result.times
    if i == 0:
        return {TIME_TO: float(times[0])}
    part = (time_to - highest[i - 1]) / (highest[i] - highest[i - 1])
    return {TIME_TO: float(times[i - 1] + part * (times[i] - times[i - 1]))}
