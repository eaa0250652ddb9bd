"""The fit within a trust region, on made-up readings whose dependence on the unknowns is known."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest
from formula import STATED, Array, Case, case, effect
from scipy.optimize import minimize

from tyrefem.diagnose.fitting.fits import FittedSet, continued, first_fits
from tyrefem.diagnose.settings import DEFAULT, DiagnosisSettings

BENDING = effect("bending")
(AMPLITUDE,) = BENDING.unknowns
T = np.linspace(0.1, 1.0, 10)


def saturating(values: Mapping[str, float]) -> Array:
    """Linear in the base number, ever less sensitive to the effect, as a film is."""
    a, b = values.get(STATED.key, 0.0), values.get(AMPLITUDE.key, 0.0)
    return np.asarray(40 * a * T + 60 * np.tanh(b / 3) * T**2)


def at(a: float, b: float) -> dict[str, float]:
    return {STATED.key: a, AMPLITUDE.key: b}


def least(made: Case) -> float:
    """The smallest misfit there is, by a general minimiser."""

    def misfit(x: Array) -> float:
        r = made.measured - made.formula.law(at(*x))
        return float(r @ r + (x[0] / STATED.sd) ** 2 + (x[1] / AMPLITUDE.sd) ** 2)

    starts = [(a, b) for a in (-0.3, 0.3) for b in (0.5, 2.0, 4.0)]
    return float(min(minimize(misfit, start, method="Nelder-Mead", options={"xatol": 1e-7}).fun for start in starts))


def fitted(made: Case) -> FittedSet:
    first = first_fits(made.residuals, made.predictions, [(BENDING,)])
    return continued(made.residuals, made.predictions, first)[0]


def made_of(measured: Array, settings: DiagnosisSettings = DEFAULT) -> Case:
    return case(saturating, measured, (BENDING,), settings)


@pytest.mark.parametrize("true", [0.5, 3.0, 5.0])
def test_the_fit_ends_where_a_general_minimiser_does(true: float) -> None:
    noise = np.random.default_rng(3).normal(size=10)
    made = made_of(saturating(at(0.2, true)) + noise)
    fit = fitted(made)
    assert fit.converged
    assert fit.misfit == pytest.approx(least(made), abs=1.0), "half a unit, or so, is left to the linear model"
    assert fit.values[AMPLITUDE] == pytest.approx(true, abs=4 * fit.sd[AMPLITUDE])


def test_no_step_leaves_the_trust_region() -> None:
    made = made_of(saturating(at(0.2, 5.0)))
    fitted(made)
    # The tangent at x = 0 promises less than is needed there, far out more: b = 60 tanh(5/3)/20 would be 2.8.
    first = made.formula.points()[0]
    assert abs(first[STATED.key]) <= 3 * STATED.sd + 1e-9
    assert abs(first[AMPLITUDE.key]) <= 3 * AMPLITUDE.sd + 1e-9


def test_where_no_tyre_is_possible_the_fit_turns_back() -> None:
    def limited(values: Mapping[str, float]) -> Array:
        # The base number is a load that the tyre carries up to a tenth more than stated.
        return np.full(10, np.nan) if values.get(STATED.key, 0.0) > 0.1 else saturating(values)

    made = case(limited, saturating(at(0.09, 1.0)) + 4.0 * T, (BENDING,))
    fit = fitted(made)
    refused = [point for point in made.formula.points() if point[STATED.key] > 0.1]
    assert refused, "a case in which nothing impossible is tried proves nothing"
    assert np.isfinite(fit.misfit)
    assert fit.values[STATED] <= 0.1
    start = made.measured - limited({})
    assert fit.misfit < float(start @ start) / 2


def test_a_larger_set_starts_where_its_part_has_converged() -> None:
    noise = np.random.default_rng(5).normal(size=10)
    made = made_of(saturating(at(0.25, 0.0)) + noise)
    residuals, predictions = made.residuals, made.predictions
    (none,) = continued(residuals, predictions, first_fits(residuals, predictions, [()]))
    assert none.close
    made.formula.questions.clear()
    (warm,) = first_fits(residuals, predictions, [(BENDING,)], {(BENDING,): none})
    assert made.formula.points()[0][STATED.key] == pytest.approx(none.values[STATED], abs=0.1)
    (cold,) = first_fits(residuals, predictions, [(BENDING,)])
    assert warm.log_evidence == pytest.approx(cold.log_evidence, abs=0.3)


def test_a_fit_does_not_change_when_it_is_carried_on() -> None:
    made = made_of(saturating(at(0.2, 5.0)) + np.random.default_rng(8).normal(size=10))
    (first,) = first_fits(made.residuals, made.predictions, [(BENDING,)])
    before = {name: np.array(getattr(first.state, name)) for name in ("x", "r", "J", "next_point")}
    numbers = first.steps, first.misfit, first.log_evidence, first.state.unknowns, first.state.needs_tangents
    (further,) = continued(made.residuals, made.predictions, [first])
    assert further.steps > first.steps
    assert (
        numbers == (first.steps, first.misfit, first.log_evidence, first.state.unknowns, first.state.needs_tangents)
    )  # fmt: skip
    for name, values in before.items():
        np.testing.assert_array_equal(getattr(first.state, name), values)
    # Carried on again from the same fit, it comes to the same.
    (again,) = continued(made.residuals, made.predictions, [first])
    np.testing.assert_array_equal(again.posterior.mean, further.posterior.mean)


@pytest.mark.parametrize(("odd", "again"), [(2.0, True), (0.3, False)])
def test_a_misfit_that_noise_seldom_makes_is_believed_with_tangents_at_its_own_point(odd: float, again: bool) -> None:
    # What no unknown explains: the misfit stays poor, so that tangents corrected step by step are not enough.
    left = odd * np.where(np.arange(10) % 2, 1.0, -1.0)
    tangents = []
    for doubtful_p in (0.0, DEFAULT.doubtful_p):
        made = made_of(saturating(at(0.2, 3.0)) + left, DiagnosisSettings(doubtful_p=doubtful_p, near_tangents=0.0))
        fit = fitted(made)
        assert fit.converged
        assert fit.misfit == pytest.approx(least(made), abs=1.0)
        tangents.append(made.formula.points("jacobian"))
    assert (len(tangents[1]) > len(tangents[0])) is again
    if again:
        last = tangents[1][-1]
        assert last[STATED.key] == pytest.approx(fit.values[STATED], abs=0.05)
        assert last[AMPLITUDE.key] == pytest.approx(fit.values[AMPLITUDE], abs=0.05)
