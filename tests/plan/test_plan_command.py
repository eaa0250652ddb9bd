"""`tyrefem plan` and `study.plan`, before a test and after a diagnosis, on a small study."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest
import tomli_w

import tyrefem as tf
from tyrefem.api.diagnosis import Diagnosis
from tyrefem.cli import main
from tyrefem.diagnose.data.sensitivities import responses, unknowns_of
from tyrefem.diagnose.forward.evaluations import Evaluations
from tyrefem.diagnose.forward.forward_model import ForwardModel
from tyrefem.diagnose.forward.sampling import DriveSampling
from tyrefem.diagnose.unknowns.candidates import catalogue_candidates
from tyrefem.effects import catalogue
from tyrefem.plan.beliefs import stored_beliefs
from tyrefem.plan.drives import candidate_drives
from tyrefem.plan.words import first_words, last_words
from tyrefem.plan.workflow import rival_of
from tyrefem.reports.plan import FILES, page

RIVALS = ("hot-road", "sun", "tread-slip")
SPEEDS = {"limits": {"drive.speed": ["10 mph", "30 mph"]}, "drives": 3, "runs_most": 2, "sensors_most": 1}


def write(folder: Path, **changes: object) -> Path:
    """A coarse study of 60 s with two sensors, three effects to choose from, and a table with a hot road."""
    data: dict[str, object] = {
        "title": "Small",
        "section": "nasa-22x5.5-8pr",
        "materials": {name: f"nasa-{name}" for name in ("carcass", "tread", "sidewall", "bead")},
        "drive": {
            "speed": "20 mph", "load": "2700 lbf", "pressure": "83 psi", "ambient": "25 degC", "duration": "60 s",
        },
        "mesh": {"size": "12 mm", "element": "P1"},
        "numerics": {"tolerance": "0.5 delta_degC"},
        "output": {"fields": 2},
        "diagnosis": {"exclude": sorted(name for name in catalogue() if name not in RIVALS)},
        "sensors": {
            "crown-outer": {"s": "0.33 in", "depth": "0.63 in"},
            "shoulder-inner": {"s": "2.00 in", "depth": "0.07 in"},
        },
        "plan": SPEEDS,
    } | changes  # fmt: skip
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "study.toml").write_text(tomli_w.dumps(data), encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def owner(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The study, and a table in which the road is 6 K warmer."""
    folder = write(tmp_path_factory.mktemp("plan") / "small")
    study = tf.study(folder)
    readings = study.replace({"effects": [{"name": "hot-road", "warmer_by": "6 delta_degC"}]}).run().readings
    times = np.arange(0.0, 60.1, 3.0)
    rng = np.random.default_rng(4)
    columns = {"time [s]": times}
    for name in study.sensors:
        columns[f"{name} [degC]"] = np.interp(times, readings["time_s"], readings[name]) + 0.5 * rng.normal(size=21)
    pd.DataFrame(columns).to_csv(folder / "table.csv", index=False)
    return folder


@pytest.fixture(scope="module")
def diagnosis(owner: Path) -> Diagnosis:
    """The diagnosis of the table."""
    return tf.study(owner).diagnose(owner / "table.csv", largest=1, looks=1)


@pytest.fixture(scope="module")
def diagnosed(diagnosis: Diagnosis, owner: Path) -> Path:
    """The folder of the diagnosis."""
    diagnosis.save(owner / "out")
    return owner / "out"


