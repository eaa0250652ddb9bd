"""A number of the drive that is stated as uncertain: every run must use it, and all its names are one number."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import pytest

import tyrefem as tf
from tyrefem import library

RUN_2, RUN_3 = 1, 2


def study(folder: Path, uncertain: dict[str, Any], **drives: dict[str, Any]) -> tf.Study:
    """The example validation with other uncertain numbers, and other drives of runs: ``run_2``, ``run_3``."""
    shutil.copytree(library.shipped() / "studies/example-validation", folder, dirs_exist_ok=True)
    base = tf.study(folder / "study.toml")
    measured = [dict(entry) for entry in base.data["measured"]]
    for place, name in ((RUN_2, "run_2"), (RUN_3, "run_3")):
        measured[place] |= {"drive": drives[name]} if name in drives else {}
    return base.replace({"uncertainty": uncertain, "measured": measured})


REFUSED = [
    (
        {"drive.load": "2 %"},
        {"run_2": {"deflection": "30 mm"}},
        ("run 'run-2'", "run-2.csv", "write 'load' in 'drive' in place of 'deflection'"),
    ),
    (
        {"drive.speed": "2 %"},
        {},
        ("run 'run-3'", "run-3.csv", "every phase of its drive sets 'speed'", "in place of 'phases.rolling.speed'"),
    ),
    (
        {"drive.phases.rolling.duration": "2 %"},
        {"run_3": {"phases": [{"name": "fast", "duration": "600 s"}]}},
        ("run 'run-3'", "no entry 'rolling'", "leave 'drive.phases.rolling.duration' out of [uncertainty]"),
    ),
]


@pytest.mark.parametrize(("uncertain", "drives", "words"), REFUSED)
@pytest.mark.parametrize("verb", ["compare", "diagnose"])
def test_a_run_without_the_number_is_named_with_its_file(
    tmp_path: Path, verb: str, uncertain: dict[str, Any], drives: dict[str, Any], words: tuple[str, ...]
) -> None:
    wrong = study(tmp_path, uncertain, **drives)
    with pytest.raises(tf.InputError) as caught:
        getattr(wrong, verb)()
    assert all(part in str(caught.value) for part in words)
    assert str(caught.value).startswith(f"{tmp_path / 'study.toml'}: uncertainty.{next(iter(uncertain))}: ")


def test_the_number_as_the_error_says_it_is_accepted(tmp_path: Path) -> None:
    from tyrefem.compare.experiment import experiments
    from tyrefem.compare.uncertain_drives import check_uncertain_drives

    right = study(tmp_path, {"drive.speed": "2 %"}, run_3={"speed": "30 mph"})
    check_uncertain_drives(right, experiments(right))


def test_a_number_that_the_study_itself_does_not_use_is_refused_at_once(tmp_path: Path) -> None:
    own = study(tmp_path, {"drive.speed": "2 %"}).replace({"drive.phases.rolling.speed": "20 mph"})
    with pytest.raises(tf.InputError, match=r"uncertainty\.drive\.speed: every phase sets 'speed': name the phase"):
        _ = own.uncertain_numbers


def test_a_phase_by_number_and_by_name_is_one_number(tmp_path: Path) -> None:
    by_number, by_name = "drive.phases.1.duration", "drive.phases.cooling.duration"
    both = study(tmp_path, {by_number: 0.02, by_name: 0.02})
    assert [number.key for number in both.uncertain_numbers if number.key.startswith("drive.")] == [by_number]
    assert both.scaled(by_name, 2.0).card.drive.end == 1800.0
    with pytest.raises(tf.InputError, match=f"is the same number as '{by_number}'; state only one"):
        _ = both.replace({"uncertainty": {by_number: 0.02, by_name: 0.03}}).uncertain_numbers
