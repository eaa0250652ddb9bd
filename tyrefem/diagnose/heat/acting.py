"""Sensitivities where sources of unknown origin act: base numbers and sensors change the response to a source, too."""

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
from tyrefem.diagnose.heat.sources import Place
from tyrefem.diagnose.inference.evidence import posterior
from tyrefem.diagnose.unknowns.unknown import Unknown

Array = NDArray[np.float64]
Estimate = TypeVar("Estimate")
#: Most linear models about points where sources act. The last one is that about a point where the misfit is above that
#: of the linear model before by no more than this share.
ROUNDS, NEAR = 4, 0.05


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
        times = {BEGINS: self.begins if self.begins > 0 else math.inf, ENDS: self.ends}
        choice = tuple((name, f"{round(float(time), 1)!r} s") for name, time in times.items() if math.isfinite(time))
        return replace(patch, choice=(*patch.choice, *choice), key=".".join((patch.key, *map(" ".join, choice))))


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
