"""Tables as loggers write them: every dialect gives the same kelvins, every mistake names its place."""

from __future__ import annotations

import os
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tyrefem.errors import InputError
from tyrefem.measured import MeasuredRun, read_table
from tyrefem.measured.columns import COLDEST, HOTTEST
from tyrefem.measured.lines import LARGEST_BYTES

TIMES = [0.0, 60.0, 120.0]
CROWN = [25.0, 31.5, np.nan]
SHOULDER = [25.0, np.nan, 40.25]

DIALECTS = {
    "plain": "time [s],crown [degC],shoulder [degC]\n0,25,25\n60,31.5,\n120,,40.25\n",
    "minutes": "time [min],crown [degC],shoulder [degC]\n0,25,25\n1,31.5,\n2,,40.25\n",
    "hours": "Time (h),crown (C),shoulder (C)\n0,25,25\n1.6666666666666666e-2,31.5,\n3.3333333333333333e-2,,40.25\n",
    "milliseconds": "t [ms],crown [degC],shoulder [degC]\n0,25,25\n60000,31.5,\n120000,,40.25\n",
    "units": "time [s],crown [°F],shoulder [K]\n0,77,298.15\n60,88.7,\n120,,313.4\n",
    "continental": "Time [s];crown [°C];shoulder [°C]\n0,0;25,0;25\n60,0;31,5;--\n120,0;-;40,25\n",
    "tabs": "time [s]\tcrown [C]\tshoulder [Celsius]\n0\t25\t25\n60\t31.5\tNaN\n120\tnan\t40.25\n",
    "comments": "# A\n\n// B\ntime [s],crown [degC],shoulder [degC]\n# c\n0,25,25\n60,31.5,\n\n120,,40.25\n# end",
    "preamble": "Logger: X7, no 12\nAt;09:30\ntime [s],crown [degC],shoulder [degC]\n0,25,25\n60,31.5,\n120,,40.25",
    "quoted": '"time [s]","crown [degC]","shoulder [degC]"\n"0","25","25"\n"60","31,5",""\n120,,"40,25"\n',
    "trailing": "time [s],crown [degC],shoulder [degC],,\n0,25,25,,\n60,31.5,,,\n120,,40.25\n,,,,\n",
    "crlf": "time [s],crown [degC],shoulder [degC]\r\n0,25,25\r\n60,31.5,\r\n120,,40.25\r\n",
    "spaces": " time [s] , crown [ deg C ] , shoulder [degC]\n 0 , 25 , 25 \n60, 31.5, \n120, , 4.025e1\n",
    "unnamed": "time [s],,crown [degC],shoulder [degC]\n0,,25,25\n60,,31.5,\n120,,,40.25\n",
    "run first": "run,time [s],crown [degC],shoulder [degC]\ntable,0,25,25\ntable,60,31.5,\ntable,120,,40.25\n",
}


def table(tmp_path, content, name="table.csv"):
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def assert_reference(run):
    assert run.name == "table"
    np.testing.assert_allclose(run.times, TIMES, rtol=0, atol=1e-9)
    assert run.sensors == ("crown", "shoulder")
    np.testing.assert_allclose(run.temperatures["crown"], CROWN, rtol=0, atol=1e-12)
    np.testing.assert_allclose(run.temperatures["shoulder"], SHOULDER, rtol=0, atol=1e-12)


@pytest.mark.parametrize("dialect", DIALECTS)
def test_every_dialect_says_the_same(tmp_path, dialect):
    (run,) = read_table(table(tmp_path, DIALECTS[dialect]))
    assert_reference(run)


def test_dashes_of_windows_in_one_byte_are_dashes(tmp_path):
    text = DIALECTS["continental"].replace("crown", "crown \N{EN DASH} inner")
    (run,) = read_table(table(tmp_path, text.encode("cp1252")))
    assert run.sensors == ("crown \N{EN DASH} inner", "shoulder")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "latin-1", "utf-16"])
def test_encodings(tmp_path, encoding):
    text = "# Prüfstand\n" + DIALECTS["continental"]
    (run,) = read_table(table(tmp_path, text.encode(encoding)))
    assert_reference(run)
    assert run.comments == ("Prüfstand",)


def test_degree_sign_after_a_wrong_decoding(tmp_path):
    twice = DIALECTS["continental"].encode().decode("latin-1").encode()
    assert_reference(*read_table(table(tmp_path, twice)))


