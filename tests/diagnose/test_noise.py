"""Noise by the scatter of readings: true within 5 %, whatever is stated; what it does to a verdict."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from hidden import Case

from tyrefem.diagnose.data.noise import ReadingNoise, noise_of
from tyrefem.diagnose.data.runs import MeasuredDrive, MeasuredSensor, with_noise_of_data
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.measured import MeasuredRun

SENSORS = ("crown", "shoulder", "sidewall", "bead")


def heated(times: np.ndarray, tau: float) -> np.ndarray:
    return 25.0 + 60.0 * (1 - np.exp(-times / tau))


def judged(
    true: float,
    *,
    stated: float = 0.5,
    every: float = 10.0,
    tau: float = 200.0,
    count: int = 200,
    runs: int = 3,
    even: bool = False,
    memory: float = 0.0,
    step: float = 0.0,
) -> list[ReadingNoise]:
    """Noise of heating histories with noise of ``true`` K; ``memory``: share that a reading has of the one before."""
    rng = np.random.default_rng(7)
    series = []
    for sensor in SENSORS * runs:
        times = every * (np.arange(count) if even else np.sort(rng.uniform(0, count, count)))
        noise = rng.normal(size=count)
        for i in range(1, count if memory else 0):
            noise[i] = memory * noise[i - 1] + np.sqrt(1 - memory**2) * noise[i]
        values = heated(times, tau) + true * noise
        series.append((sensor, times, np.round(values / step) * step if step else values))
    return noise_of(series, [stated] * len(series))


@pytest.mark.parametrize("even", [True, False], ids=["even clock", "irregular clock"])
@pytest.mark.parametrize(("every", "tau"), [(1.0, 200.0), (10.0, 60.0), (30.0, 300.0)])
@pytest.mark.parametrize("true", [0.05, 0.5, 2.0])
def test_the_scatter_tells_the_true_noise_within_5_percent(true: float, every: float, tau: float, even: bool) -> None:
    for noise in judged(true, every=every, tau=tau, even=even):
        assert noise.from_data == pytest.approx(true, rel=0.07 if true < 0.1 and every / tau > 0.1 else 0.05)
        assert noise.used == (0.5 if true == 0.5 else noise.from_data)
        assert noise.differs == (true != 0.5)
        assert not noise.correlated


def test_jumps_and_outliers_are_no_noise() -> None:
    rng = np.random.default_rng(3)
    times = np.sort(rng.uniform(0.0, 1000.0, 3000))
    values = heated(times, 200.0) + 0.8 * rng.normal(size=3000) + np.where(times > 500.0, 20.0, 0.0)
    values[::97] += 30.0
    (noise,) = noise_of([("crown", times, values)], [0.5])
    assert noise.used == pytest.approx(0.8, rel=0.05)


def test_rounded_readings_have_at_least_the_noise_of_their_steps() -> None:
    # White noise of 0.1 K, and rounding to 0.1 K: 0.1 K / sqrt(12) more, in squares.
    assert judged(0.1, step=0.1)[0].used == pytest.approx(np.hypot(0.1, 0.1 / np.sqrt(12)), rel=0.05)
    for true in (0.0, 0.005):
        (noise, *_) = judged(true, step=0.1)
        assert noise.resolution == pytest.approx(0.1)
        # The readings stick to their steps, off by up to half of one.
        assert noise.used == pytest.approx(0.05)


def test_too_few_readings_keep_the_stated_noise() -> None:
    assert {noise.used for noise in judged(0.05, count=11)} == {0.5}
    assert {noise.used for noise in judged(0.05, count=20, runs=1)} == {0.5}
    # But noise a third above the stated one is seen by few readings too.
    assert all(noise.used > 1.0 for noise in judged(2.0, count=20, runs=1))


def test_noise_that_neighbours_share_does_not_lower_the_stated_one() -> None:
    (noise, *_) = judged(0.4, memory=0.8, even=True)
    assert noise.correlated
    assert noise.from_data < 0.3
    assert noise.used == 0.5
    assert judged(0.4, memory=0.8, even=True, stated=0.05)[0].used == pytest.approx(noise.from_data)


def test_a_noisier_sensor_has_its_noise_for_itself() -> None:
    rng = np.random.default_rng(5)
    times = np.arange(0.0, 2000.0, 5.0)
    size = {"crown": 0.1, "shoulder": 0.1, "sidewall": 0.1, "bead": 0.6}
    series = [(name, times, heated(times, 150.0) + size[name] * rng.normal(size=400)) for name in SENSORS * 3]
    for (name, *_), noise in zip(series, noise_of(series, [0.5] * 12), strict=True):
        assert noise.used == pytest.approx(size[name], rel=0.1), name


def test_the_runs_take_the_noise_of_their_data() -> None:
    rng, times = np.random.default_rng(2), np.arange(0.0, 1500.0, 5.0)
    readings = tuple(
        MeasuredSensor(name, times, 0.5, 0.1, 120.0, measured=heated(times, 90.0) + 0.05 * rng.normal(size=300))
        for name in SENSORS
    )
    (run,) = with_noise_of_data((MeasuredDrive("run", {}, False, readings),))
    for before, after in zip(readings, run.sensors, strict=True):
        assert after.noise == pytest.approx(0.05, rel=0.05)
        assert after.origin is not None
        assert after.origin.stated == 0.5
        # The covariance follows: nothing of the stated noise is kept.
        assert np.diag(after.covariance - 0.01).mean() == pytest.approx(after.noise**2 / after.sizes.mean(), rel=0.1)
        assert np.diag(before.covariance).mean() > np.diag(after.covariance).mean()


def quiet_runs(case: Case, noise: float, wave: float) -> list[MeasuredRun]:
    """The study's own prediction with a wave in time that no effect has (the same at all sensors), and noise."""
    d, rng = case.diagnosis, np.random.default_rng(8)
    runs = []
    for number, run in enumerate(d.gap.runs):
        columns = {}
        times = np.arange(0.0, 160.0, 1.0)
        for readings in run.sensors:
            expected = np.interp(times, readings.block_times, d.before[number][run.parts()[readings.sensor]])
            columns[readings.sensor] = expected + wave * np.sin(times / 9.0) + noise * rng.normal(size=len(times))
        runs.append(MeasuredRun(run.name, times, pd.DataFrame(columns)))
    return runs


