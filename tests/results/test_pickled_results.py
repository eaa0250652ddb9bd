"""Results travel: to another process, or to a file and back, with all that can be asked of them."""

from __future__ import annotations

import pickle
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tyrefem as tf
from tyrefem import library

#: Feedback, effects on films and on the conductivity, radiation: all that is made of functions.
EVERYTHING = {
    "mesh.size": "12 mm",
    "drive.duration": "30 s",
    "mechanics.feedback": {},
    "effects": [{"name": "radiation"}, {"name": "wet-road", "film_gain": 1.2}],
}


def again(thing: Any) -> Any:
    return pickle.loads(pickle.dumps(thing))


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("nasa-22x5.5-8pr", EVERYTHING),
        ("nasa-brake-yaw-skid", {"mesh.size": "12 mm"}),
        ("passenger-205-55r16", {"mesh.size": "16 mm", "drive.duration": "20 s", "mechanics.motion": "linear"}),
    ],
    ids=["feedback and effects", "sliding", "finite-element strains, plies"],
)
def test_a_result_comes_back_whole(name: str, changes: dict[str, Any]) -> None:
    result = tf.study(name, changes).run()
    back = again(result)
    assert (back.readings == result.readings).all(axis=None)
    assert back.rolling_resistance == result.rolling_resistance
    assert back.heat_budget.imbalance == result.heat_budget.imbalance
    assert back.warnings == result.warnings
    sources, before = back.heat_source(-1), result.heat_source(-1)
    assert all(np.array_equal(sources[zone][1], before[zone][1]) for zone in before)
    assert back.study.replace({"output.fields": 3}).card.output.fields == 3


def test_a_result_keeps_the_cards_that_it_was_made_with(tmp_path: Path) -> None:
    """The user goes on working: a card of the study is changed, then gone."""
    (tmp_path / "materials").mkdir()
    card = shutil.copyfile(library.find("material", "nasa-tread"), tmp_path / "materials" / "mine.toml")
    study = tf.study("nasa-22x5.5-8pr", {"mesh.size": "12 mm", "drive.duration": "20 s"})
    mine = tf.Study("mine", study.data | {"materials": study.data["materials"] | {"tread": "mine"}}, None, tmp_path)
    result = mine.run()
    stored = pickle.dumps(result)
    card.unlink()
    back = pickle.loads(stored)
    assert back.study.materials == result.study.materials
    assert back.rolling_resistance == result.rolling_resistance


def test_comparison_sweep_and_campaign_come_back() -> None:
    comparison = tf.study("example-validation", {"mesh.size": "12 mm"}).compare(inputs=False)
    assert again(comparison).summary == comparison.summary
    quick = tf.study("nasa-22x5.5-8pr", {"mesh.size": "12 mm", "drive.duration": "30 s"})
    design = quick.sweep({"drive.speed": ["10 mph", "20 mph"]}, tornado={"tolerances": {"drive.load": "5 %"}})
    assert again(design).words == design.words
    assert again(design).table.equals(design.table)
    campaign = tf.study("nasa-campaign").campaign()
    assert [case.name for case in again(campaign).cases] == [case.name for case in campaign.cases]


def test_a_problem_of_numbers_comes_back() -> None:
    result = tf.study("nasa-22x5.5-8pr", {"mesh.size": "12 mm", "drive.duration": "20 s"}).run()
    back = again(result.history)
    assert np.array_equal(back.at([(0.27, 0.0)]), result.history.at([(0.27, 0.0)]))
