"""Cards: tan delta over frequency by power law, table and Prony series with a shift; moduli over temperature."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest

from tyrefem import library
from tyrefem.errors import InputError
from tyrefem.materials.card import MaterialCard, material
from tyrefem.materials.loss_tangent import Prony, Shift

pytestmark = pytest.mark.fast

WLF = {"c1": 8.86, "c2": "101.6 delta_degC", "reference": "20 degC"}
SERIES = [["1.2 MPa", "10 us"], ["0.5 MPa", "1 ms"], ["0.2 MPa", "0.1 s"]]
PRONY = {"law": "prony", "equilibrium": "1.5 MPa", "series": SERIES, "shift": WLF, "source": "test"}
T = np.array([-20.0, 25.0, 60.0, 110.0])


def card(name: str = "nasa-tread", **changes: Any) -> MaterialCard:
    data = copy.deepcopy(library.load("material", name)[0])
    for key, table in changes.items():
        data[key] = {**data.get(key, {"source": "test"}), **table}
    return MaterialCard.check(data)


def over(frequency: dict[str, Any], **loss: Any) -> Any:
    return card(loss_tangent={"frequency": frequency, **loss}).loss_tangent


def test_without_a_law_of_frequency_all_are_alike() -> None:
    law = material("nasa-tread").loss_tangent
    assert np.array_equal(law.over_frequency(3.0, T), law(T))
    assert np.array_equal(law.over_frequency(300.0, T), law(T))


def test_a_power_law_carries_the_law_of_temperature() -> None:
    law = over({"law": "power", "exponent": 0.2, "reference": "10 Hz", "source": "test"})
    assert law.over_frequency(10.0, T) == pytest.approx(law(T), rel=1e-12)
    assert law.over_frequency(320.0, T) == pytest.approx(2.0 * law(T), rel=1e-12)


def test_a_table_is_linear_in_the_logarithm_and_scales_the_law_of_temperature() -> None:
    rows = [["1 Hz", 0.1], ["100 Hz", 0.3]]
    law = over({"law": "table", "table": rows, "reference": "1 Hz", "source": "test"})
    assert law.over_frequency(10.0, T) == pytest.approx(2.0 * law(T), rel=1e-12)
    assert law.over_frequency(1e4, T) == pytest.approx(3.0 * law(T), rel=1e-12)


def test_one_maxwell_element_is_the_standard_linear_solid() -> None:
    """tan d peaks at x = sqrt(E_0 / (E_0 + E)) with E / (2 sqrt(E_0 (E_0 + E))) (Ferry 1980)."""
    relaxed, element, time = 1.5e6, 2.4e6, 1e-3
    solid, x = Prony(relaxed, (element,), (time,)), np.sqrt(relaxed / (relaxed + element))
    peak = x / (2 * np.pi * time)
    at = [float(solid(peak * factor, np.array(20.0))) for factor in (0.9, 1.0, 1.1)]
    assert at[1] == pytest.approx(element / (2 * np.sqrt(relaxed * (relaxed + element))), rel=1e-12)
    assert at[1] > max(at[0], at[2])
    # Far above the peak it is elastic: tan d falls as 1/f.
    high = [float(solid(factor * peak, np.array(20.0))) for factor in (1e4, 2e4)]
    assert high[0] == pytest.approx(2 * high[1], rel=1e-6)


def test_a_prony_series_with_a_shift_says_everything() -> None:
    law = over(PRONY, law="frequency")
    moduli, times = (1.2e6, 0.5e6, 0.2e6), (1e-5, 1e-3, 0.1)
    alone = Prony(1.5e6, moduli, times, Shift(8.86, 101.6, 20.0))
    assert law.over_frequency(50.0, T) == pytest.approx(alone(50.0, T), rel=1e-12)
    assert law(T) == pytest.approx(alone(10.0, T), rel=1e-12)
    # Time and temperature are one: a_T(60 degC) times the frequency at the reference temperature.
    shifted = 50.0 * float(Shift(8.86, 101.6, 20.0)(np.array(60.0)))
    assert law.over_frequency(50.0, np.array(60.0)) == pytest.approx(law.over_frequency(shifted, np.array(20.0)))


def test_beside_a_law_of_temperature_a_series_gives_the_ratio_only() -> None:
    law, alone = over(PRONY), over(PRONY, law="frequency")
    assert law.over_frequency(10.0, T) == pytest.approx(law(T), rel=1e-12)
    ratio = alone.over_frequency(80.0, T) / alone(T)
    assert law.over_frequency(80.0, T) == pytest.approx(law(T) * ratio, rel=1e-12)


@pytest.mark.parametrize(
    ("frequency", "loss", "message"),
    [
        ({"law": "power", "exponent": 0.1}, {}, r"^loss_tangent\.frequency\.source: missing"),
        ({"law": "power", "exponent": 3.0, "source": "t"}, {}, "exponent"),
        ({"law": "power", "exponent": 0.1, "source": "t"}, {"law": "frequency"}, "needs the table 'frequency'"),
        (
            {"law": "table", "table": [["9 Hz", 0.1], ["3 Hz", 0.2]], "source": "t"},
            {},
            r"^loss_tangent\.frequency\.table: frequencies must rise",
        ),
        ({"law": "table", "table": "x", "source": "t"}, {}, r"^loss_tangent\.frequency\.table: must be a list"),
        ({"law": "table", "tabel": [], "source": "t"}, {}, r"^loss_tangent\.frequency: unknown key 'tabel'"),
        ({**PRONY, "series": [["1 MPa"]]}, {}, r"series.0: row must be \[modulus, time\]"),
        ({**PRONY, "series": [["1 MPa", "-1 s"]]}, {}, "series.0"),
        ({"law": "pronny", "source": "t"}, {}, "did you mean 'prony'"),
    ],
)
def test_bad_laws_are_one_error(frequency: dict[str, Any], loss: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        over(frequency, **loss)


def test_a_modulus_falls_as_the_card_says_and_everything_with_it() -> None:
    soft = {"rate": "0.01 1/delta_degC", "at": "25 degC"}
    tread = card("rubber-tread-passenger", softening=soft)
    warm, factor = tread.warmed(75.0), np.exp(-0.5)
    assert tread.shear_modulus is not None
    assert warm.shear_modulus is not None
    assert warm.elasticity is not None
    assert warm.shear_modulus.value == pytest.approx(factor * tread.shear_modulus.value)
    assert warm.elasticity.initial_shear_modulus == pytest.approx(factor * 1.3e6)
    assert warm.elasticity.bulk == pytest.approx(100 * factor * 1.3e6)
    assert tread.warmed(25.0).shear_modulus == tread.shear_modulus
    yeoh = {"law": "yeoh", "c10": "0.5 MPa", "c20": "-0.01 MPa", "c30": "1 kPa", "source": "test"}
    data = library.load("material", "rubber-tread-passenger")[0]
    other = MaterialCard.check({**data, "softening": {**soft, "source": "test"}, "elasticity": yeoh})
    warm_law = other.warmed(75.0).elasticity
    assert warm_law is not None
    assert [getattr(warm_law, c) for c in ("c10", "c20", "c30")] == pytest.approx(
        [factor * x for x in (5e5, -1e4, 1e3)]
    )


def test_a_table_of_softening_is_relative_to_the_card() -> None:
    soft = card(softening={"law": "table", "table": [["25 degC", 1.0], ["75 degC", 0.6]]})
    assert soft.softening is not None
    assert [soft.softening(T) for T in (0.0, 50.0, 200.0)] == pytest.approx([1.0, 0.8, 0.6])


def test_cords_have_a_softening_of_their_own() -> None:
    ply = material("passenger-cap-ply")
    assert ply.softens
    warm = ply.warmed(75.0)
    assert ply.cords is not None
    assert warm.cords is not None
    factor = np.exp(-0.004 * 50)
    assert warm.cords.modulus == pytest.approx(factor * ply.cords.modulus)
    assert warm.cords.in_compression == pytest.approx(factor * ply.cords.in_compression)
    assert warm.elasticity == ply.elasticity
    assert not material("passenger-bead").softens
    assert material("passenger-bead").warmed(80.0) is not None


@pytest.mark.parametrize(
    ("soft", "message"),
    [
        ({"law": "exponential"}, "needs 'rate'"),
        ({"law": "table"}, "needs 'table'"),
        ({"law": "table", "table": [["25 degC", 1.0]]}, "at least two rows"),
    ],
)
def test_a_softening_without_numbers_is_refused(soft: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        card(softening=soft)


def test_a_prony_series_far_below_its_reference_is_a_number() -> None:
    """a_T of 1e200 had a square that is none; such rubber is glass and loses nothing."""
    glass = Prony(1e6, (2e6,), (1e-3,), Shift(20.0, 110.0, 20.0))(10.0, np.array([-80.0, -200.0]))
    assert glass == pytest.approx(0.0, abs=1e-9)
