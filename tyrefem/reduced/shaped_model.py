"""A reduced model on another shape of its section: the same modes by node, other operators."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from tyrefem.cache import Cache
from tyrefem.conduction.operators import Operators
from tyrefem.conduction.points import located
from tyrefem.reduced.model import NotReducibleError, ReducedModel
from tyrefem.simulation.rolling_tyre import RollingTyre

Array = NDArray[np.float64]
#: What follows from the modes and the topology alone: the same for all shapes.
SHARED = (
    "regions", "region_rows", "hot_rows", "error_rows", "zones", "sample_slices", "at_samples", "zone_rows",
)  # fmt: skip
#: Parts of an element: a point so far outside is taken as inside. Steps of Newton's method.
EDGE, NEWTON = 1e-7, 30
#: Grid cells in which a point is searched, from that of its place in the section.
AROUND = [(i, j) for i in (0, -1, 1) for j in (0, -1, 1)]


@dataclass(frozen=True, eq=False)
class ShapedModel(ReducedModel):
    """A reduced model on the mesh of a variant of another shape; ``base`` is that variant's tyre.

    Parameters
    ----------
    reference : the model on the reference shape. coefficients : of its `ShapeOperators`; None: operators are assembled
        on the variant's mesh and projected, exactly, in some 0.1 s.
    """

    reference: ReducedModel | None = None
    coefficients: Mapping[tuple[str, str], Array] | None = None

    def __post_init__(self) -> None:
        parent = self._parent
        self.__dict__.update({name: getattr(parent, name) for name in SHARED})

    @property
    def _parent(self) -> ReducedModel:
        assert self.reference is not None
        return self.reference

    @property
    def on_reference(self) -> ReducedModel:
        """The model on the reference shape."""
        return self._parent

    @functools.cached_property
    def enriched(self) -> ReducedModel:
        """The model on its modes and the further ones."""
        reference = self._parent.enriched
        fields = (self.base, reference.V, self.samples, self.nodes_from_samples, self.hot)
        return ShapedModel(*fields, reference=reference, coefficients=self.coefficients)

    @property
    def operators(self) -> Operators:
        """Operators of the full model on the variant's mesh, assembled when they are asked for."""
        return self.base.problem.operators

    @functools.cached_property
    def nodes(self) -> Array:
        """Places of the mesh's nodes, (2, n_nodes) m."""
        return np.asarray(self.base.mesh.mesh.p)

    @functools.cached_property
    def points(self) -> Array:
        """Places of the unknowns, (2, n) m."""
        return np.ascontiguousarray((self._parent.shape.dof_weights @ self.nodes.T).T)

    @functools.cached_property
    def sample_points(self) -> dict[str, Array]:
        """Zone -> (2, k) m."""
        ops = self._parent.operators
        return {
            zone: np.ascontiguousarray(self.points[:, ops.dofs(zone)[chosen]]) for zone, chosen in self.samples.items()
        }

    @functools.cached_property
    def combined(self) -> Cache[dict[str, Any]]:
        """The projected operators, once they are combined from the coefficients: see `fill`."""
        return Cache(size=1)

    @property
    def waits(self) -> bool:
        """Are the operators still to be combined from the coefficients?"""
        return self.coefficients is not None and not len(self.combined)

    @property
    def _operators(self) -> dict[str, Any] | None:
        """Operators by name, combined from the coefficients; None: they are assembled."""
        if self.coefficients is None:
            return None
        if self.waits:
            fill([self])
        operators: dict[str, Any] = self.combined.get(None, dict)
        return operators

    @functools.cached_property
    def mass(self) -> dict[str, Array]:
        """Region -> (m, m), for a heat capacity of 1 J/m3/K."""
        return super().mass if self._operators is None else self._operators["mass"]

    @functools.cached_property
    def stored_row(self) -> dict[str, Array]:
        """Region -> (m,): stored heat per mode amplitude, for a heat capacity of 1 J/m3/K."""
        return super().stored_row if self._operators is None else self._operators["stored"]

    @functools.cached_property
    def conduction(self) -> dict[str, tuple[Array, Array]]:
        """Region -> (m, m) along and across the conduction direction, for 1 W/m/K."""
        return super().conduction if self._operators is None else self._operators["conduction"]

    @functools.cached_property
    def surfaces(self) -> dict[str, tuple[Array, Array, float]]:
        """Side -> R (m, m), r (m,) and area (m2), for a film of 1 W/m2/K."""
        return super().surfaces if self._operators is None else self._operators["films"]

    @functools.cached_property
    def load(self) -> Array:
        """(m, n_samples): heat into the modes per heat source at the sample nodes."""
        return super().load if self._operators is None else self._operators["load"]

    @functools.cached_property
    def power(self) -> Array:
        """(n_zones, n_samples): power of every zone per heat source at the sample nodes."""
        return super().power if self._operators is None else self._operators["power"]

    def _rows_at(self, points: Array) -> Array:
        """Rows of V at points: near their grid cell of the topology, without a search over all elements."""
        topology, ops, t = self.base.topology, self._parent.operators, self.base.mesh.mesh.t
        assert topology is not None
        s, y = self.base.study.section.line.nearest(points)
        stations, heights = topology.grid(self.base.study.section)
        column = np.clip(np.searchsorted(stations, np.abs(s)) - 1, 0, len(stations) - 2)
        share = (np.abs(s) - stations[column]) / (stations[column + 1] - stations[column])
        of_column = heights[:, column] + share * (heights[:, column + 1] - heights[:, column])
        line = (of_column[1:-1] < y).sum(axis=0)
        side = np.where((points[:, 1] < 0) & (not self.base.study.section.half), 1, 0)
        cells = topology.elements
        chosen, local = np.full(len(points), -1), np.zeros((2, len(points)))
        left = np.arange(len(points))
        for i, j in AROUND:
            # Nearly all points lie in the first cell: the edges of elements are straight, those of the section are not.
            lines = np.clip(line[left] + i, 0, cells.shape[1] - 1)
            elements = cells[side[left], lines, np.clip(column[left] + j, 0, cells.shape[2] - 1)]
            tried, elements = left[elements >= 0], elements[elements >= 0]
            X = within(self.nodes[:, t[:, elements]], points[tried].T)
            inside = (np.abs(X - 0.5) <= 0.5 + EDGE).all(axis=0)
            chosen[tried[inside]], local[:, tried[inside]] = elements[inside], X[:, inside]
            left = np.flatnonzero(chosen < 0)
            if not left.size:
                break
        if left.size:
            return np.asarray(located(self.operators, points).value() @ self.V)
        functions = self._parent.shape.reference.values(local)
        starts = np.arange(0, functions.size + 1, len(functions))
        columns = ops.element_dofs[:, chosen].T.reshape(-1)
        return np.asarray(csr_matrix((functions.T.reshape(-1), columns, starts), (len(points), ops.size)) @ self.V)

    def rows(self, points: Array) -> Array:
        """Rows of V, (k, m), at points (k, 2) in (r, z), m."""
        return self._rows_at(np.asarray(points, dtype=float))


