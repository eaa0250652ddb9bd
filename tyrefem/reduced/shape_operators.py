"""Projected operators over the shapes of a section: matrix discrete empirical interpolation.

Weights and tensors at the quadrature points (`shape_features`) of a few dozen shapes span a small space. Its modes are
projected on the POD modes once; a shape's coefficients follow from weights and tensors at a few sample points alone
(Negri, Manzoni & Amsallem 2015, J. Comput. Phys. 303: matrix discrete empirical interpolation).
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.reduced.pod import interpolation
from tyrefem.reduced.shape_features import Edges, Numbers, QuadraturePlaces, ReferenceElement, places
from tyrefem.simulation.rolling_tyre import RollingTyre

Array = NDArray[np.float64]
#: Relative rms error of weights and tensors on their modes, and modes at most, per region.
SHAPE_TOLERANCE, MOST = 2e-7, 60


@dataclass(frozen=True, eq=False)
class Sampled:
    """A family of features and its sample points: coefficients of the modes = fit @ features at the samples.

    Parameters
    ----------
    elements, points : (p,) sample points: element, and number of the quadrature point. fit : (K, p * entries).
    """

    elements: Numbers
    points: Numbers
    fit: Array


@dataclass(frozen=True, eq=False)
class ShapeOperators(Brief):
    """Projected operators per mode of the features.

    Parameters
    ----------
    volume, metric : region -> samples of its weights and of its tensors. directed : regions whose conduction is along
        and across the plies. mass : region -> (K, m, m). stored : region -> (K, m). load : region -> (K, m, n_samples).
    power : region -> (K, n_zones, n_samples). conduction : region -> (1 or 2, K, m, m).
    area : side -> fit (K, points) of its weights. films : side -> (K, m, m), rows (K, m) and areas (K,).
    """

    volume: Mapping[str, Sampled]
    metric: Mapping[str, Sampled]
    directed: frozenset[str]
    mass: Mapping[str, Array]
    stored: Mapping[str, Array]
    load: Mapping[str, Array]
    power: Mapping[str, Array]
    conduction: Mapping[str, Array]
    area: Mapping[str, Array]
    films: Mapping[str, tuple[Array, Array, Array]]

    @property
    def sizes(self) -> dict[str, int]:
        """Modes of weights, of tensors and of surfaces, all regions and sides together; and sample points."""
        families = [*self.volume.values(), *self.metric.values()]
        return {
            "volume": sum(len(each.fit) for each in self.volume.values()),
            "metric": sum(len(each.fit) for each in self.metric.values()),
            "surface": sum(len(fit) for fit in self.area.values()),
            "samples": sum(len(each.elements) for each in families),
        }

    @functools.cached_property
    def _samples(self) -> tuple[Numbers, Numbers, dict[tuple[str, str], slice]]:
        """All sample points together, and the part of every family: ("volume" or "metric", region)."""
        families = [(("volume", region), each) for region, each in self.volume.items()]
        families += [(("metric", region), each) for region, each in self.metric.items()]
        ends = np.cumsum([0, *(len(each.elements) for _, each in families)])
        parts = {key: slice(int(a), int(b)) for (key, _), a, b in zip(families, ends[:-1], ends[1:], strict=True)}
        elements = np.concatenate([each.elements for _, each in families])
        return elements, np.concatenate([each.points for _, each in families]), parts

    def coefficients(
        self, shape: ShapeGeometry, p: Array, direction: Callable[[Array], Array]
    ) -> dict[tuple[str, str], Array]:
        """(operator, region or side) -> coefficients (K,) of a shape with nodes p (2, n) and a direction of plies."""
        elements, numbers, parts = self._samples
        at, values = shape.places(p, elements, numbers), {}
        for (family, region), part in parts.items():
            here = QuadraturePlaces(at.x[:, part], at.J[:, :, part], at.w[part])
            if family == "volume":
                values[family, region] = self.volume[region].fit @ here.w
            else:
                entries = _metric(here, direction if region in self.directed else None)
                values[family, region] = self.metric[region].fit @ entries.reshape(-1)
        for side, fit in self.area.items():
            values["surface", side] = fit @ shape.edges[side].weights(p)
        return values

    def combined(self, coefficients: Sequence[Mapping[tuple[str, str], Array]]) -> dict[str, Any]:
        """Operators of B shapes: mass, conduction (along, across), stored, load, power, films."""
        regions, sides = list(self.mass), list(self.films)
        volume = {region: np.array([each["volume", region] for each in coefficients]) for region in regions}
        metric = {region: np.array([each["metric", region] for each in coefficients]) for region in regions}
        surface = {side: np.array([each["surface", side] for each in coefficients]) for side in sides}
        conduction = {}
        for region in regions:
            parts = [_times(metric[region], each) for each in self.conduction[region]]
            # One conductivity in all directions: the sum of both is what counts.
            conduction[region] = parts if len(parts) == 2 else [parts[0], np.zeros_like(parts[0])]
        return {
            "mass": {region: _times(volume[region], self.mass[region]) for region in regions},
            "conduction": conduction,
            "stored": {region: _times(volume[region], self.stored[region]) for region in regions},
            "load": sum(_times(volume[region], self.load[region]) for region in regions),
            "power": sum(_times(volume[region], self.power[region]) for region in regions),
            "films": {side: tuple(_times(surface[side], each) for each in self.films[side]) for side in sides},
        }


def _times(coefficients: Array, modes: Array) -> Array:
    """(B, ...) sums of modes (K, ...) with coefficients (B, K)."""
    return np.asarray((coefficients @ modes.reshape(len(modes), -1)).reshape(len(coefficients), *modes.shape[1:]))


def _metric(at: QuadraturePlaces, direction: Callable[[Array], Array] | None) -> Array:
    """(k, 3) or (k, 6) entries of the tensors: for all directions, or along and across a direction."""
    if direction is None:
        return at.even()
    return np.concatenate(at.directed(direction(at.x)), axis=1)


class ShapeGeometry:
    """Quadrature points and boundary edges of a topology, for any places of its nodes."""

    def __init__(self, base: RollingTyre) -> None:
        self.base = base
        self.reference = ReferenceElement(base.problem.operators)

    @functools.cached_property
    def edges(self) -> dict[str, Edges]:
        """Side -> its edges."""
        return {side: Edges.of(self.base.problem.operators, self.base.mesh, side) for side in self.base.boundaries}

    def places(self, p: Array, elements: Numbers, points: Numbers) -> QuadraturePlaces:
        """Quadrature points, by element and number, of a mesh with nodes p (2, n)."""
        return places(self.reference, p, self.base.mesh.mesh.t, elements, points)

    @functools.cached_property
    def dof_weights(self) -> Any:
        """(n, n_nodes) sparse: places of the unknowns from those of the nodes."""
        from scipy.sparse import csr_matrix

        from tyrefem.reduced.shape_features import shape_functions

        ops, t = self.base.problem.operators, self.base.mesh.mesh.t
        import skfem

        functions, _ = shape_functions(skfem.ElementQuad1(), ops.skfem_element.doflocs.T)
        dofs, first = np.unique(ops.element_dofs, return_index=True)
        local, element = np.unravel_index(first, ops.element_dofs.shape)
        values = functions[:, local]
        rows = np.repeat(dofs, len(functions))
        return csr_matrix(
            (values.T.reshape(-1), (rows, t[:, element].T.reshape(-1))), (ops.size, self.base.mesh.n_nodes)
        )


def shape_operators(
    base: RollingTyre,
    V: Array,
    zone_rows: Mapping[str, Array],
    tyres: Sequence[RollingTyre],
    tolerance: float = SHAPE_TOLERANCE,
) -> ShapeOperators:
    """Projected operators over shapes.

    Parameters
    ----------
    base : tyre with the reference shape. V : (n, m) modes. zone_rows : zone -> (nodes, n_samples), gives heat sources
        at the zone's nodes from those at the sample nodes. tyres : of the shapes whose weights and tensors are learnt.
    """
    return _Projection(base, V, zone_rows).of(tyres, tolerance)


class _Projection:
    def __init__(self, base: RollingTyre, V: Array, zone_rows: Mapping[str, Array]) -> None:
        self.base, self.V, self.zone_rows = base, V, zone_rows
        self.shape, self.ops = ShapeGeometry(base), base.problem.operators
        self.directed = frozenset(region for region, body in base.bodies.items() if body.direction is not None)

    def of(self, tyres: Sequence[RollingTyre], tolerance: float) -> ShapeOperators:
        result = ShapeOperators({}, {}, self.directed, {}, {}, {}, {}, {}, {}, {})
        nodes = [np.asarray(tyre.mesh.mesh.p) for tyre in tyres]
        for region in self.base.bodies:
            e = self.ops.elements(region)
            n_q = len(self.shape.reference.quadrature[1])
            elements, points = np.repeat(e, n_q), np.tile(np.arange(n_q), len(e))
            volumes, metrics = [], []
            for tyre, p in zip(tyres, nodes, strict=True):
                at = self.shape.places(p, elements, points)
                direction = tyre.mesh.along_meridian if region in self.directed else None
                volumes.append(at.w)
                metrics.append(_metric(at, direction).reshape(-1))
            modes, numbers, fit = interpolation(np.array(volumes), tolerance, MOST)
            result.volume[region] = Sampled(elements[numbers], points[numbers], fit)  # type: ignore[index]
            self._volume(result, region, e, modes)
            modes, result.metric[region] = _grouped(np.array(metrics), elements, points, tolerance)  # type: ignore[index]
            result.conduction[region] = self._conduction(region, e, modes)  # type: ignore[index]
        for side, edges in self.shape.edges.items():
            weights = np.array([edges.weights(p) for p in nodes])
            modes, _, _ = interpolation(weights, tolerance, MOST)
            result.area[side] = modes.T  # type: ignore[index]
            trace = self.ops.surface(side).trace @ self.V[self.ops.surface(side).dofs]
            films = np.einsum("qk,qi,qj->kij", modes, trace, trace, optimize=True)
            result.films[side] = films, modes.T @ trace, modes.sum(axis=0)  # type: ignore[index]
        return result

    def _volume(self, result: Any, region: str, e: Numbers, modes: Array) -> None:
        """Masses, stored heat, loads and powers of the region's modes of weights, (points, K)."""
        pairs, K, m = self.shape.reference.mass_pairs, modes.shape[1], self.V.shape[1]
        zones = [zone for zone in self.zone_rows if np.isin(self.ops.elements(zone), e).all()]
        samples = next((rows.shape[1] for rows in self.zone_rows.values()), 0)
        mass, stored = np.empty((K, m, m)), np.empty((K, m))
        load, power = np.zeros((K, m, samples)), np.zeros((K, len(self.zone_rows), samples))
        dofs = self.ops.dofs(region)
        of_zone = {zone: np.isin(e, self.ops.elements(zone)) for zone in zones}
        for k in range(K):
            local = (modes[:, k].reshape(len(e), -1) @ pairs).T
            rows = self._matrix(e, local)[dofs]
            times_modes = rows @ self.V
            mass[k], stored[k] = self.V[dofs].T @ times_modes, times_modes.sum(axis=0)
            for zone, chosen in of_zone.items():
                here, number = self.ops.dofs(zone), list(self.zone_rows).index(zone)
                matrix = self._matrix(e[chosen], local[:, chosen])[here]
                load[k] += (matrix @ self.V).T @ self.zone_rows[zone]
                power[k, number] = np.asarray(matrix.sum(axis=1)).ravel() @ self.zone_rows[zone]
        result.mass[region], result.stored[region] = mass, stored
        result.load[region], result.power[region] = load, power

    def _conduction(self, region: str, e: Numbers, modes: Array) -> Array:
        """(1 or 2, K, m, m): conduction of the region's modes of tensors, (points * entries, K)."""
        pairs, m, dofs = self.shape.reference.slope_pairs, self.V.shape[1], self.ops.dofs(region)
        n_q, directions = len(pairs), 2 if region in self.directed else 1
        matrices = np.empty((directions, modes.shape[1], m, m))
        flat = pairs.reshape(n_q * 3, -1)
        for k in range(modes.shape[1]):
            entries = modes[:, k].reshape(len(e), n_q, directions, 3)
            for number in range(directions):
                local = (entries[:, :, number].reshape(len(e), -1) @ flat).T
                matrices[number, k] = self.V[dofs].T @ (self._matrix(e, local)[dofs] @ self.V)
        return matrices

    def _matrix(self, elements: Numbers, local: Array) -> Any:
        """Sparse matrix of element matrices (n_local^2, n_elements)."""
        place = self.ops.place[:, :, elements].reshape(-1)
        return self.ops.matrix(np.bincount(place, weights=local.reshape(-1), minlength=self.ops.nnz))


def _grouped(features: Array, elements: Numbers, points: Numbers, tolerance: float) -> tuple[Array, Sampled]:
    """Modes and samples of tensors: all entries at a quadrature point are sampled together."""
    entries = features.shape[1] // len(elements)
    # Entries along, across and mixed differ in size: each has its own scale, so that none is neglected.
    scale = np.sqrt((features.reshape(len(features), -1, entries) ** 2).mean(axis=(0, 1)))
    scale = np.tile(np.where(scale > 0, scale, 1.0), len(elements))
    modes, numbers, _ = interpolation(features / scale, tolerance, MOST)
    chosen = np.unique(numbers // entries)
    rows = (chosen[:, None] * entries + np.arange(entries)).reshape(-1)
    fit = np.linalg.pinv(modes[rows]) / scale[rows]
    return modes * scale[:, None], Sampled(elements[chosen], points[chosen], fit)
