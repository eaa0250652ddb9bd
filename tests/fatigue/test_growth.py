"""Growth of a flaw: the closed form of the life, ratio of the cycle, temperature; the card's table."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

from tyrefem import library
from tyrefem.errors import InputError
from tyrefem.fatigue.growth import LONGEST, cycles_to_failure, driving_force, lindley_factor, temperature_factor
from tyrefem.materials.card import MaterialCard
from tyrefem.materials.fatigue import Fatigue

pytestmark = pytest.mark.fast

TABLE = {
    "tearing_energy": "10 kJ/m**2",
    "growth_rate": "10 um",
    "exponent": 2.0,
    "flaw": "30 um",
    "crack": "1 mm",
    "temperature_rate": "0.02 1/delta_degC",
    "source": "test",
}


def fatigue(**changes: Any) -> Fatigue:
    return Fatigue.check({**TABLE, **changes})


@pytest.mark.parametrize("exponent", [0.5, 1.0, 1.0 + 1e-7, 2.0, 4.3])
def test_life_in_closed_form_is_the_integral_of_the_growth_law(exponent: float) -> None:
    card, energy, stretch, temperature = fatigue(exponent=exponent), 8e4, 1.2, 80.0

    def growth(c: float) -> float:
        tearing = 2 * (2.95 - 0.08 * 0.2) / np.sqrt(1.2) * energy * c
        return 10e-6 * (tearing / 1e4) ** exponent * np.exp(0.02 * (80 - 23))

    expected, _ = quad(lambda c: 1 / growth(c), 30e-6, 1e-3, epsrel=1e-12)
    assert cycles_to_failure(card, energy, 0.0, stretch, temperature) == pytest.approx(expected, rel=1e-6)


def test_a_crack_that_reaches_the_tearing_energy_ends_the_life_there() -> None:
    card, energy = fatigue(crack="50 mm"), 1e6
    last = 1e4 / (2 * 2.95 * energy)
    assert 30e-6 < last < 50e-3
    slope = 2 * 2.95 * energy / 1e4
    expected = (1 / 30e-6 - 1 / last) / (10e-6 * slope**2)
    assert cycles_to_failure(card, energy) == pytest.approx(expected, rel=1e-12)
    assert cycles_to_failure(card, 1e9) == 0.0
    assert cycles_to_failure(card, 1e9, 1.0) == 0.0  # it tears at once, whether or not the load changes


def test_no_cycle_lasts_for_ever() -> None:
    assert cycles_to_failure(fatigue(), [0.0, -1.0]).tolist() == [LONGEST, LONGEST]
    assert cycles_to_failure(fatigue(), 1e5, 1.0) == LONGEST  # no range, no crystals


def test_a_flaw_below_the_threshold_does_not_grow() -> None:
    energy = np.array([2e5, 4e5])  # T = 2 * 2.95 * W * 30 um = 35 and 71 J/m2
    lives = cycles_to_failure(fatigue(threshold="50 J/m**2"), energy)
    assert lives[0] == LONGEST
    assert lives[1] == cycles_to_failure(fatigue(), 4e5)


def test_life_falls_as_the_energy_to_the_exponent() -> None:
    one, two = cycles_to_failure(fatigue(exponent=3.0), [1e3, 2e3])
    assert one / two == pytest.approx(8.0, rel=1e-12)


def test_a_cycle_that_does_not_relax() -> None:
    rubber, natural = fatigue(), fatigue(crystallising=True, ratio_rate=1.5)
    share, exponent = driving_force(rubber, [0.0, 0.25])
    assert (share.tolist(), exponent.tolist()) == ([1.0, 0.75], [2.0, 2.0])
    assert cycles_to_failure(rubber, 1e4, 0.25) == pytest.approx(cycles_to_failure(rubber, 7.5e3), rel=1e-9)
    # Mars and Fatemi: dc/dN at T_max and R is that at the equivalent T of R = 0.
    ratio, tearing = 0.3, 500.0
    share, exponent = driving_force(natural, ratio)
    assert share == 1.0
    equivalent = tearing ** (exponent / 2) * 1e4 ** (1 - exponent / 2)
    assert (tearing / 1e4) ** exponent == pytest.approx((equivalent / 1e4) ** 2, rel=1e-12)
    lives = cycles_to_failure(natural, 1e4, [0.0, 0.1, 0.3, 0.6])
    assert (np.diff(lives) > 0).all()


def test_temperature_factor() -> None:
    assert temperature_factor(fatigue(), 23.0) == 1.0
    assert temperature_factor(fatigue(), 73.0) == pytest.approx(np.e, rel=1e-12)
    cold, hot = cycles_to_failure(fatigue(), 1e4, temperature=[23.0, 73.0])
    assert cold / hot == pytest.approx(np.e, rel=1e-12)


def test_lindleys_factor() -> None:
    np.testing.assert_allclose(lindley_factor([0.9, 1.0, 1.44, 4.0]), [2.95, 2.95, (2.95 - 0.0352) / 1.2, 1.355])


@pytest.mark.parametrize(
    ("changes", "field", "words"),
    [
        ({"tearing_energy": "-10 kJ/m**2"}, "tearing_energy", "0"),
        ({"growth_rate": "0 um"}, "growth_rate", "0"),
        ({"exponent": -2}, "exponent", "0"),
        ({"crack": "20 um"}, "crack", "longer than the flaw"),
        ({"threshold": "20 kJ/m**2"}, "threshold", "less than the tearing energy"),
        ({"ratio_rate": 2.0}, "ratio_rate", "crystallising = true"),
        ({"tearing": "1 kJ/m**2"}, None, "did you mean 'tearing_energy'"),
    ],
)
def test_refused_numbers(changes: dict[str, Any], field: str | None, words: str) -> None:
    data = copy.deepcopy(library.load("material", "rubber-sidewall")[0])
    with pytest.raises(InputError) as caught:
        MaterialCard.check({**data, "fatigue": {**TABLE, **changes}})
    assert words in str(caught.value)
    assert caught.value.field == ("fatigue" if field is None else f"fatigue.{field}")


def test_an_unlikely_tearing_energy_is_a_warning() -> None:
    data = copy.deepcopy(library.load("material", "rubber-sidewall")[0])
    card = MaterialCard.check({**data, "fatigue": {**TABLE, "tearing_energy": "10 J/m**2"}})
    assert [warning.field for warning in card.warnings()] == ["fatigue.tearing_energy"]


def test_large_exponents_stay_numbers() -> None:
    """Crystallising rubber that hardly relaxes: F exp(ratio_rate R) of some hundred, near the tearing energy."""
    card, energy, ratio = fatigue(exponent=8.0, crystallising=True, ratio_rate=4.0), 5e7, [0.3, 0.6, 0.8, 0.9]
    exponent = 8.0 * np.exp(4.0 * np.array(ratio))
    start = 2 * 2.95 * energy * 30e-6 / 1e4  # T over T_c of the flaw, 0.885
    expected = 3.0 * (start**-exponent - 1 / start) / (exponent - 1)  # c_0 / r_c = 3
    assert cycles_to_failure(card, energy, ratio) == pytest.approx(expected, rel=1e-9)
    lives = cycles_to_failure(card, np.geomspace(1.0, 1e12, 25)[:, None], np.linspace(0.0, 1.0, 21))
    assert np.isfinite(lives).all()
    assert (np.diff(lives, axis=0) <= 0).all()
