"""The numbers of ASME V&V 20 by hand, and verdicts that are right as often as they should be."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from toy_study import Sensor, measured_from

from tyrefem.compare import compare
from tyrefem.compare.uncertainty import WITHIN, effective_number
from tyrefem.errors import InputError
from tyrefem.measured import MeasuredRun

pytestmark = pytest.mark.fast

EVERY_10 = np.arange(0.0, 1201.0, 10.0)


def whole(comparison, sensor="crown"):
    table = comparison.table
    (entry,) = table[(table.sensor == sensor) & (table.phase == "all")].to_dict("records")
    return entry


def test_white_noise_is_worth_all_its_readings():
    errors = np.random.default_rng(3).normal(size=20_000)
    assert effective_number(errors) == pytest.approx(20_000, rel=0.03)


@pytest.mark.parametrize("phi", [0.5, 0.9])
def test_red_noise_is_worth_less(phi):
    """The variance of the mean of a first-order autoregression is sigma^2 / n (1 + phi) / (1 - phi)."""
    rng = np.random.default_rng(5)
    shocks = rng.normal(size=40_000)
    errors = np.zeros_like(shocks)
    for i in range(1, len(errors)):
        errors[i] = phi * errors[i - 1] + shocks[i]
    assert effective_number(errors) == pytest.approx(40_000 * (1 - phi) / (1 + phi), rel=0.06)
    batches = errors.reshape(200, 200)
    predicted = errors.var() / np.mean([effective_number(batch) for batch in batches])
    assert batches.mean(axis=1).var() == pytest.approx(predicted, rel=0.25)


def test_a_drift_is_worth_one_reading_and_a_constant_all():
    # Of n readings in a line, neighbours correlate by 1 - 3/n.
    assert effective_number(np.linspace(0.0, 1.0, 1000)) == pytest.approx(1.5, abs=0.01)
    # Two readings correlate by -1/2, but no series is worth more than its readings.
    assert effective_number(np.array([0.0, 1.0])) == 2.0
    assert effective_number(np.full(10, 3.3)) == 10.0
    assert effective_number(np.array([1.0])) == 1.0


def test_by_hand(study):
    """Four readings, E = +1, -1, +1, -1 K about 4 K: n_eff = 4, and every part of u_val is a round number.

    u_num = hypot(0.3, 0.4) = 0.5; u_D = sqrt((1.2 / sqrt 4)^2 + 0.5^2 + (0.002 m x 100 K/m)^2) = sqrt(0.65);
    inputs: heat +10 % of a 40 K rise = 4 K, air +20 % of 25 = 5 K; u_input = sqrt(41).
    """
    study = replace(
        study, sensors={"crown": Sensor(position_sd=0.002, noise=1.2, accuracy=0.5)}, rising=False, gradient=100.0,
        tolerance=0.3, numerical_sd=0.4, uncertainty={"heat": 0.1, "air": 0.2},
    )  # fmt: skip
    errors = 4.0 + np.array([1.0, -1.0, 1.0, -1.0])
    run = MeasuredRun("run-1", np.array([100.0, 200.0, 300.0, 400.0]), pd.DataFrame({"crown": 65.0 - errors}))
    comparison = compare(study, run)
    entry = whole(comparison)
    assert entry["bias_K"] == pytest.approx(4.0)
    assert entry["rms_K"] == pytest.approx(math.sqrt(17.0))
    assert comparison.by_sensor.to_dict() == pytest.approx({"crown": math.sqrt(17.0)})
    assert entry["n_effective"] == pytest.approx(4.0)
    assert entry["u_num_K"] == pytest.approx(0.5)
    assert entry["u_data_K"] == pytest.approx(math.sqrt(0.65))
    assert entry["u_input_K"] == pytest.approx(math.sqrt(41.0))
    assert entry["u_val_K"] == pytest.approx(math.sqrt(0.25 + 0.65 + 41.0))
    assert entry["u_reading_K"] == pytest.approx(math.sqrt(0.25 + 1.44 + 0.25 + 0.04 + 41.0))
    changes = comparison.inputs[comparison.inputs.phase == "all"].set_index("key").change_K
    assert changes.to_dict() == pytest.approx({"heat": 4.0, "air": 5.0})
    assert comparison.by_input["crown"].to_dict() == pytest.approx({"air": 5.0, "heat": 4.0})
    assert list(comparison.by_input.index) == ["air", "heat"]
    assert entry["verdict"] == WITHIN

    blunt = compare(study, run, inputs=False)
    assert whole(blunt)["u_val_K"] == pytest.approx(math.sqrt(0.9))
    assert whole(blunt)["verdict"] == "model error of about +4.00 ± 1.90 K"
    assert len(blunt.inputs) == 0
    assert any("left out" in note for note in blunt.notes)


def test_signed_changes_of_an_input_may_cancel_in_the_mean_but_not_in_a_reading(study):
    """An input that heats early and cools late moves no mean, yet blurs every reading."""
    run = measured_from(study, EVERY_10)
    change = np.where(np.arange(len(EVERY_10)) % 2, 1.0, -1.0)[:120]
    from tyrefem.compare.history import SensorHistory
    from tyrefem.compare.uncertainty import uncertainty

    history = SensorHistory(
        "a", "crown", False, run.times[:120], np.zeros(120), np.zeros(120), np.full(120, "x", dtype=object),
        np.zeros(120), {"k": 2.0 * change}, 0.0, 0.0, 0.0, 0.0,
    )  # fmt: skip
    assert uncertainty(history, np.ones(120, dtype=bool)).input == 0.0
    np.testing.assert_allclose(history.reading_uncertainty, 2.0)


def test_a_run_may_state_its_own_noise(study, tmp_path):
    from toy_study import Entry

    file = measured_from(study, EVERY_10, noise=0.1).write(tmp_path / "a.csv")
    quiet, loud = (
        whole(compare(replace(study, measured=(Entry(file, noise=noise),))))["u_data_K"] for noise in (0.5, 2.0)
    )
    assert loud == pytest.approx(4.0 * quiet)


def test_data_equal_to_the_model_and_noise_are_within(study):
    comparison = compare(study, measured_from(study, EVERY_10, noise=0.5))
    assert not comparison.table.beyond.any()
    assert set(comparison.table.verdict) == {WITHIN}
    assert "0 of 2 sensor histories, 0 of 4 sensor phases" in comparison.summary


def test_five_kelvin_are_beyond_and_come_out_as_five(study):
    comparison = compare(study, measured_from(study, EVERY_10, noise=0.5, bias=5.0))
    assert comparison.table.beyond.all()
    for entry in comparison.table.to_dict("records"):
        assert abs(entry["bias_K"] - 5.0) < 2.0 * entry["u_val_K"]
        assert entry["verdict"].startswith("model error of about +")


def test_five_kelvin_are_hidden_by_a_thermocouple_that_may_be_three_off(study):
    unsure = replace(study, sensors={name: Sensor(accuracy=3.0) for name in study.sensors})
    assert not compare(unsure, measured_from(study, EVERY_10, noise=0.5, bias=5.0)).table.beyond.any()


def test_an_error_that_changes_sign_is_not_lost_in_its_mean(study):
    run = measured_from(study, EVERY_10)
    wave = 4.0 * np.sin(2 * np.pi * EVERY_10 / 600.0)
    comparison = compare(study, MeasuredRun("run-1", run.times, run.temperatures.add(wave, axis=0)))
    entry = whole(comparison)
    assert abs(entry["bias_K"]) < 0.1
    assert entry["rms_K"] == pytest.approx(4.0 / math.sqrt(2.0), rel=0.01)
    assert entry["beyond"]
    assert "changes sign" in entry["verdict"]


def test_the_verdict_is_wrong_as_rarely_as_k_promises(study):
    """Unbiased data with offsets of the stated accuracy: beyond 2 u_val in about 5 % of the histories."""
    sensors = {f"s{i}": Sensor(noise=0.5, accuracy=0.8) for i in range(1000)}
    rng = np.random.default_rng(11)
    offsets = 0.8 * rng.normal(size=1000) + 0.1 * rng.normal(size=1000)
    from tyrefem.compare.comparison import comparison_of
    from tyrefem.compare.history import SensorHistory

    times = np.arange(40.0)
    made = [
        SensorHistory(
            "run", name, False, times, offset + 0.5 * rng.normal(size=40), np.zeros(40),
            np.full(40, "x", dtype=object), np.zeros(40), {}, 0.5, 0.8, 0.0, 0.1,
        )
        for name, offset in zip(sensors, offsets, strict=True)
    ]  # fmt: skip
    table = comparison_of("toy", made, curves={}, relative_sd={}).table
    rate = table[table.phase == "all"].beyond.mean()
    assert 0.025 < rate < 0.07


@pytest.mark.parametrize("k", [0.0, -1.0, math.nan, math.inf])
def test_a_coverage_factor_is_positive(study, k):
    with pytest.raises(InputError, match="coverage factor"):
        compare(study, measured_from(study, EVERY_10), k=k)


def test_a_sensor_whose_card_states_no_noise_is_named(study):
    silent = replace(study, sensors={"crown": Sensor(noise=0.0), "shoulder": Sensor()})
    notes = compare(silent, measured_from(study, EVERY_10)).notes
    assert "Note: no measurement noise is stated for crown" in notes
