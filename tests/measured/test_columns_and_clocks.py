"""Which columns are sensors, and times written as timestamps."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from tyrefem.errors import InputError
from tyrefem.measured import read_table

pytestmark = pytest.mark.fast

HOUR = 3600.0


def table(tmp_path: Path, text: str, encoding: str = "utf-8") -> Path:
    path = tmp_path / "table.csv"
    path.write_text(text, encoding=encoding)
    return path


def test_columns_of_other_quantities_are_no_sensors(tmp_path: Path) -> None:
    """Loggers write speed, load and pressure beside temperatures; whatever stands in those columns."""
    text = (
        "time [s],speed [km/h],crown [degC],air [kPa],load (lbf),turns [rpm],humidity [%],note [m]\n"
        "0,30,25,570,2700,120,40,a\n9,31,26,571,2700,120,40,b\n"
    )
    (run,) = read_table(table(tmp_path, text))
    assert run.sensors == ("crown",)
    assert run.channels == ("speed [km/h]", "air [kPa]", "load (lbf)", "turns [rpm]", "humidity [%]", "note [m]")


@pytest.mark.parametrize("unit", ["deg", "mV", "1", "rad"])
def test_a_unit_that_may_be_meant_as_a_temperature_is_refused(tmp_path: Path, unit: str) -> None:
    with pytest.raises(InputError, match=rf"unknown temperature unit '{unit}'.* \(column 'crown \[{unit}\]'\)"):
        read_table(table(tmp_path, f"time [s],crown [{unit}],bead [degC]\n0,25,25\n"))


def test_all_wrong_headings_are_named_at_once(tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        read_table(table(tmp_path, "time [s],crown,bead,side [mV],apex [degX]\n0,1,1,1,1\n"))
    for words in ("'crown', 'bead' have no unit", "column 'side [mV]'", "column 'apex [degX]'"):
        assert words in str(caught.value)


def test_all_columns_to_rename_that_are_not_there_are_named_at_once(tmp_path: Path) -> None:
    path = table(tmp_path, "time [s],T1 [degC],T2 [degC]\n0,1,1\n")
    wrong = "no columns 'T11' (did you mean 'T1'?), 'x' to rename; allowed: time, T1, T2"
    with pytest.raises(InputError, match=re.escape(wrong)):
        read_table(path, rename={"T11": "crown", "x": "bead"})


STAMPS = {
    "T": "2024-05-01T12:30:00,25\n2024-05-01T12:30:10.250,26\n2024-05-01T13:30:00,27\n",
    "blank": "2024-05-01 12:30:00,25\n2024-05-01 12:30:10.25,26\n2024-05-01 13:30,27\n",
    "zones": "2024-05-01T12:30:00Z,25\n2024-05-01T14:30:10.25+02:00,26\n2024-05-01T13:30:00+00:00,27\n",
}


@pytest.mark.parametrize("heading", ["time", "Timestamp", "Date/Time", "time [UTC]", "t [s]"])
@pytest.mark.parametrize("form", STAMPS)
def test_timestamps_count_from_the_first_row(tmp_path: Path, form: str, heading: str) -> None:
    path = table(tmp_path, f"{heading},crown [degC]\n{STAMPS[form]}", "utf-8-sig")
    (run,) = read_table(path)
    assert run.times.tolist() == [0.0, 10.25, HOUR]
    assert read_table(path, time_offset=-60.0)[0].times.tolist() == [-60.0, -49.75, HOUR - 60.0]


def test_timestamps_of_every_run_count_from_its_own_first_row(tmp_path: Path) -> None:
    text = (
        "time;run;crown [degC]\n2024-05-01T12:00:00,5;a;25,5\n2024-05-01T12:00:02,75;a;26\n2024-05-02T09:00:00;b;25\n"
    )
    first, second = read_table(table(tmp_path, text))
    assert first.times.tolist() == [0.0, 2.25]
    assert second.times.tolist() == [0.0]


def test_timestamps_of_years_lose_no_digits(tmp_path: Path) -> None:
    """A millisecond is told apart after 20 years."""
    text = "time,crown [degC]\n2004-01-01T00:00:00,25\n2024-01-01T00:00:00.001,25\n2024-01-01T00:00:00.002,26\n"
    (run,) = read_table(table(tmp_path, text))
    assert np.diff(run.times)[1] == pytest.approx(1e-3, rel=1e-4)


BAD = {
    "mixed": ("2024-05-01T12:30:00,25\n10,26\n", "line 3, column 'time': '10' is not a timestamp like"),
    "zones": (
        "2024-05-01T12:30:00Z,25\n2024-05-01T12:30:10,26\n",
        "line 3, column 'time': one timestamp has",
    ),
    "no such day": ("2024-05-01T12:30:00,25\n2024-05-32T12:30:10,26\n", "line 3"),
    "back": ("2024-05-01T12:30:10,25\n2024-05-01T12:30:00,26\n", "lines 2 and 3: time runs back from 0 s to -10 s"),
    "no unit": ("0,25\n10,26\n", "line 1: 'time' has no unit; write 'time [s]'"),
}


@pytest.mark.parametrize("mistake", BAD)
def test_wrong_timestamps_name_their_line(tmp_path: Path, mistake: str) -> None:
    rows, words = BAD[mistake]
    with pytest.raises(InputError, match=re.escape(words)):
        read_table(table(tmp_path, f"time,crown [degC]\n{rows}"))


def test_a_mark_before_text_that_is_not_utf_8(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    path.write_bytes(b"\xef\xbb\xbftime [s],crown [\xb0C]\n0,25\n")
    assert read_table(path)[0].sensors == ("crown",)


@pytest.mark.parametrize("stamp", ["2024-05-01 24:00:00", "2024-05-01 12:30:00 UTC", "2024-02-30 12:00"])
def test_a_first_timestamp_that_cannot_be(tmp_path: Path, stamp: str) -> None:
    file = tmp_path / "logger.csv"
    file.write_text(f"time,crown [degC]\n{stamp},25\n")
    with pytest.raises(InputError, match=r"line 2, column 'time': .* or 2024-05-01T12:30:01"):
        read_table(file)


def test_a_cell_with_a_line_break_is_named(tmp_path: Path) -> None:
    file = tmp_path / "logger.csv"
    file.write_text('time [s],"crown\n[degC]"\n0,25\n')
    with pytest.raises(InputError, match=r"line 1: quotes do not match .*; a cell must end in its line"):
        read_table(file)


def test_a_missing_table_names_the_nearest_beside_it(tmp_path: Path) -> None:
    (tmp_path / "run-1.csv").write_text("time [s],crown [degC]\n0,25\n")
    with pytest.raises(InputError, match=r"rum-1\.csv: cannot be read: .*; did you mean 'run-1\.csv'\?"):
        read_table(tmp_path / "rum-1.csv")
    with pytest.raises(InputError, match=r"cannot be read: .*directory$"):
        read_table(tmp_path / "nowhere" / "rum-1.csv")
