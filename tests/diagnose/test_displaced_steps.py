"""Places of sensors count exactly in the steps of a fit: a thermocouple at the warmest place is found at once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from hidden import measure, study
from numpy.typing import NDArray

import tyrefem as tf
from tyrefem.compare.experiment import experiments
from tyrefem.diagnose.data.runs import MeasuredDrive, MeasuredSensor, measured_drive
from tyrefem.diagnose.fitting.displaced_steps import displaced_steps
from tyrefem.diagnose.fitting.gauss_newton import FitState, initial_state
from tyrefem.diagnose.forward.forward_model import ForwardModel
from tyrefem.diagnose.inference.linear_model import DesignMatrix, LinearModel
from tyrefem.diagnose.settings import DEFAULT
from tyrefem.diagnose.unknowns.unknown import Unknown, sensor_unknowns
from tyrefem.geometry.meshing.sagitta import kept_inside

Array = NDArray[np.float64]
N = 40
#: Sensitivity of a reading to the heat, and its curve over the depth of the sensor, K; the sensor is at the top.
HEAT, WARMEST = Unknown("materials.tread.loss_tangent.value", 0.3), 0.2e-3


@pytest.fixture(scope="module")
def owner(tmp_path_factory: pytest.TempPathFactory) -> tf.Study:
    made = study(tmp_path_factory.mktemp("displaced"))
    measure(made, [])
    return made


def deeper(owner: tf.Study) -> Unknown:
    """The depth of the first sensor."""
    unknowns = sensor_unknowns(owner, set(owner.sensors))
    return next(unknown for unknown in unknowns if unknown.key.endswith(".deeper"))


@pytest.mark.parametrize("at", [0.0, 1.0])
def test_moved_sensors_read_what_a_simulation_says(owner: tf.Study, at: float) -> None:
    run = measured_drive(experiments(owner, None, ignore=(), rename=None)[0], owner)
    model = ForwardModel(owner, (run.sampling,))
    places = [each for each in sensor_unknowns(owner, set(owner.sensors)) if each.effect == "sensor-misplaced"]
    values = {each: at * each.sd for each in places}
    rng = np.random.default_rng(4)
    shifts = rng.uniform(-1e-3, 1e-3, (2, len(owner.stated_places), 2))
    names = list(owner.stated_places)
    for shift in shifts:
        change = model.displaced(0, values, shift)[0]
        by_name = dict(zip(names, shift.tolist(), strict=True))
        moved = {
            each: values[each] + by_name[dict(each.choice)["sensor"]][("along", "deeper").index(each.parameter.name)]
            for each in places
            if each.parameter
        }
        expected = model.predict(0, moved) - model.predict(0, values)
        assert np.abs(expected).max() > 0.05
        np.testing.assert_allclose(change, expected, atol=1e-9)


@dataclass
class Curve:
    """Readings that bend with the sensor's depth, at fixed temperatures."""

    place: Unknown
    asked: int = 0

    def reading(self, heat: float, depth: float) -> Array:
        over_time = np.linspace(0.2, 1.0, N)
        bend = ((depth - WARMEST) / 1e-3) ** 2 - (WARMEST / 1e-3) ** 2
        return 60.0 * heat * over_time - 9.0 * bend * over_time**2

    def of(self, method: str, questions: Any) -> list[Array]:
        assert method == "displaced"
        self.asked += 1
        return [self._displaced(values, shift) for _, values, shift in questions]

    def _displaced(self, values: Mapping[Unknown, float], shift: Array) -> Array:
        here, there = (self.reading(0.0, values[self.place] + each) for each in (0.0, shift[0, 1]))
        ahead = self.reading(0.0, values[self.place] + shift[0, 1] + 1e-8)
        return np.array([there - here, np.zeros(N), (ahead - there) / 1e-8])


def state_of(curve: Curve, run: MeasuredDrive) -> tuple[FitState, Any]:
    """The first step of a fit of heat and depth from x = 0, and its residuals."""
    slope = (curve.reading(0.0, 1e-8) - curve.reading(0.0, 0.0)) / 1e-8
    jacobian = np.column_stack([curve.reading(1.0, 0.0), slope])
    design = DesignMatrix((HEAT, curve.place), 2, jacobian)
    state = initial_state(LinearModel(design, run.measured), {0: np.zeros(N)}, (), DEFAULT)
    sensor = dict(curve.place.choice)["sensor"]
    residuals = SimpleNamespace(
        study=SimpleNamespace(stated_places={sensor: (0.0, 0.0)}, card=SimpleNamespace(effects=())),
        fitted=[0],
        runs=(run,),
        joined=np.concatenate,
    )
    return state, residuals


def series(readings: Array, sensor: str) -> MeasuredDrive:
    times = np.arange(float(N))
    return MeasuredDrive("run", {}, False, (MeasuredSensor(sensor, times, 1.0, 0.0, 1.0, N, measured=readings),))


