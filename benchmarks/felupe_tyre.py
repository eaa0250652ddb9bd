"""The plain tyre in three dimensions by FElupe: a quarter of it in 27-node hexahedra, inflated, pressed on a flat road.

FElupe does elements, kinematics, assembly, following pressure, contact by penalty, and Newton's method. It is fed with
corners, quadrilaterals, regions and boundaries of the section, and with moduli. x points forwards, y down, z along the
axis, in m.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import felupe as fem
import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import splu

from tyrefem.mechanics.footprint.example_tyre import PlainTyre

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
#: Elements of one size reach to FINE_UP_TO, rad; beyond, they grow by GROWTH up to LARGEST, rad.
FINE_UP_TO, GROWTH, LARGEST = math.radians(16), 1.35, math.radians(22)
#: Tread nodes up to this angle may touch the road, rad.
MAY_TOUCH = math.radians(35)
#: Shares of the pressure, and of the deflection, at which balances are solved one after the other.
INFLATION, PRESSING = (0.25, 1.0), (0.075, 0.2, 0.4, 0.7, 1.0)
#: Smallest step of these shares.
SMALLEST = 0.01
#: Contact stiffness of a tread node, N/m, and Newton's tolerance: residual over reactions.
PENALTY, TOLERANCE = 1e7, 1e-6


@dataclass(frozen=True, eq=False)
class Cords:
    """Cords in one direction (3, q, c) at the points of a body: W' = E (lambda - 1), lambda = |F d|; E in Pa."""

    directions: Sequence[Array]
    stiffness: float

    def stress(self, x: list[Any], **_: Any) -> list[Any]:
        """dW/dF = W'/lambda (F d) d, mean of the directions; Pa."""
        total = np.zeros(x[0].shape)
        for d, carried, stretch in self._stretched(x[0]):
            total += (self.stiffness * (stretch - 1) / stretch * carried)[:, None] * d
        return [total / len(self.directions), x[-1]]

    def elasticity(self, x: list[Any], **_: Any) -> list[Any]:
        """d2W/dFdF = (W'' - W'/lambda)/lambda^2 (F d) d (F d) d + W'/lambda 1 d d; Pa."""
        total = np.zeros((3, 3, *x[0].shape))
        for d, carried, stretch in self._stretched(x[0]):
            pull = self.stiffness * (stretch - 1) / stretch
            dyad, along = carried[:, None] * d, (pull * d)[:, None] * d
            total += ((self.stiffness - pull) / stretch**2 * dyad)[:, :, None, None] * dyad
            for i in range(3):
                total[i, :, i, :] += along
        return [total / len(self.directions)]

    def _stretched(self, f: Array) -> Iterable[tuple[Array, Array, Array]]:
        for d in self.directions:
            carried = np.einsum("ij...,j...->i...", f, d)
            yield d, carried, np.sqrt((carried * carried).sum(axis=0))


