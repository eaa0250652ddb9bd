"""Sources of heat of unknown origin: where they are, with which sign, and when they act; all by evidence."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.diagnose.fitting.materiality import Movement
from tyrefem.diagnose.heat.courses import CONSTANT, CORRELATED, FREE, PHASE, Course, CourseGrid, constant, courses, free
from tyrefem.diagnose.heat.evidence import HeatData, ProjectedData, log_mean_exp, mean_time, shares
from tyrefem.diagnose.unknowns.heat_patches import ALL_LAYERS

Array = NDArray[np.float64]
#: A place or a course is stated if its probability is at least this.
STATED = 0.9
#: An amount is stated if it differs from zero by more than this many standard deviations.
CLEAR = 2.0
#: The strength of a free course is clear at a time beyond this many: two, shared by some 75 knots (estimate).
CLEAR_AT_A_TIME = 3.5
#: Sizes of a source, over its prior sd, that are equally probable where places are compared.
SIZES = (1.0, 3.0, 10.0)
#: A course whose response differs by less than this share from that of a constant source is no course of its kind.
SAME = 0.02


@dataclass(frozen=True, eq=False)
class Place(Brief):
    """A possible place of a source: ``station`` (m) and ``where`` (see `heat_patches`), with the prior ``sd``.

    ``columns`` (n, n_all_knots): whitened response to a source of unit strength at every knot. ``inside``: heat in the
    rubber, W/m3; else flux through a surface, W/m2.
    """

    station: float
    where: str
    sd: float
    inside: bool
    columns: Array


@dataclass(frozen=True, eq=False)
class UnknownSource(Brief):
    """A source of missing heat (positive), or a place where cooling is missing (negative).

    Parameters
    ----------
    station, where, inside : most probable place. amount, sd : W/m3 or W/m2 at full strength, with the best course.
    at : (run, time s) of the amount, where a free course is clear then, but not its mean; None: no such time.
    stations, depths : probability by station (m), and by where at the station.
    kind, kinds : most probable course, and the probability of every course.
    time, time_sd : of the switch or of the ramp's begin, s; NaN for another course.
    strength, strength_sd : by run (n_knots,) W/m3 or W/m2 over time, for a free course.
    gain : ln evidence over the other sources alone, averaged over courses.
    move : largest change of a reading of the fitted runs by the source.
    """

    station: float
    where: str
    inside: bool
    amount: float
    sd: float
    stations: Mapping[float, float]
    depths: Mapping[str, float]
    kind: str
    kinds: Mapping[str, float]
    time: float
    time_sd: float
    strength: tuple[Array, ...]
    strength_sd: tuple[Array, ...]
    gain: float
    move: Movement | None = None
    at: tuple[str, float] | None = None

    @property
    def clear(self) -> bool:
        """Whether the amount differs from zero by more than two standard deviations."""
        return abs(self.amount) > CLEAR * self.sd


def pursuit(
    data: ProjectedData, places: Sequence[Place], grid: CourseGrid, most: int, least_gain: float
) -> list[tuple[Place, Course]]:
    """The sources that explain the data best, added one at a time while the evidence rises; at least one.

    Heat and sinks are equally probable. Every source is constant in time, or free, whichever has more evidence.
    """
    kinds = (constant(grid), *(free(grid, share * float(grid.ends.max())) for share in CORRELATED))
    chosen: list[tuple[Place, Course]] = []
    best = 0.0
    while len(chosen) < most:
        left = [place for place in places if all(place is not other for other, _ in chosen)]
        gains = [
            (evidence(data, [*chosen, (place, kind)]), number, which)
            for number, place in enumerate(left)
            for which, kind in enumerate(kinds)
        ]
        value, number, which = max(gains)
        if chosen and value < best + least_gain:
            break
        best = value
        chosen.append((left[number], kinds[which]))
    return chosen


def evidence(data: ProjectedData, sources: Sequence[tuple[Place, Course]]) -> float:
    """ln p(data | sources) - ln p(data | no heat)."""
    return _joint(data, sources).gain(np.eye(sum(course.factor.shape[1] for _, course in sources)))


def misfit(data: ProjectedData, sources: Sequence[tuple[Place, Course]]) -> float:
    """Misfit that the sources leave, at the best values of all unknowns."""
    return data.misfit - _joint(data, sources).explained(np.eye(sum(course.factor.shape[1] for _, course in sources)))


def _joint(data: ProjectedData, sources: Sequence[tuple[Place, Course]]) -> HeatData:
    """Statistics of the sources' coefficients, each of unit prior sd."""
    scaled = [(place, place.sd * course.factor) for place, course in sources]
    gram = [[left.T @ data.gram(place, other) @ right for other, right in scaled] for place, left in scaled]
    return HeatData(np.block(gram), np.concatenate([factor.T @ data.overlap(place) for place, factor in scaled]))


