"""VTK files of a run for ParaView: a .vtu per saved time, a .pvd that lists their times, a script that shows them.

Their points and cells are those of `tyrefem.reports.grids`: x = z (axial), y = r (up); metres.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tyrefem.output import atomic_path
from tyrefem.reports.grids import SEGMENTS, Plane, Ring, cell_means, numbers
from tyrefem.reports.paraview import script
from tyrefem.reports.vtu import VtuFile, comment
from tyrefem.reports.words import file_stem

if TYPE_CHECKING:
    from tyrefem.simulation.result import ResultData


def write_series(result: ResultData, folder: Path, *, revolved: bool = False, segments: int = SEGMENTS) -> Path:
    """Write ``<name>.pvd``, ``<name>_0000.vtu`` ... and ``<name>.py`` for ParaView; return the path of the .pvd.

    Point data ``temperature_degC``; cell data ``region`` and ``zone`` (numbers from 1, named in a comment of every
    file), ``heat_source_W_m3`` and ``strain_energy_J_m3``
    (means of the cell's nodes, from the cell's own side of a border).

    Parameters
    ----------
    revolved : also ``<name>-revolved.pvd``: the modelled section turned into a closed ring of ``segments`` hexahedra
        or wedges per cell (a half section gives half a tyre: the script shows the other by reflection).

    Raises
    ------
    InputError : the folder cannot be written.
    """
    name = file_stem(result.study.name, "tyre")
    folder = Path(folder)
    if revolved:
        ring = Ring(result, segments)
        _write(result, folder, f"{name}-revolved", ring, VtuFile(ring.points, ring.cells, ring.cell, segments))
    plane = Plane(result)
    return _write(result, folder, name, plane, VtuFile(plane.points, plane.cells, plane.cell))


def file_names(study: str) -> list[str]:
    """Names of the files that `write_series` may write."""
    name = file_stem(study, "tyre")
    ends = (".pvd", ".py", f"_{4 * '[0-9]'}*.vtu")
    return [f"{stem}{rest}" for stem in (name, f"{name}-revolved") for rest in ends]


def saved_times(result: ResultData) -> list[int]:
    """Indices of the reading times whose fields are written; for an interrupted run, also the last time reached."""
    times = result.times
    near = [int(np.argmin(np.abs(times - t))) for t in result.field_times if t <= times[-1] + 1e-6]
    if result.history.interrupted:
        near.append(len(times) - 1)
    return sorted(set(near))


def _write(result: ResultData, folder: Path, name: str, shape: Plane | Ring, grid: VtuFile) -> Path:
    regions, zones, names = numbers(result)
    constant = {"region": shape.at_cells(regions), "zone": shape.at_cells(zones)}
    entries = []
    for number, i in enumerate(saved_times(result)):
        file, time = folder / f"{name}_{number:04d}.vtu", float(result.times[i])
        source, energy = cell_means(result, i)
        grid.write(
            file,
            {"temperature_degC": shape.at_points(np.asarray(result.history.values[i]))},
            {
                **constant,
                "heat_source_W_m3": shape.at_cells(source),
                "strain_energy_J_m3": shape.at_cells(energy),
            },
            names,
            time,
        )
        entries.append(f'    <DataSet timestep="{time!r}" group="" part="0" file="{file.name}"/>')
    shown = script(result, name, saved_times(result), solid=isinstance(shape, Ring))
    with atomic_path(folder / f"{name}.py") as temporary:
        temporary.write_text(shown, encoding="utf-8")
    return _write_collection(result, folder / f"{name}.pvd", names, entries)


def _write_collection(result: ResultData, path: Path, names: dict[str, list[str]], entries: list[str]) -> Path:
    table = "\n".join(
        f"    {kind} {number} = {comment(part)}"
        for kind, parts in names.items()
        for number, part in enumerate(parts, start=1)
    )
    about = comment(result.study.title)
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
