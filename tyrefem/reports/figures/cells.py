"""Elements cut into straight-sided linear cells between the points of the unknowns, for pictures and files."""

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
    """Local unknowns of the linear cells of an element with ``unknowns`` unknowns."""
    return _PARTS[unknowns]


def linear_cells(operators: Any, elements: Array | None = None) -> tuple[Array, Array]:
    """Cells (3 or 4, n) as indices of unknowns, and the element (n,) of each cell.

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
    """The cells of `linear_cells` as triangles (n, 3), quadrilaterals cut in two, and the element of each."""
    cells, parent = linear_cells(operators, elements)
    if len(cells) == 3:
        return cells.T, parent
    return np.concatenate([cells[[0, 1, 2]], cells[[0, 2, 3]]], axis=1).T, np.tile(parent, 2)
