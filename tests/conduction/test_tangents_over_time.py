"""Sources with a strength over time: the hats add up, and a switched source is the difference of two simulations."""

from __future__ import annotations

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.conduction.fixed_steps import fixed_step_solution
from tyrefem.conduction.sensitivity import Perturbed, stage_times, tangents, tangents_over_time
from tyrefem.simulation.rolling_tyre import RollingTyre

HEAT = {"name": "missing-heat", "station": "60 mm", "width": "12 mm", "heat": "1 kW/m**3"}


def test_hats_of_a_source_over_time() -> None:
    study = tf.study("nasa-22x5.5-8pr", {"mesh.size": "8 mm", "drive.duration": "300 s"})
    tyre = RollingTyre(study)
    times = stage_times([0.0, 300.0], longest=10.0)
    values, reservoirs = fixed_step_solution(tyre.problem, times, tyre.drive.initial)
    heated = Perturbed(RollingTyre(study.replace({"effects": [HEAT]}), tyre).problem, 1000.0)
    knots = np.array([0.0, 100.0, 120.0, 300.0])
    over_time = tangents_over_time(tyre.problem, times, values, reservoirs, [heated], knots)
    constant = tangents(tyre.problem, times, values, reservoirs, [heated])
    assert over_time.values.shape[0] == 4
    np.testing.assert_allclose(over_time.values.sum(axis=0), constant.values[0], rtol=1e-9, atol=1e-12)
    # Strength 0 until 100 s, 1 from 120 s on: a switch at 110 s.
    late = RollingTyre(study.replace({"effects": [HEAT | {"begins": "110 s"}]}), tyre)
    fine = stage_times([0.0, 110.0, 300.0], longest=10.0)
    simulated = fixed_step_solution(late.problem, fine, tyre.drive.initial)[0][-1]
    without = fixed_step_solution(tyre.problem, fine, tyre.drive.initial)[0][-1]
    rise = (simulated - without) / 1000.0
    computed = over_time.values[2:, -1].sum(axis=0)
    assert rise.max() > 0
    assert computed == pytest.approx(rise, abs=0.01 * rise.max())
