"""The footprint's pressure on a rectangular grid of the road, for brush and thermal models that run in real time."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from tyrefem.mechanics.footprint.footprint import Footprint
    from tyrefem.mechanics.rolling.rolled import RolledTyre

Array = NDArray[np.float64]
#: Side of a cell, m.
CELL = 5e-3


@dataclass(frozen=True, eq=False)
class PressureMap:
    """Mean contact pressure of square cells on the road.

    Parameters
    ----------
    x, y : middles of the cells, m: forward and left of the contact centre. pressure : (len(x), len(y)), Pa.

    The sum of pressure times ``cell``^2 is the load.
    """

    x: Array
    y: Array
    pressure: Array
    cell: float

    @property
    def load(self) -> float:
        """Sum of pressure times area, N."""
        return float(self.pressure.sum() * self.cell**2)

    def rows(self) -> Iterator[list[Any]]:
        """Heading and rows of a table: x_m, y_m, pressure_Pa; y runs fastest."""
        yield ["x_m", "y_m", "pressure_Pa"]
        for x, line in zip(self.x, self.pressure, strict=True):
            for y, value in zip(self.y, line, strict=True):
                yield [round(float(x), 6), round(float(y), 6), float(f"{value:.9g}")]


def pressed_map(footprint: Footprint, cell: float = CELL) -> PressureMap:
    """The map of a pressed tyre: both halves of the footprint, mirrored where one was solved.

    The search for a load ends within some 1e-6 of it; the map has the footprint's load.
    """
    grid = footprint.grid
    z = grid.tread.places[1]
    x, _, across = grid.places(footprint.displacement, 0.0)
    if footprint.pressing.tread.half:
        across = across + grid.axial(footprint.amplitudes)
    ahead, y = (values.reshape(grid.n_angles, -1) for values in (x, across))
    forces = footprint.normal_forces
    low, high = _strips(z, grid.tread.widths[1], grid.tread.grooves)
    ahead, y, forces = (
        np.concatenate([sign * values[:0:-1], values])
        for sign, values in ((-1.0, ahead), (1.0, y), (1.0, forces))
    )  # fmt: skip
    low, high = y + (low - z), y + (high - z)
    if footprint.pressing.tread.half:
        ahead, forces = np.hstack([ahead, ahead]), np.hstack([forces, forces])
        low, high = np.hstack([low, -high]), np.hstack([high, -low])
    return _on_cells(ahead, low, high, forces * (footprint.load / forces.sum() if forces.any() else 1.0), cell)


def rolled_map(rolled: RolledTyre, cell: float = CELL) -> PressureMap:
    """The map of a tyre that rolls with friction: the forces along the road's normal."""
    shape = rolled.pressure.shape
    x, y, _ = rolled.places
    down = rolled.grid.road.in_road_axes(rolled.vectors.T)[1]
    influence = rolled.grid.influence
    z, grooves = influence.places[1], influence.tread.grooves
    if influence.tread.half:
        grooves = np.vstack([grooves, -grooves[:, ::-1]])
    low, high = _strips(z, influence.lengths, grooves)
    left = y.reshape(shape)
    return _on_cells(x.reshape(shape), left + (low - z), left + (high - z), -down.reshape(shape), cell)


def _strips(z: Array, widths: Array, grooves: Array) -> tuple[Array, Array]:
    """Ends of each node's strip across: the tread between two grooves, shared as the nodes' tributary widths."""
    cuts = [
        node + 1
        for node in range(len(z) - 1)
        if any(z[node] <= start + 1e-6 and end - 1e-6 <= z[node + 1] for start, end in grooves)
    ]
    low, high = np.empty_like(z), np.empty_like(z)
    for part in np.split(np.arange(len(z)), cuts):
        ends = np.concatenate([[0.0], np.cumsum(widths[part])]) / widths[part].sum()
        places = z[part[0]] + ends * (z[part[-1]] - z[part[0]])
        low[part], high[part] = places[:-1], places[1:]
    return low, high


def _on_cells(x: Array, low: Array, high: Array, forces: Array, cell: float) -> PressureMap:
    """Forces at points (a, m) on cells: a hat between the neighbours along x, even across its strip.

    Every force is given to the cells in whole, so the sum over the cells is the sum of the forces.
    """
    order = np.argsort(x, axis=0, kind="stable")
    x, low, high, forces = (np.take_along_axis(values, order, axis=0) for values in (x, low, high, forces))
    loaded = forces != 0
    before = np.vstack([2 * x[:1] - x[1:2], x[:-1]])
    after = np.vstack([x[1:], 2 * x[-1:] - x[-2:-1]])
    points = [values[loaded] for values in (before, x, after, low, high, forces)]
    if not loaded.any():
        return PressureMap(np.zeros(1), np.zeros(1), np.zeros((1, 1)), cell)
    begin, middle, end, left, right, force = points
    along = _edges(float(begin.min()), float(end.max()), cell)
    across = _edges(float(left.min()), float(right.max()), cell)
    shares_x = np.diff(_below_hat(along, begin, middle, end), axis=1)
    width = np.maximum(right - left, 1e-12)
    shares_y = np.diff(np.clip((across[None] - left[:, None]) / width[:, None], 0.0, 1.0), axis=1)
    pressure = np.einsum("k,ki,kj->ij", force, shares_x, shares_y, optimize=True) / cell**2
    return PressureMap(0.5 * (along[1:] + along[:-1]), 0.5 * (across[1:] + across[:-1]), pressure, cell)


def _edges(low: float, high: float, cell: float) -> Array:
    """Edges of cells about 0 that hold an interval."""
    return np.asarray(cell * np.arange(np.floor(low / cell + 1e-9), np.ceil(high / cell - 1e-9) + 1))


def _below_hat(edges: Array, begin: Array, middle: Array, end: Array) -> Array:
    """(k, edges) share of a triangle from ``begin`` over ``middle`` to ``end`` that lies below each edge."""
    u = np.clip(edges[None], begin[:, None], end[:, None])
    whole = np.maximum(end - begin, 1e-12)[:, None]
    rising = (u - begin[:, None]) ** 2 / (whole * np.maximum(middle - begin, 1e-12)[:, None])
    falling = 1.0 - (end[:, None] - u) ** 2 / (whole * np.maximum(end - middle, 1e-12)[:, None])
    return np.asarray(np.where(u <= middle[:, None], rising, falling))
