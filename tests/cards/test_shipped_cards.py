"""Every shipped card: each number carries a unit, a source and a possible value."""

from __future__ import annotations

import re

import numpy as np
import pytest

from tyrefem import library
from tyrefem.cards import read_toml
from tyrefem.geometry import load as section
from tyrefem.materials.card import material

pytestmark = pytest.mark.fast

MATERIALS = sorted(library.names("material"))
SECTIONS = sorted(library.names("section"))
#: Numbers that have no unit by nature.
PURE = {"relative_sd", "bead_bundles", "shoulder_fraction", "thickness_scale"}
NUMBER = re.compile(r"^[-+]?[\d.]+(e[-+]?\d+)?\s*(.*)$")


def bare_numbers(data, path=()):
    """Paths of numbers that carry no unit, lists with a 'unit' beside them apart."""
    if isinstance(data, dict):
        if "unit" in data and "values" in data:
            return
        for key, value in data.items():
            yield from bare_numbers(value, (*path, key))
    elif isinstance(data, list):
        for number, value in enumerate(data):
            yield from bare_numbers(value, (*path, number))
    elif not isinstance(data, bool) and (match := NUMBER.match(str(data))) and not match[2]:
        yield path


@pytest.mark.parametrize("name", MATERIALS)
def test_every_number_of_a_material_has_unit_and_source(name):
    data = read_toml(library.find("material", name))
    # tan delta is a ratio, plies are counted, an exponent is a power.
    pure = {("loss_tangent", "value"), ("cords", "loss_tangent"), ("cords", "plies")}
    pure |= {("loss_tangent", "frequency", "exponent"), ("fatigue", "exponent"), ("fatigue", "ratio_rate")}
    pure |= {("wear", "exponent")}
    pure |= {("friction", name) for name in ("coefficient", "standstill", "width", "pressure_exponent")}
    assert [path for path in bare_numbers(data) if path not in pure] == []
    for key, table in data.items():
        if isinstance(table, dict):
            assert table["source"].strip(), key


@pytest.mark.parametrize("name", SECTIONS)
def test_every_number_of_a_section_has_unit_and_source(name):
    data = read_toml(library.find("section", name))
    assert [path for path in bare_numbers(data) if not PURE & set(path)] == []
    assert all(table["source"].strip() for table in [data["line"], data["parameters"], data["rating"], *data["layers"]])


@pytest.mark.parametrize("name", MATERIALS)
def test_a_shipped_material_is_possible(name):
    card = material(name)
    for temperature in (-40.0, 25.0, 150.0):
        assert np.min(card.conductivity.law()) > 0
        assert 0 <= card.loss_tangent(temperature) < 1
    assert card.density.at(25.0) * card.specific_heat.at(25.0) == pytest.approx(card.heat_capacity())


def test_the_report_s_rubber():
    """Table 3 and appendix I: k = 0.2092 W/m/K and rho c = 2.092e6 J/m3/K for all; tan delta at 25 degC per region."""
    loss = {"tread": 0.20, "carcass": 0.10, "sidewall": 0.15, "bead": 0.03}
    for region, tangent in loss.items():
        card = material(f"nasa-{region}")
        assert card.conductivity.law() == pytest.approx(0.2092)
        assert card.heat_capacity() == pytest.approx(2.092e6)
        assert card.loss_tangent(25.0) == pytest.approx(tangent)
        assert card.loss_tangent(75.0) == pytest.approx(tangent * np.exp(-0.74))


@pytest.mark.parametrize("name", SECTIONS)
def test_a_shipped_section_is_the_tyre_of_its_designation(name):
    """Diameter over the crown and nominal width in m: 22x5.5, 16 in + 2 x 0.55 x 205 mm, 22.5 in + 2 x 0.8 x 295 mm.

    The 22x5.5 sections, fitted to tables H1 and H2, come out within 1 %. The aircraft radial's diameter is 0.985 of the
    nominal one, which is the largest.
    """
    of_nominal = 0.985 if name.startswith("aircraft-radial") else 1.0
    sizes = {"22x5.5": (0.5588, 0.1397), "205-55r16": (0.6319, 0.205), "295-80r22.5": (1.0435, 0.295)}
    (diameter, width), *others = [size for designation, size in sizes.items() if designation in name]
    tyre = section(name)
    assert not others
    assert tyre.outer_diameter == pytest.approx(of_nominal * diameter, rel=0.01)
    assert tyre.rating.width == pytest.approx(width)