@dataclass(frozen=True, eq=False)
class SolidTyre:
    """A quarter of the tyre: z >= 0, angles 0 to pi from the footprint's middle.

    Parameters
    ----------
    tyre : the plain tyre. along, through : elements of its section.
    fine : size of an element round the wheel near the footprint, rad.
    penalty : contact stiffness of a tread node, N/m.
    reduced : the dilatation is integrated at 2 x 2 x 2 points, against locking; False: at 3 x 3 x 3.
    """

    tyre: PlainTyre
    along: int
    fine: float
    through: tuple[int, int, int] = (1, 1, 1)
    penalty: float = PENALTY
    reduced: bool = True

    # -- geometry ----------------------------------------------------------------------------------------------------

    @functools.cached_property
    def flat(self) -> Any:
        """Corners ``p``, quadrilaterals ``t``, regions and boundaries of the half section."""
        return self.tyre.mesh(self.along, self.through)

    @functools.cached_property
    def section(self) -> tuple[Array, Indices]:
        """Nodes (n, 2) in (r, z), m, and elements (e, 9): corners, middles of edges, centre."""
        corners, quads = self.flat.p.T, self._quads
        edges = np.sort(np.stack([quads[:, [k, (k + 1) % 4]] for k in range(4)], axis=1), axis=-1)
        unique, inverse = np.unique(edges.reshape(-1, 2), axis=0, return_inverse=True)
        middles = len(corners) + inverse.reshape(-1, 4)
        centres = len(corners) + len(unique) + np.arange(len(quads))[:, None]
        nodes = np.vstack([corners, corners[unique].mean(axis=1), corners[quads].mean(axis=1)])
        return nodes, np.hstack([quads, middles, centres]).astype(np.int64)

    @property
    def _quads(self) -> Indices:
        # Counter-clockwise where r and z increase, as hexahedra between rising angles need.
        return np.asarray(self.flat.t.T[:, [0, 3, 2, 1]], dtype=np.int64)

    def _boundary(self, name: str) -> Indices:
        """Nodes of the section on a named boundary."""
        nodes, cells = self.section
        wanted = {tuple(pair) for pair in np.sort(self.flat.facets[:, self.flat.boundaries[name]].T, axis=1)}
        numbers: set[int] = set()
        for cell in cells:
            for k in range(4):
                start, end, middle = cell[k], cell[(k + 1) % 4], cell[4 + k]
                if tuple(sorted((start, end))) in wanted:
                    numbers |= {int(start), int(end), int(middle)}
        chosen = np.array(sorted(numbers))
        return chosen[np.argsort(nodes[chosen, 1], kind="stable")]

    @functools.cached_property
    def ends(self) -> Array:
        """Angles between elements, rad."""
        near = np.arange(round(FINE_UP_TO / self.fine) + 1) * self.fine
        beyond, step = [near[-1]], self.fine
        while beyond[-1] < math.pi:
            step = min(step * GROWTH, LARGEST)
            beyond.append(beyond[-1] + step)
        stretched = near[-1] + (np.array(beyond) - near[-1]) * (math.pi - near[-1]) / (beyond[-1] - near[-1])
        return np.concatenate([near, stretched[1:]])

    @functools.cached_property
    def angles(self) -> Array:
        """Angles of the nodes, rad: ends and middles of elements."""
        return np.interp(np.arange(2 * len(self.ends) - 1) / 2, np.arange(len(self.ends)), self.ends)

    @functools.cached_property
    def mesh(self) -> Any:
        """Nodes (angle by angle, those of the section in each) and hexahedra; the last node carries the road."""
        nodes, section = self.section
        r, z = nodes.T
        points = [np.stack([r * np.sin(t), r * np.cos(t), z], axis=1) for t in self.angles]
        cells = []
        for k in range(len(self.ends) - 1):
            first, middle, last = (section + (2 * k + j) * len(nodes) for j in range(3))
            # Corners, edges of both sections, edges between them, faces (0,3) (1,2) (0,1) (2,3), sections, centre.
            parts = [first[:, :4], last[:, :4], first[:, 4:8], last[:, 4:8], middle[:, :4], middle[:, [7, 5, 4, 6]]]
            cells.append(np.hstack([*parts, first[:, 8:], last[:, 8:], middle[:, 8:]]))
        road = [[0.0, 2 * float(r.max()), 0.0]]
        return fem.Mesh(np.vstack([*points, road]), np.vstack(cells), "hexahedron27")

    def _round(self, nodes: Indices, count: int | None = None) -> Indices:
        """Numbers of section nodes at the first angles, (angles x nodes,)."""
        planes = np.arange(len(self.angles) if count is None else count)
        return np.asarray((planes[:, None] * len(self.section[0]) + nodes).ravel())

    def _marked(self, numbers: Indices) -> NDArray[np.bool_]:
        marked = np.zeros(len(self.mesh.points), dtype=bool)
        marked[numbers] = True
        return marked

    # -- what balances -----------------------------------------------------------------------------------------------

    @functools.cached_property
    def field(self) -> Any:
        """Displacement at all nodes."""
        return fem.FieldContainer([fem.Field(fem.RegionTriQuadraticHexahedron(self.mesh), dim=3)])

    def _field_on(self, region: Any) -> Any:
        return fem.FieldContainer([fem.Field(region, dim=3)])

    @functools.cached_property
    def quadrature_points(self) -> Array:
        """(3, q, c) places of the integration points before inflation, m."""
        return np.asarray(fem.Field(self.field.region, dim=3, values=self.mesh.points).interpolate())

    def cords(self, name: str, angle: float, stiffness: float) -> Any:
        """The cords of a region at +-``angle`` to the circumference."""
        count = self.flat.t.shape[1]
        members = (np.arange(len(self.ends) - 1)[:, None] * count + self.flat.subdomains[name]).ravel()
        ends = self.flat.p[:, self.flat.t]
        along = ends[:, 1] + ends[:, 2] - ends[:, 0] - ends[:, 3]
        r, z = np.tile(along / np.linalg.norm(along, axis=0), len(self.ends) - 1)[:, members]
        x, y, _ = self.quadrature_points[..., members]
        sin, cos = x / np.hypot(x, y), y / np.hypot(x, y)
        meridian, around = np.stack([r * sin, r * cos, z + 0 * sin]), np.stack([cos, -sin, 0 * sin])
        directions = [np.sin(angle) * meridian + sign * np.cos(angle) * around for sign in (1, -1)]
        law = Cords(directions, stiffness)
        region = fem.RegionTriQuadraticHexahedron(fem.Mesh(self.mesh.points, self.mesh.cells[members], "hexahedron27"))
        return fem.SolidBody(fem.Material(law.stress, law.elasticity), self._field_on(region))

    @functools.cached_property
    def bodies(self) -> list[Any]:
        """Rubber at constant volume, its change of volume, cords of ply and belt."""
        tyre, order = self.tyre, 1 if self.reduced else 2
        quadrature = fem.GaussLegendre(order=order, dim=3)
        volume = fem.Volumetric(bulk=tyre.bulk_ratio * tyre.shear_modulus)
        return [
            fem.SolidBody(fem.NeoHooke(mu=tyre.shear_modulus), self.field),
            fem.SolidBody(volume, self._field_on(fem.RegionTriQuadraticHexahedron(self.mesh, quadrature=quadrature))),
            self.cords("ply", math.pi / 2, tyre.ply_stiffness),
            self.cords("belt", tyre.belt_angle, tyre.belt_stiffness),
        ]

    def _surface(self, name: str) -> Any:
        mask = self._marked(self._round(self._boundary(name)))
        return fem.RegionTriQuadraticHexahedronBoundary(self.mesh, only_surface=True, mask=mask)

    @functools.cached_property
    def air(self) -> Any:
        """Pressure that follows the inner wall."""
        return fem.SolidBodyPressure(self._field_on(self._surface("contained_air")))

    # -- balances ----------------------------------------------------------------------------------------------------

    def inflate(self, pressure: float) -> SolidState:
        """The balance under a pressure, Pa."""

        def solve(share: float) -> None:
            self.air.update(share * pressure)
            self._balance([*self.bodies, self.air], self._held(0.0))

        self._in_steps(INFLATION, solve)
        return self._state(None, 0.0)

    def press(self, deflection: float) -> SolidState:
        """The balance on a road that a tyre inflated by `inflate` penetrates by ``deflection``, m."""
        tread, road = self._boundary("road"), len(self.mesh.points) - 1
        reach = float((self.mesh.points + self.field[0].values)[tread, 1].max())
        near = self._round(tread, int((self.angles <= MAY_TOUCH).sum()))
        contact = fem.ContactRigidPlane(self.field, near, road, normal=[0, -1, 0], multiplier=self.penalty)

        def solve(share: float) -> None:
            place = reach - share * deflection
            self._balance([*self.bodies, self.air, contact], self._held(place - self.mesh.points[road, 1]))

        self._in_steps(PRESSING, solve)
        return self._state(reach - deflection, reach)

    def _in_steps(self, shares: Sequence[float], solve: Callable[[float], None]) -> None:
        """Balances at shares of a load; a step in which Newton's method diverges is halved."""
        waiting, reached = list(shares), 0.0
        while waiting:
            before = self.field[0].values.copy()
            try:
                with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
                    solve(waiting[0])
            except (fem.tools.NewtonConvergenceError, RuntimeError):
                if waiting[0] - reached < SMALLEST:
                    raise
                self.field[0].values = before
                waiting.insert(0, (reached + waiting[0]) / 2)
            else:
                reached = waiting.pop(0)

    def _held(self, road: float) -> dict[str, Any]:
        """Rim, planes of symmetry, and the road moved by ``road`` along y, m."""
        size, u, nodes = len(self.mesh.points), self.field[0], len(self.section[0])
        last = self._marked(np.array([size - 1]))
        ends = self._marked(np.r_[:nodes, size - 1 - nodes : size - 1])
        marked = {name: self._marked(self._round(self._boundary(name))) for name in ("rim", "symmetry")}
        return {
            "rim": fem.Boundary(u, mask=marked["rim"]),
            "mid plane": fem.Boundary(u, mask=marked["symmetry"], skip=(True, True, False)),
            "ends": fem.Boundary(u, mask=ends, skip=(False, True, True)),
            "road": fem.Boundary(u, mask=last, skip=(False, True, False)),
            "distance": fem.Boundary(u, mask=last, skip=(True, False, True), value=road),
        }

    def _balance(self, items: list[Any], held: dict[str, Any]) -> None:
        fixed, free = fem.dof.partition(self.field, held)
        values = fem.dof.apply(self.field, held, fixed)
        result = fem.newtonraphson(
            items=items, x0=self.field, dof0=fixed, dof1=free, ext0=values, solver=_solve, tol=TOLERANCE, verbose=0
        )
        self.field[0].values[:] = result.x[0].values

    # -- results -----------------------------------------------------------------------------------------------------

    def _state(self, distance: float | None, reach: float) -> SolidState:
        tread, count = self._boundary("road"), int((self.angles <= MAY_TOUCH).sum())
        near = self._round(tread, count)
        places = self.mesh.points[near] + self.field[0].values[near]
        gaps = np.full(len(near), np.inf) if distance is None else distance - places[:, 1]
        surface = self._surface("road")
        field = self._field_on(surface)
        field.link(self.field)
        normals = fem.constitution.AreaChange().function(field.extract(), surface.normals)[0]
        spread = np.linalg.norm(normals, axis=0) * surface.dV
        areas = np.zeros(len(self.mesh.points))
        np.add.at(areas, surface.mesh.cells, np.einsum("aqc,aqc->ca", *np.broadcast_arrays(surface.h, spread)))
        shape = (count, len(tread))
        return SolidState(
            self, np.array(self.field.extract()[0]), reach, self.penalty * np.maximum(-gaps, 0.0).reshape(shape),
            gaps.reshape(shape), areas[near].reshape(shape), places.reshape(*shape, 3),
        )  # fmt: skip


