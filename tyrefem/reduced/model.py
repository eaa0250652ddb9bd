"""The rolling tyre on POD modes: projected conduction, films and capacities; heat sources from sample nodes."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.cache import Cache, Content
from tyrefem.conduction.operators import Operators
from tyrefem.conduction.points import located
from tyrefem.errors import InputError
from tyrefem.geometry.wall import wall_of
from tyrefem.inputs.study import StudyData
from tyrefem.reduced.exchanges import Exchanges, Layout, exchanges
from tyrefem.reduced.learnt_cycles import LearntCycles
from tyrefem.reduced.learnt_inputs import LearntInputs
from tyrefem.reduced.pod import CANDIDATE_NODES
from tyrefem.reduced.shape_operators import ShapeGeometry, ShapeOperators
from tyrefem.simulation.rolling_tyre import RollingTyre

Array = NDArray[np.float64]


class NotReducibleError(InputError):
    """A reduced model cannot represent the study: run the study in full."""


@dataclass(frozen=True, eq=False)
class ReducedModel(Brief):
    """A tyre's heat balance on POD modes, u = V a; contained air and rim have separate states.

    M a' = -sum_i k_i K_i a - sum_j h_j (R_j a - r_j T_j) + sum_z V^T S_z q_z(T),  q_z from the sample nodes.

    Parameters
    ----------
    base : the tyre that the model was made for; all variants have its mesh. V : (n, m) modes.
    samples : zone -> numbers of its sample nodes (among the zone's nodes), where the heat source is evaluated.
    nodes_from_samples : (all zones' nodes, all samples): interpolates the heat source to all nodes.
    """

    base: RollingTyre
    V: Array
    samples: Mapping[str, NDArray[Any]]
    nodes_from_samples: Array
    #: Region -> its nodes that were nearly the hottest in training: the peak is searched there first.
    hot: Mapping[str, NDArray[np.intp]] = field(default_factory=dict)
    #: Projected operators over the shapes of the section, on these and the ``further`` modes; None: assembled and
    #: projected for every shape.
    shapes: ShapeOperators | None = None
    #: Further modes of the snapshots, (n, k): errors are estimated on them; None: no estimates.
    further: Array | None = None
    #: Strain cycles of the variants, learnt from presses; None: every variant's strain law computes them.
    cycles: LearntCycles | None = None
    #: Inputs of the variants of a box; None: every variant is made as a study.
    inputs: LearntInputs | None = None

    def _title(self) -> str:
        return f"of {self.base.study.name}"

    def _facts(self) -> Mapping[str, Any]:
        samples = sum(len(numbers) for numbers in self.samples.values())
        return {
            "modes": f"{self.size} for {len(self.V)} unknowns",
            "heat sources": f"evaluated at {samples} nodes",
        }

    @property
    def operators(self) -> Operators:
        """Operators of the full model."""
        return self.base.problem.operators

    @property
    def size(self) -> int:
        """Number of modes."""
        return int(self.V.shape[1])

    def tyre(self, study: StudyData) -> RollingTyre:
        """The tyre of a variant: like the base tyre, with learnt strain cycles if the model has them."""
        if self.cycles is None:
            return RollingTyre(study, self.base)
        return RollingTyre(study, self.base, cycles=self.cycles.schedule(study))

    @functools.cached_property
    def enriched(self) -> ReducedModel:
        """The model on its modes and the further ones."""
        assert self.further is not None
        return replace(self, V=np.column_stack([self.V, self.further]), further=None)

    @functools.cached_property
    def shape(self) -> ShapeGeometry:
        """Quadrature points and edges for any places of the nodes."""
        return ShapeGeometry(self.base)

    @property
    def on_reference(self) -> ReducedModel:
        """The model on the reference shape."""
        return self

    @functools.cached_property
    def of_sections(self) -> Cache[ReducedModel]:
        """Mesh of a shape -> the model on it."""
        return Cache(size=64)

    @property
    def points(self) -> Array:
        """Places of the unknowns, (2, n) m."""
        return self.operators.points

    def exchanges(self, layout: Layout) -> Exchanges:
        """The exchange matrices of a layout, built once."""
        if layout not in self._exchanges:
            self._exchanges[layout] = exchanges(layout, self.size, self.surfaces)
        return self._exchanges[layout]

    @functools.cached_property
    def _exchanges(self) -> dict[Layout, Exchanges]:
        return {}

    @functools.cached_property
    def mass(self) -> dict[str, Array]:
        """Region -> (m, m), for a heat capacity of 1 J/m3/K."""
        ops = self.operators
        return {region: self._projected(ops.mass(region), ops.dofs(region)) for region in self.base.bodies}

    @functools.cached_property
    def stored_row(self) -> dict[str, Array]:
        """Region -> (m,): stored heat per mode amplitude, for a heat capacity of 1 J/m3/K."""
        ops = self.operators
        ones = np.ones(ops.size)
        return {region: (ops.matrix(ops.mass(region)) @ ones) @ self.V for region in self.base.bodies}

    @functools.cached_property
    def conduction(self) -> dict[str, tuple[Array, Array]]:
        """Region -> (m, m) along and across the conduction direction, for 1 W/m/K.

        Isotropic bodies take the meridian as direction: a variant may make them anisotropic.
        """
        ops, along = self.operators, self.base.mesh.along_meridian
        return {
            region: tuple(  # type: ignore[misc]
                self._projected(matrix, ops.dofs(region)) for matrix in ops.conduction(region, body.direction or along)
            )
            for region, body in self.base.bodies.items()
        }

    @functools.cached_property
    def stacked(self) -> tuple[Array, Array]:
        """(n_regions, m, m) masses and (n_regions, 2, m, m) conduction, in the order of `mass`."""
        return np.array(list(self.mass.values())), np.array([self.conduction[region] for region in self.mass])

    @functools.cached_property
    def surfaces(self) -> dict[str, tuple[Array, Array, float]]:
        """Side -> R (m, m), r (m,) and area (m2), for a film of 1 W/m2/K."""
        ops, surfaces = self.operators, {}
        for side in self.base.boundaries:
            surface = ops.surface(side)
            data = np.zeros(ops.nnz)
            where, value = surface.unit_exchange
            np.add.at(data, where, value)
            row = np.zeros(ops.size)
            row[surface.dofs] = surface.load(1.0)
            surfaces[side] = (self._projected(data, surface.dofs), row @ self.V, float(row.sum()))
        return surfaces

    @functools.cached_property
    def regions(self) -> dict[str, NDArray[np.intp]]:
        """Region -> its nodes."""
        return {region: self.operators.dofs(region) for region in self.base.bodies}

    @functools.cached_property
    def region_rows(self) -> dict[str, Array]:
        """Region -> rows of V at its nodes."""
        return {region: self.V[dofs] for region, dofs in self.regions.items()}

    @functools.cached_property
    def hot_rows(self) -> dict[str, Array]:
        """Region -> rows of V at the nodes that were nearly the hottest in training."""
        return {region: self.V[dofs] for region, dofs in self.hot.items()}

    @functools.cached_property
    def wall(self) -> tuple[Array, Array, Array, Array]:
        """Stations s (k,) m, wall thickness (k,) m, and rows of V (k, m) at the inner and the outer surface."""
        wall = wall_of(self.base.mesh)
        inner, outer = np.split(self.rows(np.concatenate([wall.inner, wall.outer])), 2)
        return wall.s, wall.thickness, inner, outer

    def rows(self, points: Array) -> Array:
        """Rows of V, (k, m), at points (k, 2) in (r, z), m; kept for the 64 latest sets of points."""
        array = np.asarray(points, dtype=float)
        return self._rows.get(Content.of(array), lambda: np.asarray(located(self.operators, array).value() @ self.V))

    @functools.cached_property
    def _rows(self) -> Cache[Array]:
        return Cache(size=64)

    @functools.cached_property
    def node_places(self) -> Cache[tuple[float, float]]:
        """(r, z) of a peak's node -> its (s, depth), m."""
        return Cache(size=4096)

    @functools.cached_property
    def sensor_places(self) -> Cache[Array]:
        """Stated places of sensors -> their places in the mesh."""
        return Cache(size=64)

    @functools.cached_property
    def stage_matrices(self) -> Cache[Any]:
        """(phase, share) -> factored matrix of the base study; see `reduced.residual`."""
        return Cache(size=8)

    @functools.cached_property
    def error_rows(self) -> Array:
        """Rows of V, (m, m), at the nodes where the modes differ most; a field small there is small everywhere."""
        from scipy.linalg import qr

        some = self.V[:: max(len(self.V) // CANDIDATE_NODES, 1)]
        _, _, pivots = qr(some.T, pivoting=True, mode="economic")
        return some[pivots[: self.size]]

    @functools.cached_property
    def zones(self) -> list[str]:
        """Strain zones, in the order of the samples."""
        return list(self.samples)

    @functools.cached_property
    def sample_points(self) -> dict[str, Array]:
        """Zone -> (2, k) m: always the same arrays, so that a source can keep its values there."""
        ops = self.operators
        return {zone: np.ascontiguousarray(ops.nodes(zone)[:, chosen]) for zone, chosen in self.samples.items()}

    @functools.cached_property
    def sample_slices(self) -> dict[str, slice]:
        """Zone -> its slice of all samples."""
        ends = np.cumsum([0, *(len(nodes) for nodes in self.samples.values())])
        return {zone: slice(int(a), int(b)) for zone, a, b in zip(self.zones, ends[:-1], ends[1:], strict=True)}

    @functools.cached_property
    def at_samples(self) -> Array:
        """Rows of V at the sample nodes, (n_samples, m)."""
        ops = self.operators
        return np.vstack([self.V[ops.dofs(zone)[chosen]] for zone, chosen in self.samples.items()])

    @functools.cached_property
    def zone_rows(self) -> dict[str, slice]:
        """Zone -> its rows of ``nodes_from_samples``."""
        ends = np.cumsum([0, *(len(self.operators.dofs(zone)) for zone in self.zones)])
        return {zone: slice(int(a), int(b)) for zone, a, b in zip(self.zones, ends[:-1], ends[1:], strict=True)}

    @functools.cached_property
    def load(self) -> Array:
        """(m, n_samples): heat into the modes per heat source at the sample nodes."""
        loads = np.zeros((self.size, self.nodes_from_samples.shape[1]))
        for zone, rows in self.zone_rows.items():
            loads += (self.operators.source(zone).T @ self.V).T @ self.nodes_from_samples[rows]
        return loads

    @functools.cached_property
    def power(self) -> Array:
        """(n_zones, n_samples): power of every zone per heat source at the sample nodes."""
        rows = []
        for zone, part in self.zone_rows.items():
            row = np.asarray(self.operators.source(zone).sum(axis=0)).ravel()
            rows.append(row @ self.nodes_from_samples[part])
        return np.array(rows)

    def _projected(self, data: Array, dofs: NDArray[np.intp]) -> Array:
        """V^T A V of a matrix A with entries only in the rows ``dofs``."""
        rows = self.operators.matrix(data)[dofs]
        return np.asarray(self.V[dofs].T @ (rows @ self.V))
