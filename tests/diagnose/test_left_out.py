"""Candidates that the study cannot have are left out with a note; the diagnosis goes on."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
from hidden import COARSE, COARSE_MESH, FINER_MESH, HASTY, HELD_OUT, measure, study

import tyrefem as tf
from tyrefem.diagnose.forward.forward_model import ForwardModel
from tyrefem.diagnose.unknowns.candidates import Candidate, beside_rolling, catalogue_candidates, possible
from tyrefem.diagnose.unknowns.unknown import of_effect
from tyrefem.diagnose.words.discrepancy_record import confidence
from tyrefem.diagnose.words.headline import headline
from tyrefem.diagnose.words.sentences import verdict_words
from tyrefem.effects import catalogue
from tyrefem.effects.hot_road import HotRoad
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData

TWICE = replace(COARSE, looks=2)
#: What is left out does not depend on fits.
QUICK = replace(HASTY, mesh_size=COARSE_MESH)
SWAP = {"name": "swapped-channels", "sensor": "crown-outer", "other": "sidewall-outer"}


def few(looked_at: StudyData) -> tuple[Candidate, ...]:
    """Swaps and the hot road only."""
    return tuple(each for each in catalogue_candidates(looked_at) if each.name in ("swapped-channels", "hot-road"))


def written(folder: Path) -> tf.Study:
    """The study with three thermocouples on a coarse mesh, all effects allowed."""
    return study(folder, COARSE_MESH).replace({"diagnosis.exclude": []})


def test_swapped_channels_are_identified_and_looked_at_again(tmp_path: Path) -> None:
    owner = written(tmp_path / "study")
    measure(owner, [SWAP], FINER_MESH)
    tables = list((tmp_path / "study").glob("*.csv"))

    def forget(*step: object) -> None:
        """No look reads the tables again."""
        for table in tables:
            table.unlink(missing_ok=True)

    diagnosis = owner.diagnose(settings=TWICE, candidates=few, progress=forget)
    assert not any(table.exists() for table in tables)
    assert diagnosis.verdict == "identified"
    assert [member.key for member in diagnosis.best.members] == ["swapped-channels (crown-outer, sidewall-outer)"]
    assert diagnosis.again is not None, "the second look at the amended study is finished"
    assert diagnosis.again.verdict == "no gap"
    # Both sensors show it, and it has no amount.
    (support,) = diagnosis.supports.values()
    assert support.only == ""
    assert {each.name for each in support.left_out} == {*owner.sensors, "slow", "loaded"}
    assert confidence(diagnosis) > 0.95
    sentence, _, step = headline(diagnosis)
    assert sentence.startswith(
        "Two thermocouples are plugged into each other's channels (crown-outer, sidewall-outer), "
    )
    assert "effects.swapped-channels" not in " ".join(verdict_words(diagnosis))
    assert step.startswith("Check that you believe this, ")
    # The third sensor has no partner left: the second look has no swap among its candidates.
    assert {candidate.name for candidate in diagnosis.again.candidates} == {"hot-road"}


def test_a_sensor_is_in_at_most_one_swap(tmp_path: Path) -> None:
    four = written(tmp_path).replace({"sensors.bead": {"s": "5.6 in", "depth": "0.3 in"}, "effects": [SWAP]})
    swaps = [each for each in catalogue_candidates(four) if each.name == "swapped-channels"]
    assert [dict(each.choice) for each in swaps] == [{"sensor": "shoulder-inner", "other": "bead"}]


def test_a_candidate_that_the_study_cannot_have_is_left_out_with_a_note(tmp_path: Path) -> None:
    owner = written(tmp_path).replace({"effects": [SWAP]})
    choice = (("sensor", "crown-outer"), ("other", "shoulder-inner"))
    conflicting = Candidate("swapped-channels", choice, of_effect(catalogue()["swapped-channels"], choice))
    (hot_road,) = (each for each in few(owner) if each.name == "hot-road")
    kept, notes = possible(owner, (conflicting, hot_road))
    assert kept == (hot_road,)
    assert len(notes) == 1
    assert notes[0].startswith("swapped-channels (crown-outer, shoulder-inner) was left out")
    assert notes[0].endswith("'crown-outer' is swapped twice")


@pytest.mark.fast
def test_slip_beside_a_tyre_that_rolls_with_friction_is_noted() -> None:
    free = tf.study("passenger-205-55r16", {"mechanics.motion": "linear", "mesh.section": "full"})
    rolls = free.replace({"boundaries.sliding": "rolling"})
    candidates = catalogue_candidates(rolls)
    (note,) = beside_rolling(rolls, candidates)
    assert "so yaw, tread-slip, camber would stand for more slip angle, slip or camber than it states" in note
    assert beside_rolling(free, candidates) == ()
    assert beside_rolling(rolls, [each for each in candidates if each.name == "hot-road"]) == ()


def test_a_candidate_whose_tyre_cannot_be_simulated_does_not_end_the_diagnosis(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    owner = written(tmp_path / "study")
    measure(owner, [], FINER_MESH)

    def refused(*_: object) -> float:
        raise InputError("no such road")

    # As the port of an effect does whose law has no value at this drive.
    monkeypatch.setattr(HotRoad, "sink_addend", refused)
    diagnosis = owner.diagnose(settings=COARSE, candidates=few, rerun=False)
    assert diagnosis.verdict == "no gap"
    assert {candidate.name for candidate in diagnosis.candidates} == {"swapped-channels"}
    assert diagnosis.notes == ("hot-road was left out, because no tyre with it could be simulated",)
    diagnosis.save(tmp_path / "out")
    record = json.loads((tmp_path / "out" / "verdict.json").read_text(encoding="utf-8"))
    assert record["notes"] == list(diagnosis.notes)
    assert "Hot-road was left out" in (tmp_path / "out" / "diagnosis.html").read_text(encoding="utf-8")


def test_a_base_number_without_a_tyre_is_still_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    owner = written(tmp_path / "study")
    measure(owner, [], FINER_MESH)

    def refused(*_: object) -> None:
        raise InputError("no such tyre")

    monkeypatch.setattr(ForwardModel, "with_values", refused)
    with pytest.raises(InputError, match="no such tyre"):
        owner.diagnose(settings=COARSE, candidates=few, rerun=False)


def test_a_held_out_run_with_readings_at_its_start_only_tests_nothing(tmp_path: Path) -> None:
    owner = written(tmp_path / "study")
    measure(owner, [SWAP], FINER_MESH)
    table = tmp_path / "study" / f"{HELD_OUT}.csv"
    table.write_text("".join(table.read_text(encoding="utf-8").splitlines(keepends=True)[:2]), encoding="utf-8")
    diagnosis = owner.diagnose(settings=QUICK, candidates=few, rerun=False, verdict_only=True)
    assert [run.name for run in diagnosis.gap.runs] == ["slow", "loaded"]
    note = f"held-out run '{HELD_OUT}' was left out: it has readings at 0 s only, which test nothing"
    assert note in diagnosis.notes
    assert diagnosis.gap.held_out == []
