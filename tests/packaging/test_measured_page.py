"""docs/measured.md says what the stored tables say, and the measured data are whole."""

from __future__ import annotations

import csv
import importlib.util
import sys
from dataclasses import astuple
from pathlib import Path
from types import ModuleType

import pytest

pytestmark = pytest.mark.fast

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def maker() -> ModuleType:
    """tools/make_measured_page.py."""
    spec = importlib.util.spec_from_file_location("make_measured_page", ROOT / "tools/make_measured_page.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def test_the_page_has_the_tables_of_the_stored_results(maker: ModuleType) -> None:
    text = (ROOT / "docs/measured.md").read_text(encoding="utf-8")
    assert text.split(maker.BEGIN)[1].split(maker.END)[0].strip() == maker.page_tables()


def test_the_comparison_is_that_of_the_stored_results(maker: ModuleType) -> None:
    with (maker.TABLES / "measured-comparison.csv").open(encoding="utf-8", newline="") as lines:
        stored = list(csv.reader(lines))[1:]
    assert stored == [[str(value) for value in astuple(row)] for row in maker.comparison()]


@pytest.mark.parametrize(
    ("path", "rows", "columns"),
    [
        ("measured-205-60r15/summary.csv", 5, 10),
        ("measured-255-40r17/load-radius-re71r.csv", 80, 4),
        ("measured-255-40r17/footprints-ecf.csv", 15, 6),
    ],
)
def test_the_measured_data_are_whole_and_name_their_source(
    maker: ModuleType, path: str, rows: int, columns: int
) -> None:
    assert len(maker.data(path)) == rows
    assert {len(row) for row in maker.data(path)} == {columns}
    assert "Source" in (ROOT / "studies" / path).read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("large", "verdict", "met"),
    [(100.5, "within u_val", "yes"), (109.0, "within 2 u_val", "yes"), (150.0, "model error", "no")],
)
def test_a_deviation_is_judged_against_its_uncertainty(maker: ModuleType, large: float, verdict: str, met: str) -> None:
    row = maker.compared("205/60R15", "deflection", 220.0, 4000.0, 100.0, large, large, 0.10)
    assert row.u_val == pytest.approx(100 * (0.03**2 + 0.02**2 + (row.u_input / 100) ** 2) ** 0.5, abs=0.1)
    assert (row.verdict, row.goal_met) == (verdict, met)
    assert row.deviation == pytest.approx(large - 100, abs=0.1)


def test_aircraft_rows_and_their_median(maker: ModuleType) -> None:
    facts = maker.aircraft_facts()
    assert facts["tyres"] == 395
    assert 0.9 < facts["median"] < 1.1
