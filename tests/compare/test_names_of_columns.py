"""Columns that a study calls otherwise: renamed or ignored by hand and in `[[measured]]`, named where unknown."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from toy_study import Entry, Study, measured_from

from tyrefem.cli.common import renamed
from tyrefem.compare import compare
from tyrefem.diagnose.options import grouped
from tyrefem.errors import InputError
from tyrefem.measured import MeasuredRun, read_table

pytestmark = pytest.mark.fast

TIMES = np.arange(0.0, 1201.0, 20.0)
LOGGER = {"crown": "T1", "shoulder": "T2"}


def logged(study: Study, name: str = "run-1", **names: str) -> MeasuredRun:
    run = measured_from(study, TIMES, name=name)
    return run.renamed(names or LOGGER)


@pytest.mark.parametrize("form", ["table", "run", "runs", "entry", "entries", "entry by run name"])
def test_renamed_alike_wherever_it_is_said(study: Study, tmp_path: Path, form: str) -> None:
    file = logged(study).write(tmp_path / "run-1.csv")
    names = {"T1": "crown", "T2": "shoulder"}
    forms = {
        "table": lambda: compare(study, file, rename=names),
        "run": lambda: compare(study, logged(study), rename=names),
        "runs": lambda: compare(study, [logged(study)], rename=names),
        "entry": lambda: compare(replace(study, measured=(Entry(file, rename=names),))),
        "entries": lambda: compare(replace(study, measured=(Entry(file),)), rename=names),
        "entry by run name": lambda: compare(replace(study, measured=(Entry(file, rename=names),)), logged(study)),
    }
    comparison = forms[form]()
    assert set(comparison.table.sensor) == {"crown", "shoulder"}
    assert comparison.rms_K == pytest.approx(0.0, abs=1e-12)


def test_a_name_given_by_hand_goes_before_that_of_the_entry(study: Study, tmp_path: Path) -> None:
    file = logged(study, crown="T1", shoulder="T2").write(tmp_path / "run-1.csv")
    crossed = replace(study, measured=(Entry(file, rename={"T1": "shoulder", "T2": "crown"}),))
    assert compare(crossed).rms_K > 1.0
    assert compare(crossed, rename={"T1": "crown", "T2": "shoulder"}).rms_K == pytest.approx(0.0, abs=1e-12)


def test_a_column_of_one_table_may_be_missing_in_another(study: Study, tmp_path: Path) -> None:
    files = [logged(study, "a").write(tmp_path / "a.csv"), measured_from(study, TIMES).write(tmp_path / "b.csv")]
    both = replace(study, measured=tuple(Entry(file) for file in files))
    assert len(compare(both, rename={"T1": "crown", "T2": "shoulder"}).table.run.unique()) == 2
    with pytest.raises(InputError, match="no column 'T3' to rename; did you mean"):
        compare(both, rename={"T1": "crown", "T2": "shoulder", "T3": "bead"})
    with pytest.raises(InputError, match=r"b.csv: no column 'T1' to rename"):
        compare(replace(study, measured=(Entry(files[1], rename={"T1": "crown"}),)))


def test_what_an_entry_ignores(study: Study, tmp_path: Path) -> None:
    file = logged(study, shoulder="room").write(tmp_path / "run-1.csv")
    assert set(compare(replace(study, measured=(Entry(file, ignore=("room",)),))).table.sensor) == {"crown"}
    with pytest.raises(InputError, match="no column 'rom' to ignore; did you mean 'room'"):
        compare(replace(study, measured=(Entry(file, ignore=("rom",)),)))
    with pytest.raises(InputError, match="no column 'crwn' to ignore; did you mean 'crown'"):
        compare(study, measured_from(study, TIMES), ignore=["crwn"])


def test_all_unknown_columns_are_named_at_once(study: Study) -> None:
    runs = [logged(study, "a", crown="crwn"), logged(study, "b", crown="T9", shoulder="sholder")]
    words = (
        "columns 'crwn' (did you mean 'crown'?), 'T9', 'sholder' (did you mean 'shoulder'?) are no sensors of study "
        "'toy'; allowed: contained-air, crown, rim, shoulder; rename them, ignore them, or add them to [sensors]"
    )
    with pytest.raises(InputError, match=re.escape(words)):
        compare(study, runs)
    assert study.runs == []


def test_other_quantities_are_left_out_and_said_so(study: Study, tmp_path: Path) -> None:
    file = measured_from(study, TIMES).write(tmp_path / "run-1.csv")
    lines = file.read_text(encoding="utf-8").splitlines()
    wide = [f"{line},{'speed [km/h]' if number == 0 else '30'}" for number, line in enumerate(lines)]
    file.write_text("\n".join(wide), encoding="utf-8")
    comparison = compare(study, file)
    assert set(comparison.table.sensor) == {"crown", "shoulder"}
    assert any("left out: speed [km/h]" in note for note in comparison.notes)
    file.write_text(file.read_text(encoding="utf-8").replace("speed [km/h]", "contained-air [kPa]"), encoding="utf-8")
    with pytest.raises(InputError, match=re.escape("column 'contained-air [kPa]': a sensor's unit is degC")):
        compare(study, file)


@pytest.mark.parametrize("column", ["contained-air", "contained-air [kPa]"])
def test_a_column_that_a_run_left_out_may_be_ignored(study: Study, column: str) -> None:
    run = replace(measured_from(study, TIMES), channels=("contained-air [kPa]", "speed [km/h]"))
    comparison = compare(study, run, ignore=[column])
    assert set(comparison.table.sensor) == {"crown", "shoulder"}
    assert next(note for note in comparison.notes if "left out: " in note).endswith("left out: speed [km/h]")


def test_a_text_is_one_column_to_ignore(study: Study, tmp_path: Path) -> None:
    file = logged(study, crown="crown", shoulder="room").write(tmp_path / "run-1.csv")
    assert set(compare(study, file, ignore="room").table.sensor) == {"crown"}
    assert read_table(file, ignore="room")[0].sensors == ("crown",)


FUNCTIONS = {
    "compare": compare,
    "read_table": lambda _, file, **names: read_table(file, **names),
    "diagnose": lambda _, file, **names: grouped(names),
}


@pytest.mark.parametrize("function", FUNCTIONS)
@pytest.mark.parametrize(
    ("names", "words"),
    [
        ({"rename": "T1"}, "rename: must give columns their sensors, like {'T1': 'crown'}, not 'T1'"),
        ({"rename": ["T1"]}, "rename: must give columns their sensors"),
        ({"rename": {"T1": 3}}, "rename: must give columns their sensors"),
        ({"ignore": 3}, "ignore: must be a column's name, or a list of them, not 3"),
        ({"ignore": ["T1", None]}, "ignore: must be a column's name, or a list of them"),
    ],
)
def test_names_of_another_form_are_refused(
    study: Study, tmp_path: Path, function: str, names: dict[str, object], words: str
) -> None:
    file = logged(study).write(tmp_path / "run-1.csv")
    with pytest.raises(InputError, match=re.escape(words)):
        FUNCTIONS[function](study, file, **names)


def test_a_column_has_one_name_on_the_command_line() -> None:
    assert renamed(["T1=crown", "T1=crown", "T2=bead"]) == {"T1": "crown", "T2": "bead"}
    with pytest.raises(InputError, match="--rename: column 'T1' has two names, 'crown' and 'bead'"):
        renamed(["T1=crown", "T1=bead"])


CALLED_OTHERWISE = {"Dauer": "time", "Versuch": "run", "T1": "crown", "T2": "shoulder"}


@pytest.mark.parametrize("form", ["table", "frame", "index", "entry", "entries", "entry by run name"])
def test_a_time_and_a_run_column_are_renamed_alike(study: Study, tmp_path: Path, form: str) -> None:
    frame = logged(study).temperatures.rename(columns="{} [degC]".format)
    frame.insert(0, "Versuch", "run-1")
    frame.insert(0, "Dauer [min]", TIMES / 60.0)
    file = tmp_path / "log.csv"
    frame.to_csv(file, index=False)
    names = CALLED_OTHERWISE
    without_run = {column: name for column, name in names.items() if name != "run"}
    forms = {
        "table": lambda: compare(study, file, rename=names),
        "frame": lambda: compare(study, frame, rename=names),
        "index": lambda: compare(study, frame.set_index(["Versuch", "Dauer [min]"]), rename=names),
        "entry": lambda: compare(replace(study, measured=(Entry(file, rename=names),))),
        "entries": lambda: compare(replace(study, measured=(Entry(file, run="run-1"),)), rename=names),
        "entry by run name": lambda: compare(
            replace(study, measured=(Entry(tmp_path / "run-1.csv", rename=without_run),)),
            frame.drop(columns="Versuch").to_csv(tmp_path / "run-1.csv", index=False) or [tmp_path / "run-1.csv"],
        ),
    }
    comparison = forms[form]()
    assert set(comparison.table.run) == {"run-1"}
    assert comparison.rms_K == pytest.approx(0.0, abs=1e-12)


def test_how_a_table_was_read_is_a_note(study: Study, tmp_path: Path) -> None:
    frame = measured_from(study, TIMES).temperatures.rename(columns="{} °C".format)
    frame.insert(0, "Zeit/s", TIMES)
    frame.to_csv(tmp_path / "run-1.csv", index=False)
    words = "Note: run-1.csv: times are those of 'Zeit/s'; units without brackets: crown in degC, shoulder in degC"
    assert words in compare(study, tmp_path / "run-1.csv").notes
