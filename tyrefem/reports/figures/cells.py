"""Elements cut into straight-sided linear cells on the unknowns' own points, for drawing and for writing."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

#: Local unknowns of an element -> its linear cells, by (number of unknowns); anticlockwise as the element.
_PARTS: dict[int, tuple[tuple[int, ...], ...]] = {
    3: ((0, 1, 2),),
    4: ((0, 1, 2, 3),),
    6: ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)),
    9: ((0, 4, 8, 7), (4, 1, 5, 8), (8, 5, 2, 6), (7, 8, 6, 3)),
}


def parts_of(unknowns: int) -> tuple[tuple[int, ...], ...]:
    """Local unknowns of the linear cells that an element of so many unknowns is cut into."""
    return _PARTS[unknowns]


def linear_cells(operators: Any, elements: Array | None = None) -> tuple[Array, Array]:
    """Cells (3 or 4, n), numbers of unknowns, and the element (n,) that each is part of.

    Parameters
    ----------
    operators : the conduction problem's, P1 or P2. elements : only these; all by default.
    """
    dofs = np.asarray(operators.element_dofs)
    chosen = np.arange(dofs.shape[1]) if elements is None else np.asarray(elements)
    parts = parts_of(dofs.shape[0])
    cells = np.concatenate([dofs[list(part)][:, chosen] for part in parts], axis=1)
    return cells, np.tile(chosen, len(parts))


def triangles(operators: Any, elements: Array | None = None) -> tuple[Array, Array]:
    """As `linear_cells`, quadrilaterals cut in two: (n, 3), and the element of each."""
    cells, parent = linear_cells(operators, elements)
    if len(cells) == 3:
        return cells.T, parent
    return np.concatenate([cells[[0, 1, 2]], cells[[0, 2, 3]]], axis=1).T, np.tile(parent, 2)
