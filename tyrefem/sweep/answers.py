"""What is asked of every variant: numbers of a finished run, one short function each.

A new answer is one more function with `answer` above it, which says beforehand how its answers are called.
"""

from __future__ import annotations

import fnmatch
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.boundaries.rim import Lumped
from tyrefem.errors import InputError, nearest
from tyrefem.result import GAS, RIM
from tyrefem.slip import slides

if TYPE_CHECKING:
    from tyrefem.result import Result
    from tyrefem.studies import Study

Answers = dict[str, Any]
#: Present only where a temperature to be reached was given.
TIME_TO = "time_to_limit_s"
Function = Callable[["Result", float | None], Answers]
#: Names of a function's answers for a study; ``*`` stands for any name.
Names = Callable[["Study"], list[str]]
_FUNCTIONS: list[tuple[Function, Names]] = []


def answer(names: Names) -> Callable[[Function], Function]:
    """Add a function to what every variant is asked; ``names``: of its answers, before anything has run."""

    def add(function: Function) -> Function:
        _FUNCTIONS.append((function, names))
        return function

    return add


def answers(result: Result, time_to: float | None = None) -> Answers:
    """Every answer of a run by name, the unit at its end; SI units and degC.

    Parameters
    ----------
    time_to : temperature, degC, whose first reaching anywhere in the tyre is asked for.
    """
    found: Answers = {}
    for function, _ in _FUNCTIONS:
        found |= function(result, time_to)
    return found


def answer_names(study: Study, time_to: float | None = None) -> list[str]:
    """Names of the numbers that `answers` will give of a study, without running it.

    >>> import tyrefem
    >>> answer_names(tyrefem.study("nasa-22x5.5-8pr"))[:3]
    ['hottest_degC', 'hottest_s_m', 'hottest_depth_m']
    """
    found = [name for _, names in _FUNCTIONS for name in names(study)]
    return found if time_to is not None else [name for name in found if name != TIME_TO]


def check_answer(name: str, study: Study, time_to: float | None = None) -> None:
    """Raise `InputError`, with the nearest name, for an answer that a study has not."""
    known = answer_names(study, time_to)
    if not any(fnmatch.fnmatchcase(name, one) for one in known):
        hint = "; it needs a temperature to be reached: 'time_to'" if name == TIME_TO else nearest(name, known)
        raise InputError(f"no answer '{name}'{hint}")


@answer(
    lambda study: [
        *("hottest_degC", "hottest_s_m", "hottest_depth_m", "hottest_time_s"),
        *(f"{region}_max_degC" for region in study.section.regions),
    ]
)
def hottest(result: Result, _: float | None) -> Answers:
    """Highest temperature over the run, its place and time; per region."""
    peaks = result.history.region_maximum
    peak, place = result.history.maximum, result.extremes.iloc[0]
    return {
        "hottest_degC": float(peak.temperature),
        "hottest_region": max(peaks, key=lambda region: peaks[region].temperature),
        "hottest_s_m": float(place.s_m),
        "hottest_depth_m": float(place.depth_m),
        "hottest_time_s": float(peak.time),
        **{f"{region}_max_degC": float(one.temperature) for region, one in peaks.items()},
    }


@answer(lambda study: [f"{name}{end}" for end in ("_degC", "_max_degC") for name in study.sensors])
def sensors(result: Result, _: float | None) -> Answers:
    """Every sensor at the end and at its highest."""
    readings = result.readings
    names = [name for name in readings.columns if name not in ("time_s", GAS, RIM)]
    return {f"{name}_degC": float(readings[name].iloc[-1]) for name in names} | {
        f"{name}_max_degC": float(readings[name].max()) for name in names
    }


@answer(
    lambda study: [
        *(f"{GAS}_degC", "gas_pressure_Pa"),
        *([f"{RIM}_degC"] if isinstance(study.card.boundaries.rim, Lumped) else []),
    ]
)
def gas(result: Result, _: float | None) -> Answers:
    """Contained air at the end; a lumped rim."""
    found = {
        f"{GAS}_degC": float(result.gas_temperature[-1]),
        "gas_pressure_Pa": float(result.gas_pressure[-1]),
    }
    return found | ({f"{RIM}_degC": float(result.readings[RIM].iloc[-1])} if RIM in result.readings else {})


@answer(lambda _: ["gradient_K_m", "gradient_s_m"])
def gradient(result: Result, _: float | None) -> Answers:
    """Steepest mean gradient from the inner to the outer surface at the end, K/m, and where."""
    section = result.study.section
    lowest = 0.0 if section.half else -section.line.length
    s = np.linspace(lowest, section.line.length, 41)[1:-1]
    thickness = section.total_thickness(s)
    ends = [result._inside(section.place(s, depth)) for depth in (np.zeros_like(s), thickness)]
    field = result.history.field(len(result.times) - 1)
    inner, outer = (np.asarray(field.at(points)) for points in ends)
    steep = np.abs(inner - outer) / thickness
    i = int(np.argmax(steep))
    return {"gradient_K_m": float(steep[i]), "gradient_s_m": float(s[i])}


@answer(
    lambda _: [f"rolling_resistance_{end}" for end in ("N", "coefficient", "coefficient_cold")],
)
def resistance(result: Result, _: float | None) -> Answers:
    """Rolling resistance of hysteresis, warm and cold."""
    found = result.rolling_resistance
    return {
        "rolling_resistance_N": found.force,
        "rolling_resistance_coefficient": found.coefficient,
        "rolling_resistance_coefficient_cold": found.cold_coefficient,
    }


@answer(
    lambda study: [
        *(f"stored_{region}_share" for region in study.section.regions),
        *(f"lost_{name}_share" for name in ("road contact", "air at the tread", "outside air", "contained air", "rim")),
        # Slip and effects lose heat in ways of their own.
        *(["lost_*_share"] if study.effects or any(map(slides, study.card.drive.phases)) else []),
        "heat_J",
    ]
)
def shares(result: Result, _: float | None) -> Answers:
    """Parts of the heat budget over all heat that came into the rubber."""
    table = result.heat_budget.table
    chosen = table[table["kind"].isin(["lost", "stored"])]
    found = {f"{row['kind']}_{row['name']}_share": float(row["share"]) for row in chosen.to_dict("records")}
    return found | {"heat_J": result.heat_budget.made}


@answer(lambda _: ["mass_kg"])
def mass(result: Result, _: float | None) -> Answers:
    """Mass of the whole tyre, kg."""
    from tyrefem.construction import masses

    study = result.study
    return {"mass_kg": float(sum(masses(study.section, study.materials).values()))}


@answer(lambda _: ["load_N", "deflection_m"])
def drive(result: Result, _: float | None) -> Answers:
    """Load and deflection of the last phase."""
    phase = result.phases[-1]
    return {"load_N": phase.load, "deflection_m": phase.deflection}


@answer(lambda _: [TIME_TO])
def time_to_limit(result: Result, time_to: float | None) -> Answers:
    """When the hottest node first reaches a temperature, s; NaN: not within the drive. Linear between readings."""
    if time_to is None:
        return {}
    highest = np.asarray(result.history.values).max(axis=1)
    above = np.flatnonzero(highest >= time_to)
    if not len(above):
        return {TIME_TO: float("nan")}
    i, times = int(above[0]), result.times
    if i == 0:
        return {TIME_TO: float(times[0])}
    part = (time_to - highest[i - 1]) / (highest[i] - highest[i - 1])
    return {TIME_TO: float(times[i - 1] + part * (times[i] - times[i - 1]))}
