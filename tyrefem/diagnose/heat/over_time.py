"""Heat of unknown origin over time: its sources by place, sign and course, estimated from the fitted runs."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.diagnose.data.residuals import Residuals
from tyrefem.diagnose.fitting.fits import FittedSet
from tyrefem.diagnose.fitting.materiality import Movement, largest_change
from tyrefem.diagnose.forward.evaluations import Evaluations
from tyrefem.diagnose.heat.courses import Course, CourseGrid, courses
from tyrefem.diagnose.heat.evidence import ProjectedData
from tyrefem.diagnose.heat.sources import Place, UnknownSource, evidence, misfit, place_shares, pursuit, timed
from tyrefem.diagnose.heat.values import WRITTEN, source_unknown, values_with_sources
from tyrefem.diagnose.unknowns.heat_patches import is_inside, layer_patches, patches, place_of, surface_patches
from tyrefem.diagnose.unknowns.unknown import Unknown
from tyrefem.inputs.drive import Drive
from tyrefem.inputs.motion import motion_at

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SourceBasis(Brief):
    """What the sources of `HeatOverTime` were estimated from, for their law: see `heat_law`.

    Parameters
    ----------
    data : the data, base numbers and sensors integrated out. entries : places with their courses, on ``grid``.
    unknowns : of the places. grid, coarse : the fitted runs with fine and with few knots.
    tried : every other place, coarse, single layers at the places' stations included, with its unknown.
    nuisance : unknowns of the columns of the data's Jacobian. present : values of the unknowns of effects beside them.
    """

    data: ProjectedData
    entries: tuple[tuple[Place, Course], ...]
    unknowns: tuple[Unknown, ...]
    grid: CourseGrid
    coarse: CourseGrid
    tried: tuple[tuple[Place, Unknown], ...]
    nuisance: tuple[Unknown, ...]
    present: Mapping[Unknown, float]


@dataclass(frozen=True, eq=False)
class HeatOverTime(Brief):
    """Sources of heat of unknown origin, the most significant first.

    Parameters
    ----------
    sources : see `UnknownSource`. knots : by fitted run (n_knots,) s. runs : names of the fitted runs.
    rolling : by run (n_knots,) whether the tyre rolls. cools : whether a fitted run has readings at rest after rolling.
    log_evidence : ln evidence of the data, comparable with the sets of effects; places and courses share the prior.
    values, sd : x and standard deviation of base numbers, sensors and clear sources; empty if a study file cannot state
        the course of a clear source. unknowns : of the clear sources. basis : what they were estimated from.
    """

    sources: tuple[UnknownSource, ...]
    knots: tuple[Array, ...]
    runs: tuple[str, ...]
    rolling: tuple[NDArray[np.bool_], ...]
    cools: bool
    log_evidence: float
    values: dict[Unknown, float]
    sd: dict[Unknown, float]
    unknowns: tuple[Unknown, ...]
    basis: SourceBasis | None = None

    @property
    def clear(self) -> tuple[UnknownSource, ...]:
        """The sources whose amount differs from zero by more than two standard deviations."""
        return tuple(source for source in self.sources if source.clear)


def heat_over_time(
    residuals: Residuals, evaluations: Evaluations, about: FittedSet, tick: Callable[[], None] | None = None
) -> HeatOverTime:
    """Estimate the sources in the linear model about the fit of no effect or about x = 0, whichever explains more.

    Beside effects only the model about their fit counts: about x = 0 there are none, and the sources would be theirs.

    1. Every place of a few coarse knots in time is tried: heat in all layers, and flux through the outer surface, the
       inner surface and from the rim. The best are added one by one.
    2. At the station of each source, single layers compete too.
    3. Each source gets fine knots; the courses of `heat.courses` compete by evidence.
    """
    of_fit = np.array([unknown.sd for unknown in about.unknowns])
    points: list[tuple[ProjectedData, Sequence[Unknown]]] = [
        (ProjectedData(about.linear.data, about.linear.jacobian, of_fit), about.unknowns)
    ]
    if not about.members:
        origin, n = residuals.linear(residuals.fitted), residuals.nuisance
        at_zero = ProjectedData(origin.data, origin.jacobian[:, :n], origin.design.sd[:n])
        points.insert(0, (at_zero, residuals.unknowns[:n]))
    responses = _Responses(residuals, evaluations, tick)
    present = {unknown: 1.0 for member in about.members for unknown in member.presence}
    estimates = [_estimated(residuals, responses, data, unknowns, present) for data, unknowns in points]
    return max(estimates, key=lambda heat: heat.log_evidence)


def _estimated(
    residuals: Residuals,
    responses: _Responses,
    data: ProjectedData,
    nuisance: Sequence[Unknown],
    present: Mapping[Unknown, float],
) -> HeatOverTime:
    study, settings = residuals.study, residuals.settings
    coarse, fine = (_grid(residuals, count) for count in (settings.coarse_knots, settings.fine_knots))
    tried = (*patches(study, settings), *surface_patches(study, settings))
    places = responses.places(coarse, tried)
    chosen = pursuit(data, places, coarse, settings.most_sources, settings.source_gain)
    # What even the free courses leave is an error of the linear model: with less weight it makes no further sources.
    exact, data = data, replace(data, weight=1.0 / max(1.0, misfit(data, chosen) / len(data.data)))
    chosen = pursuit(data, places, coarse, settings.most_sources, settings.source_gain)
    shares, refined, layered = [], [], dict[tuple[float, str], Place]()
    for number, (place, _) in enumerate(chosen):
        others = [entry for other, entry in enumerate(chosen) if other != number]
        layers = responses.places(coarse, layer_patches(study, settings, place.station))
        layered |= {(layer.station, layer.where): layer for layer in layers}
        options = [option for option in (*places, *layers) if all(option is not other for other, _ in others)]
        share = place_shares(data, options, others, coarse)
        shares.append(share)
        refined.append(next(o for o in options if (o.station, o.where) == next(iter(share))))
    unknown_of = {place_of(unknown): unknown for unknown in tried}
    # The station of a source may move while its layers compete, so those of both stations are needed.
    for station in dict.fromkeys([*(station for station, _ in layered), *(place.station for place in refined)]):
        for unknown in layer_patches(study, settings, station):
            unknown_of[place_of(unknown)] = unknown
    of_places = tuple(unknown_of[place.station, place.where] for place in refined)
    resolved = responses.places(fine, of_places)
    free = pursuit(data, resolved, fine, len(resolved), -math.inf)
    current = [(place, next(course for other, course in free if other is place)) for place in resolved]
    sources: list[UnknownSource] = []
    for number, place in enumerate(resolved):
        others = [entry for other, entry in enumerate(current) if other != number]
        source, course = timed(data, place, others, fine, shares[number])
        current[number] = place, course
        strength = source.amount * course.strength if course.strength.size else np.concatenate(source.strength)
        sources.append(replace(source, move=responses.movement(fine, of_places[number], strength)))
    # Every place and every course has a share of the prior; a course with a switch shares it further.
    shared = len(current) * (math.log(len(tried)) + math.log(sum(1 for _ in courses(fine))))
    log_evidence = exact.log_evidence + evidence(exact, current) - shared
    rolling = tuple(
        np.array([fine.speed(number, float(t)) > 0 for t in knots]) for number, knots in enumerate(fine.knots)
    )
    cools = any(flags.any() and not flags[int(np.argmax(flags)) :].all() for flags in rolling)
    clear = [entry for source, entry in zip(sources, current, strict=True) if source.clear]
    written = all(course.kind in WRITTEN for _, course in clear)
    named = [(source_unknown(study, settings, *entry), *entry) for entry in clear if written]
    values, sd = values_with_sources(data, nuisance, named) if named else ({}, {})
    unknowns = tuple(unknown for unknown, _, _ in named)
    sources.sort(key=lambda source: -abs(source.amount) / source.sd)
    every = [(place, unknown_of[place.station, place.where]) for place in (*places, *layered.values())]
    basis = SourceBasis(data, tuple(current), of_places, fine, coarse, tuple(every), tuple(nuisance), present)
    return HeatOverTime(
        tuple(sources), fine.knots, fine.names, rolling, cools, log_evidence, values, sd, unknowns, basis
    )


def _grid(residuals: Residuals, count: int) -> CourseGrid:
    """The fitted runs with even knots up to the last reading, or the end of the drive."""
    names, knots, phases, drives = [], [], [], []
    for number in residuals.fitted:
        run, drive = residuals.runs[number], residuals.driven(number).card.drive
        # In whole hundredths of the drive: diagnoses of one layout then have the same knots and share responses.
        hundredth = drive.end / 100
        last = min(math.ceil(run.last / hundredth - 1e-9) * hundredth, drive.end)
        names.append(run.name)
        knots.append(np.linspace(0.0, last, count))
        drives.append(drive)
        phases.append(
            tuple(
                (phase.name, start, start + phase.duration)
                for start, phase in zip(drive.starts, drive.phases, strict=True)
                if start < last
            )
        )
    return CourseGrid(tuple(names), tuple(knots), tuple(phases), DriveSpeeds(tuple(drives)))


@dataclass(frozen=True, eq=False)
class DriveSpeeds:
    """The speed of every fitted run's drive, m/s; a function that can be stored."""

    drives: tuple[Drive, ...]

    def __call__(self, number: int, t: float) -> float:
        """Speed of a run at a time, s."""
        return float(motion_at(self.drives[number], t).speed)


