"""Times and amounts of sources of unknown origin in a linear model about the point where they act.

Base numbers and sensors change the response to a source, too: a late sensor shows it late, one nearer to it more, and
a film weaker than stated lets it warm the tyre more. A model about a point without sources leaves that out: it tells
their times too surely, and their amounts wrongly.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.diagnose.data.residuals import Residuals
from tyrefem.diagnose.forward.evaluations import Evaluations
from tyrefem.diagnose.heat.courses import BEGINS, ENDS, GROWS, PHASE, Course, CourseGrid
from tyrefem.diagnose.heat.evidence import ProjectedData
from tyrefem.diagnose.heat.over_time import HeatOverTime
from tyrefem.diagnose.heat.sources import EstimatedSource, Place, UnknownSource, estimated, misfit
from tyrefem.diagnose.heat.values import WRITTEN, source_unknown, values_with_sources
from tyrefem.diagnose.inference.evidence import posterior
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns.heat_patches import at_times, written_times
from tyrefem.diagnose.unknowns.unknown import Unknown
from tyrefem.inputs.study import StudyData

Array = NDArray[np.float64]
Estimate = TypeVar("Estimate")
#: Most linear models about points where sources act. The last one is that about a point where the misfit is above that
#: of the linear model before by no more than this share.
ROUNDS, NEAR = 6, 0.002


def repeated(first: Estimate, again: Callable[[Estimate], tuple[Estimate, float, float] | None]) -> Estimate:
    """An estimate made again about its own point, until linear model and simulation agree there.

    ``again``: estimate -> estimate about its point, misfit there, and misfit of the linear model there; None if no tyre
    is possible there. Of all estimates made again that about the point of the smallest misfit counts.
    """
    current, tried = first, list[tuple[float, Estimate]]()
    for _ in range(ROUNDS):
        if (made := again(current)) is None:
            break
        current, left, promised = made
        tried.append((left, current))
        if left < (1 + NEAR) * promised:
            break
    return min(tried, key=lambda each: each[0])[1] if tried else first


@dataclass(frozen=True)
class ActingSource:
    """A source as a study file can state it in one run: a strength from ``begins`` to ``ends``, s."""

    strength: float
    begins: float = -math.inf
    ends: float = math.inf

    def course(self, t: Array) -> Array:
        """Strength at times t, s."""
        return np.asarray(self.strength * ((t >= self.begins) & (t < self.ends)))

    def unknown(self, patch: Unknown) -> Unknown:
        """The patch with these times."""
        begins, ends = (time if 0 < time < math.inf else None for time in (self.begins, self.ends))
        return at_times(patch, written_times(begins, ends))


@dataclass(frozen=True, eq=False)
class ActingPoint(Brief):
    """Best values of base numbers and sensors ``x`` (k,), and by source, by run of the grid: how it acts.

    ``misfit``: what the linear model leaves there.
    """

    x: Array
    sources: tuple[tuple[ActingSource, ...], ...]
    misfit: float


def best_point(
    data: ProjectedData, low: Array, high: Array, entries: Sequence[tuple[Place, Course]], grid: CourseGrid
) -> ActingPoint:
    """Base numbers and sensors within ``low`` and ``high`` (k,), and sources, where the linear model is best."""
    factors = [place.sd * course.factor for place, course in entries]
    columns = [place.columns @ factor for (place, _), factor in zip(entries, factors, strict=True)]
    J, k = np.column_stack([data.jacobian, *columns]) * math.sqrt(data.weight), len(low)
    d = data.data * math.sqrt(data.weight)
    free, sd = np.full(J.shape[1] - k, np.inf), np.concatenate([data.sd, np.ones(J.shape[1] - k)])
    mean = posterior(J.T @ J, J.T @ d, sd, np.concatenate([low, -free]), np.concatenate([high, free])).mean
    parts = np.split(mean[k:], np.cumsum([factor.shape[1] for factor in factors])[:-1])
    sources = tuple(
        _acting(factor @ part, *entry, grid) for factor, part, entry in zip(factors, parts, entries, strict=True)
    )
    return ActingPoint(mean[:k], sources, float(np.sum((d - J @ mean) ** 2)))


def _acting(strength: Array, place: Place, course: Course, grid: CourseGrid) -> tuple[ActingSource, ...]:
    """By run: the mean strength of a source at the knots at which it acts."""
    result = []
    for run, (part, knots) in enumerate(zip(grid.parts(), grid.knots, strict=True)):
        begins, ends = _times(course, grid, run)
        on = (knots >= begins) & (knots < ends)
        if place.inside:
            on &= np.array([grid.speed(run, float(t)) > 0 for t in knots])
        result.append(ActingSource(float(strength[part][on].mean()) if on.any() else 0.0, begins, ends))
    return tuple(result)


def _times(course: Course, grid: CourseGrid, run: int) -> tuple[float, float]:
    """Begin and end of a course in a run, s."""
    if course.time is not None and (course.kind.endswith(BEGINS) or course.kind == GROWS):
        return course.time, math.inf
    if course.time is not None and course.kind == ENDS:
        return -math.inf, course.time
    if not course.kind.startswith(PHASE):
        return -math.inf, math.inf
    phase = course.kind.removeprefix(PHASE)
    return next(((start, end) for name, start, end in grid.phases[run] if name == phase), (-math.inf, math.inf))


def about_point(
    sd: Array, point: ActingPoint, r: Array, J: Array, entries: Sequence[tuple[Place, Course]], grid: CourseGrid
) -> ProjectedData:
    """The linear model about a point: d = r + J x + (responses) q, with whitened residuals r and sensitivities J there.

    The responses to sources stay as they are: what base numbers and sensors change of them is in J.
    """
    d = r + J @ point.x
    for (place, _), acting in zip(entries, point.sources, strict=True):
        courses = grid.sampled(lambda run, t, acting=acting: acting[run].course(t))  # type: ignore[misc]
        d = d + place.columns @ np.concatenate(courses)
    return ProjectedData(d, J, sd)


def simulated_at(
    residuals: Residuals,
    evaluations: Evaluations,
    unknowns: Sequence[Unknown],
    present: Mapping[Unknown, float],
    patches: Sequence[Unknown],
    point: ActingPoint,
) -> tuple[Array, Array] | None:
    """Whitened residuals (n,) and sensitivities (n, k) of the fitted runs at a point; None if no tyre is possible.

    ``present``: values of further unknowns. ``patches``: of the sources.
    """
    fitted, values = residuals.fitted, []
    for run in range(len(fitted)):
        each = [(acting[run], patch) for acting, patch in zip(point.sources, patches, strict=True)]
        of_sources = {acting.unknown(patch): acting.strength for acting, patch in each if acting.strength}
        values.append({**dict(zip(unknowns, map(float, point.x), strict=True)), **present, **of_sources})
    answers = evaluations.of("predict", list(zip(fitted, values, strict=True)))
    if not all(np.isfinite(answer).all() for answer in answers):
        return None
    questions = [(number, tuple(unknowns), at) for number, at in zip(fitted, values, strict=True)]
    slopes = evaluations.of("jacobian", questions)
    r = residuals.joined([residuals.residual(number, answer) for number, answer in zip(fitted, answers, strict=True)])
    J = residuals.joined([residuals.runs[number].whitened(each) for number, each in zip(fitted, slopes, strict=True)])
    return (r, J) if np.isfinite(J).all() else None


@dataclass(frozen=True, eq=False)
class ActingHeat(Brief):
    """Sources of known places and kinds of course, estimated anew.

    Parameters
    ----------
    data : linear model about the point where they act. entries : places with their courses. sources : by entry, its
        time, if it has one, and its amount; empty before they are estimated.
    """

    data: ProjectedData
    entries: tuple[tuple[Place, Course], ...]
    sources: tuple[EstimatedSource, ...]

    @classmethod
    def of(cls, data: ProjectedData, entries: Sequence[tuple[Place, Course]], grid: CourseGrid) -> ActingHeat:
        """The times that explain the data best, and the amounts, one source after the other."""
        data = replace(data, weight=1.0 / max(1.0, misfit(data, entries) / len(data.data)))
        current, sources = list(entries), list[EstimatedSource]()
        for number, (place, course) in enumerate(entries):
            others = [entry for other, entry in enumerate(current) if other != number]
            source = estimated(data, place, course, others, grid)
            sources.append(source)
            current[number] = place, source.course
        return cls(data, tuple(current), tuple(sources))


def where_it_acts(residuals: Residuals, evaluations: Evaluations, heat: HeatOverTime) -> ActingHeat | None:
    """The sources estimated about the point where they act, see `repeated`.

    None without a clear source that has a time or a course that a study file can state, if no tyre is possible there,
    or if the amount of such a source is no longer clear there.
    """
    basis = heat.basis
    restated = [source for source in heat.clear if source.kind in WRITTEN or math.isfinite(source.time)]
    if basis is None or not restated:
        return None
    low, high = (np.array([getattr(each, side) for each in basis.nuisance]) for side in ("low", "high"))

    def again(current: ActingHeat) -> tuple[ActingHeat, float, float] | None:
        exact = replace(current.data, weight=1.0)
        point = best_point(exact, low, high, current.entries, basis.grid)
        there = simulated_at(residuals, evaluations, basis.nuisance, basis.present, basis.unknowns, point)
        if there is None:
            return None
        data = about_point(exact.sd, point, *there, current.entries, basis.grid)
        return ActingHeat.of(data, current.entries, basis.grid), float(there[0] @ there[0]), point.misfit

    first = ActingHeat(basis.data, basis.entries, ())
    acting = repeated(first, again)
    if acting is first:
        return None
    known = _by_place(acting)
    unclear = any(not known[source.station, source.where].clear for source in restated)
    return None if unclear else acting


def _by_place(acting: ActingHeat) -> dict[tuple[float, str], EstimatedSource]:
    return {
        (place.station, place.where): source for (place, _), source in zip(acting.entries, acting.sources, strict=True)
    }


def as_it_acts(study: StudyData, settings: DiagnosisSettings, heat: HeatOverTime, acting: ActingHeat) -> HeatOverTime:
    """The sources with times and amounts from where they act, also for the amended study.

    Of both intervals the wider one: another point adds no readings. A free course keeps what was estimated about no
    source.
    """
    known = _by_place(acting)

    def updated(source: UnknownSource) -> UnknownSource:
        new = known[source.station, source.where]
        if math.isfinite(source.time):
            source = replace(source, time=new.time, time_sd=max(new.time_sd, source.time_sd))
        sd = max(new.sd, source.sd)
        return replace(source, amount=new.amount, sd=sd) if new.course.kind in WRITTEN else source

    sources = tuple(map(updated, heat.sources))
    if not heat.unknowns or heat.basis is None:
        return replace(heat, sources=sources)
    clear = {(source.station, source.where) for source in heat.clear}
    entries = [(place, course) for place, course in acting.entries if (place.station, place.where) in clear]
    named = [(source_unknown(study, settings, *entry), *entry) for entry in entries]
    values, sd = values_with_sources(acting.data, heat.basis.nuisance, named)
    return replace(heat, sources=sources, values=values, sd=sd, unknowns=tuple(unknown for unknown, _, _ in named))
