"""What a table of variants says: limits, the Pareto front, tolerances, indices, the envelope."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tyrefem import study
from tyrefem.api import Study
from tyrefem.errors import InputError
from tyrefem.inputs.uncertain_numbers import stated_deviations
from tyrefem.reduced.surrogate import SurrogateCertificate
from tyrefem.reports import sweep_answer_figures as answer_pictures  # noqa: F401  registers its pictures
from tyrefem.reports.sweep_figures import figures
from tyrefem.reports.sweep_files import computation_sentence
from tyrefem.sweep.envelope import Envelope, SpeedSearch, _speed_words, checked_pairs, envelope
from tyrefem.sweep.evaluation import Evaluator
from tyrefem.sweep.optimum import Optimum, optimum
from tyrefem.sweep.pareto import ParetoFront, front, undominated
from tyrefem.sweep.responses import Responses, main_effects
from tyrefem.sweep.sobol_indices import Indices, indices
from tyrefem.sweep.sweep import Sweep, sweep
from tyrefem.sweep.tornado import Tornado, tolerances, tornado_plan
from tyrefem.variants.answer_units import name_of
from tyrefem.variants.answers import TIME_TO, answer_names
from tyrefem.variants.blocks import packed
from tyrefem.variants.card import EnvelopeCard, LimitCard, OptimiseCard
from tyrefem.variants.execution import Execution
from tyrefem.variants.outcomes import Answered, Failed
from tyrefem.variants.plan import Plan, plan_of
from tyrefem.variants.samples import drawn
from tyrefem.variants.varied import Varied

SALTELLI = {"sample": "saltelli", "seed": 1}


@pytest.fixture(scope="module")
def tyre() -> Study:
    return study("nasa-22x5.5-8pr", {"mesh.size": "12 mm", "numerics.tolerance": "0.5 K", "drive.duration": "120 s"})


@pytest.fixture(scope="module")
def swept(tyre: Study) -> Sweep:
    plan = plan_of(
        tyre,
        {"drive.speed": ("10 mph", "30 mph", 3), "materials.tread.loss_tangent.value": ["0.1", "0.3"]},
        limits={"hottest_degC": {"below": 40.0}},
        time_to="35 degC",
    )
    return sweep(plan)


def test_changes_act_in_every_variant(tyre: Study) -> None:
    warm = tyre.sweep({"drive.speed": ["10 mph", "20 mph"]}, change={"drive.ambient": "60 degC"}, reduced="never")
    alone = tyre.replace({"drive.ambient": "60 degC", "drive.speed": "20 mph"}).run()
    assert warm.table["hottest_degC"].iloc[1] == pytest.approx(alone.history.maximum.temperature, abs=1e-9)


def test_every_variant_is_the_run_of_its_study(swept: Sweep, tyre: Study) -> None:
    row = swept.table.iloc[3]
    alone = tyre.replace({"drive.speed": "20 mph", "materials.tread.loss_tangent.value": "0.3"}).run()
    assert row["hottest_degC"] == pytest.approx(alone.history.maximum.temperature, abs=1e-6)
    assert row["rolling_resistance_coefficient"] == pytest.approx(alone.rolling_resistance.coefficient, rel=1e-9)
    assert row["contained-air_degC"] == pytest.approx(float(alone.gas_temperature[-1]), abs=1e-6)
    shares = [name for name in swept.table if name.endswith("_share") and name.startswith(("lost", "stored"))]
    assert row[shares].sum() == pytest.approx(1.0, abs=1e-3)


def test_limits_say_what_is_feasible(swept: Sweep) -> None:
    assert (swept.table["feasible"] == (swept.table["hottest_degC"] < 40.0)).all()
    assert 0 < swept.table["feasible"].sum() < len(swept.table)


def test_hotter_variants_reach_a_temperature_sooner(swept: Sweep) -> None:
    reached = swept.table.dropna(subset=["time_to_limit_s"]).sort_values("hottest_degC")
    assert len(reached) >= 2
    assert (np.diff(reached["time_to_limit_s"]) < 0).all()
    assert (swept.table["time_to_limit_s"].isna() == (swept.table["hottest_degC"] < 35.0)).all()


def test_a_time_that_is_never_reached_is_the_longest(swept: Sweep, tyre: Study) -> None:
    # What stays below 35 degC never gets there.
    cool = Sweep(replace(swept.plan, limits={"hottest_degC": LimitCard(below=35.0)}), swept.outcomes)
    assert 0 < cool.table["feasible"].sum() < len(cool.table)
    words = Responses(cool).words
    assert "Time to the given temperature of those: never." in words
    latest = front(swept.table.assign(feasible=True), {TIME_TO: "max", "hottest_degC": "max"})
    assert latest[TIME_TO].isna().sum() == 1
    assert latest["hottest_degC"].max() == swept.table["hottest_degC"].max()
    coolest = swept.table[swept.table[TIME_TO].isna()]["hottest_degC"]
    assert latest[latest[TIME_TO].isna()]["hottest_degC"].tolist() == [coolest.max()]


def test_limits_that_nothing_keeps_are_said_to_be_so(swept: Sweep) -> None:
    none = Sweep(replace(swept.plan, limits={"hottest_degC": LimitCard(below=20.0)}), swept.outcomes)
    words = Responses(none).words
    assert words[0] == "None of 6 variants keeps the limits."
    assert words[1].startswith("Highest temperature of all: from")
    # The limit, 10 K below all of them, does not press the curves together.
    for _, _, picture in figures(Responses(none)):
        low, high = picture.axes[0].dataLim.intervaly
        assert picture.axes[0].get_ylim()[0] > low - (high - low)


def test_one_of_anything_is_said_in_the_singular(swept: Sweep, tyre: Study) -> None:
    coolest, second = sorted(swept.table["hottest_degC"])[:2]
    limits = {"hottest_degC": LimitCard(below=(coolest + second) / 2)}
    one = Sweep(replace(swept.plan, limits=limits), swept.outcomes)
    assert Responses(one).words[0] == "1 of 6 variants keeps the limits."
    front_of_one = ParetoFront(one, {"hottest_degC": "min", "rolling_resistance_coefficient": "min"})
    assert front_of_one.words[0].startswith("1 of 1 variants is not dominated")
    card = EnvelopeCard(below=120.0, loads=("2 kN",), pressures=("500 kPa",))
    answer = envelope(tyre, card, scheduler=Formula(heated), reduced="never")
    assert replace(answer, runs=1).words[-1] == "Computed by 1 full run."
    certificate = SurrogateCertificate({}, cases=4, worst=0.5, tolerance=1.0, trained_on=12, amended=1)
    by_model = Sweep(swept.plan, swept.outcomes, certificate, "")
    assert "from 11 runs and 1 correction, within" in computation_sentence(by_model)


def test_one_failing_variant_is_recorded_and_the_sweep_goes_on(tyre: Study) -> None:
    # Each value alone is possible; together the load is more than the tyre carries at that pressure.
    plan = plan_of(tyre, {"drive.load": ["2000 lbf", "5000 lbf"], "drive.pressure": ["60 psi", "156 psi"]})
    swept = sweep(plan)
    assert swept.complete
    assert len(swept.failed) + int((swept.table["failure"] == "").sum()) == 4


def test_front_knows_what_is_better_and_refuses_unknown_answers(swept: Sweep) -> None:
    best = front(swept.table, {"hottest_degC": "min"})
    assert best["hottest_degC"].tolist() == [swept.table["hottest_degC"].min()]
    most = front(swept.table.assign(feasible=True), {"hottest_degC": "max"})
    assert most["hottest_degC"].tolist() == [swept.table["hottest_degC"].max()]
    with pytest.raises(InputError, match="did you mean 'hottest_degC'"):
        front(swept.table, {"hotest_degC": "min"})


class Formula:
    """Answers by a formula of the changed numbers in place of runs: what a search must find is known."""

    def __init__(self, formula: Callable[[list[float]], float], answer: str = "hottest_degC") -> None:
        self.formula, self.answer, self.asked = formula, answer, 0

    def outcomes(self, work: Any, tasks: Any, common: Any = None) -> Any:
        for place, task in enumerate(tasks):
            self.asked += 1
            numbers = [float(str(value).split()[0]) for value in task.changes.values()]
            # The study as it is changes nothing.
            value = self.formula(numbers) if numbers else 99.0
            answers = {self.answer: value, "gas_pressure_Pa": numbers[0] if numbers else 0.0}
            yield place, Answered(answers) if math.isfinite(value) else Failed("burst")


def ishigami(numbers: list[float]) -> float:
    x, y, z = (float(value) for value in numbers)
    return math.sin(x) + 7 * math.sin(y) ** 2 + 0.1 * z**4 * math.sin(x)


def test_indices_of_the_ishigami_function(tyre: Study) -> None:
    box = dict.fromkeys(("sensors.crown-inner.noise", "sensors.crown-inner.accuracy", "sensors.crown-inner.lag_sd"))
    varied = tuple(Varied(key, "K", low=-math.pi, high=math.pi) for key in box)
    variants = drawn(varied, "saltelli", 512, 1)
    plan = Plan(tyre, varied, tuple(variants), tuple(map(str, range(len(variants)))), {}, None, SALTELLI)
    answer = indices(sweep(plan, scheduler=Formula(ishigami), reduced="never"), "hottest_degC").set_index("number")
    # Ishigami & Homma (1990), a = 7, b = 0.1: variance 13.845, shares of the three alone and with all others.
    exact = {"first": [0.3139, 0.4424, 0.0], "total": [0.5576, 0.4424, 0.2437]}
    for column, values in exact.items():
        for key, value in zip(box, values, strict=True):
            assert answer.loc[key, column] == pytest.approx(value, abs=0.06)
            assert abs(answer.loc[key, column] - value) < 2 * answer.loc[key, f"{column}_95"] + 0.01


def test_indices_need_their_sample_and_every_variant(swept: Sweep, tyre: Study) -> None:
    with pytest.raises(InputError, match="saltelli"):
        indices(swept, "hottest_degC")
    box = {"drive.speed": ("10 m/s", "11 m/s"), "drive.ambient": ("10 degC", "11 degC")}
    plan = plan_of(tyre, box, sample="saltelli", count=4)
    burst = sweep(plan, scheduler=Formula(lambda x: math.inf if x[0] > 10.5 else x[0]), reduced="never")
    with pytest.raises(InputError, match="variants have no 'hottest_degC'"):
        indices(burst, "hottest_degC")
    assert "No Sobol indices" in Indices(burst, ("hottest_degC",)).words[0]
    with pytest.raises(InputError, match="power of two"):
        plan_of(tyre, box, sample="saltelli", count=5)


def test_tornado_moves_every_number_alone(tyre: Study) -> None:
    given = {"materials.tread.loss_tangent.value": 0.2, "materials.carcass.loss_tangent.value": 0.1}
    answer = Tornado(sweep(tornado_plan(tyre, given)), ("hottest_degC",))
    table = answer.of("hottest_degC")
    assert set(table["number"]) == set(given)
    assert (table["more"] > 0).all()
    assert (table["less"] < 0).all()
    assert table["range"].is_monotonic_decreasing
    assert table["nominal"].iloc[0] == pytest.approx(tyre.run().history.maximum.temperature, abs=1e-6)
    assert "depends most on materials." in answer.words[0]
    first, second, *_ = repr(answer).splitlines()
    assert first == "Which tolerance matters", "a notebook shows the sentences, not the fields of a dataclass"
    assert second.startswith("  The highest temperature, ")
    with pytest.raises(InputError, match="answer: no answer 'hottest'; did you mean 'hottest_degC'"):
        answer.of("hottest")


def test_cases_in_memory_are_refused_in_one_line(tyre: Study) -> None:
    table = pd.DataFrame({"name": ["slow", "fast"], "drive.speed [mph]": [10, 20]})
    for cases in (table, [{"drive.speed": "10 mph"}], b"cases.csv"):
        with pytest.raises(InputError, match=r"^cases: must be the path of a CSV file or workbook, not a ") as caught:
            plan_of(tyre, {}, sample="list", cases=cases)
        assert "\n" not in str(caught.value)


def test_tornado_takes_the_tolerances_that_cards_state(tyre: Study) -> None:
    plan = tornado_plan(tyre)
    assert plan.sampling["tolerances"] == tyre.uncertainty
    assert len(plan.variants) == 2 * len(tyre.uncertainty) + 1
    with pytest.raises(InputError, match="did you mean 'tread'"):
        tornado_plan(tyre, {"materials.tred.loss_tangent.value": 0.2})


def test_a_sample_of_all_uncertain_numbers_moves_a_shared_card_as_one(tyre: Study) -> None:
    stiff = {"relative_sd": 0.2}
    shared = {f"materials.{value}": {"base": "nasa-tread", "shear_modulus": stiff} for value in ("tread", "sidewall")}
    study = tyre.replace(shared)
    plan = plan_of(study, {"drive.speed": ("10 mph", "30 mph")}, uncertain=1.5, sample="latin-hypercube", count=6)
    assert {value.key for value in plan.varied} == {"drive.speed", *study.uncertainty}
    key, other = (f"materials.{value}.shear_modulus.value" for value in ("tread", "sidewall"))
    factors = [plan.row(n)[f"{key} [x]"] for n in range(6)]
    assert min(factors) > 0.7
    assert max(factors) < 1.3
    assert max(factors) - min(factors) > 0.3
    for variant, factor in zip(plan.variants, factors, strict=True):
        assert variant[key] == variant[other] == f"{335 * factor:.9g} psi"
    assert f"{other} [x]" not in plan.row(0)
    assert other not in plan.row(0)
    with pytest.raises(InputError, match=r"uncertain: 5 standard deviations of 'materials\..*reach zero"):
        plan_of(study, {}, uncertain=5, sample="latin-hypercube", count=4)
    with pytest.raises(InputError, match=r"uncertain: 'materials.tread' varies as a whole"):
        plan_of(study, {"materials.tread": ["nasa-tread", "rubber-tread-aircraft"]}, uncertain=1)


def test_an_uncertain_temperature_is_a_column_of_degrees(tyre: Study) -> None:
    """A factor on kelvins means nothing to a person."""
    study = tyre.replace({"drive.ambient": "25 degC", "uncertainty": {"drive.ambient": "3 K", "drive.load": "2 %"}})
    plan = plan_of(study, {}, uncertain=2, sample="latin-hypercube", count=8)
    ambient = [plan.row(n)["drive.ambient [degC]"] for n in range(8)]
    assert 19 <= min(ambient) < 20.5
    assert 29.5 < max(ambient) <= 31
    assert plan.variants[0]["drive.ambient"] == f"{ambient[0]:.9g} degC"
    assert 0.96 <= plan.row(0)["drive.load [x]"] <= 1.04
    assert tornado_plan(study).sampling["in_words"]["drive.ambient"] == "±3 K"


def test_a_reduced_model_follows_uncertain_numbers(tyre: Study) -> None:
    """Moved in two regions at once, by full runs and by the model."""
    from tyrefem.reduced.surrogate import why_outside

    shared = {f"materials.{entry}": "nasa-tread" for entry in ("tread", "sidewall")}
    plan = plan_of(tyre.replace(shared), {}, uncertain=1, sample="sobol", count=2)
    for variant in plan.variants:
        assert why_outside(plan.study.replace(variant), plan.study, plan.varied) == ""
    alone = {key: value for key, value in plan.variants[0].items() if not key.startswith("materials.sidewall.")}
    assert len(alone) < len(plan.variants[0])
    assert "does not change with" in why_outside(plan.study.replace(alone), plan.study, plan.varied)


BOX = {"drive.speed": ("10 m/s", "20 m/s"), "drive.ambient": ("10 degC", "30 degC")}


def test_optimum_of_a_bowl(tyre: Study) -> None:
    plan = plan_of(tyre, BOX, optimise={"minimise": "hottest_degC"})
    bowl = Formula(lambda x: (x[0] - 13) ** 2 + (x[1] - 22) ** 2 + 40)
    answer = optimum(plan, OptimiseCard(minimise="hottest_degC", runs=600), scheduler=bowl, reduced="never")
    assert answer.full["hottest_degC"] == pytest.approx(40.0, abs=0.05)
    assert float(answer.changes["drive.speed"].split()[0]) == pytest.approx(13.0, abs=0.3)
    assert len(answer.table) <= 600
    assert answer.table["best_so_far"].is_monotonic_decreasing
    assert answer.table["best_so_far"].iloc[-1] == answer.full["hottest_degC"]
    assert repr(answer).startswith("Optimum\n  Smallest highest temperature: ")
    assert len(repr(answer)) < 800


def test_optimum_keeps_its_limits(tyre: Study) -> None:
    plan = plan_of(tyre, BOX, limits={"gas_pressure_Pa": {"above": 15.0}}, optimise={"minimise": "hottest_degC"})
    answer = optimum(plan, OptimiseCard(minimise="hottest_degC", runs=600), scheduler=Formula(sum), reduced="never")
    assert answer.full["hottest_degC"] == pytest.approx(25.0, abs=0.1)
    assert answer.full["gas_pressure_Pa"] > 15.0
    beyond = plan_of(tyre, BOX, limits={"gas_pressure_Pa": {"above": 30.0}}, optimise={"minimise": "hottest_degC"})
    none = optimum(beyond, OptimiseCard(minimise="hottest_degC", runs=60), scheduler=Formula(sum), reduced="never")
    assert none.best is None
    assert "no variant keeps the limits" in none.words[0]


def test_optimum_of_listed_values_tries_every_combination_once(tyre: Study) -> None:
    box = {"drive.speed": ["10 m/s", "11 m/s", "12 m/s"], "drive.ambient": ["10 degC", "20 degC"]}
    plan = plan_of(tyre, box, optimise={"maximise": "hottest_degC"})
    scheduler = Formula(lambda x: x[0] * x[1])
    # Six variants are too few to train a reduced model for, whatever the search may run.
    answer = optimum(plan, OptimiseCard(maximise="hottest_degC"), scheduler=scheduler, reduced="auto")
    assert answer.exhaustive
    assert answer.swept.certificate is None
    assert answer.changes == {"drive.speed": "12 m/s", "drive.ambient": "20 degC"}
    assert scheduler.asked == 6 + 1  # and the study as it is


def test_an_optimum_of_failures_alone_speaks_of_no_limits(tyre: Study) -> None:
    plan = plan_of(tyre, {"drive.speed": ["10 m/s", "11 m/s"]}, optimise={"minimise": "hottest_degC"})
    failing = Formula(lambda x: math.inf)
    answer = optimum(plan, OptimiseCard(minimise="hottest_degC"), scheduler=failing, reduced="never")
    expected = "Smallest highest temperature: no variant has a number (2 different variants evaluated, 2 failed)."
    assert answer.words == [expected]


def test_a_search_passes_over_failures_and_mixes_lists_with_ranges(tyre: Study) -> None:
    box = {"drive.speed": ("10 m/s", "20 m/s"), "drive.ambient": ["10 degC", "20 degC", "30 degC"]}
    plan = plan_of(tyre, box, optimise={"minimise": "hottest_degC"})
    # Ends of the list are dearer, and below 12 m/s there is no answer.
    broken = Formula(lambda x: math.inf if x[0] < 12 else 1000 + x[0] + 50 * (x[1] != 20))
    answer = optimum(plan, OptimiseCard(minimise="hottest_degC", runs=400), scheduler=broken, reduced="never")
    assert answer.full["hottest_degC"] == pytest.approx(1012.0, abs=0.2)
    assert answer.changes["drive.ambient"] == "20 degC"
    assert (answer.table["failure"] != "").any()


def test_an_interrupted_search_goes_on_without_running_anything_twice(tyre: Study, tmp_path: Path) -> None:
    plan, card = (
        plan_of(tyre, BOX, optimise={"minimise": "hottest_degC"}),
        OptimiseCard(minimise="hottest_degC", runs=60),
    )
    first, again = Formula(sum), Formula(sum)
    search = optimum(plan, card, scheduler=first, folder=tmp_path, reduced="never")
    other = optimum(plan, card, scheduler=again, folder=tmp_path, reduced="never")
    assert again.asked == 1  # the study as it is
    assert first.asked == len(search.table) + 1
    assert other.changes == search.changes
    assert other.swept.resumed == len(search.table)


class Optimist:
    """A reduced model that says half a kelvin too little, and knows it."""

    certificate = SurrogateCertificate({"hottest_degC": 0.5}, cases=4, worst=0.5, tolerance=1.0, trained_on=11)


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch) -> list[Optimist]:
    """Every model that was made."""
    models: list[Optimist] = []

    def surrogate(*_: Any, **__: Any) -> Optimist:
        models.append(Optimist())
        return models[-1]

    def by_model(_model: Any, _plan: Any, variants: list[dict[str, str]], _scheduler: Any) -> Any:
        for place, changes in enumerate(variants):
            low = sum(float(value.split()[0]) for value in changes.values()) - 0.5
            yield packed({place: Answered({"hottest_degC": low, "gas_pressure_Pa": 0.0}, "reduced")})

    monkeypatch.setattr("tyrefem.reduced.surrogate.surrogate", surrogate)
    monkeypatch.setattr("tyrefem.sweep.evaluation.by_model", by_model)
    return models


def test_what_a_reduced_model_finds_keeps_its_limits_in_a_full_run(tyre: Study, made: list[Optimist]) -> None:
    limits = {"hottest_degC": {"below": 40.0}}
    plan, scheduler = plan_of(tyre, BOX, limits=limits, optimise={"maximise": "hottest_degC"}), Formula(sum)
    answer = optimum(plan, OptimiseCard(maximise="hottest_degC", runs=400), scheduler=scheduler)
    assert 39.7 < answer.full["hottest_degC"] < 40.0
    assert scheduler.asked == 2  # the study as it is, and the best variant
    assert answer.words[-1].endswith("error of 0.5 K; highest temperature to ±0.5 K.")
    assert answer.swept.certificate == Optimist.certificate
    assert len(made) == 1
    by = answer.table["by"]
    assert answer.table["error_K"][by == "reduced"].eq(0.5).all()
    assert answer.table["error_K"][by == "full"].eq(0.0).all()
    # The full run of the best variant is no other variant.
    assert answer.to_dict()["evaluated"] == (by == "reduced").sum() == len(answer.table) - 1
    assert answer.words[-2].startswith(f"{len(answer.table) - 1} different variants evaluated")


def test_a_search_that_is_finished_makes_no_model_again(tyre: Study, made: list[Optimist], tmp_path: Path) -> None:
    plan = plan_of(tyre, BOX, limits={"hottest_degC": {"below": 40.0}}, optimise={"maximise": "hottest_degC"})
    card = OptimiseCard(maximise="hottest_degC", runs=60)
    how = Execution(Formula(sum), tmp_path)
    first, again = (optimum(plan, card, how) for _ in "ab")
    assert len(made) == 1
    assert vars(again.swept.certificate) == vars(Optimist.certificate)
    assert again.words == first.words
    # A longer search asks for variants that the folder does not have.
    longer = optimum(plan, OptimiseCard(maximise="hottest_degC", runs=90), how)
    assert len(made) == 2
    assert longer.full["hottest_degC"] >= first.full["hottest_degC"]


def test_how_it_is_carried_out_is_said_by_name_or_in_one(tyre: Study, tmp_path: Path) -> None:
    plan, ticks = plan_of(tyre, {"drive.speed": ["10 m/s", "11 m/s"]}), []
    how = Execution(Formula(sum), tmp_path, progress=lambda *what: ticks.append(what))
    swept, other = sweep(plan, how), sweep(plan, scheduler=Formula(sum), reduced="never")
    assert ticks == [("variants", 0, 2), ("variants", 1, 2), ("variants", 2, 2)]
    assert swept.table["hottest_degC"].tolist() == other.table["hottest_degC"].tolist() == [10.0, 11.0]
    assert sweep(plan, how, progress=None).resumed == 2
    assert sweep(plan, how, progress=None, restart=True).resumed == 0
    assert len(ticks) == 3
    assert how.within("envelope").folder == tmp_path / "envelope"
    wrong = {"reduced": "never", "tolerance": "positive", "foldr": "did you mean 'folder'"}
    for (name, message), value in zip(wrong.items(), ("perhaps", 0.0, tmp_path), strict=True):
        with pytest.raises(InputError, match=message):
            tyre.sweep({"drive.speed": ["10 m/s"]}, **{name: value})


def heated(numbers: list[float]) -> float:
    """A tyre whose temperature is 20 + load x speed."""
    load, _, speed = numbers
    return 20.0 + load * speed


def test_a_reduced_answer_of_another_search_is_not_taken_for_a_full_run(tyre: Study, tmp_path: Path) -> None:
    plan = plan_of(tyre, {"drive.speed": ("10 m/s", "20 m/s", 2)})
    execution = Execution(folder=tmp_path, reduced="never", scheduler=Formula(lambda numbers: 20.0 + numbers[0]))
    changes = [{"drive.speed": "12 m/s"}, {"drive.speed": "13 m/s"}]
    with Evaluator(plan, execution) as evaluate:
        assert evaluate._store is not None
        names = [json.dumps(each, sort_keys=True) for each in changes]
        kept = [Answered({"hottest_degC": 1.0}, "reduced"), Answered({"hottest_degC": 2.0}, "full")]
        evaluate._store.add_by_name(dict(zip(names, kept, strict=True)))
        first, second = evaluate(changes)
    assert (first.by, first.answers["hottest_degC"]) != ("reduced", 1.0)
    assert first.by == "full"
    assert second.answers["hottest_degC"] == 2.0


def test_the_envelope_ends_where_the_limit_is_reached(tyre: Study) -> None:
    card = EnvelopeCard(below=120.0, loads=("2 kN", "5 kN", "8 kN"), pressures=("500 kPa",))
    answer = envelope(tyre, card, scheduler=Formula(heated), reduced="never")
    speeds = answer.table["speed_m_s"].tolist()
    assert speeds == pytest.approx([50.0, 20.0, 12.5], rel=0.005)
    assert answer.table["at_limit"].all()
    assert answer.runs < 30
    assert answer.table["settled"].all()
    # Load x speed is the same everywhere: 100 kN m/s = 36.7 t km/h.
    assert answer.rating["tkph"].tolist() == pytest.approx([100 / 9.80665 * 3.6], rel=0.005)


def test_the_envelope_says_where_no_speed_or_every_speed_is_safe(tyre: Study) -> None:
    card = EnvelopeCard(below=25.0, loads=("2 kN", "8 kN"), pressures=("500 kPa",), slowest="1 m/s", fastest="2 m/s")
    answer = envelope(tyre, card, scheduler=Formula(heated), reduced="never")
    assert answer.table["speed_m_s"].iloc[0] == pytest.approx(2.0)
    assert np.isnan(answer.table["speed_m_s"].iloc[1])
    assert not answer.table["at_limit"].any()
    assert answer.words[1] == "at 500 kPa: 7 km/h and more with 2 kN, no speed with 8 kN."
    assert np.isnan(answer.rating["tkph"].iloc[0])


def test_a_search_that_does_not_end_says_so_and_gives_a_safe_speed() -> None:
    search = SpeedSearch(1.0, 100.0, 120.0)
    for _ in range(2):
        search.record(Answered({"hottest_degC": 20.0 + 5.0 * search.next}), "hottest_degC")
    assert search.bracketed
    assert not search.settled
    assert (search.speed, search.value) == (1.0, 25.0)
    row = {"speed_m_s": search.speed, "at_limit": True, "settled": False, "failure": "", "load": "5 kN"}
    assert _speed_words(row) == "4 km/h or more (not settled) with 5 kN"


def test_a_heavier_tyre_must_go_slower_and_what_it_says_is_true(tyre: Study) -> None:
    card = EnvelopeCard(below=40.0, loads=("2000 lbf", "2700 lbf", "3400 lbf"))
    answer = envelope(tyre, card, reduced="never")
    speeds = answer.table["speed_m_s"]
    assert (np.diff(speeds) < 0).all()
    row = answer.table.iloc[1]
    at = {"drive.load": "2700 lbf", "drive.speed": f"{row['speed_m_s']} m/s"}
    assert tyre.replace(at).run().history.maximum.temperature == pytest.approx(row["hottest_degC"], abs=1e-3)
    assert 39.9 < row["hottest_degC"] < 40.0


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"answer": "hotest_degC"}, "did you mean 'hottest_degC'"),
        ({"loads": ("2 kN", "2000 N")}, "given twice"),
        ({"loads": ("2 kg",)}, "not a unit of this quantity"),
        ({"slowest": "9 m/s", "fastest": "3 m/s"}, "no range of speeds"),
    ],
)
def test_an_envelope_that_makes_no_sense_is_refused(tyre: Study, fields: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        checked_pairs(tyre, EnvelopeCard(below=100.0, **fields))


def test_what_a_steeper_loss_tangent_does_is_in_the_words(swept: Sweep) -> None:
    effects = main_effects(swept, "hottest_degC").set_index("number")["effect"]
    assert (effects > 0).all()
    words = " ".join(Responses(swept).words)
    assert f"{int(swept.table['feasible'].sum())} of 6 variants keep the limits" in words


def linear(numbers: list[float]) -> float:
    """A tyre that is 3 K hotter for each m/s, and 7 K cooler for each kN."""
    return 20.0 + 3.0 * numbers[0] - 7.0 * numbers[1]


@pytest.mark.parametrize(("sample", "count"), [("latin-hypercube", 5), ("latin-hypercube", 40), ("sobol", 8)])
def test_main_effects_of_a_random_sample_are_those_of_the_answer(tyre: Study, sample: str, count: int) -> None:
    vary = {"drive.speed": ("5 m/s", "20 m/s"), "drive.load": ("2 kN", "4 kN")}
    plan = plan_of(tyre, vary, sample=sample, count=count)
    table = sweep(plan, scheduler=Formula(linear), reduced="never")
    effects = main_effects(table, "hottest_degC").set_index("number")
    for number, slope in (("drive.speed [m/s]", 3.0), ("drive.load [kN]", -7.0)):
        row = effects.loc[number]
        assert row["effect"] == pytest.approx(slope * (row["high"] - row["low"]), rel=1e-9)
    assert len(effects) == 2


def test_a_grid_with_a_failed_variant_has_the_main_effects_of_its_answer(tyre: Study) -> None:
    plan = plan_of(tyre, {"drive.speed": ("5 m/s", "20 m/s", 3), "drive.load": ["2 kN", "3 kN", "4 kN"]})
    whole = sweep(plan, scheduler=Formula(linear), reduced="never")
    outcomes = {**dict(whole.outcomes), 0: Failed("no equilibrium")}
    for each in (whole, Sweep(plan, outcomes)):
        effects = main_effects(each, "hottest_degC").set_index("number")["effect"]
        assert effects["drive.speed [m/s]"] == pytest.approx(45.0)
        assert effects["drive.load [kN]"] == pytest.approx(-14.0)


def test_too_few_variants_state_no_main_effects(tyre: Study) -> None:
    vary = {"drive.speed": ("5 m/s", "20 m/s"), "drive.load": ("2 kN", "4 kN"), "drive.pressure": ("70 psi", "90 psi")}
    table = sweep(plan_of(tyre, vary, sample="latin-hypercube", count=4), scheduler=Formula(linear), reduced="never")
    assert main_effects(table, "hottest_degC").empty
    words = Responses(table).words
    assert "No main effects on the highest temperature: 4 variants do not tell 3 numbers apart." in words
    assert not any(line.startswith("Main effects") for line in words)
    assert list(figures(Responses(table)))


def test_names_of_answers_are_known_before_anything_runs(swept: Sweep, tyre: Study) -> None:
    text = {"hottest_region"}
    assert set(answer_names(tyre, 35.0)) == set(swept.answers) - text
    assert TIME_TO not in answer_names(tyre)


def test_the_page_of_sweeps_names_every_answer(tyre: Study) -> None:
    """Its table has REGION, SENSOR and WAY for the names that a study gives."""
    page = (Path(__file__).parents[2] / "docs/sweeps.md").read_text(encoding="utf-8")
    table = page.partition("## Answers")[2].partition("`sweep.csv`")[0]
    written = [re.sub("REGION|SENSOR|WAY", ".+", name) for name in re.findall(r"`([\w-]+)`", table)]
    lumped = tyre.replace({"boundaries.rim": {"law": "lumped", "mass": "9 kg", "cooling": "2 W/K", "air": "0.5 W/K"}})
    fatigue = study("passenger-205-55r16", {"output.life": True})
    names = {name for each in (lumped, fatigue) for name in answer_names(each, 35.0)}
    assert {name for name in names if not any(re.fullmatch(pattern, name) for pattern in written)} == set()


def test_no_answer_in_words_repeats_its_unit(tyre: Study) -> None:
    lumped = tyre.replace({"boundaries.rim": {"law": "lumped", "mass": "9 kg", "cooling": "2 W/K", "air": "0.5 W/K"}})
    for name in answer_names(lumped, 35.0):
        words, unit = name_of(name), name.rpartition("_")[2]
        assert "_" not in words
        assert unit in ("share", "coefficient", "cold") or unit not in words.split(), words


@given(st.lists(st.tuples(*3 * [st.integers(0, 4)]), min_size=1, max_size=30))
def test_the_front_is_what_comparing_all_pairs_gives(rows: list[tuple[int, ...]]) -> None:
    values = np.array(rows, dtype=float)
    kept = undominated(values)
    for row, mark in zip(values, kept, strict=True):
        beaten = any((other <= row).all() and (other < row).any() for other in values)
        assert mark == (not beaten)


def test_an_empty_sweep_has_an_empty_table(tyre: Study) -> None:
    plan = plan_of(tyre, {"drive.speed": ("10 mph", "30 mph", 3)})
    assert isinstance(Sweep(plan, {}).table, pd.DataFrame)
    assert Sweep(plan, {}).table.empty


def test_nothing_is_drawn_between_two_cards(tyre: Study) -> None:
    plan = plan_of(tyre, {"materials.tread": ["nasa-tread", "rubber-tread-aircraft"]})
    answer = Responses(Sweep(plan, {n: Answered({"hottest_degC": 50.0 + n}) for n in range(2)}))
    ((name, _, picture),) = figures(answer)
    assert name.startswith("bars-")
    (line,) = picture.axes[0].get_lines()
    assert len(line.get_xdata()) == 2
    assert line.get_linestyle() == "None"
    assert line.get_marker() == "o"


def test_tornado_moves_stiffness_too_and_a_shared_card_as_one(tyre: Study) -> None:
    stiff = {"relative_sd": 0.2}
    shared = {f"materials.{entry}": {"base": "nasa-tread", "shear_modulus": stiff} for entry in ("tread", "sidewall")}
    idle = {"materials.bead.shear_modulus": {"value": "1 MPa", "source": "test", **stiff}}
    study = tyre.replace({**shared, **idle})
    key, other = (f"materials.{entry}.shear_modulus.value" for entry in ("tread", "sidewall"))
    plan = tornado_plan(study)
    assert key in plan.sampling["tolerances"]
    assert other not in plan.sampling["tolerances"]
    moved = [entry for entry in plan.variants if key in entry]
    assert [set(entry) for entry in moved] == [{key, other}, {key, other}]
    answer = Tornado(sweep(tornado_plan(study, {other: 0.2})), ("hottest_degC",))
    (row,) = answer.of("hottest_degC").to_dict("records")
    assert row["also"] == "tread"
    both = study.replace(dict(moved[1])).run().history.maximum.temperature
    assert row["nominal"] + row["more"] == pytest.approx(both, abs=1e-6)
    assert abs(row["more"]) > 0.01
    assert plan.sampling["left_out"] == [
        "left out, because the strain law 'arcs' does not read them: materials.bead.shear_modulus.value"
    ]


def test_every_kind_of_answer_has_registered_pictures() -> None:
    """A new answer needs a function beside the code that draws it; without one nothing is drawn in silence."""
    for kind in (Responses, ParetoFront, Indices, Tornado, Optimum, Envelope):
        assert figures.dispatch(kind) is not figures.dispatch(object), kind
    with pytest.raises(TypeError, match="no pictures are registered for dict"):
        figures({})


SENSOR = {"s": "2 in", "depth": "0.02 in"}


def test_a_sensor_named_as_a_region_has_an_answer_of_its_own(tyre: Study) -> None:
    """Its highest temperature stood in the place of the region's."""
    same = tyre.replace({"sensors.tread": SENSOR, "sensors.other": SENSOR})
    plan = plan_of(same, {"drive.speed": ["10 mph", "20 mph"]})
    assert "tread_sensor_max_degC" in answer_names(same)
    for table in (sweep(plan).table, sweep(plan, reduced="never").table):
        assert (table["tread_max_degC"] > table["tread_sensor_max_degC"]).all()
        assert table["tread_sensor_max_degC"].tolist() == table["other_max_degC"].tolist()


