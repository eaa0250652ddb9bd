"""Readings as blocks: means, correlated uncertainty made white, noise seen in the readings; stretches of a history."""

from __future__ import annotations

import numpy as np
import pytest

from tyrefem.diagnose.data.residual_tables import stretches
from tyrefem.diagnose.data.runs import MeasuredDrive, MeasuredSensor
from tyrefem.diagnose.settings import DEFAULT


def _series(count: int = 200, *, noise: float = 0.5, discrepancy: float = 0.1, tau: float = 120.0) -> MeasuredSensor:
    times = np.sort(np.random.default_rng(1).uniform(0.0, 1000.0, count))
    return MeasuredSensor("crown", times, noise, discrepancy, tau, measured=25.0 + 0.02 * times)


def test_block_means_are_means_and_hold_every_reading() -> None:
    sensor = _series(203)
    assert len(sensor.starts) == DEFAULT.blocks
    assert sensor.sizes.sum() == 203
    assert sensor.block_means(sensor.measured) @ sensor.sizes == pytest.approx(sensor.measured.sum())
    expected = sensor.measured[sensor.starts[3] : sensor.starts[4]].mean()
    assert sensor.block_means(sensor.measured)[3] == pytest.approx(expected, rel=1e-14)
    few = _series(7)
    np.testing.assert_array_equal(few.block_means(few.measured), few.measured)


def test_a_computed_history_is_seen_at_the_times_of_the_readings() -> None:
    sensor = _series()
    times = np.linspace(0.0, 1000.0, 11)
    values = np.column_stack([3.0 * times, np.sin(times / 300)])
    seen = sensor.sampled(times, values)
    for column in range(2):
        expected = sensor.block_means(np.interp(sensor.times, times, values[:, column]))
        np.testing.assert_allclose(seen[:, column], expected, atol=1e-9)
        np.testing.assert_allclose(sensor.sampled(times, values[:, column]), expected, atol=1e-9)
    np.testing.assert_allclose(seen[:, 0], 3.0 * sensor.block_times)


def test_whitening_leaves_independent_numbers_of_unit_variance() -> None:
    sensor = _series(50)
    unit = sensor.whitened(np.eye(len(sensor.starts)))
    np.testing.assert_allclose(unit @ sensor.covariance @ unit.T, np.eye(len(sensor.starts)), atol=1e-10)
    # Drawn with noise per reading and a discrepancy that all readings of a stretch share.
    rng = np.random.default_rng(2)
    apart = np.abs(sensor.times[:, None] - sensor.times[None, :])
    root = np.linalg.cholesky(0.1**2 * np.exp(-apart / 120.0) + 1e-10 * np.eye(50))
    drawn = root @ rng.normal(size=(50, 4000)) + 0.5 * rng.normal(size=(50, 4000))
    white = sensor.whitened(sensor.block_means(drawn))
    np.testing.assert_allclose(np.cov(white), np.eye(len(sensor.starts)), atol=0.12)


def test_a_trial_takes_its_series_one_after_the_other() -> None:
    first, second = _series(30), _series(80, noise=2.0)
    trial = MeasuredDrive("run", {}, False, (first, second))
    blocks = np.arange(30.0 + DEFAULT.blocks)
    expected = np.concatenate([first.whitened(blocks[:30]), second.whitened(blocks[30:])])
    np.testing.assert_array_equal(trial.whitened(blocks), expected)


def test_stretches_follow_the_slope() -> None:
    sensor = _series(400)
    t = sensor.block_times
    rising = 25.0 + 60.0 * (1 - np.exp(-np.minimum(t, 600.0) / 100.0))
    history = np.where(t <= 600.0, rising, 25.0 + (rising - 25.0) * np.exp(-(t - 600.0) / 150.0))
    kinds = stretches(sensor, history)
    # 10 % of the fastest rate is left after ln(10) time constants.
    assert set(kinds[t < 200.0]) == {"heating"}
    assert set(kinds[(t > 270.0) & (t < 550.0)]) == {"plateau"}
    assert set(kinds[(t > 640.0) & (t < 850.0)]) == {"cooling"}
    assert set(stretches(sensor, np.full_like(t, 25.0))) == {"plateau"}
