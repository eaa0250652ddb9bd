"""What a study is built of: shared where two studies do not differ, and never changed from outside."""

from __future__ import annotations

import copy
import dataclasses
import pickle
from concurrent.futures import ThreadPoolExecutor

import pytest

import tyrefem as tf
from tyrefem.inputs import study_parts

WORN = {"effects": [{"name": "worn-tread", "fraction": 0.3}]}


@pytest.fixture(scope="module")
def study() -> tf.Study:
    return tf.study("nasa-22x5.5-8pr", {"mesh.size": "12 mm", "drive.duration": "30 s"})


def test_a_change_shares_what_it_does_not_touch(study: tf.Study) -> None:
    faster = study.replace({"drive.speed": "25 mph"})
    assert faster.section is study.section
    assert faster.stated_places is study.stated_places
    assert all(faster.materials[region] is card for region, card in study.materials.items())
    warmer = study.replace({"materials.tread.conductivity.value": "0.3 W/m/K"})
    assert warmer.materials["tread"].conductivity.value == pytest.approx(0.3)
    assert warmer.materials["carcass"] is study.materials["carcass"]
    wider = study.replace({"section.crown_radius": "3.6 in"})
    assert wider.section.line.crown_radius != study.section.line.crown_radius
    whole = study.replace({"mesh.section": "full"})
    assert (whole.section.half, study.section.half) == (False, True)


def test_a_change_is_the_same_study_as_one_read_anew(study: tf.Study) -> None:
    changes = {
        **WORN, "materials.tread.loss_tangent.value": 0.1, "section.crown_radius": "3.6 in",
        "sensors.crown-inner.depth": "2 mm",
    }  # fmt: skip
    step_by_step = study
    for key, value in changes.items():
        step_by_step = step_by_step.replace({key: value})
    anew = tf.Study(study.name, step_by_step.data, study.file, study.folder)
    for name in ("card", "section", "new_section", "materials", "stated_places", "material_data", "warnings"):
        assert getattr(step_by_step, name) == getattr(anew, name), name


def test_nothing_half_built_is_left_in_a_study(study: tf.Study) -> None:
    changed = study.replace({"drive.speed": "25 mph"})
    assert set(vars(changed)) == {"name", "data", "file", "folder", "parts"} | (set(vars(changed)) & {"effects"})


def test_a_warm_study_leaves_the_cold_one_as_it_is(study: tf.Study) -> None:
    before = copy.deepcopy(study.parts)
    warm = study.warmed(dict.fromkeys(study.materials, 80.0))
    assert type(warm) is type(study)
    assert warm.temperatures == dict.fromkeys(study.materials, 80.0)
    assert study.temperatures is None
    assert warm.section is study.section
    assert study.materials == before.materials.cards


def test_copies_and_pickles_keep_everything(study: tf.Study) -> None:
    worn = study.replace(WORN).warmed(dict.fromkeys(study.materials, 60.0))
    for back in (pickle.loads(pickle.dumps(worn)), copy.deepcopy(worn), copy.copy(worn)):
        assert type(back) is tf.Study
        for name in ("name", "data", "file", "folder", "card", "section", "materials", "temperatures", "stated_places"):
            assert getattr(back, name) == getattr(worn, name), name
    renamed = dataclasses.replace(study, name="another")
    assert (renamed.name, renamed.card) == ("another", study.card)


def test_equal_wear_is_one_section_and_few_are_kept(study: tf.Study) -> None:
    study_parts._WORN.clear()
    first, again = study.replace(WORN), study.replace(WORN | {"drive.speed": "10 mph"})
    assert first.section is again.section
    assert first.section != study.section
    other = tf.study("nasa-22x5.5-8pr", WORN | {"mesh.size": "6 mm"})
    assert other.section is first.section
    for number in range(50):
        study.replace({"effects": [{"name": "worn-tread", "fraction": 0.1 + number / 100}]})
    assert len(study_parts._WORN) == study_parts._WORN.size


def test_sections_that_are_equal_have_one_hash(study: tf.Study) -> None:
    other = tf.study("nasa-22x5.5-8pr").section
    assert other is not study.section
    assert (other, hash(other)) == (study.section, hash(study.section))
    assert other != other.worn("tread", 0.1)


def test_threads_that_build_different_studies_get_their_own(study: tf.Study) -> None:
    fractions = [0.1 + (number % 10) / 20 for number in range(40)]

    def built(fraction: float) -> tuple[float, float]:
        effects = [{"name": "worn-tread", "fraction": fraction}]
        changed = study.replace({"effects": effects, "drive.speed": f"{100 * fraction} mph"})
        thickness = changed.section.thickness("tread", 0.0) / changed.new_section.thickness("tread", 0.0)
        return float(thickness), changed.card.drive.phases[0].speed.start

    study_parts._WORN.clear()
    with ThreadPoolExecutor(4) as pool:
        answers = list(pool.map(built, fractions))
    for fraction, (thickness, speed) in zip(fractions, answers, strict=True):
        assert thickness == pytest.approx(1 - fraction)
        assert speed == pytest.approx(100 * fraction * 0.44704)