@pytest.mark.parametrize("name", ["hottest", "gas_pressure", "rim", "rolling_resistance"])
def test_a_sensor_has_no_name_of_another_output(name: str, tyre: Study) -> None:
    with pytest.raises(InputError, match=f"'{name}' is a name that readings already use"):
        tyre.replace({f"sensors.{name}": SENSOR})


@pytest.mark.parametrize("name", ["sidewall_max", "tread_max"])
def test_a_sensor_whose_answer_has_the_name_of_another_is_refused(name: str, tmp_path: Path) -> None:
    (tmp_path / "cases.csv").write_text("name,drive.speed [mph]\na,10\n")
    named = study("nasa-22x5.5-8pr", {f"sensors.{name}": SENSOR, "cases": str(tmp_path / "cases.csv")})
    message = rf"sensors\.{name}: '{name}_degC' would be .* e\.g\. '{name}-sensor'"
    with pytest.raises(InputError, match=message):
        plan_of(named, {"drive.speed": ["10 mph", "20 mph"]})
    with pytest.raises(InputError, match=message):
        checked_pairs(named, EnvelopeCard(answer="hottest_degC", below=100.0))
    with pytest.raises(InputError, match=message):
        named.campaign()


@pytest.mark.parametrize(
    "phase", [{"speed": "5 mph"}, {"load": "1 kN"}, {"deflection": "20 mm"}, {"pressure": "60 psi"}]
)
def test_an_envelope_over_phases_of_their_own_is_refused(tyre: Study, phase: dict[str, str]) -> None:
    phased = tyre.replace({"drive.phases": [{"name": "taxi"}, {"name": "tow", **phase}]})
    with pytest.raises(InputError, match=f"the phase 'tow' has a {next(iter(phase))} of its own"):
        checked_pairs(phased, EnvelopeCard(below=100.0, loads=("2 kN",)))
    # Phases that take all of them from [drive] follow the envelope.
    assert checked_pairs(tyre.replace({"drive.phases": [{"name": "taxi"}, {"name": "tow"}]}), EnvelopeCard(below=100.0))


