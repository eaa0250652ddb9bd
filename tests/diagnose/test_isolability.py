"""What a layout can tell, before any data."""

from __future__ import annotations

import itertools
import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from formula import STATED, effect
from hidden import RIVALS, RUNS, Case
from jsonschema import Draft7Validator
from typer.testing import CliRunner

from tyrefem.cli import app
from tyrefem.diagnose.beside.discrepancy import other_structure
from tyrefem.diagnose.data.sensitivities import Sensitivities
from tyrefem.diagnose.forward.evaluations import Evaluations
from tyrefem.diagnose.forward.forward_model import ForwardModel
from tyrefem.diagnose.forward.sampling import DriveSampling, SensorSampling
from tyrefem.diagnose.inference.linear_model import DesignMatrix, LinearModel
from tyrefem.diagnose.inference.set_evidences import SetEvidences
from tyrefem.diagnose.layout.isolability import MARGIN, Isolability, competitors_of, fewest_runs, isolability, margins
from tyrefem.diagnose.layout.planned_runs import layout_sensitivities, planned
from tyrefem.diagnose.unknowns.candidates import Candidate, SetPrior
from tyrefem.diagnose.unknowns.energy_shapes import SHAPE
from tyrefem.diagnose.unknowns.unknown import Unknown, of_effect
from tyrefem.effects import catalogue
from tyrefem.inputs.name_patterns import SCALES
from tyrefem.reports.isolability import picture
from tyrefem.schemas.answer_schema import answer_schema


@pytest.fixture(scope="module")
def isolability_result(case: Case, known: Sensitivities) -> Isolability:
    return isolability(case.study, known=known)


def test_names_of_sensors_are_no_formulas() -> None:
    candidates = [SimpleNamespace(name=key, key=key) for key in ("hot-road", "sensor-offset ($\\bad$)")]
    known = SimpleNamespace(study="$\\bad$", candidates=candidates, separation=np.full((2, 2), 12.0))
    assert picture(known).startswith(b"\x89PNG")  # type: ignore[arg-type]


def test_every_candidate_has_a_row_and_nothing_else(isolability_result: Isolability) -> None:
    assert {name.split(" (")[0] for name in isolability_result.table["effect"]} == RIVALS
    assert [run for runs in isolability_result.runs for run in runs if run == "fast"] == [], (
        "the held-out run is not planned on"
    )


def test_the_fewest_of_many_runs_are_not_searched_for_hours() -> None:
    """An effect that all of 24 runs hardly show: there are 16 million sets of them."""
    faint, times = effect("faint"), np.arange(3.0)
    sampling = SensorSampling("crown", times, 1.0, 0.0, 1.0)
    drives = tuple(DriveSampling(f"run-{number}", {}, False, (sampling,)) for number in range(24))
    J = np.column_stack([np.ones(3), 0.01 * times])
    none = (np.zeros(3),) * len(drives)
    layout = Sensitivities(drives, (STATED, *faint.unknowns), 1, none, none, (J,) * len(drives))
    prior = SetPrior((faint,), 0.5)
    few, notes = fewest_runs(replace(layout, drives=drives[:2], jacobians=(J, J)), (faint,), prior, np.array([1.0]))
    assert (few, notes) == ((), ())
    few, notes = fewest_runs(layout, (faint,), prior, np.array([1.0]))
    assert few == ()
    assert notes == ("The fewest runs are not known: there are too many sets of 4 and more of the 24 fitted runs.",)


def test_to_be_told_from_all_takes_at_least_what_being_seen_takes(isolability_result: Isolability) -> None:
    assert (isolability_result.smallest >= isolability_result.seen).all()
    assert np.isfinite(isolability_result.seen).any()


def test_the_margin_is_reached_at_the_smallest_amplitude_and_not_well_below(
    case: Case, known: Sensitivities, isolability_result: Isolability
) -> None:
    design = known.design(known.fitted)
    linear = LinearModel(design, np.zeros(len(design.jacobian)))
    prior = SetPrior(isolability_result.candidates, case.study.card.diagnosis.effects_expected)
    number = [candidate.name for candidate in isolability_result.candidates].index("hot-road")
    road = isolability_result.candidates[number]
    column = linear.jacobian[:, design.place[road.amplitudes[0]]]
    sets = competitors_of((road,), isolability_result.candidates)

    def lead(amplitude: float) -> float:
        return min(margins(linear, amplitude * column, (road,), sets, prior))

    assert lead(isolability_result.smallest[number]) >= MARGIN > lead(0.7 * isolability_result.smallest[number])


def test_twice_the_noise_needs_a_stronger_effect(
    case: Case, known: Sensitivities, isolability_result: Isolability
) -> None:
    study = case.study
    sensors = [sensor_series.sensor for sensor_series in case.diagnosis.gap.runs[0].sensors]
    louder = study.replace({f"sensors.{name}.noise": "1.5 delta_degC" for name in study.sensors})
    model = ForwardModel(louder, planned(louder, sensors))
    again = layout_sensitivities(Evaluations(model), case.diagnosis.gap.responses)
    assert (isolability(louder, known=again).seen >= isolability_result.seen).all()
    assert (isolability(louder, known=again).seen > isolability_result.seen).any()