class _Responses:
    """Whitened responses of the fitted runs to sources over time; each is computed once."""

    def __init__(self, residuals: Residuals, evaluations: Evaluations, tick: Callable[[], None] | None) -> None:
        self.residuals, self.evaluations, self.tick = residuals, evaluations, tick
        self._known: dict[tuple[Unknown, int], Array] = {}
        self._readings: dict[tuple[Unknown, int], list[Array]] = {}

    def places(self, grid: CourseGrid, unknowns: Sequence[Unknown]) -> list[Place]:
        """The places of some unknowns with their responses."""
        left = tuple(unknown for unknown in unknowns if (unknown, grid.size) not in self._known)
        if left:
            self._known |= zip([(unknown, grid.size) for unknown in left], self._computed(grid, left), strict=True)
        spread = self.residuals.settings.source_spread
        return [
            Place(*place_of(unknown), spread * unknown.sd, inside, self._known[unknown, grid.size])
            for unknown, inside in zip(unknowns, is_inside(unknowns), strict=True)
        ]

    def movement(self, grid: CourseGrid, unknown: Unknown, strength: Array) -> Movement:
        """The largest change of a reading by a source with this strength at the knots of all runs (n_all_knots,)."""
        drives = [self.residuals.sensitivities.drives[number] for number in self.residuals.fitted]
        answers = self._readings[unknown, grid.size]
        return largest_change(
            drives, [answer @ strength[part] for answer, part in zip(answers, grid.parts(), strict=True)]
        )

    def _computed(self, grid: CourseGrid, unknowns: tuple[Unknown, ...]) -> list[Array]:
        """By unknown (n, n_all_knots)."""
        fitted = self.residuals.fitted
        questions = [
            (number, unknowns, tuple(map(float, knots))) for number, knots in zip(fitted, grid.knots, strict=True)
        ]
        answers = self.evaluations.of("source_responses", questions, self.tick)
        for column, unknown in enumerate(unknowns):
            self._readings[unknown, grid.size] = [answer[:, column] for answer in answers]
        ends = np.cumsum([0, *(len(answer) for answer in answers)])
        columns = np.zeros((len(unknowns), ends[-1], grid.size))
        for order, (number, answer, part) in enumerate(zip(fitted, answers, grid.parts(), strict=True)):
            for column in range(len(unknowns)):
                whitened = self.residuals.runs[number].whitened(np.ascontiguousarray(answer[:, column]))
                columns[column, ends[order] : ends[order + 1], part] = whitened
        return list(columns)


def source_columns(
    residuals: Residuals,
    evaluations: Evaluations,
    grid: CourseGrid,
    unknowns: Sequence[Unknown],
    tick: Callable[[], None] | None = None,
) -> list[Array]:
    """By unknown (n, n_all_knots): whitened responses of the fitted runs to a source of unit strength at every knot."""
    return _Responses(residuals, evaluations, tick)._computed(grid, tuple(unknowns))
