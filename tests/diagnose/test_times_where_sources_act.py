"""Sources are estimated where they act: late sensors show them late, and weak films let them warm the tyre more.

Times and amounts hold the truth as often as stated.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import solve_banded

from tyrefem.diagnose.heat.acting import ActingHeat, ActingSource, about_point, best_point, repeated
from tyrefem.diagnose.heat.courses import Course, CourseGrid, constant, courses
from tyrefem.diagnose.heat.evidence import ProjectedData
from tyrefem.diagnose.heat.sources import EstimatedSource, Place
from tyrefem.diagnose.law.evidence import LawData, law_data
from tyrefem.diagnose.law.heat_law import PlaceLaw, place_law
from tyrefem.diagnose.law.terms import DriveVariables, drive_variables, fine_times, law_terms
from tyrefem.diagnose.unknowns.heat_patches import ALL_LAYERS
from tyrefem.diagnose.unknowns.unknown import Unknown

Array = NDArray[np.float64]
#: Speeds of the runs, m/s. Readings, s. Heat as the model has it, K; noise, K.
SPEEDS, READ, HEAT, NOISE, SD = (8.0, 12.0, 16.0), np.linspace(15.0, 900.0, 60), 40.0, 0.5, 3.0
#: Share of the source at each sensor; time constants of wall and sensors, s, and their standard deviations.
SHARES, WALL, WALL_SD, LAG, LAG_SD = (1.0, 0.2, 0.1), 150.0, 15.0, 30.0, 20.0
FINE = np.linspace(0.0, 900.0, 901)
#: A sensor is late by 2 s at least.
LEAST = np.array([-5.0, *[(2.0 - LAG) / LAG_SD] * len(SHARES)])
GRID = CourseGrid(
    ("a", "b", "c"), (np.linspace(0.0, 900.0, 25),) * 3, ((("rolling", 0.0, 900.0),),) * 3, lambda run, _: SPEEDS[run]
)
#: Heat of the model by sensor, K: the first one sees hardly anything but the source.
OF_MODEL = (0.02, 1.0, 0.6)


def delayed(course: Array, time: float) -> Array:
    """A first-order rise (n_fine,) after a course (n_fine,)."""
    kept = np.exp(-1.0 / time)
    # rise[i] = kept * rise[i - 1] + (1 - kept) * (course[i] + course[i - 1]) / 2: a matrix of two diagonals.
    rises = np.append(0.0, (1 - kept) * (course[1:] + course[:-1]) / 2)
    return np.asarray(solve_banded((1, 0), np.array([[1.0], [-kept]]) * np.ones(len(course)), rises))


def readings(x: Array, courses_by_run: list[Array]) -> Array:
    """Whitened readings; x: wall and three sensors, in standard deviations: how late each is."""
    rows = []
    for course in courses_by_run:
        for sensor, share in enumerate(SHARES):
            heat = OF_MODEL[sensor] * HEAT + share * course
            lag = max(LAG + LAG_SD * x[1 + sensor], 1.0)
            rise = delayed(delayed(heat * (FINE > 0), WALL + WALL_SD * x[0]), lag)
            rows.append(np.interp(READ, FINE, rise) / NOISE)
    return np.concatenate(rows)


def slopes(x: Array, by_run: list[Array]) -> Array:
    """(n, 4) differences of the readings."""
    steps = 0.02 * np.eye(len(x))
    return np.column_stack([(readings(x + h, by_run) - readings(x - h, by_run)) / 0.04 for h in steps])


def responses() -> Array:
    """(n, n_knots) of the source at x = 0."""
    columns, nothing = [], [np.zeros(len(FINE))] * len(SPEEDS)
    none = readings(np.zeros(4), nothing)
    for run, knots in enumerate(GRID.knots):
        for hat in np.eye(len(knots)):
            with_hat = list(nothing)
            with_hat[run] = np.interp(FINE, knots, hat)
            columns.append(readings(np.zeros(4), with_hat) - none)
    return np.column_stack(columns)


COLUMNS = responses()
PLACE = Place(0.06, ALL_LAYERS, SD, True, COLUMNS)
NONE = [np.zeros(len(FINE))] * len(SPEEDS)


def begun(data: ProjectedData) -> Course:
    """The beginning that explains the data best."""
    late = [course for course in courses(GRID) if course.kind == "begins"]
    statistics = data.with_sources(COLUMNS)
    return max(late, key=lambda course: statistics.gain(SD * course.factor))


def drawn(seed: int) -> tuple[float, Array]:
    """Time of a beginning off every grid, and readings with noise of a late source; wall and sensors as drawn."""
    rng = np.random.default_rng(seed)
    time, x = float(rng.uniform(250.0, 500.0)), np.clip(rng.normal(size=4), LEAST, -LEAST)
    by_run = [0.4 * speed * (time <= FINE) for speed in SPEEDS]
    return time, readings(x, by_run) + rng.normal(size=len(COLUMNS))


def law_variables() -> DriveVariables:
    """What varies over the runs: the speed."""
    rows = [np.array([[speed], [12e3], [5e5], [0.03], [25.0]]) * np.ones(len(t))
            for speed, t in zip(SPEEDS, fine_times(GRID), strict=True)]  # fmt: skip
    return drive_variables(GRID, rows)


def estimated(measured: Array) -> tuple[PlaceLaw, PlaceLaw, EstimatedSource]:
    """The law about x = 0; the same law and the source, dated about a point where the source acts."""
    at = np.zeros(4)
    first = ProjectedData(measured - readings(at, NONE), slopes(at, NONE), np.ones(4))
    variables = law_variables()

    def of_place(data: ProjectedData) -> LawData:
        return law_data(data, COLUMNS, SD, variables.hats)

    def again(heat: ActingHeat) -> tuple[ActingHeat, float, float]:
        data = replace(heat.data, weight=1.0)
        point = best_point(data, LEAST, -LEAST, heat.entries, GRID)
        by_run = [acting.course(FINE) for acting in point.sources[0]]
        r = measured - readings(point.x, by_run)
        there = about_point(data.sd, point, r, slopes(point.x, by_run), heat.entries, GRID)
        return ActingHeat.of(there, heat.entries, GRID), float(r @ r), point.misfit

    law = place_law(of_place(first), variables, law_terms(variables), inside=True)
    acting = repeated(ActingHeat(first, ((PLACE, begun(first)),), ()), again)
    (source,) = acting.sources
    return law, law.as_it_acts(of_place(acting.data), variables, inside=True), source


def test_times_of_a_switch_hold_the_truth_as_often_as_stated_where_sensors_may_be_late() -> None:
    """About x = 0, where nothing of the source is late, most intervals of two standard deviations miss it."""
    before, after, of_source = [], [], []
    for seed in range(16):
        time, measured = drawn(seed)
        law, dated, source = estimated(measured)
        assert law.fit.switch.kind == dated.fit.switch.kind == "begins"
        assert dated.fit.terms == law.fit.terms
        before.append(abs(law.time - time) / law.time_sd)
        after.append(abs(dated.time - time) / dated.time_sd)
        of_source.append(abs(source.time - time) / source.time_sd)
    assert np.mean(np.array(before) < 2) < 0.6
    for deviations in (np.array(after), np.array(of_source)):
        assert np.mean(deviations < 2) > 0.85
        assert deviations.max() < 4


def test_a_law_without_a_time_gets_its_amplitude_where_it_acts() -> None:
    variables = law_variables()
    steady = [0.4 * speed * np.ones(len(FINE)) for speed in SPEEDS]

    def of_place(measured: Array) -> LawData:
        data = ProjectedData(measured - readings(np.zeros(4), NONE), slopes(np.zeros(4), NONE), np.ones(4))
        return law_data(data, COLUMNS, SD, variables.hats)

    stated = of_place(readings(np.zeros(4), steady))
    law = place_law(stated, variables, law_terms(variables), inside=True)
    assert np.isnan(law.time)
    same = law.as_it_acts(stated, variables, inside=True)
    assert (same.amplitude, same.sd) == pytest.approx((law.amplitude, law.sd), rel=1e-9)
    halved = law.as_it_acts(of_place(readings(np.zeros(4), [course / 2 for course in steady])), variables, inside=True)
    assert halved.fit == law.fit
    assert halved.amplitude == pytest.approx(law.amplitude / 2, rel=0.02)


def test_the_model_about_a_point_gives_the_readings_there() -> None:
    time, measured = drawn(3)
    at = np.zeros(4)
    data = ProjectedData(measured - readings(at, NONE), slopes(at, NONE), np.ones(4))
    entries = [(PLACE, begun(data))]
    point = best_point(data, np.full(4, -np.inf), np.full(4, np.inf), entries, GRID)
    (acting,) = point.sources
    assert [each.begins for each in acting] == [pytest.approx(time, abs=40.0)] * 3
    assert acting[0].strength < acting[1].strength < acting[2].strength
    by_run = [each.course(FINE) for each in acting]
    r, J = measured - readings(point.x, by_run), slopes(point.x, by_run)
    model = about_point(data.sd, point, r, J, entries, GRID)
    q = np.concatenate(GRID.sampled(lambda run, t: acting[run].course(t)))
    assert model.data - J @ point.x - COLUMNS @ q == pytest.approx(r)


def test_a_source_of_one_phase_acts_in_it() -> None:
    phases = replace(GRID, phases=((("warm", 0.0, 300.0), ("hot", 300.0, 900.0)),) * 3)
    course = next(course for course in courses(phases) if course.kind == "phase hot")
    data = ProjectedData(COLUMNS @ (4.0 * course.strength), np.zeros((len(COLUMNS), 1)), np.ones(1))
    free = np.full(1, np.inf)
    (acting,) = best_point(data, -free, free, [(PLACE, course)], phases).sources
    assert [(each.begins, each.ends) for each in acting] == [(300.0, 900.0)] * 3
    assert [each.strength for each in acting] == pytest.approx([4.0] * 3, rel=0.1)


def test_a_source_is_stated_with_its_times() -> None:
    patch = Unknown("effects.missing-heat.60 mm.heat", 1.0, effect="missing-heat", choice=(("station", "60 mm"),))
    assert ActingSource(2.0).unknown(patch) == patch
    late = ActingSource(2.0, np.float64(300.04), np.float64(600.0)).unknown(patch)  # type: ignore[arg-type]
    assert late.choice == (("station", "60 mm"), ("begins", "300.0 s"), ("ends", "600.0 s"))
    assert late.key == "effects.missing-heat.60 mm.begins 300.0 s.ends 600.0 s.heat"


def with_film(film: float, courses_by_run: list[Array]) -> Array:
    """Whitened readings with a film exp(0.2 ``film``) times as strong."""
    return np.asarray(readings(np.zeros(4), courses_by_run) * np.exp(-0.2 * film))


def film_slope(film: float, by_run: list[Array]) -> Array:
    """(n, 1) differences of the readings."""
    return ((with_film(film + 0.02, by_run) - with_film(film - 0.02, by_run)) / 0.04)[:, None]


def steady_amounts(measured: Array) -> tuple[EstimatedSource, EstimatedSource]:
    """Amount of a constant source about no source, and about the point where it acts."""
    first = ProjectedData(measured - with_film(0.0, NONE), film_slope(0.0, NONE), np.ones(1))
    steady = next(course for course in courses(GRID) if course.kind == "constant")
    free = np.full(1, np.inf)

    def again(heat: ActingHeat) -> tuple[ActingHeat, float, float]:
        data = replace(heat.data, weight=1.0)
        point = best_point(data, -free, free, heat.entries, GRID)
        by_run = [acting.course(FINE) for acting in point.sources[0]]
        (film,) = point.x
        r = measured - with_film(film, by_run)
        there = about_point(data.sd, point, r, film_slope(film, by_run), heat.entries, GRID)
        return ActingHeat.of(there, heat.entries, GRID), float(r @ r), point.misfit

    entries = ((PLACE, steady),)
    (before,), (after,) = (
        ActingHeat.of(first, entries, GRID).sources,
        repeated(ActingHeat(first, entries, ()), again).sources,
    )
    return before, after


@pytest.mark.parametrize("film", [-2.0, 2.0])
def test_amounts_hold_the_truth_where_a_film_is_far_from_what_was_stated(film: float) -> None:
    """About no source the response to it is that of the stated film, off by the film's factor."""
    amount, by_run = 5.0, [np.full(len(FINE), 5.0)] * len(SPEEDS)
    before, after = [], []
    for seed in range(8):
        noise = np.random.default_rng(seed).normal(size=len(COLUMNS))
        first, acting = steady_amounts(with_film(film, by_run) + noise)
        before.append((first.amount - amount) / first.sd)
        after.append((acting.amount - amount) / acting.sd)
    assert np.mean(np.abs(before)) > 5
    assert np.mean(np.abs(after)) < 1.5


def test_a_phase_named_as_a_course_does_not_limit_this_course() -> None:
    phases = ((("constant", 0.0, 600.0), ("cooling", 600.0, 900.0)),)
    grid = CourseGrid(("A",), (np.linspace(0.0, 900.0, 4),), phases, lambda run, t: 10.0)
    place = Place(0.06, "outer surface", 1.0, False, np.eye(4))
    data = ProjectedData(np.array([1.0, 1.0, 3.0, 3.0]), np.zeros((4, 0)), np.zeros(0))
    course = constant(grid)
    point = best_point(data, np.zeros(0), np.zeros(0), [(place, course)], grid)
    (acting,) = point.sources[0]
    assert (acting.begins, acting.ends) == (-np.inf, np.inf)
