"""Measured tables in workbooks: the same readings as from CSV, sheets as runs, and what is refused."""

from __future__ import annotations

import datetime as dt
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import openpyxl
import pytest

from tyrefem.errors import InputError
from tyrefem.measured import read_table
from tyrefem.measured.cases import read_cases

HEAD = ["time [s]", "crown [degC]", "shoulder [degF]"]
ROWS = [[0, 21.5, 77], [10.25, 22, None], [20.5, 23.125, 95]]


def book(path: Path, **sheets: list[list[Any]]) -> Path:
    """A workbook with sheets of rows."""
    made = openpyxl.Workbook()
    made.remove(made.active)
    for name, rows in sheets.items():
        sheet = made.create_sheet(name)
        for row in rows:
            sheet.append(row)
    made.save(path)
    return path


def test_a_sheet_is_read_like_the_same_table_as_csv(tmp_path: Path) -> None:
    rows = [["Lab 3, drum of 1.7 m"], [], ["Time", "Crown\nbelt", "shoulder"], ["s", "°C", "degF"], *ROWS]
    (run,) = read_table(book(tmp_path / "wallops.xlsx", Data=rows))
    text = "Time [s]\tCrown belt [degC]\tshoulder [degF]\n0\t21.5\t77\n10.25\t22\t\n20.5\t23.125\t95\n"
    (tmp_path / "wallops.csv").write_text(text)
    (same,) = read_table(tmp_path / "wallops.csv")
    assert run.name == same.name == "wallops"
    np.testing.assert_array_equal(run.times, same.times)
    assert run.temperatures.equals(same.temperatures)
    assert run.temperatures["shoulder"].tolist() == pytest.approx([25.0, np.nan, 35.0], nan_ok=True)
    assert run.comments == ("Lab 3, drum of 1.7 m",)
    assert run.notes == ("units are those of line 4",)


def test_a_toa5_table_in_a_sheet_is_read(tmp_path: Path) -> None:
    head = [["TOA5", "CR1000X", "12345"], ["TIMESTAMP", "RECORD", "crown"], ["TS", "RN", "Deg C"], [None, None, "Avg"]]
    stamps = [dt.datetime(2026, 5, 1, 10, 0, second) for second in (0, 10)]
    (run,) = read_table(book(tmp_path / "log.xlsx", log=[*head, [stamps[0], 0, 25.1], [stamps[1], 1, 26.1]]))
    assert run.times.tolist() == [0.0, 10.0]
    assert run.temperatures["crown"].tolist() == [25.1, 26.1]


def test_sheets_are_runs_and_others_are_left_out_with_a_note(tmp_path: Path) -> None:
    path = book(
        tmp_path / "two.xlsx", Setup=[["tyre", "22x5.5"]], slow=[HEAD, *ROWS], fast=[HEAD[:2], [0, 30], [60, 40]]
    )
    slow, fast = read_table(path)
    assert (slow.name, fast.name) == ("slow", "fast")
    assert fast.temperatures["crown"].tolist() == [30.0, 40.0]
    assert slow.notes == fast.notes == ("sheets without a time column are left out: Setup",)
    (alone,) = read_table(book(tmp_path / "alone.xlsx", Setup=[["tyre"]], slow=[HEAD, *ROWS]))
    assert alone.name == "alone"


def test_hidden_sheets_and_empty_ones_do_not_count(tmp_path: Path) -> None:
    path = book(tmp_path / "hidden.xlsx", now=[HEAD, *ROWS], before=[HEAD, [0, 99, 99]], Sheet3=[])
    made = openpyxl.load_workbook(path)
    made["before"].sheet_state = "hidden"
    made.save(path)
    (run,) = read_table(path)
    assert run.name == "hidden"
    assert run.notes == ()


def test_renamed_and_ignored_columns_may_stand_in_one_sheet_only(tmp_path: Path) -> None:
    path = book(tmp_path / "two.xlsx", a=[["t [s]", "T1 [degC]"], [0, 20], [1, 21]], b=[HEAD, *ROWS])
    a, b = read_table(path, rename={"T1": "crown"}, ignore=["shoulder"])
    assert a.sensors == b.sensors == ("crown",)


@pytest.mark.parametrize(
    ("heading", "cells"),
    [
        ("timestamp", [dt.datetime(2024, 5, 1, 23, 59, 59), dt.datetime(2024, 5, 2, 0, 0, 4, 500_000)]),
        ("time", [dt.time(9, 59, 59), dt.time(10, 0, 4, 500_000)]),
        ("elapsed time", [dt.timedelta(hours=30), dt.timedelta(hours=30, seconds=5.5)]),
    ],
)
def test_cells_of_time_count_from_the_first_row(tmp_path: Path, heading: str, cells: list[Any]) -> None:
    rows = [[cell, 20 + place] for place, cell in enumerate(cells)]
    (run,) = read_table(book(tmp_path / "clock.xlsx", log=[[heading, "crown [degC]"], *rows]))
    start = 30 * 3600 if heading == "elapsed time" else 0
    assert run.times.tolist() == [start, start + 5.5]


