"""Rolling takes the coefficient of friction from the tread's card."""

from __future__ import annotations

import numpy as np
import pytest

from tyrefem import study
from tyrefem.mechanics.footprint.press import press
from tyrefem.mechanics.rolling.roll import FRICTION, tread_friction

COARSE = {"mesh.size": "16 mm", "mechanics.motion": "linear"}


def test_the_card_of_the_region_on_the_road_decides() -> None:
    pressed = press(study("passenger-205-55r16", COARSE))
    law = tread_friction(pressed)
    assert callable(law)
    card, temperature = pressed.study.materials["tread"].friction, pressed.study.card.drive.initial
    speeds, pressures = np.array([0.0, 0.1, 3.0]), np.array([1e5, 3e5, 6e5])
    assert law(speeds, pressures) == pytest.approx(card(speeds, pressures, temperature))


def test_without_the_table_it_is_the_estimate() -> None:
    pressed = press(study("nasa-22x5.5-8pr", {"mesh.size": "12 mm", "mechanics.motion": "linear"}))
    assert tread_friction(pressed) == FRICTION
