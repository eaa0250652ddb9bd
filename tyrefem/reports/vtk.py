"""VTK files of a run for ParaView: one .vtu per saved time, and a .pvd that lists their times.

The section lies in the plane of the screen: x = z (axial), y = r (up), so the wheel's axis is the x axis; metres.
P2 elements become quadratic cells; the ring is cut into linear cells on all their nodes, in single precision.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import escape

import numpy as np
from numpy.typing import NDArray

from tyrefem.output import atomic_path

if TYPE_CHECKING:
    from tyrefem.simulation.result import ResultData

Array = NDArray[Any]

#: Unknowns of an element -> (VTK cell, reversed order of its nodes, because r up and z right mirrors the plane).
_CELLS: dict[int, tuple[str, tuple[int, ...]]] = {
    3: ("triangle", (0, 2, 1)),
    4: ("quad", (0, 3, 2, 1)),
    6: ("triangle6", (0, 2, 1, 5, 4, 3)),
    9: ("quad9", (0, 3, 2, 1, 7, 6, 5, 4, 8)),
}
SEGMENTS = 72


def write_series(result: ResultData, folder: Path, *, revolved: bool = False, segments: int = SEGMENTS) -> Path:
    """Write ``<name>.pvd`` and ``<name>_0000.vtu`` ...; return the path of the .pvd.

    Point data ``temperature_degC``; cell data ``region`` and ``zone`` (numbers, named by the field data
    ``region_id_<name>`` and ``zone_id_<name>`` and in the .pvd), ``heat_source_W_m3`` and ``strain_energy_J_m3``
    (means of the cell's nodes, from the cell's own side of a border).

    Parameters
    ----------
    revolved : also ``<name>-revolved.pvd``: the modelled section turned into a closed ring of ``segments`` hexahedra
        or wedges per cell (a half section gives half a tyre: ParaView's Reflect filter shows the other).

    Raises
    ------
    InputError : the folder cannot be written.
    """
    name = file_name(result.study.name)
    folder = Path(folder)
    if revolved:
        _write(result, folder, f"{name}-revolved", _Ring(result, segments))
    return _write(result, folder, name, _Plane(result))


def file_name(study: str) -> str:
    """The stem of a study's VTK files: its name, without characters that a file name may not have."""
    return re.sub(r"[^\w.-]+", "-", study).strip("-.") or "tyre"


def file_names(study: str) -> list[str]:
    """Names of the files that `write_series` may write."""
    name = file_name(study)
    return [f"{stem}{rest}" for stem in (name, f"{name}-revolved") for rest in (".pvd", f"_{4 * '[0-9]'}*.vtu")]


def saved_times(result: ResultData) -> list[int]:
    """Indices of the reading times whose fields are written; for an interrupted run, also the last time reached."""
    times = result.times
    near = [int(np.argmin(np.abs(times - t))) for t in result.field_times if t <= times[-1] + 1e-6]
    if result.history.interrupted:
        near.append(len(times) - 1)
    return sorted(set(near))


class _Plane:
    """The section in its plane."""

    def __init__(self, result: ResultData) -> None:
        operators = result.tyre.problem.operators
        dofs = np.asarray(operators.element_dofs)
        self.cell, order = _CELLS[len(dofs)]
        r, z = operators.points
        self.points = np.stack([z, r, np.zeros_like(r)], axis=1)
        self.cells = np.ascontiguousarray(dofs[list(order)].T.astype(np.int32))

    def at_points(self, values: Array) -> Array:
        return values

    def at_cells(self, values: Array) -> Array:
        return values


class _Ring:
    """The section revolved about the wheel's axis, from the screen's plane towards the viewer."""

    def __init__(self, result: ResultData, segments: int) -> None:
        from tyrefem.reports.figures.cells import linear_cells

        operators = result.tyre.problem.operators
        cells, self.parent = linear_cells(operators)
        self.segments, size = segments, operators.size
        r, z = operators.points
        angle = 2 * np.pi * np.arange(segments)[:, None] / segments
        axial = np.broadcast_to(z, (segments, size))
        points = np.stack([axial, r * np.cos(angle), r * np.sin(angle)], axis=-1).reshape(-1, 3)
        self.points = points.astype(np.float32)
        # In the direction of rotation, a hexahedron's first face points inwards, a wedge's outwards.
        turned = cells[::-1].T if len(cells) == 4 else cells.T
        here = turned[None] + size * np.arange(segments)[:, None, None]
        there = turned[None] + size * (np.arange(1, segments + 1) % segments)[:, None, None]
        self.cell = "hexahedron" if len(cells) == 4 else "wedge"
        self.cells = np.concatenate([here, there], axis=2).reshape(-1, 2 * len(cells)).astype(np.int32)

    def at_points(self, values: Array) -> Array:
        return np.tile(values.astype(np.float32), self.segments)

    def at_cells(self, values: Array) -> Array:
        kind = np.int32 if values.dtype == np.int32 else np.float32
        return np.tile(values[self.parent].astype(kind), self.segments)


def _write(result: ResultData, folder: Path, name: str, shape: _Plane | _Ring) -> Path:
    import meshio

    regions, zones, names = _numbers(result)
    constant = {"region": [shape.at_cells(regions)], "zone": [shape.at_cells(zones)]}
    entries = []
    for number, i in enumerate(saved_times(result)):
        file = folder / f"{name}_{number:04d}.vtu"
        source, energy = _cell_means(result, i)
        mesh = meshio.Mesh(
            shape.points,
            [(shape.cell, shape.cells)],
            point_data={"temperature_degC": shape.at_points(np.asarray(result.history.values[i]))},
            cell_data=constant
            | {"heat_source_W_m3": [shape.at_cells(source)], "strain_energy_J_m3": [shape.at_cells(energy)]},
        )
        with atomic_path(file) as temporary:
            meshio.write(temporary, mesh, file_format="vtu", binary=True)
            add_fields(temporary, {**names, "TimeValue": float(result.times[i])})
        entries.append(f'    <DataSet timestep="{float(result.times[i])!r}" group="" part="0" file="{file.name}"/>')
    return _write_collection(result, folder / f"{name}.pvd", names, entries)


def _write_collection(result: ResultData, path: Path, names: dict[str, int], entries: list[str]) -> Path:
    table = "\n".join(f"    {name} = {number}" for name, number in names.items())
    # A comment may hold neither markup nor two hyphens in a row.
    about = re.sub(r"-(?=-)|-$", "- ", escape(result.study.title))
    stopped = (
        "\n  The run was interrupted: its last time is not the end of the drive." if result.history.interrupted else ""
    )
    text = f"""<?xml version="1.0"?>
<!-- {about}
  x = axial position z, y = radius r (the wheel's axis is the x axis), metres; time in s.
  temperature_degC at points; heat_source_W_m3 and strain_energy_J_m3 (per cycle) in cells; numbers of the names:
{table}{stopped}
-->
<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">
  <Collection>
{chr(10).join(entries)}
  </Collection>
</VTKFile>
"""
    with atomic_path(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
    return path


def _numbers(result: ResultData) -> tuple[Array, Array, dict[str, int]]:
    """Region and zone of every element, counted from 1 (0: none), and the numbers' names."""
    mesh, section = result.tyre.mesh.mesh, result.study.section
    names: dict[str, int] = {}
    arrays = []
    for kind, parts in (("region", section.regions), ("zone", [zone.name for zone in result.tyre.schedule.zones])):
        numbers = np.zeros(mesh.nelements, dtype=np.int32)
        for number, part in enumerate(parts, start=1):
            numbers[np.asarray(mesh.subdomains[part])] = number
            names[f"{kind}_id_{part}"] = number
        arrays.append(numbers)
    return arrays[0], arrays[1], names


def _cell_means(result: ResultData, i: int) -> tuple[Array, Array]:
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


def add_fields(path: Path, fields: Mapping[str, float]) -> None:
    """Add field data, which meshio does not write, to a .vtu file."""
    rows = []
    for name, value in fields.items():
        kind = "Int32" if isinstance(value, int) else "Float64"
        rows.append(f'<DataArray type="{kind}" Name="{name}" NumberOfTuples="1" format="ascii">{value!r}</DataArray>')
    start, tag, rest = path.read_text(encoding="utf-8").partition("<UnstructuredGrid>")
    path.write_text(f"{start}{tag}\n<FieldData>{''.join(rows)}</FieldData>\n{rest}", encoding="utf-8")
