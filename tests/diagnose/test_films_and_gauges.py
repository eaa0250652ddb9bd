"""Effects beside another strain energy, other gauges and other speed laws of films; models that the data exclude."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, cast

import numpy as np
import pytest
from formula import STATED, Case, case, effect

import tyrefem as tf
from tyrefem.diagnose.beside.best_fit import fit_beside
from tyrefem.diagnose.beside.discrepancy import ENERGY, FURTHER, NONE, READINGS, Discrepancy, without
from tyrefem.diagnose.beside.ranked_beside import RankedBeside
from tyrefem.diagnose.beside.ranking import robustness
from tyrefem.diagnose.beside.robustness import Robustness, UnderDiscrepancy
from tyrefem.diagnose.fitting.criterion import LogEvidence
from tyrefem.diagnose.fitting.fits import first_fits
from tyrefem.diagnose.fitting.forward_selection import ForwardSelection
from tyrefem.diagnose.fitting.selection import SelectionProblem
from tyrefem.diagnose.inference.shared_error import SharedError
from tyrefem.diagnose.settings import DEFAULT
from tyrefem.diagnose.unknowns.candidates import SetPrior
from tyrefem.diagnose.unknowns.energy_shapes import courses, energy_shapes
from tyrefem.diagnose.unknowns.gauges import gauges
from tyrefem.diagnose.unknowns.unknown import Unknown, with_values
from tyrefem.diagnose.verdicts.partly import beside_discrepancies
from tyrefem.diagnose.verdicts.verdict import PARTLY, UNEXPLAINED, Judgement, judge, ranked
from tyrefem.inputs.name_patterns import SCALES

NO_EFFECTS = cast(Any, type("Study", (), {"card": type("Card", (), {"effects": ()})}))
SHAPES = energy_shapes(NO_EFFECTS, DEFAULT)
GAUGE = Unknown(f"{SCALES}.tread", DEFAULT.gauge_sd, keys=(f"{SCALES}.tread",))
HOT, COLD, FILM = effect("hot", 10.0), effect("cold", 10.0), effect("outside-film-speed", 0.3)
EVERY = (HOT, COLD, FILM)
SETTINGS = replace(DEFAULT, largest=2)
S = np.linspace(0.0, 1.0, 160)


def law(values: Mapping[str, float]) -> np.ndarray:
    """40 K of heat with a factor along the meridian, two bumps, and waves of a gauge and of a film's speed law."""
    log_factor = courses(S, SHAPES) @ [values.get(unknown.key, 0.0) for unknown in SHAPES]
    heat = 40.0 * (1 + S) * np.exp(log_factor)
    hot, cold = (np.exp(-(((S - at) / 0.06) ** 2) / 2) for at in (0.2, 0.85))
    bumps = values.get("hot", 0.0) * hot + values.get("cold", 0.0) * cold
    waves = 60.0 * values.get(GAUGE.key, 0.0) * np.sin(40 * S) + 30.0 * values.get(FILM.key, 0.0) * np.cos(31 * S)
    return np.asarray(heat + bumps + waves)


def measured(hot: float) -> Case:
    """Readings of a tyre with another strain energy, a tread 14 % thicker and another speed law of its film."""
    noise = np.random.default_rng(3).normal(size=len(S))
    steep = 40.0 * (1 + S) * 0.25 * np.tanh((0.45 - S) / 0.2)
    readings = law({"hot": hot, GAUGE.key: 0.14, FILM.key: -0.4}) + steep + noise
    return case(law, readings, EVERY, SETTINGS, further=(*SHAPES, GAUGE))


def selection(data: Case) -> SelectionProblem:
    prior = SetPrior(EVERY, 0.5, SETTINGS.size_shares)
    return SelectionProblem(data.residuals, data.predictions, EVERY, prior, LogEvidence())


def searched(data: Case) -> tuple[SelectionProblem, Judgement, Robustness]:
    """The sets beside every discrepancy model, as if no set explained the data."""
    problem = selection(data)
    scored = problem.settled(ForwardSelection().search(problem))
    judgement = replace(judge(ranked(scored), lambda members: None, SETTINGS), verdict=UNEXPLAINED)
    return problem, judgement, robustness(problem, scored, certain=False, explained=False)


