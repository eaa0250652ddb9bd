"""What is asked of every variant: numbers of a finished run, one short function each.

A new answer is one more function with `answer` above it, which says beforehand how its answers are called.

What an answer may ask of a run: a full one's `Result` has it, and so has a variant of a reduced model.
"""

from __future__ import annotations

import fnmatch
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from tyrefem.boundaries.rim import LumpedRim
from tyrefem.errors import InputError, nearest
from tyrefem.inputs.drive import slides
from tyrefem.simulation.surroundings import GAS, RIM

if TYPE_CHECKING:
    from tyrefem.conduction.field import Peak
    from tyrefem.inputs.study import StudyData
    from tyrefem.simulation.heat_budget import HeatBudget
    from tyrefem.simulation.rolling_resistance import RollingResistance
    from tyrefem.simulation.rolling_tyre import RollingTyre

Answers = dict[str, Any]


#: Present only where a temperature to be reached was given.
TIME_TO = "time_to_limit_s"


#: Stands for a time that was never reached, s: later than any.
NEVER = 1e9
Function = Callable[["FinishedRun", float | None], Answers]


#: Names of a function's answers for a study; ``*`` stands for any name.
Names = Callable[["StudyData"], list[str]]
_FUNCTIONS: list[tuple[Function, Names]] = []


def answer(names: Names) -> Callable[[Function], Function]:
    """Add a function to what every variant is asked; ``names``: of its answers, before anything has run."""

    def add(function: Function) -> Function:
        _FUNCTIONS.append((function, names))
        return function

    return add


def answers(result: FinishedRun, time_to: float | None = None) -> Answers:
    """Every answer of a run by name, the unit at its end; SI units and degC.

    Parameters
    ----------
    time_to : temperature, degC, whose first reaching anywhere in the tyre is asked for.
    """
    values: Answers = {}
    for function, _ in _FUNCTIONS:
        values |= function(result, time_to)
    return values


def answer_names(study: StudyData, time_to: float | None = None) -> list[str]:
    """Names of the numbers that `answers` will give of a study, without running it.

    >>> import tyrefem
    >>> answer_names(tyrefem.study("nasa-22x5.5-8pr"))[:3]
    ['hottest_degC', 'hottest_s_m', 'hottest_depth_m']
    """
    all_names = [name for _, names in _FUNCTIONS for name in names(study)]
    return all_names if time_to is not None else [name for name in all_names if name != TIME_TO]


def check_answer(name: str, study: StudyData, time_to: float | None = None) -> None:
    """Raise `InputError`, with the nearest name, for an answer that a study has not."""
    known = answer_names(study, time_to)
    if not any(fnmatch.fnmatchcase(name, pattern) for pattern in known):
        hint = "; it needs a temperature to be reached: 'time_to'" if name == TIME_TO else nearest(name, known)
        raise InputError(f"no answer '{name}'{hint}")


@answer(
    lambda study: [
        *("hottest_degC", "hottest_s_m", "hottest_depth_m", "hottest_time_s"),
        *(f"{region}_max_degC" for region in study.section.regions),
    ]
)
def hottest(result: FinishedRun, _: float | None) -> Answers:
    """Highest temperature over the run, its place and time; per region."""
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


@answer(lambda study: [f"{name}{end}" for end in ("_degC", "_max_degC") for name in study.sensors])
def sensors(result: FinishedRun, _: float | None) -> Answers:
    """Every sensor at the end and at its highest."""
    read = result.recorded
    return {f"{name}_degC": float(series[-1]) for name, series in read.items()} | {
        f"{name}_max_degC": float(series.max()) for name, series in read.items()
    }


