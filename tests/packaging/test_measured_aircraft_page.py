"""Aircraft tyres by finite elements: docs/measured.md says what the stored tables say; the rule of the rows is kept."""

from __future__ import annotations

from types import ModuleType

import pytest
from script_module import ROOT, script_module

pytestmark = pytest.mark.fast


@pytest.fixture(scope="module")
def page() -> ModuleType:
    return script_module("tools/measured_aircraft_page.py")


@pytest.fixture(scope="module")
def benchmark() -> ModuleType:
    return script_module("benchmarks/measured_aircraft.py")


def test_the_page_has_the_tables_of_the_stored_results(page: ModuleType) -> None:
    text = (ROOT / "docs/measured.md").read_text(encoding="utf-8")
    assert text.split(page.BEGIN)[1].split(page.END)[0].strip() == page.section()


def test_the_stored_rows_are_those_of_the_rule(page: ModuleType, benchmark: ModuleType) -> None:
    chosen = benchmark.chosen()
    assert [(t.number, t.group) for t in chosen] == [(int(r["row"]), r["group"]) for r in page.rows_of()]
    assert len(chosen) == 38
    assert len(benchmark.catalogue()) == 348
    assert [tyre.size for tyre in chosen].count("22x5.5") == 3
    loads = [tyre.load for tyre in chosen[3:]]
    assert loads == sorted(loads)
    assert {tyre.group for tyre in chosen} == {"used", "judged"}


def test_a_stored_row_is_that_of_the_data_book(page: ModuleType, benchmark: ModuleType) -> None:
    for tyre, row in zip(benchmark.chosen(), page.rows_of(), strict=True):
        assert float(row["catalogue deflection [mm]"]) == pytest.approx(tyre.deflection * 1e3, rel=1e-4)
        if row["computed deflection [mm]"]:
            ratio = float(row["computed deflection [mm]"]) / (tyre.deflection * 1e3)
            assert float(row[page.RATIO]) == pytest.approx(ratio, rel=1e-4)
        else:
            assert row["message"]


def test_verdicts_follow_the_uncertainty(page: ModuleType) -> None:
    row = {"u of the catalogue, %": "5"}
    u = page.u_val(row)
    assert u == pytest.approx((0.05**2 + page.NUMERICAL**2 + page.input_uncertainty() ** 2) ** 0.5)
    verdicts = [page.verdict({**row, page.RATIO: str(1 + k * u)}) for k in (0.5, -1.5, 2.5)]
    assert verdicts == ["within u_val", "within 2 u_val", "model error"]


def test_the_order_of_loads_is_a_rank_correlation(page: ModuleType) -> None:
    assert page.order([(1.0, 5.0, True), (2.0, 6.0, True), (3.0, 70.0, False)]) == pytest.approx(1.0)
    assert page.order([(1.0, 70.0, True), (2.0, 6.0, True), (3.0, 5.0, False)]) == pytest.approx(-1.0)


def test_every_bottoming_radius_of_the_chosen_rows_is_computed(page: ModuleType, benchmark: ModuleType) -> None:
    wanted = [tyre.number for tyre in benchmark.chosen() if tyre.bottoming_load > 0 and tyre.bottoming_radius > 0]
    rows = page.table("bottoming")
    assert [int(row["row"]) for row in rows] == wanted
    assert len(wanted) == 30
    short = [
        row for row in rows if float(row["reached deflection [mm]"]) < 0.98 * float(row["crown meets the rim at [mm]"])
    ]
    assert all(
        float(row["reached deflection [mm]"]) == float(row["deflection at the bottoming radius [mm]"]) for row in short
    )
    assert page.at_the_rim() == len(rows) - 27
