"""Cords that inflation compresses: their tension over a revolution in linear motion."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tyrefem.mechanics.footprint.cord_cycle import cord_cycles
from tyrefem.mechanics.solid.cords import CordLayer

pytestmark = pytest.mark.fast


@pytest.mark.parametrize("inflated", [0.99, 1.002])
@pytest.mark.parametrize("cord", [1e4, None])
def test_the_tension_of_a_compressed_cord_is_the_derivative_of_its_law(inflated: float, cord: float | None) -> None:
    """Beyond its buckling limit a cord is far softer than E A."""
    small, ones = 1e-7, np.ones((1, 1))
    layer = CordLayer(0 * ones, np.stack([ones, 0 * ones]), 3e8 * ones, cord_stiffness=cord, limit=7.5e5)
    deformation = np.eye(3)[..., None, None] * ones
    deformation[2, 2] = inflated
    body = SimpleNamespace(
        parts={"belt": SimpleNamespace(cords=(layer,))},
        mesh=SimpleNamespace(subdomains={"belt": [0]}),
        rings=SimpleNamespace(points=np.zeros((2, 1, 1))),
    )
    tyre: Any = SimpleNamespace(body=body, deformation=deformation)
    cycle: Any = SimpleNamespace(
        footprint=SimpleNamespace(balanced=None), along=lambda d, angles, members: np.full((1, 1, len(angles)), small)
    )
    (computed,) = cord_cycles(tyre, cycle, count=3)
    law = layer.stress_in_layer if cord is None else layer.tension
    change = float((law(deformation * (1 + small)) - law(deformation))[0, 0])
    assert computed.plus - computed.inflated == pytest.approx(change, rel=1e-4)
