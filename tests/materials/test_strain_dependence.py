"""Cards: storage and loss modulus over strain amplitude by Kraus (Payne effect)."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest

from tyrefem import library
from tyrefem.errors import InputError
from tyrefem.materials.card import MaterialCard, material, strain_laws
from tyrefem.materials.reads import values_read
from tyrefem.materials.strain_dependence import Kraus

pytestmark = pytest.mark.fast

SWEEP = {
    "small_strain_modulus": "3.5 MPa",
    "large_strain_modulus": "1 MPa",
    "greatest_loss_modulus": "0.3 MPa",
    "large_strain_loss_modulus": "0.08 MPa",
    "critical_strain": "2 %",
    "source": "test",
}
AMPLITUDES = np.geomspace(1e-6, 10.0, 200)


def card(**changes: Any) -> MaterialCard:
    data = copy.deepcopy(library.load("material", "rubber-sidewall")[0])
    return MaterialCard.check({**data, "strain_dependence": {**SWEEP, **changes}})


def test_limits_of_kraus() -> None:
    law = Kraus(3.5e6, 1e6, 3e5, 8e4, 0.02)
    assert law.storage(0.0) == 3.5e6
    assert law.loss(0.0) == 8e4
    assert law.storage(1e6) == pytest.approx(1e6, rel=1e-6)
    assert law.loss(1e9) == pytest.approx(8e4, rel=1e-5)
    assert law.storage(0.02) == pytest.approx((3.5e6 + 1e6) / 2, rel=1e-15)
    # One decade beyond the critical strain: x = 10^0.6.
    assert law.storage(0.2) == pytest.approx(1e6 + 2.5e6 / (1 + 10**1.2), rel=1e-14)
    assert law.loss(0.2) == pytest.approx(8e4 + 2.2e5 * 2 * 10**0.6 / (1 + 10**1.2), rel=1e-14)


def test_storage_falls_and_loss_has_one_peak_symmetric_in_the_logarithm() -> None:
    law = Kraus(3.5e6, 1e6, 3e5, 8e4, 0.02)
    assert (np.diff(law.storage(AMPLITUDES)) < 0).all()
    loss = law.loss(AMPLITUDES)
    peak = int(loss.argmax())
    assert (np.diff(loss[: peak + 1]) > 0).all()
    assert (np.diff(loss[peak:]) < 0).all()
    assert AMPLITUDES[peak] == pytest.approx(0.02, rel=0.1)
    assert law.loss(0.02 * 7) == pytest.approx(law.loss(0.02 / 7), rel=1e-12)


def test_the_amplitude_of_a_modulus_is_the_inverse() -> None:
    law = Kraus(3.5e6, 1e6, 3e5, 8e4, 0.02)
    for amplitude in (1e-4, 0.02, 0.3):
        assert law.amplitude(float(law.storage(amplitude))) == pytest.approx(amplitude, rel=1e-9)
    assert law.amplitude(4e6) == 0.0
    assert law.amplitude(1e6) == float("inf")


def test_only_ratios_of_the_sweep_count() -> None:
    scaled = {name: f"{2 * float(SWEEP[name].split()[0])} MPa" for name in SWEEP if name.endswith("modulus")}
    law, other = card().strain_dependence, card(**scaled).strain_dependence
    assert law is not None
    assert other is not None
    assert other.stiffening(AMPLITUDES) == pytest.approx(law.stiffening(AMPLITUDES), rel=1e-14)
    assert other.lossiness(AMPLITUDES) == pytest.approx(law.lossiness(AMPLITUDES), rel=1e-14)


def test_the_cards_numbers_hold_at_their_amplitudes() -> None:
    law = card(modulus_amplitude="4 %", loss_amplitude="4 %").strain_dependence
    assert law is not None
    assert law.stiffening(0.04) == 1.0
    assert law.lossiness(0.04) == pytest.approx(1.0, rel=1e-15)
    # With two amplitudes: loss modulus = tan d (at b) x modulus (at a) x lossiness.
    law = card(modulus_amplitude="4 %", loss_amplitude="1 %").strain_dependence
    assert law is not None
    tangent = law.kraus.loss(0.01) / law.kraus.storage(0.01)
    assert law.lossiness(0.07) * tangent * law.kraus.storage(0.04) == pytest.approx(law.kraus.loss(0.07), rel=1e-14)


def test_a_card_at_another_amplitude_is_the_same_compound() -> None:
    rubber = card()
    soft, law = rubber.at_amplitude(0.001), rubber.strain_dependence
    assert law is not None
    assert soft.strain_dependence is not None
    assert rubber.elasticity is not None
    assert soft.elasticity is not None
    assert rubber.shear_modulus is not None
    assert soft.shear_modulus is not None
    factor = float(law.stiffening(0.001))
    assert factor > 2
    assert soft.elasticity.initial_shear_modulus == pytest.approx(factor * 0.8e6, rel=1e-14)
    assert soft.shear_modulus.value == pytest.approx(factor * 0.8e6, rel=1e-14)
    modulus = soft.elasticity.initial_shear_modulus
    for amplitude in (0.001, 0.03, 0.3):
        assert modulus * soft.strain_dependence.stiffening(amplitude) == pytest.approx(
            0.8e6 * law.stiffening(amplitude), rel=1e-14
        )
        assert modulus * soft.strain_dependence.lossiness(amplitude) == pytest.approx(
            0.8e6 * law.lossiness(amplitude), rel=1e-14
        )
    again = soft.at_amplitude(0.1)
    assert again.elasticity is not None
    assert again.elasticity.initial_shear_modulus == pytest.approx(0.8e6, rel=1e-14)
    assert soft.cords == rubber.cords
    assert soft.density == rubber.density


def test_a_card_without_the_table_is_unchanged() -> None:
    rubber = material("nasa-sidewall")
    assert rubber.at_amplitude(1e-3) is rubber
    assert strain_laws({"sidewall": rubber}) == {}
    assert values_read("fem", {"sidewall": rubber}) == values_read("barrel", {"sidewall": rubber})


def test_only_the_footprint_reads_the_table() -> None:
    rubber = card()
    assert rubber.strain_dependence in values_read("fem", {"sidewall": rubber})["sidewall"]
    for law in ("barrel", "arcs", "given"):
        assert rubber.strain_dependence not in values_read(law, {"sidewall": rubber}).get("sidewall", ())


@pytest.mark.parametrize(
    ("changes", "field", "words"),
    [
        ({"small_strain_modulus": "0.9 MPa"}, "small_strain_modulus", "must be more than the modulus at large strain"),
        ({"large_strain_loss_modulus": "0.4 MPa"}, "greatest_loss_modulus", "must be at least the loss modulus"),
        ({"critical_strain": "0 %"}, "critical_strain", "more than 0"),
        ({"exponent": 3}, "exponent", "2"),
        ({"modulus_amplitude": "120 %"}, "modulus_amplitude", "1"),
        ({"small_strain_modulus": "3.5 mm"}, "small_strain_modulus", "not a unit"),
        ({"law": "payne"}, "law", "kraus"),
        ({"critical_strian": "2 %"}, "strain_dependence", "did you mean 'critical_strain'"),
    ],
)
def test_bad_tables_are_errors_that_name_the_field(changes: dict[str, Any], field: str, words: str) -> None:
    with pytest.raises(InputError) as caught:
        card(**changes)
    assert field in str(caught.value.field)
    assert words in str(caught.value)
