"""The harmonic n = 0 is the derivative of the inflation."""

from __future__ import annotations

import numpy as np
import pytest

from tyrefem.api import study
from tyrefem.geometry.meshing import build
from tyrefem.mechanics.footprint.elements import SectionElements
from tyrefem.mechanics.footprint.harmonics import Harmonics
from tyrefem.mechanics.solid.inflation import inflate


@pytest.mark.parametrize(
    ("name", "size", "pressure"), [("nasa-22x5.5-8pr", 10e-3, 5e5), ("passenger-205-55r16", 20e-3, 2.1e5)]
)
def test_harmonic_zero_is_the_slope_of_the_inflation(name: str, size: float, pressure: float) -> None:
    tyre = study(name)
    mesh = build(tyre.section, size=size, through=1)
    step = pressure / 500
    low, middle, high = (inflate(tyre, p, mesh) for p in (pressure - step, pressure, pressure + step))
    # The bead lies on the rim's flange, so that the flange's stiffness takes part.
    assert all(flange.pressure(middle.places).max() > 1e5 for flange in middle.body.flanges)
    places = [SectionElements(inflated.state.mesh).nodes for inflated in (low, high)]
    slope = (places[1] - places[0]) / (2 * step)
    u = Harmonics(middle.state).inflated_by(1.0).reshape(-1, 3)
    np.testing.assert_allclose(u[:, :2].T, slope, atol=0.02 * np.abs(slope).max())
