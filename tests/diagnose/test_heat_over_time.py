"""Sources and sinks over time: place, sign and course by evidence, on linear problems made here."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from tyrefem.diagnose.heat.courses import CourseGrid, courses
from tyrefem.diagnose.heat.evidence import ProjectedData
from tyrefem.diagnose.heat.sources import Place, UnknownSource, place_shares, pursuit, timed, told_courses
from tyrefem.diagnose.heat.values import values_with_sources
from tyrefem.diagnose.numbers import percent
from tyrefem.diagnose.unknowns.heat_patches import ALL_LAYERS, INNER, OUTER
from tyrefem.diagnose.unknowns.unknown import Unknown
from tyrefem.diagnose.words.heat import course_words, inside_share, is_told, source_amount

Array = NDArray[np.float64]
TIMES = np.linspace(15.0, 900.0, 60)
#: (sensor) share of a source at each station that reaches the sensor.
STATIONS = {0.02: [1.0, 0.4, 0.1, 0.0], 0.06: [0.2, 0.5, 1.0, 0.3], 0.10: [0.0, 0.1, 0.5, 1.0]}
#: Time constant of the rise, s: heat near a surface leaves sooner.
DELAY = {ALL_LAYERS: 200.0, OUTER: 60.0, INNER: 90.0}
SD = 3.0


def grid(knots: int = 19, runs: int = 2) -> CourseGrid:
    """Runs of 900 s at 8 and 12 m/s."""
    names = ("slow", "fast")[:runs]
    return CourseGrid(
        names, (np.linspace(0.0, 900.0, knots),) * runs, ((("rolling", 0.0, 900.0),),) * runs,
        lambda run, _: (8.0, 12.0)[run],
    )  # fmt: skip


def response(station: float, where: str, strength: Array, fine: Array) -> Array:
    """(n_sensors n_times,) K: first-order rise of every sensor for a strength over time."""
    delay = DELAY.get(where, DELAY[ALL_LAYERS])
    step, rise = fine[1] - fine[0], np.zeros(len(fine))
    for i in range(1, len(fine)):
        rise[i] = rise[i - 1] + step * (strength[i] - rise[i - 1]) / delay
    here = np.interp(TIMES, fine, rise)
    return np.concatenate([share * here for share in STATIONS[station]])


def place(station: float, where: str, runs: CourseGrid) -> Place:
    """A place with its responses to hats."""
    fine, count = np.linspace(0.0, 900.0, 901), len(TIMES) * 4
    columns = np.zeros((count * len(runs.names), runs.size))
    for number, (part, knots) in enumerate(zip(runs.parts(), runs.knots, strict=True)):
        hats = [response(station, where, np.interp(fine, knots, hat), fine) for hat in np.eye(len(knots))]
        columns[number * count : (number + 1) * count, part] = np.column_stack(hats) / 0.3
    return Place(station, where, SD, where not in (OUTER, INNER), columns)


def readings(strengths: list[Array], station: float, where: str, seed: int) -> ProjectedData:
    """Whitened data of a source with a strength over time (K) in every run; noise 0.3 K; unknown offsets of sensors."""
    fine = np.linspace(0.0, 900.0, 901)
    clean = np.concatenate([response(station, where, strength, fine) for strength in strengths])
    offsets = np.vstack([np.kron(np.eye(4), np.ones((len(TIMES), 1)))] * len(strengths))
    noise = np.random.default_rng(seed).normal(0.0, 1.0, len(clean))
    return ProjectedData(clean / 0.3 + noise, offsets / 0.3, np.full(4, 0.5))


def source(
    data: ProjectedData, runs: CourseGrid, wheres: tuple[str, ...] = (ALL_LAYERS, OUTER, INNER)
) -> UnknownSource:
    """The first source that the data show, with its course."""
    places = [place(station, where, runs) for station in STATIONS for where in wheres]
    shares = place_shares(data, places, [], runs)
    chosen = next(each for each in places if (each.station, each.where) == next(iter(shares)))
    return timed(data, chosen, [], runs, shares)[0]


def after(time: float) -> Array:
    """1 from a time on."""
    return (np.linspace(0.0, 900.0, 901) >= time).astype(float)


@pytest.mark.parametrize("seed", range(4))
def test_a_source_that_begins_late_is_dated(seed: int) -> None:
    shown = source(readings([4.0 * after(300.0)] * 2, 0.06, ALL_LAYERS, seed), grid())
    assert (shown.station, shown.where, shown.kind) == (0.06, ALL_LAYERS, "begins")
    assert shown.kinds["begins"] > 0.9
    assert abs(shown.time - 300.0) < 3.5 * shown.time_sd
    assert shown.time_sd < 20.0
    assert shown.amount == pytest.approx(4.0, abs=4 * shown.sd)
    assert course_words(shown).startswith("It begins at ")


def test_the_free_course_rises_where_the_source_begins() -> None:
    shown = source(readings([4.0 * after(450.0)] * 2, 0.06, ALL_LAYERS, 9), grid())
    knots, early, late = grid().knots[0], shown.strength[0][:7].mean(), shown.strength[0][12:].mean()
    assert knots[7] < 450.0 < knots[12]
    assert abs(early) < 0.6
    assert late == pytest.approx(4.0, abs=0.8)


def test_a_sink_at_the_surface_has_its_sign_and_place() -> None:
    shown = source(readings([-3.0 * after(0.0)] * 2, 0.10, OUTER, 1), grid())
    assert (shown.station, shown.where) == (0.10, OUTER)
    assert is_told(shown)
    assert shown.amount < 0
    assert shown.clear
    assert shown.amount == pytest.approx(-3.0, abs=4 * shown.sd)
    assert shown.kinds["constant"] > 0.5


def test_a_source_in_one_run_only_is_said_to_be_that() -> None:
    shown = source(readings([0.0 * after(0.0), 6.0 * after(0.0)], 0.02, ALL_LAYERS, 2), grid())
    assert shown.kind == "run fast"
    assert shown.kinds["run fast"] > 0.85
    assert course_words(shown) in (
        "It acts in fast only",
        f"Probably it acts in fast only ({percent(shown.kinds[shown.kind])})",
    )


@pytest.mark.parametrize("seed", range(3))
def test_a_source_in_a_part_of_one_run_is_clear_where_it_acts(seed: int) -> None:
    """Its mean over both runs hardly differs from zero, though the data show it: run and time stand with the amount."""
    shown = source(readings([0.0 * after(0.0), 4.0 * (after(300.0) - after(500.0))], 0.06, ALL_LAYERS, seed), grid())
    assert shown.kind == "free"
    assert shown.gain > 100.0
    assert shown.clear
    assert shown.at is not None
    run, time = shown.at
    assert run == "fast"
    assert 300.0 < time < 500.0
    assert shown.amount == pytest.approx(4.0, abs=3 * shown.sd)
    assert source_amount(shown).endswith(f"(run fast at {time:.0f} s)")


def test_a_free_course_with_a_clear_mean_has_this_mean() -> None:
    """Heat in two waves, in both runs."""
    wave = 4.0 * (1 + np.sin(np.linspace(0.0, 4 * np.pi, 901)))
    shown = source(readings([wave, wave], 0.06, ALL_LAYERS, 3), grid())
    assert (shown.kind, shown.at) == ("free", None)
    assert shown.clear


def test_a_source_in_proportion_to_the_speed() -> None:
    shown = source(readings([2.0 * after(0.0), 3.0 * after(0.0)], 0.02, ALL_LAYERS, 2), grid())
    assert shown.kinds["speed"] > shown.kinds["constant"]


def test_layers_and_surfaces_that_the_data_do_not_tell_apart_are_not_named() -> None:
    runs = grid()
    data = readings([3.0 * after(0.0)] * 2, 0.06, ALL_LAYERS, 4)
    # Two layers with the response of the whole thickness: the data cannot tell them.
    shown = source(data, runs, (ALL_LAYERS, "carcass", "sidewall", OUTER))
    assert is_told(shown)
    assert inside_share(shown) > 0.9
    assert shown.depths["carcass"] == pytest.approx(shown.depths["sidewall"])
    assert max(shown.depths.values()) < 0.9
    # A surface with the same response: not even inside and surface are told apart.
    DELAY[INNER], kept = DELAY[ALL_LAYERS], DELAY[INNER]
    try:
        shown = source(data, runs, (ALL_LAYERS, INNER))
    finally:
        DELAY[INNER] = kept
    assert not is_told(shown)
    assert shown.depths[INNER] == pytest.approx(0.5)


@pytest.mark.parametrize("seed", range(5))
def test_noise_alone_shows_no_clear_source(seed: int) -> None:
    data = readings([0.0 * after(0.0)] * 2, 0.06, ALL_LAYERS, seed)
    shown = source(data, grid())
    assert abs(shown.amount) < 3 * shown.sd
    assert shown.gain < 1.0
    assert max(shown.kinds.values()) < 0.9


def test_two_sources_are_two_and_one_is_one() -> None:
    runs = grid()
    places = [place(station, where, runs) for station in STATIONS for where in (ALL_LAYERS, OUTER)]
    heated = readings([4.0 * after(0.0)] * 2, 0.06, ALL_LAYERS, 5)
    assert len(pursuit(heated, places, runs, 3, 3.0)) == 1
    cooled = readings([-3.0 * after(0.0)] * 2, 0.10, OUTER, 6)
    both = ProjectedData(heated.data + cooled.data, heated.jacobian, heated.sd)
    chosen = pursuit(both, places, runs, 3, 3.0)
    assert {(entry.station, entry.where) for entry, _ in chosen} == {(0.06, ALL_LAYERS), (0.10, OUTER)}


def test_the_evidence_is_that_of_the_dense_gaussian() -> None:
    rng = np.random.default_rng(0)
    J, L, data, sd = rng.normal(size=(12, 3)), rng.normal(size=(12, 2)), rng.normal(size=12), np.array([0.5, 1.0, 2.0])

    def dense(covariance: Array) -> float:
        return float(-data @ np.linalg.solve(covariance, data) / 2 - np.linalg.slogdet(covariance)[1] / 2)

    for weight in (1.0, 0.4):
        projected = ProjectedData(data, J, sd, weight)
        none = np.eye(12) / weight + (J * sd**2) @ J.T
        assert projected.log_evidence == pytest.approx(dense(none))
        gain = projected.with_sources(L).gain(np.eye(2))
        assert gain == pytest.approx(dense(none + L @ L.T) - dense(none))


def test_values_with_a_source_are_those_of_least_squares() -> None:
    runs = grid()
    data = readings([4.0 * after(300.0)] * 2, 0.06, ALL_LAYERS, 3)
    here = place(0.06, ALL_LAYERS, runs)
    begins = next(course for course in courses(runs) if course.time == 300.0 and course.kind == "begins")
    nuisance = tuple(Unknown(f"offset-{number}", 0.5) for number in range(4))
    heat = Unknown("heat", SD)
    values, sd = values_with_sources(data, nuisance, [(heat, here, begins)])
    J = np.column_stack([data.jacobian, here.columns @ begins.strength])
    prior = np.diag([0.5**-2] * 4 + [SD**-2])
    exact = np.linalg.solve(J.T @ J + prior, J.T @ data.data)
    assert list(values.values()) == pytest.approx(list(exact))
    assert values[heat] == pytest.approx(4.0, abs=4 * sd[heat])


def test_courses_that_the_rolling_makes_equal_are_one() -> None:
    # Heat acts while the tyre rolls, up to 600 s: what ends later is constant heat, and so is heat in that phase.
    runs = CourseGrid(
        ("slow",), (np.linspace(0.0, 900.0, 19),), ((("rolling", 0.0, 600.0), ("rest", 600.0, 900.0)),),
        lambda _, t: 8.0 if t < 600 else 0.0,
    )  # fmt: skip
    whole = place(0.06, ALL_LAYERS, runs)
    rolling = replace(whole, columns=whole.columns * (runs.knots[0] < 600.0))
    kinds = [(course.kind, course.time) for course in told_courses(rolling, runs)]
    assert ("constant", None) in kinds
    assert "phase rolling" not in {kind for kind, _ in kinds}
    assert "phase rest" not in {kind for kind, _ in kinds}
    assert max(time for kind, time in kinds if kind == "ends" and time is not None) < 600.0
    assert {kind for kind, _ in kinds} >= {"begins", "ends", "grows", "free"}
    # A flux through a surface acts at rest too, so its phases differ.
    flux = [course.kind for course in told_courses(place(0.06, OUTER, runs), runs)]
    assert {"phase rolling", "phase rest"} <= set(flux)
