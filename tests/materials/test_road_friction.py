"""Friction of a tread on the road, from its card."""

import numpy as np
import pytest

from tyrefem.errors import InputError
from tyrefem.materials.card import MaterialCard, material
from tyrefem.materials.road_friction import RoadFriction

pytestmark = pytest.mark.fast

PEAK = {
    "law": "savkoor", "coefficient": 1.2, "standstill": 0.8, "peak_speed": "2 m/s", "width": 0.4, "at": "30 degC",
    "decade": "20 K", "pressure_exponent": 0.1, "pressure": "3 bar", "source": "estimate: a test",
}  # fmt: skip


def law(**changes: object) -> RoadFriction:
    return RoadFriction.check({name: value for name, value in {**PEAK, **changes}.items() if value is not None})


def test_the_peak_is_at_its_speed_and_moves_a_decade_with_the_temperature() -> None:
    friction, speeds = law(), np.logspace(-4, 4, 8001)
    at_30 = friction(speeds, 3e5, 30.0)
    assert at_30.max() == pytest.approx(1.2)
    assert speeds[at_30.argmax()] == pytest.approx(2.0, rel=2e-3)
    assert speeds[friction(speeds, 3e5, 50.0).argmax()] == pytest.approx(20.0, rel=2e-3)
    assert friction(20.0, 3e5, 50.0) == pytest.approx(1.2)


def test_standstill_and_very_fast_sliding_have_the_same_coefficient() -> None:
    friction = law()
    assert friction(np.array([0.0, 1e-9, 1e9]), 3e5, 30.0) == pytest.approx(0.8, rel=1e-3)


def test_it_falls_with_the_pressure_by_its_power() -> None:
    friction = law()
    assert friction(2.0, 6e5, 30.0) / friction(2.0, 3e5, 30.0) == pytest.approx(2**-0.1)
    constant = RoadFriction.check({"coefficient": 0.9, "source": "estimate: a test"})
    assert constant(np.array([0.0, 5.0]), 1e5, 80.0).tolist() == [0.9, 0.9]


@pytest.mark.parametrize(
    ("changes", "field", "message"),
    [
        ({"width": None}, "width", "is missing: the law 'savkoor' needs it"),
        ({"law": "constant"}, "standstill", "is only for the law 'savkoor'"),
        ({"decade": None}, "decade", "belong together"),
        ({"standstill": 1.3}, "standstill", "at most the coefficient of the peak"),
        ({"coefficient": -1}, "coefficient", "more than 0"),
        ({"peek_speed": "1 m/s"}, None, "did you mean 'peak_speed'"),
    ],
)
def test_a_wrong_table_is_one_clear_error(changes: dict[str, object], field: str | None, message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        law(**changes)
    assert caught.value.field == field


def test_a_shipped_tread_has_it_and_the_card_reads_it() -> None:
    card = material("rubber-tread-passenger")
    assert isinstance(card, MaterialCard)
    assert card.friction is not None
    assert 0.5 < float(card.friction(1.0, 3e5, 30.0)) < 1.5
