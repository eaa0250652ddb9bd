"""The section, or its ring, as points and cells for VTK files and pyvista.

The section lies in the plane of the screen: x = z (axial), y = r (up), so the wheel's axis is the x axis; metres.
P2 elements become quadratic cells; the ring is cut into linear cells on all their nodes, in single precision.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from tyrefem.simulation.result import ResultData

Array = NDArray[Any]

#: Unknowns of an element -> (VTK cell, its VTK number, order of its nodes: r up and z right mirror the plane).
_CELLS: dict[int, tuple[str, int, tuple[int, ...]]] = {
    3: ("triangle", 5, (0, 2, 1)),
    4: ("quad", 9, (0, 3, 2, 1)),
    6: ("triangle6", 22, (0, 2, 1, 5, 4, 3)),
    9: ("quad9", 28, (0, 3, 2, 1, 7, 6, 5, 4, 8)),
}
#: Cells round the wheel.
SEGMENTS = 72


class Plane:
    """The section in its plane: ``points`` (n, 3), ``cells`` (m, nodes), their VTK number ``kind``."""

    def __init__(self, result: ResultData) -> None:
        operators = result.tyre.problem.operators
        dofs = np.asarray(operators.element_dofs)
        self.cell, self.kind, order = _CELLS[len(dofs)]
        r, z = operators.points
        self.points = np.stack([z, r, np.zeros_like(r)], axis=1)
        self.cells = np.ascontiguousarray(dofs[list(order)].T.astype(np.int32))

    def at_points(self, values: Array) -> Array:
        """Values (n,) of the section's unknowns at the points."""
        return values.copy()

    def at_cells(self, values: Array) -> Array:
        """Values (n,) of the section's elements in the cells."""
        return values


class Ring:
    """The section revolved about the wheel's axis, from the screen's plane towards the viewer."""

    def __init__(self, result: ResultData, segments: int = SEGMENTS) -> None:
        from tyrefem.reports.figures.cells import linear_cells

        operators = result.tyre.problem.operators
        cells, self.parent = linear_cells(operators)
        self.segments, size = segments, operators.size
        r, z = operators.points
        angle = 2 * np.pi * np.arange(segments)[:, None] / segments
        axial = np.broadcast_to(z, (segments, size))
        points = np.stack([axial, r * np.cos(angle), r * np.sin(angle)], axis=-1).reshape(-1, 3)
        self.points = points.astype(np.float32)
        # In the direction of rotation, the first face of VTK's cells points inwards.
        turned = cells[::-1].T
        here = turned[None] + size * np.arange(segments)[:, None, None]
        there = turned[None] + size * (np.arange(1, segments + 1) % segments)[:, None, None]
        self.cell, self.kind = ("hexahedron", 12) if len(cells) == 4 else ("wedge", 13)
        self.cells = np.concatenate([here, there], axis=2).reshape(-1, 2 * len(cells)).astype(np.int32)

    def at_points(self, values: Array) -> Array:
        """Values (n,) of the section's unknowns at the points."""
        return np.tile(values.astype(np.float32), self.segments)

    def at_cells(self, values: Array) -> Array:
        """Values (n,) of the section's elements in the cells."""
        kind = values.dtype if values.dtype.kind in "iu" else np.dtype(np.float32)
        return np.tile(values[self.parent].astype(kind), self.segments)


def numbers(result: ResultData) -> tuple[Array, Array, dict[str, list[str]]]:
    """Region and zone of every element, counted from 1 (0: none), and the names of the numbers by kind."""
    mesh, section = result.tyre.mesh.mesh, result.study.section
    kinds = {"region": list(section.regions), "zone": [zone.name for zone in result.tyre.schedule.zones]}
    arrays = []
    for parts in kinds.values():
        of_elements = np.zeros(mesh.nelements, dtype=np.int32)
        for number, part in enumerate(parts, start=1):
            of_elements[np.asarray(mesh.subdomains[part])] = number
        arrays.append(of_elements)
    return arrays[0], arrays[1], kinds


def cell_means(result: ResultData, i: int) -> tuple[Array, Array]:
    """Heat source, W/m3, and strain energy, J/m3, of every element at ``times[i]``: means over its nodes."""
    operators = result.tyre.problem.operators
    t = float(result.times[i])
    just = t * (1 - 1e-12)
    source, energy = np.zeros(operators.mesh.nelements), np.zeros(operators.mesh.nelements)
    for zone, (nodes, q) in result.heat_source(i).items():
        elements = operators.elements(zone)
        place = np.searchsorted(operators.dofs(zone), operators.element_dofs[:, elements])
        source[elements] = q[place].mean(axis=0)
        energy[elements] = result.tyre.hysteresis[zone].energy_density(nodes, just)[place].mean(axis=0)
    return source, energy


def pyvista_grid(result: ResultData, i: int, *, revolved: bool = False) -> Any:
    """A pyvista ``UnstructuredGrid`` with the data of the VTK files at ``times[i]``; ``revolved``: the whole ring.

    Point data ``temperature_degC``; cell data ``region``, ``zone``, ``heat_source_W_m3`` and ``strain_energy_J_m3``;
    field data ``region_names`` and ``zone_names``, the first name for number 1.
    """
    import pyvista

    shape: Plane | Ring = Ring(result) if revolved else Plane(result)
    regions, zones, names = numbers(result)
    source, energy = cell_means(result, i)
    grid = pyvista.UnstructuredGrid({shape.kind: shape.cells}, shape.points)
    grid.point_data["temperature_degC"] = shape.at_points(np.asarray(result.history.values[i]))
    grid.cell_data["region"], grid.cell_data["zone"] = shape.at_cells(regions), shape.at_cells(zones)
    grid.cell_data["heat_source_W_m3"] = shape.at_cells(source)
    grid.cell_data["strain_energy_J_m3"] = shape.at_cells(energy)
    for kind, parts in names.items():
        grid.field_data[f"{kind}_names"] = np.array(parts)
    grid.field_data["TimeValue"] = np.array([float(result.times[i])])
    grid.set_active_scalars("temperature_degC")
    return grid
