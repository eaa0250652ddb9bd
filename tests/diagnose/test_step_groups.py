"""Unknowns that take their steps at once: what each changes is the reading of another sensor."""

from __future__ import annotations

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.diagnose.forward.fixed_step import fixed_step_run
from tyrefem.diagnose.forward.reading_sensitivities import sensitivities_about
from tyrefem.diagnose.forward.step_groups import step_groups, stepped
from tyrefem.diagnose.unknowns.unknown import Unknown, of_effect, with_values
from tyrefem.effects import catalogue

KNOWN = catalogue()
LOSS = Unknown("materials.tread.loss_tangent.value", 0.1)


def of_sensor(effect: str, sensor: str, sd: float | None = None) -> tuple[Unknown, ...]:
    return of_effect(KNOWN[effect], (("sensor", sensor),), sd)


def small_study(**changes: object) -> tf.Study:
    return tf.study("hidden-effect").replace({"mesh.size": "8 mm", **changes})


def test_the_same_change_of_different_sensors_is_one_step() -> None:
    (crown,), (bead,) = of_sensor("sensor-lag", "crown-inner"), of_sensor("sensor-lag", "bead-middle")
    along, deeper = of_sensor("sensor-misplaced", "crown-inner")
    unknowns = [LOSS, crown, along, deeper, bead]
    assert step_groups(unknowns, small_study()) == [(0,), (1, 4), (2,), (3,)]
    values = stepped(unknowns, (1, 4), {LOSS: 0.3, bead: 2.0})
    assert values == {LOSS: 0.3, crown: crown.step, bead: 2.0 + bead.step}


def test_a_sensor_takes_one_step_at_a_time() -> None:
    (card,), (effect,) = of_sensor("sensor-lag", "crown-inner", sd=1.0), of_sensor("sensor-lag", "crown-inner")
    (bead,) = of_sensor("sensor-lag", "bead-middle")
    assert step_groups([card, effect, bead], small_study()) == [(0, 2), (1,)]


def test_swapped_channels_keep_the_unknowns_apart() -> None:
    swapped = small_study(effects=[{"name": "swapped-channels", "sensor": "crown-inner", "other": "bead-middle"}])
    unknowns = [unknown for name in swapped.sensors for unknown in of_sensor("sensor-lag", name)]
    assert step_groups(unknowns, swapped) == [(number,) for number in range(len(unknowns))]


@pytest.mark.parametrize(
    "effects", [[], [{"name": "swapped-channels", "sensor": "crown-inner", "other": "bead-middle"}]]
)
def test_sensitivities_at_once_are_those_one_by_one(effects: list[dict[str, str]]) -> None:
    study = small_study(effects=effects)
    base = fixed_step_run(study)
    names = tuple(study.sensors)
    unknowns = [unknown for name in names for of in ("sensor-lag", "sensor-offset") for unknown in of_sensor(of, name)]

    def slopes(of: list[Unknown]) -> np.ndarray:
        varied = sensitivities_about(base, of, {}, lambda values: with_values(study, values, study))
        by_sensor = varied.slopes(names)
        return np.array([by_sensor[name] for name in names])

    together = slopes(unknowns)
    apart = np.concatenate([slopes([unknown]) for unknown in unknowns], axis=2)
    assert np.abs(together).max() > 0.5
    np.testing.assert_allclose(together, apart, atol=1e-12)
