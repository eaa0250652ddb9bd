"""The stepped tyre: against full runs, its own states and limits, and away from every other library."""

from __future__ import annotations

import shutil
import subprocess
import sys
import textwrap
from pathlib import Path

import numpy as np
import pytest

import tyrefem
from tyrefem.realtime import tyre as realtime
from tyrefem.realtime.certificate import DriveTask, export, perform_drive
from tyrefem.realtime.inputs import Box, BoxDrive, box_of, random_drive, steady
from tyrefem.realtime.tyre import GAMMA, PHI, PHI_2, Inputs, RealTimeTyre, inverse
from tyrefem.variants.task import bundle

WARM = Inputs(10.0, 12e3, 560e3, 20.0, 30.0)


def test_the_certificate_is_of_fresh_steady_and_changing_runs(exported):
    certificate = exported.certificate
    assert certificate.worst <= 0.3
    assert certificate.cases == (2, 2)
    assert (
        set(certificate.steady)
        == set(certificate.driven)
        == {"skin", "slow", "rim", "contained-air", "hottest", "rolling_resistance"}
    )
    # Interpolated films and heat are much better known than temperatures.
    assert certificate.tables["films"] < 1e-4
    assert certificate.tables["heat"] < 5e-3
    assert RealTimeTyre(exported.file).about["certificate"]["worst"] == pytest.approx(certificate.worst)


def test_a_course_of_its_own_agrees_with_a_full_run(exported):
    """Steps and ramps written here, not drawn by the certificate's own generator."""
    first = [[8.0, 12e3, 560e3, 20.0, 30.0], [0.0, 12e3, 560e3, 20.0, 30.0], [0.0, 10e3, 560e3, 25.0, 15.0]]
    last = [[8.0, 12e3, 560e3, 20.0, 30.0], [0.0, 12e3, 560e3, 20.0, 30.0], [11.0, 13e3, 540e3, 25.0, 15.0]]
    course = BoxDrive(np.array([0.0, 40.0, 55.0, 90.0]), np.array(first), np.array(last), 22.0)
    result = course.study(exported.study).run()
    tyre = RealTimeTyre(exported.file)
    tyre.reset(22.0)
    rows = [tyre.outputs] + [tyre.step(1.0, *course.inputs(t - 1.0, t)) for t in range(1, 91)]
    table = dict(zip(tyre.names, np.array(rows).T, strict=True))
    whole = np.isclose(result.times % 1.0, 0.0)
    number = np.round(result.times[whole]).astype(int)
    for name in ("skin", "slow", "rim", "contained-air"):
        full = result.readings[name].to_numpy()[whole]
        assert np.ptp(full) > (3.0 if name == "skin" else 0.05)
        np.testing.assert_allclose(table[name][number], full, atol=0.15)
    hottest = np.asarray(result.history.values).max(axis=1)[whole]
    np.testing.assert_allclose(table["hottest"][number], hottest, atol=0.3)
    drag = result.heat_budget.power("generated")[whole][number > 70] / [
        course.inputs(t - 1.0, t)[1].speed for t in number[number > 70]
    ]
    np.testing.assert_allclose(table["rolling_resistance"][number[number > 70]], drag, rtol=0.01)
    # Pressure follows the contained air at constant volume.
    assert table["gas_pressure"][40] == pytest.approx(result.gas_pressure[whole][number == 40][0], rel=1e-4)


def test_no_heat_and_no_difference_leave_the_tyre_as_it_is(exported):
    tyre = RealTimeTyre(exported.file)
    tyre.reset(20.0)
    for _ in range(30):
        outputs = tyre.step(10.0, Inputs(0.0, 10e3, 560e3, 20.0))
    names = dict(zip(tyre.names, outputs, strict=True))
    for name in ("skin", "slow", "rim", "contained-air", "hottest"):
        assert names[name] == pytest.approx(20.0, abs=1e-9)
    assert names["gas_pressure"] == pytest.approx(560e3)
    assert names["rolling_resistance"] == 0.0


def test_halving_the_step_changes_little(exported):
    tyre, ends = RealTimeTyre(exported.file), []
    for step in (2.0, 1.0, 0.25):
        tyre.reset(15.0)
        for _ in range(round(60 / step)):
            outputs = tyre.step(step, WARM)
        ends.append(outputs[:5])
    assert np.abs(ends[0] - ends[2]).max() < 5e-3
    assert np.abs(ends[1] - ends[2]).max() < 2e-3


