"""Variants without an answer, with another set of values, or with a time that is never reached."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pandas as pd
import pytest

from tyrefem.api.numbers import check_numbers
from tyrefem.cli.sweep_flags import questions_of_flags, varied
from tyrefem.errors import InputError
from tyrefem.reduced import surrogate as surrogates
from tyrefem.reduced.surrogate import certified
from tyrefem.reports.sweep_files import write_parts, write_table
from tyrefem.sweep.envelope import SpeedSearch
from tyrefem.sweep.optimum import Optimum, objective, violation
from tyrefem.sweep.pareto import front
from tyrefem.sweep.responses import words
from tyrefem.sweep.sweep import Sweep
from tyrefem.variants import answers
from tyrefem.variants.answer_units import shown
from tyrefem.variants.card import LimitCard, OptimiseCard, VaryCard
from tyrefem.variants.outcomes import Answered, Failed
from tyrefem.variants.plan import Plan

TYRE: Any = SimpleNamespace(name="tyre")


def listed(*variants: dict[str, Any], **limits: LimitCard) -> Plan:
    """A plan of a list of variants."""
    names = tuple(str(n + 1) for n in range(len(variants)))
    return Plan(TYRE, (), variants, names, limits, None, {"sample": "list"})


def test_a_sweep_in_which_every_variant_failed_has_its_table_in_spite_of_limits() -> None:
    plan = listed({"drive.speed": 1.0}, {"drive.speed": 2.0}, hottest_degC=LimitCard(below=90.0))
    swept = Sweep(plan, {0: Failed("burst"), 1: Failed("burst")})
    assert swept.table["failure"].tolist() == ["burst", "burst"]
    assert not swept.table["feasible"].any()
    assert words(swept) == []
    assert front(swept.overview(), {"mass_kg": "min"}).empty


def test_a_limit_of_an_answer_that_no_variant_has_is_still_refused() -> None:
    swept = Sweep(listed({"drive.speed": 1.0}, mass_kg=LimitCard(below=9.0)), {0: Answered({"hottest_degC": 50.0})})
    with pytest.raises(InputError, match="no answer 'mass_kg'"):
        _ = swept.table


def test_the_parts_of_a_list_with_empty_cells_have_the_columns_of_the_whole_table(tmp_path: Path) -> None:
    plan = listed({"a": 1.0, "b": 2.0}, {"a": 1.0, "b": 3.0}, {"b": 4.0}, {"b": 5.0, "a": 9.0}, {"c": 7.0}, {"a": 8.0})
    swept = Sweep(plan, {n: Answered({"hottest_degC": 50.0 + n}) for n in range(6)})
    write_table(swept.table, tmp_path, "whole")
    write_parts(swept.parts(2), tmp_path, "parts")
    assert (tmp_path / "parts.csv").read_text() == (tmp_path / "whole.csv").read_text()
    pd.testing.assert_frame_equal(pd.read_parquet(tmp_path / "parts.parquet"), swept.table)


def test_a_time_that_a_validation_run_never_reaches_leaves_the_error_of_the_others() -> None:
    never, late = {"time_to_limit_s": math.nan, "hottest_degC": 50.0}, {"time_to_limit_s": 10.0, "hottest_degC": 50.0}
    later = {"time_to_limit_s": 10.2, "hottest_degC": 50.01}
    for pairs in ([(never, never), (late, later)], [(late, later), (never, never)]):
        errors = certified(pairs, 0.01, 1, 1).errors
        assert errors == pytest.approx({"time_to_limit_s": 0.2, "hottest_degC": 0.01})
    errors = certified([(never, never)], 0.01, 1, 1).errors
    assert errors == {"hottest_degC": 0.0}
    limits = {"time_to_limit_s": LimitCard(above=300.0)}
    assert violation(Answered({"time_to_limit_s": 500.0}, "reduced"), limits, errors) == 0.0


def test_an_optimum_that_is_never_reached_states_no_difference() -> None:
    card = OptimiseCard(maximise="time_to_limit_s")
    nominal = Answered({"time_to_limit_s": 300.0})
    best = {"time_to_limit_s": math.nan}
    swept = Sweep(listed({"drive.speed": 1.0}), {0: Answered(best)})
    sentences = Optimum(swept, card, 0, best, nominal, exhaustive=True, ended="").words
    assert "The study as it is has 300 s." in sentences


def test_a_variant_without_the_answer_is_passed_over() -> None:
    other = Answered({"hottest_degC": 50.0})
    assert objective(other, OptimiseCard(minimise="lost_rim film_share")) == math.inf
    assert violation(other, {"lost_rim film_share": LimitCard(below=0.1)}) > 0
    search = SpeedSearch(1.0, 60.0, 90.0)
    search.record(other, "lost_rim film_share")
    assert search.settled
    assert search.failure == "no answer 'lost_rim film_share'"


def test_a_share_of_no_heat_is_neither_large_nor_small() -> None:
    """A tyre that stands has no heat, so no share of it: it keeps no limit and is the best in nothing."""
    share = "lost_rim_share"
    plan = listed({"drive.speed": 0.0}, {"drive.speed": 1.0}, {"drive.speed": 2.0}, **{share: LimitCard(above=0.1)})
    shares = {0: math.nan, 1: 0.2, 2: 0.3}
    outcomes = {n: Answered({share: value, "hottest_degC": 25.0 + n}) for n, value in shares.items()}
    swept = Sweep(plan, outcomes)
    assert swept.table["feasible"].tolist() == [False, True, True]
    assert [violation(outcome, plan.limits) > 0 for outcome in outcomes.values()] == [True, False, False]
    for card in (OptimiseCard(maximise=share), OptimiseCard(minimise=share)):
        assert objective(outcomes[0], card) == math.inf
    unlimited = Sweep(listed(*plan.variants), outcomes)
    assert front(unlimited.overview((share,)), {share: "max"})["variant"].tolist() == ["3"]
    sentence = words(unlimited, (share,))[0]
    assert sentence == "Lost rim share: from 0.2 (variant 2) to 0.3 (variant 3)."
    assert shown(share, math.nan) == "none"
    search = SpeedSearch(1.0, 60.0, 90.0)
    search.record(outcomes[0], share)
    assert (search.settled, search.failure) == (True, "no number for 'lost_rim_share'")


def test_a_factor_without_end_is_refused() -> None:
    with pytest.raises(InputError, match="two rising positive numbers"):
        VaryCard.check({"factor": [1.0, math.inf]})


def test_a_sensor_with_brackets_in_its_name_has_answers(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(answers, "answer_names", lambda *_: ["hottest_degC", "T[1]_degC", "lost_*_share"])
    for name in ("T[1]_degC", "lost_rim film_share"):
        answers.check_answer(name, TYRE)
    with pytest.raises(InputError, match="no answer 'T1_max_degC'"):
        answers.check_answer("T1_max_degC", TYRE)


def test_the_flag_of_a_tornado_leaves_the_tolerances_of_a_file() -> None:
    assert questions_of_flags(tornado=True) == {"tornado": {}}
    given = questions_of_flags(tornado=True, tolerance_of=["drive.load=5%"])
    assert given == {"tornado": {"tolerances": {"drive.load": "5 %"}}}


@pytest.mark.parametrize("distance", ["20000 km", math.nan, math.inf])
def test_a_distance_of_wear_is_a_number_in_m(distance: Any) -> None:
    with pytest.raises(InputError, match="distance"):
        check_numbers(distance=distance)


def test_a_place_whose_numbers_do_not_fit_together_fails_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    class Picky:
        def replace(self, changes: dict[str, float]) -> dict[str, float]:
            if changes["sensors.crown.depth"] > changes["section.thickness_scale.tread"]:
                raise InputError("is not in the rubber", field="sensors.crown")
            return changes

    def computed(_model: Any, studies: list[dict[str, float]], _time_to: float | None) -> list[Answered]:
        return [Answered({"hottest_degC": each["sensors.crown.depth"]}, "reduced") for each in studies]

    monkeypatch.setattr(surrogates, "reduced_answers", computed)
    plan: Any = SimpleNamespace(study=Picky(), time_to=None)
    places = [{"sensors.crown.depth": depth, "section.thickness_scale.tread": 1.0} for depth in (0.5, 2.0, 0.7)]
    first, second, third = surrogates.answers_of_changes(SimpleNamespace(), plan, places)  # type: ignore[arg-type]
    assert isinstance(first, Answered)
    assert isinstance(third, Answered)
    assert third.answers["hottest_degC"] == 0.7
    assert second == Failed("sensors.crown: is not in the rubber")


def test_a_path_with_a_drives_letter_is_no_range() -> None:
    key, entry = varied(r"materials.tread=C:\cards\soft.toml,D:/cards/hard.toml")
    assert (key, entry) == ("materials.tread", {"values": [r"C:\cards\soft.toml", "D:/cards/hard.toml"]})