def test_a_step_that_slopes_lead_astray_ends_where_the_readings_are(owner: tf.Study) -> None:
    place = deeper(owner)
    curve, truth = Curve(place), (0.05, 1.3e-3)
    state, residuals = state_of(curve, series(curve.reading(*truth), dict(place.choice)["sensor"]))
    misfit = state.misfit(state.r, state.x)

    def true_misfit(point: Array) -> float:
        return state.misfit(residuals.runs[0].measured - curve.reading(*point), point)

    # At the top of the curve a slope sees nothing, or sends the sensor to the wrong side.
    by_slope = true_misfit(state.next_point)
    (taken,) = displaced_steps([residuals], cast(Any, SimpleNamespace(evaluations=curve)), [state])
    assert taken.expected is not None
    assert true_misfit(taken.next_point) == pytest.approx(taken.misfit(taken.expected, taken.next_point), rel=1e-9)
    assert true_misfit(taken.next_point) < min(by_slope, misfit) - DEFAULT.least_reduction
    assert curve.asked > 1
    # The next Jacobian has the slope of the new depth.
    depth = taken.next_point[1]
    slope = (curve.reading(0.0, depth + 1e-8) - curve.reading(0.0, depth)) / 1e-8
    assert taken.next_jacobian is not None
    np.testing.assert_allclose(taken.next_jacobian[:, 1], slope, rtol=0.05)
    np.testing.assert_allclose(taken.next_jacobian[:, 0], state.J[:, 0])


def test_a_slope_at_the_end_of_the_wall_is_that_towards_the_inside(owner: tf.Study) -> None:
    run = measured_drive(experiments(owner, None, ignore=(), rename=None)[0], owner)
    model = ForwardModel(owner, (run.sampling,))
    name = next(iter(owner.stated_places))
    place, depth = (float(each) for each in owner.section.locate(np.array(owner.stated_places[name])))
    rows = run.parts()[name]
    thickness = float(owner.section.rubber_thickness(place))
    outline, mesh = owner.section.place([place], [thickness]), model.base(0).tyre.mesh
    # As far out as straight-sided elements allow.
    end = thickness - float(np.linalg.norm(kept_inside(mesh, outline) - outline)) - depth

    def displaced(deeper: float) -> Array:
        shift = np.zeros((len(owner.stated_places), 2))
        shift[0, 1] = deeper
        return model.displaced(0, {}, shift)[:, rows]

    inwards = (displaced(end)[0] - displaced(end - 1e-4)[0]) / 1e-4
    assert np.abs(inwards).max() > 100.0
    np.testing.assert_allclose(displaced(end)[2], inwards, rtol=0.1, atol=20.0)
    np.testing.assert_allclose(displaced(end + 1e-3)[0], displaced(end)[0], rtol=1e-5)


def test_a_sensor_whose_slope_is_wrong_does_not_hold_back_another(owner: tf.Study) -> None:
    # Both sensors moved outwards; the second one stands where the wall ends: its slope says nothing of the way back.
    places = [each for each in sensor_unknowns(owner, set(owner.sensors)) if each.key.endswith(".deeper")][:2]
    names, over_time = [dict(each.choice)["sensor"] for each in places], np.linspace(0.2, 1.0, N)
    straight, steep = 6e3 * over_time, 4e4 * over_time

    def of(method: str, questions: Any) -> list[Array]:
        (shift,) = (shift for _, _, shift in questions)
        change = np.concatenate([straight * shift[0, 1], steep * min(shift[1, 1], 0.0)])
        return [np.array([change, np.zeros(2 * N), np.concatenate([straight, np.zeros(N)])])]

    wanted, beyond = 1e-3, 2.0 * places[1].sd
    times = np.arange(float(N))
    sensors = tuple(MeasuredSensor(name, times, 1.0, 0.0, 1.0, N, measured=np.zeros(N)) for name in names)
    run = MeasuredDrive("run", {}, False, sensors)
    jacobian = np.concatenate([straight, np.zeros(N)])[:, None] * [[1.0, 0.0]]
    data = np.concatenate([straight * wanted, np.zeros(N)])
    state = initial_state(
        LinearModel(DesignMatrix(tuple(places), 2, jacobian), data), {0: np.zeros(2 * N)}, (), DEFAULT
    )
    state = replace(state, x=np.array([0.0, beyond])).proposed()
    assert state.next_point[1] == pytest.approx(0.0, abs=1e-9)
    residuals = SimpleNamespace(
        study=SimpleNamespace(stated_places=dict.fromkeys(names, (0.0, 0.0)), card=SimpleNamespace(effects=())),
        fitted=[0],
        runs=(run,),
        joined=np.concatenate,
    )
    predictions = cast(Any, SimpleNamespace(evaluations=SimpleNamespace(of=of)))
    (taken,) = displaced_steps(cast(Any, [residuals]), predictions, [state])
    assert taken.next_point[0] == pytest.approx(state.next_point[0], rel=1e-3)
    assert taken.next_point[1] > 0.9 * beyond


def test_without_a_simulation_at_the_point_a_step_follows_the_slopes(owner: tf.Study) -> None:
    place = deeper(owner)
    curve = Curve(place)
    state, residuals = state_of(curve, series(curve.reading(0.05, 1.3e-3), dict(place.choice)["sensor"]))
    curve.reading = lambda heat, depth: np.full(N, np.nan)  # type: ignore[method-assign]
    assert displaced_steps([residuals], cast(Any, SimpleNamespace(evaluations=curve)), [state]) == [state]


def test_a_step_without_moving_sensors_asks_nothing(owner: tf.Study) -> None:
    curve = Curve(deeper(owner))
    state, residuals = state_of(curve, series(np.zeros(N), "crown"))
    assert not state.next_point.any()
    assert displaced_steps([residuals], cast(Any, SimpleNamespace(evaluations=curve)), [state]) == [state]
    assert curve.asked == 0
