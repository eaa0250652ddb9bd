"""Files of `tyrefem press`: numbers, tables, pictures, and the whole pressed tyre as a VTK file for ParaView."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.interruption import keeping
from tyrefem.output import atomic_folder, atomic_path, write_json
from tyrefem.reports.figures.cells import parts_of
from tyrefem.reports.vtk import add_fields

if TYPE_CHECKING:
    from tyrefem.mechanics.footprint.cord_cycle import CordCycle
    from tyrefem.mechanics.footprint.press import Pressed
    from tyrefem.reports.press_places import CyclePlace

Array = NDArray[Any]


#: Steps of the angle, rad, under and near the footprint and opposite to it.
FINE, COARSE = np.radians(1.0), np.radians(6.0)


#: Above this number of points, each nine-node element becomes one hexahedron per angular step instead of four.
MOST_POINTS = 450_000


#: Number of angles whose strains are computed together.
AT_ONCE = 24


def wheel_angles(near: float) -> Array:
    """Angles from -pi to below pi, rad, symmetric about 0: steps of 1 degree up to ``near``, growing to 6 beyond.

    >>> angles = wheel_angles(0.3)
    >>> bool(np.allclose(angles[1:], -angles[:0:-1])), round(float(np.degrees(np.diff(angles).max())), 1) <= 6.0
    (True, True)
    """
    angles, step = [0.0], FINE
    while angles[-1] + step < np.pi - 0.5 * step:
        angles.append(angles[-1] + step)
        if angles[-1] > near:
            step = min(1.2 * step, COARSE)
    side = np.array(angles)
    return np.concatenate([[-np.pi], -side[:0:-1], side])


@dataclass(frozen=True, eq=False)
class RevolvedTyre:
    """Points, cells and fields of the whole deformed tyre; a half section gives both halves.

    x is axial, y up from the wheel's centre, z backwards; the road is below. The hexahedra's node order gives positive
    volumes, unless an element is folded.

    Parameters
    ----------
    pressed : the tyre. most_points : number of points above which elements are not cut in four.
    """

    pressed: Pressed
    most_points: int = MOST_POINTS

    @cached_property
    def angles(self) -> Array:
        """(n,) from the middle of the footprint, rad."""
        grid = self.pressed.footprint.grid
        return wheel_angles(min(1.1 * float(grid.angles[-1]), np.pi))

    @cached_property
    def _section(self) -> tuple[Array, Array, Array, Array, Array]:
        """Nodes (m,), their side (m,) 1 or -1, cells (k, 4) as indices of these, their element (k,) and side (k,)."""
        pressed = self.pressed
        rings, half = pressed.tyre.body.rings, pressed.pressing.tread.half
        nodes = rings.element_nodes
        many = rings.n_nodes * (2 if half else 1) * len(self.angles) > self.most_points
        parts = parts_of(4 if many else 9)
        quads = np.concatenate([nodes[:, list(part)] for part in parts])
        parent = np.tile(np.arange(len(nodes)), len(parts))
        used, local = np.unique(quads, return_inverse=True)
        quads, ones = local.reshape(quads.shape), np.ones(len(used), dtype=int)
        if not half:
            return used, ones, quads, parent, np.ones(len(quads), dtype=int)
        on_plane = np.isin(used, rings.boundary_nodes(pressed.pressing.state.symmetric))
        other = np.where(on_plane, np.arange(len(used)), len(used) + np.cumsum(~on_plane) - 1)
        mirrored = other[quads][:, ::-1]
        sides = np.repeat([1, -1], len(quads))
        return (
            np.concatenate([used, used[~on_plane]]), np.concatenate([ones, -ones[~on_plane]]),
            np.concatenate([quads, mirrored]), np.tile(parent, 2), sides,
        )  # fmt: skip

    @cached_property
    def displacements(self) -> tuple[Array, Array]:
        """Displacement of every point from the tyre without pressure and load, and the points, (n, 3), m."""
        nodes, side, *_ = self._section
        footprint = self.pressed.footprint
        u = footprint.amplitudes.reshape(footprint.harmonics + 1, -1, 3)[:, nodes]
        phase = np.multiply.outer(self.angles, np.arange(footprint.harmonics + 1))
        u_r, u_z = (np.cos(phase) @ u[..., c] for c in (0, 1))
        u_t = np.sin(phase) @ u[..., 2]
        (r0, z0), (r, z) = self.pressed.tyre.body.rings.nodes[:, nodes], self.pressed.tyre.places[:, nodes]
        sin, cos = np.sin(self.angles)[:, None], np.cos(self.angles)[:, None]
        down, behind = (r + u_r) * cos - u_t * sin, -(r + u_r) * sin - u_t * cos
        points = np.stack([side * (z + u_z), -down, behind], axis=-1).reshape(-1, 3)
        free = np.stack([np.broadcast_to(side * z0, down.shape), -r0 * cos, -r0 * sin], axis=-1).reshape(-1, 3)
        return points - free, points

    @cached_property
    def cells(self) -> Array:
        """(n, 8) hexahedra between neighbouring angles."""
        nodes, _, quads, *_ = self._section
        size, count = len(nodes), len(self.angles)
        turned = quads[:, ::-1]
        here = turned[None] + size * np.arange(count)[:, None, None]
        there = turned[None] + size * (np.arange(1, count + 1) % count)[:, None, None]
        return np.concatenate([here, there], axis=2).reshape(-1, 8).astype(np.int32)

    @cached_property
    def contact_pressure(self) -> Array:
        """(n_points,) contact pressure, Pa; zero outside the tread."""
        nodes, *_ = self._section
        footprint = self.pressed.footprint
        known, tread = footprint.grid.angles, footprint.grid.tread.nodes
        pressure = np.zeros((len(self.angles), len(nodes)))
        for column, node in enumerate(tread):
            along = np.interp(np.abs(self.angles), known, footprint.pressure[:, column], right=0.0)
            pressure[:, nodes == node] = along[:, None]
        return pressure.ravel()

    @cached_property
    def strain_energy(self) -> Array:
        """(n_cells,) e : C' : e / 2, J/m3, of the strain beyond inflation in the middle of each step, mean over the
        element. C' is the stiffness that loses energy: of the rubber, and of cords times their lossy share."""
        cycle = self.pressed.cycle
        weights = cycle.elements.weights / cycle.elements.weights.sum(axis=1, keepdims=True)
        storage = np.moveaxis(self.pressed.pressing.state.storage, (0, 1), (-2, -1))
        middles = (self.angles + np.append(self.angles[1:], np.pi)) / 2
        densities = np.zeros((len(middles), len(weights)))
        for start in range(0, len(middles), AT_ONCE):
            e = cycle.strain(middles[start : start + AT_ONCE]).transpose(1, 2, 0, 3)
            density = 0.5 * ((storage @ e) * e).sum(axis=2)
            densities[start : start + AT_ONCE] = (density * weights[..., None]).sum(axis=1).T
        return self._of_cells(densities)

    @cached_property
    def loss(self) -> Array | None:
        """(n_cells,) energy lost per revolution, J/m3; None if the wheel does not roll."""
        loss = self.pressed.loss
        if loss is None:
            return None
        weights = loss.cycle.elements.weights
        mean = (loss.density * weights).sum(axis=1) / weights.sum(axis=1)
        return self._of_cells(np.broadcast_to(mean, (len(self.angles), len(mean))))

    def _of_cells(self, values: Array) -> Array:
        """Values (angles, elements) as one value per cell."""
        *_, parent, _ = self._section
        return np.asarray(values[:, parent]).ravel()

    @cached_property
    def regions(self) -> tuple[Array, dict[str, int]]:
        """(n_cells,) region numbers from 1, and the number of each ``region_id_<name>``."""
        body = self.pressed.tyre.body
        numbers, names = np.zeros(body.mesh.t.shape[1], dtype=np.int32), {}
        for number, region in enumerate(self.pressed.study.section.regions, start=1):
            numbers[np.asarray(body.mesh.subdomains[region])] = number
            names[f"region_id_{region}"] = number
        return self._of_cells(np.broadcast_to(numbers, (len(self.angles), len(numbers)))), names

    def write(self, path: Path) -> Path:
        """Write a compressed .vtu in single precision, completely or not at all.

        Point data ``displacement_m`` (from the tyre without pressure and load) and ``contact_pressure_Pa``; cell data
        ``region``, ``strain_energy_J_m3`` and ``loss_J_m3`` (per revolution); field data ``region_id_<name>``.

        Raises
        ------
        InputError : the file cannot be written.
        """
        import meshio

        moved, points = self.displacements
        regions, names = self.regions
        data = {"strain_energy_J_m3": self.strain_energy, **({} if self.loss is None else {"loss_J_m3": self.loss})}
        mesh = meshio.Mesh(
            points.astype(np.float32),
            [("hexahedron", self.cells)],
            point_data={
                "displacement_m": moved.astype(np.float32),
                "contact_pressure_Pa": self.contact_pressure.astype(np.float32),
            },
            cell_data={"region": [regions], **{name: [values.astype(np.float32)] for name, values in data.items()}},
        )
        with atomic_path(path) as temporary:
            meshio.write(temporary, mesh, file_format="vtu", binary=True)
            add_fields(temporary, names)
        return path


