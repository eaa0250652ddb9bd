"""Three sentences for every verdict, at the head of the page, in the record, and on one printed page."""

from __future__ import annotations

import json
import math
import re
import subprocess
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest
from hidden import HASTY, RUNS, Case
from made_up import confounded, judged, unexplained
from matplotlib.colors import to_hex

from tyrefem.api.diagnosis import Diagnosis
from tyrefem.api.diagnosis_record import DiagnosisRecord
from tyrefem.diagnose import DiagnosisData
from tyrefem.diagnose.amend import Change
from tyrefem.diagnose.beside.discrepancy import ENERGY, HEAT, NONE
from tyrefem.diagnose.beside.robustness import Robustness, UnderDiscrepancy
from tyrefem.diagnose.fitting.support import LeftOut, Support
from tyrefem.diagnose.heat.sources import UnknownSource
from tyrefem.diagnose.next_experiment import compared_sets
from tyrefem.diagnose.numbers import percent
from tyrefem.diagnose.unknowns.heat_patches import OUTER
from tyrefem.diagnose.unknowns.unknown import Unknown
from tyrefem.diagnose.verdicts.verdict import CONFOUNDED, IDENTIFIED, NO_GAP, PARTLY, UNEXPLAINED, certain_members
from tyrefem.diagnose.words.corrections import corrections
from tyrefem.diagnose.words.headline import QUESTIONS, headline, label
from tyrefem.diagnose.words.result_tables import rms_table
from tyrefem.diagnose.words.sentences import noise_words, verdict_words
from tyrefem.diagnose.words.support import alone_words, stated_words, support_words
from tyrefem.measured import MeasuredRun
from tyrefem.reports.diagnosis import _numbers, _set, page
from tyrefem.reports.diagnosis_figures import pictures, probabilities_figure, rms_figure
from tyrefem.reports.diagnosis_gap import AFTER
from tyrefem.reports.diagnosis_summary import (
    CHARACTERS,
    HEIGHT,
    LEAST_PICTURE,
    MOST_PICTURE,
    SummaryTable,
    clipped,
    picture_height,
    summary,
    summary_tables,
)
from tyrefem.reports.notebook import GOOD, diagnosis_page, diagnosis_record_page


def no_gap(d: DiagnosisData, gap: bool) -> DiagnosisData:
    """As if no effect were missing; ``gap``: with the gap of the original, else with the readings after the fit."""
    judgement = replace(judged(d, NO_GAP, {(): 0.93, ("sun",): 0.07}).judgement)
    load = next(unknown for unknown in d.null.unknowns if unknown.effect is None)
    changes = (Change(load, d.null.values[load], d.null.sd[load], False, "test"),)
    return replace(d, judgement=judgement, best=d.null, changes=changes, before=d.before if gap else d.after)


def doubted(d: DiagnosisData) -> DiagnosisData:
    doubt = "Sun predicts the held-out runs better than hot-road, by 45 nats."
    return judged(d, CONFOUNDED, {("hot-road",): 0.999, ("sun",): 0.001}, doubts=(doubt,))


def none_doubted(d: DiagnosisData) -> DiagnosisData:
    """As if no effect were most probable, and a hot road predicted the held-out runs better."""
    doubt = "Hot-road predicts the held-out runs better than no effect, by 7 nats."
    return replace(judged(d, CONFOUNDED, {(): 0.93, ("hot-road",): 0.07}, doubts=(doubt,)), best=d.null)


def certain(d: DiagnosisData) -> DiagnosisData:
    return judged(d, CONFOUNDED, {("hot-road", "sun"): 0.54, ("hot-road",): 0.45, ("sun",): 0.01})


def rejected(d: DiagnosisData) -> DiagnosisData:
    doubt = "Hot-road explains the data only with improbable corrections: load +12 ± 1 %."
    d = unexplained(d, 1e3)
    return replace(d, judgement=replace(d.judgement, doubts=(doubt,)))


