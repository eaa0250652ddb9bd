"""Changes by dotted name reach what they name, and nothing else."""

from __future__ import annotations

import copy

import pytest

import tyrefem as tf
from tyrefem.inputs.changes import changed, scaled, value_at

pytestmark = pytest.mark.fast

PHASES = {"drive": {"load": "1 kN", "phases": [{"name": "a", "load": "2 kN"}, {"name": "b", "deflection": "1 mm"}]}}


def test_the_original_is_left_alone():
    before = copy.deepcopy(PHASES)
    after = changed(PHASES, "drive.phases.a.load", "3 kN")
    assert before == PHASES
    assert after["drive"]["phases"][0]["load"] == "3 kN"
    assert after["drive"]["phases"][1] == PHASES["drive"]["phases"][1]


def test_a_phase_by_name_or_by_number():
    assert changed(PHASES, "drive.phases.0.load", "3 kN") == changed(PHASES, "drive.phases.a.load", "3 kN")
    with pytest.raises(tf.InputError, match="no entry 'c'; allowed: a, b"):
        changed(PHASES, "drive.phases.c.load", "3 kN")


def test_load_and_deflection_drop_each_other():
    after = changed(PHASES, "drive.phases.a.deflection", "2 mm")
    assert after["drive"]["phases"][0] == {"name": "a", "deflection": "2 mm"}


@pytest.mark.parametrize("key", ["drive.load", "drive.deflection"])
def test_a_change_that_every_phase_overrides_is_refused(key):
    with pytest.raises(tf.InputError, match="every phase sets 'deflection or load': name the phase"):
        changed(PHASES, key, "3 kN" if key.endswith("load") else "3 mm")


def test_section_shorthand():
    data = {"section": "nasa-22x5.5-8pr"}
    name = {"base": "nasa-22x5.5-8pr"}
    assert changed(data, "section.crown_radius", "3 in")["section"] == {**name, "parameters": {"crown_radius": "3 in"}}
    assert changed(data, "section.cord_angle", "40 deg")["section"] == {**name, "rating": {"cord_angle": "40 deg"}}
    scale = changed(data, "section.parameters.thickness_scale.tread", "1.1")["section"]
    assert scale == {**name, "parameters": {"thickness_scale": {"tread": "1.1"}}}


def test_a_sensor_s_two_ways_of_placing():
    data = {"sensors": {"x": {"s": "1 in", "depth": "1 mm", "lag": "2 s"}}}
    assert changed(data, "sensors.x.at", ["0.25 m", "0 m"])["sensors"]["x"] == {"lag": "2 s", "at": ["0.25 m", "0 m"]}


def test_a_value_is_found_through_the_cards():
    study = tf.study("nasa-22x5.5-8pr")
    assert value_at(study.data, "materials.tread.loss_tangent.value", study.folder) == 0.2
    assert value_at(study.data, "section.crown_radius", study.folder) == "3.482 in"
    with pytest.raises(tf.InputError, match="did you mean 'specific_heat'"):
        value_at(study.data, "materials.tread.specific_heet.value", study.folder)


@pytest.mark.parametrize("value", ["fast", True, None, {}, ["a"]])
def test_only_numbers_scale(value):
    with pytest.raises(tf.InputError, match="not a number that can be scaled"):
        scaled(value, 2.0)


def test_scaling_keeps_the_unit():
    assert scaled("83 psi", 0.5) == "41.5 psi"
    assert scaled(["1 in", 2], 2) == ["2 in", 4]


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("drive.sped", "20 mph", "did you mean 'speed'"),
        ("drive..speed", "20 mph", "not a dotted name"),
        ("drive.speed.from", "20 mph", "'drive.speed' is a value, not a table"),
        ("boundaries.road.law", "catani", "did you mean 'cattani'"),
        ("materials.tred", "nasa-tread", "did you mean 'tread'"),
        ("materials.tread", "nasa-tred", "did you mean 'nasa-tread'"),
        ("section.crown_radus", "3 in", "did you mean 'crown_radius'"),
        ("mesh.cell", "hex", "'hex' is not allowed"),
    ],
)
def test_a_wrong_name_says_the_nearest(key, value, message):
    with pytest.raises(tf.InputError, match=message):
        tf.study("nasa-22x5.5-8pr").replace({key: value})