def test_beside_another_strain_energy_what_imitates_it_is_not_seen(case: Case, known: Sensitivities) -> None:
    design, beside = known.design(known.fitted), other_structure(known)
    wave = next(unknown for unknown in design.unknowns if unknown.effect == SHAPE)
    road = next(unknown for unknown in design.unknowns if unknown.effect == "hot-road")
    of_wave, of_road = (unknown.sd * design.jacobian[:, design.place[unknown]] for unknown in (wave, road))
    assert np.linalg.norm(of_wave) > 3 > 1 > np.linalg.norm(beside.whitened(of_wave))
    # The road heats one side, as no strain energy does: part of its signal is left.
    assert np.linalg.norm(of_road) > np.linalg.norm(beside.whitened(of_road)) > 2
    films = [unknown.key for unknown in design.unknowns if unknown.key.startswith(SCALES)]
    fewer = other_structure(known, films)
    assert beside.fitted.shape[1] - fewer.fitted.shape[1] == len(films) > 0


def test_the_printed_table_has_the_units_of_study_files(isolability_result: Isolability) -> None:
    candidate = Candidate("pressure-loss", (), of_effect(catalogue()["pressure-loss"], ()))
    same = (np.array([30.0]), np.array([20.0]), np.array([15.0]))
    result = replace(
        isolability_result, candidates=(candidate,), smallest=same[0], seen=same[1], scale=same[2],
        competitors=("",), separation=np.zeros((1, 1)),
    )  # fmt: skip
    # 30 Pa/s are 1.8 kPa/min; the table for programs stays in SI.
    header, row, *_ = result.words()[0].splitlines()
    assert row.split()[:5] == ["pressure-loss", "kPa/min", "0.9", "1.2", "1.8"]
    assert header.split()[-2] == "told_from"
    assert result.table.loc[0, ["unit", "told_from"]].tolist() == ["Pa/s", 30.0]


def test_the_command_calibrates_a_layout(
    case: Case, known: Sensitivities, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tyrefem.diagnose.layout.isolability.planned_sensitivities", lambda *_, **__: known)
    out = tmp_path / "out"
    arguments = ["isolability", str(case.study.file), "--calibrate", "60", "--out", str(out)]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 0, result.output
    assert "60 quick cases of study, seed 1" in result.output
    record = json.loads((out / "calibration.json").read_text(encoding="utf-8"))
    Draft7Validator(answer_schema("isolability")["properties"]["calibration"]).validate(record)
    assert len(record["layout"]["runs"]) == len(RUNS)
    assert sum(record["ranks"]["base_numbers_and_sensors"]["counts"]) >= 50
    assert record["unexplained"]["nothing_hidden"]["misfit"]["of"] == 100_000
    fresh = record["conformal"]["fresh_cases"]
    assert fresh["all"]["of"] == fresh["an effect leads"]["of"] + fresh["no effect leads"]["of"] == 30
    assert (out / "calibration.png").read_bytes()[:4] == b"\x89PNG"
    refused = CliRunner().invoke(app, [*arguments[:3], "10"])
    assert refused.exit_code == 2


def test_evidences_of_many_sets_at_once_are_those_of_each_alone() -> None:
    """No effect, single effects and pairs: with and without bounds, of two amplitudes, and of a fixed signal."""
    free, bounded, other = effect("free"), effect("bounded", low=0.0), effect("other", sd=0.5, low=-0.1)
    double = Candidate("double", (), (*effect("first", low=0.0).unknowns, *effect("second").unknowns))
    swapped = Candidate("swapped", (), (Unknown("swapped", 1.0, effect="swapped"),))
    candidates = (free, bounded, other, double, swapped)
    nuisance = (STATED, Unknown("drive.load", 0.1, low=-0.05), Unknown("drive.pressure", 0.2))
    rng = np.random.default_rng(5)
    unknowns = (*nuisance, *(unknown for candidate in candidates for unknown in candidate.unknowns))
    design = DesignMatrix(unknowns, len(nuisance), rng.normal(size=(40, len(unknowns))))
    sets = [members for size in range(3) for members in itertools.combinations(candidates, size)]
    many = SetEvidences(design, sets)
    for size in (0.0, 1.0, 5.0):
        linear = LinearModel(design, size * rng.normal(size=40))
        expected = [linear.log_evidence(members) for members in sets]
        assert many.log_evidence(linear.overlap) == pytest.approx(expected, rel=1e-9, abs=1e-9)


def test_every_effect_compared_is_reported_as_progress(case: Case, known: Sensitivities) -> None:
    done: list[tuple[str, int, int]] = []
    result = isolability(case.study, known=known, progress=lambda *each: done.append(each))
    n = len(result.candidates)
    assert done == [("effects", number, n) for number in range(1, n + 1)]


@pytest.mark.parametrize(("low", "high"), [(0.0, 100.0), (-100.0, 0.0), (0.0, 1.0)])
def test_an_effect_is_seen_on_the_side_and_to_the_bound_that_it_has(low: float, high: float) -> None:
    """A draft of missing cooling has no positive amplitudes: it counted as never seen."""
    made = effect("made-up", sd=2.0)
    known = made.unknowns[0]
    candidate = replace(made, unknowns=(replace(known, low=low, high=high),))
    times = np.arange(40.0)
    sampling = SensorSampling("crown", times, 1.0, 0.0, 1.0)
    drive = DriveSampling("run-1", {}, False, (sampling,))
    J = np.column_stack([np.ones(40), 0.3 * times])
    layout = Sensitivities((drive,), (STATED, *candidate.unknowns), 1, (np.zeros(40),), (np.zeros(40),), (J,))
    runs, _ = fewest_runs(layout, (candidate,), SetPrior((candidate,), 0.5), np.array([1.0]))
    assert runs == (("run-1",),)
