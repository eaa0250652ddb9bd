"""A unit is a name with small powers; an expression that would take for ever is refused at once."""

from __future__ import annotations

import pytest

from tyrefem.errors import InputError
from tyrefem.quantity import parse

UNBOUNDED = [
    "m**9**9**9",
    "m^9^9^9",
    "m**(9)**(9)**(9)",
    "(m**9)**9",
    "9**9**9 m",
    "m**99999999",
    "2*m",
    "a" * 58 + "!",
]


@pytest.mark.parametrize("unit", UNBOUNDED)
def test_unbounded_expressions_are_refused(unit: str) -> None:
    with pytest.raises(InputError, match="unit"):
        parse(f"3 {unit}", "m")


@pytest.mark.parametrize(
    "unit", ["W/m**2/K", "W/m^2/K", "W/(m^2 K)", "W/m²/K", "W*m**-2/K", "W m⁻² K⁻¹", "W·m^-2/delta_degC"]
)
def test_every_usual_spelling_is_understood(unit: str) -> None:
    assert parse(f"20.5 {unit}", "W/m**2/K") == pytest.approx(20.5)
