"""Heat of unknown origin that explains the data by itself: effects beside it are not named."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from formula import Case, case, effect

from tyrefem.diagnose.beside.discrepancy import ENERGY, HEAT, NONE, discrepancies, missing_heat_beside, missing_patches
from tyrefem.diagnose.beside.free_heat import FreeHeat, free_heat
from tyrefem.diagnose.beside.ranked_beside import RankedBeside
from tyrefem.diagnose.beside.ranking import averaged
from tyrefem.diagnose.beside.robustness import Robustness, UnderDiscrepancy
from tyrefem.diagnose.fitting.criterion import LogEvidence
from tyrefem.diagnose.fitting.exhaustive import Exhaustive
from tyrefem.diagnose.fitting.fits import first_fits
from tyrefem.diagnose.fitting.selection import ScoredSet, SelectionProblem
from tyrefem.diagnose.settings import DEFAULT
from tyrefem.diagnose.unknowns.candidates import SetPrior
from tyrefem.diagnose.unknowns.unknown import Unknown
from tyrefem.diagnose.verdicts.partly import beside_discrepancies
from tyrefem.diagnose.verdicts.verdict import CONFOUNDED, PARTLY, UNEXPLAINED, judge, ranked

#: Places of the readings along the meridian; the effect heats a narrow place, the patches wide ones.
S = np.linspace(0.0, 1.0, 120)
HOT = effect("hot", 10.0)
STATIONS = (0.1, 0.3, 0.5, 0.7, 0.9)
PATCHES = tuple(Unknown(f"patch-{at}", 1.0, effect="missing-heat", choice=(("station", f"{at} m"),)) for at in STATIONS)
WIDTH = DEFAULT.heat_widths[-1]


def law(values: Mapping[str, float]) -> np.ndarray:
    """Heat of patches, which saturates, and a narrow bump by the effect."""
    heat = sum(values.get(patch.key, 0.0) * wide(at) for patch, at in zip(PATCHES, STATIONS, strict=True))
    bump = np.exp(-(((S - 0.22) / 0.03) ** 2) / 2)
    return np.asarray(100.0 * np.tanh(heat / 100.0) + values.get("hot", 0.0) * bump)


def wide(at: float) -> np.ndarray:
    return np.asarray(np.exp(-(((S - at) / 0.1) ** 2) / 2))


def problem_of(readings: np.ndarray) -> SelectionProblem:
    made: Case = case(law, readings + np.random.default_rng(3).normal(size=len(S)), (HOT,), further=PATCHES)
    return SelectionProblem(made.residuals, made.predictions, (HOT,), SetPrior((HOT,), 0.5), LogEvidence())


def of_effect(problem: SelectionProblem) -> float:
    """ln evidence of the effect, with no heat."""
    (fit,) = first_fits(problem.residuals, problem.predictions, [(HOT,)])
    return fit.log_evidence


def test_a_source_as_expected_explains_the_data_by_itself() -> None:
    problem = problem_of(law({PATCHES[1].key: 2.0, PATCHES[2].key: 1.5}))
    heat = free_heat(problem, 0.0, of_effect(problem))
    assert heat is not None
    assert heat.p_value > 0.01
    assert heat.lead < 3.0
    assert heat.explains(DEFAULT.free_heat_lead)


def test_a_source_that_is_far_too_strong_is_no_explanation() -> None:
    # Twenty prior standard deviations.
    problem = problem_of(law({PATCHES[1].key: 20.0}))
    heat = free_heat(problem, 0.0, of_effect(problem))
    assert heat is not None
    assert heat.p_value < 1e-4
    assert not heat.explains(DEFAULT.free_heat_lead)


def test_a_misfit_that_is_far_too_large_costs_no_further_fits() -> None:
    problem = problem_of(law({"hot": 80.0}))
    heat = free_heat(problem, 0.0, 0.0)
    assert heat is not None
    assert heat.p_value < 1e-10
    assert heat.lead == math.inf
    assert not heat.explains(DEFAULT.free_heat_lead)
    asked = [values for values in problem.predictions.evaluations.points() if values.get("hot")]
    assert asked == []


def test_heat_at_the_stations_is_no_effect_at_a_narrow_place() -> None:
    problem = problem_of(law({"hot": 30.0}))
    heat = free_heat(problem, 0.0, of_effect(problem))
    assert heat is not None
    assert heat.lead > 2 * DEFAULT.free_heat_lead
    assert not heat.explains(DEFAULT.free_heat_lead)


def test_without_patches_nothing_is_compared() -> None:
    made = case(law, law({}), (HOT,))
    problem = SelectionProblem(made.residuals, made.predictions, (HOT,), SetPrior((HOT,), 0.5), LogEvidence())
    assert free_heat(problem, 0.0, 0.0) is None


@pytest.mark.parametrize(
    ("heat", "named"), [(FreeHeat(0.6, 16.0), False), (FreeHeat(0.6, 90.0), True), (FreeHeat(1e-4, 5.0), True)]
)
def test_an_effect_is_not_named_where_heat_explains_the_data_as_well(heat: FreeHeat, named: bool) -> None:
    problem = problem_of(law({"hot": 30.0}))
    fits = {members: first_fits(problem.residuals, problem.predictions, [members])[0] for members in ((), (HOT,))}
    values = {HOT.amplitudes[0].key: (30.0, 1.0)}
    models = tuple(
        UnderDiscrepancy(name, 0.0, name, chance, {"hot": 1.0}, (HOT,), values, fits)
        for name, chance in ((ENERGY, 0.995), (NONE, 0.005))
    )
    judgement = judge(ranked(problem_sets(problem)), lambda members: None)
    unexplained = replace(judgement, verdict=UNEXPLAINED)
    revision = beside_discrepancies(unexplained, Robustness(models), DEFAULT, heat=heat)
    assert revision.verdict == (PARTLY if named else UNEXPLAINED)
    assert revision.members == ((HOT,) if named else ())
    told = "Hot is not named: heat of unknown origin explains the data about as well."
    assert (told in revision.doubts) is not named
    # Where effects alone are not excluded, nothing is "unexplained".
    open_models = Robustness((replace(models[0], probability=0.6), replace(models[1], probability=0.4)))
    revision = beside_discrepancies(replace(judgement, verdict=CONFOUNDED), open_models, DEFAULT, heat=heat)
    assert revision.verdict == (PARTLY if named else CONFOUNDED)


def test_the_best_set_with_the_effects_is_compared() -> None:
    problem = problem_of(law({"hot": 30.0}))
    fits = {members: first_fits(problem.residuals, problem.predictions, [members])[0] for members in ((), (HOT,))}
    model = UnderDiscrepancy(ENERGY, 0.0, ENERGY, 1.0, {"hot": 1.0}, (HOT,), {}, fits)
    assert model.log_evidence((HOT,)) == fits[(HOT,)].log_evidence
    assert model.log_evidence(()) == max(fit.log_evidence for fit in fits.values())
    assert replace(model, fits={(): fits[()]}).log_evidence((HOT,)) == -math.inf
    assert replace(model, fits={(): fits[()]}, allowed=(HOT,)).log_evidence((HOT,)) == fits[()].log_evidence


def problem_sets(problem: SelectionProblem) -> list[ScoredSet]:
    return problem.settled(Exhaustive().search(problem))


def test_the_evidence_of_missing_heat_is_the_average_over_its_sizes() -> None:
    problem = problem_of(law({PATCHES[1].key: 4.0}))
    fits = {members: first_fits(problem.residuals, problem.predictions, [members])[0] for members in ((), (HOT,))}
    sizes = []
    for discrepancy in discrepancies(problem.residuals):
        if discrepancy.name == HEAT:
            sizes.append(RankedBeside(problem, discrepancy))
            sizes[-1].begin(fits)
    assert [beside.discrepancy.width for beside in sizes] == list(DEFAULT.heat_widths)
    _, residuals, rows = averaged(sizes)
    scores = {row.members: row.score for row in rows}
    expected = math.log(np.mean([math.exp(beside.score(())) for beside in sizes]))
    assert scores[()] == pytest.approx(expected, abs=1e-9)
    best = max(sizes, key=lambda beside: beside.score(()))
    assert residuals is best.residuals
    # The heat is four times its prior expectation, so neither the smallest nor the largest size is the best.
    assert best.discrepancy.width == DEFAULT.heat_widths[1]


def test_sources_are_fitted_and_the_other_patches_linear() -> None:
    residuals = problem_of(law({})).residuals
    heat = missing_heat_beside(residuals, PATCHES[:2], WIDTH)
    assert missing_patches(residuals) == PATCHES
    assert [unknown.sd for unknown in heat.nuisance] == [WIDTH, WIDTH]
    assert heat.shared_error is not None
    # Three linear patches that all runs share, and each run's part of all five.
    assert heat.shared_error.fitted.shape[1] == 3 + 5
