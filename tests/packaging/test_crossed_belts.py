"""Belts as two single plies (benchmarks/crossed_belts.py) against a series and against averaged belts."""

from __future__ import annotations

import math
from dataclasses import replace
from types import ModuleType

import numpy as np
import pytest
from script_module import script_module

import tyrefem as tf
from tyrefem.mechanics.rolling.tread_influence import TreadInfluence


@pytest.fixture(scope="module")
def crossed() -> ModuleType:
    """benchmarks/crossed_belts.py."""
    return script_module("benchmarks/crossed_belts.py")


@pytest.mark.parametrize("angle", [20.0, 26.0])
def test_free_edges_take_what_the_series_says(crossed: ModuleType, angle: float) -> None:
    computed, exact = crossed.two_plies(2.5e6, 24e9, math.radians(angle), 0.08, 1.25e-3, 24)
    assert computed == pytest.approx(exact, rel=5e-3)
    assert exact > 0.2


def test_single_plies_are_softer_and_both_hands_alike(crossed: ModuleType) -> None:
    """The compliance is symmetric, exceeds that of averaged belts by a positive matrix, and is even in the hand."""
    pressed = tf.study("measured-205-60r15", {"mesh.size": "16 mm"}).press(motion="linear")
    tread, inflated = pressed.pressing.tread, pressed.tyre.state
    averaged, single = TreadInfluence(tread), crossed.CrossedBelts(tread, inflated=inflated)
    size = averaged.solved(3)[0].size * 3
    before, after = (points.solved(3).reshape(round(math.sqrt(size)), -1) for points in (averaged, single))
    assert np.abs(after - after.T).max() < 1e-9 * np.abs(after).max()
    more = np.linalg.eigvalsh(after - before)
    assert more.min() > -1e-6 * more.max()
    assert more.max() > 0.02 * np.linalg.eigvalsh(before).max()
    other = replace(single, hands={"belt-1": -1.0, "belt-2": 1.0})
    assert other.solved(3).ravel() == pytest.approx(after.ravel(), abs=1e-9 * np.abs(after).max())