def partly(d: DiagnosisData) -> DiagnosisData:
    """As if another strain energy were probable, and the hot road a part of the cause with it and without."""
    (member,) = d.best.members
    unknown = member.amplitudes[0]
    models = [
        UnderDiscrepancy(name, 0.2, words, share, {member.key: named}, d.best.members, {unknown.key: (x, 1.5)}, {})
        for name, words, share, named, x in (
            (ENERGY, "another strain energy along the meridian", 0.9, 0.99, 24.0),
            (NONE, "the model as it is", 0.1, 0.97, 26.0),
        )
    ]
    judgement = replace(d.judgement, verdict=PARTLY)
    return replace(d, judgement=judgement, robustness=Robustness(tuple(models)))


VERDICTS: dict[str, Callable[[DiagnosisData], DiagnosisData]] = {
    IDENTIFIED: lambda d: d,
    PARTLY: partly,
    CONFOUNDED: confounded,
    "confounded, one certain": certain,
    "confounded, doubted": doubted,
    "confounded, no effect doubted": none_doubted,
    UNEXPLAINED: lambda d: unexplained(d, 1e3),
    "unexplained, rejected": rejected,
    NO_GAP: lambda d: no_gap(d, gap=False),
    "no gap after corrections": lambda d: no_gap(d, gap=True),
}


@pytest.mark.parametrize("kind", VERDICTS)
def test_every_verdict_says_what_is_wrong_how_sure_and_what_to_do(kind: str, case: Case) -> None:
    d = VERDICTS[kind](case.diagnosis)
    wrong, sure, step = headline(d)
    for sentence in (wrong, sure, step):
        assert sentence[0].isupper()
        assert sentence.endswith(".")
        assert "nan" not in sentence
        assert ".." not in sentence
    # How sure: a probability or a doubt, and kelvins; what to do next: something to do.
    assert "%" in sure or "nats" in sure
    assert step.split()[0] in {"Check", "A", "Measure", "Nothing", "Exclude", "State"}
    assert d.to_dict()["headline"] == [wrong, sure, step]


def test_no_effect_that_the_held_out_runs_doubt_is_no_name(case: Case) -> None:
    d = none_doubted(case.diagnosis)
    wrong, sure, _ = headline(d)
    assert wrong == "Perhaps an effect is missing: the road is warmer than stated, as asphalt in the sun is (hot-road)."
    assert sure.startswith(
        "Hot-road predicts the held-out runs better than no effect, by 7 nats (fitted runs alone: 93"
    )
    first, second, *_ = verdict_words(d)
    assert first == "The fitted runs alone need no effect (93 %), but this is not certain."
    assert second == d.judgement.doubts[0]


def test_readings_mostly_outside_the_drive_come_first(case: Case) -> None:
    """Times in a wrong unit: half of a run cannot be compared, and no name says so."""
    runs = []
    for run in case.diagnosis.gap.runs:
        columns = {each.sensor: each.measured for each in run.sensors}
        times = run.sensors[0].times
        runs.append(MeasuredRun(run.name, times * 10.0, pd.DataFrame(columns), channels=("torque [N*m]",)))
    d = case.study.diagnose(runs, settings=HASTY, known=case.diagnosis.gap.responses, rerun=False, verdict_only=True)
    wrong, _, step = headline(d)
    assert wrong.startswith(f"ERROR: run '{runs[0].name}': ")
    assert "measured times lie outside the simulated span 0 to" in wrong
    assert step.startswith("Check the unit of the times")
    assert "columns without temperatures are left out: torque [N*m]" in d.notes
    assert "Columns without temperatures are left out: torque [N*m]" in page(d, {}, version="1")


