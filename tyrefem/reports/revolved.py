"""A deformed section revolved into the whole tyre, as a VTK file for ParaView."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.reports.figures.cells import parts_of
from tyrefem.reports.vtu import VtuFile

if TYPE_CHECKING:
    from tyrefem.mechanics.footprint.loss import RevolutionLoss
    from tyrefem.mechanics.footprint.press import Pressed
    from tyrefem.mechanics.footprint.strain_harmonics import StrainHarmonics

Array = NDArray[Any]
#: Steps of the angle, rad, under and near the footprint and opposite to it.
FINE, COARSE = np.radians(1.0), np.radians(6.0)
#: Above this number of points, each nine-node element becomes one hexahedron per angular step instead of four.
MOST_POINTS = 450_000
#: Number of angles whose strains are computed together.
AT_ONCE = 24


def wheel_angles(near: float, fine: float = float(FINE)) -> Array:
    """Angles from -pi to below pi, rad, symmetric about 0: steps ``fine`` up to ``near``, growing to 6 degrees beyond.

    >>> angles = wheel_angles(0.3)
    >>> bool(np.allclose(angles[1:], -angles[:0:-1])), round(float(np.degrees(np.diff(angles).max())), 1) <= 6.0
    (True, True)
    """
    angles, step = [0.0], fine
    while angles[-1] + step < np.pi - 0.5 * step:
        angles.append(angles[-1] + step)
        if angles[-1] > near:
            step = min(1.2 * step, COARSE)
    side = np.array(angles)
    return np.concatenate([[-np.pi], -side[:0:-1], side])


@dataclass(frozen=True, eq=False)
class RevolvedSection(ABC):
    """Points, cells and fields of the whole deformed tyre; a half section gives both halves.

    The hexahedra's node order gives positive volumes, unless an element is folded.

    Parameters
    ----------
    pressed : the tyre. most_points : number of points above which elements are not cut in four.
    """

    pressed: Pressed
    most_points: int = MOST_POINTS

    @property
    @abstractmethod
    def angles(self) -> Array:
        """(n,) from the middle of the footprint, rad."""

    @property
    @abstractmethod
    def motions(self) -> tuple[Array, ...]:
        """(harmonics + 1, n_dofs) amplitudes U, m, of u = Re((U_r, U_z, -i U_t) e^(i n t)) beyond inflation, of a full
        section or of both halves; two of a half section: of the side z > 0, and of the mirror image of the other."""

    @property
    @abstractmethod
    def strains(self) -> tuple[StrainHarmonics, ...]:
        """The strains of `motions`."""

    @property
    @abstractmethod
    def losses(self) -> tuple[RevolutionLoss, ...]:
        """The losses of `strains`; none if the wheel does not roll."""

    @property
    @abstractmethod
    def point_data(self) -> Mapping[str, Array]:
        """Values of the points, beside the displacement."""

    @property
    def cell_data(self) -> Mapping[str, Array]:
        """Values of the cells, beside region, strain energy and loss."""
        return {}

    @abstractmethod
    def in_space(self, places: Array) -> Array:
        """(3, ...) coordinates of the file for places (x forward, y down, z along the axis), m."""

    @cached_property
    def section(self) -> tuple[Array, Array, Array, Array, Array]:
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

    def _by_side(self, values: tuple[Array, ...], sides: Array) -> list[tuple[Array, Array]]:
        """The value of each side, and where it is meant."""
        if len(values) == 1:
            return [(values[0], np.full(len(sides), True))]
        return [(values[0], sides > 0), (values[1], sides < 0)]

    @cached_property
    def displacements(self) -> tuple[Array, Array]:
        """Displacement of every point from the tyre without pressure and load, and the points, (n, 3), m."""
        nodes, side, *_ = self.section
        moved = np.zeros((3, len(self.angles), len(nodes)))
        for amplitudes, here in self._by_side(self.motions, side):
            turn = np.exp(1j * np.multiply.outer(self.angles, np.arange(len(amplitudes))))
            u = amplitudes.reshape(len(amplitudes), -1, 3)[:, nodes[here]]
            for component, phase in enumerate((1.0, 1.0, -1j)):
                moved[component][:, here] = (turn @ (phase * u[..., component])).real
        u_r, u_z, u_t = moved
        (r0, z0), (r, z) = self.pressed.tyre.body.rings.nodes[:, nodes], self.pressed.tyre.places[:, nodes]
        sin, cos = np.sin(self.angles)[:, None], np.cos(self.angles)[:, None]
        places = self.in_space(np.stack([(r + u_r) * sin + u_t * cos, (r + u_r) * cos - u_t * sin, side * (z + u_z)]))
        free = self.in_space(np.stack([r0 * sin, r0 * cos, np.broadcast_to(side * z0, u_r.shape)]))
        points = np.moveaxis(places, 0, -1).reshape(-1, 3)
        return points - np.moveaxis(free, 0, -1).reshape(-1, 3), points

    @cached_property
    def cells(self) -> Array:
        """(n, 8) hexahedra between neighbouring angles."""
        nodes, _, quads, *_ = self.section
        size, count = len(nodes), len(self.angles)
        right_handed = np.linalg.det(self.in_space(np.eye(3)) - self.in_space(np.zeros((3, 3)))) > 0
        turned = quads if right_handed else quads[:, ::-1]
        here = turned[None] + size * np.arange(count)[:, None, None]
        there = turned[None] + size * (np.arange(1, count + 1) % count)[:, None, None]
        return np.concatenate([here, there], axis=2).reshape(-1, 8).astype(np.int32)

    def on_tread(self, angles: Array, known: Array, values: Array, columns: Mapping[tuple[int, int], int]) -> Array:
        """(n_points,) values (n_known, m) of the tread at ``angles``, linear between angles ``known``; else zero.

        ``columns``: (node, side) -> column of ``values``.
        """
        nodes, side, *_ = self.section
        field = np.zeros((len(angles), len(nodes)))
        for place, key in enumerate(zip(nodes.tolist(), side.tolist(), strict=True)):
            if key in columns:
                field[:, place] = np.interp(angles, known, values[:, columns[key]], left=0.0, right=0.0)
        return field.ravel()

    @cached_property
    def strain_energy(self) -> Array:
        """(n_cells,) e : C' : e / 2, J/m3, of the strain beyond inflation in the middle of each step, mean over the
        element. C' is the stiffness that loses energy: of the rubber, and of cords times their lossy share."""
        storage = np.moveaxis(self.pressed.pressing.state.storage, (0, 1), (-2, -1))
        middles = (self.angles + np.append(self.angles[1:], np.pi)) / 2

        def densities(cycle: StrainHarmonics) -> Array:
            weights = cycle.elements.weights / cycle.elements.weights.sum(axis=1, keepdims=True)
            densities = np.zeros((len(middles), len(weights)))
            for start in range(0, len(middles), AT_ONCE):
                e = cycle.strain(middles[start : start + AT_ONCE]).transpose(1, 2, 0, 3)
                density = 0.5 * ((storage @ e) * e).sum(axis=2)
                densities[start : start + AT_ONCE] = (density * weights[..., None]).sum(axis=1).T
            return densities

        return self.of_cells(tuple(densities(cycle) for cycle in self.strains))

    @cached_property
    def loss(self) -> Array | None:
        """(n_cells,) energy lost per revolution, J/m3; None if the wheel does not roll."""
        if not self.losses:
            return None

        def mean(loss: RevolutionLoss) -> Array:
            weights = loss.cycle.elements.weights
            return np.asarray((loss.density * weights).sum(axis=1) / weights.sum(axis=1))

        return self.of_cells(tuple(self._round(mean(loss)) for loss in self.losses))

    def _round(self, values: Array) -> Array:
        """(angles, elements) values (elements,) that are alike all round."""
        return np.broadcast_to(values, (len(self.angles), len(values)))

    def of_cells(self, values: tuple[Array, ...]) -> Array:
        """(n_cells,) of values (angles, elements) of both sides, or of each."""
        *_, parent, sides = self.section
        cells = np.zeros((len(self.angles), len(parent)), dtype=values[0].dtype)
        for of_side, here in self._by_side(values, sides):
            cells[:, here] = of_side[:, parent[here]]
        return cells.ravel()

    def of_elements(self, values: Array) -> Array:
        """(n_cells,) of values (elements,) that are alike all round and on both sides."""
        return self.of_cells((self._round(values),))

    @cached_property
    def regions(self) -> tuple[Array, list[str]]:
        """(n_cells,) region numbers from 1, and the regions' names in that order."""
        body = self.pressed.tyre.body
        numbers, names = np.zeros(body.mesh.t.shape[1], dtype=np.int32), list(self.pressed.study.section.regions)
        for number, region in enumerate(names, start=1):
            numbers[np.asarray(body.mesh.subdomains[region])] = number
        return self.of_elements(numbers), names

    def write(self, path: Path) -> Path:
        """Write a compressed .vtu in single precision, completely or not at all.

        Point data ``displacement_m`` (from the tyre without pressure and load) and `point_data`; cell data
        ``region``, ``strain_energy_J_m3``, ``loss_J_m3`` (per revolution) and `cell_data`; a comment has the
        regions' names.

        Raises
        ------
        InputError : the file cannot be written.
        """
        moved, points = self.displacements
        regions, names = self.regions
        loss = {} if self.loss is None else {"loss_J_m3": self.loss}
        cells = {"strain_energy_J_m3": self.strain_energy, **loss, **self.cell_data}
        values = {"displacement_m": moved, **self.point_data}
        return VtuFile(points.astype(np.float32), self.cells, "hexahedron").write(
            path,
            {name: _single(field) for name, field in values.items()},
            {"region": regions, **{name: _single(field) for name, field in cells.items()}},
            {"region": names},
        )


def _single(values: Array) -> Array:
    return values if values.dtype == np.int32 else values.astype(np.float32)
