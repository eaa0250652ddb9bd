"""A result from its folder is the one of the run; a folder that is none says so."""

from __future__ import annotations

import json
import pickle
import shutil
from pathlib import Path
from typing import Any

import matplotlib.image
import numpy as np
import pandas as pd
import pytest

import tyrefem as tf
from tyrefem import library
from tyrefem.api import Record, Result
from tyrefem.errors import InputError
from tyrefem.output import jsonable
from tyrefem.output.arrays import STEP, packed_bytes, read_arrays, unpacked, write_arrays
from tyrefem.reports.run import content
from tyrefem.simulation.stored_result import FILE

#: Feedback, effects on films and on the conductivity, radiation: all that is made of functions.
EVERYTHING = {
    "mesh.size": "12 mm",
    "drive.duration": "60 s",
    "mechanics.feedback": {},
    "effects": [{"name": "radiation"}, {"name": "wet-road", "film_gain": 1.2}],
}
QUICK = {"mesh.size": "12 mm", "drive.duration": "60 s"}
LINEAR = {"mesh.size": "16 mm", "drive.duration": "20 s", "mechanics.motion": "linear"}
CASES: dict[str, tuple[str, dict[str, Any]]] = {
    "feedback and effects": ("nasa-22x5.5-8pr", EVERYTHING),
    "lumped rim, triangles, whole section": (
        "nasa-22x5.5-8pr",
        {**QUICK, "mesh.cell": "tri", "mesh.section": "full",
         "boundaries.rim": {"law": "lumped", "mass": "5 kg", "cooling": "1 W/K"}},
    ),
    "sliding": ("nasa-brake-yaw-skid", {"mesh.size": "12 mm"}),
    "finite elements, plies": ("passenger-205-55r16", LINEAR),
}  # fmt: skip


@pytest.fixture(scope="module", params=CASES)
def both(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Result, Result]:
    """The result of a run, and the one from its folder."""
    result = tf.study(*CASES[request.param]).run()
    folder = tmp_path_factory.mktemp("results")
    result.save(folder)
    back = tf.load(folder)
    assert isinstance(back, Result)
    return result, back


def near(value: Any) -> Any:
    """Plain data with numbers that may differ by the rounding of stored temperatures."""
    if isinstance(value, dict):
        return {key: near(entry) for key, entry in value.items()}
    if isinstance(value, list):
        return [near(entry) for entry in value]
    return pytest.approx(value, rel=1e-8, abs=1e-8) if isinstance(value, float) else value


def test_numbers_are_those_of_the_run(both: tuple[Result, Result]) -> None:
    result, back = both
    assert np.abs(back.history.values - result.history.values).max() <= STEP / 2
    assert (back.readings - result.readings).abs().max(axis=None) < 1e-8
    assert back.readings.attrs == result.readings.attrs
    assert back.extremes.equals(result.extremes)
    assert back.heat_budget.table.equals(result.heat_budget.table)
    assert back.feedback == result.feedback
    assert back.history.steps == result.history.steps
    assert back.warnings == result.warnings
    point = result.history.maximum.point
    assert back.at([point]) == pytest.approx(result.at([point]), abs=1e-8)
    assert jsonable(back.summary()) == near(jsonable(result.summary()))


def test_report_and_vtk_are_those_of_the_run(both: tuple[Result, Result], tmp_path: Path) -> None:
    result, back = both
    rows, shown = content(back), content(result)
    for entry in (rows, shown):
        entry.pop("written")
    assert rows == shown
    files = [run.to_vtk(tmp_path / name) for run, name in ((result, "run"), (back, "back"))]
    assert files[0].read_text(encoding="utf-8") == files[1].read_text(encoding="utf-8")
    sources, before = back.heat_source(-1), result.heat_source(-1)
    for zone, (_, power) in before.items():
        assert sources[zone][1] == pytest.approx(power, rel=1e-8)


def test_the_pictures_are_those_of_the_run(tmp_path: Path) -> None:
    result = tf.study("nasa-22x5.5-8pr", QUICK).run()
    result.save(tmp_path)
    back = tf.load(tmp_path)
    assert isinstance(back, Result)
    drawn = [run.plot(tmp_path / name) for run, name in ((result, "run"), (back, "back"))]
    assert [path.name for path in drawn[0]] == [path.name for path in drawn[1]]
    for first, second in zip(*drawn, strict=True):
        drawn_first, drawn_second = (matplotlib.image.imread(path) for path in (first, second))
        assert drawn_first.shape == drawn_second.shape
        assert float(np.abs(drawn_first - drawn_second).mean()) < 1e-3, first.name


