"""CSV files are pandas' own, made without it."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from tyrefem.output.csv_table import columns_of, write_csv

pytestmark = pytest.mark.fast


def test_as_pandas_writes_it(tmp_path: Path) -> None:
    columns = {
        "length_m": np.array([0.0, 1 / 3, 1e-17, 123456789.0]),
        'name, "quoted"': ["plain", 'with "quotes"', "with, comma", "grüß dich"],
        "count": np.arange(4),
        "capped": [True, False, True, False],
        "missing": [math.nan, -2.5, math.inf, 1e300],
    }
    written = write_csv(columns, tmp_path / "folder" / "table.csv")
    assert written.read_text(encoding="utf-8") == pd.DataFrame(columns).to_csv(index=False, float_format="%.6g")


@pytest.mark.parametrize("name", ["time_s", "time [s]"])
def test_times_of_a_week_stay_apart(name: str, tmp_path: Path) -> None:
    times = 604800.0 + np.array([0.0, 0.1, 0.2])
    table = pd.read_csv(write_csv({name: times, "heat_W": times}, tmp_path / "table.csv"))
    assert table[name].tolist() == times.tolist()
    assert table["heat_W"].nunique() == 1


def test_columns_of_different_length_write_nothing(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="shorter"):
        write_csv({"a": [1], "b": []}, tmp_path / "table.csv")
    assert list(tmp_path.iterdir()) == []


def test_no_rows_are_no_columns() -> None:
    assert columns_of([]) == {}