def test_identified_gives_the_effect_its_value_what_it_moves_and_the_held_out_runs(case: Case) -> None:
    d = case.diagnosis
    wrong, sure, step = headline(d)
    (member,) = d.best.members
    value, sd = d.best.values[member.amplitudes[0]], d.best.sd[member.amplitudes[0]]
    stated = re.search(r"by ([\d.]+) ± ([\d.]+) K", wrong)
    assert stated is not None
    assert float(stated[1]) == pytest.approx(value, abs=0.6)
    assert float(stated[2]) == pytest.approx(sd, rel=0.1)
    assert f"moves crown-outer by up to {d.movements[member].kelvin:+.1f} K" in wrong
    before, after = (d.rms(after=after, held_out=True) for after in (False, True))
    assert f"held-out runs from {before:.1f} to {after:.1f} K" in sure
    assert "no gap is left" in step


def test_a_colder_road_is_colder_without_a_minus(case: Case) -> None:
    d = case.diagnosis
    (member,) = d.best.members
    mean = d.best.posterior.mean.copy()
    mean[d.best.unknowns.index(member.amplitudes[0])] *= -1
    colder = replace(d, best=replace(d.best, posterior=replace(d.best.posterior, mean=mean)))
    wrong = headline(colder)[0]
    assert wrong.startswith("The road is colder than stated, by ")
    assert "warmer" not in wrong
    assert "-" not in wrong.split(" K")[0]


def test_a_part_of_the_cause_has_its_range_and_what_is_beside_it(case: Case) -> None:
    wrong, sure, step = headline(partly(case.diagnosis))
    # Two standard deviations about 24 K and 26 K, without signs: the sentence says warmer.
    assert wrong.startswith("This is a part of it: The road is warmer than stated, as asphalt in the sun is, by 21")
    assert " to 29" in wrong
    assert "moves crown-outer by up to +" in wrong
    assert "besides it the data speak for another strain energy along the meridian" in wrong
    assert "with all readings at least 97 %, whatever else is wrong" in sure
    assert "Check that you believe the range" in step


def test_an_effect_that_is_likely_beside_a_part_of_the_cause_is_told(case: Case) -> None:
    d = partly(case.diagnosis)
    assert d.robustness is not None
    first, *others = d.robustness.models
    fit = replace(d.null, misfit=float(d.null.readings))
    first = replace(first, named={**first.named, "sun": 0.94, "sensor-offset": 0.2}, fits={(): fit})
    d = replace(d, robustness=Robustness((first, *others)))
    assert headline(d)[0].endswith("Perhaps also: sun (94 %).")
    sentence = "Perhaps these act, too: sun (94 %), sensor-offset (20 %). They are not sure enough to be named."
    assert sentence in verdict_words(d)


def test_heat_beside_a_part_of_the_cause_is_one_clause(case: Case) -> None:
    d = partly(case.diagnosis)
    assert d.robustness is not None
    models = (replace(d.robustness.models[0], name=HEAT, words="heat of unknown origin"), d.robustness.models[1])
    sources = tuple(
        UnknownSource(
            station, OUTER, False, -435.0, 11.0, {station: 1.0}, {OUTER: 1.0}, "constant", {"constant": 1.0},
            math.nan, math.nan, (), (), 500.0,
        )
        for station in (0.095, 0.053, 0.137)
    )  # fmt: skip
    over_time: Any = SimpleNamespace(clear=sources, cools=True)
    d = replace(d, robustness=Robustness(models), missing=replace(d.missing, over_time=over_time))
    wrong = headline(d)[0]
    assert wrong.endswith(
        "besides it the model has too much heat, cooling is missing, at the outer surface, in mid sidewall (s = 95 mm "
        "along the meridian): -435 ± 11 W/m²; it is constant in time; and 2 more places."
    )
    two = replace(d, missing=replace(d.missing, over_time=SimpleNamespace(clear=sources[:2], cools=True)))
    assert headline(two)[0].endswith("; and 1 more place.")


def supported(d: DiagnosisData, *left: LeftOut, only_at: str = "") -> DiagnosisData:
    (member,) = d.best.members
    return replace(d, supports={member: Support(left, only_at)})


