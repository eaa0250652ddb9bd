"""Base numbers in the amended study: deviations of the fit wherever stated, and drives of runs by any name."""

from __future__ import annotations

import math
from typing import Any

import pytest

import tyrefem as tf
from tyrefem.diagnose.amend import Change, amended
from tyrefem.diagnose.unknowns.unknown import Unknown, base_unknowns
from tyrefem.inputs.uncertain_numbers import uncertain_at

LOSS = "materials.tread.loss_tangent.value"
UP, SD = math.log(1.1), 0.013


def changed(study: tf.Study, key: str, sd: float = SD) -> tf.Study:
    """The study after a base number was found 10 % larger."""
    (unknown,) = (each for each in base_unknowns(study) if each.key == key)
    return amended(study, (Change(unknown, UP, sd, False, "test"),))


def unknown(study: tf.Study, key: str) -> Unknown:
    (number,) = (each for each in base_unknowns(study) if each.key == key)
    return number


@pytest.mark.parametrize(
    ("key", "stated", "written"),
    [
        (LOSS, "20 %", "1.3 %"),
        (LOSS, 0.2, 0.013),
        ("drive.load", "2 %", "1.3 %"),
        # 1.3 % of 2970 lbf; the amended number and its deviation in the unit of the number.
        ("drive.load", "100 N", "39 lbf"),
    ],
)
def test_a_deviation_in_the_table_is_that_of_the_fit(key: str, stated: Any, written: Any) -> None:
    study = tf.study("example-validation", {"uncertainty": {key: stated, "drive.pressure": "1 %"}})
    new = changed(study, key)
    assert new.data["uncertainty"] == {key: written, "drive.pressure": "1 %"}
    assert unknown(new, key).sd == pytest.approx(SD, rel=0.02)


def test_a_deviation_of_a_temperature_stays_in_kelvins() -> None:
    study = tf.study("example-validation", {"uncertainty": {"drive.ambient": "2 K"}})
    new = changed(study, "drive.ambient", sd=0.001)
    # 0.1 % of 1.1 x 298.15 K.
    assert new.data["uncertainty"] == {"drive.ambient": "0.33 K"}


def test_a_deviation_of_a_card_is_that_of_the_fit_in_every_region_however_it_is_stated() -> None:
    study = tf.study("passenger-205-55r16")
    (ply,) = (each for each in base_unknowns(study) if each.key == "materials.body-ply.conductivity.value")
    assert len(ply.keys) > 1
    other = ply.keys[1]
    new = amended(study.replace({"uncertainty": {other: "30 %"}}), (Change(ply, UP, SD, False, "test"),))
    number = uncertain_at(new, ply.key)
    assert number is not None
    assert number.sd == pytest.approx(SD)
    assert new.data["uncertainty"] == {other: "1.3 %"}


@pytest.mark.parametrize("name", ["phases.0.duration", "phases.rolling.duration"])
@pytest.mark.parametrize("stated", ["drive.phases.0.duration", "drive.phases.rolling.duration"])
def test_a_phase_of_a_run_is_changed_by_number_and_by_name(name: str, stated: str) -> None:
    measured = [{"table": "run-1.csv", "drive": {name: "300 s", "load": "2000 lbf"}}]
    study = tf.study("example-validation", {"uncertainty": {stated: "2 %"}, "measured": measured})
    new = changed(study, stated)
    assert new.data["measured"][0]["drive"] == {name: "330 s", "load": "2000 lbf"}
    assert new.data["drive"]["phases"][0]["duration"] == "660 s"
    assert new.data["uncertainty"] == {stated: "1.3 %"}


def test_a_phase_of_a_run_with_phases_of_its_own_is_changed() -> None:
    phases = [{"name": "rolling", "duration": "300 s"}, {"name": "fast", "duration": "60 s", "speed": "40 mph"}]
    key = "drive.phases.rolling.duration"
    measured = [{"table": "run-1.csv", "drive": {"phases": phases}}]
    study = tf.study("example-validation", {"uncertainty": {key: "2 %"}, "measured": measured})
    (run,) = changed(study, key).data["measured"]
    assert run["drive"]["phases"] == [{**phases[0], "duration": "330 s"}, phases[1]]
