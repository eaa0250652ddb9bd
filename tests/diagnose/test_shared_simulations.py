"""Diagnoses of one layout share their simulations at x = 0; readings of many columns are those of each."""

from __future__ import annotations

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.api import Study
from tyrefem.diagnose.data.sensitivities import shared_responses, unknowns_of
from tyrefem.diagnose.forward.evaluations import Evaluations
from tyrefem.diagnose.forward.forward_model import ForwardModel
from tyrefem.diagnose.layout.planned_runs import planned
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.simulation.sensors import lagged, recorded, recorded_change

COARSE = DiagnosisSettings(mesh_size="12 mm")


@pytest.fixture(scope="module")
def study() -> Study:
    return tf.study("example-validation", {"mesh.size": "12 mm"})


def model_of(study: Study, settings: DiagnosisSettings = COARSE) -> ForwardModel:
    return ForwardModel(study, planned(study)[:1], settings=settings)


def test_models_of_one_layout_share_the_simulation_at_zero(study: Study) -> None:
    base = model_of(study).base(0)
    assert model_of(study).base(0) is base
    faster = study.replace({"materials.tread.loss_tangent.value": 0.3})
    other = model_of(faster).base(0)
    assert other is not base
    assert not np.allclose(other.values, base.values)
    assert model_of(study, DiagnosisSettings(mesh_size="10 mm")).base(0) is not base


def test_models_of_one_layout_share_the_readings_by_another_law(study: Study) -> None:
    first = model_of(study).change_by_law(0, "barrel", 0.1)
    second = model_of(study).change_by_law(0, "barrel", 0.1)
    np.testing.assert_array_equal(first, second)
    assert not np.allclose(first, model_of(study).change_by_law(0, "barrel", 0.2))


def test_models_of_one_layout_share_the_responses(study: Study) -> None:
    unknowns, _ = unknowns_of(study, list(study.sensors), ())
    some = unknowns[:3]
    first = shared_responses(Evaluations(model_of(study)), some)
    assert shared_responses(Evaluations(model_of(study)), some) is first
    assert shared_responses(Evaluations(model_of(study)), unknowns[:2]) is not first


def test_results_of_several_methods_come_in_the_order_of_the_questions(study: Study) -> None:
    evaluations, heard = Evaluations(model_of(study)), list[str]()
    driven = evaluations.model.driven(study, 0)
    (history,), (means, (times, readings)) = evaluations.histories_beside(
        [driven], [("predict", (0, {})), ("base_readings", (0,))], lambda: heard.append("further")
    )
    np.testing.assert_array_equal(history, evaluations.model.history(driven))
    np.testing.assert_array_equal(means, evaluations.model.predict(0, {}))
    assert readings.shape == (len(evaluations.model.sensors), len(times))
    assert heard == ["further", "further"]
    # The run is known now.
    assert evaluations.histories([driven])[0] is history


def test_readings_of_many_columns_are_those_of_each(study: Study) -> None:
    times = np.linspace(0.0, 100.0, 41)
    names = list(study.sensors)
    effects = [
        {"name": "sensor-lag", "sensor": names[0], "slower_by": "12 s"},
        {"name": "sensor-offset", "sensor": names[-1], "too_high": "2 delta_degC"},
        {"name": "clock-offset", "late": "3 s"},
    ]
    acted = study.replace({"effects": effects})
    columns = np.sin(np.outer(times, np.arange(1, 2 * len(names) + 1)) / 40.0).reshape(len(times), len(names), 2)
    together = recorded(acted, times, columns)
    change = recorded_change(acted, times, columns)
    for k in range(2):
        alone = recorded(acted, times, columns[:, :, k])
        for name in names:
            np.testing.assert_allclose(together[name][:, k], alone[name], rtol=1e-13, atol=1e-13)
    np.testing.assert_allclose(together[names[-1]] - change[names[-1]], 2.0, rtol=1e-12)
    np.testing.assert_allclose(
        lagged(times, columns[:, :, 0], 5.0)[:, 1], lagged(times, columns[:, 1, 0], 5.0), rtol=1e-13
    )
