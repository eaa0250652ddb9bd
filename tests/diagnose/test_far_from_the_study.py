"""Beside a discrepancy that changes the readings much, effects are searched with sensitivities at the fit."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import pytest
from formula import Array, Case, case, effect

from tyrefem.diagnose.beside.discrepancy import ENERGY, Discrepancy
from tyrefem.diagnose.beside.ranked_beside import CHANGED, RankedBeside
from tyrefem.diagnose.fitting.criterion import LogEvidence
from tyrefem.diagnose.fitting.selection import SelectionProblem
from tyrefem.diagnose.unknowns.candidates import SetPrior
from tyrefem.diagnose.unknowns.unknown import Unknown

N = 120
T = np.linspace(0.0, 1.0, N)
#: Strain energy of the data over that of the study, as a logarithm.
ENERGY_LEVEL = Unknown("energy", 0.3)
SLIP, ROAD = effect("slip", 3.0), effect("road", 3.0)
CANDIDATES = (SLIP, ROAD)


def law(values: Mapping[str, float]) -> Array:
    """A rise in proportion to the energy; a warmer tyre shows the slip at another time."""
    level = math.exp(values.get("energy", 0.0))
    slip = values.get("slip", 0.0) * np.sin(4.0 * level * T)
    return np.asarray(40.0 * level * T + slip + values.get("road", 0.0) * np.sin(5.0 * T))


def made(level: float) -> Case:
    """Readings of a tyre that slips, whose energy is another one."""
    noise = np.random.default_rng(2).normal(size=N)
    return case(law, law({"energy": level, "slip": 4.0}) + noise, CANDIDATES, further=(ENERGY_LEVEL,))


def searched(data: Case) -> RankedBeside:
    """Sets beside the energy, from a fit of no effect."""
    prior = SetPrior(CANDIDATES, 0.5)
    problem = SelectionProblem(data.residuals, data.predictions, CANDIDATES, prior, LogEvidence())
    beside = RankedBeside(problem, Discrepancy(ENERGY, 0.0, nuisance=(ENERGY_LEVEL,)))
    beside.begin(dict(zip([()], problem.fitted([()], {}), strict=True)))
    return beside


def test_estimates_rest_on_sensitivities_where_the_fit_is() -> None:
    beside = searched(made(0.5))
    assert beside.change == pytest.approx(math.exp(0.5) - 1.0, rel=0.1)
    before = beside.estimates[SLIP,]
    beside.further()
    assert beside.best.members == (SLIP,)
    # About x = 0 the effect seemed to explain far less than it does.
    assert beside.score((SLIP,)) > before + 20.0
    assert beside.best.values[SLIP.amplitudes[0]] == pytest.approx(4.0, abs=0.6)


def test_near_the_study_sensitivities_are_not_taken_again() -> None:
    beside = searched(made(0.05))
    assert beside.change < CHANGED
    beside.further()
    assert beside.renewed is None
    assert beside.best.members == (SLIP,)


def test_no_effect_is_fitted_beside_a_discrepancy_however_far_its_fit_without_it_is() -> None:
    data = made(0.5)
    prior = SetPrior(CANDIDATES, 0.5)
    problem = SelectionProblem(data.residuals, data.predictions, CANDIDATES, prior, LogEvidence())
    beside = RankedBeside(problem, Discrepancy(ENERGY, 0.0, nuisance=(ENERGY_LEVEL,)))
    beside.begin({problem.ordered(fit.members): fit for fit in problem.fitted([(ROAD,), (SLIP,)], {})}, 1)
    assert () in beside.fits
