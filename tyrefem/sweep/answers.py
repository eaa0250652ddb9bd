"""What is asked of every variant: numbers of a finished run, one short function each.

A new answer is one more function with `answer` above it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.result import GAS, RIM

if TYPE_CHECKING:
    from tyrefem.result import Result

Answers = dict[str, Any]
_FUNCTIONS: list[Callable[[Result, float | None], Answers]] = []


def answer(function: Callable[[Result, float | None], Answers]) -> Callable[[Result, float | None], Answers]:
    """Add a function to what every variant is asked."""
    _FUNCTIONS.append(function)
    return function


def answers(result: Result, time_to: float | None = None) -> Answers:
    """Every answer of a run by name, the unit at its end; SI units and degC.

    Parameters
    ----------
    time_to : temperature, degC, whose first reaching anywhere in the tyre is asked for.
    """
    found: Answers = {}
    for function in _FUNCTIONS:
        found |= function(result, time_to)
    return found


@answer
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


@answer
def sensors(result: Result, _: float | None) -> Answers:
    """Every sensor at the end and at its highest."""
    readings = result.readings
    names = [name for name in readings.columns if name not in ("time_s", GAS, RIM)]
    return {f"{name}_degC": float(readings[name].iloc[-1]) for name in names} | {
        f"{name}_max_degC": float(readings[name].max()) for name in names
    }


@answer
def gas(result: Result, _: float | None) -> Answers:
    """Contained air at the end; a lumped rim."""
    found = {
        f"{GAS}_degC": float(result.gas_temperature[-1]),
        "gas_pressure_Pa": float(result.gas_pressure[-1]),
    }
    return found | ({f"{RIM}_degC": float(result.readings[RIM].iloc[-1])} if RIM in result.readings else {})


@answer
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


@answer
def resistance(result: Result, _: float | None) -> Answers:
    """Rolling resistance of hysteresis, warm and cold."""
    found = result.rolling_resistance
    return {
        "rolling_resistance_N": found.force,
        "rolling_resistance_coefficient": found.coefficient,
        "rolling_resistance_coefficient_cold": found.cold_coefficient,
    }


@answer
def shares(result: Result, _: float | None) -> Answers:
    """Parts of the heat budget over all heat that came into the rubber."""
    table = result.heat_budget.table
    chosen = table[table["kind"].isin(["lost", "stored"])]
    found = {
        f"{row.kind}_{row.name_}_share": float(row.share)
        for row in chosen.rename(columns={"name": "name_"}).itertuples()
    }
    return found | {"heat_J": result.heat_budget.made}


@answer
def mass(result: Result, _: float | None) -> Answers:
    """Mass of the whole tyre, kg."""
    from tyrefem.construction import masses

    study = result.study
    return {"mass_kg": float(sum(masses(study.section, study.materials).values()))}


@answer
def drive(result: Result, _: float | None) -> Answers:
    """Load and deflection of the last phase."""
    phase = result.phases[-1]
    return {"load_N": phase.load, "deflection_m": phase.deflection}


@answer
def time_to_limit(result: Result, time_to: float | None) -> Answers:
    """When the hottest node first reaches a temperature, s; NaN: not within the drive. Linear between readings."""
    if time_to is None:
        return {}
    highest = np.asarray(result.history.values).max(axis=1)
    above = np.flatnonzero(highest >= time_to)
    if not len(above):
        return {"time_to_limit_s": float("nan")}
    i, times = int(above[0]), result.times
    if i == 0:
        return {"time_to_limit_s": float(times[0])}
    part = (time_to - highest[i - 1]) / (highest[i] - highest[i - 1])
    return {"time_to_limit_s": float(times[i - 1] + part * (times[i] - times[i - 1]))}
