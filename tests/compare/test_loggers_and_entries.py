"""The measured runs of a comparison: which entry they follow, and what two loggers of one run recorded."""

from __future__ import annotations

import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from toy_study import Entry, Sensor, Study, measured_from

import tyrefem as tf
from tyrefem.compare import compare
from tyrefem.compare.experiment import Experiment, acting_in, driven, experiments
from tyrefem.compare.omitted import start_notes
from tyrefem.compare.sensors import check_sensors
from tyrefem.diagnose.data.runs import measured_drive
from tyrefem.errors import InputError, ResultWarning
from tyrefem.measured import MeasuredRun

pytestmark = pytest.mark.fast

TIMES = np.arange(0.0, 1201.0, 20.0)
FAST = {"speed": 2.0}


def written(folder: Path, study: Study, name: str = "run-1", **choice: object) -> Path:
    folder.mkdir(exist_ok=True)
    return measured_from(study, TIMES, name=name, **choice).write(folder / f"{name}.csv")


def of_many(folder: Path, study: Study, drives: dict[str, dict[str, float]]) -> Path:
    """One file with a run of each drive."""
    runs = [
        pd.read_csv(written(folder, study.with_drive(drive), name)).assign(run=name) for name, drive in drives.items()
    ]
    pd.concat(runs).to_csv(folder / "all.csv", index=False)
    return folder / "all.csv"


# -- two loggers of one run ----------------------------------------------------------------------------------------


def loggers(study: Study) -> list[MeasuredRun]:
    """Two loggers, each with its sensor and its times."""
    first = measured_from(study, TIMES, bias=1.0, sensors=("crown",))
    return [first, measured_from(study, TIMES[:-1] + 7.0, bias=2.0, sensors=("shoulder",))]


def test_two_loggers_of_a_run_are_one_run_with_all_sensors(study: Study) -> None:
    comparison = compare(study, loggers(study))
    rows = comparison.table[comparison.table.phase == "all"].set_index("sensor")
    assert set(rows.run) == {"run-1"}
    assert rows.bias_K.to_dict() == {"crown": pytest.approx(1.0, abs=1e-4), "shoulder": pytest.approx(2.0, abs=1e-4)}
    assert rows.n.to_dict() == {"crown": 61, "shoulder": 60}
    assert len(study.runs) == 1


def test_every_logger_keeps_its_noise(study: Study, tmp_path: Path) -> None:
    files = [written(tmp_path / name, study, sensors=(sensor,)) for name, sensor in (("a", "crown"), ("b", "shoulder"))]
    both = replace(study, measured=(Entry(files[0], run="run-1", noise=2.0), Entry(files[1], run="run-1")))
    (experiment,) = experiments(both)
    assert [experiment.noise_of(sensor, both) for sensor in ("crown", "shoulder")] == [2.0, Sensor().noise]
    assert len(experiments(replace(both, measured=(both.measured[0], Entry(files[1], drive=FAST))))) == 2
    assert len(experiments(replace(both, measured=(both.measured[0], Entry(files[1], hold_out=True))))) == 2


def test_frames_without_names_are_different_runs(study: Study) -> None:
    frames = [
        pd.DataFrame({"time [s]": TIMES, f"{sensor} [degC]": study.at(sensor, TIMES)})
        for sensor in ("crown", "shoulder")
    ]
    assert [each.origin for each in experiments(study, frames)] == ["measured", "measured (2)"]


def test_an_effect_in_a_run_acts_in_all_its_records() -> None:
    """Two records of one sensor stay apart, and are of one run."""
    study = tf.study("example-validation").replace(
        {"effects": [{"name": "hot-road", "warmer_by": "9 delta_degC", "runs": ["a"]}]}
    )
    name = next(iter(study.sensors))
    records = [MeasuredRun(run, np.array([0.0, 60.0]), pd.DataFrame({name: [25.0, 26.0]})) for run in ("a", "a", "b")]
    planned = experiments(study, records)
    assert [experiment.name for experiment in planned] == ["a", "a (2)", "b"]
    assert [acting_in(study, experiment) for experiment in planned] == [(0,), (0,), ()]
    assert [len(driven(study, experiment).card.acting_effects) for experiment in planned] == [1, 1, 0]
    assert [measured_drive(experiment, study).sampling.run for experiment in planned] == ["a", "a", "b"]


def test_a_number_gives_no_name_that_another_run_has(study: Study) -> None:
    records = [measured_from(study, TIMES, name=name) for name in ("a", "a", "a (2)")]
    assert [each.name for each in experiments(study, records)] == ["a", "a (3)", "a (2)"]


# -- entries of tables ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("spelling", ["up and down", "link"])
def test_an_entry_is_found_by_its_file_however_its_path_is_written(study: Study, tmp_path: Path, spelling: str) -> None:
    file = of_many(tmp_path, study, {"x": FAST})
    (tmp_path / "link.csv").symlink_to(file)
    (tmp_path / "sub").mkdir()
    other = {"up and down": tmp_path / "sub" / ".." / "all.csv", "link": tmp_path / "link.csv"}[spelling]
    (experiment,) = experiments(replace(study, measured=(Entry(file, drive=FAST, hold_out=True),)), other)
    assert (experiment.drive, experiment.hold_out) == (FAST, True)