def test_a_set_is_stated_at_the_confidence_of_its_weakest_member(case: Case) -> None:
    d = case.diagnosis
    chance = percent(d.judgement.probability)
    weak = supported(d, LeftOut("sensor", "crown-outer", 0.62), LeftOut("run", "slow", 0.97))
    assert headline(weak)[1].startswith(
        f"It is at least 62 % probable without any one sensor or run (least without crown-outer); with all readings "
        f"{chance}, among all that was tried; "
    )
    # Without a difference in words, one number.
    sure = supported(d, LeftOut("run", "slow", d.judgement.probability))
    assert headline(sure)[1].startswith(f"It is {chance} probable, also without any one run, among")
    assert headline(replace(d, supports={}))[1].startswith(f"It is {chance} probable, among all that was tried")
    beside = supported(partly(d), LeftOut("sensor", "crown-outer", 0.93))
    assert headline(beside)[1].startswith(
        "It is at least 93 % probable without any one sensor (least without crown-outer); with all readings at "
        "least 97 %, whatever else is wrong; "
    )


def test_the_certain_member_of_a_confounded_set_is_stated_at_its_confidence(case: Case) -> None:
    d = certain(case.diagnosis)
    hot = next(each for each in d.judgement.best.members if each.key == "hot-road")
    assert certain_members(d.judgement, d.gap.settings) == (hot,)
    weak = replace(d, supports={hot: Support((LeftOut("run", "slow", 0.71),))})
    assert headline(weak)[1].startswith(
        "It is at least 71 % probable without any one run (least without run slow); with all readings 99.0 %;"
    )
    assert "It stays at least 71 % probable" in " ".join(verdict_words(weak))
    assert headline(replace(d, supports={}))[1].startswith("It is 99.0 % probable; ")


def test_improbable_corrections_of_a_part_of_the_cause_stand_in_the_first_sentences(case: Case) -> None:
    d = partly(case.diagnosis)
    assert "improbable" not in headline(d)[1]
    load = next(k for k, unknown in enumerate(d.best.unknowns) if unknown.effect is None)
    mean = d.best.posterior.mean.copy()
    mean[load] = 5.1 * d.best.unknowns[load].sd
    strained = replace(d, best=replace(d.best, posterior=replace(d.best.posterior, mean=mean)))
    sure = headline(strained)[1]
    assert "The amended study explains the data only with improbable corrections: " in sure
    assert "+5.1 prior standard deviations" in sure


def test_a_member_that_one_sensor_asks_for_is_said_to_be_that_at_once(case: Case) -> None:
    d = case.diagnosis
    (member,) = d.best.members
    alone = supported(d, LeftOut("sensor", "crown-outer", 0.12), LeftOut("run", "slow", 0.97))
    sure = headline(alone)[1]
    assert sure.startswith("It is only 12 % probable without crown-outer, which alone asks for hot-road; with all")
    assert "Only crown-outer asks" not in sure
    assert "Only crown-outer asks for hot-road: without it the probability is 12 %." in " ".join(verdict_words(alone))
    # A second member of the set, at another sensor, and a fault that only its sensor can show.
    sun = next(each for each in d.candidates if each.key == "sun")
    offset = next(each for each in d.candidates if each.name == "sensor-offset" and not each.runs)
    others = {
        sun: Support((LeftOut("sensor", "sidewall-outer", 0.3),)),
        offset: Support((LeftOut("run", "slow", 0.99),), dict(offset.choice)["sensor"]),
    }
    several = headline(replace(alone, supports={**alone.supports, **others}))[1]
    assert "Only sidewall-outer asks for sun: without it the probability is 30 %." in several
    assert f"{offset.key} can show only at {dict(offset.choice)['sensor']}." in several
    assert support_words(alone) == alone_words(alone)
    assert member in alone.supports


