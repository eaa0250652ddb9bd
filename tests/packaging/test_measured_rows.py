"""A row of the measured tyres, computed again on a coarse mesh, meets the stored one."""

from __future__ import annotations

from types import ModuleType

import pytest
from script_module import script_module

#: Largest relative difference of a coarse mesh from the stored row.
TOLERANCES = {
    "deflection [mm]": 0.01,
    "length [mm]": 0.03,
    "width [mm]": 0.02,
    "gross area [cm2]": 0.03,
    "net area [cm2]": 0.03,
    "loaded radius [mm]": 0.002,
    "rolling radius [mm]": 0.002,
    "growth [mm]": 0.01,
    "mass [kg]": 0.005,
    "rolling resistance at 20 degC": 0.02,
}


@pytest.fixture(scope="module")
def benchmark_module() -> ModuleType:
    """benchmarks/measured.py."""
    return script_module("benchmarks/measured.py")


@pytest.mark.parametrize("name", ["passenger", "prints"])
def test_a_coarse_press_meets_the_stored_row(benchmark_module: ModuleType, name: str) -> None:
    row = benchmark_module.quick_row(name)
    off = {quantity: now / stored - 1 for quantity, (now, stored) in row.items() if quantity in TOLERANCES}
    assert set(off) == set(TOLERANCES)
    assert {quantity for quantity, value in off.items() if abs(value) > TOLERANCES[quantity]} == set(), off
