"""Property laws: tables interpolate, plies are orthotropic, tan delta falls with temperature."""

from __future__ import annotations

import copy

import numpy as np
import pytest

from tyrefem import library
from tyrefem.errors import InputError
from tyrefem.materials.card import MaterialCard

pytestmark = pytest.mark.fast


def card(**changes):
    data = copy.deepcopy(library.load("material", "nasa-tread")[0])
    for name, table in changes.items():
        data[name] = {"source": "test", **table}
    return MaterialCard.check(data)


def test_tables_are_linear_between_rows_and_constant_beyond():
    changed = card(
        conductivity={"table": [["0 degC", "0.20 W/m/K"], ["100 degC", "0.30 W/m/K"]]},
        specific_heat={"table": [["0 degC", "1800 J/kg/K"], ["100 degC", "2200 J/kg/K"]]},
        loss_tangent={"law": "table", "table": [["0 degC", "0.30"], ["100 degC", "0.10"]]},
    )
    T = np.array([-50.0, 0.0, 25.0, 100.0, 400.0])
    assert changed.conductivity.law()(T) == pytest.approx([0.20, 0.20, 0.225, 0.30, 0.30])
    assert changed.heat_capacity()(T) == pytest.approx([1.8e6, 1.8e6, 1.9e6, 2.2e6, 2.2e6])
    assert changed.loss_tangent(T) == pytest.approx([0.30, 0.30, 0.25, 0.10, 0.10])


def test_plies_conduct_along_and_across():
    plies = card(conductivity={"along": "0.4 W/m/K", "across": "0.2 W/m/K"})
    assert plies.conductivity.orthotropic
    assert plies.conductivity.law() == (0.4, 0.2)
    rows = [["0 degC", "0.4 W/m/K", "0.2 W/m/K"], ["100 degC", "0.6 W/m/K", "0.3 W/m/K"]]
    along, across = card(conductivity={"table": rows}).conductivity.law()(np.array([50.0]))
    assert (float(along[0]), float(across[0])) == pytest.approx((0.5, 0.25))


def test_one_direction_alone_is_refused():
    with pytest.raises(InputError, match="belong together"):
        card(conductivity={"along": "0.4 W/m/K"})


def test_tan_delta_laws():
    """exponential: tan d = value exp(-rate (T - at)); the logarithm's slope is the rate."""
    law = card(loss_tangent={"value": 0.2, "at": "25 degC", "rate": "0.0148 1/delta_degC"}).loss_tangent
    assert np.log(law(45.0) / law(35.0)) == pytest.approx(-0.148)
    constant = card(loss_tangent={"law": "constant", "value": 0.2}).loss_tangent
    assert constant(np.array([0.0, 200.0])) == pytest.approx([0.2, 0.2])
    for incomplete in ({"law": "exponential", "value": 0.2}, {"law": "table"}, {"law": "constant"}):
        with pytest.raises(InputError, match="needs"):
            card(loss_tangent=incomplete)


def test_a_table_that_the_law_does_not_read_is_refused():
    rows = [["0 degC", "1.3"], ["100 degC", "0.8"]]
    softening = {"rate": "0.003 1/delta_degC", "table": rows}
    assert card(softening={"law": "table", "table": rows}).softening(0.0) == pytest.approx(1.3)
    with pytest.raises(InputError, match="only for the law 'table'") as caught:
        card(softening=softening)
    assert caught.value.field == "softening.table"
    for other in ({"law": "exponential", "rate": "0.01 1/delta_degC"}, {"law": "constant"}):
        with pytest.raises(InputError, match="only for the law 'table'"):
            card(loss_tangent={"value": 0.2, "table": rows, **other})