def test_an_entry_without_a_run_leaves_the_runs_of_other_entries(study: Study, tmp_path: Path) -> None:
    file = of_many(tmp_path, study, {"slow": {}, "fast": FAST, "other": {}})
    entries = (Entry(file), Entry(file, run="fast", drive=FAST))
    planned = experiments(replace(study, measured=entries))
    assert {each.name: each.drive for each in planned} == {"slow": {}, "other": {}, "fast": FAST}
    assert compare(replace(study, measured=entries)).rms_K == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    ("run", "words"), [("slow", "two entries for run 'slow' of this table"), (None, "two entries for all runs of this")]
)
def test_two_entries_for_one_run_at_one_drive_are_refused(
    study: Study, tmp_path: Path, run: str | None, words: str
) -> None:
    file = of_many(tmp_path, study, {"slow": {}, "fast": FAST})
    with pytest.raises(InputError, match=rf"all.csv: measured.run: {words}"):
        experiments(replace(study, measured=(Entry(file, run=run, drive=FAST), Entry(file, run=run, drive=FAST))))
    # At two drives: which of them was it?
    both = experiments(replace(study, measured=(Entry(file, run=run), Entry(file, run=run, drive=FAST))))
    assert [each.drive for each in both if each.origin == "slow"] == [{}, FAST]


def test_a_new_file_is_read_as_the_entry_of_its_run_says(study: Study, tmp_path: Path) -> None:
    """Its columns are ignored and renamed before they are judged, run by run."""
    file = of_many(tmp_path, study, {"slow": {}, "fast": FAST})
    frame = pd.read_csv(file).rename(columns={"crown [degC]": "T1 [degC]"})
    frame["crown [degC]"], frame["gauge [mV]"] = 500.0, 3.0
    frame.to_csv(tmp_path / "new.csv", index=False)
    names = {"rename": {"T1": "crown"}, "ignore": ("crown", "gauge"), "time_offset": 1.0}
    old = tmp_path / "old.csv"
    entries = (Entry(old, run="slow", **names), Entry(old, run="fast", drive=FAST, **{**names, "time_offset": 0.0}))
    for table in (tmp_path / "new.csv", frame):
        slow, fast = experiments(replace(study, measured=entries), table)
        assert (slow.run.times[0], fast.run.times[0], fast.drive) == (1.0, 0.0, FAST)
        assert fast.run.temperatures["crown"].max() < 200.0
    with pytest.raises(InputError, match="gauge"):
        experiments(study, tmp_path / "new.csv")


def test_a_run_at_hand_is_taken_as_its_entry_says(study: Study) -> None:
    run = measured_from(study, TIMES).renamed({"crown": "T1"})
    run = replace(run, temperatures=run.temperatures.assign(crown=500.0))
    entry = Entry(Path("old.csv"), run="run-1", rename={"T1": "crown"}, ignore=("crown",))
    comparison = compare(replace(study, measured=(entry,)), run)
    assert comparison.rms_K == pytest.approx(0.0, abs=1e-9)


def test_files_of_one_name_in_two_folders_are_said_to_be_one_run(study: Study, tmp_path: Path) -> None:
    """Two folders may be two loggers of a run, or two days."""
    files = []
    for day, sensor in (("day-1", "crown"), ("day-2", "shoulder")):
        (tmp_path / day).mkdir()
        files.append(tmp_path / day / "log.csv")
        pd.DataFrame({"time [s]": TIMES, f"{sensor} [degC]": study.at(sensor, TIMES)}).to_csv(files[-1], index=False)
    of_entries = replace(study, measured=tuple(Entry(file) for file in files))
    for given in ((of_entries,), (study, files)):
        with pytest.warns(ResultWarning, match=r"day-1/log.csv and .*day-2/log.csv are taken as one run 'log'"):
            (both,) = experiments(*given)
        assert set(both.run.sensors) == {"crown", "shoulder"}
    # Nothing is said where the entries name the run, where the drives differ, or of one file at two drives.
    named = tuple(Entry(file, run="log") for file in files)
    apart = (Entry(files[0]), Entry(files[1], drive=FAST))
    twice = (Entry(files[0]), Entry(files[0], drive=FAST))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        counts = [len(experiments(replace(study, measured=entries))) for entries in (named, apart, twice)]
    assert counts == [1, 2, 2]


def of_tyre(first: float, sensors: tuple[str, ...] = ("crown-inner", "bead-middle", "tread-outer")) -> MeasuredRun:
    """A run of 60 s whose sensors read ``first`` + 0.1 K/s at 5, 25 and 45 s; the first sensor begins late."""
    times = np.array([5.0, 25.0, 45.0])
    frame = pd.DataFrame(dict.fromkeys(sensors, first + 0.1 * times))
    frame.iloc[0, 0] = np.nan
    return MeasuredRun("A", times, frame)


@pytest.mark.parametrize(
    ("first", "drive", "noted"), [(55.0, {}, True), (25.0, {}, False), (55.0, {"initial": "55 degC"}, False)]
)
def test_a_tyre_that_was_warm_at_the_start_is_noted(first: float, drive: dict[str, str], noted: bool) -> None:
    """Else its 30 K too many look like an effect; with the run's own ``initial`` there is nothing to note."""
    notes = start_notes(tf.study("hidden-effect"), [Experiment(of_tyre(first), "A", drive)])
    assert len(notes) == noted
    for note in notes:
        assert "run 'A' begins at 56 degC (median of 2 sensors" in note
        assert "its drive at 25 degC" in note


def test_a_rim_that_is_not_computed_is_refused_before_anything_is_simulated() -> None:
    study = tf.study("hidden-effect")
    rim = of_tyre(25.0, ("crown-inner", "rim"))
    with pytest.raises(InputError, match=r"column 'rim': the rim of the study has a given temperature.*lumped"):
        check_sensors([rim], study)
    lumped = {"law": "lumped", "mass": "8 kg", "cooling": "10 W/K"}
    check_sensors([rim], study.replace({"boundaries.rim": lumped}))
