"""Changed strain cycles by finite elements start from those of their drive: the same changes, fewer solutions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import Executor
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import tyrefem as tf
from tyrefem.compare import ComparisonData, changed_cycles
from tyrefem.compare.changed_cycles import Key
from tyrefem.compare.interface import Computed
from tyrefem.compare.packed_drive import Work, solve_cycles
from tyrefem.compare.runs import Runs
from tyrefem.mechanics.cycle_schedule import CycleSchedule
from tyrefem.mechanics.footprint.pressed_tyre import REMEMBERED_TYRES
from tyrefem.reduced.training import Snapshots

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

    def counted(changed: Sequence[Work]) -> None:
        made.extend(changed)
        solve_cycles(changed)

    monkeypatch.setattr(changed_cycles, "solve_cycles", counted)
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


class Noted(Executor):
    """Other processes, in name only. ``order``: drives as they are there, and the changed cycles that begin: the drives
    of each piece."""

    def __init__(self) -> None:
        self.order: list[Any] = []

    def map(self, function: Any, *work: Any, timeout: float | None = None, chunksize: int = 1) -> Iterator[Any]:
        """Answers without any work; cycles begin at once."""
        (given,) = work
        if function is not solve_cycles:
            return map(self._driven, range(len(given)))
        self.order.append([[Path(each.drive.cycles).stem for each in piece] for piece in given])
        return iter([None] * len(given))

    def _driven(self, number: int) -> Any:
        self.order.append(str(number))
        computed = Computed(None, pd.DataFrame({"time_s": [0.0]}), pd.DataFrame({"crown": [0.0]}), [])
        drive = tf.study("nasa-22x5.5-8pr").card.drive
        return computed, Snapshots(np.zeros((1, 1)), np.zeros((1, 1))), CycleSchedule(drive, (), ((number,),), ())


def began(drives: list[dict[str, str]]) -> list[Any]:
    """In which order drives are there and changed cycles begin, with all of them ahead."""
    study, executor = pressed("large").replace({"uncertainty": dict.fromkeys(STIFF, 0.2)}), Noted()
    studies: dict[Key, Any] = {}
    for number, drive in enumerate(drives):
        driven = study.with_drive(drive)
        studies |= {(str(number), None): driven}
        studies |= {(str(number), key): driven.scaled(key, 1.2) for key in STIFF}
    with Runs(studies, dict.fromkeys(STIFF, 0.2), executor=executor) as made:
        made.begin([key for key in studies if key[1] is not None])
        count = len(executor.order)
        made.solve_cycles(studies)
        assert len(executor.order) == count
    return executor.order


def test_changed_cycles_begin_before_the_last_drive_is_there() -> None:
    """Else a process that has no drive to run would wait; drives of one pressure share a changed tyre."""
    higher = {"pressure": "95 psi"}
    order = began([{}, {"load": "3000 lbf"}, higher])
    assert order == ["0", "1", [["0", "1"], ["0", "1"]], "2", [["2"], ["2"]]]
    order = began([{}, higher, {"load": "3000 lbf"}])
    assert order == ["0", [["0"], ["0"]], "1", [["1"], ["1"]], "2", [["2"], ["2"]]]


def test_no_more_than_two_drives_of_one_pressure_are_a_piece_of_work() -> None:
    order = began([{}, {"load": "3000 lbf"}, {"load": "2500 lbf"}])
    assert order == ["0", "1", [["0", "1"], ["0", "1"]], "2", [["2"], ["2"]]]
