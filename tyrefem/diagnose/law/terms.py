"""Terms of a law of missing heat: powers of speed, load, pressure and deflection, temperature laws, switches."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.diagnose.heat.courses import BEGINS, ENDS, PHASE, RUN, CourseGrid

Array = NDArray[np.float64]
#: Names of the terms. `WARM`: exp(rate (T - reference)). `ABOVE`: power of the temperature above the ambient.
SPEED, LOAD, PRESSURE, DEFLECTION = "speed", "load", "pressure", "deflection"
WARM, ABOVE = "temperature", "temperature above ambient"
MECHANICAL = (LOAD, PRESSURE, DEFLECTION)
#: Terms that are never together: deflection follows from load and pressure.
SETS_OF_MECHANICAL = ((), (LOAD,), (PRESSURE,), (DEFLECTION,), (LOAD, PRESSURE))
#: Prior mean and sd of the exponents (of the temperature's rate: 1/K), all estimates. Heat inside is work per
#: revolution times revolutions per second, work the square of a strain; loss laws have rates of 0.01 to 0.02 1/K.
OF_HEAT: Mapping[str, tuple[float, float]] = {
    SPEED: (1.0, 1.0), LOAD: (1.0, 1.5), PRESSURE: (0.0, 1.5), DEFLECTION: (2.0, 1.5), WARM: (0.0, 0.02),
    ABOVE: (0.0, 1.0),
}  # fmt: skip
#: The same for a flux through a surface, and for a share of a film or of the model's own heat.
OF_SHARE: Mapping[str, tuple[float, float]] = {
    SPEED: (0.0, 1.0), LOAD: (0.0, 1.5), PRESSURE: (0.0, 1.5), DEFLECTION: (0.0, 1.5), WARM: (0.0, 0.02),
    ABOVE: (0.0, 1.0),
}  # fmt: skip
#: Prior probability that speed takes part in heat inside, and in a flux or share; that temperature takes part.
SPEED_IN_HEAT, SPEED_IN_SHARE, TEMPERATURE_IN = 0.8, 0.4, 0.3
#: Prior probabilities of the mechanical variables, in the order of `SETS_OF_MECHANICAL`; for heat, and for the others.
MECHANICAL_IN_HEAT, MECHANICAL_IN_SHARE = (0.3, 0.2, 0.05, 0.35, 0.1), (0.6, 0.1, 0.1, 0.15, 0.05)
#: Walking pace, m/s: below it a power of speed is held. Least temperature above the ambient in a power of it, K.
SLOWEST, LEAST_ABOVE = 1.0, 1.0
#: A variable hardly varies if its largest value is less than this above its smallest (ln, or K for temperature).
HARDLY, HARDLY_WARMER = 0.05, 3.0
#: Two variables vary together if their logarithms correlate by more than this.
TOGETHER = 0.95
#: Fine times per interval between two knots, and number of times at which a switch is tried.
FINE, TIMES = 12, 120
NO_SWITCH, ROLLING, REST = "no switch", "while rolling", "at rest"


@dataclass(frozen=True, eq=False)
class DriveVariables(Brief):
    """What varies over the fitted runs, at fine times; every array is (n,) over all runs, one after another.

    Parameters
    ----------
    grid : the runs with their knots. times : s. run : number of the run among the grid's.
    speed : m/s. load : N. pressure : Pa. deflection : m. ambient : degC.
    """

    grid: CourseGrid
    times: Array
    run: NDArray[np.intp]
    speed: Array
    load: Array
    pressure: Array
    deflection: Array
    ambient: Array

    @cached_property
    def rolling(self) -> NDArray[np.bool_]:
        """Where the tyre rolls."""
        return np.asarray(self.speed > 0)

    @cached_property
    def hats(self) -> Array:
        """(n_all_knots, n): means over the hat function of every knot, as of `CourseGrid.sampled`."""
        matrix = np.zeros((self.grid.size, len(self.times)))
        for number, (part, knots) in enumerate(zip(self.grid.parts(), self.grid.knots, strict=True)):
            here = np.flatnonzero(self.run == number)
            rows = np.array([np.interp(self.times[here], knots, hat) for hat in np.eye(len(knots))])
            matrix[part, here[0] : here[-1] + 1] = rows / rows.sum(axis=1, keepdims=True)
        return matrix


def fine_times(grid: CourseGrid) -> list[Array]:
    """By run: times at which a law is evaluated, s."""
    return [np.linspace(knots[0], knots[-1], FINE * (len(knots) - 1) + 1) for knots in grid.knots]


def drive_variables(grid: CourseGrid, by_run: Sequence[Array]) -> DriveVariables:
    """The variables from (5, n) arrays of every run at `fine_times`: speed, load, pressure, deflection, ambient."""
    times = fine_times(grid)
    run = np.concatenate([np.full(len(each), number) for number, each in enumerate(times)])
    return DriveVariables(grid, np.concatenate(times), run, *np.hstack(list(by_run)))


@dataclass(frozen=True, eq=False)
class LawTerms(Brief):
    """The terms that a law at one place may have, as logarithms: the law is exp(sum of exponent x term) x switch.

    Parameters
    ----------
    features : term -> (n,) ln(variable / reference), or T - reference (K) for `WARM`.
    references : term -> reference (SI, degC): the mean (of the logarithm) while the tyre rolls.
    hardly : variables that hardly vary. together : pairs of variables that vary together. of_heat : heat inside, W/m3.
    """

    features: Mapping[str, Array]
    references: Mapping[str, float]
    hardly: tuple[str, ...]
    together: tuple[tuple[str, str], ...]
    of_heat: bool = True

    def prior(self, name: str) -> tuple[float, float]:
        """Prior mean and sd of a term's exponent."""
        return (OF_HEAT if self.of_heat else OF_SHARE)[name]


