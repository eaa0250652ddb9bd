"""The table of cases: what it means, and how each mistake in it is named by its line."""

from __future__ import annotations

import re
from pathlib import Path

import openpyxl
import pytest

import tyrefem as tf
from tyrefem.errors import InputError
from tyrefem.measured.cases import read_cases

pytestmark = pytest.mark.fast


def read(folder: Path, text: str | bytes) -> dict[str, dict[str, str]]:
    path = folder / "cases.csv"
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return {case.name: case.changes for case in read_cases(path)}


def test_units_comments_quotes_and_empty_cells(tmp_path: Path) -> None:
    text = '# made by hand\n\nname, drive.load [lbf] ,section,"note"\na, 2700 ,,"a, b"\n# between\nb,,mine,\n'
    assert read(tmp_path, text) == {"a": {"drive.load": "2700 lbf"}, "b": {"section": "mine"}}


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
@pytest.mark.parametrize("ending", ["\n", "\r\n", "\r"])
def test_as_spreadsheets_write_it(tmp_path: Path, encoding: str, ending: str) -> None:
    text = ending.join(["name,drive.speed [mph]", "a,20", ""])
    assert read(tmp_path, text.encode(encoding)) == {"a": {"drive.speed": "20 mph"}}


def test_rows_without_a_filled_cell_and_quoted_comments_are_no_cases(tmp_path: Path) -> None:
    text = '"# by hand, 3 May",\nname,drive.speed [mph]\na,20\n,\n"",""\n'
    assert read(tmp_path, text) == {"a": {"drive.speed": "20 mph"}}


def test_empty_columns_at_the_end_are_none(tmp_path: Path) -> None:
    assert read(tmp_path, "name,drive.speed [mph],,\na,20,,\nb,30,,\n,,,\n") == read(
        tmp_path, "name,drive.speed [mph]\na,20\nb,30\n"
    )


@pytest.mark.parametrize("delimiter", [";", "\t"])
def test_semicolons_and_decimal_commas(tmp_path: Path, delimiter: str) -> None:
    text = "name|drive.speed [mph]|note|section\nslow|12,5|a, b|mine\nfast|35||\n".replace("|", delimiter)
    assert read(tmp_path, text) == {
        "slow": {"drive.speed": "12.5 mph", "section": "mine"},
        "fast": {"drive.speed": "35 mph"},
    }


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "is empty"),
        ("# only words\n", "needs a heading and at least one case"),
        ("name,drive.load [lbf]\n", "needs a heading and at least one case"),
        ("# x\ncase,drive.load [lbf]\na,1\n", "line 2: the heading has no column 'name'"),
        ("name,drive.load [lbf],drive.load [N]\na,1,2\n", "line 1: the heading has column 'drive.load' twice"),
        ("name,drive.load lbf]\na,1\n", "'drive.load lbf]' is not a column heading"),
        ("name,section\na,b\n\nc\n", "line 4 has 1 cells, the heading 2"),
        ("name,section\na,b,\n", "line 2 has 3 cells, the heading 2"),
        ("name,section\na,b\n../a,b\n", "line 3: '../a' is no name"),
        ("name,section\n..,b\n", "line 2: '..' is no name"),
        ("name,section\n,b\n", "line 2: '' is no name"),
        ("name,section\na,b\nc,d\na,b\n", "case 'a' stands in lines 2 and 4"),
        ("name,section\na,b\nA,d\n", "cases 'a' and 'A', lines 2 and 3, differ only in capital letters"),
        ("name,section\nAux,b\n", "line 2: 'Aux' can be no folder on Windows"),
        ("name,section\na.,b\n", "line 2: 'a.' can be no folder on Windows"),
        ('name,section\na,"b\n', "line 2: quotes do not match"),
        ("name,cases\na,b.csv\n", "line 1: column 'cases' would be a table of cases for each case"),
        ("name,section,\na,b,c\n", "line 2 has 3 cells, the heading 2"),
        (b"name\x00", "is not a text file"),
        (b"PK\x03\x04", "workbook or archive"),
    ],
)
def test_mistakes_are_named(tmp_path: Path, text: str | bytes, words: str) -> None:
    with pytest.raises(InputError) as error:
        read(tmp_path, text)
    assert words in str(error.value)
    assert "cases.csv" in str(error.value)


@pytest.mark.parametrize(
    ("cell", "words"),
    [
        ("#DIV/0!", "cell B3: #DIV/0! is the error of a formula"),
        ("=A2*2", "cell B3: a formula without its value; open and save the workbook"),
    ],
)
def test_a_formula_without_a_value_is_not_the_value_of_the_study(tmp_path: Path, cell: str, words: str) -> None:
    """An empty cell keeps the study's value: a failed formula would do so unseen."""
    book = openpyxl.Workbook()
    for row in (["name", "drive.speed [mph]"], ["a", 20], ["b", cell]):
        book.active.append(row)
    book.create_sheet("notes").append(["#REF!"])
    book["notes"].sheet_state = "hidden"
    book.save(tmp_path / "cases.xlsx")
    with pytest.raises(InputError, match=re.escape(f"cases.xlsx: {words}")):
        read_cases(tmp_path / "cases.xlsx")
    book.active["B3"] = 30
    book.save(tmp_path / "cases.xlsx")
    assert [case.changes["drive.speed"] for case in read_cases(tmp_path / "cases.xlsx")] == ["20 mph", "30 mph"]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("name,drive.sped [mph]\na,20\n", "line 2, case 'a': drive: unknown key 'sped'; did you mean 'speed'?"),
        ("name,drive.speed [mph]\na,20\nb,-3\n", "line 3, case 'b': drive.speed: '-3 mph' is out of range"),
        ("name,drive.speed [mph]\na,twenty\n", "line 2, case 'a': drive.speed: 'twenty mph' is not a quantity"),
        ("name,drive.speed\na,20\n", "line 2, case 'a': drive.speed: '20' has no unit"),
        (
            "name,drive.load [lbf],drive.deflection [mm]\na,2000,\nb,2000,25\n",
            "line 3, case 'b': drive.deflection: 'drive.load' sets it too: give one of them",
        ),
        (
            "name,section.crown_radius [in],section.parameters.crown_radius [in]\na,3.6,3.7\n",
            "line 2, case 'a': section.parameters.crown_radius: 'section.crown_radius' sets it too",
        ),
        ("name,section\na,nasa-22x5.5-9pr\n", "line 2, case 'a': section: no section named 'nasa-22x5.5-9pr'"),
    ],
)
def test_values_are_checked_before_anything_runs(folder: Path, text: str, words: str) -> None:
    (folder / "cases.csv").write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as error:
        tf.study(folder).campaign()
    assert f"cases.csv: {words}" in str(error.value)


def test_a_missing_table_and_no_table(folder: Path) -> None:
    (folder / "cases.csv").unlink()
    with pytest.raises(InputError, match=r"cases\.csv: cannot be read: No such file"):
        tf.study(folder).campaign()
    with pytest.raises(InputError, match="the study has no 'cases' table"):
        tf.study("nasa-22x5.5-8pr").campaign()
