"""The simulations of a comparison: announced, shared, kept where it is interrupted, and certified in long drives."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import tyrefem as tf
from tyrefem.compare import runs
from tyrefem.compare.reduced_inputs import ReducedInputCertificate, ReducedInputRuns, ReducedInputSettings
from tyrefem.compare.runs import Runs
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.footprint.pressed_tyre import REMEMBERED_TYRES
from tyrefem.processes import processes
from tyrefem.variants.answer_store import AnswerStore

QUICK = {"mesh.size": "12 mm", "mesh.element": "P1", "numerics.tolerance": "0.1 delta_degC", "output.every": "20 s"}


def table(study: StudyData) -> pd.DataFrame:
    """What the study computes, 3 K warmer, every minute."""
    readings = study.run().readings.iloc[::3]
    return readings.assign(**{name: readings[name] + 3.0 for name in readings if name != "time_s"})


@pytest.fixture(scope="module")
def quick() -> StudyData:
    return tf.study("example-validation").replace(QUICK)


@pytest.fixture(scope="module")
def measured(quick: StudyData) -> pd.DataFrame:
    return table(quick)


class Counted:
    """How many runs of each kind were made."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.made: list[str] = []
        for name in ("base_run", "training_run", "full_run"):
            monkeypatch.setattr(runs, name, self.counting(name, getattr(runs, name)))

    def counting(self, name, function):
        def run(work):
            self.made.append(name)
            return function(work)

        return run


@pytest.fixture
def counted(monkeypatch: pytest.MonkeyPatch) -> Counted:
    return Counted(monkeypatch)


def test_an_interrupted_comparison_goes_on(
    quick: StudyData, measured: pd.DataFrame, tmp_path: Path, counted: Counted
) -> None:
    whole = quick.compare(measured, reduced="never")
    count = len(counted.made)
    assert count == 1 + len(quick.uncertainty)
    messages: list[str] = []

    def stop(done: int, total: int) -> None:
        if done == 5:
            raise KeyboardInterrupt

    store = AnswerStore(tmp_path / "kept")
    with pytest.raises(KeyboardInterrupt):
        quick.compare(measured, reduced="never", store=store, progress=stop)
    assert store.count == 5
    assert store.kept == "5 finished simulations are kept; the same command resumes from there"
    counted.made.clear()
    again = quick.compare(measured, reduced="never", store=AnswerStore(tmp_path / "kept"), begin=messages.append)
    # The drive itself is run again, for its mesh and operators.
    assert counted.made == ["base_run", *["full_run"] * (count - 5)]
    assert messages == [
        "15 simulations: 1 drive as driven; 14 with one uncertain input changed; 4 are reused from an interrupted "
        "comparison"
    ]
    pd.testing.assert_frame_equal(again.table, whole.table)
    pd.testing.assert_frame_equal(again.inputs, whole.inputs)
    # Interrupted after the last of them, nothing is run again.
    counted.made.clear()
    once_more = quick.compare(measured, reduced="never", store=AnswerStore(tmp_path / "kept"))
    assert counted.made == []
    pd.testing.assert_frame_equal(once_more.table, whole.table)


def test_runs_of_a_reduced_model_and_its_certificate_are_kept_too(
    quick: StudyData, measured: pd.DataFrame, tmp_path: Path, counted: Counted
) -> None:
    first = quick.compare(measured, store=AnswerStore(tmp_path))
    assert first.reduced is not None
    assert counted.made == ["base_run", "training_run", "training_run", "training_run"]
    counted.made.clear()
    again = quick.compare(measured, store=AnswerStore(tmp_path))
    assert counted.made == []
    assert vars(again.reduced) == vars(first.reduced)
    assert again.notes == first.notes
    pd.testing.assert_frame_equal(again.inputs, first.inputs)
    # Full runs are asked for: those of the model do not count.
    quick.compare(measured, store=AnswerStore(tmp_path), reduced="never")
    assert counted.made == ["base_run", *["full_run"] * 11]
    # Another study has nothing of it.
    counted.made.clear()
    quick.replace({"drive.speed": "21 mph"}).compare(measured, store=AnswerStore(tmp_path), inputs=False)
    assert counted.made == ["base_run"]


def remembered() -> int:
    """Tyres that a worker's finite elements have solved and kept."""
    return len(REMEMBERED_TYRES)


@pytest.fixture(scope="module")
def pressed() -> StudyData:
    """Finite elements on a coarse mesh, for ten seconds."""
    changes = {"mechanics.strain": "fem", "drive.duration": "10 s", "output.every": "5 s", "mesh.size": "15 mm"}
    changes["mechanics.motion"] = "linear"
    return tf.study("nasa-22x5.5-8pr").replace({**QUICK, **changes, "sensors.crown": {"s": "0 mm", "depth": "5 mm"}})


def test_finite_elements_are_solved_once_for_all_that_does_not_change_them(pressed: StudyData) -> None:
    measured = pressed.run().readings[["time_s", "crown"]]
    messages: list[str] = []
    with processes(1) as pool:
        comparison = pressed.compare(measured, executor=pool, reduced="never", begin=messages.append)
        assert pool.submit(remembered).result() == 1
    assert "strain cycles to be solved by finite elements: 1" in messages[0]
    # The same as on its own.
    key = "materials.tread.loss_tangent.value"
    alone = pressed.scaled(key, 1.0 + pressed.uncertainty[key]).run().readings["crown"]
    change = comparison.inputs.set_index(["key", "phase"])["change_K"][key, "all"]
    assert change == pytest.approx((alone - measured["crown"]).mean(), abs=1e-9)


def test_a_long_drive_is_followed_from_its_first_readings() -> None:
    """What a change does to a surface within the first minutes of three hours must be taught.

    A fiftieth of the drive, 216 s, is too late: the errors of such a model are twice as large.
    """
    changes = {"mechanics.strain": "given", "mesh.size": "12 mm", "mesh.element": "P1", "output.every": "60 s"}
    study = tf.study("truck-295-80r22.5").replace(changes)
    outer = ("tread", "sidewall", "apex", "shoulder-cushion")
    keys = {key: sd for key, sd in study.uncertainty.items() if key.split(".")[1] in outer}
    studies = {("", None): study} | {("", key): study.scaled(key, 1.0 + sd) for key, sd in keys.items()}

    def certificate(settings: ReducedInputSettings) -> ReducedInputCertificate:
        with Runs(studies, keys) as made:
            made.begin()
            return ReducedInputRuns(made, settings).solve()

    taught = certificate(ReducedInputSettings()).worst
    assert taught < 0.016
    # The first model that is not taught, whatever its error.
    assert certificate(ReducedInputSettings(early=np.inf, safety=10.0)).worst > 2 * taught