def law_terms(variables: DriveVariables, temperature: Array | None = None, *, of_heat: bool = True) -> LawTerms:
    """The terms that these runs can show.

    ``temperature`` (n,) degC at the place, None: no temperature law there. ``of_heat``: heat inside, W/m3.
    """
    rolling = variables.rolling if variables.rolling.any() else np.ones(len(variables.times), dtype=bool)
    values = {SPEED: np.maximum(variables.speed, SLOWEST)}
    values |= {name: np.maximum(getattr(variables, name), 1e-12) for name in MECHANICAL}
    features, references, hardly = {}, {}, []
    for name, value in values.items():
        logarithm = np.log(value)
        references[name] = float(np.exp(logarithm[rolling].mean()))
        if np.ptp(logarithm[rolling]) < HARDLY:
            hardly.append(name)
        else:
            features[name] = logarithm - np.log(references[name])
    if temperature is not None:
        references[WARM] = float(temperature[rolling].mean())
        above = np.log(np.maximum(temperature - variables.ambient, LEAST_ABOVE))
        references[ABOVE] = float(np.exp(above[rolling].mean()))
        if np.ptp(temperature[rolling]) < HARDLY_WARMER:
            hardly.append(WARM)
        else:
            features |= {WARM: temperature - references[WARM], ABOVE: above - np.log(references[ABOVE])}
    names = [name for name in features if name not in (WARM, ABOVE)]
    together = tuple(
        (first, second)
        for number, first in enumerate(names)
        for second in names[number + 1 :]
        if abs(np.corrcoef(features[first][rolling], features[second][rolling])[0, 1]) > TOGETHER
    )
    return LawTerms(features, references, tuple(hardly), together, of_heat)


def structures(terms: LawTerms) -> dict[tuple[str, ...], float]:
    """Sets of terms -> prior probability, shared by those that these runs can show."""
    known = terms.features
    speed = SPEED_IN_HEAT if terms.of_heat else SPEED_IN_SHARE
    speeds = {(): 1 - speed} | ({(SPEED,): speed} if SPEED in known else {})
    weights = MECHANICAL_IN_HEAT if terms.of_heat else MECHANICAL_IN_SHARE
    mechanical = {
        names: weight
        for names, weight in zip(SETS_OF_MECHANICAL, weights, strict=True)
        if all(name in known for name in names)
    }
    temperatures = [name for name in (WARM, ABOVE) if name in known]
    warm = {(): 1 - TEMPERATURE_IN} | {(name,): TEMPERATURE_IN / len(temperatures) for name in temperatures}
    total = sum(speeds.values()) * sum(mechanical.values()) * sum(warm.values())
    return {
        (*first, *second, *third): speeds[first] * mechanical[second] * warm[third] / total
        for first in speeds
        for second in mechanical
        for third in warm
    }


@dataclass(frozen=True, eq=False)
class Switch(Brief):
    """When a law acts: ``kind`` (a course's name of `heat.courses`, or one of this module), ``time`` s, ``on`` (n,)."""

    kind: str
    on: Array
    time: float | None = None


def switches(variables: DriveVariables, *, inside: bool) -> list[Switch]:
    """The switches that a law may have; heat ``inside`` acts while the tyre rolls only."""
    grid, t, count = variables.grid, variables.times, len(variables.times)
    rolls = variables.rolling.astype(float)
    result = [Switch(NO_SWITCH, np.ones(count))]
    if not inside and 0 < rolls.sum() < count:
        result += [Switch(ROLLING, rolls), Switch(REST, 1 - rolls)]
    longest = float(grid.ends.max())
    times = np.linspace(0.0, longest, TIMES + 1)[3:-3]
    result += [Switch(BEGINS, (t >= time).astype(float), float(time)) for time in times]
    result += [Switch(ENDS, (t < time).astype(float), float(time)) for time in times]
    names = dict.fromkeys(name for phases in grid.phases for name, _, _ in phases)
    phases = [name for name in names if not inside or name in grid.rolling_phases]
    for name in phases if len(phases) > 1 else ():
        result.append(Switch(PHASE + name, _in_phase(variables, name)))
    if len(grid.names) > 1:
        for number, name in enumerate(grid.names):
            of_run = (variables.run == number).astype(float)
            result.append(Switch(RUN + name, of_run))
            begun = [time for time in times if time < 0.95 * grid.ends[number]]
            result += [Switch(f"{RUN}{name} {BEGINS}", of_run * (t >= time), float(time)) for time in begun]
    return result


def _in_phase(variables: DriveVariables, name: str) -> Array:
    on = np.zeros(len(variables.times))
    for number, phases in enumerate(variables.grid.phases):
        for phase, start, end in phases:
            if phase == name:
                on[(variables.run == number) & (variables.times >= start) & (variables.times < end)] = 1.0
    return on