#: Angles of the tables of strain: 0.5 degrees apart.
ANGLES = np.linspace(-np.pi, np.pi, 721)


#: Files that `write_files` may write.
FILES = (
    "press.json", "load-deflection.csv", "strain-cycle.csv", "cord-tension.csv", "harmonics.csv", "tyre.vtu",
    *(f"{name}.png" for name in ("section", "section-loaded", "pressure", "load-deflection", "strain-cycle",
                                 "cord-tension", "harmonics")),
)  # fmt: skip


def write_files(
    pressed: Pressed,
    folder: Path,
    places: Sequence[CyclePlace],
    curve: Any,
    *,
    pictures: bool = True,
    vtk: bool = True,
) -> None:
    """``press.json``, ``load-deflection.csv``, ``strain-cycle.csv``, ``cord-tension.csv``, ``harmonics.csv``; pictures
    of these, of the section and of the contact pressure; ``tyre.vtu``.

    The tables are written before the pictures. Without cords there is no ``cord-tension``; without rolling there is
    no ``harmonics``.

    Parameters
    ----------
    pressed : the tyre. folder : folder of the files. places : places of the strain cycle. curve : `Pressed.curve`.
    """
    from tyrefem.mechanics.footprint.cord_cycle import cord_cycles

    cords = cord_cycles(pressed.tyre, pressed.cycle)
    with atomic_folder(folder) as place:
        write_json(pressed.summary(), place / "press.json")
        for name, rows in _tables(pressed, places, curve, cords).items():
            (place / f"{name}.csv").write_text(_csv(rows), encoding="utf-8")
    with keeping(f"{folder} has the tables, but not the pictures"), atomic_folder(folder) as place:
        if pictures:
            for name, picture in _pictures(pressed, places, curve, cords).items():
                (place / f"{name}.png").write_bytes(picture)
        if vtk:
            RevolvedTyre(pressed).write(place / "tyre.vtu")


