"""Changed strain cycles by finite elements start from those of their drive: the same changes, fewer solutions."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pandas as pd
import pytest

import tyrefem as tf
from tyrefem.compare import ComparisonData, runs
from tyrefem.compare.packed_drive import Work, solve_cycles
from tyrefem.mechanics.footprint.pressed_tyre import REMEMBERED_TYRES

SHORT = {"mesh.size": "14 mm", "mesh.element": "P1", "drive.duration": "60 s", "numerics.tolerance": "0.02 delta_degC"}
STIFF = ("materials.tread.shear_modulus.value", "materials.carcass.cord.ply_shear_modulus")
UNCERTAIN = {"uncertainty": dict.fromkeys(STIFF, 0.2) | {"drive.load": 0.02}}


def pressed(motion: str) -> tf.Study:
    return tf.study("nasa-22x5.5-8pr", {**SHORT, **UNCERTAIN, "mechanics.strain": "fem", "mechanics.motion": motion})


def tables(study: tf.Study, drives: dict[str, dict[str, Any]]) -> list[pd.DataFrame]:
    """What the study computes at its drives, 1 K warmer."""
    readings = [study.with_drive(drive).run().readings for drive in drives.values()]
    return [table.assign(**{name: table[name] + 1.0 for name in table if name != "time_s"}) for table in readings]


def changes(comparison: ComparisonData) -> pd.Series:
    """Change of every mean, K, by sensor and input."""
    whole = comparison.inputs[comparison.inputs["phase"] == "all"]
    return whole.set_index(["sensor", "key"])["change_K"]


def alone(study: tf.Study, key: str) -> pd.Series:
    """Change of every mean, K, of two runs that know nothing of each other."""
    REMEMBERED_TYRES.clear()
    changed = study.scaled(key, 1.0 + study.uncertainty[key]).run().readings
    return (changed - study.run().readings).mean()


def test_in_linear_motion_the_changes_are_those_of_separate_runs() -> None:
    study = pressed("linear")
    (table,) = tables(study, {"as driven": {}})
    compared = changes(study.compare(table, reduced="never"))
    for key in UNCERTAIN["uncertainty"]:
        expected = alone(study, key)
        for sensor in study.sensors:
            assert compared[sensor, key] == pytest.approx(expected[sensor], abs=1e-6)


def test_in_large_motion_the_changes_are_those_of_separate_runs_to_the_tolerance_of_a_balance() -> None:
    """Two balances, each to 0.1 % of its motion, differ by as much as some hundredths of a change."""
    study = pressed("large")
    (table,) = tables(study, {"as driven": {}})
    compared = changes(study.compare(table, reduced="never"))
    for key in UNCERTAIN["uncertainty"]:
        expected = alone(study, key)
        largest = max(abs(expected[sensor]) for sensor in study.sensors)
        assert largest > 0.02
        for sensor in study.sensors:
            assert compared[sensor, key] == pytest.approx(expected[sensor], abs=0.1 * largest + 2e-3)


@pytest.fixture
def solved(monkeypatch: pytest.MonkeyPatch) -> list[Work]:
    """The changed strain cycles that are solved."""
    made: list[Work] = []

    def counted(work: Work) -> None:
        made.append(work)
        solve_cycles(work)

    monkeypatch.setattr(runs, "solve_cycles", counted)
    return made


def test_drives_with_the_same_load_share_their_changed_cycles(solved: list[Work], tmp_path: Path) -> None:
    study = pressed("linear").replace({"uncertainty": {STIFF[0]: 0.2}})
    (table,) = tables(study, {"as driven": {}})
    table.columns = ["time [s]", *(f"{name} [degC]" for name in table.columns[1:])]
    table.to_csv(tmp_path / "run.csv", index=False)
    drives: list[dict[str, str]] = [{}, {"speed": "30 mph"}, {"load": "2500 lbf"}]
    measured = study.replace({"measured": [{"table": str(tmp_path / "run.csv"), "drive": drive} for drive in drives]})
    comparison = measured.compare(reduced="never")
    assert comparison.inputs["run"].nunique() == 3
    # One changed number at two loads, not at three drives.
    assert [work.tyre.study.card.drive.phases[0].load.start for work in solved] == pytest.approx(
        [12010.2, 11120.6], rel=1e-4
    )
    assert all(set(work.changes) == {STIFF[0]} for work in solved)


def test_a_reduced_model_follows_changed_cycles() -> None:
    study = tf.study("nasa-22x5.5-8pr", {**SHORT, "mechanics.strain": "fem", "mechanics.motion": "linear"})
    study = study.replace({"uncertainty": dict.fromkeys(STIFF, 0.2) | {"drive.pressure": 0.05}})
    (table,) = tables(study, {"as driven": {}})
    comparison, full = study.compare(table), study.compare(table, reduced="never")
    assert comparison.reduced is not None
    assert comparison.reduced.reduced + comparison.reduced.full == comparison.inputs["key"].nunique()
    assert comparison.reduced.full <= 4
    near, far = changes(comparison), changes(full)
    for key in (*STIFF, "drive.pressure"):
        for sensor in study.sensors:
            assert near[sensor, key] == pytest.approx(far[sensor, key], abs=comparison.reduced.tolerance)


def test_a_reduced_model_follows_a_loss_that_changes_the_strain_energy(monkeypatch: pytest.MonkeyPatch) -> None:
    """Beside cords of a loss of their own, tan delta of the rubber changes heat and strain energy: two patterns."""
    study = tf.study("aircraft-radial", {**SHORT, "mesh.size": "16 mm", "mechanics.motion": "linear"})
    key = "materials.inner-belts.loss_tangent.value"
    # Beside it only what leaves the strain cycles as they are: each other number would have them solved again.
    thermal = ("conductivity.value", "specific_heat.value")
    numbers = [each for each in study.uncertain_numbers if each.key == key or each.key.endswith(thermal)]
    monkeypatch.setattr(type(study), "uncertain_numbers", tuple(numbers))
    study = study.replace({"uncertainty": {key: 0.3}})
    (table,) = tables(study, {"as driven": {}})
    comparison, full = study.compare(table), study.compare(table, reduced="never")
    assert comparison.reduced is not None
    # All but the runs of the certificate are reduced; it compares those with the largest changes, of which this is one.
    assert comparison.reduced.full == comparison.reduced.cases
    assert comparison.reduced.worst < 0.1 * comparison.reduced.tolerance
    near, far = changes(comparison), changes(full)
    for sensor in study.sensors:
        assert near[sensor, key] == pytest.approx(far[sensor, key], abs=0.1 * comparison.reduced.tolerance)
