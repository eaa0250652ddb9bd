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


def test_several_entries_of_one_name_need_a_number():
    data = {"effects": [{"name": "sensor-offset", "sensor": "a"}, {"name": "sensor-offset", "sensor": "b"}]}
    words = r"several entries have the name 'sensor-offset': give a number: 0 \(sensor-offset\), 1 \(sensor-offset\)"
    with pytest.raises(tf.InputError, match=words):
        changed(data, "effects.sensor-offset.offset", "1 delta_degC")
    assert changed(data, "effects.1.offset", "1 delta_degC")["effects"][1]["offset"] == "1 delta_degC"


def test_a_layer_by_its_name_or_number():
    study = tf.study("passenger-205-55r16")
    gauge = {"unit": "mm", "values": [1.5, 1.4]}
    by_name, by_number = (study.replace({f"section.layers.{n}.thickness": gauge}) for n in ("liner", "0"))
    assert by_name.section.layers[0].thickness.values == (0.0015, 0.0014)
    assert by_number.section.layers[0] == by_name.section.layers[0]
    with pytest.raises(tf.InputError, match="no entry 'linr'; did you mean 'liner'"):
        study.replace({"section.layers.linr.thickness": gauge})


def test_a_layer_by_a_part_of_its_name():
    """The layer is `belt-2 and turn-up`; `belt` alone names none."""
    study = tf.study("passenger-205-55r16")
    assert value_at(study.data, "section.layers.belt-2.name", study.folder) == "belt-2 and turn-up"
    assert value_at(study.data, "section.layers.turn-up.name", study.folder) == "belt-2 and turn-up"
    lower = study.replace({"section.layers.belt-1.regions.sidewall.to": "-36 mm"}).section
    ends = dict(zip(lower.layers[2].regions.names, lower.layers[2].regions.ends, strict=True))
    assert ends["sidewall"] == pytest.approx(lower.line.length - 0.036)
    with pytest.raises(tf.InputError, match="no entry 'belt'"):
        study.replace({"section.layers.belt.name": "x"})


def test_the_angle_of_a_layer_s_cords():
    """`section.layers.belt-1.angle` means the cords of the region; the study itself stays as it was."""
    study = tf.study("passenger-205-55r16")
    before = copy.deepcopy(study.data)
    turned = study.replace({"section.layers.belt-1.angle": "20 deg"})
    assert turned.materials["belt-1"].cords.angle == pytest.approx(0.3490658504)
    assert turned.data == study.replace({"materials.belt-1.cords.angle": "20 deg"}).data
    assert study.data == before
    assert value_at(turned.data, "section.layers.belt-1.angle", study.folder) == "20 deg"
    with pytest.raises(tf.InputError, match="did you mean 'belt-1'"):
        study.replace({"section.layers.belt1.angle": "20 deg"})
    of_size = tf.study("measured-205-60r15").replace({"section.layers.belt-1.angle": "20 deg"})
    assert of_size.materials["belt-1"].cords.angle == pytest.approx(0.3490658504)


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