def within(corners: Array, target: Array) -> Array:
    """Reference coordinates (2, k) of points (2, k) in bilinear elements with corners (2, 4, k), by Newton's method.

    x = a + b X + c Y + d X Y.

    >>> square = np.array([[[0.0], [2.0], [2.0], [0.0]], [[0.0], [0.0], [4.0], [4.0]]])
    >>> within(square, np.array([[0.5], [3.0]]))[:, 0].tolist()
    [0.25, 0.75]
    """
    b, c = corners[:, 1] - corners[:, 0], corners[:, 3] - corners[:, 0]
    d, goal = corners[:, 2] - corners[:, 1] - c, target - corners[:, 0]
    X = np.full(target.shape, 0.5)
    for _ in range(NEWTON):
        gap = goal - b * X[0] - c * X[1] - d * (X[0] * X[1])
        along, across = b + d * X[1], c + d * X[0]
        determinant = along[0] * across[1] - along[1] * across[0]
        step = np.stack([across[1] * gap[0] - across[0] * gap[1], along[0] * gap[1] - along[1] * gap[0]]) / determinant
        X = np.clip(X + step, -2.0, 3.0)
        if not step.size or np.abs(step).max() < 1e-12:
            break
    return X


def on_tyre(reference: ReducedModel, tyre: RollingTyre) -> ReducedModel:
    """The model on the mesh of a tyre: the same, or one for another shape of the section, which alike sections share.

    Raises
    ------
    NotReducibleError : the mesh is another, and no shape of the model's.
    OtherTopologyError : the section has no mesh of the model's topology.
    """
    if tyre.mesh is reference.base.mesh:
        return reference
    if tyre.topology is None or tyre.topology is not reference.base.topology:
        raise NotReducibleError("the mesh is another: geometry, strain zones or [mesh] differ")

    def make() -> ReducedModel:
        fields = (tyre, reference.V, reference.samples, reference.nodes_from_samples, reference.hot)
        if reference.shapes is None:
            return ShapedModel(*fields, further=reference.further, reference=reference)
        mesh = tyre.mesh
        coefficients = reference.shapes.coefficients(reference.shape, np.asarray(mesh.mesh.p), mesh.along_meridian)
        return ShapedModel(*fields, further=reference.further, reference=reference, coefficients=coefficients)

    model: ReducedModel = reference.of_sections.get(tyre.study.section, make)
    return model


def fill(models: Sequence[ReducedModel]) -> None:
    """Combine the operators of shapes together: one product per table in place of one per shape."""
    waiting = [model for model in dict.fromkeys(models) if isinstance(model, ShapedModel) and model.waits]
    if not waiting:
        return
    shapes = waiting[0].on_reference.shapes
    assert shapes is not None
    together = shapes.combined([model.coefficients for model in waiting if model.coefficients is not None])
    for b, model in enumerate(waiting):
        model.combined.get(None, functools.partial(_of_shape, together, b, model.size))
        if model.further is not None:
            enriched = model.enriched
            assert isinstance(enriched, ShapedModel)
            enriched.combined.get(None, functools.partial(_of_shape, together, b, enriched.size))


def _of_shape(together: dict[str, Any], b: int, m: int) -> dict[str, Any]:
    """The operators of shape b on the first m modes, from those of all shapes on all modes."""
    return {
        "mass": {region: each[b, :m, :m] for region, each in together["mass"].items()},
        "conduction": {
            region: tuple(part[b, :m, :m] for part in parts) for region, parts in together["conduction"].items()
        },
        "stored": {region: each[b, :m] for region, each in together["stored"].items()},
        "load": np.ascontiguousarray(together["load"][b, :m]),
        "power": together["power"][b],
        "films": {side: (R[b, :m, :m], r[b, :m], float(area[b])) for side, (R, r, area) in together["films"].items()},
    }
