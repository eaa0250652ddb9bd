"""A study is immutable, changes by dotted name, and survives its own file."""

from __future__ import annotations

import copy
import json
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pint
import pytest

import tyrefem as tf
from tyrefem.errors import InputError
from tyrefem.variants.plan import plan_of

pytestmark = pytest.mark.fast

QUICK = {"mesh.size": "4 mm", "mesh.element": "P1", "drive.duration": "60 s"}


@pytest.fixture(scope="module")
def study():
    return tf.study("nasa-22x5.5-8pr")


def test_replace_returns_a_new_study(study):
    before = copy.deepcopy(study.data)
    faster = study.replace({"drive.speed": "25 mph", "materials.tread.loss_tangent.value": 0.1})
    assert study.data == before
    assert faster.card.drive.phases[0].speed.start == pytest.approx(25 * 0.44704)
    assert faster.materials["tread"].loss_tangent(25.0) == pytest.approx(0.1)
    assert study.materials["tread"].loss_tangent(25.0) == pytest.approx(0.2)
    with pytest.raises(AttributeError):
        study.name = "another"


def test_scaled_multiplies_the_number_wherever_it_stands(study):
    for key in ("drive.load", "materials.tread.conductivity.value", "section.crown_radius"):
        changed = study.scaled(key, 1.01)
        assert changed.scaled(key, 1 / 1.01).section.line.crown_radius == pytest.approx(study.section.line.crown_radius)
    assert study.scaled("section.crown_radius", 1.01).section.line.crown_radius == pytest.approx(
        1.01 * study.section.line.crown_radius
    )
    assert study.scaled("drive.load", 0.5).card.drive.phases[0].load.start == pytest.approx(1350 * 4.4482216)


def test_every_uncertain_number_can_be_scaled(study):
    assert study.uncertainty["materials.tread.loss_tangent.value"] == pytest.approx(0.2)
    assert {"conductivity", "specific_heat", "loss_tangent"} == {key.split(".")[2] for key in study.uncertainty}
    for key, sd in study.uncertainty.items():
        assert 0 < sd < 1
        assert study.scaled(key, 1 + sd).data != study.data


def test_a_saved_study_runs_to_identical_readings(study, tmp_path):
    changed = study.replace(
        {**QUICK, "section.crown_radius": "3.4 in", "materials.tread.conductivity.value": "0.25 W/m/K"}
    )
    loaded = tf.study(str(changed.save(tmp_path / "other" / "study.toml")))
    assert loaded.data == changed.data
    assert (loaded.run().readings == changed.run().readings).all(axis=None)


def test_the_error_names_file_and_field(tmp_path, study):
    file = study.save(tmp_path / "study.toml")
    file.write_text(file.read_text().replace('speed = "20 mph"', 'speed = "20"'))
    with pytest.raises(tf.InputError) as caught:
        tf.study(str(file))
    assert str(file) in str(caught.value)
    assert "drive.speed: '20' has no unit" in str(caught.value)


def test_an_unknown_study_gets_the_nearest_name():
    with pytest.raises(tf.InputError, match=r"did you mean 'nasa-22x5\.5-"):
        tf.study("nasa-22x5.5-8p")


def test_a_missing_region_is_named(study):
    data = copy.deepcopy(study.data)
    del data["materials"]["bead"]
    with pytest.raises(tf.InputError, match="no material card for region 'bead'"):
        tf.Study("x", data, None, study.folder)


def test_a_load_that_the_section_cannot_bear_is_an_input_error(study):
    with pytest.raises(tf.InputError, match=r"impossible|deflects the tyre"):
        study.replace({"drive.load": "30000 lbf"}).run()


def test_a_thickness_scale_may_be_named_without_its_table() -> None:
    study = tf.study("nasa-22x5.5-8pr")
    short = study.replace({"section.thickness_scale.tread": 1.2})
    assert short.data == study.replace({"section.parameters.thickness_scale.tread": 1.2}).data
    assert short.section.thickness("tread", 0.0) == pytest.approx(1.2 * study.section.thickness("tread", 0.0))


def test_quantities_of_pint_and_numbers_of_numpy_are_saved_as_text(study, tmp_path):
    units = pint.UnitRegistry()
    changed = study.replace(
        {
            "drive.speed": 25 * units.mph,
            "drive.ambient": units.Quantity(77.0, "degF"),
            "sensors.crown-inner.noise": units.Quantity(0.5, "delta_degC"),
            "sensors.crown-inner.at": np.array([10.4, 0.0]) * units.inch,
            "materials.tread.loss_tangent.value": np.float32(0.125),
            "output.fields": np.int64(3),
        }
    )
    assert changed.data["drive"]["speed"] == "25 mph"
    loaded = tf.study(changed.save(tmp_path / "study.toml"))
    assert loaded.card == changed.card
    assert loaded.card.drive.phases[0].ambient.start == 25.0
    assert loaded.materials == changed.materials


def test_a_study_of_quantities_is_saved_too(study, tmp_path):
    data = study.data | {"drive": study.data["drive"] | {"speed": pint.UnitRegistry().Quantity(20, "mph")}}
    assert tf.study(tf.Study("mine", data, None, study.folder).save(tmp_path / "study.toml")).card == study.card


def test_a_sweep_takes_quantities(study):
    units = pint.UnitRegistry()
    speeds = [10 * units.mph, 20 * units.mph]
    for vary in (speeds, (*speeds, 2)):
        plan = plan_of(study, {"drive.speed": vary})
        assert [variant["drive.speed"] for variant in plan.variants] == ["10 mph", "20 mph"]


def test_what_a_study_was_read_from_cannot_be_changed() -> None:
    """``study.data["drive"]["speed"] = ...`` had left the run at the old speed, and its files said the new one."""
    study = tf.study("hidden-effect")
    data: Any = study.data
    changes: list[Callable[[], object]] = [
        lambda: data["drive"].__setitem__("speed", "25 mph"),
        lambda: data["drive"].update(speed="25 mph"),
        lambda: data["drive"].pop("load"),
        lambda: data.__ior__({"title": "mine"}),
        lambda: data["measured"].append({}),
        lambda: data["measured"][0].__delitem__("table"),
        lambda: data["measured"].__iadd__([{}]),
    ]
    before = json.dumps(data)
    for again in (study, study.replace({"drive.load": "3000 lbf"}), pickle.loads(pickle.dumps(study))):
        data = again.data
        for change in changes:
            with pytest.raises(InputError, match=r"a study does not change; study\.replace\("):
                change()
    assert json.dumps(study.data) == before


def test_a_copy_of_what_a_study_was_read_from_can_be_changed() -> None:
    study = tf.study("nasa-22x5.5-8pr")
    data: Any = copy.deepcopy(study.data)
    assert data == study.data
    data["drive"]["speed"] = "25 mph"
    faster = tf.Study("faster", data, None, study.folder)
    data["drive"]["speed"] = "30 mph"
    assert faster.data["drive"]["speed"] == "25 mph"
    assert faster.card.drive.value("speed", 0.0) == pytest.approx(25 * 0.44704)
    assert study.data["drive"]["speed"] == "20 mph"
    assert copy.deepcopy(faster).data == faster.data
    assert (study.data | {"title": "mine"})["title"] == "mine"