def _tables(
    pressed: Pressed, places: Sequence[CyclePlace], curve: Any, cords: Sequence[CordCycle]
) -> dict[str, Iterable[Sequence[Any]]]:
    from tyrefem.mechanics.footprint.strain_harmonics import COMPONENTS

    degrees, harmonics = np.degrees(ANGLES), pressed.curve_harmonics(curve)
    strains: list[Sequence[Any]] = [
        ["place", "region", "r_m", "z_m", "angle_deg", *(f"e_{name}" for name in COMPONENTS)]
    ]
    for place in places:
        history = pressed.cycle.strain(ANGLES, [place.element])[:, 0, place.point]
        strains += [[place.name, place.region, *place.place, *row] for row in np.column_stack([degrees, history.T])]
    tables: dict[str, Iterable[Sequence[Any]]] = {
        "load-deflection": [["deflection_m", "load_N", "harmonics"], *np.column_stack([curve, harmonics])],
        "strain-cycle": strains,
    }
    if cords:
        head = ["region", "unit", "r_m", "z_m", "angle_deg", "plus_angle", "minus_angle"]
        tables["cord-tension"] = [head] + [
            [place.region, place.unit, *place.place, *row]
            for place in cords
            for row in np.column_stack([np.degrees(place.angles), place.plus, place.minus])
        ]
    if pressed.loss is not None:
        orders = np.arange(len(pressed.loss.by_harmonic))
        values = np.column_stack([orders, pressed.loss.stored_by_harmonic, pressed.loss.by_harmonic])[1:]
        tables["harmonics"] = [["harmonic", "energy_J", "loss_per_revolution_J"], *values]
    return tables


def _csv(rows: Iterable[Sequence[Any]]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    for row in rows:
        writer.writerow([cell if isinstance(cell, str) else f"{cell:.9g}" for cell in row])
    return text.getvalue()


def _pictures(
    pressed: Pressed, places: Sequence[CyclePlace], curve: Any, cords: Sequence[CordCycle]
) -> dict[str, bytes]:
    from tyrefem.reports.figures.footprint import (
        cord_tension_figure,
        deformed_figure,
        harmonics_figure,
        inflation_figure,
        load_deflection_figure,
        pressure_map_figure,
        strain_history_figure,
    )
    from tyrefem.reports.figures.style import png

    elements = pressed.cycle.elements
    shown = {f"{place.name}, {place.region}": tuple(elements.points[:, place.element, place.point]) for place in places}
    figures = {
        "section": inflation_figure(pressed.tyre, pressed.study.name),
        "section-loaded": deformed_figure(pressed.footprint),
        "pressure": pressure_map_figure(pressed.footprint),
        "load-deflection": load_deflection_figure(pressed, curve),
        "strain-cycle": strain_history_figure(pressed.cycle, shown),
    }
    if cords:
        figures["cord-tension"] = cord_tension_figure(pressed.footprint, cords)
    if pressed.loss is not None:
        figures["harmonics"] = harmonics_figure(pressed.loss)
    return {name: png(drawn) for name, drawn in figures.items()}