def test_another_run_tells_an_effect_in_one_run_from_that_in_all(case: Case) -> None:
    odd = next(each for each in case.diagnosis.candidates if each.key == "hot-road in slow")
    d = replace(case.diagnosis, supports={odd: Support((LeftOut("run", "loaded", 0.07),), "slow")})
    assert stated_words(d, (odd,), 0.99, "99.0 %") == (
        "It is only 7.0 % probable without run loaded, which alone tells hot-road in slow from the same effect in all "
        "runs; with all readings 99.0 %"
    )


def test_where_no_effect_is_left_one_is_missing_perhaps(case: Case) -> None:
    d = judged(case.diagnosis, CONFOUNDED, {("hot-road",): 0.91, (): 0.09})
    assert headline(d)[0].startswith("Perhaps an effect is missing, but ")
    assert verdict_words(d)[0].startswith("Perhaps an effect is missing, but ")


def test_no_gap_at_a_large_rms_names_its_corrections_and_is_not_green(case: Case) -> None:
    quiet, loud = (no_gap(case.diagnosis, gap=gap) for gap in (False, True))
    assert label(quiet) == NO_GAP
    assert headline(quiet)[0].startswith("Nothing is wrong")
    assert label(loud) == "no gap after corrections"
    wrong, _, step = headline(loud)
    (correction,) = corrections(loud)
    assert f"{loud.rms(after=False, held_out=False):.1f} K in the fitted runs" in wrong
    assert f"({correction.pull.pull:+.1f} sd of what was stated" in wrong
    assert "Measure what was corrected most" in step
    text = page(loud, {}, version="1")
    assert 'class="verdict no-gap-after-corrections"' in text
    assert 'class="verdict no-gap"' not in text


def test_a_notebook_is_not_green_either_where_corrections_close_the_gap(case: Case, tmp_path: Path) -> None:
    quiet, loud = (no_gap(case.diagnosis, gap=gap) for gap in (False, True))
    assert GOOD in diagnosis_page(quiet)
    assert GOOD not in diagnosis_page(loud)
    assert "no gap after corrections" in diagnosis_page(loud)
    Diagnosis.of(loud).save(tmp_path)
    record = json.loads((tmp_path / "verdict.json").read_text(encoding="utf-8"))
    assert (record["verdict"], record["label"]) == (NO_GAP, label(loud))
    back = DiagnosisRecord(tmp_path, "diagnose", True)
    assert back.label == label(loud)
    assert GOOD not in diagnosis_record_page(back)


def test_the_page_gives_corrections_in_standard_deviations_and_kelvins(case: Case) -> None:
    d = no_gap(case.diagnosis, gap=True)
    (correction,) = corrections(d)
    text = page(d, {}, version="1")
    move = correction.move
    assert f"<td>{correction.pull.pull:+.1f}</td>" in text
    assert f"{move.kelvin:+.1f} K ({move.sensor}, {move.run})" in text
    assert f"change no reading by {d.gap.settings.negligible:g} K are left out" in text


def test_the_summary_says_that_the_stated_noise_is_another(case: Case) -> None:
    d = case.diagnosis
    assert noise_words(d) == ()
    runs = tuple(
        replace(run, sensors=tuple(replace(each, origin=replace(each.origin, stated=1.4)) for each in run.sensors))
        for run in d.gap.runs
    )
    other = replace(d, gap=replace(d.gap, runs=runs))
    (sentence,) = noise_words(other)
    assert "the stated noise is 1.4 K" in sentence
    assert sentence in summary(other, version="1")


def test_the_summary_of_a_part_of_the_cause_shows_it_beside_every_discrepancy(case: Case) -> None:
    table = summary_tables(partly(case.diagnosis))[-1]
    assert table.title == "If more is wrong than effects"
    assert table.rows == (
        ("another strain energy along the meridian", "90 %", "hot-road 99.0 %"),
        ("the model as it is", "10 %", "hot-road 97 %"),
    )


