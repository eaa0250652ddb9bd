"""Known deviations come out as put in: bias, rms, late clocks, phases, spans."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from toy_study import RISES, TAU, Entry, measured_from

from tyrefem.compare import compare
from tyrefem.errors import InputError
from tyrefem.inputs.study_card import Sensor as StudySensor
from tyrefem.measured import MeasuredRun

EVERY_20 = np.arange(0.0, 1201.0, 20.0)


def row(comparison, sensor, phase="all", run="run-1"):
    table = comparison.table
    (entry,) = table[(table.sensor == sensor) & (table.phase == phase) & (table.run == run)].to_dict("records")
    return entry


def test_the_sign_is_computed_minus_measured(study):
    comparison = compare(study, measured_from(study, EVERY_20, bias=5.0))
    for sensor in ("crown", "shoulder"):
        entry = row(comparison, sensor)
        assert entry["bias_K"] == pytest.approx(5.0, abs=1e-12)
        assert entry["rms_K"] == pytest.approx(5.0, abs=1e-12)
        assert entry["n"] == 61
        assert entry["n_effective"] == 61.0
    assert comparison.bias_K == pytest.approx(5.0)


def test_rms_of_an_alternating_error_and_its_largest(study):
    run = measured_from(study, EVERY_20)
    signs = np.where(np.arange(61) % 2, 1.0, -1.0)
    signs[30] = -4.0
    shifted = MeasuredRun("run-1", run.times, run.temperatures.add(3.0 * signs, axis=0))
    entry = row(compare(study, shifted), "crown")
    assert entry["rms_K"] == pytest.approx(3.0 * math.sqrt((60 + 16) / 61), rel=1e-12)
    assert entry["bias_K"] == pytest.approx(-3.0 * signs.mean(), rel=1e-9)
    assert (entry["largest_K"], entry["at_s"]) == (pytest.approx(12.0), 600.0)


def test_a_late_clock_shows_as_the_slope_times_the_delay(study):
    """E(t) = T(t) - T(t - d) = rise exp(-t / tau) (exp(d / tau) - 1) while T is an exponential."""
    run = measured_from(study, EVERY_20[1:], delay=10.0)
    residuals = compare(study, run).residuals
    crown = residuals[residuals.sensor == "crown"]
    exact = RISES["crown"] * np.exp(-crown.time_s / TAU) * (math.exp(10.0 / TAU) - 1.0)
    np.testing.assert_allclose(crown.error_K, exact, atol=1e-10)
    back = compare(study, run.shifted(-10.0)).residuals
    np.testing.assert_allclose(back.error_K, 0.0, atol=1e-10)


def test_between_saved_times_linear_interpolation_is_second_order(study):
    """The chord of an exponential is below the curve by at most h^2 / 8 times its largest curvature."""
    run = measured_from(study, np.arange(0.5, 1200.0, 1.0))
    error = compare(study, run).residuals.error_K
    assert error.max() < 1e-12
    assert -error.min() == pytest.approx(60.0 / TAU**2 / 8.0 * math.exp(-0.5 / TAU), rel=0.01)


def test_phases_partition_the_readings(study):
    comparison = compare(study, measured_from(study, EVERY_20))
    assert [row(comparison, "crown", phase)["n"] for phase in ("heating", "holding", "all")] == [31, 30, 61]
    at_border = comparison.residuals.query("time_s == 600.0")
    assert set(at_border.phase) == {"heating"}


def test_times_outside_the_span_are_reported_and_never_used(study):
    times = np.arange(-200.0, 1400.0, 100.0)
    comparison = compare(study, measured_from(replace(study, rising=False), times))
    assert comparison.residuals.time_s.min() == 0.0
    assert comparison.residuals.time_s.max() == 1200.0
    assert any("3 of 16 measured times" in note for note in comparison.notes)
    assert "ERROR" not in comparison.summary


def test_mostly_outside_is_an_error_in_the_summary(study):
    comparison = compare(study, measured_from(study, np.arange(0.0, 3600.0, 100.0)))
    assert comparison.summary.startswith("ERROR: run 'run-1': 23 of 36 measured times")


def test_wholly_outside_is_refused(study):
    with pytest.raises(InputError, match=r"no sensor has a reading within the simulated span; .*2 of 2 measured times"):
        compare(study, measured_from(study, [2000.0, 2100.0]))


def test_times_within_the_span_without_a_reading_are_not_called_outside(study):
    run = measured_from(study, [0.0, 100.0, 2000.0])
    temperatures = run.temperatures.copy()
    temperatures.iloc[:2] = np.nan
    with pytest.raises(InputError, match=r"no sensor has a reading within the simulated span; .*1 of 3 measured times"):
        compare(study, MeasuredRun("run-1", run.times, temperatures))


def test_no_reading_is_no_deviation(study):
    run = measured_from(study, EVERY_20, bias=1.0)
    temperatures = run.temperatures.copy()
    temperatures.loc[temperatures.index % 2 == 1, "crown"] = np.nan
    comparison = compare(study, MeasuredRun("run-1", run.times, temperatures))
    assert (row(comparison, "crown")["n"], row(comparison, "shoulder")["n"]) == (31, 61)
    assert row(comparison, "crown")["bias_K"] == pytest.approx(1.0)
    assert comparison.residuals.error_K.notna().all()


def test_contained_air_is_compared_without_a_place(study):
    run = measured_from(study, EVERY_20, sensors=("contained-air",), bias=-0.5)
    entry = row(compare(replace(study, gradient=1e3), run), "contained-air")
    assert entry["bias_K"] == pytest.approx(-0.5)
    # Noise and accuracy are those of a sensor's card that states none.
    card = StudySensor(s="0 mm", depth="0 mm")
    assert entry["u_data_K"] == pytest.approx(np.hypot(card.noise / np.sqrt(entry["n"]), card.accuracy))


def test_unknown_column_says_the_nearest_or_is_ignored(study):
    run = measured_from(study, EVERY_20)
    run = MeasuredRun("run-1", run.times, run.temperatures.rename(columns={"crown": "crwon"}))
    with pytest.raises(InputError, match=r"column 'crwon' is no sensor of study 'toy'; did you mean 'crown'\?"):
        compare(study, run)
    assert study.runs == []
    assert set(compare(study, run, ignore=["crwon"]).table.sensor) == {"shoulder"}


class TestRuns:
    """Which run is simulated at which drive."""

    def own(self, study, tmp_path, **entries):
        made = []
        for name, options in entries.items():
            speed = options.get("drive", {}).get("drive.speed", 1.0)
            run = measured_from(replace(study, speed=speed), EVERY_20, name=name, bias=options.pop("bias", 0.0))
            made.append(Entry(run.write(tmp_path / f"{name}.csv"), **options))
        return replace(study, measured=tuple(made))

    def test_each_entry_runs_at_its_own_drive_and_equal_drives_run_once(self, study, tmp_path):
        fast = {"drive": {"drive.speed": 1.5}}
        with_entries = self.own(study, tmp_path, a={}, b=dict(fast), c=dict(fast))
        comparison = compare(with_entries)
        assert comparison.rms_K == pytest.approx(0.0, abs=1e-12)
        assert study.runs == [(1.0, 25.0, 1.0), (1.0, 25.0, 1.5)]

    def test_held_out_runs_are_told_apart(self, study, tmp_path):
        with_entries = self.own(study, tmp_path, a={"bias": 1.0}, b={"bias": -3.0, "hold_out": True})
        comparison = compare(with_entries)
        assert comparison.to_dict()["fitted"]["bias_K"] == pytest.approx(1.0)
        assert comparison.to_dict()["held_out"]["rms_K"] == pytest.approx(3.0)
        assert "(fitted +1.00, 1.00 K rms; held out -3.00, 3.00 K rms)" in comparison.summary

    def test_a_named_table_takes_its_entry(self, study, tmp_path):
        with_entries = self.own(study, tmp_path, a={"drive": {"drive.speed": 1.5}}, b={})
        assert compare(with_entries, tmp_path / "a.csv").rms_K == pytest.approx(0.0, abs=1e-12)
        copy = (tmp_path / "elsewhere").mkdir() or tmp_path / "elsewhere" / "a.csv"
        copy.write_bytes((tmp_path / "a.csv").read_bytes())
        assert compare(with_entries, copy).rms_K == pytest.approx(0.0, abs=1e-12)

    def test_a_known_result_is_not_computed_again(self, study):
        result = study.run()
        study.runs.clear()
        compare(study, measured_from(study, EVERY_20), result)
        assert study.runs == []

    def test_a_result_at_the_studys_drive_is_not_used_for_another_drive(self, study, tmp_path):
        with_entries = self.own(study, tmp_path, a={"drive": {"drive.speed": 1.5}})
        assert compare(with_entries, result=with_entries.run()).rms_K == pytest.approx(0.0, abs=1e-12)

    def test_an_amended_result_is_used(self, study):
        amended = replace(study, heat=1.1)
        run = measured_from(amended, EVERY_20)
        assert compare(study, run, amended.run()).rms_K == pytest.approx(0.0, abs=1e-12)
        assert compare(study, run).rms_K > 2.0

    def test_one_run_of_a_file_and_a_wrong_one(self, study, tmp_path):
        frame = pd.DataFrame({"time [s]": [0.0, 0.0], "run": ["a", "b"], "crown [degC]": [25.0, 99.0]})
        frame.to_csv(tmp_path / "both.csv", index=False)
        with_entries = replace(study, measured=(Entry(tmp_path / "both.csv", run="a"),))
        assert compare(with_entries).rms_K == 0.0
        with pytest.raises(InputError, match=r"both.csv: measured.run: no run 'c'"):
            compare(replace(study, measured=(Entry(tmp_path / "both.csv", run="c"),)))

    def test_no_table_at_all(self, study):
        with pytest.raises(InputError, match="has no"):
            compare(study)

    def test_two_loggers_on_one_run_stay_apart(self, study):
        runs = [measured_from(study, EVERY_20, bias=bias) for bias in (1.0, 2.0)]
        comparison = compare(study, runs)
        assert row(comparison, "crown", run="run-1")["bias_K"] == pytest.approx(1.0)
        assert row(comparison, "crown", run="run-1 (2)")["bias_K"] == pytest.approx(2.0)
