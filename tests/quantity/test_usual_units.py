"""Factors of usual units stand in a table: it is pint's, and the shipped files need no other unit."""

from __future__ import annotations

import subprocess
import sys

import make_unit_factors
import pytest

from tyrefem.quantity import _convert, _usual, parse
from tyrefem.quantity.factors import FACTORS, TEMPERATURES

pytestmark = pytest.mark.fast

PAIRS = [(unit, text) for unit, factors in FACTORS.items() for text in factors]


@pytest.mark.parametrize("unit", FACTORS)
def test_factors_are_pints(unit: str) -> None:
    for text in FACTORS[unit]:
        for number in (1.0, -3.7, 0.123456789):
            assert _usual(number, text, unit) == _convert(number, text, unit, f"{number} {text}", "")


@pytest.mark.parametrize("text", TEMPERATURES)
def test_temperatures_are_pints(text: str) -> None:
    for number in (0.0, 25.0, 77.0, 298.15, 1234.5):
        assert _usual(number, text, "degC") == pytest.approx(_convert(number, text, "degC", "", ""), abs=1e-10)


def test_the_table_is_the_tools() -> None:
    assert make_unit_factors.PAGE.read_text(encoding="utf-8") == make_unit_factors.text()


def test_a_unit_of_another_kind_is_not_in_the_table() -> None:
    assert _usual(1.0, "kg", "m") is None
    assert _usual(1.0, "delta_degC", "degC") is None
    assert _usual(1.0, "degC", "delta_degC") is None
    assert _usual(1.0, "furlong", "m") is None
    assert parse("1 furlong", "m") == pytest.approx(201.168, rel=1e-5)


def test_shipped_studies_are_read_without_pint() -> None:
    code = (
        "import sys, tyrefem as tf\n"
        "from tyrefem import library\n"
        "for name in library.names('study'):\n"
        "    tf.study(name)\n"
        "print('pint' in sys.modules)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.stdout == "False\n", done.stderr