def test_runs_in_one_file_keep_their_own_clock_and_sensors(tmp_path):
    text = "time [s],run,crown [degC],bead [degC]\n0,slow,25,\n0,fast,26,24\n10,slow,27,\n10,fast,30,25\n"
    slow, fast = read_table(table(tmp_path, text))
    assert (slow.name, fast.name) == ("slow", "fast")
    assert slow.sensors == ("crown",)
    assert fast.temperatures["bead"].tolist() == [24.0, 25.0]
    assert slow.times.tolist() == fast.times.tolist() == [0.0, 10.0]


def test_offset_rename_ignore(tmp_path):
    text = "time [s],T1 [degC],speed [km/h],shoulder [degC]\n5,25,30,25\n6,26,31,26\n"
    (run,) = read_table(table(tmp_path, text), time_offset=-5.0, rename={"T1": "crown"}, ignore=["speed"])
    assert run.sensors == ("crown", "shoulder")
    assert run.times.tolist() == [0.0, 1.0]


def test_calendar_times_need_an_offset(tmp_path):
    path = table(tmp_path, "time [s],crown [degC]\n1700000000,25\n1700000001,26\n")
    with pytest.raises(InputError, match="time_offset"):
        read_table(path)
    (run,) = read_table(path, time_offset=-1.7e9)
    assert run.times.tolist() == [0.0, 1.0]


@given(st.lists(st.floats(COLDEST, HOTTEST), min_size=1, max_size=20))
def test_units_round_trip(tmp_path_factory, degC):
    """The same temperatures written in three units come back the same to rounding of the file."""
    values = np.array(degC)
    rows = np.column_stack([np.arange(len(values)), values, values * 1.8 + 32.0, values + 273.15])
    lines = [",".join(repr(float(value)) for value in row) for row in rows]
    text = "time [s],a [degC],b [degF],c [K]\n" + "\n".join(lines)
    path = table(tmp_path_factory.getbasetemp(), text, "units.csv")
    (run,) = read_table(path)
    assert run.temperatures["a"].tolist() == values.tolist()
    np.testing.assert_allclose(run.temperatures["b"], values, atol=1e-9)
    np.testing.assert_allclose(run.temperatures["c"], values, atol=1e-9)


def test_written_and_read_to_the_last_bit(tmp_path):
    rng = np.random.default_rng(1)
    frame = pd.DataFrame(rng.normal(60.0, 20.0, (50, 2)), columns=["crown", "bead, left"])
    frame.iloc[3, 0] = np.nan
    run = MeasuredRun("hot", np.cumsum(rng.random(50)), frame, comments=("made, up",))
    (again,) = read_table(run.write(tmp_path / "hot.csv"))
    assert again.name == "hot"
    assert again.times.tolist() == run.times.tolist()
    pd.testing.assert_frame_equal(again.temperatures, frame, check_exact=True)
    assert again.comments == run.comments


