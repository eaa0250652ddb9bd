"""A hidden hot road: named, added, and the gap shrinks on a run that no fit has seen."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hidden import FINISHED, HELD_OUT, NOISE, RUNS, WARMER, Case

import tyrefem as tf
from tyrefem.cli import main
from tyrefem.diagnose.forward.evaluations import ProgressStore, key_of
from tyrefem.diagnose.forward.forward_model import ForwardModel
from tyrefem.diagnose.unknowns.unknown import base_unknowns, sensor_unknowns, with_values
from tyrefem.diagnose.words.sentences import verdict_words
from tyrefem.measured import MeasuredRun
from tyrefem.variants.answer_store import PROGRESS


def test_the_hidden_effect_is_named_with_its_size(case: Case) -> None:
    d = case.diagnosis
    assert d.verdict == "identified"
    assert [item.name for item in d.best.members] == ["hot-road"]
    amplitude = d.best.members[0].amplitudes[0]
    assert abs(d.best.values[amplitude] - WARMER) < 4 * d.best.sd[amplitude]
    assert d.best.sd[amplitude] < 0.4 * WARMER


def test_the_gap_shrinks_to_the_noise_on_the_run_no_fit_has_seen(case: Case) -> None:
    d = case.diagnosis
    before, after = (d.rms(after=after, held_out=True) for after in (False, True))
    assert before > 3 * after
    assert after < 1.2 * NOISE
    assert d.rms(after=True, held_out=False) == pytest.approx(NOISE, rel=0.15)


def test_verdict_json_says_what_the_diagnosis_found(case: Case) -> None:
    record = json.loads((case.folder / "verdict.json").read_text(encoding="utf-8"))
    d = case.diagnosis
    assert record["verdict"] == "identified"
    (effect,) = record["effects"]
    assert effect["name"] == "hot-road"
    assert 0.9 < effect["probability"] <= 1.0
    amplitude = d.best.members[0].amplitudes[0]
    assert effect["parameters"] == {
        "warmer_by": {"value": d.best.values[amplitude], "sd": d.best.sd[amplitude], "unit": "delta_degC"}
    }
    assert record["candidates"][0]["name"] == "hot-road"
    assert len(record["candidates"]) == len(d.candidates)
    for row in record["candidates"]:
        assert {"name", "variant", "probability", "log_evidence", "confounded_with"} <= set(row)
    # Evidence is a likelihood of the same data: the true effect beats no effect by far, and every rival alone.
    gains = [row["log_evidence_gain"] for row in record["candidates"]]
    assert gains[0] > 40
    assert gains[0] == max(gains)
    assert record["candidates"][0]["rms_K"] < 1.2 * NOISE
    for state, after in (("before", False), ("after", True)):
        assert record["gap"][state]["rms_K"] == pytest.approx(d.rms(after=after, held_out=False))
        assert record["gap"][state]["held_out_rms_K"] == pytest.approx(d.rms(after=after, held_out=True))
    assert record["gap"]["noise_K"] == pytest.approx(NOISE)
    # The road heats the tread: the sensor next to it is where the study fails most.
    assert record["where"]["sensor"] == "crown-outer"
    assert record["where"]["region"] == "tread"
    assert record["where"]["phase"] in ("heating", "plateau", "cooling")
    assert record["where"]["run"] in RUNS
    assert record["next_experiment"] == {}
    assert record["missing_heat"] is None
    assert record["versions"]["tyrefem"] == tf.__version__
    assert record["input"]["drive"]["speed"] == "20 mph"
    assert {run["run"]: run["hold_out"] for run in record["runs"]} == {name: name == HELD_OUT for name in RUNS}
    assert sum(row["probability"] for row in record["sets"]) == pytest.approx(1.0, abs=1e-6)


def test_the_amended_study_runs_as_it_is_and_gives_what_was_shown(case: Case) -> None:
    record = json.loads((case.folder / "verdict.json").read_text(encoding="utf-8"))
    amended = tf.study(case.folder / record["amended_study"])
    assert amended.effects[0].name == "hot-road"
    assert amended.title.endswith("(amended)")
    entry = amended.data["effects"][0]
    assert "slow, loaded" in entry["from"]
    assert entry["sd"]["warmer_by"].endswith("delta_degC")
    readings = amended.with_drive(RUNS[HELD_OUT]).run().readings
    number = list(RUNS).index(HELD_OUT)
    trial = case.diagnosis.gap.runs[number]
    computed = np.concatenate(
        [sensor_series.sampled(readings["time_s"], readings[sensor_series.sensor]) for sensor_series in trial.sensors]
    )
    np.testing.assert_allclose(computed, case.diagnosis.after[number], atol=1e-9)
    table = pd.read_csv(case.folder / "histories.csv").query("run == @HELD_OUT")
    np.testing.assert_allclose(table["amended_degC"], computed, atol=1e-9)


def test_the_difference_is_readable_and_only_what_was_found(case: Case) -> None:
    lines = (case.folder / "difference.txt").read_text(encoding="utf-8").splitlines()
    added = [line[1:] for line in lines[2:] if line.startswith("+")]
    removed = [line[1:] for line in lines[2:] if line.startswith("-")]
    assert any(line.startswith("warmer_by = ") for line in added)
    changed = {unknown.unknown.key for unknown in case.diagnosis.changes}
    # Every line that goes is the title, or a number (or the card of one) that was corrected.
    for line in removed:
        name = line.split(" = ")[0]
        assert name == "title" or any(name in key.split(".") for key in changed), line
    numbers = [line.split(" = ")[1].strip('"').split()[0] for line in added if line.startswith(("value = ", "load = "))]
    assert numbers
    assert all(len(number.lstrip("-0.").replace(".", "")) <= 6 for number in numbers)


def test_tables_of_before_and_after(case: Case) -> None:
    where = pd.read_csv(case.folder / "where.csv")
    assert set(where["run"]) == set(RUNS)
    assert where.loc[where["hold_out"], "run"].unique().tolist() == [HELD_OUT]
    worst = where["mean_K"].abs().idxmax()
    assert abs(where.loc[worst, "mean_after_K"]) < 0.1 * abs(where.loc[worst, "mean_K"])
    histories = pd.read_csv(case.folder / "histories.csv")
    deviation = histories["measured_degC"] - histories["original_degC"]
    part = where[(where["run"] == "slow") & (where["sensor"] == "crown-outer")]
    mine = (histories["run"] == "slow") & (histories["sensor"] == "crown-outer")
    weights = histories["readings"]
    mean = np.average(deviation[mine], weights=weights[mine])
    assert np.average(part["mean_K"], weights=part["n"]) == pytest.approx(mean, abs=1e-9)


def test_the_page_needs_nothing_else_and_begins_with_the_verdict(case: Case) -> None:
    text = (case.folder / "diagnosis.html").read_text(encoding="utf-8")
    for outside in ("http://", "https://", "<script ", "<link"):
        assert outside not in text
    pictures = sorted(file.name for file in case.folder.glob("*.png"))
    assert pictures == sorted(
        ["gap.png", "rms.png", "residual-map.png", "probabilities.png", *(f"histories-{run}.png" for run in RUNS)]
    )
    assert text.count('src="data:image/png;base64,') == len(pictures)
    first = text.index("The road is warmer than stated")
    assert first < text.index("<img") < text.index("<h2>Where</h2>")
    assert all(run in text for run in RUNS)


def test_an_interrupted_diagnosis_takes_up_what_was_finished(case: Case) -> None:
    assert case.first == [0, 1]
    assert case.second == [2], "the second look has the sensitivities of the first"
    assert case.resumed == FINISHED, "sensitivities of two drives; the full runs come behind all of them"
    assert not case.folder.with_name("progress").exists()


def test_kept_simulations_belong_to_one_study_and_its_data(case: Case) -> None:
    drives = case.diagnosis.gap.sensitivities.drives
    model = ForwardModel(case.study, drives)
    other = ForwardModel(case.study.replace({"drive.speed": "21 mph"}), drives)
    fewer = ForwardModel(case.study, drives[:2])
    assert len({key_of(item) for item in (model, other, fewer)}) == 3
    assert key_of(model) == key_of(ForwardModel(tf.study(case.study.file), drives))
    store = ProgressStore(case.kept.with_name("copied"))
    (store.folder / "of-the-user").mkdir(parents=True)
    assert store.open(other) == 0
    store.keep("predict", (0, {}), np.zeros(3))
    assert store.open(model) == 0
    assert [place.name for place in store.folder.iterdir()] == ["of-the-user"]
    answer = np.array([1.0, 1 / 3, np.nan])
    store.keep("predict", (0, {}), answer)
    np.testing.assert_array_equal(store.known("predict", (0, {})), answer)
    assert store.known("predict", (1, {})) is None
    next(store.folder.rglob("*.npz")).write_bytes(b"half a file")
    assert store.known("predict", (0, {})) is None


def test_the_command_goes_on_where_it_was_and_says_so(
    case: Case, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    shutil.copytree(case.kept, out / ".progress")
    shutil.copytree(case.kept.with_name("kept-2"), out / ".progress-2")
    mark = {"command": "diagnose", "complete": False, "writing": [f"{PROGRESS}*/*/*.npz"]}
    (out / "summary.json").write_text(json.dumps(mark), encoding="utf-8")
    flags = ["--workers", "1", "--largest", "1", "--looks", "2"]
    assert main(["diagnose", str(case.study.file), "--out", str(out), *flags]) == 0
    printed, err = capfd.readouterr()
    # A busy machine says how far it is.
    assert [line for line in err.splitlines() if " after " not in line] == []
    assert printed.startswith(
        f"{len(list(case.kept.rglob('*.npz')))} simulations of an interrupted diagnosis were reused"
    )
    assert "IDENTIFIED: The road is warmer than stated" in printed
    assert str(out / "diagnosis.html") in printed
    # Nothing hidden is left: neither what was kept, nor a temporary file.
    assert not [file for file in out.rglob("*") if file.name.startswith(".")]
    ours, theirs = (json.loads((folder / "verdict.json").read_text()) for folder in (out, case.folder))
    for item in (ours, theirs):
        item.pop("wall_time_s")
    assert ours == theirs


def test_a_second_look_at_the_amended_study_finds_no_gap(case: Case) -> None:
    d = case.diagnosis
    assert d.again is not None
    assert d.again.verdict == "no gap"
    assert d.again.original is d.study
    # Its readings are those of the amended study, its sensitivities those of the first look.
    first, second = d.gap.responses[0], d.again.gap.responses[0]
    sensor = next(iter(second.slopes))
    assert np.abs(second.readings[sensor] - first.readings[sensor]).max() > 1.0
    columns = [[unknown.key for unknown in first.unknowns].index(unknown.key) for unknown in second.unknowns]
    np.testing.assert_allclose(second.slopes[sensor], first.slopes[sensor][:, columns], rtol=0, atol=1e-9)
    assert d.to_dict()["again"] == [
        {"verdict": "no gap", "effects": [], "reasons": list(d.again.judgement.reasons), "folder": None}
    ]
    assert verdict_words(d)[-1].endswith("no gap is left.")
    # What is known of the effect now belongs to the base numbers: from its value, with its standard deviation.
    expected = next(unknown for unknown in base_unknowns(d.study) if unknown.effect == "hot-road")
    amplitude = d.best.members[0].amplitudes[0]
    assert expected.value(0.0) == pytest.approx(d.best.values[amplitude], abs=0.02 * d.best.sd[amplitude])
    assert expected.sd == pytest.approx(d.best.sd[amplitude], rel=0.06)
    unknowns = (*base_unknowns(d.study), *sensor_unknowns(d.study, set(d.study.sensors)))
    assert dict(with_values(d.study, dict.fromkeys(unknowns, 0.0)).run().readings.iloc[-1]) == pytest.approx(
        dict(d.study.run().readings.iloc[-1])
    )


def test_noise_alone_is_no_gap(case: Case) -> None:
    d, rng = case.diagnosis, np.random.default_rng(5)
    runs = []
    for number, sensor_series in enumerate(d.gap.runs):
        columns = {}
        for readings in sensor_series.sensors:
            # The study's own prediction at the times of the readings, through the means of its blocks.
            expected = np.interp(
                readings.times, readings.block_times, d.before[number][sensor_series.parts()[readings.sensor]]
            )
            columns[readings.sensor] = expected + NOISE * rng.normal(size=len(readings.times))
        runs.append(MeasuredRun(sensor_series.name, sensor_series.sensors[0].times, pd.DataFrame(columns)))
    # The same layout: the responses at hand serve.
    result = case.study.diagnose(runs, largest=1, known=d.gap.responses)
    assert result.verdict == "no gap"
    assert result.to_dict()["effects"] == []
    assert result.rms(after=False, held_out=False) == pytest.approx(NOISE, rel=0.15)


def test_python_can_start_workers_and_they_agree(case: Case) -> None:
    code = (
        "import sys; import tyrefem as tf; from tyrefem.diagnose.forward.forward_model import ForwardModel\n"
        "from tyrefem.diagnose.forward.evaluations import evaluating\n"
        "from tyrefem.compare.experiment import experiments; from tyrefem.diagnose.data.runs import measured_drive\n"
        "if __name__ == '__main__':\n"
        "    study = tf.study(sys.argv[1])\n"
        "    model = ForwardModel(study, tuple(measured_drive(one, study).sampling for one in experiments(study)))\n"
        "    with evaluating(model, 2) as evaluations:\n"
        "        here = [model.predict(i, {}) for i in (0, 1)]\n"
        "        there = evaluations.of('predict', [(0, {}), (1, {})])\n"
        "    assert all((a == b).all() for a, b in zip(here, there, strict=True))\n"
    )
    script = case.folder.parent / "workers.py"
    script.write_text(code, encoding="utf-8")
    done = subprocess.run(
        [sys.executable, str(script), str(case.study.file)], capture_output=True, text=True, timeout=300, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