def test_python_has_the_sentences_of_the_files(case: Case) -> None:
    d, record = case.diagnosis, json.loads((case.folder / "verdict.json").read_text(encoding="utf-8"))
    back = DiagnosisRecord(case.folder, "diagnose", True)
    assert isinstance(d, Diagnosis)
    assert d.headline == back.headline == tuple(record["headline"])
    assert d.words == back.words == tuple(record["summary"])
    assert d.confidence == back.confidence == record["confidence"] == record["effects"][0]["confidence"]
    assert d.label == back.label == IDENTIFIED
    nameless = Diagnosis.of(replace(no_gap(d, gap=True), supports={}))
    assert nameless.label == "no gap after corrections"
    assert math.isnan(nameless.confidence)


def test_what_a_correction_moves_is_its_sensitivity_times_its_value(case: Case) -> None:
    d = no_gap(case.diagnosis, gap=True)
    (correction,) = corrections(d)
    column = d.gap.unknowns.index(correction.pull.unknown)
    largest = max(float(np.abs(J[:, column]).max()) for J in d.gap.sensitivities.jacobians)
    assert abs(correction.move.kelvin) == pytest.approx(largest * abs(correction.pull.x))


def test_confounded_says_the_sets_in_words_and_what_would_decide(case: Case) -> None:
    wrong, sure, step = headline(confounded(case.diagnosis))
    assert "the road is warmer than stated" in wrong
    assert "the sun shines on the tyre" in wrong
    assert "hot-road 74 %, sun 25 %" in sure
    assert step.startswith("A thermocouple at s = 0 mm, outside")
    # A colder road is told as that in a set, too.
    d = confounded(case.diagnosis)
    first, *others = d.judgement.ranking
    assert first.fit is not None
    (member,) = first.members
    mean = first.fit.posterior.mean.copy()
    mean[first.fit.unknowns.index(member.amplitudes[0])] *= -1
    fit = replace(first.fit, posterior=replace(first.fit.posterior, mean=mean))
    ranking = (replace(first, fit=fit), *others)
    colder = replace(d, judgement=replace(d.judgement, ranking=ranking, credible=ranking[:3]))
    assert "show which: the road is colder than stated (hot-road), or the sun" in headline(colder)[0]
    _, sure, _ = headline(doubted(case.diagnosis))
    assert sure.startswith("Sun predicts the held-out runs better than hot-road, by 45 nats (")
    wrong, sure, _ = headline(certain(case.diagnosis))
    assert wrong.startswith("The road is warmer than stated")
    assert "with all readings 99.0 %" in sure


def test_the_next_experiment_is_about_the_largest_doubt(case: Case) -> None:
    """Hot road and sun at 69 %, the hot road alone at 28 %: the sun is in doubt, not a rare third effect."""
    sets = {("hot-road", "sun"): 0.69, ("hot-road",): 0.28, ("hot-road", "sensor-offset (crown-outer)"): 0.03}
    d = judged(case.diagnosis, CONFOUNDED, sets)
    assert [entry.key for entry in compared_sets(d.judgement)] == ["hot-road + sun", "hot-road"]
    # A set that contains the leading one names its effects, too.
    sets = {("hot-road",): 0.6, ("hot-road", "sun"): 0.3, ("sun",): 0.1}
    d = judged(case.diagnosis, CONFOUNDED, sets)
    assert [entry.key for entry in compared_sets(d.judgement)] == ["hot-road", "sun"]


def test_unexplained_says_where_heat_is_missing_and_which_sensor_to_check(case: Case) -> None:
    d = unexplained(case.diagnosis, 1e3)
    wrong, sure, step = headline(d)
    assert wrong.startswith("No effect in the catalogue explains the deviation; ")
    assert "97 % probable" in sure
    place = d.to_dict()["where"]
    assert f"Check {place['sensor']} in run {place['run']} first" in step
    assert f"{place['mean_K']:+.1f} K" in step
    assert headline(rejected(case.diagnosis))[1].startswith("Hot-road explains the data only with improbable")