HEAD = "time [s],crown [degC],bead [degC]\n"
BAD = {
    "empty": (b"", "is empty"),
    "blank": (b"\n \n\r\n", "is empty"),
    "only comments": ("# nothing\n// more\n", "only comments"),
    "no time": ("seconds,crown [degC]\n0,25\n", "line 1: no time column"),
    "time without unit": ("time,crown [degC]\n0,25\n", "line 1: 'time' has no unit"),
    "minutes or metres": (
        "time (m),crown [degC]\n0,25\n",
        "line 1: time unit 'm': write 'min' for minutes; allowed: s,",
    ),
    "other dates": (
        "time,crown [degC]\n,1\n05/01/2024 12:30,25\n",
        "line 2, column 'time': '' is not a timestamp like 2024-05-01T12:30:01",
    ),
    "date and two numbers": ("Date,Time,crown [degC]\n2024-05-01,12:30,25\n", "which may be h:mm or mm:ss; say which"),
    "torque": (
        "time [s],torque [Nm],crown [degC]\n0,1,25\n",
        "unknown temperature unit 'Nm'; allowed: K, degC, degF (column 'torque [Nm]'); columns of other quantities "
        "need `ignore`",
    ),
    "unknown time unit": ("time [sek],crown [degC]\n0,25\n", "line 1: unknown time unit 'sek'"),
    "no sensor": ("time [s]\n0\n", "line 1: no sensor column"),
    "sensor without unit": ("# x\ntime [s],crown\n0,25\n", "line 2: 'crown' has no unit"),
    "unknown unit": (
        "time [s],crown [degCC]\n0,25\n",
        "line 1: unknown temperature unit 'degCC'; did you mean 'degC'?",
    ),
    "voltage": ("time [s],crown [mV]\n0,25\n", "unknown temperature unit 'mV'; allowed: K, degC, degF"),
    "two times": ("time [s],t [min],crown [degC]\n0,0,25\n", "line 1: two time columns, 1 and 2"),
    "two runs": ("time [s],run,Run,crown [degC]\n0,a,a,25\n", "line 1: two run columns, 2 and 3"),
    "two sensors": ("time [s],crown [degC],crown [degF]\n0,25,77\n", "line 1: two columns for sensor 'crown'"),
    "nameless": ("time [s],,crown [degC]\n0,7,25\n", "line 1: column 2 has readings but no name"),
    "no rows": (HEAD, "no readings"),
    "text": (HEAD + "0,25,25\n1,warm,25\n", "line 3, column 'crown [degC]': 'warm' is not a number"),
    "text after comment": (HEAD + "# a\n\n0,25,2x5\n", "line 4, column 'bead [degC]': '2x5' is not a number"),
    "underscore": (HEAD + "0,2_5,25\n", "line 2, column 'crown [degC]': '2_5' is not a number"),
    "clock": (HEAD + "12:30:01,25,25\n", "line 2, column 'time [s]': '12:30:01' is not a number"),
    "no time in row": (HEAD + "0,25,25\n,26,26\n", "line 3, column 'time [s]': the cell is empty"),
    "inf": (HEAD + "0,25,25\n1,inf,25\n", "line 3, column 'crown [degC]': 'inf' is not finite"),
    "overflow": (HEAD + "0,25,25\n1,1e999,25\n", "line 3, column 'crown [degC]': '1e999' is not finite"),
    "duplicate time": (HEAD + "0,25,25\n1,25,25\n1,25,25\n", "lines 3 and 4: the same time"),
    "unsorted": (HEAD + "0,25,25\n2,25,25\n1,25,25\n", "lines 3 and 4: time runs back from 2 s to 1 s"),
    "empty sensor": (HEAD + "0,25,\n1,25,-\n", "column 'bead [degC]' has no reading"),
    "too cold": (HEAD + "0,25,25\n1,25,-9998\n", "line 3, column 'bead [degC]': -9998 degC is below absolute"),
    "too cold in K": (
        "time [s],crown [K]\n0,-300\n",
        "line 2, column 'crown [K]': -573.15 degC is below absolute zero; leave the cell empty",
    ),
    "type K": (
        "time [s],crown [K]\n0,25\n1,80\n",
        "line 2, column 'crown [K]': -248.15 degC (25 K) is too cold; K is kelvin: a thermocouple of type K is written "
        "'crown [degC]'",
    ),
    "code of a cold end": (HEAD + "0,25,25\n1,-200,25\n", "line 3, column 'crown [degC]': -200 degC is below -90 degC"),
    "code of a hot end": (HEAD + "0,25,1372\n", "line 2, column 'bead [degC]': 1372 degC is above 900 degC (an open"),
    "hot in degF": ("time [s],crown [degF]\n0,2501.6\n", "line 2, column 'crown [degF]': 1372 degC is above"),
    "open thermocouple": (HEAD + "0,25,9999\n", "column 'bead [degC]' has no reading in any row"),
    "short row": (
        HEAD + "0,25,25\n1,25\n",
        "line 3: 2 cells, but the heading has 3 (a cell without a reading is empty, not left out)",
    ),
    "a heading that is none": (
        "Logger 3000\nTime\t08:12:00\nX_Value\tcrown [degC]\tbead [degC]\n0\t25\t25\n",
        "line 3: 3 cells, but the heading, line 2, has 2",
    ),
    "long row": (HEAD + "0,25,25\n1,25,25,25\n", "line 3: 4 cells, but the heading has 3"),
    "decimal commas": (HEAD + "0,25,5,25,5\n", "line 2: 5 cells, but the heading has 3 (decimal commas need"),
    "both marks": (
        "time [s];crown [degC]\n0;25,5\n1;1.025,5\n",
        "mixes decimal points (line 3) and decimal commas (line 2)",
    ),
    "mixed marks": (
        "time [s];crown [degC]\n0;25,5\n1;26.5\n",
        "mixes decimal points (line 3) and decimal commas (line 2)",
    ),
    "quote": (HEAD + '0,"25,25\n', "line 2: quotes do not match"),
    "no run name": ("time [s],run,crown [degC]\n0,a,25\n1,,26\n", "line 3: the run column is empty"),
    "silent run": ("time [s],run,crown [degC]\n0,a,25\n0,b,\n", "run 'b' has no reading at all"),
    "binary": (b"time [s],crown [degC]\n0,\x00\x01\x02\n", "not a text file (control character in line 2)"),
}