def test_a_stated_noise_above_that_of_the_data_does_not_disarm_the_misfit_test(case: Case) -> None:
    few = DiagnosisSettings(largest=1, looks=1, beside_sets=1, discrepancy_sizes=(1.0,))
    known = case.diagnosis.gap.responses
    result = case.study.diagnose(quiet_runs(case, 0.05, 0.5), settings=few, known=known, rerun=False, verdict_only=True)
    # By the stated 0.5 K the wave would drown: rms 0.35 K.
    assert result.stated_noise == 0.5
    assert result.noise == pytest.approx(0.05, rel=0.1)
    assert result.verdict == "unexplained"
    words = " ".join(result.to_dict()["summary"])
    assert "The stated noise is 0.5 K" in words or "the stated noise is 0.5 K" in words
    noise = result.to_dict()["noise"]
    assert noise["stated_K"] == 0.5
    assert noise["from_data_K"] == pytest.approx(0.05, rel=0.1)
    assert noise["used_K"] == noise["from_data_K"]
    assert len(noise["series"]) == 9


def rounded_runs(case: Case, step: float) -> list[MeasuredRun]:
    """The study's own prediction read by a fast logger that rounds, with hardly any noise of its own."""
    d, rng = case.diagnosis, np.random.default_rng(8)
    runs = []
    for number, run in enumerate(d.gap.runs):
        columns, times = {}, np.arange(0.0, 160.0, 0.1)
        for readings in run.sensors:
            expected = np.interp(times, readings.block_times, d.before[number][run.parts()[readings.sensor]])
            columns[readings.sensor] = np.round((expected + 0.02 * rng.normal(size=len(times))) / step) * step
        runs.append(MeasuredRun(run.name, times, pd.DataFrame(columns)))
    return runs


def test_rounded_readings_of_a_fast_logger_do_not_condemn_a_right_model(case: Case) -> None:
    """Forty readings of a block stick to the same step: their mean is no better than each of them."""
    result = case.study.diagnose(rounded_runs(case, 1.0), largest=1, looks=1, known=case.diagnosis.gap.responses)
    assert result.verdict == "no gap"
    for run in result.gap.runs:
        for readings in run.sensors:
            assert readings.rounding == pytest.approx(1.0 / np.sqrt(12.0))
            assert np.diag(readings.covariance).min() >= readings.rounding**2


def test_readings_whose_noise_spreads_over_several_steps_have_no_shared_rounding() -> None:
    times, rng = np.arange(0.0, 500.0), np.random.default_rng(4)
    values = np.round(heated(times, 90.0) + 0.8 * rng.normal(size=len(times)))
    (noise,) = noise_of([("crown", times, values)], [0.5])
    assert noise.resolution == 1.0
    assert noise.rounding == 0.0


def test_a_few_readings_tell_no_step_of_a_logger() -> None:
    """Two readings are multiples of their difference: 35 K were taken for the step, and 17.5 K for the noise."""
    rng, times = np.random.default_rng(7), 10.0 * np.arange(300)
    logged = ("crown", times, heated(times, 200.0) + 0.5 * rng.normal(size=300))
    by_hand = [
        ("bead", np.array([0.0, 1800.0]), np.array([25.0, 60.0])),
        ("sidewall", np.array([0.0, 900.0, 1800.0]), np.array([25.0, 37.0, 49.0])),
    ]
    _, *few = noise_of([logged, *by_hand], [0.5] * 3)
    assert [(noise.used, noise.rounding) for noise in few] == [(0.5, 0.0)] * 2