def test_a_day_in_a_cell_of_hours_and_minutes_is_no_date(tmp_path: Path) -> None:
    """1.25 days as h:mm:ss, which some programs write in place of [h]:mm:ss."""
    path = book(tmp_path / "days.xlsx", log=[["elapsed time", "crown [degC]"], [0.5, 20], [1.25, 21]])
    made = openpyxl.load_workbook(path)
    for cell in ("A2", "A3"):
        made["log"][cell].number_format = "h:mm:ss"
    made.save(path)
    (run,) = read_table(path)
    assert run.times.tolist() == [43200.0, 108000.0]


def test_a_whole_day_is_a_time_and_midnight_a_timestamp(tmp_path: Path) -> None:
    """Spreadsheets hold both as a date without a clock time."""
    rows = [[place / 24, 20 + place] for place in (23, 24, 25)]
    path = book(tmp_path / "day.xlsx", log=[["elapsed time", "crown [degC]"], *rows])
    made = openpyxl.load_workbook(path)
    for cell in ("A2", "A3", "A4"):
        made["log"][cell].number_format = "h:mm:ss"
    made.save(path)
    (run,) = read_table(path)
    assert run.times.tolist() == [82800.0, 86400.0, 90000.0]
    rows = [[dt.datetime(2024, 5, 1), 20], [dt.datetime(2024, 5, 1, 0, 0, 5), 21]]
    (run,) = read_table(book(tmp_path / "midnight.xlsx", log=[["timestamp", "crown [degC]"], *rows]))
    assert run.times.tolist() == [0.0, 5.0]


def test_hours_and_minutes_have_the_seconds_that_their_format_hides(tmp_path: Path) -> None:
    rows = [["time [hh:mm]", "crown [degC]"], [dt.time(12, 30), 20], [dt.time(12, 31), 21]]
    (run,) = read_table(book(tmp_path / "clock.xlsx", log=rows))
    assert run.times.tolist() == [0.0, 60.0]


def test_date_and_time_in_two_columns(tmp_path: Path) -> None:
    day = dt.date(2024, 5, 1)
    rows = [["Date", "Time", "crown [degC]"], [day, dt.time(12, 0), 20], [day, dt.time(12, 0, 30), 21]]
    (run,) = read_table(book(tmp_path / "dated.xlsx", log=rows))
    assert run.times.tolist() == [0.0, 30.0]


def test_errors_of_formulas_are_no_readings(tmp_path: Path) -> None:
    (run,) = read_table(book(tmp_path / "errors.xlsx", log=[HEAD, [0, "#N/A", 77], [1, 20, "#DIV/0!"]]))
    assert run.temperatures["crown"].tolist() == pytest.approx([np.nan, 20.0], nan_ok=True)


def test_an_open_document_is_read(tmp_path: Path) -> None:
    cells = [["time [s]", "crown [degC]"], [0, 20.5], [60, 21.25]]
    (run,) = read_table(_open_document(tmp_path / "open.ods", [[_ods_cell(cell) for cell in row] for row in cells]))
    assert run.times.tolist() == [0.0, 60.0]
    assert run.temperatures["crown"].tolist() == [20.5, 21.25]


def test_an_open_document_has_times_of_more_than_a_day(tmp_path: Path) -> None:
    times = ("PT23H59M59S", "PT24H00M00S", "PT30H00M00.500000000S")
    cells = [f'<table:table-cell office:value-type="time" office:time-value="{time}"/>' for time in times]
    heading = [_ods_cell("elapsed time"), _ods_cell("crown [degC]")]
    rows = [heading, *([cell, _ods_cell(20.5)] for cell in cells)]
    (run,) = read_table(_open_document(tmp_path / "days.ods", rows))
    assert run.times.tolist() == [86399.0, 86400.0, 108000.5]


def test_a_number_that_is_not_finite_is_refused_with_its_place(tmp_path: Path) -> None:
    rows = [[_ods_cell("time [s]"), _ods_cell("crown [degC]")], [_ods_cell(0), _ods_cell(float("inf"))]]
    with pytest.raises(InputError, match=r"line 2, column 'crown \[degC\]': 'inf' is not finite"):
        read_table(_open_document(tmp_path / "inf.ods", rows))


