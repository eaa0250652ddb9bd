"""What another strain law changes at the sensors, and a law that a study cannot run."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from hidden import study

import tyrefem as tf
from tyrefem.diagnose.forward.forward_model import ForwardModel
from tyrefem.diagnose.forward.sampling import DriveSampling, SensorSampling
from tyrefem.diagnose.forward.strain_law_study import by_law
from tyrefem.diagnose.settings import DiagnosisSettings

TIMES = np.arange(0.0, 160.0, 8.0)


def test_another_strain_law_changes_the_readings_by_its_runs_difference(tmp_path: Path) -> None:
    owner = study(tmp_path).replace({"drive.duration": "160 s"})
    sensors = tuple(SensorSampling(name, TIMES, 0.5, 0.1, 120.0) for name in owner.sensors)
    settings = DiagnosisSettings(mesh_size="8 mm")
    model = ForwardModel(owner, (DriveSampling("run", {}, hold_out=False, sensors=sensors),), settings=settings)
    change = model.change_by_law(0, "barrel")
    assert np.isfinite(change).all()
    # The barrel has half the arcs' energy at the crown (docs/evidence/strain-laws.md): the tread stays colder.
    of_tread = change[model.drives[0].parts()["crown-outer"]]
    assert of_tread[-1] < -0.5
    np.testing.assert_allclose(model.change_by_law(0, "arcs"), 0.0, atol=1e-9)
    assert np.isnan(model.change_by_law(0, "given")).all()


def test_a_level_on_the_heat_is_for_every_run_also_beside_an_entry_at_null_or_of_one_run() -> None:
    shape = {"name": "heat-shape", "half_waves": 0}
    of_run = {**shape, "log_factor": 0.2, "runs": ["A"]}
    for entries in ([shape], [of_run], [of_run, shape]):
        stated = tf.study("hidden-effect").replace({"effects": entries})
        factors = [
            float(each["log_factor"]) for each in by_law(stated, "barrel", 0.1).data["effects"] if not each.get("runs")
        ]
        assert factors == [0.1]