def test_inputs_that_change_during_a_step_are_followed(exported):
    """Ten seconds of a ramp of everything: in one step each second, and in short steps of held inputs."""
    first, last = np.array([4.0, 10e3, 530e3, 12.0, 15.0]), np.array([11.0, 12.5e3, 590e3, 28.0, 38.0])
    ends = []
    for step, linear in ((1.0, True), (0.02, False), (1.0, False)):
        tyre = RealTimeTyre(exported.file)
        tyre.reset(20.0)
        for k in range(round(10 / step)):
            now, later = (Inputs(*(first + (last - first) * number * step / 10).tolist()) for number in (k, k + 1))
            middle = Inputs(*(first + (last - first) * (k + 0.5) * step / 10).tolist())
            outputs = tyre.step(step, now, later) if linear else tyre.step(step, middle)
        ends.append(outputs[: tyre.names.index("gas_pressure")])
    assert np.abs(ends[0] - ends[1]).max() < 0.05
    # Held at their mean they leave the skin half a step behind.
    assert np.abs(ends[2] - ends[1]).max() > 3 * np.abs(ends[0] - ends[1]).max()


def test_a_state_given_back_goes_on_to_the_bit(exported):
    tyre = RealTimeTyre(exported.file)
    tyre.reset(12.0)
    assert np.isnan(tyre.outputs[-1])
    for _ in range(5):
        tyre.step(1.0, WARM)
    kept = tyre.state
    before = tyre.outputs
    ahead = [tyre.step(1.0, Inputs(5.0, 10e3, 530e3, 15.0)) for _ in range(3)]
    other = RealTimeTyre(exported.file)
    other.state = kept
    np.testing.assert_array_equal(other.outputs, before)
    again = [other.step(1.0, Inputs(5.0, 10e3, 530e3, 15.0)) for _ in range(3)]
    np.testing.assert_array_equal(again, ahead)
    assert other.time == 8.0
    with pytest.raises(ValueError, match="numbers"):
        other.state = kept[1:]


def test_a_step_of_a_nanosecond_is_a_step(exported):
    """Masters with events make such steps: they are not lost."""
    tyre = RealTimeTyre(exported.file)
    tyre.step(1.0, WARM)
    before, time = tyre.state, tyre.time
    for _ in range(10):
        tyre.step(1e-9, WARM)
    assert tyre.time - time == pytest.approx(1e-8, rel=1e-3)
    assert (tyre.state != before).any()


def test_inputs_outside_the_box_are_refused_or_moved_to_its_edge(exported):
    tyre = RealTimeTyre(exported.file)
    with pytest.raises(ValueError, match=r"speed = 40 is outside 0 to 12 m/s"):
        tyre.step(1.0, Inputs(40.0, 12e3, 560e3, 20.0))
    with pytest.raises(ValueError, match="load = nan"):
        RealTimeTyre(exported.file, clamp=True).step(1.0, Inputs(5.0, float("nan"), 560e3, 20.0))
    with pytest.raises(ValueError, match="step"):
        tyre.step(0.0, WARM)
    with pytest.raises(ValueError, match="a temperature must be a number of degC, not nan"):
        tyre.reset(float("nan"))
    soft, edge = RealTimeTyre(exported.file, clamp=True), RealTimeTyre(exported.file)
    moved = soft.step(1.0, Inputs(40.0, 12e3, 560e3, 20.0, 30.0))
    np.testing.assert_array_equal(moved, edge.step(1.0, Inputs(12.0, 12e3, 560e3, 20.0, 30.0)))
    assert len(soft.clamped) == 1
    soft.step(1.0, WARM)
    assert soft.clamped == []


def test_another_file_is_refused(exported, tmp_path):
    text = tmp_path / "tyre.npz"
    text.write_text("no numbers")
    with pytest.raises(ValueError, match="is not a real-time model"):
        RealTimeTyre(text)
    whole = exported.file.read_bytes()
    for length in (0, 100, len(whole) // 2):
        text.write_bytes(whole[:length])
        with pytest.raises(ValueError, match="is not a real-time model"):
            RealTimeTyre(text)
    with pytest.raises(FileNotFoundError):
        RealTimeTyre(tmp_path / "none.npz")
    np.savez(tmp_path / "old.npz", about=np.array('{"format": "old"}'))
    with pytest.raises(ValueError, match="is a 'old'"):
        RealTimeTyre(tmp_path / "old.npz")


def test_a_copy_of_one_module_needs_numpy_only(exported, tmp_path):
    """A bare process: tyrefem, scikit-fem, scipy and pandas cannot be imported there."""
    shutil.copy(Path(realtime.__file__), tmp_path / "realtime.py")
    shutil.copy(exported.file, tmp_path / "tyre.npz")
    (tmp_path / "use.py").write_text(
        textwrap.dedent("""
        import sys
        from importlib.abc import MetaPathFinder
        from pathlib import Path

        class Blocker(MetaPathFinder):
            def find_spec(self, name, path=None, target=None):
                if name.split(".")[0] in {"tyrefem", "skfem", "scipy", "pandas", "pydantic", "pint", "meshio"}:
                    raise ImportError(f"{name} must not be needed")

        sys.meta_path.insert(0, Blocker())
        here = Path(__file__).parent
        sys.path.insert(0, str(here))
        from realtime import Inputs, RealTimeTyre

        tyre = RealTimeTyre(here / "tyre.npz")
        for _ in range(10):
            tyre.step(1.0, Inputs(10.0, 12e3, 560e3, 20.0, 30.0))
        print(*(repr(float(one)) for one in tyre.outputs))
        """)
    )
    command = [sys.executable, "-I", "-W", "error", str(tmp_path / "use.py")]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=tmp_path)
    tyre = RealTimeTyre(exported.file)
    for _ in range(10):
        tyre.step(1.0, WARM)
    np.testing.assert_allclose([float(number) for number in done.stdout.split()], tyre.outputs, rtol=1e-12)


