"""Tables of loggers that are not in the plain form: read where they have one meaning, with a note, else refused."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from tyrefem.errors import InputError
from tyrefem.measured import MeasuredRun, read_table
from tyrefem.measured.lines import LONGEST_PREAMBLE

pytestmark = pytest.mark.fast


def table(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "logger.csv"
    path.write_text(text, encoding="utf-8")
    return path


def only(tmp_path: Path, text: str, **names: object) -> MeasuredRun:
    (run,) = read_table(table(tmp_path, text), **names)  # type: ignore[arg-type]
    return run


def refused(tmp_path: Path, text: str, **names: object) -> str:
    with pytest.raises(InputError) as caught:
        read_table(table(tmp_path, text), **names)  # type: ignore[arg-type]
    return str(caught.value)


#: Text -> notes. All are the same run: crown 25 degC at 0 s and 26.5 degC at 70.5 s.
SAME = {
    "time,crown [degC]\n0:00:00,25\n0:01:10.5,26.5\n": [
        "times in 'time' are h:mm:ss, counted from the first row of the run (0:00:00)"
    ],
    "Time [hh:mm:ss];crown [°C]\n12:30:00;25,0\n12:31:10,5;26,5\n": [
        "times in 'Time [hh:mm:ss]' are h:mm:ss, counted from the first row of the run (12:30:00)"
    ],
    "Time [hh:mm],crown [degC]\n12:30:00,25\n12:31:10.5,26.5\n": [
        "times in 'Time [hh:mm]' are h:mm:ss, counted from the first row of the run (12:30:00)"
    ],
    "Timestamp,crown [degC]\n2024-05-01,25\n2024-05-01 00:01:10.5,26.5\n": [],
    "Elapsed time (mm:ss),crown [degC]\n00:00,25\n01:10.5,26.5\n": [
        "times in 'Elapsed time (mm:ss)' are mm:ss since the start"
    ],
    "Date,Time,crown [degC]\n2024-05-01,23:59:30,25\n2024-05-02,00:00:40.5,26.5\n": [
        "times are those of 'Date' and 'Time', counted from the run's first row"
    ],
    "Datum;Uhrzeit;crown [°C]\n30.04.2024;9:59:30;25,0\n30.04.2024;10:00:40,5;26,5\n": [
        "times are those of 'Datum' and 'Uhrzeit', counted from the run's first row",
        "dates are day.month.year",
    ],
    "Timestamp,crown [degC]\n30.04.2024 9:59:30,25\n30.04.2024 10:00:40.5,26.5\n": ["dates are day.month.year"],
    "Timestamp,crown [degC]\n2024/04/30 09:59:30,25\n2024/04/30 10:00:40.5,26.5\n": [],
    "Zeit [s];crown [°C]\n0;25,0\n70,5;26,5\n": ["times are those of 'Zeit [s]'"],
    "temps [s],crown [degC]\n0,25\n70.5,26.5\n": ["times are those of 'temps [s]'"],
    "Elapsed (min),crown [degC]\n0,25\n1.175,26.5\n": ["times are those of 'Elapsed (min)'"],
    "Time/s,crown °C\n0,25\n70.5,26.5\n": ["units without brackets: crown in degC"],
    "time_s,crown_degF\n0,77\n70.5,79.7\n": ["units without brackets: crown in degF"],
    "t / min,crown deg C\n0,25\n1.175,26.5\n": ["units without brackets: crown in degC"],
    "time,crown\ns,degC\n0,25\n70.5,26.5\n": ["units are those of line 2"],
    "time,speed,crown\n(min),(km/h),(K)\n0,30,298.15\n1.175,30,299.65\n": ["units are those of line 2"],
    "Timestamp,n,crown\n,%,°C\n2024-05-01 12:00,1,25\n2024-05-01 12:01:10.5,2,26.5\n": ["units are those of line 2"],
    "Time,crown [degC]\nhh:mm:ss,degC\n0:00:00,25\n0:01:10.5,26.5\n": [
        "units are those of line 2",
        "times in 'Time [hh:mm:ss]' are h:mm:ss, counted from the first row of the run (0:00:00)",
    ],
    "Time,crown [degC]\n11:59:30 AM,25\n12:00:40.5 pm,26.5\n": [
        "times in 'Time' are h:mm:ss, counted from the first row of the run (11:59:30 AM)"
    ],
    "Timestamp,crown [degC]\n5/1/2024 9:59:30 PM,25\n5/1/2024 10:00:40.5 PM,26.5\n": [],
    "Timestamp,crown [degC]\n4/30/2024 11:59:30 PM,25\n5/1/2024 12:00:40.5 AM,26.5\n": ["dates are month/day/year"],
    "Date,Time,crown [degC]\n30/04/2024,23:59:30,25\n01/05/2024,00:00:40.5,26.5\n": [
        "times are those of 'Date' and 'Time', counted from the run's first row",
        "dates are day/month/year",
    ],
    "time [s],crown [degC]\n0,25\n10,-9999\n20,999.9\n70.5,26.5\n": [
        "no reading in 2 cells of 'crown [degC]' (-9999, 999.9)"
    ],
    "time [s],crown [degC]\n-5,OL\n0,25\n70.5,26.5\n75,open\n": ["no reading in 2 cells of 'crown [degC]' (OL, open)"],
}


@pytest.mark.parametrize("text", SAME)
def test_the_same_run_in_the_words_of_loggers(tmp_path: Path, text: str) -> None:
    run = only(tmp_path, text)
    assert run.sensors == ("crown",)
    assert list(run.notes) == SAME[text]
    readings = run.temperatures["crown"]
    assert readings.dropna().tolist() == pytest.approx([25.0, 26.5], abs=1e-9)
    assert run.times[readings.notna()].tolist() == pytest.approx([0.0, 70.5], abs=1e-9)


#: Text -> words of the error: each may mean two things, or nothing.
TWO_MEANINGS = {
    "time,crown [degC]\n12:30,25\n12:31,26\n": "'time' begins with '12:30', which may be h:mm or mm:ss; say which",
    "Date,Time,crown [degC]\n05/01/2024,12:30:00,25\n05/02/2024,12:30:00,25\n": (
        "the date in '05/01/2024 12:30:00' may be month/day/year or day/month/year; write dates like 2024-05-01"
    ),
    "Timestamp,crown [degC]\n31/31/2024 12:30:00,25\n": "'31/31/2024 12:30:00' is not a timestamp",
    "Date,time [s],crown [degC]\n2024-05-01,0,25\n": "'Date' has no unit",
    "time [s],crown [degC]\n0:00:01,25\n": "'0:00:01' is not a number",
    "time [mm:ss],crown [degC]\n0:00:01,25\n": "'0:00:01' is not a time like mm:ss",
    "time,crown [degC]\n0:00:01,25\n12,26\n": "line 3, column 'time': '12' is not a time like h:mm:ss",
    "time,crown [degC]\n0:00:01,25\n,26\n": "line 3, column 'time': the cell is empty",
    "time,crown [degC]\n0:00:61,25\n": "begins with '0:00:61'",
    "time,crown [degC]\n13:30:01 PM,25\n": "begins with '13:30:01 PM'",
    "time [s],crown C\n0,25\n": "'crown C' has no unit",
    "time min,crown [degC]\n0,25\n": "no time column",
    "time,crown\ns,mV\n0,25\n": "unknown temperature unit 'mV'",
    "time [s],crown [degC]\ns,F\n0,25\n": "line 2: column 'crown [degC]' has another unit, 'F', in a row of units",
    "time,crown\n,x\n0,25\n": "'time' has no unit",
    "time [s],crown\n": "'crown' has no unit",
    "time [s],crown [degC]\n0,25\n1,-300\n": "-300 degC is below absolute zero",
    "time [s],crown [degC]\n0,25\n1,1372\n": "1372 degC is above 900 degC",
    "Zeit [s],Temps [s],crown [degC]\n0,0,25\n": "two time columns, 1 and 2; ignore one of them",
}


@pytest.mark.parametrize("text", TWO_MEANINGS)
def test_what_may_mean_two_things_is_refused(tmp_path: Path, text: str) -> None:
    assert TWO_MEANINGS[text] in refused(tmp_path, text)


def test_an_elapsed_time_keeps_its_start(tmp_path: Path) -> None:
    text = "{},crown [degC]\n0:05:00,25\n0:05:10,26\n"
    assert only(tmp_path, text.format("elapsed time")).times.tolist() == [300.0, 310.0]
    assert only(tmp_path, text.format("time")).times.tolist() == [0.0, 10.0]
    assert only(tmp_path, text.format("time"), rename={"time": "elapsed time"}).times.tolist() == [300.0, 310.0]
    assert only(tmp_path, text.format("time"), time_offset=300.0).times.tolist() == [300.0, 310.0]


def test_every_run_counts_from_its_first_row(tmp_path: Path) -> None:
    text = "time,run,crown [degC]\n9:00:00,a,25\n9:00:02.75,a,26\n10:00:00,b,25\n"
    first, second = read_table(table(tmp_path, text))
    assert first.times.tolist() == [0.0, 2.75]
    assert second.times.tolist() == [0.0]


def test_a_clock_goes_over_midnight_where_its_step_stays(tmp_path: Path) -> None:
    text = "time,crown [degC]\n23:59:50,25\n23:59:55,26\n0:00:00,27\n0:00:05,28\n"
    run = only(tmp_path, text)
    assert run.times.tolist() == [0.0, 5.0, 10.0, 15.0]
    assert run.notes[-1] == "run 'logger' passes midnight"


@pytest.mark.parametrize(
    "times",
    [
        ["23:59:50", "23:59:55", "0:10:00"],  # Another run, or a pause.
        ["12:00:00", "12:00:05", "11:00:10"],  # A clock that is put back.
        ["23:59:50", "0:00:00"],  # No other step.
        ["25:00:00", "25:00:10", "1:00:20"],  # No clock has 25 hours.
    ],
)
def test_a_clock_that_falls_back_is_refused(tmp_path: Path, times: list[str]) -> None:
    rows = "".join(f"{time},25\n" for time in times)
    words = refused(tmp_path, f"time,crown [degC]\n{rows}")
    assert "time runs back from" in words
    assert "over midnight, give the dates, too" in words


def test_names_of_times_and_runs_are_given_by_rename(tmp_path: Path) -> None:
    text = "Bank 3\nDauer [min];Versuch;T1 [°C]\n0;a;25\n1;a;26\n0;b;30\n"
    names = {"Dauer": "time", "Versuch": "run", "T1": "crown"}
    first, second = read_table(table(tmp_path, text), rename=names)
    assert (first.name, second.name) == ("a", "b")
    assert first.times.tolist() == [0.0, 60.0]
    assert first.sensors == ("crown",)
    assert first.notes == ()
    assert "rename a time column of another name to 'time'" in refused(tmp_path, text)


def test_rename_gives_a_time_its_unit(tmp_path: Path) -> None:
    text = "Dauer,crown [degC]\n{},25\n{},26\n"
    assert only(tmp_path, text.format(0, 1), rename={"Dauer": "time [min]"}).times.tolist() == [0.0, 60.0]
    run = only(tmp_path, text.format("00:10", "75:20"), rename={"Dauer": "elapsed time [mm:ss]"})
    assert run.times.tolist() == [10.0, 4520.0]
    two = refused(tmp_path, "Dauer [s],crown [degC]\n0,25\n", rename={"Dauer": "time [min]"})
    assert "logger.csv: rename: column 'Dauer [s]' has its unit; rename it to 'time' instead of 'time [min]'" in two


def test_a_column_called_time_goes_before_other_words(tmp_path: Path) -> None:
    run = only(tmp_path, "Elapsed [s],Timestamp,crown [degC]\n7,2024-05-01T12:00:00,25\n9,2024-05-01T12:00:03,26\n")
    assert run.times.tolist() == [0.0, 3.0]
    assert run.channels == ("Elapsed [s]",)


def test_a_row_of_units_may_name_what_is_ignored(tmp_path: Path) -> None:
    run = only(tmp_path, "time,crown,switch\ns,degC,on/off\n0,25,1\n", ignore=["switch"])
    assert run.temperatures["crown"].tolist() == [25.0]


def test_a_second_logger_keeps_the_notes_of_both(tmp_path: Path) -> None:
    first = only(tmp_path, "time/s,crown °C\n0,25\n")
    second = only(tmp_path, "Zeit [s],bead [degC]\n0,25\n")
    assert first.joined(second).notes == ("units without brackets: crown in degC", "times are those of 'Zeit [s]'")


def test_lines_below_a_row_of_units_keep_their_numbers(tmp_path: Path) -> None:
    """Lines are counted as in the file, below a row of units, too."""
    words = refused(tmp_path, "# bench\ntime,crown\ns,degC\n0,25\n1,warm\n")
    assert re.search(r"line 5, column 'crown \[degC\]': 'warm' is not a number", words)


def test_a_column_of_words_may_name_the_runs(tmp_path: Path) -> None:
    text = "time [s];Versuch;crown [degC]\n0;A;25\n60;A;26\n0;B;25\n"
    assert "'Versuch' has words; if they name the runs, it needs `rename` to run" in refused(tmp_path, text)
    assert "has no unit" in refused(tmp_path, text.replace("A", "1").replace("B", "2"))


def warming(readings: dict[int, float]) -> str:
    """A table of a sensor that warms by 1 K in 20 s, with other readings at some rows."""
    rows = [f"{20 * row},{readings.get(row, 25.0 + row)}" for row in range(24)]
    return "time [s],crown [degC]\n" + "\n".join(rows) + "\n"


@pytest.mark.parametrize(
    ("readings", "note"),
    [
        pytest.param({}, [], id="warming"),
        pytest.param(dict.fromkeys(range(5, 24), 60.0), [], id="a step"),
        pytest.param({5: 25.0, 6: 24.0, 7: 23.0}, [], id="a dip of three readings"),
        pytest.param({4: 32.0}, [], id="3 K of noise"),
        pytest.param(
            {4: 62.5},
            ["1 reading of 'crown [degC]' is 33.5 K off the readings before and after (line 6): empty the cell if the "
             "logger is wrong"],
            id="one spike",
        ),
        pytest.param(
            {4: 62.5, 8: 20.0},
            ["2 readings of 'crown [degC]' are up to 33.5 K off the readings before and after (lines 6, 10): empty the "
             "cells if the logger is wrong"],
            id="two spikes",
        ),
    ],
)  # fmt: skip
def test_spikes_of_a_logger_have_a_note(tmp_path: Path, readings: dict[int, float], note: list[str]) -> None:
    assert list(only(tmp_path, warming(readings)).notes) == note


#: Heading of a TOA5 table, as Campbell Scientific's loggers write it.
TOA5 = (
    '"TOA5","CR1000X","CR1000X","12345","CR1000X.Std.04.02","CPU:tyre.CR1X","4321","Table1"\n'
    '"TIMESTAMP","RECORD","crown, inner","shoulder"\n"TS","RN","Deg C","deg F"\n"","","Smp","Avg"\n'
)


def test_a_toa5_table_has_its_units_below_its_names(tmp_path: Path) -> None:
    readings = '"2026-05-01 10:00:00",0,25.1,77\n"2026-05-01 10:00:10.5",1,26.1,"NAN"\n'
    run = only(tmp_path, TOA5 + readings)
    np.testing.assert_allclose(run.times, [0, 10.5])
    np.testing.assert_allclose(run.temperatures["crown, inner"], [25.1, 26.1])
    np.testing.assert_allclose(run.temperatures["shoulder"], [25, np.nan])
    assert (run.channels, run.comments[0][:12]) == (("RECORD [RN]",), "TOA5,CR1000X")


def test_a_toa5_table_counts_lines_as_in_its_file_and_names_an_unknown_unit(tmp_path: Path) -> None:
    assert "line 6, column 'crown, inner [Deg C]'" in refused(
        tmp_path, TOA5 + '"2026-05-01 10:00:00",0,25.1,77\n"2026-05-01 10:00:10",1,warm,78\n'
    )
    millivolts = TOA5.replace('"Deg C"', '"mV"') + '"2026-05-01 10:00:00",0,25.1,77\n'
    assert "line 2: unknown temperature unit 'mV'" in refused(tmp_path, millivolts)


def test_the_first_reading_of_a_toa5_table_without_kinds_is_kept(tmp_path: Path) -> None:
    without = TOA5.replace('"","","Smp","Avg"', '"","","",""')
    rows = '"2026-05-01 10:00:00",0,25.1,77\n"2026-05-01 10:00:10",1,26.1,77\n'
    assert only(tmp_path, without + rows).times.tolist() == [0, 10]


@pytest.mark.parametrize("delimiter", [";", "\t"])
def test_a_toa5_table_saved_again_by_a_spreadsheet_is_read(tmp_path: Path, delimiter: str) -> None:
    rows = '"2026-05-01 10:00:00",0,25.1,77\n"2026-05-01 10:00:10.5",1,26.1,\n'
    text = (TOA5 + rows).replace("crown, inner", "crown").replace(",", delimiter)
    run = only(tmp_path, text)
    assert run.times.tolist() == [0, 10.5]
    assert run.temperatures["crown"].tolist() == [25.1, 26.1]
    assert run.channels == ("RECORD [RN]",)


@pytest.mark.parametrize("kinds", ['"","","Smp","Avg"\n', '"","","",""\n', ""])
def test_a_toa5_table_without_readings_says_so(tmp_path: Path, kinds: str) -> None:
    heading = TOA5.rsplit("\n", 2)[0] + "\n"
    assert refused(tmp_path, heading + kinds).endswith("logger.csv: has a heading but no readings")


def test_numbers_with_exponents_are_no_names_of_runs(tmp_path: Path) -> None:
    words = refused(tmp_path, "time [s],crown\n0,2.50E+01\n1,2.6e1\n")
    assert "'crown' has no unit" in words
    assert "has words" not in words


def test_as_many_lines_may_precede_the_heading_as_is_said(tmp_path: Path) -> None:
    table_below = "time [s],crown [degC]\n0,25\n"
    assert len(only(tmp_path, "Bank 3\n" * LONGEST_PREAMBLE + table_below).comments) == LONGEST_PREAMBLE == 100
    assert "no time column" in refused(tmp_path, "Bank 3\n" * (LONGEST_PREAMBLE + 1) + table_below)


def test_a_sensor_may_be_called_run(tmp_path: Path) -> None:
    run = only(tmp_path, "time [s],run [degC]\n0,25\n10,26\n")
    assert run.temperatures["run"].tolist() == [25.0, 26.0]
    (again,) = read_table(run.write(tmp_path / "again.csv"))
    assert again.temperatures.equals(run.temperatures)


def _local_times(shift: int) -> str:
    """A table whose local clock is shifted by so many hours after a minute."""
    rows = [f"31.03.2024;01:59:{20 * k:02d};2{k},5" for k in range(3)]
    rows += [f"31.03.2024;{2 + shift:02d}:00:{20 * k:02d};2{k},9" for k in range(3)]
    return "Datum;Uhrzeit;crown [degC]\n" + "\n".join(rows) + "\n"


def test_a_clock_put_forward_by_an_hour_is_noted(tmp_path: Path) -> None:
    """The readings after it were compared an hour too late without a word."""
    table = tmp_path / "spring.csv"
    table.write_text(_local_times(1), encoding="utf-8")
    (run,) = read_table(table)
    assert any("lines 4 and 5 are an hour and 20 s apart, where 20 s are usual" in note for note in run.notes)
    table.write_text(_local_times(0), encoding="utf-8")
    assert not any("an hour" in note for note in read_table(table)[0].notes)
    table.write_text(_local_times(-1), encoding="utf-8")
    with pytest.raises(InputError, match=r"time runs back .*if the clock was put back there from summer time"):
        read_table(table)
