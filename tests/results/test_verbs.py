"""The verbs of `tyrefem.api`: the same data as another class, whatever it goes through."""

from __future__ import annotations

import dataclasses
import json
import pickle
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

import tyrefem as tf
from tyrefem.api import Comparison, Diagnosis, with_verbs
from tyrefem.brief import Brief
from tyrefem.compare import compare
from tyrefem.diagnose import diagnosis as diagnosis_data
from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.press import press


@dataclass(frozen=True, eq=False)
class Readings(Brief):
    """Data."""

    sensor: str
    values: tuple[float, ...]


class Shown(Readings):
    """The same with a verb."""

    def show(self) -> str:
        """In a line."""
        return f"{self.sensor}: {self.values}"


def test_verbs_take_the_data_as_they_are() -> None:
    data = Readings("crown", (1.0, 2.0))
    shown = with_verbs(Shown, data)
    assert shown.show() == "crown: (1.0, 2.0)"
    assert shown.values is data.values
    assert repr(shown) == repr(data).replace("Readings", "Shown")
    assert dataclasses.replace(shown, sensor="bead").show() == "bead: (1.0, 2.0)"
    with pytest.raises(dataclasses.FrozenInstanceError):
        shown.sensor = "bead"  # type: ignore[misc]
    assert pickle.loads(pickle.dumps(shown)).show() == shown.show()


def test_every_further_look_of_a_diagnosis_has_verbs() -> None:
    others: dict[str, Any] = {field.name: None for field in dataclasses.fields(diagnosis_data.DiagnosisData)}
    second = diagnosis_data.DiagnosisData(**others)
    first = diagnosis_data.DiagnosisData(**others | {"again": second})
    looks = Diagnosis.of(first).looks
    assert [type(look) for look in looks] == [Diagnosis, Diagnosis]
    assert first.again is second


def test_a_tyre_is_pressed_and_its_frequencies_are_found_by_verbs(tmp_path: Path) -> None:
    coarse = tf.study("nasa-22x5.5-8pr", {"mesh.size": "14 mm", "mechanics.motion": "linear"})
    loaded = coarse.press(deflection=0.015)
    assert loaded.footprint.load == pytest.approx(press(coarse, deflection=0.015).footprint.load, rel=1e-12)
    assert loaded.footprint.motion == "linear"
    pressure = loaded.footprint.pressure
    with pytest.raises(ValueError, match="read-only"):
        pressure /= 1e3
    assert loaded.save(tmp_path / "pressed", ["tread"], pictures=False, vtk=False) == tmp_path / "pressed"
    assert json.loads((tmp_path / "pressed/press.json").read_text(encoding="utf-8"))["motion"] == "linear"
    assert "tread" in (tmp_path / "pressed/strain-cycle.csv").read_text(encoding="utf-8").splitlines()[1]
    modes = coarse.natural_frequencies([0], 1, pressure=4e5)
    assert modes.table.name.tolist() == ["lateral"]
    assert modes.tyre.pressure == 4e5
    assert modes.save(tmp_path / "modes", pictures=False) == tmp_path / "modes"
    files = ["modes.csv", "modes.json", "study.toml", "summary.json"]
    assert sorted(path.name for path in (tmp_path / "modes").iterdir()) == files


def test_a_comparison_has_verbs_and_its_data_have_none(tmp_path: Path) -> None:
    study = tf.study("example-validation", {"mesh.size": "12 mm"})
    comparison = study.compare(inputs=False)
    assert type(comparison) is tf.Comparison is Comparison
    assert repr(comparison).startswith("Comparison of example-validation")
    back = pickle.loads(pickle.dumps(comparison))
    assert back.save(tmp_path) == tmp_path / "comparison.html"
    data = compare(study, inputs=False)
    assert not hasattr(data, "save")
    assert data.to_dict() == comparison.to_dict()


def test_a_curve_names_its_peak_and_a_rolling_tyre_takes_one_temperature(tmp_path: Path) -> None:
    coarse = tf.study("nasa-22x5.5-8pr", {"mesh.size": "16 mm", "mechanics.motion": "linear"})
    for options, where in (({"slip_angle": [0.0, 0.05]}, "0.05 rad"), ({"slip": [0.01, 0.05]}, "slip 0.05")):
        curve = coarse.slip_curve(**options, tolerance=0.5)
        assert f"peak                 {curve.peak['force_N']:.5g} N at {where}" in repr(curve)
    rolled = coarse.roll(slip=0.01, tolerance=0.5)
    for values in (rolled.state.force, rolled.state.moment, rolled.state.power_map):
        with pytest.raises(ValueError, match="read-only"):
            values /= 1e3
    for temperature, message in (("80 degC", "did you mean 80"), (float("nan"), "must be finite")):
        with pytest.raises(InputError, match=f"temperature: .*{message}"):
            rolled.to_vtk(tmp_path, temperature)  # type: ignore[arg-type]
    assert list(tmp_path.iterdir()) == []
