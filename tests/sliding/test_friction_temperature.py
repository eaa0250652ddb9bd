"""The coefficient of friction follows the temperature of the tread in a drive that rolls with friction."""

from __future__ import annotations

import functools
from pathlib import Path

import pytest

import tyrefem as tf
from tyrefem.api import Result
from tyrefem.reports.assumptions import assumptions

#: Sliding below the speed of the peak: a warmer tread has less friction, from 1.2 at 25 degC to 0.4.
FALLING = {
    "law": "savkoor", "coefficient": 1.2, "standstill": 0.4, "peak_speed": "1 m/s", "width": 0.8, "at": "25 degC",
    "decade": "12 K", "source": "estimate: a test",
}  # fmt: skip
BASE = {
    "mesh.size": "12 mm", "mesh.section": "full", "mechanics.strain": "fem", "mechanics.motion": "linear",
    "drive.load": "4 kN", "drive.duration": "4 h", "drive.slip_angle": "4 deg", "drive.speed": "5 m/s",
    "output.fields": 2, "output.every": "30 min",
    "materials.tread": {"base": "rubber-tread-passenger", "friction": FALLING}, "boundaries.sliding": "rolling",
}  # fmt: skip
FEEDBACK = {
    "mechanics.feedback.pressure": False, "mechanics.feedback.modulus": False, "mechanics.feedback.knots": 3,
    "mechanics.feedback.tolerance": "0.5 K",
}  # fmt: skip


def study(**changes: object) -> tf.Study:
    return tf.study("nasa-22x5.5-8pr", {**BASE, **changes})


@functools.cache
def warm() -> Result:
    return study(**FEEDBACK).run()


def used(result: Result) -> float:
    """Horizontal force over load at the end."""
    return float(result.tyre.sliding.friction(float(result.times[-1]) * (1 - 1e-12)))


def rubbing(result: Result) -> float:
    return float(result.tyre.schedule.cycles[-1][-1].friction.total)


def at(temperature: float) -> Result:
    """A run whose friction is at one temperature, that from which it starts."""
    return study(**{"drive.initial": f"{temperature} degC"}).run()


def test_it_lies_between_cold_and_hot_and_ends_as_the_steady_tread() -> None:
    result = warm()
    outcome = result.feedback
    assert outcome is not None
    assert outcome.converged
    assert outcome.friction_temperature is not None
    steady = outcome.friction_temperature
    assert steady > 35.0
    cold, fixed, hot = at(25.0), at(steady), at(steady + 15)
    assert used(cold) > 1.1 * used(result) > 1.1 * used(hot)
    assert cold.highest[-1] > result.highest[-1] > hot.highest[-1]
    assert used(result) == pytest.approx(used(fixed), rel=5e-3)
    assert rubbing(result) == pytest.approx(rubbing(fixed), rel=1e-2)
    assert result.highest[-1] == pytest.approx(fixed.highest[-1], abs=0.5)
    assert steady == pytest.approx(_tread(fixed), abs=0.5)


def test_a_loaded_result_has_it(tmp_path: Path) -> None:
    result = warm()
    result.save(tmp_path)
    loaded = tf.load(tmp_path)
    assert loaded.feedback == result.feedback


def _tread(result: Result) -> float:
    from tyrefem.simulation.warm_cycles import Warmth

    return float(Warmth.of(result).at(float(result.times[-1])).regions["tread"])


def test_the_heat_budget_closes() -> None:
    budget = warm().heat_budget
    made, kept = budget.total("generated") + budget.total("sliding"), budget.total("stored") + budget.total("lost")
    assert made == pytest.approx(kept, rel=1e-9)
    assert budget.imbalance < 1e-9
    frictions = [cycle.friction.friction for cycle in warm().tyre.schedule.cycles[0]]
    assert frictions[0] > 1.1 * max(frictions[1:])


def test_without_it_friction_stays_cold() -> None:
    off = study(**FEEDBACK, **{"mechanics.feedback.friction": False}).run()
    assert off.feedback is not None
    assert off.feedback.friction_temperature is None
    assert used(off) == pytest.approx(used(at(25.0)), rel=1e-9)
    texts = {
        follows: " ".join(
            text for _, text in assumptions(study(**FEEDBACK, **{"mechanics.feedback.friction": follows}), [])
        )
        for follows in (True, False)
    }
    assert "follows the mean temperature of the tread" in texts[True]
    assert "is that of the drive's initial temperature" in texts[False]
    assert "The temperature acts on: the coefficient of friction." in texts[True]
    assert "The temperature acts on: nothing." in texts[False]


def test_a_constant_coefficient_needs_no_further_run() -> None:
    constant = {**FALLING, "law": "constant"}
    for name in ("standstill", "peak_speed", "width", "at", "decade"):
        del constant[name]
    tread = {"base": "rubber-tread-passenger", "friction": constant}
    result = study(**FEEDBACK, **{"materials.tread": tread, "drive.duration": "5 min"}).run()
    assert result.feedback is not None
    assert result.feedback.iterations == 1
