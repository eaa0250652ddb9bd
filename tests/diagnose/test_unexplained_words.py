""" "Unexplained" says something: how much another strain energy explains, and which effects may act beside it."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hidden import Case
from made_up import unexplained

from tyrefem.diagnose import DiagnosisData
from tyrefem.diagnose.beside.discrepancy import ENERGY, HEAT, NONE, READINGS
from tyrefem.diagnose.beside.robustness import Robustness, UnderDiscrepancy
from tyrefem.diagnose.blind.blind_case import outcome_row
from tyrefem.diagnose.fitting.fits import FittedSet
from tyrefem.diagnose.heat.sources import UnknownSource
from tyrefem.diagnose.inference.evidence import Posterior
from tyrefem.diagnose.unknowns.energy_shapes import energy_shapes
from tyrefem.diagnose.unknowns.heat_patches import ALL_LAYERS
from tyrefem.diagnose.words.discrepancy_record import possible_effects
from tyrefem.diagnose.words.headline import headline
from tyrefem.diagnose.words.record import record
from tyrefem.diagnose.words.sentences import verdict_words
from tyrefem.diagnose.words.verdicts.unexplained import MOST, explaining_words


def beside_energy(d: DiagnosisData, left: float) -> FittedSet:
    """A fit of no effect whose half waves raise the heat at the crown; ``left``: share of the deviation that it leaves.

    Noise does not explain the rest.
    """
    shapes = energy_shapes(d.original, d.gap.settings)
    mean = np.zeros(len(shapes))
    mean[:3] = 0.3
    covariance = np.diag([0.03**2] * len(shapes))
    posterior = Posterior(mean, covariance, 0.0, np.zeros(len(shapes), dtype=bool), np.zeros(len(shapes)))
    runs = dict(enumerate(d.gap.runs))
    computed = {i: run.measured - left * (run.measured - d.before[i]) for i, run in runs.items()}
    return replace(d.null, unknowns=shapes, posterior=posterior, computed=computed, misfit=1e6)


def with_models(d: DiagnosisData, left: float, leading_p: float) -> DiagnosisData:
    """As if errors of the readings were most probable, with this probability of their misfit."""
    d = unexplained(d, 1e3)
    misfit = d.best.readings if leading_p else 1e6
    readings = replace(d.null, misfit=float(misfit))
    models = (
        UnderDiscrepancy(READINGS, 4.0, "errors of the readings", 0.9, {"hot-road": 0.4}, (), {}, {(): readings}),
        UnderDiscrepancy(ENERGY, 0.0, "another strain energy", 0.1, {}, (), {}, {(): beside_energy(d, left)}),
    )
    return replace(d, robustness=Robustness(models))


def test_a_strain_energy_that_explains_most_is_told_with_place_and_amount(case: Case) -> None:
    d = with_models(case.diagnosis, left=0.2, leading_p=0.0)
    sentence = explaining_words(d)
    assert sentence.startswith("Another strain energy along the meridian explains ")
    # 0.2 of the deviation is left, and the scatter within blocks.
    before = d.rms(after=False, held_out=False)
    assert f"(rms {before:.1f} to " in sentence
    assert "more heat in the crown" in sentence
    assert sentence in verdict_words(d)
    assert "another strain energy along the meridian explains" in headline(d)[0]
    assert possible_effects(d) == {}


def test_a_strain_energy_that_explains_little_is_not_told(case: Case) -> None:
    assert explaining_words(with_models(case.diagnosis, left=1.1 - MOST / 2, leading_p=0.0)) == ""


def test_effects_that_may_act_beside_a_discrepancy_are_in_the_set(case: Case) -> None:
    d = with_models(case.diagnosis, left=0.2, leading_p=0.5)
    assert possible_effects(d) == {"hot-road": pytest.approx(0.4)}
    assert "If that holds, these effects may act beside it: hot-road (40 %)." in " ".join(verdict_words(d))
    assert record(d)["possible_effects"] == {"hot-road": pytest.approx(0.4)}
    assert "hot-road" in outcome_row(d)["set"]
    assert outcome_row(d)["named"] == []


def with_source(d: DiagnosisData, lead: float) -> DiagnosisData:
    """As if heat began late in the sidewall, with this lead over the most probable discrepancy model, nats."""
    assert d.robustness is not None
    source = UnknownSource(
        0.095, ALL_LAYERS, True, 1.2e5, 3e3, {0.095: 1.0}, {ALL_LAYERS: 1.0}, "begins", {"begins": 1.0}, 336.0, 14.0,
        (), (), 500.0,
    )  # fmt: skip
    over_time: Any = SimpleNamespace(clear=(source,), cools=True)
    evidence = d.robustness.log_evidence + math.log(d.robustness.models[0].probability) + lead
    return replace(d, missing=replace(d.missing, over_time=over_time, log_evidence=evidence))


@pytest.mark.parametrize(("lead", "heat"), [(20.0, True), (-20.0, False)])
def test_errors_of_the_readings_are_told_only_where_heat_explains_less(case: Case, lead: float, heat: bool) -> None:
    d = with_models(case.diagnosis, left=0.2, leading_p=0.5)
    assert d.robustness is not None
    d = with_source(replace(d, robustness=replace(d.robustness, log_evidence=-500.0)), lead)
    first, words = headline(d)[0], " ".join(verdict_words(d))
    assert ("heat is missing in mid sidewall" in first) is heat
    assert ("errors of the readings would explain it" in first) is not heat
    assert ("Errors of the readings would explain it." in words) is not heat
    assert ("state such errors if readings or model may have them" in headline(d)[2]) is not heat
    may = (
        "Beside errors of the readings these effects may act"
        if heat
        else "If that holds, these effects may act beside it"
    )
    assert f"{may}: hot-road (40 %)." in words


@pytest.mark.parametrize(
    ("lead", "may"), [(20.0, "Beside errors of the readings may act"), (-20.0, "If that holds, beside it may act")]
)
def test_a_likely_effect_is_told_with_what_it_acts_beside(case: Case, lead: float, may: str) -> None:
    d = with_models(case.diagnosis, left=0.2, leading_p=0.5)
    assert d.robustness is not None
    first, *others = d.robustness.models
    models = (replace(first, named={"hot-road": 0.6}), *others)
    d = with_source(replace(d, robustness=replace(d.robustness, models=models, log_evidence=-500.0)), lead)
    assert headline(d)[0].endswith(f"{may}: hot-road (60 %).")


def test_a_model_that_explains_the_deviation_only_with_an_effect_is_told_with_it(case: Case) -> None:
    """Errors of 0.5 K were said to explain a deviation of 15 K by themselves."""
    d = with_models(case.diagnosis, left=0.2, leading_p=0.5)
    assert d.robustness is not None
    first, *others = d.robustness.models
    hot, sun = (next(each for each in d.candidates if each.key == key) for key in ("hot-road", "sun"))
    beside = replace(first, best=(sun, hot), named={"hot-road": 0.999, "sun": 0.3})
    words = "rrors of the readings would explain it together with hot-road."
    d = replace(d, robustness=Robustness((beside, *others)))
    assert f"; e{words}" in headline(d)[0]
    assert f"E{words}" in verdict_words(d)


def test_contained_air_has_no_place_to_check(case: Case) -> None:
    d = unexplained(case.diagnosis, 1e3)
    assert "its place, its channel and the drive" in headline(d)[2]
    of_air = replace(d)
    of_air.__dict__["where"] = d.where.assign(sensor="contained-air")
    assert "Check contained-air in run" in headline(of_air)[2]
    assert "its channel and the drive" in headline(of_air)[2]
    assert "its place" not in headline(of_air)[2]
    assert "its channel, the run's drive, and the stated uncertainties" in " ".join(verdict_words(of_air))


def test_heat_that_explains_the_deviation_is_told_with_its_place(case: Case) -> None:
    d = with_models(case.diagnosis, left=0.2, leading_p=0.5)
    assert d.robustness is not None
    first, *others = d.robustness.models
    models = (replace(first, name=HEAT, words="heat of unknown origin"), *others)
    d = with_source(replace(d, robustness=replace(d.robustness, models=models, log_evidence=-500.0)), 20.0)
    assert "heat is missing in mid sidewall" in headline(d)[0]
    assert "heat of unknown origin would explain it" not in headline(d)[0]


@pytest.mark.parametrize("share", [0.4, 0.01])
def test_effects_alone_that_the_data_do_not_exclude_are_told(case: Case, share: float) -> None:
    """A strain energy leads by 60 to 40 %: the hot road, certain without it, stands in the first sentence too."""
    d = with_models(case.diagnosis, left=0.2, leading_p=0.5)
    assert d.robustness is not None
    first = replace(d.robustness.models[0], name=ENERGY, words="another strain energy", probability=1 - share)
    hot = next(candidate for candidate in d.candidates if candidate.key == "hot-road")
    fit = replace(d.null, misfit=float(d.null.readings))
    none = UnderDiscrepancy(NONE, 0.0, "as it is", share, {"hot-road": 0.999, "sun": 0.2}, (hot,), {}, {(hot,): fit})
    d = replace(d, robustness=Robustness((first, none)))
    wrong, sure, step = headline(d)
    told = share > 0.05
    assert ("Or effects alone explain it: hot-road (99.9 %)." in wrong) is told
    assert ("is sure to explain the deviation" in wrong) is told
    assert ("Another strain energy: 60 % probable, effects alone 40 %" in sure) is told
    assert ("find out whether hot-road acted" in step) is told
    assert ("Or effects alone explain it (40 % probable): hot-road (99.9 %)." in verdict_words(d)) is told
