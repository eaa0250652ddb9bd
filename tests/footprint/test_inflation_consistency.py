"""The harmonic n = 0 is the derivative of the inflation. (Belongs to tests/footprint once tyrefem/solid is there.)"""

from __future__ import annotations

import numpy as np
import pytest

from tyrefem.footprint.elements import SectionElements
from tyrefem.footprint.harmonics import Harmonics
from tyrefem.meshing import build
from tyrefem.solid.inflation import inflate
from tyrefem.studies import study


def test_harmonic_zero_is_the_slope_of_the_inflation() -> None:
    tyre = study("nasa-22x5.5-8pr")
    mesh = build(tyre.section, size=8e-3, through=1)
    pressure, step = 5e5, 2e3
    low, middle, high = (inflate(tyre, p, mesh) for p in (pressure - step, pressure, pressure + step))
    places = [SectionElements(found.state.mesh).nodes for found in (low, high)]
    slope = (places[1] - places[0]) / (2 * step)
    harmonics = Harmonics(middle.state)
    u = harmonics.inflated_by(1.0).reshape(-1, 3)
    at = u[:, :2].T
    print(np.abs(at - slope).max() / np.abs(slope).max())
    assert at == pytest.approx(slope, abs=0.02 * np.abs(slope).max())
