"""docs/measured.md says what the stored tables say, and the measured data are whole."""

from __future__ import annotations

import csv
import math
from dataclasses import astuple
from pathlib import Path

import make_measured_page as maker
import measured_comparison
import measured_pictures
import numpy as np
import pytest

pytestmark = pytest.mark.fast

ROOT = Path(__file__).resolve().parents[2]


def test_the_page_has_the_tables_of_the_stored_results() -> None:
    text = (ROOT / "docs/measured.md").read_text(encoding="utf-8")
    assert text.split(maker.BEGIN)[1].split(maker.END)[0].strip() == maker.page_tables()


def test_the_comparison_is_that_of_the_stored_results() -> None:
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
def test_the_measured_data_are_whole_and_name_their_source(path: str, rows: int, columns: int) -> None:
    assert len(maker.data(path)) == rows
    assert {len(row) for row in maker.data(path)} == {columns}
    assert "Source" in (ROOT / "studies" / path).read_text(encoding="utf-8")


@pytest.mark.parametrize(("times", "verdict"), [(0.9, "within u_val"), (1.9, "within 2 u_val"), (2.1, "model error")])
def test_a_deviation_is_judged_against_its_uncertainty(times: float, verdict: str) -> None:
    parts = measured_comparison.uncertainties("205/60R15", "deflection")
    u_val = math.hypot(*parts)
    computed = 100 * (1 + times * u_val)
    row = measured_comparison.compared("205/60R15", "deflection", 220.0, 4000.0, 100.0, computed, computed, 0.10)
    assert row.verdict == verdict
    assert row.u_val == pytest.approx(100 * u_val, abs=0.06)
    assert row.deviation == pytest.approx(100 * times * u_val, abs=0.06)
    assert row.goal_met == ("yes" if times * u_val <= 0.10 else "no")


def test_uncertainties_join_mesh_harmonics_tolerance_and_inputs() -> None:
    """The inputs' part is the root of the sum of squares of what each number moves; the largest is not above it."""
    _, numerical, inputs = measured_comparison.uncertainties("255/40R17 RE-71R", "deflection")
    by_number = measured_comparison.changes("255/40R17 RE-71R", "deflection")
    assert len(by_number) >= 15
    assert inputs == pytest.approx(np.sqrt(sum(change**2 for change in by_number.values())))
    assert measured_comparison.TOLERANCE <= numerical < 0.1


@pytest.mark.parametrize("fill", [math.pi / 4, 0.87, 0.96])
def test_the_outline_of_a_print_has_its_length_width_and_area(fill: float) -> None:
    """Area by the shoelace formula; an ellipse fills pi/4 of its box."""
    x, z = measured_pictures.print_outline(120.0, 200.0, fill * 120 * 200, count=20001)
    area = abs(np.sum(x[:-1] * z[1:] - x[1:] * z[:-1])) / 2
    assert (np.ptp(x), np.ptp(z), area) == pytest.approx((120.0, 200.0, fill * 120 * 200), rel=2e-4)
    if fill == math.pi / 4:
        assert np.hypot(x / 60, z / 100) == pytest.approx(1.0)


def test_the_stored_pressure_carries_the_stored_load() -> None:
    """Four quarters of the pressure map, by the trapezoidal rule, against the load: the tread's curve is left out."""
    for row in measured_comparison.table("pressure")[:1]:
        part = [
            other
            for other in measured_comparison.table("pressure")
            if (other["inflation [kPa]"], other["load [lbf]"]) == (row["inflation [kPa]"], row["load [lbf]"])
        ]
        x, z, pressure = measured_pictures.whole_print(part)
        load = np.trapezoid(np.trapezoid(pressure * 1e3, x * 1e-3, axis=1), z * 1e-3)
        assert load == pytest.approx(float(row["load [lbf]"]) * 4.4482, rel=0.05)


def test_aircraft_rows_and_their_median() -> None:
    facts = maker.aircraft_facts()
    assert facts["tyres"] == 395
    assert 0.9 < facts["median"] < 1.1
