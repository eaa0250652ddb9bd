"""Laws of missing heat: exponents, switches and what the runs cannot tell, on linear problems made here."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from tyrefem.diagnose.heat.courses import CourseGrid
from tyrefem.diagnose.heat.evidence import ProjectedData
from tyrefem.diagnose.law.evidence import LawData, fitted_law, law_data, plain_switch
from tyrefem.diagnose.law.heat_law import Exponent, PlaceLaw, place_law
from tyrefem.diagnose.law.scatter import SeriesScatter
from tyrefem.diagnose.law.terms import WARM, DriveVariables, drive_variables, fine_times, law_terms, structures
from tyrefem.diagnose.words.law import law_formula

Array = NDArray[np.float64]
#: Run -> speed m/s, load N, pressure Pa.
APART = {"a": (8.0, 12e3, 5e5), "b": (16.0, 12e3, 6e5), "c": (12.0, 18e3, 5e5), "d": (9.0, 15e3, 7e5)}
CONFOUNDED = {"a": (8.0, 8e3, 5e5), "b": (12.0, 12e3, 5e5), "c": (16.0, 16e3, 5e5)}
KNOTS, SENSORS, END, DELAY, SD = 19, 4, 900.0, 200.0, 3.0
READ = np.linspace(15.0, END, 60)


def problem(runs: dict[str, tuple[float, float, float]], rest: float = END) -> tuple[DriveVariables, Array]:
    """The runs, at rest from a time on, and (n_data, m) responses of four sensors to hats."""
    values = list(runs.values())
    grid = CourseGrid(
        tuple(runs), (np.linspace(0.0, END, KNOTS),) * len(runs),
        ((("rolling", 0.0, rest), ("rest", rest, END + 1e-9)) if rest < END else (("rolling", 0.0, END),),) * len(runs),
        lambda run, t: values[run][0] if t < rest else 0.0,
    )  # fmt: skip
    rows = []
    for (speed, load, pressure), t in zip(values, fine_times(grid), strict=True):
        deflection = 0.03 * (load / 12e3) * (5e5 / pressure) ** 0.8
        ones = np.ones_like(t)
        moving = np.where((t < rest) | (rest >= END), speed, 0.0)
        rows.append(np.array([moving, load * ones, pressure * ones, deflection * ones, 25.0 * ones]))
    shares = np.array([1.0, 0.4, 0.1, 0.6])
    columns = np.zeros((len(runs) * SENSORS * len(READ), grid.size))
    fine = np.linspace(0.0, END, 901)
    for number, (part, knots) in enumerate(zip(grid.parts(), grid.knots, strict=True)):
        rises = []
        for hat in np.eye(KNOTS):
            rise, q = np.zeros(len(fine)), np.interp(fine, knots, hat)
            for i in range(1, len(fine)):
                rise[i] = rise[i - 1] + (q[i] - rise[i - 1]) / DELAY
            rises.append(np.kron(shares, np.interp(READ, fine, rise)))
        size = SENSORS * len(READ)
        columns[number * size : (number + 1) * size, part] = np.column_stack(rises) / 0.3
    return drive_variables(grid, rows), columns


def measured(
    variables: DriveVariables, columns: Array, strength: Callable[[DriveVariables], Array], seed: int
) -> LawData:
    """Whitened data of a source, with unknown offsets of sensors; noise 0.3 K."""
    q = variables.hats @ strength(variables)
    runs = len(variables.grid.names)
    offsets = np.vstack([np.kron(np.eye(SENSORS), np.ones((len(READ), 1)))] * runs) / 0.3
    noise = np.random.default_rng(seed).normal(size=len(columns))
    projected = ProjectedData(columns @ q + noise, offsets, np.full(SENSORS, 0.5))
    return law_data(projected, columns, SD, variables.hats)


def law(
    strength: Callable[[DriveVariables], Array],
    runs: dict[str, tuple[float, float, float]] = APART,
    seed: int = 0,
    rest: float = END,
    inside: bool = True,
    temperature: Callable[[DriveVariables], Array] | None = None,
) -> PlaceLaw:
    """The law that the readings of a source show."""
    variables, columns = problem(runs, rest)
    if inside:
        columns = columns * (variables.hats @ variables.rolling > 0.5)
    data = measured(variables, columns, strength, seed)
    terms = law_terms(variables, None if temperature is None else temperature(variables))
    return place_law(data, variables, terms, inside=inside)


@pytest.mark.parametrize("seed", range(4))
def test_exponents_of_speed_and_load_are_found_within_their_intervals(seed: int) -> None:
    shown = law(lambda v: 4.0 * (v.speed / 11.0) ** 1.5 * (v.load / 14e3) ** -0.8, seed=seed)
    assert shown.fit.terms == ("speed", "load")
    assert shown.fit.switch.kind == "no switch"
    speed, load = shown.exponent["speed"], shown.exponent["load"]
    assert abs(speed.mean - 1.5) < 3.5 * speed.sd
    assert abs(load.mean + 0.8) < 3.5 * load.sd
    assert speed.sd < 0.15
    assert load.sd < 0.3
    assert speed.narrowed
    assert load.narrowed
    amplitude = 4.0 * (speed.reference / 11.0) ** 1.5 * (load.reference / 14e3) ** -0.8
    assert shown.amplitude == pytest.approx(amplitude, abs=4 * shown.sd)


@pytest.mark.parametrize("seed", range(3))
def test_a_power_of_the_deflection_is_told_from_load_and_pressure_alone(seed: int) -> None:
    shown = law(lambda v: 4.0 * (v.speed / 11.0) * (v.deflection / 0.03) ** 2, seed=seed)
    assert shown.fit.terms == ("speed", "deflection")
    assert shown.exponent["deflection"].mean == pytest.approx(2.0, abs=4 * shown.exponent["deflection"].sd)


def test_constant_heat_has_no_terms() -> None:
    shown = law(lambda v: np.full(len(v.times), 4.0))
    assert shown.fit.terms == ()
    assert all(entry.probability < 0.5 for entry in shown.exponents)
    assert shown.switch_probabilities["no switch"] > 0.9


def test_variables_that_vary_together_are_named() -> None:
    shown = law(lambda v: 4.0 * (v.speed / 11.0) ** 1.5, CONFOUNDED)
    assert ("speed", "load") in shown.together
    assert "pressure" in shown.hardly
    assert "pressure" not in {entry.name for entry in shown.exponents}
    # The load explains as much as the speed: both laws are reported.
    laws = {shown.fit.terms, *(fit.terms for fit, _ in shown.alternatives)}
    assert len({terms for terms in laws if len(terms) == 1}) > 1


def test_two_terms_that_vary_together_keep_their_prior_along_the_difference() -> None:
    variables, columns = problem(CONFOUNDED)
    data = measured(variables, columns, lambda v: 4.0 * (v.speed / 11.0) ** 1.5, 1)
    terms = law_terms(variables)
    names = ["speed", "load"]
    fit = fitted_law(data, terms, names, plain_switch(len(variables.times)))
    # Known is the sum only; given it, the priors N(1, 1) and N(1, 1.5^2) leave the difference this sd.
    difference = np.array([1.0, -1.0])
    assert np.sqrt(difference @ fit.covariance @ difference) == pytest.approx(2 * 1.5 / np.hypot(1, 1.5), rel=0.05)
    assert fit.mean.sum() == pytest.approx(1.5, abs=0.3)


def test_a_beginning_is_dated_beside_a_power_of_speed() -> None:
    shown = law(lambda v: 5.0 * (v.speed / 11.0) ** 1.0 * (v.times >= 300.0))
    assert shown.fit.switch.kind == "begins"
    assert shown.switch_probabilities["begins"] > 0.9
    assert shown.time == pytest.approx(300.0, abs=max(3.5 * shown.time_sd, 8.0))
    assert shown.time_sd < 25.0
    assert shown.exponent["speed"].mean == pytest.approx(1.0, abs=4 * shown.exponent["speed"].sd)


def test_one_run_only() -> None:
    shown = law(lambda v: 5.0 * (v.run == 2))
    assert shown.fit.switch.kind == "run c"
    assert shown.switch_probabilities["run c"] > 0.9


@pytest.mark.parametrize(("kind", "on"), [("while rolling", True), ("at rest", False)])
def test_a_flux_while_rolling_or_at_rest(kind: str, on: bool) -> None:
    shown = law(lambda v: 6.0 * (v.rolling == on), rest=600.0, inside=False)
    assert max(shown.switch_probabilities, key=lambda name: shown.switch_probabilities[name]) in (
        kind, "phase rolling" if on else "phase rest",
    )  # fmt: skip
    assert shown.switch_probabilities.get("no switch", 0.0) < 0.01


def test_a_rate_of_temperature() -> None:
    def temperature(v: DriveVariables) -> Array:
        return np.asarray(25.0 + 60.0 * (1 - np.exp(-v.times / 250.0)) * (v.speed / 12.0))

    shown = law(
        lambda v: 8.0 * np.exp(-0.02 * (temperature(v) - 60.0)) * (v.speed / 11.0), temperature=temperature, seed=3
    )
    assert "temperature" in shown.fit.terms
    rate = shown.exponent["temperature"]
    assert rate.mean == pytest.approx(-0.02, abs=4 * rate.sd)
    assert rate.narrowed


def test_the_evidence_is_the_integral_over_amplitude_and_exponent() -> None:
    variables, columns = problem(APART)
    data = measured(variables, columns, lambda v: 3.0 * (v.speed / 11.0), 5)
    terms = law_terms(variables)
    switch = plain_switch(len(variables.times))
    fit = fitted_law(data, terms, ["speed"], switch)
    exponents = np.linspace(-4.0, 4.0, 1601)
    gains = np.array([data.gain(np.exp(x * terms.features["speed"])) for x in exponents])
    density = np.exp(gains - gains.max() - (exponents - 1) ** 2 / 2) / np.sqrt(2 * np.pi)
    exact = gains.max() + np.log(density.sum() * (exponents[1] - exponents[0]))
    assert fit.log_evidence == pytest.approx(exact, abs=0.05)


@pytest.mark.parametrize("seed", range(3))
def test_noise_alone_is_no_evidence_of_any_law(seed: int) -> None:
    variables, columns = problem(APART)
    data = measured(variables, columns, lambda v: np.zeros(len(v.times)), seed)
    shown = place_law(data, variables, law_terms(variables), inside=True)
    assert abs(shown.amplitude) < 3 * shown.sd
    assert shown.log_evidence - data.base < 1.0


@pytest.mark.parametrize("of_heat", [True, False])
@pytest.mark.parametrize("runs", [APART, CONFOUNDED, {"a": APART["a"]}])
def test_prior_probabilities_of_laws_sum_to_one(runs: dict[str, tuple[float, float, float]], of_heat: bool) -> None:
    variables, _ = problem(runs)
    temperature = np.linspace(25.0, 90.0, len(variables.times))
    terms = law_terms(variables, temperature, of_heat=of_heat)
    assert sum(structures(terms).values()) == pytest.approx(1.0)
    # Heat inside usually goes with the speed.
    speedy = sum(prior for names, prior in structures(terms).items() if "speed" in names)
    assert speedy == pytest.approx((0.8 if of_heat else 0.4) if len(runs) > 1 else 0.0)


def exponents_of_scatter(size: float, seeds: range) -> tuple[Array, Array, Array]:
    """Exponent of speed of several tables: mean, sd of noise alone, sd with the scatter of each sensor in each run.

    Every series has an error of this size (in noise sd) that its readings share, as a place of another shape leaves.
    """
    variables, columns = problem(APART)
    response = columns @ (variables.hats @ (4.0 * (variables.speed / 11.0) ** 1.5))
    series = tuple(slice(start, start + len(READ)) for start in range(0, len(columns), len(READ)))
    terms, rows = law_terms(variables), []
    for seed in seeds:
        rng = np.random.default_rng(seed)
        shared = size * np.repeat(rng.normal(size=len(series)), len(READ))
        noise = rng.normal(size=len(columns))
        projected = ProjectedData(response + shared + noise, np.zeros((len(columns), 1)), np.ones(1))
        data = law_data(projected, columns, SD, variables.hats)
        fit = fitted_law(data, terms, ["speed"], plain_switch(len(variables.times)))
        amplitude, _ = data.amplitude(fit.strength(dict(terms.features)))
        wide = SeriesScatter(projected, columns, series).widened(fit, amplitude, terms, variables.hats)
        rows.append((fit.mean[0], fit.sd[0], wide.sd[0]))
    mean, plain, wide_sd = np.array(rows).T
    return mean, plain, wide_sd


def test_errors_that_readings_share_in_time_widen_the_intervals_as_much_as_they_scatter_the_exponents() -> None:
    mean, plain, wide = exponents_of_scatter(3.0, range(40))
    assert plain.mean() < 0.35 * mean.std()
    assert wide.mean() == pytest.approx(mean.std(), rel=0.4)
    assert np.mean(np.abs(mean - 1.5) < 2 * wide) > 0.8
    assert np.mean(np.abs(mean - 1.5) < 2 * plain) < 0.6


def test_independent_noise_leaves_the_intervals_nearly_as_they_are() -> None:
    _, plain, wide = exponents_of_scatter(0.0, range(10))
    assert np.all(wide >= plain)
    assert wide.mean() < 1.3 * plain.mean()


def test_a_term_that_only_shared_errors_ask_for_is_no_part_of_the_law() -> None:
    """Without the scatter, errors that the readings of a series share choose a load or a temperature as well."""
    variables, columns = problem(APART)
    response = columns @ (variables.hats @ (4.0 * (variables.speed / 11.0) ** 1.5))
    series = tuple(slice(start, start + len(READ)) for start in range(0, len(columns), len(READ)))
    terms, false_terms = law_terms(variables), {False: 0, True: 0}
    for seed in range(6):
        rng = np.random.default_rng(seed)
        shared = 3.0 * np.repeat(rng.normal(size=len(series)), len(READ))
        values = response + shared + rng.normal(size=len(columns))
        projected = ProjectedData(values, np.zeros((len(columns), 1)), np.ones(1))
        data, scatter = law_data(projected, columns, SD, variables.hats), SeriesScatter(projected, columns, series)
        for scattered in (False, True):
            shown = place_law(data, variables, terms, inside=True, scatter=scatter if scattered else None)
            assert "speed" in shown.fit.terms
            false_terms[scattered] += len(set(shown.fit.terms) - {"speed"}) + (shown.fit.switch.kind != "no switch")
    assert false_terms[False] >= 6
    assert false_terms[True] <= 2


def test_the_formula_is_rounded_to_the_digits_of_its_deviations() -> None:
    shown = law(lambda v: 4.0 * (v.speed / 11.0) ** 1.5 * (v.load / 14e3) ** -0.8)
    fit = replace(shown.fit, terms=("speed", "load", WARM))
    exponents = (
        Exponent("speed", 1.5234, 0.0312, 1.0, True, 11.0),
        Exponent("load", -0.8123, 0.4, 1.0, True, 14e3),
        Exponent(WARM, -0.015, 0.0004, 1.0, True, 25.0),
    )
    assert law_formula(replace(shown, fit=fit, exponents=exponents)) == (
        "grows as speed^1.523 ± 0.031 × load^(-0.8 ± 0.4) × exp(-1.50 ± 0.04 %/K × temperature)"
    )