@answer(
    lambda study: [
        *(f"{GAS}_degC", "gas_pressure_Pa"),
        *([f"{RIM}_degC"] if isinstance(study.card.boundaries.rim, LumpedRim) else []),
    ]
)
def gas(result: FinishedRun, _: float | None) -> Answers:
    """Contained air at the end; a lumped rim."""
    values = {
        f"{GAS}_degC": float(result.gas_temperature[-1]),
        "gas_pressure_Pa": result.pressure_at(len(result.times) - 1),
    }
    rim = result.rim_temperature
    return values if rim is None else values | {f"{RIM}_degC": float(rim[-1])}


@answer(lambda _: ["gradient_K_m", "gradient_s_m"])
def gradient(result: FinishedRun, _: float | None) -> Answers:
    """Steepest mean gradient from the inner to the outer surface at the end, K/m, and where."""
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
        # Slip and effects lose heat in ways of their own.
        *(["lost_*_share"] if study.effects or any(map(slides, study.card.drive.phases)) else []),
        "heat_J",
    ]
)
def shares(result: FinishedRun, _: float | None) -> Answers:
    """Parts of the heat budget over all heat that came into the rubber."""
    budget = result.end_budget
    made = budget.made
    values = {
        f"{kind}_{name}_share": float(series[-1]) / made if made > 0 else float("nan")
        for (kind, name), series in budget.energies.items()
        if kind in ("lost", "stored")
    }
    return values | {"heat_J": made}


@answer(lambda _: ["mass_kg"])
def mass(result: FinishedRun, _: float | None) -> Answers:
    """Mass of the whole tyre, kg."""
    from tyrefem.materials.cord_layers import masses

    study = result.study
    return {"mass_kg": float(sum(masses(study.section, study.materials).values()))}


@answer(lambda _: ["load_N", "deflection_m"])
def drive(result: FinishedRun, _: float | None) -> Answers:
    """Load and deflection of the last phase."""
    schedule, end = result.tyre.schedule, result.tyre.drive.end * (1 - 1e-12)
    return {
        "load_N": schedule.mean(lambda case: case.load, end),
        "deflection_m": schedule.mean(lambda case: case.deflection, end),
    }


@answer(lambda _: [TIME_TO])
def time_to_limit(result: FinishedRun, time_to: float | None) -> Answers:
    """When the hottest node first reaches a temperature, s; NaN: not within the drive. Linear between readings."""
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


Array = NDArray[np.float64]


class FinishedRun(Protocol):
    """A finished run, as far as answers look at it. An answer that needs more takes it from the whole `Result`, which
    a reduced variant makes when it is first asked for: right, but slower."""

    @property
    def study(self) -> StudyData:
        """What was run."""
        ...

    @property
    def tyre(self) -> RollingTyre:
        """Its drive, load cases and materials."""
        ...

    @property
    def times(self) -> Array:
        """Times of the readings, (n,) s."""
        ...

    @property
    def peaks(self) -> Mapping[str, Peak]:
        """Highest temperature of the ``tyre`` and of every region over the run."""
        ...

    def place_of(self, peak: Peak) -> tuple[float, float]:
        """(s, depth) of a peak, m."""
        ...

    @property
    def recorded(self) -> Mapping[str, Array]:
        """Sensor -> what the logger recorded, (n,) degC."""
        ...

    @property
    def gas_temperature(self) -> Array:
        """Contained air, (n,) degC."""
        ...

    @property
    def rim_temperature(self) -> Array | None:
        """A lumped rim, (n,) degC; None: not lumped."""
        ...

    def pressure_at(self, i: int) -> float:
        """Gauge pressure of the contained air at ``times[i]``, Pa."""
        ...

    @property
    def wall_gradient(self) -> tuple[Array, Array]:
        """s (k,) m along the meridian, and |T inner - T outer| / thickness there at the end, K/m."""
        ...

    @property
    def rolling_resistance(self) -> RollingResistance:
        """Force and coefficient."""
        ...

    @property
    def end_budget(self) -> HeatBudget:
        """Heat budget at the end; its series have one time at least, the last being the end."""
        ...

    @property
    def highest(self) -> Array:
        """Hottest node over time, (n,) degC."""
        ...