def _solve(matrix: Any, right: Any) -> Array:
    """Direct solution for a matrix of symmetric pattern."""
    options = {"SymmetricMode": True}
    factors = splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.01, options=options)
    return np.asarray(factors.solve(np.asarray(right).ravel()))


@dataclass(frozen=True, eq=False)
class SolidState:
    """A balance. ``deformation`` F (3, 3, q, c); ``reach`` of the inflated tyre, m; of tread nodes (angles, nodes) up
    to `MAY_TOUCH` in the quarter: ``forces``, N, ``gaps``, m, ``areas`` in this state, m2, ``places`` (..., 3), m."""

    solid: SolidTyre
    deformation: Array
    reach: float
    forces: Array
    gaps: Array
    areas: Array
    places: Array

    def green(self) -> tuple[Array, Array, Array, Array]:
        """Green's strain (3, 3, e, 9, angles) in (r, z, t), the points' angles (angles,), and r, z (e, 9)."""
        x, y, z = self.solid.quadrature_points
        sin, cos = x / np.hypot(x, y), y / np.hypot(x, y)
        zero = 0 * sin
        axes = np.stack([np.stack([sin, cos, zero]), np.stack([zero, zero, zero + 1]), np.stack([cos, -sin, zero])])
        f = self.deformation
        green = (np.einsum("kiqc,kjqc->ijqc", f, f) - np.eye(3)[..., None, None]) / 2
        turned = np.einsum("aiqc,ijqc,bjqc->abqc", axes, green, axes, optimize=True)
        local = np.asarray(self.solid.field.region.quadrature.points).round(9)
        order = np.lexsort((local[:, 1], local[:, 0], local[:, 2])).reshape(3, 9)
        elements = self.solid.flat.t.shape[1]

        def by_angle(values: Array) -> Array:
            parts = values[..., order, :].reshape(*values.shape[:-2], 3, 9, -1, elements)
            return np.moveaxis(parts, (-4, -3, -2, -1), (-1, -3, -2, -4)).reshape(*values.shape[:-2], elements, 9, -1)

        return by_angle(turned), by_angle(np.arctan2(x, y))[0, 0], by_angle(np.hypot(x, y))[..., 0], by_angle(z)[..., 0]
