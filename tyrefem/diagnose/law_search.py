"""Search for the law of missing heat: laws at the place of the largest source, of the model's own heat, of films."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.diagnose.evaluations import Evaluations
from tyrefem.diagnose.heat_courses import CORRELATED, Course, CourseGrid, constant, courses, free
from tyrefem.diagnose.heat_evidence import ProjectedData
from tyrefem.diagnose.heat_law import PlaceLaw, place_law
from tyrefem.diagnose.heat_over_time import HeatOverTime, SourceBasis, source_columns
from tyrefem.diagnose.heat_sources import Place, evidence
from tyrefem.diagnose.law_evidence import law_data
from tyrefem.diagnose.law_places import HEAT, LOSS, LawPlace, law_place, points_of, shares_of_model
from tyrefem.diagnose.law_terms import DriveVariables, drive_variables, fine_times, law_terms
from tyrefem.diagnose.residuals import Residuals

Array = NDArray[np.float64]
#: Shares of the model's heat or films whose laws are tried, and how far below the sources they may be, nats.
MOST_SHARES, FAR = 3, 20.0
#: A law holds for all runs if sources with a free strength in every run explain the data by no more than this better.
WORSE = 3.0


@dataclass(frozen=True, eq=False)
class RankedPlace(Brief):
    """A place with its best law, beside ``beside`` further sources; ``below``: ln evidence below the best place."""

    place: LawPlace
    law: PlaceLaw
    beside: int
    below: float
    columns: Array
    data: ProjectedData


@dataclass(frozen=True, eq=False)
class HeatLaw(Brief):
    """The law of the missing heat over the runs.

    Parameters
    ----------
    ranking : places with their laws, best first. variables : what varies over the runs.
    lead : ln evidence of the best law over sources with a free strength in every run.
    basis : the data, and the coarse places of `HeatOverTime`.
    """

    ranking: tuple[RankedPlace, ...]
    variables: DriveVariables
    lead: float
    basis: SourceBasis

    @property
    def place(self) -> LawPlace:
        """The place of the best law."""
        return self.ranking[0].place

    @property
    def law(self) -> PlaceLaw:
        """The best law."""
        return self.ranking[0].law

    @property
    def holds(self) -> bool:
        """Whether one law with a clear amplitude describes the heat in all fitted runs."""
        return self.law.clear and self.lead > -WORSE


def heat_law(
    residuals: Residuals,
    evaluations: Evaluations,
    over_time: HeatOverTime | None,
    tick: Callable[[], None] | None = None,
) -> HeatLaw | None:
    """The law of the largest clear source; None without one.

    Its place competes with shares of the model's own heat (in all regions and in each) and with shares of the films,
    beside the other sources and alone. The linear model is that of `heat_over_time`.
    """
    if over_time is None or over_time.basis is None or not over_time.clear:
        return None
    basis, largest = over_time.basis, over_time.clear[0]
    main = next(
        number
        for number, (place, _) in enumerate(basis.entries)
        if (place.station, place.where) == (largest.station, largest.where)
    )
    others = [entry for number, entry in enumerate(basis.entries) if number != main]
    # Every source pays for the choice of its place, every other source for that of its course, too.
    of_place = math.log(len(basis.tried))
    of_other = of_place + math.log(sum(1 for _ in courses(basis.grid)))
    models = shares_of_model(residuals)
    patch = law_place(basis.entries[main][0], basis.unknowns[main])
    tried = [(patch, basis.entries[main][0].columns, False, -of_place - len(others) * of_other)]
    for model, columns, alone in _promising(residuals, evaluations, basis, others, models, tick):
        tried.append((model, columns, alone, -math.log(len(models)) - (0 if alone else len(others) * of_other)))
    variables, temperatures = _variables(residuals, evaluations, basis.grid, [entry[0] for entry in tried], tick)
    ranked = []
    for (place, columns, alone, prior), temperature in zip(tried, temperatures, strict=True):
        data = basis.data if alone else _beside(basis.data, others)
        of_place_data = law_data(data, columns, place.sd, variables.hats)
        terms = law_terms(variables, temperature if place.kind in (HEAT, LOSS) else None)
        law = place_law(of_place_data, variables, terms, inside=place.inside)
        ranked.append(
            (law.log_evidence + prior, RankedPlace(place, law, 0 if alone else len(others), 0.0, columns, data))
        )
    ranked.sort(key=lambda entry: -entry[0])
    top = ranked[0][0]
    by_run = basis.data.log_evidence + evidence(basis.data, list(basis.entries)) - len(basis.entries) * of_other
    return HeatLaw(tuple(replace(place, below=top - score) for score, place in ranked), variables, top - by_run, basis)


def _beside(data: ProjectedData, others: Sequence[tuple[Place, Course]]) -> ProjectedData:
    """The data with the coefficients of other sources integrated out, too."""
    columns = [place.sd * place.columns @ course.factor for place, course in others]
    count = sum(each.shape[1] for each in columns)
    return replace(data, jacobian=np.hstack([data.jacobian, *columns]), sd=np.concatenate([data.sd, np.ones(count)]))


def _promising(
    residuals: Residuals,
    evaluations: Evaluations,
    basis: SourceBasis,
    others: Sequence[tuple[Place, Course]],
    models: Sequence[LawPlace],
    tick: Callable[[], None] | None,
) -> list[tuple[LawPlace, Array, bool]]:
    """The shares of the model that may explain as much as the sources: with fine responses, and whether alone."""
    coarse = basis.coarse
    kinds = (constant(coarse), *(free(coarse, share * float(coarse.ends.max())) for share in CORRELATED))
    columns = source_columns(residuals, evaluations, coarse, [model.unknown for model in models], tick)
    needed = evidence(basis.data, list(basis.entries)) - FAR
    scored = []
    for number, (model, each) in enumerate(zip(models, columns, strict=True)):
        place = Place(model.station, model.where, model.sd, model.inside, each)
        for alone in (True, False) if others else (True,):
            beside = [] if alone else list(others)
            scored.append((max(evidence(basis.data, [*beside, (place, kind)]) for kind in kinds), number, alone))
    scored.sort(reverse=True)
    kept: dict[int, bool] = {}
    for value, number, alone in scored:
        if value >= needed and number not in kept and len(kept) < MOST_SHARES:
            kept[number] = alone
    if not kept:
        return []
    chosen = [models[number] for number in kept]
    fine = source_columns(residuals, evaluations, basis.grid, [model.unknown for model in chosen], tick)
    return [(model, each, alone) for model, each, alone in zip(chosen, fine, kept.values(), strict=True)]


def _variables(
    residuals: Residuals,
    evaluations: Evaluations,
    grid: CourseGrid,
    places: Sequence[LawPlace],
    tick: Callable[[], None] | None,
) -> tuple[DriveVariables, list[Array]]:
    """What varies over the fitted runs, and the temperature at every place: computed, plus the nearest sensor's gap."""
    points = points_of(residuals.study, places)
    times = fine_times(grid)
    questions = [
        (number, tuple(map(float, each)), points) for number, each in zip(residuals.fitted, times, strict=True)
    ]
    answers = evaluations.of("drive_variables", questions, tick)
    temperatures: list[list[Array]] = [[] for _ in places]
    for number, each, answer in zip(residuals.fitted, times, answers, strict=True):
        for order, of_place in enumerate(points):
            gap = _gap_near(residuals, number, each, np.array(of_place).mean(axis=0))
            temperatures[order].append(answer[5 + order] + gap)
    variables = drive_variables(grid, [answer[:5] for answer in answers])
    return variables, [np.concatenate(each) for each in temperatures]


def _gap_near(residuals: Residuals, number: int, times: Array, place: Array) -> Array:
    """Measured minus computed of the sensor nearest to a place (s, depth), K; 0 without a sensor in the rubber."""
    study, run = residuals.study, residuals.runs[number]
    known = {readings.sensor: readings for readings in run.sensors if readings.sensor in study.sensors}
    if not known:
        return np.zeros(len(times))
    at = study.section.place(place[:1], place[1:])[0]
    nearest = min(known, key=lambda name: math.dist(study.section_place(study.sensors[name]), at))
    gap = run.measured - residuals.corrected(number, residuals.computed[number])
    return np.interp(times, known[nearest].block_times, gap[run.parts()[nearest]])