def place_shares(
    data: ProjectedData,
    options: Sequence[Place],
    others: Sequence[tuple[Place, Course]],
    grid: CourseGrid,
) -> dict[tuple[float, str], float]:
    """(station, where) -> probability of a source's place, averaged over a constant and free courses and over `SIZES`.

    Otherwise the prior's sizes of heat and flux, which have different units, would decide between inside and surface.

    At every station, half of the prior is for heat inside and half for the surfaces. Of the heat inside, half is for
    all layers together, and half is for single layers.
    """
    kinds = (constant(grid), *(free(grid, share * float(grid.ends.max())) for share in CORRELATED))
    logs: dict[tuple[float, str], float] = {}
    for place in options:
        beside = [option.inside for option in options if option.station == place.station]
        layers = sum(beside) - 1
        prior = 0.5 / (len(beside) - sum(beside)) if not place.inside else 0.5
        if place.inside and layers > 0:
            prior = 0.25 if place.where == ALL_LAYERS else 0.25 / layers
        logs[place.station, place.where] = math.log(prior) + log_mean_exp(
            [
                evidence(data, [*others, (place, replace(kind, factor=size * kind.factor))])
                for kind in kinds
                for size in SIZES
            ]
        )
    return shares(logs)


def timed(
    data: ProjectedData,
    place: Place,
    others: Sequence[tuple[Place, Course]],
    grid: CourseGrid,
    places: Mapping[tuple[float, str], float],
) -> tuple[UnknownSource, Course]:
    """A source with its course in time, beside other sources; ``places``: see `place_shares`."""
    base = evidence(data, others) if others else 0.0
    by_kind: dict[str, list[tuple[float, Course]]] = {}
    for course in told_courses(place, grid):
        by_kind.setdefault(course.kind, []).append((evidence(data, [*others, (place, course)]) - base, course))
    kinds = shares({kind: log_mean_exp([gain for gain, _ in tried]) for kind, tried in by_kind.items()})
    kind = next(iter(kinds))
    _, best = max(by_kind[kind], key=lambda entry: entry[0])
    gains, tried_courses = zip(*by_kind[kind], strict=True)
    time, time_sd = mean_time([course.time for course in tried_courses], np.array(gains))
    amount, sd = _amount(data, place, best, others)
    _, loosest = max(by_kind[FREE], key=lambda entry: entry[0])
    strength, strength_sd = _over_time(data, place, loosest, others, grid)
    at = None
    if kind == FREE and abs(amount) <= CLEAR * sd and (peak := _clearest(grid, strength, strength_sd)):
        amount, sd, at = peak
    stations: dict[float, float] = {}
    for (station, _), share in places.items():
        stations[station] = stations.get(station, 0.0) + share
    here = sum(share for (station, _), share in places.items() if station == place.station)
    depths = {where: share / here for (station, where), share in places.items() if station == place.station}
    gain = log_mean_exp([log_mean_exp([gain for gain, _ in tried]) for tried in by_kind.values()])
    source = UnknownSource(
        place.station, place.where, place.inside, amount, sd, stations, depths, kind, kinds, time, time_sd,
        strength, strength_sd, gain, at=at,
    )  # fmt: skip
    return source, best


