"""A film given as a number and the same film given point by point do the same."""

from __future__ import annotations

import numpy as np
import pytest
import skfem

from tyrefem.conduction import Conduction, Film, Material, Reservoir

pytestmark = pytest.mark.fast


def history(h, sink):
    mesh = skfem.MeshTri().refined(3).with_boundaries({"edge": lambda x: x[0] < 1e-9})
    mesh = mesh.with_subdomains({"all": lambda x: x[0] > -1})
    problem = Conduction(
        mesh,
        {"all": Material(0.3, 2.0e3)},
        {"edge": Film(h, sink)},
        axisymmetric=False,
        element="P1",
        reservoirs={"gas": Reservoir(500.0, 80.0)},
    )
    return problem.transient(np.linspace(0.0, 1000.0, 5), 20.0, 1e-3)


@pytest.mark.parametrize("sink", [60.0, "gas"])
def test_number_and_points_agree(sink):
    even = history(lambda x, t: 5.0 + 0.01 * t, sink)
    points = history(lambda x, t: np.full(x.shape[1], 5.0 + 0.01 * t), sink)
    assert np.allclose(even.reservoirs["gas"], points.reservoirs["gas"], rtol=0, atol=1e-9)
    assert np.ptp(even.values[-1]) > 1.0
    assert np.allclose(even.values, points.values, rtol=0, atol=1e-9)
