"""Effects beside a wrong model: what stays named whatever else is wrong, and what does not."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, cast

import numpy as np
import pytest
from formula import Case, case, effect

from tyrefem.diagnose.beside.discrepancy import ENERGY, NONE, Discrepancy, beside_law, discrepancies
from tyrefem.diagnose.beside.ranked_beside import RankedBeside
from tyrefem.diagnose.beside.ranking import robustness, under
from tyrefem.diagnose.beside.robustness import Robustness
from tyrefem.diagnose.fitting.criterion import LogEvidence
from tyrefem.diagnose.fitting.fits import first_fits
from tyrefem.diagnose.fitting.forward_selection import ForwardSelection
from tyrefem.diagnose.fitting.selection import SelectionProblem
from tyrefem.diagnose.fitting.support import ALONE, SENSOR, supports
from tyrefem.diagnose.inference.shared_error import SharedError
from tyrefem.diagnose.settings import DEFAULT
from tyrefem.diagnose.unknowns.candidates import SetPrior
from tyrefem.diagnose.unknowns.energy_shapes import courses, energy_shapes
from tyrefem.diagnose.verdicts.partly import beside_discrepancies
from tyrefem.diagnose.verdicts.verdict import IDENTIFIED, PARTLY, UNEXPLAINED, Judgement, judge, ranked

NO_EFFECTS = cast(Any, type("Study", (), {"card": type("Card", (), {"effects": ()})}))
SHAPES = energy_shapes(NO_EFFECTS, DEFAULT)
#: Places of the readings from crown to bead; the readings heat up to 40 K.
S = np.linspace(0.0, 1.0, 120)
HOT, COLD = effect("hot", 10.0), effect("cold", 10.0)
SETTINGS = replace(DEFAULT, largest=2)


def law(values: Mapping[str, float]) -> np.ndarray:
    """40 K of heat with a factor along the meridian; two effects heat the crown and the bead."""
    log_factor = courses(S, SHAPES) @ [values.get(unknown.key, 0.0) for unknown in SHAPES]
    heat = 40.0 * (1 + S) * np.exp(log_factor + 0.1 * values.get("materials.tread.loss_tangent.value", 0.0))
    hot, cold = (np.exp(-(((S - at) / 0.06) ** 2) / 2) for at in (0.2, 0.85))
    return np.asarray(heat + values.get("hot", 0.0) * hot + values.get("cold", 0.0) * cold)


def measured(hot: float = 0.0, off: float = 0.0, factor: float = 0.0) -> Case:
    """Readings with unit noise; the heat's truth is steeper along the meridian than any half wave, by ``off``.

    ``factor``: ln of its factor at the crown, and of that at the bead with the other sign.
    """
    rng = np.random.default_rng(4)
    steep = np.tanh((0.45 - S) / 0.2)
    truth = law({"hot": hot}) + 40.0 * (1 + S) * (off * steep + np.expm1(factor * steep)) + rng.normal(size=len(S))
    return case(law, truth, (HOT, COLD), SETTINGS, further=SHAPES)


def diagnosed(data: Case) -> tuple[Judgement, tuple[Any, ...], Robustness]:
    problem = SelectionProblem(
        data.residuals, data.predictions, (HOT, COLD), SetPrior((HOT, COLD), 0.5, SETTINGS.size_shares), LogEvidence()
    )
    scored = problem.settled(ForwardSelection().search(problem))
    judgement = judge(ranked(scored), lambda members: None, SETTINGS)
    robust = robustness(problem, scored, certain=judgement.verdict == IDENTIFIED)
    revision = beside_discrepancies(judgement, robust, SETTINGS)
    return judgement.revised(revision.verdict, revision.reasons, revision.doubts), revision.members, robust


def test_an_effect_in_a_right_model_stays_identified() -> None:
    judgement, members, robust = diagnosed(measured(hot=15.0))
    assert judgement.verdict == IDENTIFIED
    assert judgement.best.members == (HOT,)
    assert members == ()
    assert robust.models[0].name == NONE
    assert sum(model.probability for model in robust.models) == pytest.approx(1.0)
    x, sd = next(model for model in robust.models if model.name == ENERGY).values["hot"]
    assert abs(x - 15.0) < 4 * sd < 8.0


def test_a_strain_energy_25_per_cent_off_names_no_effect() -> None:
    judgement, members, robust = diagnosed(measured(off=0.25))
    assert judgement.verdict == UNEXPLAINED
    assert members == ()
    assert robust.models[0].name == ENERGY
    assert robust.mean("hot") < 0.5
    assert robust.mean("cold") < 0.5


def test_an_effect_beside_a_wrong_strain_energy_is_partly_identified() -> None:
    judgement, members, robust = diagnosed(measured(hot=25.0, off=0.25))
    assert judgement.verdict == PARTLY
    assert members == (HOT,)
    assert robust.least("hot") >= SETTINGS.named_probability
    low, high = robust.interval(HOT.amplitudes[0])
    assert low < 25.0 < high
    assert high - low < 12.0


@pytest.mark.parametrize("hot", [25.0, 0.0])
def test_a_strain_energy_that_is_wrong_by_a_factor_is_followed(hot: float) -> None:
    # The tyre makes up to 3.5 times the model's heat at the crown and a third of it at the bead.
    judgement, members, robust = diagnosed(measured(hot=hot, off=0.0, factor=1.2))
    assert robust.models[0].name == ENERGY
    shapes = robust.models[0].fits[robust.models[0].best]
    assert max(unknown.sd for unknown in shapes.unknowns if unknown.effect == "heat-shape") > 0.4
    assert judgement.verdict == (PARTLY if hot else UNEXPLAINED)
    assert members == ((HOT,) if hot else ())
    if hot:
        low, high = robust.interval(HOT.amplitudes[0])
        assert low < hot < high


def test_an_effect_that_the_fit_of_all_does_not_ask_for_is_told_but_not_named() -> None:
    judgement, members, robust = diagnosed(measured(hot=25.0, off=0.25))
    assert members == (HOT,)
    again = replace(judgement, verdict=UNEXPLAINED)
    assert beside_discrepancies(again, replace(robust, idle=(COLD,)), SETTINGS).members == (HOT,)
    revision = beside_discrepancies(again, replace(robust, idle=(HOT,)), SETTINGS)
    assert (revision.verdict, revision.members) == (UNEXPLAINED, ())
    assert any(reason.startswith("hot is not named: beside the films'") for reason in revision.reasons)


def test_an_effect_without_which_held_out_runs_are_predicted_better_is_told_but_not_named() -> None:
    judgement, members, robust = diagnosed(measured(hot=25.0, off=0.25))
    assert members == (HOT,)
    leading = robust.models[0]
    fit = leading.fits[(HOT,)]
    for lead, named in ((-3.0, True), (3.0, False)):
        fits = {(HOT,): replace(fit, held_out=-50.0), (): replace(fit, members=(), held_out=-50.0 + lead)}
        models = (replace(leading, fits=fits), *robust.models[1:])
        again = replace(judgement, verdict=UNEXPLAINED)
        revision = beside_discrepancies(again, replace(robust, models=models), SETTINGS)
        assert (revision.verdict == PARTLY) is named
        told = "Hot is not named: the held-out runs are predicted better without it."
        assert (told in revision.doubts) is not named


def test_an_effect_in_one_run_is_told_but_not_named_where_more_is_wrong() -> None:
    judgement, _, robust = diagnosed(measured(hot=25.0, off=0.25))
    odd = HOT.in_runs(("fast",))
    for member, named in ((HOT, True), (odd, False)):
        models = []
        for model in robust.models:
            fit = max(model.fits.values(), key=lambda each: each.p_value)
            fits = {
                (member,): replace(fit, members=(member,), held_out=-40.0),
                (): replace(fit, members=(), held_out=-50.0),
            }
            values = {member.amplitudes[0].key: (25.0, 1.0)}
            models.append(replace(model, fits=fits, named={member.key: 1.0}, values=values))
        again = replace(judgement, verdict=UNEXPLAINED)
        revision = beside_discrepancies(again, replace(robust, models=tuple(models)), SETTINGS)
        assert revision.members == ((HOT,) if named else ())
        assert revision.verdict == (PARTLY if named else UNEXPLAINED)
        told = f"{odd.key} is not named: no other run tells it from what else differs in fast"
        assert (told in revision.reasons) is not named


def test_of_two_effects_the_member_that_the_held_out_runs_ask_for_is_named() -> None:
    judgement, _, robust = diagnosed(measured(hot=25.0, off=0.25))
    again = replace(judgement, verdict=UNEXPLAINED)
    # ln p of the held-out runs with neither effect, with hot, with cold, with both.
    for held_out, members in (
        ((-60.0, -50.0, -55.0, -49.0), (HOT, COLD)),
        ((-60.0, -50.0, -55.0, -52.0), (HOT,)),
        ((-50.0, -52.0, -51.0, -55.0), ()),
        ((-60.0, -50.0, -50.0, -52.0), ()),
    ):
        models = []
        for model in robust.models:
            fit = max(model.fits.values(), key=lambda each: each.p_value)
            sets = ((), (HOT,), (COLD,), (HOT, COLD))
            fits = {part: replace(fit, members=part, held_out=x) for part, x in zip(sets, held_out, strict=True)}
            values = {"hot": (25.0, 1.0), "cold": (9.0, 1.0)}
            models.append(replace(model, fits=fits, named={"hot": 1.0, "cold": 1.0}, values=values))
        revision = beside_discrepancies(again, replace(robust, models=tuple(models)), SETTINGS)
        assert set(revision.members) == set(members)
        left = [each.key for each in (HOT, COLD) if each not in members]
        told = "is not named: the held-out runs are predicted better without it"
        assert [reason for reason in revision.reasons if told in reason] == (
            [f"{' + '.join(left)} {told}"] if left else []
        )


@pytest.mark.parametrize("hot", [0.0, 25.0])
def test_where_nothing_explains_the_data_only_effects_that_may_be_named_cost_fits(hot: float) -> None:
    data = measured(hot=hot, off=0.25)
    judgement, members, every = diagnosed(data)
    problem = SelectionProblem(
        data.residuals, data.predictions, (HOT, COLD), SetPrior((HOT, COLD), 0.5, SETTINGS.size_shares), LogEvidence()
    )
    scored = problem.settled(ForwardSelection().search(problem))
    robust = robustness(problem, scored, certain=False, explained=False)
    unexplained = replace(judgement, verdict=UNEXPLAINED)
    assert beside_discrepancies(unexplained, robust, SETTINGS).members == members == ((HOT,) if hot else ())
    assert [model.name for model in robust.models] == [model.name for model in every.models]
    fits, of_every = (sum(len(model.fits) for model in each.models) for each in (robust, every))
    if not hot:
        assert fits < of_every
        assert robust.open(SETTINGS.named_probability) == ()
        return
    assert fits <= of_every
    assert robust.open(SETTINGS.named_probability) == (HOT,)
    for known, model in zip(every.models, robust.models, strict=True):
        assert model.probability == pytest.approx(known.probability, abs=1e-3)
        (x, sd), (wanted, _) = model.values["hot"], known.values["hot"]
        assert abs(x - wanted) < 0.2 * sd


def test_an_effect_that_another_strain_law_does_not_need_is_not_named() -> None:
    # The readings have the bump of the effect; one other law heats just there, another one does not.
    data = measured(hot=25.0, off=0.25)
    judgement, members, robust = diagnosed(data)
    assert members == (HOT,)
    bump = 25.0 * np.exp(-(((S - 0.2) / 0.06) ** 2) / 2)
    problem = SelectionProblem(
        data.residuals, data.predictions, (HOT, COLD), SetPrior((HOT, COLD), 0.5, SETTINGS.size_shares), LogEvidence()
    )
    fits = {part: first_fits(data.residuals, data.predictions, [part])[0] for part in ((), (HOT,))}
    for change, named in ((4.0 * S, True), (bump, False)):
        beside = RankedBeside(problem, beside_law(data.residuals, "other", [change]))
        beside.begin(fits)
        law = under(beside.discrepancy, beside.residuals, beside.scored())
        assert (law.named["hot"] > SETTINGS.named_probability) is named
        revision = beside_discrepancies(replace(judgement, verdict=UNEXPLAINED), replace(robust, laws=(law,)), SETTINGS)
        assert revision.members == ((HOT,) if named else ())
        assert (revision.verdict == PARTLY) is named
        assert any("the strain law other" in reason for reason in revision.reasons) is not named


def test_an_effect_without_an_amount_is_not_named() -> None:
    # Evidence of a fit that ended early named a tread worn by 1 +- 2 % with certainty.
    judgement, members, robust = diagnosed(measured(hot=25.0, off=0.25))
    assert members == (HOT,)
    leading = robust.models[0]
    x, sd = leading.values["hot"]
    assert x > 5 * sd
    for amount, named in ((2.1, (HOT,)), (1.9, ())):
        changed = replace(leading, values={**leading.values, "hot": (amount * sd, sd)})
        of_one = replace(robust, models=(changed,))
        revision = beside_discrepancies(replace(judgement, verdict=UNEXPLAINED), of_one, SETTINGS)
        assert revision.members == named
        assert ("hot is not named: its amount may as well be none" in revision.reasons) is not bool(named)


def test_a_misfit_that_no_discrepancy_explains_names_nothing() -> None:
    data = measured(hot=25.0)
    rng = np.random.default_rng(0)
    data = case(law, data.measured + rng.normal(0.0, 8.0, len(S)), (HOT, COLD), SETTINGS, further=SHAPES)
    _, _, robust = diagnosed(data)
    assert robust.models[0].p_value < 1e-4
    assert robust.robust((HOT, COLD), 0.0) == ()


def test_the_shared_error_is_that_of_its_covariance() -> None:
    rng = np.random.default_rng(1)
    C, H, y, z = rng.normal(size=(6, 3)), rng.normal(size=(4, 3)), rng.normal(size=6), rng.normal(size=4)
    error = SharedError(C, H)
    covariance = np.eye(6) + C @ C.T
    whitened = error.whitened(y)
    assert whitened @ whitened == pytest.approx(y @ np.linalg.solve(covariance, y))
    assert error.log_det == pytest.approx(np.linalg.slogdet(covariance)[1] / 2)
    gain = H @ C.T @ np.linalg.inv(covariance)
    np.testing.assert_allclose(error.held_out_from(whitened, z), z - gain @ y, atol=1e-12)
    np.testing.assert_allclose(error.held_out_covariance, np.eye(4) + H @ H.T - gain @ C @ H.T, atol=1e-12)


def test_a_fit_beside_a_discrepancy_has_the_evidence_of_the_joint_model() -> None:
    # Linear: the shapes are columns with N(0, 1) coefficients, so the evidence is a Gaussian density of the data.
    data = measured(hot=15.0)
    columns = courses(S, SHAPES) * 3.0
    beside = replace(data.residuals, shared_error=SharedError(columns, np.zeros((0, columns.shape[1]))))
    (fit,) = first_fits(beside, data.predictions, [(HOT,)])
    linear = data.residuals.linear([0])
    d = fit.linear.data
    J = fit.linear.jacobian
    sd = np.array([unknown.sd for unknown in fit.unknowns])
    within = np.eye(len(S)) + (J * sd**2) @ J.T
    expected = -float(d @ np.linalg.solve(within, d)) / 2 - np.linalg.slogdet(within)[1] / 2 - beside.log_det
    # The amplitude is far within its bounds.
    assert fit.log_evidence == pytest.approx(expected, abs=0.3)
    assert linear.jacobian.shape[0] == len(d)


def test_the_models_are_those_that_the_unknowns_allow() -> None:
    names = [each.name for each in discrepancies(measured().residuals)]
    # Without errors of the readings and with two sizes of them, each with narrow and wide priors.
    assert names.count(ENERGY) == 6
    assert {each.width for each in discrepancies(measured().residuals)} == {1.0, *DEFAULT.energy_widths}
    assert all(isinstance(each, Discrepancy) for each in discrepancies(measured().residuals))
    without = case(law, law({}), (HOT, COLD), SETTINGS)
    assert ENERGY not in [each.name for each in discrepancies(without.residuals)]


def test_the_half_waves_have_the_stated_scatter() -> None:
    waves = courses(np.linspace(0.0, 1.0, 2001), SHAPES)
    variance = (waves**2) @ np.array([unknown.sd for unknown in SHAPES]) ** 2
    assert np.trapezoid(variance, dx=1 / 2000) == pytest.approx(DEFAULT.energy_sd**2, rel=1e-6)
    assert SHAPES[0].key == "effects.heat-shape.0.log_factor"


def supported(data: Case, members: tuple[Any, ...], others: tuple[Any, ...]) -> dict[str, Any]:
    prior = SetPrior((*members, *others), 0.5, SETTINGS.size_shares)
    fits = {}
    for part in ((), *((each,) for each in members), members):
        (fits[part],) = first_fits(data.residuals, data.predictions, [part])
    found = supports(data.residuals, fits[members], fits, (*members, *others), prior)
    return {member.key: support for member, support in found.items()}


def test_an_effect_that_one_sensor_asks_for_is_told() -> None:
    # The bump "hot" is at the first 40 readings only, the slope at all of them.
    rng = np.random.default_rng(2)
    bump, slope = effect("bump", 5.0), effect("slope", 5.0)

    def of(values: Mapping[str, float]) -> np.ndarray:
        x = np.arange(120.0)
        return np.asarray(values.get("bump", 0.0) * np.exp(-(((x - 20) / 5) ** 2)) + values.get("slope", 0.0) * x / 60)

    data = case(of, of({"bump": 8.0, "slope": 6.0}) + rng.normal(size=120), (bump, slope), SETTINGS, sensors=3)
    of_effects = supported(data, (bump, slope), ())
    assert of_effects["bump"].only == "sensor-0"
    assert of_effects["bump"].weakest.probability < ALONE
    assert of_effects["slope"].only == ""
    assert of_effects["slope"].weakest.probability > 0.99
    assert {entry.kind for entry in of_effects["slope"].left_out} == {SENSOR}


def test_a_fault_of_a_sensor_is_not_left_without_its_sensor() -> None:
    fault = replace(effect("offset", 5.0), choice=(("sensor", "sensor-1"),))

    def of(values: Mapping[str, float]) -> np.ndarray:
        x = np.arange(120.0)
        return np.asarray(values.get("offset", 0.0) * ((x >= 40) & (x < 80)))

    data = case(of, of({"offset": 3.0}), (fault,), SETTINGS, sensors=3)
    support = supported(data, (fault,), ())[fault.key]
    assert support.only_at == support.only == "sensor-1"
    assert [entry.name for entry in support.left_out] == ["sensor-0", "sensor-2"]
    assert support.weakest.probability > 0.99