def test_the_tolerance_of_a_temperature_is_in_kelvins(tyre: Study) -> None:
    stated = tyre.replace({"uncertainty": {"drive.ambient": "8 K", "drive.load": "1 %"}})
    answer = Tornado(sweep(tornado_plan(stated)), ("hottest_degC",))
    assert answer.tolerance("drive.ambient") == "±8 K"
    assert answer.tolerance("drive.load") == "±1 %"
    assert "depends most on drive.ambient: ±" in answer.words[0]
    assert "K for ±8 K, then" in answer.words[0]
    # Eight kelvins more or less are those of two runs.
    row = answer.of("hottest_degC").set_index("number").loc["drive.ambient"]
    ends = [tyre.replace({"drive.ambient": f"{t} degC"}).run().history.maximum.temperature for t in (17, 25, 33)]
    assert (row["less"], row["more"]) == pytest.approx((ends[0] - ends[1], ends[2] - ends[1]), abs=1e-3)


def test_a_tornado_without_tolerances_names_the_flag_that_gives_them(tyre: Study) -> None:
    certain = {
        f"materials.{region}.{name}.relative_sd": 0.0
        for region, card in tyre.materials.items()
        for name, _ in stated_deviations(card)
    }
    with pytest.raises(InputError, match="give --tolerance-of KEY=5%"):
        tolerances(tyre.replace(certain))


def test_a_tolerance_of_a_temperature_is_refused_with_the_table_that_takes_kelvins(tyre: Study) -> None:
    with pytest.raises(InputError) as refused:
        tolerances(tyre, {"drive.ambient": 0.05})
    assert str(refused.value).startswith("tornado.tolerances.drive.ambient: ")
    assert "an sd like '2 K' in [uncertainty]" in str(refused.value)
    in_kelvins = tyre.replace({"uncertainty": {"drive.ambient": "2 K"}})
    assert "drive.ambient" in [number.key for number in tolerances(in_kelvins)]
