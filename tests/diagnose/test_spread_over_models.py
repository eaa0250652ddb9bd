"""Standard deviations of an identified effect count how much its amount differs between discrepancy models."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from formula import STATED, case, effect

from tyrefem.diagnose.beside.robustness import Robustness, UnderDiscrepancy
from tyrefem.diagnose.fitting.criterion import LogEvidence
from tyrefem.diagnose.fitting.exhaustive import Exhaustive
from tyrefem.diagnose.fitting.fits import FittedSet
from tyrefem.diagnose.fitting.selection import SelectionProblem
from tyrefem.diagnose.ranking import Ranking, beside_other_models
from tyrefem.diagnose.settings import DEFAULT
from tyrefem.diagnose.unknowns.candidates import SetPrior
from tyrefem.diagnose.verdicts.verdict import CONFOUNDED, IDENTIFIED, PARTLY
from tyrefem.diagnose.words.result_tables import parameters

T = np.linspace(0.0, 1.0, 40)


@pytest.fixture(scope="module")
def fit() -> FittedSet:
    """A fit of one effect whose amplitude is about 3."""
    candidates = (effect("early"),)

    def law(values: dict[str, float]) -> np.ndarray:
        return 2.0 * values.get(STATED.key, 0.0) * np.sqrt(T) + 3.0 * values.get("early", 0.0) * T

    noise = np.random.default_rng(2).normal(size=len(T))
    made = case(law, 9.0 * T + noise, candidates, replace(DEFAULT, largest=1))
    prior = SetPrior(candidates, 0.5, DEFAULT.size_shares)
    problem = SelectionProblem(made.residuals, made.predictions, candidates, prior, LogEvidence())
    best = problem.settled(Exhaustive().search(problem))[0].fit
    assert best is not None
    return best


def beside(fit: FittedSet, *models: tuple[float, float, float]) -> Robustness:
    """Models with their probability, and the amount and its standard deviation beside each."""
    (unknown,) = fit.members[0].unknowns
    return Robustness(
        tuple(
            UnderDiscrepancy(f"model {n}", 0.0, "", p, {}, fit.members, {unknown.key: (x, sd)}, {})
            for n, (p, x, sd) in enumerate(models)
        )
    )


def test_the_spread_is_the_root_mean_square_about_the_fit(fit: FittedSet) -> None:
    (unknown,) = fit.members[0].unknowns
    x, sd = fit.values[unknown], fit.sd[unknown]
    models = beside(fit, (0.75, x + 3 * sd, 2 * sd), (0.25, x, sd))
    expected = sd * math.sqrt(0.75 * (4 + 9) + 0.25)
    assert models.spread(fit) == {unknown: pytest.approx(expected)}
    # An improbable model does not count, and no interval becomes narrower.
    assert beside(fit, (1.0, x, 0.5 * sd), (0.0, x + 9 * sd, sd)).spread(fit) == {unknown: sd}


@pytest.mark.parametrize(("verdict", "wider"), [(IDENTIFIED, True), (PARTLY, True), (CONFOUNDED, False)])
def test_named_effects_have_the_spread_over_the_models(fit: FittedSet, verdict: str, wider: bool) -> None:
    (unknown,) = fit.members[0].unknowns
    x, sd = fit.values[unknown], fit.sd[unknown]
    judged = SimpleNamespace(verdict=verdict)
    unused: Any = None
    ranking = Ranking(judged, fit, fit, unused, unused, unused, beside(fit, (1.0, x + sd, sd)))  # type: ignore[arg-type]
    assert beside_other_models(ranking).best.sd[unknown] == pytest.approx(sd * (math.sqrt(2) if wider else 1.0))


def test_tables_state_the_wider_standard_deviation_and_the_value_of_the_fit(fit: FittedSet) -> None:
    (unknown,) = fit.members[0].unknowns
    x, sd = fit.values[unknown], fit.sd[unknown]
    wider = replace(fit, spread=beside(fit, (1.0, x + sd, sd)).spread(fit))
    (row,) = parameters([unknown], wider).values()
    assert row["value"] == x
    assert row["sd"] == pytest.approx(math.sqrt(2) * sd)
    assert wider.posterior.sd == pytest.approx(fit.posterior.sd)


def test_an_unknown_that_only_an_improbable_model_fitted_has_its_range(fit: FittedSet) -> None:
    (unknown,) = fit.members[0].unknowns
    probable, improbable = beside(fit, (0.995, 3.0, 0.2), (0.005, 4.0, 0.5)).models
    robust = Robustness((replace(probable, values={}), improbable))
    assert robust.interval(unknown) == (3.0, 5.0)
