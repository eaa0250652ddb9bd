"""Products of a matrix that all variants share with the arrays of the variants."""

from __future__ import annotations

import numpy as np
import pytest

from tyrefem.reduced.shared_product import shared_product


@pytest.mark.parametrize("shapes", [1, 3])
@pytest.mark.parametrize("by_sample", [False, True])
def test_it_is_the_product_of_every_variant(shapes: int, by_sample: bool) -> None:
    random = np.random.default_rng(1)
    matrix = random.normal(size=(shapes, 4, 5))
    arrays = random.normal(size=(5, 3, 2)).transpose(1, 0, 2) if by_sample else random.normal(size=(3, 5, 2))
    expected = [(matrix[row] if shapes > 1 else matrix[0]) @ arrays[row] for row in range(3)]
    assert shared_product(matrix, arrays) == pytest.approx(np.array(expected), abs=1e-12)