def test_the_rational_functions_are_what_the_module_says():
    z = np.geomspace(1e-6, 1e9, 20001)
    x = 1 / (1 + GAMMA * z)
    decay = 1 - z * sum(b * x ** (j + 1) for j, b in enumerate(PHI))
    assert np.abs(decay - np.exp(-z)).max() < 2.2e-4
    assert np.abs(decay).max() < 1
    assert abs(1 - PHI[0] / GAMMA) < 1e-12
    small = z[z < 0.05]
    # The error of a step falls with its fourth power.
    assert (np.abs(decay - np.exp(-z))[: len(small)] < 1e-14 + small**4).all()
    second = sum(b * x ** (j + 1) for j, b in enumerate(PHI_2))
    exact = (z - 1 + np.exp(-z)) / z**2
    assert np.abs(second - exact)[z > 1e-2].max() < 7e-3
    assert sum(PHI_2) == pytest.approx(0.5)


def test_inverse_of_a_positive_matrix():
    A = np.random.default_rng(1).normal(size=(31, 31))
    W = A @ A.T + np.eye(31)
    np.testing.assert_allclose(inverse(W) @ W, np.eye(31), atol=1e-9)


def test_random_courses_stay_in_their_box():
    box = Box(
        {"speed": (0, 10), "load": (1e3, 2e3), "pressure": (1e5, 2e5), "ambient": (0, 30), "road_temperature": (5, 5)}
    )
    for seed in range(20):
        course = random_drive(box, 200.0, seed)
        both = np.vstack([course.first, course.last])
        assert (both >= box.low - 1e-9).all()
        assert (both <= box.high + 1e-9).all()
        assert np.diff(course.ends).min() >= 20
        assert course.ends[-1] == 200
    study = course.study(tyrefem.study("nasa-22x5.5-8pr", {"mesh.size": "12 mm"}))
    drive, t = study.card.drive, 77.25
    for name in ("speed", "load", "ambient"):
        assert drive.value(name, t) == pytest.approx(getattr(course.inputs(t - 0.25, t)[1], name))
        assert drive.value(name, t) == pytest.approx(getattr(course.inputs(t, t + 0.25)[0], name))


def test_rolling_to_rest_has_no_drag_of_rounding(exported):
    low = [0.1 + 0.2, 1.0e4, 5.5e5, 20.0, 20.0]
    # Three steps of a tenth: the ramp ends at some 1e-17 m/s and not at rest.
    course = BoxDrive(np.array([0.0, 30.0]), np.array([low]), np.array([[0.1 + 0.2 - 0.3, *low[1:]]]), 20.0)
    resistance = perform_drive(DriveTask(bundle(exported.study), course, 1.0, 4)).answers["rolling_resistance"]
    assert course.last[0, 0] > 0
    assert resistance[-1] == 0.0
    assert 5.0 < resistance[1:-1].max() < 1000.0


@pytest.mark.parametrize(("key", "value"), [("drum_diameter", "2 m"), ("rim_temperature", "90 degC")])
def test_what_is_no_input_must_be_the_same_in_every_phase(key, value):
    """Given in one phase only, it would act in all drives of the training."""
    phases = [{"name": "first", "duration": "10 s"}, {"name": "second", "duration": "10 s", key: value}]
    study = tyrefem.study("nasa-22x5.5-8pr", {"drive.phases": phases})
    with pytest.raises(tyrefem.InputError, match=f"'{key}' must be the same in every phase"):
        steady(box_of(study), np.full(5, 0.5), 10.0).study(study)


@pytest.mark.parametrize("duration", [0.5, 0.0])
def test_drives_of_less_than_a_second_are_refused_before_any_work(tmp_path, duration):
    with pytest.raises(tyrefem.InputError, match=r"duration: .* must be a second or more"):
        export(tyrefem.study("nasa-22x5.5-8pr"), tmp_path / "tyre.npz", duration=duration)