@pytest.mark.parametrize("hot", [25.0, 0.0])
def test_an_effect_is_named_beside_gauges_and_films_that_differ_too(hot: float) -> None:
    data = measured(hot)
    problem, judgement, robust = searched(data)
    leading = robust.models[0]
    assert leading.name == ENERGY
    assert FURTHER in leading.words
    assert leading.explains
    # The film's law is a part of the discrepancy: its effect has a probability and an amount, but no fit of its own.
    assert leading.named[FILM.key] > 0.99
    assert not any(FILM in members for members in leading.fits)
    assert leading.named.get("cold", 0.0) < 0.5
    assert leading.allowed == (FILM,)
    x, sd = leading.values[FILM.key]
    assert abs(x + 0.4) < 3 * sd < 0.2
    revision = beside_discrepancies(judgement, robust, SETTINGS)
    assert revision.members == ((HOT, FILM) if hot else (FILM,))
    assert revision.verdict == PARTLY
    if hot:
        low, high = robust.interval(HOT.amplitudes[0])
        assert low < hot < high
    # Fitted as an effect, the film's law takes what the discrepancy no longer allows for.
    (alone,) = first_fits(data.residuals, data.predictions, [revision.members])
    fit = fit_beside(problem, leading, alone)
    assert abs(fit.values[FILM.amplitudes[0]] + 0.4) < 3 * sd
    bare = fit_beside(problem, replace(leading, fits={}), alone)
    assert abs(bare.values[FILM.amplitudes[0]] + 0.4) < 3 * sd
    assert leading.discrepancy is not None
    assert without(leading.discrepancy, FILM.amplitudes).further == (GAUGE,)


def test_a_film_without_whose_law_held_out_runs_are_predicted_better_is_not_named() -> None:
    data = measured(25.0)
    _, judgement, robust = searched(data)
    leading = robust.models[0]
    fits = {part: replace(fit, held_out=-50.0 if HOT in part else -60.0) for part, fit in leading.fits.items()}
    for without_film, named in ((-52.0, (HOT, FILM)), (-48.0, (HOT,))):
        model = replace(leading, fits=fits, held_out_without={FILM.key: without_film})
        models = (model, *robust.models[1:])
        revision = beside_discrepancies(judgement, replace(robust, models=models), SETTINGS)
        assert revision.members == named


def test_a_set_is_fitted_from_a_larger_one_whose_further_effect_is_zero() -> None:
    data = measured(25.0)
    problem = selection(data)
    beside = RankedBeside(problem, Discrepancy(NONE, 0.0))
    (whole,) = first_fits(data.residuals, data.predictions, [(HOT, COLD)])
    beside._take([whole])
    beside.estimates = {(HOT,): beside.score((HOT, COLD))}
    beside.further()
    (alone,) = first_fits(data.residuals, data.predictions, [(HOT,)])
    fit = beside.fits[(HOT,)]
    assert fit.members == (HOT,)
    assert fit.log_evidence == pytest.approx(alone.log_evidence, abs=0.5)


def test_a_set_that_ended_on_its_way_names_no_effect() -> None:
    """A base number far off, in a law that bends: after the first steps the effect leads, at their ends it does not."""

    def bent(values: Mapping[str, float]) -> np.ndarray:
        bump = np.exp(-(((S - 0.2) / 0.2) ** 2) / 2)
        return np.asarray(
            40.0 * np.exp(2.5 * np.sin(3 * S) * values.get(STATED.key, 0.0)) + values.get("hot", 0) * bump
        )

    noise = np.random.default_rng(1).normal(size=len(S))
    data = case(bent, bent({STATED.key: 0.6}) + noise, (HOT,), SETTINGS)
    prior = SetPrior((HOT,), 0.5, SETTINGS.size_shares)
    problem = SelectionProblem(data.residuals, data.predictions, (HOT,), prior, LogEvidence())
    beside = RankedBeside(problem, Discrepancy(NONE, 0.0))
    beside._take(first_fits(data.residuals, data.predictions, [(), (HOT,)]))
    assert beside.best.members == (HOT,)
    assert not any(fit.converged for fit in beside.fits.values())
    beside.further()
    assert beside.best.members == ()
    assert beside.best.converged
    assert beside.best.p_value > 0.1
    assert beside.best.values[STATED] == pytest.approx(0.6, abs=0.01)


def under(name: str, probability: float, hot: float, size: float = 0.0, p_value: float = 0.5) -> UnderDiscrepancy:
    fits = {(): type("Fit", (), {"p_value": p_value})}
    return UnderDiscrepancy(name, size, name, probability, {"hot": hot}, (), {}, cast(Any, fits))