def test_the_command_writes_its_files(owner: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "plan"
    assert main(["plan", str(owner), "--out", str(out), "--workers", "1"]) == 0
    assert {path.name for path in out.iterdir()} == {*FILES, "study.toml", "summary.json"}
    words = capsys.readouterr().out
    assert words.startswith("Before any data: no effect, or one of 3 single effects")
    assert "Run 1: speed" in words
    record = json.loads((out / "plan.json").read_text(encoding="utf-8"))
    assert record["after"] is None
    few = record["steps"][-1]["expected_probability"] < 0.95
    assert ("A name needs 95 %; the true set is expected to have" in words) == few
    assert sum(entry["probability"] for entry in record["sets"]) == pytest.approx(1.0)
    table = pd.read_csv(out / "plan.csv")
    assert table["step"].tolist() == [step["step"] for step in record["steps"]]
    assert table["drive.speed"].dropna().isin(["10 mph", "20 mph", "30 mph"]).all()
    assert (table["total_gain_nats"].diff().dropna() > 0).all()
    assert table["total_cost"].iloc[-1] == pytest.approx(table["cost"].sum())
    assert "data:image/png" in (out / "plan.html").read_text(encoding="utf-8")


def test_after_a_diagnosis_its_folder_and_its_object_give_the_same_plan(
    owner: Path, diagnosed: Path, diagnosis: Diagnosis
) -> None:
    study = tf.study(owner)
    of_folder = study.plan(diagnosed)
    of_object = study.plan(diagnosis)
    assert of_folder.beliefs.verdict == diagnosis.verdict
    assert [entry.key for entry in of_folder.beliefs.sets] == [entry.key for entry in of_object.beliefs.sets]
    assert of_folder.beliefs.probabilities == pytest.approx(of_object.beliefs.probabilities)
    assert [step.kind for step in of_folder.steps] == [step.kind for step in of_object.steps]
    gains = [[step.total_gain for step in plan.steps] for plan in (of_folder, of_object)]
    assert gains[0] == pytest.approx(gains[1], rel=1e-3)
    assert of_folder.beliefs.noise.keys() == study.sensors.keys()
    assert "After the verdict" in of_folder.words[0]
    # Limits and costs are those of the study at hand.
    short = study.replace({"plan.runs_most": 1, "plan.sensors_most": 0, "plan.run_cost": 7.0}).plan(diagnosis)
    assert [(step.kind, step.cost) for step in short.steps] == [("run", 7.0)]


def test_responses_at_hand_give_the_same_plan(owner: Path) -> None:
    study = tf.study(owner).replace({"plan.sensors_most": 0})
    names = {*study.sensors, "contained-air"}
    unknowns, _ = unknowns_of(study, names, catalogue_candidates(study))
    drives = candidate_drives(study)
    samplings = tuple(DriveSampling(drive.name, dict(drive.changes), False, ()) for drive in drives)
    known = responses(Evaluations(ForwardModel(study, samplings)), unknowns)
    at_hand, simulated = study.plan(known=known), study.plan()
    assert [step.drive for step in at_hand.steps] == [step.drive for step in simulated.steps]
    gains = [[step.total_gain for step in plan.steps] for plan in (at_hand, simulated)]
    assert gains[0] == pytest.approx(gains[1], rel=1e-6)
    with pytest.raises(tf.InputError, match=r"belong to another study or to other sensors: .* is not there"):
        study.plan(known=[response.of(unknowns[:3]) for response in known])
    with pytest.raises(tf.InputError, match="ignore: is for a table of readings"):
        study.plan(ignore=["room"])


def test_a_table_is_diagnosed_first(owner: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    line = ["plan", str(owner), str(owner / "table.csv"), "--out", str(tmp_path / "plan"), "--workers", "1", "--json"]
    assert main(line) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["after"] in ("identified", "confounded", "unexplained", "no gap", "partly identified")
    assert (tmp_path / "plan/plan.csv").is_file()


def test_sets_that_are_not_shown_are_counted_with_their_probability(owner: Path) -> None:
    plan = tf.study(owner).plan()
    beliefs = plan.beliefs
    many = replace(
        beliefs, sets=tuple(replace(beliefs.sets[0], probability=1 / 67) for _ in range(67)), verdict="confounded"
    )
    shown = replace(plan, beliefs=many)
    text = page(shown, b"")
    assert text.count('<td class="word">no effect</td>') == 12
    assert '<td class="word quiet">55 more, not shown</td><td>82.1 %</td>' in text
    assert "The 12 most probable of 67 sets" in text
    assert shown.words[0].endswith("and 63 more (94 % together).")
    assert "not shown" not in page(plan, b"")


def test_the_rival_of_a_set_lacks_one_of_its_members() -> None:
    first, second, third = catalogue_candidates(tf.study("hidden-effect"))[:3]
    assert rival_of([(first,), (first, second), (), (third,)]) == 2
    assert rival_of([(first, second), (first,), (third,)]) == 1
    assert rival_of([(), (first,), (second,)]) == 1


def test_where_nothing_moves_nothing_is_proposed(tmp_path: Path) -> None:
    # A tyre that stands at ambient temperature: slip of its tread cannot be seen at any load.
    exclude = sorted(name for name in catalogue() if name != "tread-slip")
    folder = write(
        tmp_path / "standing",
        drive={"speed": "0 mph", "load": "2700 lbf", "pressure": "83 psi", "ambient": "25 degC", "duration": "60 s"},
        diagnosis={"exclude": exclude},
        plan={"limits": {"drive.load": ["2000 lbf", "3000 lbf"]}, "drives": 3, "sensors_most": 0},
    )
    plan = tf.study(folder).plan()
    assert plan.steps == ()
    assert plan.candidates["gain_nats"].tolist() == pytest.approx([0.0] * 3, abs=1e-9)
    assert "Widen the limits" in " ".join(plan.words)


def test_a_drive_that_cannot_run_is_one_error(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = write(tmp_path / "heavy", plan={"limits": {"drive.load": ["2000 lbf", "200000 lbf"]}, "drives": 3})
    assert main(["plan", str(folder), "--out", str(tmp_path / "plan"), "--workers", "1"]) == 2
    words = capsys.readouterr().err
    assert words.count("\n") == 1
    assert "heavy/study.toml: plan.limits: the drive with load" in words
    assert "state narrower limits" in words
    assert not (tmp_path / "plan").exists()


def test_a_folder_without_a_diagnosis_is_one_error(
    owner: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    empty = tmp_path / "empty"
    empty.mkdir()
    assert main(["plan", str(owner), str(empty), "--out", str(tmp_path / "plan")]) == 2
    assert "holds no posterior.json: name the output folder of 'tyrefem diagnose'" in capsys.readouterr().err
    (empty / "posterior.json").write_text('{"sets": 3}', encoding="utf-8")
    assert main(["plan", str(owner), str(empty), "--out", str(tmp_path / "plan")]) == 2
    assert "posterior.json: is damaged: diagnose again" in capsys.readouterr().err


def test_a_diagnosis_of_another_study_is_refused(
    owner: Path, diagnosed: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for changes in (["nasa-22x5.5-8pr"], [str(owner), "--set", "boundaries.road.coefficient=900 W/m**2/K"]):
        assert main(["plan", *changes, str(diagnosed), "--out", str(diagnosed.parent / "plan")]) == 2
        assert "posterior.json: belongs to another study" in capsys.readouterr().err


def test_options_of_tables_need_a_table(owner: Path, diagnosed: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for arguments in ([], [str(diagnosed)]):
        assert main(["plan", str(owner), *arguments, "--ignore", "speed"]) == 2
        assert "--ignore: is for a table of readings" in capsys.readouterr().err


def test_a_plan_that_ends_before_its_last_run_asks_for_wider_limits() -> None:
    """More runs are no advice where the plan did not use those that it may have."""
    step: Any = SimpleNamespace(total_gain=0.4, right=0.45)
    plan: Any = SimpleNamespace(beliefs=SimpleNamespace(sets=(1, 2)), steps=(step,), doubt=2.0, runs_left=0)
    assert "Allow more runs or sensors" in last_words(plan)[-1]
    plan.runs_left = 18
    assert "No further run within the limits is expected to tell more" in last_words(plan)[-1]
    assert "runs_most" not in last_words(plan)[-1]


def test_a_cause_outside_the_catalogue_alone_says_which_runs_tell_its_law(owner: Path, diagnosed: Path) -> None:
    """No sets are left to compare, but "no experiment can tell more" would be wrong."""
    copy = owner / "partly"
    copy.mkdir()
    record = json.loads((diagnosed / "posterior.json").read_text(encoding="utf-8"))
    assert record["part"] == []
    record |= {"verdict": "partly identified", "part": ["hot-road"]}
    record["sets"] = [record["sets"][0] | {"outside": True, "effects": []}]
    (copy / "posterior.json").write_text(json.dumps(record), encoding="utf-8")
    beliefs = stored_beliefs(tf.study(owner), copy)
    plan: Any = SimpleNamespace(beliefs=beliefs, steps=(), doubt=0.0, runs_left=3)
    first = "After the verdict 'partly identified', beside hot-road these sets are left: not in the catalogue"
    assert first_words(plan).startswith(first)
    (last,) = last_words(plan)
    assert "Runs at another speed, load or pressure tell its law" in last