@pytest.mark.parametrize("kind", VERDICTS)
def test_the_page_begins_with_the_sentences_then_the_gap_then_where(kind: str, case: Case) -> None:
    d = VERDICTS[kind](case.diagnosis)
    text = page(d, dict.fromkeys(pictures(d), b"png"), version="1")
    body = text[text.index("<body>") :]
    order = [f">{question}<" for question in QUESTIONS]
    order += ["measured - computed by sensor and run", "<h2>Where</h2>"]
    order += ["<h2>The verdict in more words</h2>", "<h2>Histories</h2>", "<h2>Candidates ranked</h2>"]
    order += ["<h2>Assumptions</h2>"]
    places = [body.index(part) for part in order]
    assert places == sorted(places)
    # The gap is the first picture.
    assert body.index("<img") < places[4]
    assert body.index("<img") > places[2]


@pytest.mark.parametrize("kind", VERDICTS)
def test_no_raw_keys_stand_in_the_words(kind: str, case: Case) -> None:
    d = VERDICTS[kind](case.diagnosis)
    words = " ".join([*headline(d), *(cell for table in summary_tables(d) for row in table.rows for cell in row)])
    shown = page(d, {}, version="1").split("<h2>The amended study</h2>")[0]
    keys = [unknown.key for unknown in d.gap.unknowns if "." in unknown.key]
    assert keys
    assert not [key for key in keys if key in words or key in shown]


def test_the_record_and_the_page_hold_the_same_three_sentences(case: Case) -> None:
    record = json.loads((case.folder / "verdict.json").read_text(encoding="utf-8"))
    text = (case.folder / "diagnosis.html").read_text(encoding="utf-8")
    short = (case.folder / "summary.html").read_text(encoding="utf-8")
    assert len(record["headline"]) == len(QUESTIONS)
    for sentence in record["headline"]:
        assert sentence in text
        assert sentence in short
    assert 'href="summary.html"' in text
    assert 'href="diagnosis.html"' in short
    assert (case.folder / "gap.png").stat().st_size > 10_000