def _open_document(path: Path, rows: list[list[str]]) -> Path:
    """A workbook of one sheet with rows of cells as XML."""
    text = "".join(f"<table:table-row>{''.join(row)}</table:table-row>" for row in rows)
    space = "urn:oasis:names:tc:opendocument:xmlns"
    content = (
        f'<office:document-content xmlns:office="{space}:office:1.0" xmlns:table="{space}:table:1.0" '
        f'xmlns:text="{space}:text:1.0"><office:body><office:spreadsheet><table:table table:name="log">{text}'
        "</table:table></office:spreadsheet></office:body></office:document-content>"
    )
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("mimetype", "application/vnd.oasis.opendocument.spreadsheet")
        archive.writestr("content.xml", content)
        archive.writestr("META-INF/manifest.xml", "<manifest/>")
    return path


def _ods_cell(value: str | float) -> str:
    kind = '"string"' if isinstance(value, str) else f'"float" office:value="{value}"'
    return f"<table:table-cell office:value-type={kind}><text:p>{value}</text:p></table:table-cell>"


BAD: dict[str, tuple[dict[str, list[list[Any]]], str]] = {
    "no time": ({"a": [["crown [degC]"], [20]]}, "line 1: no time column in 'crown [degC]'"),
    "no time in two": ({"a": [["x"]], "b": [["y"]]}, "none of its sheets (a, b) has a time column like 'time [s]'"),
    "cell": ({"a": [HEAD, [0, "warm", 77]]}, "line 2, column 'crown [degC]': 'warm'"),
    "cell of two": ({"a": [HEAD, *ROWS], "b": [HEAD, [0, "warm", 77]]}, "sheet 'b', line 2, column 'crown [degC]'"),
    "cell beside another sheet": ({"a": [["x"]], "b": [HEAD, [0, "warm", 77]]}, "sheet 'b', line 2, column 'crown"),
    "no unit": ({"a": [HEAD, *ROWS], "b": [["time", "crown"], [0, 20]]}, "sheet 'b', "),
    "run twice": (
        {"a": [["run", *HEAD], ["x", *ROWS[0]]], "b": [["run", *HEAD], ["x", *ROWS[0]]]},
        "run 'x' stands in two sheets, 'a' and 'b'",
    ),
    "empty": ({"a": []}, "is a workbook without a filled and visible sheet"),
}


@pytest.mark.parametrize("mistake", BAD)
def test_every_mistake_names_file_sheet_and_line(tmp_path: Path, mistake: str) -> None:
    sheets, message = BAD[mistake]
    path = book(tmp_path / "bad.xlsx", **sheets)
    with pytest.raises(InputError) as caught:
        read_table(path)
    assert message in str(caught.value)
    assert str(caught.value).startswith(f"{path}: ")


@pytest.mark.parametrize("content", [b"PK\x03\x04rest", b"\xd0\xcf\x11\xe0rest"])
def test_a_broken_workbook_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "broken.xlsx"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"workbook or archive that cannot be read .*: save the sheet as CSV"):
        read_table(path)


def test_cases_may_stand_in_a_sheet(tmp_path: Path) -> None:
    rows = [["name", "drive.speed [mph]", "note"], ["slow", 20, "as measured"], ["fast", 35.5, None]]
    path = book(tmp_path / "cases.xlsx", cases=rows)
    assert [case.changes for case in read_cases(path)] == [{"drive.speed": "20 mph"}, {"drive.speed": "35.5 mph"}]
    with pytest.raises(InputError, match=r"has several sheets \(a, b\): keep one of them"):
        read_cases(book(tmp_path / "two.xlsx", a=rows, b=rows))


def test_a_cell_far_off_the_table_is_refused_before_all_cells_to_it_are_made(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The process would end without a message where they do not fit into memory."""
    path = book(tmp_path / "far.xlsx", log=[HEAD, *ROWS])
    made = openpyxl.load_workbook(path)
    made["log"]["XFD1048576"].number_format = "0.0"  # a format takes no cell
    made.save(path)
    assert read_table(path)[0].times.tolist() == [0.0, 10.25, 20.5]
    made["log"]["A20000"] = made["log"]["XFC1"] = " "
    made.save(path)
    monkeypatch.setattr("tyrefem.estimates.memory.free_memory", lambda: 8 * 2.0**30)
    with pytest.raises(
        InputError, match=r"far\.xlsx: a sheet's last cell is in column XFC and row 20,000; .* are free; empty "
    ):
        read_table(path)


def test_an_absurd_duration_is_refused(tmp_path: Path) -> None:
    path = book(tmp_path / "long.xlsx", log=[["elapsed time", "crown [degC]"], [1e10, 20]])
    made = openpyxl.load_workbook(path)
    made["log"]["A2"].number_format = "[h]:mm:ss"
    made.save(path)
    with pytest.raises(InputError, match="cannot be read"):
        read_table(path)
