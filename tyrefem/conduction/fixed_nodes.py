"""Unknowns whose temperature is prescribed."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.datum import Datum
from tyrefem.conduction.operators import Surface

Array = NDArray[Any]


class FixedNodes:
    """Prescribed unknowns: a node of several boundaries gets the temperature of the first."""

    def __init__(self, size: int, fixed: list[tuple[int, Surface, Datum]]) -> None:
        owner = np.full(size, -1)
        self._data: list[tuple[int, Datum, Array]] = []
        for slot, surface, value in fixed:
            mine = owner[surface.dofs] < 0
            owner[surface.dofs[mine]] = slot
            self._data.append((slot, value, mine))
        parts = [surface.dofs[mine] for (_, surface, _), (_, _, mine) in zip(fixed, self._data, strict=True)]
        self.dofs = np.concatenate(parts) if parts else np.zeros(0, np.int64)
        self.free = np.flatnonzero(owner < 0)
        ends = np.cumsum([0, *(part.size for part in parts)])
        self.parts = [(slot, slice(a, b)) for (slot, _, _), a, b in zip(self._data, ends[:-1], ends[1:], strict=True)]
        self.constant = all(value.constant for _, value, _ in self._data)

    def __call__(self, t: float) -> Array:
        """Prescribed temperatures at time t, in the order of `dofs`."""
        if not self._data:
            return np.zeros(0)
        return np.concatenate([np.broadcast_to(value(t), mine.shape)[mine] for _, value, mine in self._data])