def test_its_study_runs_again_and_it_travels_on(both: tuple[Result, Result], tmp_path: Path) -> None:
    result, back = both
    assert type(back.study) is tf.Study
    assert back.study.data == json.loads(json.dumps(result.study.data))
    shorter = back.study.replace({"output.fields": 3})
    assert shorter.card.output.fields == 3
    assert shorter.section == result.study.section
    again = pickle.loads(pickle.dumps(back))
    assert (again.readings == back.readings).all(axis=None)
    back.save(tmp_path)
    twice = tf.load(tmp_path / FILE)
    assert isinstance(twice, Result)
    assert (twice.readings == back.readings).all(axis=None)


def test_the_cards_are_those_of_the_run_though_the_files_have_gone(tmp_path: Path) -> None:
    (tmp_path / "materials").mkdir()
    card = shutil.copyfile(library.find("material", "nasa-tread"), tmp_path / "materials" / "mine.toml")
    study = tf.study("nasa-22x5.5-8pr", QUICK)
    mine = tf.Study("mine", study.data | {"materials": study.data["materials"] | {"tread": "mine"}}, None, tmp_path)
    result = mine.run()
    result.save(tmp_path / "out")
    card.unlink()
    back = tf.load(tmp_path / "out")
    assert isinstance(back, Result)
    assert back.study.materials == result.study.materials
    assert back.rolling_resistance.force == pytest.approx(result.rolling_resistance.force, rel=1e-9)


def test_a_life_of_a_loaded_result_has_its_strain_cycles_solved_again(tmp_path: Path) -> None:
    study = tf.study("nasa-22x5.5-8pr", {**QUICK, "mechanics.strain": "fem", "mechanics.motion": "linear"})
    result = study.run()
    result.save(tmp_path)
    back = tf.load(tmp_path)
    assert isinstance(back, Result)
    shortest, expected = (float(np.nanmin(run.study.life(result=run).km)) for run in (back, result))
    assert shortest == pytest.approx(expected, rel=1e-6)


def test_an_interrupted_run_is_loaded_as_such(tmp_path: Path) -> None:
    def stop(time: float) -> None:
        if time > 30:
            raise KeyboardInterrupt

    result = tf.study("nasa-22x5.5-8pr", QUICK).run(stop, partial=True)
    result.save(tmp_path)
    back = tf.load(tmp_path)
    assert isinstance(back, Result)
    assert back.history.interrupted
    assert back.times[-1] == result.times[-1] < 60


# -- folders that are no result ----------------------------------------------------------------------------------------


def saved(folder: Path) -> Path:
    tf.study("nasa-22x5.5-8pr", {"mesh.size": "20 mm", "drive.duration": "10 s"}).run().save(folder)
    return folder


def test_a_missing_folder_names_the_nearest(tmp_path: Path) -> None:
    (tmp_path / "nasa-fast").mkdir()
    with pytest.raises(InputError, match="no such folder of results; did you mean 'nasa-fast'"):
        tf.load(tmp_path / "nasa-fsat")


