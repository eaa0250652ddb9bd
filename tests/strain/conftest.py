"""What several files of tests of the strain cycle share."""

from __future__ import annotations

import pytest
from bias_tyre import bias

from tyrefem.mechanics.finite_elements import FiniteElements
from tyrefem.mechanics.solved_cases import KnotSolver


@pytest.fixture(scope="session")
def bias_cycle() -> FiniteElements:
    """The strain cycle at 1000 lbf of a study that says nothing of its motion."""
    solver = KnotSolver(bias())
    solved = solver.cycle(0, solver.case(0, 0.0))
    assert isinstance(solved, FiniteElements)
    return solved
