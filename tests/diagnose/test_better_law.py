"""Another strain law in place of the study's: when it is taken, what is said of it, and what the files have."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from formula import case as formula_case
from formula import effect
from hidden import Case, study
from made_up import judged
from scipy.special import chdtri

from tyrefem.diagnose import DiagnosisData
from tyrefem.diagnose.beside.discrepancy import NONE
from tyrefem.diagnose.beside.law_trials import LawTrial, law_trials
from tyrefem.diagnose.beside.robustness import Robustness, UnderDiscrepancy
from tyrefem.diagnose.better_law import CLEARLY, by_better_law
from tyrefem.diagnose.forward.forward_model import ForwardModel
from tyrefem.diagnose.forward.sampling import DriveSampling
from tyrefem.diagnose.forward.strain_law_study import COARSE_MESH, LEVEL_SD, STRETCHES, by_law
from tyrefem.diagnose.options import Method
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns.unknown import base_unknowns, with_values
from tyrefem.diagnose.verdicts.verdict import NO_GAP, PARTLY, UNEXPLAINED
from tyrefem.diagnose.words.headline import headline
from tyrefem.diagnose.words.missing_heat import missing_heat_words
from tyrefem.diagnose.words.record import record
from tyrefem.diagnose.words.sentences import verdict_words
from tyrefem.diagnose.words.set_posteriors import posterior_record
from tyrefem.plan.beliefs import diagnosed_beliefs, stored_beliefs
from tyrefem.reports.diagnosis import page

CROWN_AND_BEAD = np.linspace(0.4, 3.0, STRETCHES)
TRIAL = LawTrial("barrel", math.log(1.8), np.full(STRETCHES, 50.0), 50.0 * CROWN_AND_BEAD, 40.0, 6.0, 2.0, 2.5)


def test_the_study_by_another_law_has_its_energy_times_an_unknown_factor(tmp_path: Path) -> None:
    replaced = by_law(study(tmp_path), "barrel", 0.6)
    assert replaced.card.mechanics.strain == "barrel"
    (unknown,) = (each for each in base_unknowns(replaced) if each.effect == "heat-shape")
    assert (unknown.value(0.0), unknown.sd) == (0.6, LEVEL_SD)
    # The factor is moved where it stands, also if the entry has a number for its choice.
    (moved,) = with_values(replaced, {unknown: 0.1}).effects
    assert moved.log_factor == pytest.approx(0.7)
    numbered = replaced.replace({"effects": [{"name": "heat-shape", "half_waves": 0, "log_factor": 0.2}]})
    (again,) = by_law(numbered, "arcs", 0.3).effects
    assert again.log_factor == pytest.approx(0.5)
    assert by_law(study(tmp_path), "fem", 0.0).card.mechanics.motion == "linear"


def test_heat_by_another_law_is_compared_on_the_same_mesh(tmp_path: Path) -> None:
    owner = study(tmp_path)
    settings = DiagnosisSettings(mesh_size="8 mm")
    model = ForwardModel(owner, (DriveSampling("run", {}, hold_out=False, sensors=()),), settings=settings)
    arcs, barrel = model.heat_by_law(0, "barrel", "8 mm")
    np.testing.assert_allclose(model.heat_by_law(0, "arcs", "8 mm"), [arcs, arcs], rtol=1e-9)
    # The barrel has half the arcs' energy, and the bead, which the arcs leave out (docs/evidence/strain-laws.md).
    assert 0.3 < barrel.sum() / arcs.sum() < 0.8
    assert barrel[-3:].sum() > arcs[-3:].sum()
    doubled = by_law(owner, "barrel", math.log(2.0))
    assert np.isnan(model.heat_by_law(0, "given", "8 mm")).all()
    assert doubled.card.mechanics.strain == "barrel"


def test_a_law_that_leaves_most_of_the_deviation_is_not_promising() -> None:
    assert TRIAL.promising
    assert not replace(TRIAL, rms=0.9 * TRIAL.stated_rms).promising
    assert not replace(TRIAL, gain=5.0).promising


def test_a_law_by_finite_elements_is_diagnosed_on_a_coarse_mesh() -> None:
    assert Method().by_law("barrel").settings.mesh_size == COARSE_MESH
    assert Method().by_law("arcs") == Method()


class Laws:
    """Answers of a forward model: the barrel heats by 10 K more at the first readings; elements find no tyre."""

    def of(self, name: str, questions: list[tuple[Any, ...]], tick: object = None) -> list[np.ndarray]:
        if name == "heat_by_law":
            ((_, law, _),) = questions
            return [np.ones((2, STRETCHES)) * ([[2.0], [1.0]] if law == "barrel" else np.nan)]
        assert name == "change_by_law"
        assert {law for _, law, _, _ in questions} == {"barrel"}
        assert all(level == pytest.approx(math.log(2.0)) for _, _, level, _ in questions)
        return [10.0 * (np.arange(40) < 20) for _ in questions]


@pytest.mark.parametrize("like_barrel", [True, False])
def test_a_law_is_promising_if_it_takes_the_deviation_away(like_barrel: bool) -> None:
    rng = np.random.default_rng(3)
    measured = 10.0 * (np.arange(40) < 20) * like_barrel + rng.normal(size=40)
    data = formula_case(lambda values: np.full(40, values.get("all", 0.0)), measured, (effect("all"),))
    stated = SimpleNamespace(**vars(data.residuals.study))
    stated.card = SimpleNamespace(**vars(stated.card), mechanics=SimpleNamespace(strain="arcs"))
    residuals = replace(data.residuals, study=cast(Any, stated))
    (trial,) = law_trials(residuals, cast(Any, Laws()))
    assert trial.law == "barrel"
    assert trial.promising is like_barrel
    assert trial.rms == pytest.approx(np.sqrt(np.mean((measured - 10.0 * (np.arange(40) < 20)) ** 2)))
    assert math.isnan(trial.held_out_rms)


def with_evidence(d: DiagnosisData, verdict: str, log_evidence: float, held_out: float) -> DiagnosisData:
    """As if this were the verdict, with this evidence and prediction of the held-out run."""
    fit = replace(d.best, held_out=held_out)
    member = fit.members[0]
    named = {member.key: 0.99}
    values = {unknown.key: (25.0, 1.5) for unknown in member.amplitudes}
    model = UnderDiscrepancy(NONE, 0.0, "the model as it is", 1.0, named, fit.members, values, {fit.members: fit})
    judgement = replace(d.judgement, verdict=verdict)
    return replace(d, judgement=judgement, robustness=Robustness((model,), log_evidence=log_evidence))


@pytest.mark.parametrize(
    ("ahead", "lead", "taken"),
    [(CLEARLY + 1, 3.0, True), (CLEARLY - 1, 3.0, False), (CLEARLY + 1, -3.0, False), (CLEARLY + 1, math.nan, True)],
)
def test_another_law_is_taken_only_if_evidence_and_held_out_runs_speak_for_it(
    case: Case, ahead: float, lead: float, taken: bool
) -> None:
    stated = with_evidence(case.diagnosis, UNEXPLAINED, -100.0, -50.0)
    other = with_evidence(case.diagnosis, PARTLY, -100.0 + ahead, -50.0 + lead)
    result = by_better_law(stated, other, TRIAL)
    assert (result.better_law is not None) is taken
    assert result.verdict == (PARTLY if taken else UNEXPLAINED)
    assert result.before is stated.before
    assert result.original is stated.original


@pytest.mark.parametrize(
    ("stated_p", "p", "held_out_p", "taken"),
    [(1e-9, 0.3, 0.2, True), (1e-3, 0.3, 0.2, False), (1e-9, 1e-9, 0.2, False), (1e-9, 0.3, 1e-6, False)],
)
def test_held_out_runs_are_no_race_with_a_law_whose_fitted_runs_refute_it(
    case: Case, stated_p: float, p: float, held_out_p: float, taken: bool
) -> None:
    def with_p(d: DiagnosisData, p: float) -> DiagnosisData:
        """The diagnosis with this probability of the misfit in the fitted runs."""
        assert d.robustness is not None
        (model,) = d.robustness.models
        ((members, fit),) = model.fits.items()
        fit = replace(fit, misfit=float(chdtri(fit.readings, p)), held_out_p=held_out_p)
        return replace(d, robustness=replace(d.robustness, models=(replace(model, fits={members: fit}),)))

    stated = with_p(with_evidence(case.diagnosis, UNEXPLAINED, -100.0, -50.0), stated_p)
    other = with_p(with_evidence(case.diagnosis, PARTLY, -100.0 + 2 * CLEARLY, -55.0), p)
    result = by_better_law(stated, other, TRIAL)
    assert (result.better_law is not None) is taken
    if taken:
        assert "noise explains the held-out runs by barrel, but not the fitted runs by arcs" in headline(result)[1]


def test_words_page_and_record_tell_the_law_and_the_effect(case: Case) -> None:
    stated = with_evidence(replace(case.diagnosis, law_trials=(TRIAL,)), UNEXPLAINED, -500.0, -50.0)
    d = by_better_law(stated, with_evidence(case.diagnosis, PARTLY, -100.0, -40.0), TRIAL)
    wrong, sure, _ = headline(d)
    assert wrong.startswith("The strain energy of the model is off: the strain law barrel in place of arcs takes")
    assert "60 % less heat in the crown" in wrong
    assert "3.0 times the heat" in wrong
    assert "Besides: The road is warmer than stated" in wrong
    assert "the data prefer barrel" in sure
    assert verdict_words(d)[0].startswith("The strain energy of the model is off")
    plain = record(d)
    assert plain["better_strain_law"]["law"] == "barrel"
    assert plain["better_strain_law"]["stated"] == "arcs"
    assert plain["better_strain_law"]["log_odds"] == pytest.approx(400.0)
    assert [row["law"] for row in plain["strain_laws"]] == ["barrel"]
    assert "Other strain laws" in page(d, {}, version="test")


def test_a_law_that_leaves_no_gap_is_told_and_names_no_effect(case: Case) -> None:
    stated = with_evidence(case.diagnosis, UNEXPLAINED, -1e5, -1e4)
    d = replace(judged(case.diagnosis, NO_GAP, {(): 0.95, ("sun",): 0.05}), robustness=None, best=case.diagnosis.null)
    result = by_better_law(stated, d, TRIAL)
    assert result.verdict == UNEXPLAINED
    assert result.better_law is not None
    assert result.better_law.alone
    wrong, _, step = headline(result)
    assert "With it no effect is missing." in wrong
    assert "strain law barrel" in step
    assert "With this strain law no effect is missing." in verdict_words(result)
    assert record(result)["effects"] == []
    assert missing_heat_words(result) == ()
    assert "Heat of unknown origin" not in page(result, {}, version="test")


def test_a_plan_after_the_verdict_is_of_the_study_by_the_better_law(case: Case, tmp_path: Path) -> None:
    level = 0.6
    replaced = by_law(case.diagnosis.original, "barrel", level)
    by_other = replace(case.diagnosis, gap=replace(case.diagnosis.gap, study=replaced))
    trial = replace(TRIAL, level=level)
    d = by_better_law(
        with_evidence(case.diagnosis, UNEXPLAINED, -500.0, -50.0), with_evidence(by_other, PARTLY, 0.0, 0.0), trial
    )
    assert diagnosed_beliefs(d).study is replaced
    kept = posterior_record(d)
    assert kept["strain_law"] == {"name": "barrel", "level": level}
    (tmp_path / "posterior.json").write_text(json.dumps(kept), encoding="utf-8")
    assert stored_beliefs(d.original, tmp_path).study.card.mechanics.strain == "barrel"