def test_a_folder_without_results_says_what_makes_one(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(InputError, match=r"neither result\.npz nor summary\.json; 'tyrefem run STUDY --out"):
        tf.load(tmp_path)
    (tmp_path / "summary.json").write_text('{"mine": 1}')
    with pytest.raises(InputError, match=r"its summary\.json names no command"):
        tf.load(tmp_path)
    (tmp_path / "summary.json").write_text("{")
    with pytest.raises(InputError, match=r"summary\.json: is damaged"):
        tf.load(tmp_path)
    (tmp_path / "summary.json").write_text('{"command": "run"}')
    with pytest.raises(InputError, match=r"has no result\.npz: an older version"):
        tf.load(tmp_path)


def test_a_result_of_another_format_names_both_versions(tmp_path: Path) -> None:
    file = saved(tmp_path) / FILE
    data, arrays = read_arrays(file)
    write_arrays(file, data | {"format": 99, "version": "9.0.0"}, arrays, {})
    with pytest.raises(InputError, match=r"result\.npz: has the format 99, written by tyrefem 9\.0\.0"):
        tf.load(tmp_path)


def damage_bytes(file: Path) -> None:
    content = file.read_bytes()
    file.write_bytes(content[: len(content) // 2])


def damage_text(file: Path) -> None:
    file.write_text("not arrays")


def damage_nodes(file: Path) -> None:
    data, arrays = read_arrays(file)
    arrays["temperatures"] = arrays["temperatures"][:, :-1]
    write_arrays(file, data, arrays, {})


def damage_names(file: Path) -> None:
    data, arrays = read_arrays(file)
    del arrays["mesh-cells"]
    write_arrays(file, data, arrays, {})


@pytest.mark.parametrize("damage", [damage_bytes, damage_text, damage_nodes, damage_names])
def test_a_damaged_file_is_a_clear_error(damage: Any, tmp_path: Path) -> None:
    file = saved(tmp_path) / FILE
    damage(file)
    with pytest.raises(InputError, match=r"damaged|do not belong"):
        tf.load(tmp_path)


def test_a_file_with_objects_is_not_opened(tmp_path: Path) -> None:
    """An array of Python objects would run code when it is read."""
    file = saved(tmp_path) / FILE
    np.savez(file, data=np.array([{"a": 1}], dtype=object))
    with pytest.raises(InputError, match="damaged"):
        tf.load(tmp_path)


# -- folders of other commands -----------------------------------------------------------------------------------------


def test_folders_of_other_commands_give_summary_tables_and_study(tmp_path: Path) -> None:
    study = tf.study("nasa-22x5.5-8pr", QUICK)
    design = study.sweep({"drive.speed": ["10 mph", "20 mph"]})
    design.save(tmp_path, pictures=False)
    summary = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    (tmp_path / "summary.json").write_text(json.dumps(summary | {"command": "sweep"}), encoding="utf-8")
    record = tf.load(tmp_path)
    assert isinstance(record, Record)
    assert record.command == "sweep"
    assert record.table("sweep")["hottest_degC"].tolist() == design.table["hottest_degC"].tolist()
    assert record.summary["study"] == study.name
    assert record.study is not None
    assert record.study.card == study.card
    assert "tables    pareto, sweep" in repr(record)
    with pytest.raises(InputError, match="no table 'sweeep'; did you mean 'sweep'"):
        record.table("sweeep")


def test_a_campaign_gives_its_study(tmp_path: Path) -> None:
    """With its table of cases, though the results lie in another folder."""
    from tyrefem.reports.campaign import run_campaign

    cases = tmp_path / "mine" / "cases.csv"
    cases.parent.mkdir()
    cases.write_text("name,drive.speed [mph]\nslow,10\n", encoding="utf-8")
    quick = tf.study("nasa-22x5.5-8pr", QUICK | {"mesh.size": "20 mm"})
    own = quick.replace({"cases": str(cases)}).save(cases.with_name("study.toml"))
    study = tf.study(str(own))
    run_campaign(study.campaign(), tmp_path / "out")
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    written(tmp_path / "out", summary=summary | {"command": "run"})
    record = tf.load(tmp_path / "out")
    assert isinstance(record, Record)
    assert record.study is not None
    assert record.study.is_campaign
    assert [case.name for case in record.study.campaign().cases] == ["slow"]
    # A campaign whose results lie beside its file keeps the file as it is.
    before = own.read_bytes()
    run_campaign(study.campaign(), own.parent)
    assert own.read_bytes() == before


def written(folder: Path, **files: Any) -> Path:
    """A folder with JSON files."""
    for name, data in files.items():
        (folder / f"{name}.json").write_text(json.dumps(data), encoding="utf-8")
    return folder


def test_the_answer_of_a_rig_is_not_its_short_summary(tmp_path: Path) -> None:
    record = tf.load(written(tmp_path, summary={"command": "rig identify", "rig": "a"}, rig={"rig": "a", "words": []}))
    assert isinstance(record, Record)
    assert record.summary == {"rig": "a", "words": []}


def test_the_calibration_belongs_to_the_answer(tmp_path: Path) -> None:
    folder = written(tmp_path, summary={"command": "isolability"}, isolability={"sets": 3})
    plain = tf.load(folder)
    assert isinstance(plain, Record)
    assert plain.summary == {"sets": 3}
    again = tf.load(written(folder, calibration={"cases": 40}))
    assert isinstance(again, Record)
    assert again.summary == {"sets": 3, "calibration": {"cases": 40}}


def test_names_in_tables_stay_as_they_were_written(tmp_path: Path) -> None:
    rows = "case,run,value,note,failure\n01,NA,1.5,,\n02,null,,,\n"
    (written(tmp_path, summary={"command": "run"}) / "campaign.csv").write_text(rows, encoding="utf-8")
    record = tf.load(tmp_path)
    assert isinstance(record, Record)
    table = record.table("campaign")
    assert list(table) == ["case", "run", "value", "note", "failure"]
    assert (table["case"].tolist(), table["run"].tolist()) == (["01", "02"], ["NA", "null"])
    assert (table["note"].tolist(), table["failure"].tolist()) == (["", ""], ["", ""])
    assert table["value"].tolist() == pytest.approx([1.5, np.nan], nan_ok=True)
    (tmp_path / "plain.csv").write_text("a\n1\n2\n", encoding="utf-8")
    assert Record(tmp_path, "run", True).table("plain")["a"].tolist() == [1, 2]


def test_the_tables_of_a_simulated_rig_are_read_below_their_remarks(tmp_path: Path) -> None:
    from tyrefem.cli import main

    assert (
        main(["rig", "simulate", "trtlab", "--every", "60 s", "--seed", "1", "--out", str(tmp_path / "rig"), "-q"]) == 0
    )
    record = tf.load(tmp_path / "rig")
    assert isinstance(record, Record)
    table = record.table("high")
    assert list(table) == ["time [s]", "outer [degC]", "inner [degC]", "interface [degC]"]
    assert table["outer [degC]"].max() > 100
    assert table["time [s]"].iloc[0] == 0


def test_a_loaded_diagnosis_names_every_effect(tmp_path: Path) -> None:
    offsets = [
        {"name": "sensor-offset", "variant": {"sensor": sensor}, "runs": None, "probability": share}
        for sensor, share in (("a", 0.97), ("b", 0.99))
    ]
    hot = {"name": "hot-road", "variant": {}, "runs": ["02"], "probability": 0.98}
    rms = {"rms_K": 1.0, "held_out_rms_K": None}
    verdict = {
        "study": "tyre", "verdict": "identified", "effects": [*offsets, hot], "reasons": [], "changes": [],
        "candidates": [], "sets": [{"effects": ["hot-road"], "probability": 0.99999}],
        "gap": {"before": rms, "after": rms, "noise_K": 0.5},
    }  # fmt: skip
    back = tf.load(written(tmp_path, verdict=verdict))
    assert isinstance(back, tf.api.DiagnosisRecord)
    assert back.named == {"sensor-offset (a)": 0.97, "sensor-offset (b)": 0.99, "hot-road in 02": 0.98}
    assert "hot-road (more than 99.99 %)" in repr(back)


def test_a_comparison_comes_back_from_its_folder(tmp_path: Path) -> None:
    coarse = {"mesh.size": "14 mm", "mesh.element": "P1", "numerics.tolerance": "1 delta_degC"}
    comparison = tf.study("example-validation", coarse).compare(inputs=False)
    comparison.save(tmp_path / "first")
    back = tf.load(tmp_path / "first")
    assert isinstance(back, tf.api.Comparison)
    assert repr(back) == repr(comparison)
    assert back.to_dict() == comparison.to_dict()
    for name, curve in comparison.curves.items():
        pd.testing.assert_frame_equal(back.curves[name], curve)
    back.save(tmp_path / "second")
    files = {file.name: file for file in (tmp_path / "first").iterdir()}
    assert {"study.toml", "summary.json"} < files.keys()
    files.pop("summary.json")  # it names the folder that the study was read from
    for file in files.values():
        assert (tmp_path / "second" / file.name).read_bytes() == file.read_bytes(), file.name
    (tmp_path / "first" / "residuals.csv").write_text("run\nslow\n")
    (tmp_path / "first" / "comparison.json").write_text("{}")
    with pytest.raises(InputError, match="damaged"):
        tf.load(tmp_path / "first")


# -- arrays in a file --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("shape", [(1, 1), (1, 7), (2, 3), (40, 5), (0, 4)])
def test_packed_numbers_come_back_to_half_a_step(shape: tuple[int, int]) -> None:
    values = np.random.default_rng(1).uniform(-273.0, 2000.0, shape)
    back = unpacked(packed_bytes(values))
    assert back.shape == shape
    assert np.abs(back - values).max(initial=0.0) <= STEP / 2
    assert (unpacked(packed_bytes(back)) == back).all()


def test_every_command_s_answer_is_its_summary() -> None:
    """A command writes its answer beside ``summary.json``; results keep theirs in tables."""
    from tyrefem.api.record import ANSWERS

    root = Path(__file__).parents[2] / "tyrefem"
    text = "".join(file.read_text(encoding="utf-8") for file in root.rglob("*.py") if file.name != "record.py")
    assert all(f'"{name}"' in text for name in ANSWERS)
