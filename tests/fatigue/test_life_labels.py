"""Labels of the places that fail first lead to the side on which they lie."""

from __future__ import annotations

import numpy as np
import pytest

from tyrefem.fatigue.places import FailurePlace
from tyrefem.reports.figures.life import place_label

pytestmark = pytest.mark.fast


@pytest.mark.parametrize(("z", "half", "x"), [(-0.05, False, -50.0), (0.05, False, 50.0), (-0.05, True, 50.0)])
def test_a_label_is_on_the_side_of_its_place(z: float, half: bool, x: float) -> None:
    place = object.__new__(FailurePlace)
    for name, value in {"z": z, "r": 0.3, "km": 944.0, "temperature": 80.0}.items():
        object.__setattr__(place, name, value)
    label = place_label(1, place, half=half)
    assert (label.text, label.bold) == ("1  944 km, 80 °C", True)
    assert np.allclose([label.x, label.y], [x, 300.0])