@dataclass(frozen=True, eq=False)
class EstimatedSource(Brief):
    """A source of a known kind of course, of the best time if it switches.

    ``time``, ``time_sd``: mean and sd of its time, s; NaN without one. ``amount``, ``sd``: W/m3 or W/m2.
    """

    course: Course
    time: float
    time_sd: float
    amount: float
    sd: float

    @property
    def clear(self) -> bool:
        """Whether the amount differs from zero by more than two standard deviations."""
        return abs(self.amount) > CLEAR * self.sd


def estimated(
    data: ProjectedData, place: Place, course: Course, others: Sequence[tuple[Place, Course]], grid: CourseGrid
) -> EstimatedSource:
    """The amount of a source with a course of this kind, and its time if it switches, beside other sources."""
    if course.time is None:
        return EstimatedSource(course, math.nan, math.nan, *_amount(data, place, course, others))
    of_kind = [each for each in told_courses(place, grid) if each.kind == course.kind]
    gains = np.array([evidence(data, [*others, (place, each)]) for each in of_kind])
    best = of_kind[int(gains.argmax())]
    times = mean_time([each.time for each in of_kind], gains)
    return EstimatedSource(best, *times, *_amount(data, place, best, others))


def _clearest(
    grid: CourseGrid, strength: Sequence[Array], strength_sd: Sequence[Array]
) -> tuple[float, float, tuple[str, float]] | None:
    """Strength, sd, run and time (s) where a free course differs most from zero; None: nowhere clearly.

    Heat that acts in a part of one run has a mean over all runs near zero.
    """
    peaks = []
    for name, knots, means, spreads in zip(grid.names, grid.knots, strength, strength_sd, strict=True):
        ratios = np.abs(means) / np.maximum(spreads, 1e-300)
        n = int(np.argmax(ratios))
        peaks.append((float(ratios[n]), float(means[n]), float(spreads[n]), (name, float(knots[n]))))
    ratio, mean, sd, at = max(peaks)
    return (mean, sd, at) if ratio > CLEAR_AT_A_TIME else None


def told_courses(place: Place, grid: CourseGrid) -> Iterator[Course]:
    """The courses that readings can tell from a constant source at a place, and the constant one.

    Heat while the tyre rolls that ends after the last rolling, say, is constant heat.
    """
    plain = place.columns @ constant(grid).strength
    rolling = grid.rolling_phases if place.inside else ()
    for course in courses(grid):
        # Heat in the only phase that rolls is constant heat.
        phase = place.inside and course.kind.startswith(PHASE)
        if phase and (len(rolling) < 2 or course.kind.removeprefix(PHASE) not in rolling):
            continue
        if course.strength.size and course.kind != CONSTANT:
            response = place.columns @ course.strength
            if min(np.linalg.norm(response), np.linalg.norm(response - plain)) < SAME * np.linalg.norm(plain):
                continue
        yield course


def _amount(
    data: ProjectedData, place: Place, course: Course, others: Sequence[tuple[Place, Course]]
) -> tuple[float, float]:
    """Amount at full strength, mean over the runs, and its standard deviation; of a free course the mean over time."""
    statistics = _joint(data, [(place, course), *others])
    count = course.factor.shape[1]
    total = sum(other.factor.shape[1] for _, other in others) + count
    mean, covariance = statistics.posterior(np.eye(total))
    if course.strength.size:
        # The coefficients are the strength of all runs, and the runs' deviations from it.
        share = course.factor.T @ course.strength / (course.strength @ course.strength)
    else:
        share = course.factor.mean(axis=0)
    share = share * place.sd
    return float(share @ mean[:count]), float(np.sqrt(share @ covariance[:count, :count] @ share))


def _over_time(
    data: ProjectedData, place: Place, course: Course, others: Sequence[tuple[Place, Course]], grid: CourseGrid
) -> tuple[tuple[Array, ...], tuple[Array, ...]]:
    """By run (n_knots,): strength over time and its standard deviation."""
    statistics = _joint(data, [(place, course), *others])
    count = course.factor.shape[1]
    mean, covariance = statistics.posterior(np.eye(len(statistics.overlap)))
    factor = place.sd * course.factor
    strength = factor @ mean[:count]
    sd = np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", factor, covariance[:count, :count], factor), 0.0))
    return tuple(strength[part] for part in grid.parts()), tuple(sd[part] for part in grid.parts())
