"""Published ranges stand beside results and change none of them."""

from __future__ import annotations

import csv
import html
from pathlib import Path

import pytest

import tyrefem as tf
from tyrefem.inputs.published import PublishedComparison, compared
from tyrefem.reports.run import render
from tyrefem.reports.run_files import of_run

RADIALS = ("passenger-205-55r16", "truck-295-80r22.5", "aircraft-radial")


@pytest.mark.parametrize("name", RADIALS)
def test_the_radials_name_ranges_with_their_source(name: str) -> None:
    published = tf.study(name).card.published
    assert published.vertical_stiffness is not None
    for quantity in type(published).model_fields:
        known = getattr(published, quantity)
        if known is not None:
            low, high = known.between
            assert 0 < low < high
            # A recollection or a guess is called one.
            assert any(word in known.source for word in ("Regulation", "from memory", "estimate"))
            middle = (low + high) / 2
            verdicts = [compared(published, {quantity: value})[0].inside for value in (0.9 * low, middle, 1.1 * high)]
            assert verdicts == [False, True, False]


def test_the_recorded_table_has_the_ranges_of_the_studies() -> None:
    """Made by benchmarks/radials.py in large motion, the studies' own; what is outside is recorded as outside."""
    tables = Path(__file__).parents[2] / "docs/evidence/tables"
    with (tables / "radials-published.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    quantities = {
        "secant stiffness [N/mm]": ("vertical_stiffness", 1e3),
        "footprint length [mm]": ("footprint_length", 1e-3),
        "footprint width [mm]": ("footprint_width", 1e-3),
        "footprint area without grooves [cm2]": ("footprint_area", 1e-4),
        "coefficient, cold": ("rolling_resistance_coefficient", 1.0),
        "coefficient, warm": ("rolling_resistance_coefficient", 1.0),
    }
    studies = {name.split("-")[0]: tf.study(name) for name in RADIALS}
    seen = set()
    for row in rows:
        tyre = row["tyre"].split(",")[0]
        quantity, unit = quantities[row["quantity"]]
        known = getattr(studies[tyre].card.published, quantity)
        limits = (float(row["published from"]) * unit, float(row["published to"]) * unit)
        assert known.between == pytest.approx(limits, rel=1e-9)
        inside = limits[0] <= float(row["computed"]) * unit <= limits[1]
        assert row["inside"] == ("yes" if inside else "no")
        seen.add((tyre, quantity))
    named = {(tyre, quantity) for tyre, study in studies.items() for quantity in study.card.published.model_fields_set}
    assert seen == named
    # Stated on the page: the passenger is too soft, the truck's area 1 % too small.
    assert [(row["tyre"].split(",")[0], row["quantity"]) for row in rows if row["inside"] == "no"] == [
        ("passenger", "secant stiffness [N/mm]"),
        ("truck", "footprint area without grooves [cm2]"),
    ]


def test_label_classes_of_c3_tyres() -> None:
    """Regulation (EC) 1222/2009 annex I part A: class A ends at 4.0, class E at 8.0 kg/t."""
    known = tf.study("truck-295-80r22.5").card.published.rolling_resistance_coefficient
    assert known is not None
    assert known.between == (0.004, 0.008)


def test_the_gross_area_of_the_truck_tyre_by_the_tire_and_rim_association() -> None:
    """Design guide 3-24R2: 39.8 - 0.315 P + 0.00887 L + 0.000938 V square inches, V = 3.14 (H + D_r) S H, inches."""
    study = tf.study("truck-295-80r22.5")
    phase = study.card.drive.phases[0]
    height, width, rim = 0.8 * 295 / 25.4, 298 / 25.4, 22.5
    volume = 3.14 * (height + rim) * width * height
    gross = 39.8 - 0.315 * phase.pressure.start / 6894.757 + 0.00887 * phase.load.start / 4.448222 + 0.000938 * volume
    known = study.card.published.footprint_area
    assert known is not None
    assert known.between == pytest.approx((0.70 * gross * 0.0254**2, 0.85 * gross * 0.0254**2), rel=5e-3)


def test_words_and_json() -> None:
    comparison = PublishedComparison("footprint_length", 0.11, 0.12, 0.15, "a book")
    assert comparison.words == "footprint length 110, published 120 to 150 mm: outside (a book)"
    assert comparison.to_dict()["verdict"] == "outside"
    assert comparison.to_dict()["unit"] == "m"


def test_a_run_tells_its_own_beside_them() -> None:
    """A given strain cycle knows no footprint; the coefficient is the run's own."""
    study = tf.study(
        "passenger-205-55r16",
        {
            "mechanics.strain": "given",
            "mesh.size": "12 mm",
            "mesh.element": "P1",
            "drive.duration": "60 s",
            "numerics.tolerance": "1 delta_degC",
        },
    )
    result = study.run()
    (only,) = of_run(result)
    assert only.quantity == "rolling_resistance_coefficient"
    assert only.value == result.rolling_resistance.coefficient
    assert result.summary()["published"] == [only.to_dict()]
    page = render(result)
    assert "Comparison with published ranges" in page
    for cell in only.cells:
        assert html.escape(cell, quote=False) in html.unescape(page).replace("&", "&amp;")
    without = study.replace({"published": {}}).run()
    assert "Beside published ranges" not in render(without)
    assert of_run(without) == ()
    assert without.rolling_resistance.coefficient == only.value