def test_a_model_that_the_data_exclude_has_no_veto() -> None:
    other = under(READINGS, 1e-9, 0.1)
    assert Robustness((under(ENERGY, 1.0, 0.97), other)).least("hot") == 0.97
    # Not excluded; or what leads does not explain the data, or only with errors of the readings.
    assert Robustness((under(ENERGY, 1.0, 0.97), replace(other, probability=1e-4))).least("hot") == 0.1
    assert Robustness((under(ENERGY, 1.0, 0.97, p_value=1e-3), other)).least("hot") == 0.1
    assert Robustness((under(ENERGY, 1.0, 0.97, size=0.5), other)).least("hot") == 0.1
    assert Robustness((under(NONE, 1.0, 0.97), other)).least("hot") == 0.97


def test_coefficients_of_a_shared_error_are_those_of_the_joint_posterior() -> None:
    rng = np.random.default_rng(5)
    C, J, y = rng.normal(size=(9, 2)), rng.normal(size=(9, 3)), rng.normal(size=9)
    both = np.hstack([C, J])
    covariance = np.linalg.inv(np.eye(5) + both.T @ both)
    mean = covariance @ both.T @ y
    error = SharedError(C, np.zeros((0, 2)))
    slopes = error.whitened(J)
    of_x = np.linalg.inv(np.eye(3) + slopes.T @ slopes)
    x = of_x @ slopes.T @ error.whitened(y)
    c, sd = error.coefficients(error.whitened(y - J @ x), slopes, of_x)
    np.testing.assert_allclose(c, mean[:2], atol=1e-12)
    np.testing.assert_allclose(sd, np.sqrt(np.diag(covariance)[:2]), atol=1e-12)


def test_gauges_are_those_of_the_regions_that_the_study_does_not_state() -> None:
    study = tf.study("hidden-effect")
    known = gauges(study, DEFAULT)
    assert [unknown.key for unknown in known] == [f"{SCALES}.{region}" for region in study.section.regions]
    stated = study.replace({"uncertainty": {"section.parameters.thickness_scale.tread": "5 %"}})
    assert f"{SCALES}.tread" not in [unknown.key for unknown in gauges(stated, DEFAULT)]
    assert gauges(tf.study("passenger-205-55r16"), DEFAULT) == ()
    thicker = with_values(study, {known[0]: 0.05})
    s = [0.5 * study.section.line.length]
    inner, outer = thicker.section.total_thickness(s), study.section.total_thickness(s)
    assert inner[0] > outer[0]


def thin(values: Mapping[str, float]) -> np.ndarray:
    """A gauge whose response is nearly the bump of an effect."""
    bump = np.exp(-(((S - 0.2) / 0.07) ** 2) / 2)
    return law({**values, GAUGE.key: 0.0}) + 150.0 * values.get(GAUGE.key, 0.0) * bump


@pytest.mark.parametrize("gauge_sd", [DEFAULT.gauge_sd, 1e-6])
def test_an_effect_that_a_gauge_explains_as_well_is_not_named(gauge_sd: float) -> None:
    """A tread 14 % thinner than stated, beside another strain energy: half waves and the effect explain the readings,
    so the search asks for no gauge."""
    gauge = replace(GAUGE, sd=gauge_sd)
    noise = np.random.default_rng(3).normal(size=len(S))
    steep = 40.0 * (1 + S) * 0.25 * np.cos(2 * np.pi * S)
    data = case(thin, thin({GAUGE.key: 0.14}) + steep + noise, EVERY, SETTINGS, further=(*SHAPES, gauge))
    problem = selection(data)
    scored = problem.settled(ForwardSelection().search(problem))
    judgement = replace(judge(ranked(scored), lambda members: None, SETTINGS), verdict=UNEXPLAINED)
    for explained in (False, True):
        robust = robustness(problem, scored, certain=False, explained=explained)
        assert robust.models[0].name == ENERGY
        of_energy = [model for model in robust.models if model.name == ENERGY]
        assert [FURTHER in model.words for model in sorted(of_energy, key=lambda model: model.words)] == [False, True]
        named = beside_discrepancies(judgement, robust, SETTINGS).members
        assert named == (() if gauge_sd > 1e-3 else (HOT,))