@pytest.mark.parametrize("mistake", BAD)
def test_every_mistake_names_file_and_place(tmp_path, mistake):
    content, message = BAD[mistake]
    path = table(tmp_path, content)
    with pytest.raises(InputError, match=re.escape(message)) as caught:
        read_table(path)
    assert str(caught.value).startswith(str(path))
    assert len(str(caught.value)) < 400


def test_no_such_file_and_a_folder(tmp_path):
    with pytest.raises(InputError, match="No such file"):
        read_table(tmp_path / "missing.csv")
    with pytest.raises(InputError, match="cannot be read"):
        read_table(tmp_path)


def test_too_large_is_refused_before_it_is_read(tmp_path):
    path = table(tmp_path, DIALECTS["plain"])
    # The file system keeps no blocks for what is never written.
    os.truncate(path, LARGEST_BYTES + 1)
    with pytest.raises(InputError, match="larger than 400 MB"):
        read_table(path)


def test_wrong_rename_says_the_nearest(tmp_path):
    with pytest.raises(InputError, match="did you mean 'crown'"):
        read_table(table(tmp_path, DIALECTS["plain"]), rename={"crwn": "x"})


CELL = st.one_of(
    st.sampled_from(
        [
            "",
            "-",
            "NaN",
            "inf",
            "1e400",
            "25",
            "25,5",
            "-3",
            '"',
            "run",
            "time [s]",
            "a [K]",
            "#",
            "٣",
            "s",
            "°C",
            "OL",
            "0:00:01",
        ]
    ),
    st.floats(allow_nan=True, allow_infinity=True).map(repr),
    st.text(max_size=6),
)
ROWS = st.lists(st.lists(CELL, max_size=5), max_size=8)


@settings(max_examples=300, suppress_health_check=[HealthCheck.too_slow], deadline=None)
@given(rows=ROWS, delimiter=st.sampled_from(",;\t"), heading=st.booleans())
def test_arbitrary_tables_are_read_or_refused(tmp_path_factory, rows, delimiter, heading):
    head = delimiter.join(["time [s]", "crown [degC]", "bead [degF]", "run"][: len(rows[0]) if rows else 3])
    text = (head + "\n" if heading else "") + "\n".join(delimiter.join(row) for row in rows)
    read_or_refused(tmp_path_factory, text.encode("utf-8", "surrogatepass"))


@settings(max_examples=200, deadline=None)
@given(st.one_of(st.binary(max_size=200), st.text(max_size=200).map(lambda text: text.encode("utf-16", "replace"))))
def test_arbitrary_bytes_are_read_or_refused(tmp_path_factory, content):
    read_or_refused(tmp_path_factory, content)


def read_or_refused(tmp_path_factory, content):
    path = table(tmp_path_factory.getbasetemp(), content, "fuzz.csv")
    runs = ()
    refused = None
    try:
        runs = read_table(path)
    except InputError as error:
        refused = error
    assert bool(runs) != bool(refused)
    assert refused is None or refused.file == path
    for run in runs:
        assert np.all(np.diff(run.times) > 0.0)
        readings = run.temperatures.to_numpy()
        assert np.all(np.isnan(readings) | ((readings >= COLDEST - 1e-6) & (readings <= HOTTEST + 1e-6)))
        assert np.isfinite(readings).any(axis=0).all()


def test_the_table_in_the_documentation_can_be_read(tmp_path):
    text = (Path(__file__).parents[2] / "docs" / "validation.md").read_text(encoding="utf-8")
    shown = text.split("## The measured table")[1].split("```")[1]
    (run,) = read_table(table(tmp_path, shown.strip()))
    assert run.name == "20-mph"
    assert run.times.tolist() == [0.0, 60.0]
    assert run.temperatures["crown-inner"].tolist() == pytest.approx([25.0, 52.5 / 1.8])
    assert run.temperatures["shoulder"].isna().tolist() == [False, True]


def test_names_with_separate_accents_are_those_with_composed_letters(tmp_path: Path) -> None:
    """Some systems write a letter and its mark as two characters, which look the same."""
    file = tmp_path / "t.csv"
    file.write_text("time [s],Gu\u0308rtel [degC],Luft vorn\u0308 [degC],x [degC]\n0,25,25,20\n", encoding="utf-8")
    (run,) = read_table(file, rename={"x": "Seite u\u0308"}, ignore=["Luft vorn\u0308"])
    assert run.sensors == ("G\u00fcrtel", "Seite \u00fc")
