"""The rim: a seat that fixes the bead, and a rounded flange which the bead's outside may touch or leave."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.solid.elements import Indices, Rings, edge_functions

Array = NDArray[np.float64]
#: Radius of a flange, m, if the section gives none. Estimate: rims have 8 to 13 mm.
FLANGE_RADIUS = 10e-3
#: The boundary fixed by the seat, and the one that may touch the flange; facets more radii away than this never do.
SEAT, FLANGE = "rim_seat", "rim_flange"
REACH = 4.0
#: Pressure of the flange per depth, Pa/m. Estimate: at 5 MPa, more than any bead bears, the depth is 10 um.
STIFFNESS = 5e11


@dataclass(frozen=True, eq=False)
class Flange:
    """A rigid ring of circular section without friction: pressure k <-g>, gap g = |x - c| - R in the (r, z) plane.

    The pressure acts per undeformed area: energy int k <-g>^2/2 r0 ds0, force and stiffness are consistent.

    Parameters
    ----------
    rings : shape functions of the body.
    centre : (r, z) of the circle, m. radius : R, m.
    boundary : the edges that may touch. side : +1, or -1 for the mirrored flange on the other half of a full section.
    stiffness : k, Pa/m.
    """

    rings: Rings
    centre: tuple[float, float]
    radius: float
    boundary: str = FLANGE
    side: int = 1
    stiffness: float = STIFFNESS

    @functools.cached_property
    def _facets(self) -> Indices:
        """Edges on the same side as the flange."""
        facets, mesh = self.rings.boundary(self.boundary), self.rings.mesh
        return np.asarray(facets[self.side * mesh.p[1, mesh.facets[:, facets]].mean(axis=0) > 0], dtype=np.int64)

    @functools.cached_property
    def nodes(self) -> Indices:
        """(n_edges, 3): end, end, middle."""
        return self.rings.edge_nodes(self._facets)

    @functools.cached_property
    def _functions(self) -> tuple[Array, Array]:
        """Values (5 points, 3 nodes); weights r0 ds0 (n_edges, 5), m2 per radian."""
        values, _, w = edge_functions(5)
        places = self.rings.nodes[:, self.nodes]
        length = np.hypot(*(places[..., 1] - places[..., 0]))
        return values, places[0] @ values.T * w * length[:, None] / 2

    def _contact_geometry(self, places: Array) -> tuple[Array, Array, Array]:
        """Gap (n_edges, 5), m, its normal (2, n_edges, 5), distance from the centre."""
        away = places[:, self.nodes] @ self._functions[0].T - np.reshape(self.centre, (2, 1, 1))
        distance = np.hypot(*away)
        return distance - self.radius, away / distance, distance

    def gap(self, places: Array) -> Array:
        """(n_edges, 5) gap at the Gauss points, m, for nodes at (2, n_nodes)."""
        return self._contact_geometry(places)[0]

    def pressure(self, places: Array) -> Array:
        """(n_edges, 5) pressure on the body, Pa per undeformed area."""
        return self.stiffness * np.maximum(-self.gap(places), 0.0)

    def energy(self, places: Array) -> float:
        """J per radian."""
        return float((self.pressure(places) ** 2 / (2 * self.stiffness) * self._functions[1]).sum())

    def force(self, places: Array) -> Array:
        """(2 n_nodes,) force on the body, N per radian, component c of node i at 2 i + c."""
        _, normal, _ = self._contact_geometry(places)
        values, weights = self._functions
        local = np.einsum("cfq,fq,qa->fac", normal, self.pressure(places) * weights, values)
        force = np.zeros(2 * self.rings.n_nodes)
        np.add.at(force, (2 * self.nodes[:, :, None] + np.arange(2)).ravel(), local.ravel())
        return force

    def stiffness_matrix(self, places: Array, components: int = 2) -> Any:
        """Derivative of - `force` by the positions: sparse (components n_nodes, components n_nodes), N/m per radian.

        k n n - p Hess g where the gap is closed. With three components (r, z, t) it also has Hess g_tt = n_r/r, for
        motions along the circumference; it is the same for all harmonics n.
        """
        import scipy.sparse as sp

        _, normal, distance = self._contact_geometry(places)
        pressure, (values, weights) = self.pressure(places), self._functions
        along = np.stack([-normal[1], normal[0]])
        local = np.zeros((components, components, *pressure.shape))
        closed = np.where(pressure > 0, self.stiffness, 0.0)
        for i in range(2):
            for j in range(2):
                local[i, j] = closed * normal[i] * normal[j] - pressure / distance * along[i] * along[j]
        if components == 3:
            local[2, 2] = -pressure * normal[0] / (places[0, self.nodes] @ values.T)
        blocks = np.einsum("ijfq,fq,qa,qb->faibj", local, weights, values, values, optimize=True)
        dofs = (components * self.nodes[:, :, None] + np.arange(components)).reshape(len(self.nodes), -1)
        size, n = dofs.shape[1], components * self.rings.n_nodes
        place = (np.repeat(dofs, size, axis=1).ravel(), np.tile(dofs, (1, size)).ravel())
        return sp.coo_matrix((blocks.ravel(), place), shape=(n, n)).tocsc()


def on_rim(
    mesh: Any,
    radius: float,
    rim: str = "rim",
    outside: str = "outside_air",
    centre: tuple[float, float] | None = None,
) -> tuple[Any, tuple[Flange, ...]]:
    """A tyre's mesh with the boundaries `SEAT` and `FLANGE` in place of the rim, and a flange on each side.

    The part of ``rim`` on the outer face is as high as the flange. The flange's circle touches the undeformed outer
    face without crossing it, one radius (along the face) below that part's end; the rest below is the seat. A hollow
    outer face reduces the circle's radius. A rim that does not meet ``outside`` is all seat.

    Parameters
    ----------
    mesh : skfem ``MeshQuad`` with the boundaries ``rim`` and ``outside``. radius : of the flange, m.
    centre : (r, z) of the flange's circle where it is known, m; then the circle is as large as the face leaves room.

    Raises
    ------
    InputError : no boundary ``rim``.
    """
    boundaries = mesh.boundaries
    seat, face = Rings(mesh).boundary(rim), np.asarray(boundaries.get(outside, []), dtype=np.int64)
    lying, flanges = [], []
    for side in (1, -1):
        side_facets = seat[side * mesh.p[1, mesh.facets[:, seat]].mean(axis=0) > 0]
        outer = face[side * mesh.p[1, mesh.facets[:, face]].mean(axis=0) > 0]
        common = np.intersect1d(mesh.facets[:, side_facets], mesh.facets[:, outer])
        if not len(common):
            continue
        # Air on both sides of a rim: the flange is at the end farther from the mid plane, the other end is the toe.
        heel = int(common[np.argmax(side * mesh.p[1, common])])
        up, down = _chain(mesh, outer, heel), _chain(mesh, side_facets, heel)
        below = np.cumsum(np.hypot(*np.diff(mesh.p[:, down[1]], axis=1)))
        held = max(min(int(np.abs(below - radius).argmin()) + 1, len(down[1]) - 2), 0)
        touching = np.concatenate([down[1][held::-1], up[1][1:]])
        if centre is None:
            middle, size = _tangent_circle(mesh.p[:, touching], side, radius)
        else:
            middle = (centre[0], side * centre[1])
            size = min(radius, _distance(mesh.p[:, touching], middle))
        middles = mesh.p[:, mesh.facets[:, up[0]]].mean(axis=1)
        near = up[0][np.hypot(*(middles - np.reshape(middle, (2, 1)))) < (1 + REACH) * radius]
        lying.append(np.concatenate([down[0][:held], near]))
        flanges.append((middle, size, side))
    flange = np.concatenate([np.zeros(0, dtype=np.int64), *lying])
    named = mesh.with_boundaries({FLANGE: np.sort(flange), SEAT: np.setdiff1d(seat, flange)})
    rings = Rings(named)
    return named, tuple(Flange(rings, middle, size, side=side) for middle, size, side in flanges)


def _chain(mesh: Any, facets: Indices, point: int) -> tuple[Indices, Indices]:
    """Facets of a line in order from a point at its end, as far as they are connected, and their points."""
    ends = mesh.facets[:, facets]
    left, order, points = list(range(len(facets))), [], [point]
    while left:
        after = [k for k in left if point in ends[:, k]]
        if not after:
            break
        left.remove(after[0])
        order.append(after[0])
        point = int(ends[:, after[0]].sum() - point)
        points.append(point)
    return facets[order], np.array(points)


def _distance(points: Array, place: tuple[float, float]) -> float:
    """Least distance of a place from a line of points (2, n), m."""
    start, along = points[:, :-1], np.diff(points, axis=1)
    to = np.reshape(place, (2, 1)) - start
    share = np.clip((to * along).sum(axis=0) / (along**2).sum(axis=0), 0.0, 1.0)
    return float(np.hypot(*(to - share * along)).min())


def _tangent_circle(points: Array, side: int, radius: float) -> tuple[tuple[float, float], float]:
    """Centre and radius of the circle that touches a line of points (2, n) from outside at its start."""
    away = points[:, 1:] - points[:, :1]
    along = away[:, 0] / np.hypot(*away[:, 0])
    outwards = side * np.array([-along[1], along[0]])
    height, distance = outwards @ away, (away**2).sum(axis=0)
    radii = np.divide(distance, 2 * height, out=np.full(height.shape, np.inf), where=height > 1e-9)
    size = float(min(radius, radii.min()))
    centre = points[:, 0] + size * outwards
    return (float(centre[0]), float(centre[1])), size