def test_readings_that_do_not_deviate_are_drawn(case: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    table = rms_table(case.diagnosis).assign(before_K=0.0, after_K=0.0, noise_K=0.0)
    monkeypatch.setattr("tyrefem.reports.diagnosis_figures.rms_table", lambda _: table)
    assert rms_figure(case.diagnosis).axes[0].get_xlim() == (0.0, 1.0)


# -- the summary -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", VERDICTS)
def test_the_summary_has_the_numbers_of_its_verdict(kind: str, case: Case) -> None:
    d = VERDICTS[kind](case.diagnosis)
    text = summary(d, version="0.9.9")
    for outside in ("http://", "https://", "<script ", "<link"):
        assert outside not in re.sub(r'src="data:[^"]*"', "", text)
    assert "tyrefem 0.9.9" in text
    assert f"{d.rms(after=False, held_out=True):.2f} K" in text
    assert f"{d.noise:.2f} K" in text
    assert all(run in text for run in RUNS)
    # Names of tables, without the folders of this machine.
    assert "slow.csv" in text
    assert str(case.study.folder) not in text


def test_the_picture_gets_the_height_that_lines_leave() -> None:
    empty = picture_height((), ["word"] * 3, [])
    assert empty == MOST_PICTURE
    row = ("some words", "+1.0", "+2.0 K")
    table = SummaryTable("Numbers", ("what", "value", "moves"), (row,) * 6)
    heights = [picture_height((table,) * n, ["x" * 4 * CHARACTERS] * 3, ["word"]) for n in range(6)]
    assert heights == sorted(heights, reverse=True)
    assert heights[-1] >= LEAST_PICTURE
    assert heights[0] < HEIGHT


def crowded(d: DiagnosisData) -> DiagnosisData:
    """All that a summary may hold: long sentences, and many corrections."""
    doubt = "Hot-road explains the data only with improbable corrections: " + "load +12 ± 1 %; " * 60
    d = rejected(d)
    many = tuple(Change(unknown, 1.0, 0.1, False, "test") for unknown in d.null.unknowns)
    return replace(d, changes=(*d.changes, *many), judgement=replace(d.judgement, doubts=(f"{doubt}.",)))


@pytest.mark.usefixtures("needs_chromium")
@pytest.mark.parametrize("make", [lambda d: d, confounded, crowded], ids=["identified", "confounded", "crowded"])
def test_the_summary_prints_on_one_page(
    make: Callable[[DiagnosisData], DiagnosisData], case: Case, tmp_path: Path
) -> None:
    (tmp_path / "summary.html").write_text(summary(make(case.diagnosis), version="1"), encoding="utf-8")
    printed = tmp_path / "summary.pdf"
    command = ["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--no-pdf-header-footer"]
    command += [f"--user-data-dir={tmp_path / 'profile'}", f"--print-to-pdf={printed}"]
    subprocess.run([*command, (tmp_path / "summary.html").as_uri()], check=True, capture_output=True, timeout=120)
    assert len(re.findall(rb"/Type\s*/Page[^s]", printed.read_bytes())) == 1


def test_a_crowded_summary_is_cut_to_its_page(case: Case) -> None:
    d = crowded(case.diagnosis)
    assert all(len(table.rows) <= 6 for table in summary_tables(d))
    sentences = [clipped(sentence) for sentence in headline(d)]
    assert len(sentences[1]) < len(headline(d)[1])
    assert max(len(sentence) for sentence in sentences) <= 4 * CHARACTERS
    assert picture_height(summary_tables(d), sentences, []) >= LEAST_PICTURE


def test_sensors_and_films_have_names_in_corrections(case: Case) -> None:
    d = case.diagnosis
    many = tuple(Change(unknown, 1.0, 0.1, False, "test") for unknown in d.null.unknowns)
    shown = corrections(replace(d, best=d.null, changes=many))
    assert len(shown) == len(d.null.unknowns)
    kelvins = [abs(each.move.kelvin) for each in shown]
    assert kelvins == sorted(kelvins, reverse=True)
    unknowns: list[Unknown] = [each.pull.unknown for each in shown]
    assert not [each.words for each, unknown in zip(shown, unknowns, strict=True) if unknown.key in each.words]


def test_the_picture_of_probabilities_marks_the_set_of_the_study_and_none_of_its_parts(case: Case) -> None:
    d = certain(case.diagnosis)
    both: Any = SimpleNamespace(members=d.judgement.best.members)
    drawn = probabilities_figure(replace(d, best=both))
    marked = []
    for axes in drawn.axes:
        names = [label.get_text() for label in axes.get_yticklabels()]
        marked.append(
            [
                name
                for name, bar in zip(names, axes.patches, strict=True)
                if to_hex(bar.get_facecolor()) == AFTER.lower()
            ]
        )
    assert marked == [["hot-road + sun"], ["hot-road", "sun"]]


def test_noise_is_no_smallest_rms_where_a_study_comes_nearer() -> None:
    """Sensors may state more noise than their readings have."""
    for after, note in ((0.6, "smallest rms that a model can reach"), (0.1, "as their sensors state it")):
        rms = {(False, False): 2.5, (True, False): after}
        d: Any = SimpleNamespace(
            rms=lambda *, after, held_out, rms=rms: rms.get((after, held_out), math.nan), noise=0.5, stated_noise=0.5
        )
        assert _numbers(d)[-1]["note"] == note


@pytest.mark.parametrize(("score", "shown"), [(0.0, "0.0"), (4.13, "-4.1"), (math.inf, "–")])
def test_how_far_a_set_is_below_the_best(score: float, shown: str) -> None:
    """A set that cannot be has no number of nats: a dash, no '-inf'."""
    row = {"effects": ["wind"], "probability": 0.1, "log_score_below_best": score, "credible": True}
    empty = {"rms_K": None, "held_out_rms_K": None, "p_value": None, "held_out_p": None}
    assert _set(row | empty)["below"] == shown
