"""A banded factor solved block by block."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import cholesky_banded

from tyrefem.conduction.linear_solver import BlockFactor

pytestmark = pytest.mark.fast


@pytest.mark.parametrize(("size", "width"), [(10, 3), (24, 24), (100, 1), (131, 30), (240, 40)])
def test_solution_leaves_no_residual(size: int, width: int) -> None:
    rng = np.random.default_rng(0)
    band = np.zeros((width + 1, size))
    for distance in range(1, min(width, size - 1) + 1):
        band[distance, : size - distance] = -rng.random(size - distance)
    band[0] = 2.0 * width + 1.0
    A = np.diag(band[0])
    for distance in range(1, min(width, size - 1) + 1):
        part = np.diag(band[distance, : size - distance], -distance)
        A += part + part.T
    right = rng.standard_normal((size, 7))
    solution = BlockFactor(np.asfortranarray(cholesky_banded(band, lower=True))).solve(right)
    assert np.abs(A @ solution - right).max() < 1e-12 * np.abs(A).sum(axis=1).max()
