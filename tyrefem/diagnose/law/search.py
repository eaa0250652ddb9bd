"""Search for the law of missing heat: laws at the place of the largest source, of the model's own heat, of films."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.diagnose.data.residuals import Residuals
from tyrefem.diagnose.forward.evaluations import Evaluations
from tyrefem.diagnose.heat.courses import BEGINS, ENDS, Course, CourseGrid, courses
from tyrefem.diagnose.heat.evidence import ProjectedData
from tyrefem.diagnose.heat.over_time import HeatOverTime, SourceBasis, source_columns
from tyrefem.diagnose.heat.sources import Place, UnknownSource, evidence
from tyrefem.diagnose.law.evidence import fitted_law, law_data, law_strength, plain_switch
from tyrefem.diagnose.law.heat_law import PlaceLaw, place_law
from tyrefem.diagnose.law.places import (
    FLUX,
    HEAT,
    LOSS,
    LawPlace,
    law_place,
    points_of,
    shares_of_model,
    whole_surfaces,
)
from tyrefem.diagnose.law.scatter import SeriesScatter
from tyrefem.diagnose.law.terms import (
    LOAD,
    PRESSURE,
    ROLLING,
    SPEED,
    DriveVariables,
    Switch,
    drive_variables,
    fine_times,
    law_terms,
)

Array = NDArray[np.float64]
#: Largest number of places, of shares of the model's heat or of films, and of whole surfaces, whose laws are tried
#: alone; and how far below the best of its kind each may be, nats.
MOST_PLACES, MOST_SHARES, MOST_SURFACES, FAR = 3, 3, 2, 30.0
#: A law holds for all runs if sources with a free strength in every run explain the data by no more than this better,
#: nats, or if it describes this share of the gain of ln evidence that they have.
WORSE, MOSTLY = 3.0, 0.9


@dataclass(frozen=True, eq=False)
class RankedPlace(Brief):
    """A place with its best law, beside further sources ``others``; ``below``: ln evidence below the best place."""

    place: LawPlace
    law: PlaceLaw
    others: tuple[tuple[Place, Course], ...]
    below: float
    columns: Array


@dataclass(frozen=True, eq=False)
class HeatLaw(Brief):
    """The law of the missing heat over the runs.

    Parameters
    ----------
    ranking : places with their laws: first those that describe nearly all by themselves, then by evidence.
    variables : what varies over the runs.
    lead : ln evidence of the first law over sources with a free strength in every run. share : its gain of ln evidence
        over theirs.
    basis : the data, and the coarse places of `HeatOverTime`.
    """

    ranking: tuple[RankedPlace, ...]
    variables: DriveVariables
    lead: float
    share: float
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
    def data(self) -> ProjectedData:
        """The data of the best law: those of the basis, with the sources beside it integrated out, too."""
        return _beside(self.basis.data, self.ranking[0].others)

    @property
    def holds(self) -> bool:
        """Whether one law with a clear amplitude describes the heat in all fitted runs."""
        return self.law.clear and (self.lead > -WORSE or self.share >= MOSTLY)

    def as_it_acts(self, data: ProjectedData) -> HeatLaw:
        """The laws with switches and amplitudes by a linear model about the point where the sources act: ``data``.

        A share of the model's heat or of a film is not what acts there: without a switch it stays as it is.
        """
        ranking = []
        for entry in self.ranking:
            place = entry.place
            of_place = law_data(_beside(data, entry.others), entry.columns, place.sd, self.variables.hats)
            law = entry.law
            if place.kind in (HEAT, FLUX) or not math.isnan(law.time):
                law = law.as_it_acts(of_place, self.variables, inside=place.inside)
            ranking.append(replace(entry, law=law))
        return replace(self, ranking=tuple(ranking))


def heat_law(
    residuals: Residuals,
    evaluations: Evaluations,
    over_time: HeatOverTime | None,
    tick: Callable[[], None] | None = None,
) -> HeatLaw | None:
    """The law of the missing heat; None without a clear source.

    Tried are: the source that moves readings most, beside the other sources and alone; all heat of its sign with one
    law; other places alone, as one source with a law may look like several; shares of the model's own heat (in all
    regions and in each) and of the films. The linear model is that of `heat_over_time`. Few knots in time choose the
    most promising ones of each kind.
    """
    if over_time is None or over_time.basis is None or not over_time.clear:
        return None
    basis = over_time.basis
    variables = _drive(residuals, evaluations, basis.grid, tick)
    options = _of_sources(over_time, basis)
    known = {option.place.unknown: option.columns for option in options if not option.place.parts}
    models, surfaces = shares_of_model(residuals), whole_surfaces(residuals)
    further = [place.unknown for place in (*models, *surfaces)]
    coarse = source_columns(residuals, evaluations, basis.coarse, further, tick)
    alone = [(law_place(place, unknown), place.columns) for place, unknown in basis.tried]
    chosen = _promising(basis, variables, alone, MOST_PLACES)
    chosen += _promising(basis, variables, list(zip(models, coarse, strict=False)), MOST_SHARES)
    chosen += _promising(basis, variables, list(zip(surfaces, coarse[len(models) :], strict=True)), MOST_SURFACES)
    single = [option.place for option in options if not option.place.parts]
    chosen += [place for place in single if all(place.unknown != other.unknown for other in chosen)]
    new = [place.unknown for place in chosen if place.unknown not in known]
    known |= zip(new, source_columns(residuals, evaluations, basis.grid, new, tick), strict=True)
    options = [option for option in options if option.others or option.place.parts]
    options += [_Option(place, (), known[place.unknown]) for place in chosen]
    # Every source pays for the choice of its place, and beside sources of a free course for that of their courses.
    of_place = math.log(len(basis.tried) + len(further))
    of_other = of_place + math.log(sum(1 for _ in courses(basis.grid)))
    temperatures = _temperatures(residuals, evaluations, variables, [option.place for option in options], tick)
    series = _series(residuals)
    ranked = []
    for option, temperature in zip(options, temperatures, strict=True):
        place, data = option.place, _beside(basis.data, option.others)
        terms = law_terms(variables, temperature if place.kind in (HEAT, LOSS) else None, of_heat=place.kind == HEAT)
        of_option = law_data(data, option.columns, place.sd, variables.hats)
        scatter = SeriesScatter(data, option.columns, series)
        law = place_law(of_option, variables, terms, inside=place.inside, scatter=scatter)
        entry = RankedPlace(place, law, option.others, 0.0, option.columns)
        places = max(len(place.parts), 1)
        ranked.append((law.log_evidence - places * of_place - len(option.others) * of_other, entry))
    top, none = max(score for score, _ in ranked), basis.data.log_evidence
    by_run = none + evidence(basis.data, list(basis.entries)) - len(basis.entries) * of_other

    def share(score: float) -> float:
        return (score - none) / max(by_run - none, 1e-9)

    ranked.sort(key=lambda scored: (bool(scored[1].others) or share(scored[0]) < MOSTLY, -scored[0]))
    first = ranked[0][0]
    ranking = tuple(replace(entry, below=top - score) for score, entry in ranked)
    return HeatLaw(ranking, variables, first - by_run, share(first), basis)


@dataclass(frozen=True, eq=False)
class _Option:
    """A place for a law, beside other sources of free courses; ``columns``: fine responses."""

    place: LawPlace
    others: tuple[tuple[Place, Course], ...]
    columns: Array


def _of_sources(over_time: HeatOverTime, basis: SourceBasis) -> list[_Option]:
    """The source that moves readings most, beside the others; and all heat inside of one sign with one law.

    A source of another shape than a patch looks like several at one place.
    """
    entry_of = {(entry[0].station, entry[0].where): number for number, entry in enumerate(basis.entries)}
    clear = {entry_of[source.station, source.where]: source for source in over_time.clear}
    main = max(clear, key=lambda number: _moved(clear[number]))
    place = law_place(basis.entries[main][0], basis.unknowns[main])
    options = [_Option(place, _without(basis, [main]), basis.entries[main][0].columns)]
    inside = [number for number, source in clear.items() if source.inside]
    if len(inside) < 2:
        return options
    first = max(inside, key=lambda number: _moved(clear[number]))
    shares = {number: clear[number].amount / clear[first].amount for number in inside}
    shares = {number: share for number, share in shares.items() if share > 0}
    if len(shares) > 1:
        parts = tuple((basis.unknowns[number], share) for number, share in shares.items())
        whole = replace(law_place(basis.entries[first][0], basis.unknowns[first]), parts=parts)
        columns = np.sum([share * basis.entries[number][0].columns for number, share in shares.items()], axis=0)
        options += [_Option(whole, (), columns)]
        options += [_Option(whole, others, columns)] if (others := _without(basis, tuple(shares))) else []
    return options


def _moved(source: UnknownSource) -> float:
    """What a source moves at the sensors, K."""
    return 0.0 if source.move is None else abs(source.move.kelvin)


def _without(basis: SourceBasis, numbers: Sequence[int]) -> tuple[tuple[Place, Course], ...]:
    return tuple(entry for number, entry in enumerate(basis.entries) if number not in numbers)


def _beside(data: ProjectedData, others: Sequence[tuple[Place, Course]]) -> ProjectedData:
    """The data with the coefficients of other sources integrated out, too."""
    if not others:
        return data
    columns = [place.sd * place.columns @ course.factor for place, course in others]
    count = sum(each.shape[1] for each in columns)
    return replace(data, jacobian=np.hstack([data.jacobian, *columns]), sd=np.concatenate([data.sd, np.ones(count)]))


def _series(residuals: Residuals) -> tuple[slice, ...]:
    """Rows of each sensor in each fitted run."""
    series, start = [], 0
    for number in residuals.fitted:
        run = residuals.runs[number]
        series += [slice(start + part.start, start + part.stop) for part in run.parts().values()]
        start += run.size
    return tuple(series)


def _promising(
    basis: SourceBasis, variables: DriveVariables, places: Sequence[tuple[LawPlace, Array]], most: int
) -> list[LawPlace]:
    """The places whose laws explain most alone, by responses at few knots: always on, or begun or ended in between."""
    coarse = replace(variables, grid=basis.coarse)
    longest = float(basis.coarse.ends.max())
    t = coarse.times
    tried = [plain_switch(len(t))]
    for time in longest * np.linspace(0.1, 0.9, 9):
        tried += [Switch(BEGINS, (t >= time).astype(float), time), Switch(ENDS, (t < time).astype(float), time)]
    scored = []
    for place, columns in places:
        data = law_data(basis.data, columns, place.sd, coarse.hats)
        terms = law_terms(coarse, of_heat=place.kind == HEAT)
        names = [name for name in (SPEED, LOAD, PRESSURE) if name in terms.features]
        rolls = coarse.rolling.astype(float) if place.inside else np.ones(len(t))
        usual = law_strength([terms.features[name] for name in names], np.array([terms.prior(n)[0] for n in names]),
                             Switch(ROLLING, rolls))  # fmt: skip
        switch = max(tried, key=lambda each: data.gain(each.on * usual))
        fits = [fitted_law(data, terms, names, each) for each in (tried[0], switch)]
        scored.append((max(fit.log_evidence for fit in fits), place))
    scored.sort(key=lambda entry: -entry[0])
    return [place for value, place in scored[:most] if value > scored[0][0] - FAR]


def _drive(
    residuals: Residuals, evaluations: Evaluations, grid: CourseGrid, tick: Callable[[], None] | None
) -> DriveVariables:
    """What varies over the fitted runs."""
    times = zip(residuals.fitted, fine_times(grid), strict=True)
    questions = [(number, tuple(map(float, each)), ()) for number, each in times]
    return drive_variables(grid, evaluations.of("drive_variables", questions, tick))


def _temperatures(
    residuals: Residuals,
    evaluations: Evaluations,
    variables: DriveVariables,
    places: Sequence[LawPlace],
    tick: Callable[[], None] | None,
) -> list[Array]:
    """By place: its temperature (n,) degC over the runs, computed, plus the nearest sensor's gap."""
    points = points_of(residuals.study, places)
    times = fine_times(variables.grid)
    questions = [
        (number, tuple(map(float, each)), points) for number, each in zip(residuals.fitted, times, strict=True)
    ]
    answers = evaluations.of("drive_variables", questions, tick)
    return [
        np.concatenate([
            answer[5 + order] + _gap_near(residuals, number, each, np.array(of_place).mean(axis=0))
            for number, each, answer in zip(residuals.fitted, times, answers, strict=True)
        ])
        for order, of_place in enumerate(points)
    ]  # fmt: skip


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
