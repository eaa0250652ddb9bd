"""Displacement of the tread under unit loads, by harmonic."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.cache import Cache
from tyrefem.errors import InputError, nearest
from tyrefem.mechanics.footprint.elements import COMPONENTS
from tyrefem.mechanics.footprint.harmonics import Harmonics

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
#: All harmonics up to this one are solved; above it the solved ones grow by a factor, with interpolation between.
ALL_UP_TO = 24
GROWTH = 1.12


@functools.lru_cache(maxsize=64)
def solved_harmonics(highest: int) -> tuple[int, ...]:
    """Harmonics to solve, from which all others up to ``highest`` are interpolated.

    >>> solved_harmonics(40)[-8:]
    (22, 23, 24, 27, 30, 34, 38, 43)
    """
    solved = list(range(min(highest, ALL_UP_TO) + 1))
    while solved[-1] < highest:
        solved.append(max(solved[-1] + 1, round(solved[-1] * GROWTH)))
    return tuple(solved)


def interpolation(highest: int) -> Array:
    """(highest + 1, number solved) weights of the solved harmonics: cubic in log(1 + n) between them."""
    solved = np.array(solved_harmonics(highest), dtype=float)
    weights = np.zeros((highest + 1, len(solved)))
    x, order = np.log1p(solved), min(4, len(solved))
    for n in range(highest + 1):
        first = int(np.clip(np.searchsorted(solved, n) - order // 2, 0, len(solved) - order))
        if n in solved:
            weights[n, int(np.searchsorted(solved, n))] = 1.0
            continue
        near = np.arange(first, first + order)
        for k in near:
            others = near[near != k]
            weights[n, k] = np.prod((np.log1p(n) - x[others]) / (x[k] - x[others]))
    return weights


@dataclass(frozen=True, eq=False)
class TreadCompliance(Brief):
    """Displacements of the tread's nodes per unit load, G_n = T K_n^-1 T', m per N per radian.

    Loads act at the tread's nodes along r, t and, on a full section, z. Each solved harmonic needs one factorisation.
    Between solved harmonics G_n is interpolated: above the first two dozen it is smooth in n.

    Raises
    ------
    InputError : the mesh has no tread boundary.
    """

    harmonics: Harmonics
    #: Compliances of solved harmonics; the cache holds more than `solved_harmonics` of any footprint.
    _solved: Cache[Array] = field(default_factory=lambda: Cache(size=128), init=False, repr=False)
    #: Compliance of the latest harmonics above those of a large motion: footprints take it to other processes.
    _short: dict[tuple[int, int], Array] = field(default_factory=dict, init=False, repr=False)

    def __post_init__(self) -> None:
        state = self.harmonics.state
        if state.tread not in (state.mesh.boundaries or {}):
            raise InputError(f"the mesh has no boundary '{state.tread}'{nearest(state.tread, state.mesh.boundaries)}")

    @property
    def half(self) -> bool:
        """True if the mesh is one half of a symmetric tyre."""
        state = self.harmonics.state
        return state.symmetric in state.mesh.boundaries

    @property
    def components(self) -> tuple[int, ...]:
        """Components of (r, z, t) that are loaded."""
        return (0, 2) if self.half else (0, 2, 1)

    @functools.cached_property
    def nodes(self) -> Indices:
        """Node numbers of the tread, from small to large z."""
        elements = self.harmonics.elements
        numbers = elements.boundary_nodes(self.harmonics.state.tread)
        return numbers[np.argsort(elements.nodes[1, numbers], kind="stable")]

    @functools.cached_property
    def places(self) -> Array:
        """(2, m) tread nodes in (r, z), m."""
        return np.asarray(self.harmonics.elements.nodes[:, self.nodes])

    @functools.cached_property
    def widths(self) -> tuple[Array, Array]:
        """Tributary length of each node on the outline and on its axial projection, (m,), m."""
        facets = self.harmonics.elements.facet_basis(self.harmonics.state.tread)
        values = np.stack([np.broadcast_to(np.asarray(f[0]), facets.dx.shape) for f in facets.basis], axis=0)
        length, axial = np.zeros((2, self.harmonics.elements.nodes.shape[1]))
        across = np.abs(np.asarray(facets.normals)[0])
        np.add.at(length, facets.element_dofs, np.einsum("afq,fq->af", values, facets.dx))
        np.add.at(axial, facets.element_dofs, np.einsum("afq,fq->af", values, facets.dx * across))
        return length[self.nodes], axial[self.nodes]

    @functools.cached_property
    def grooves(self) -> Array:
        """(n, 2) axial intervals without tread, m: between its facets, and at the mid plane of a half."""
        mesh, tread = self.harmonics.state.mesh, self.harmonics.state.tread
        ends = np.sort(mesh.p[1, mesh.facets[:, mesh.boundaries[tread]]], axis=0)
        low, high = ends[:, np.argsort(ends[0])]
        reached = np.maximum.accumulate(high)
        starts = np.concatenate([[0.0 if self.half else low[0]], reached[:-1]])
        open_ = low - starts > 1e-6
        return np.stack([starts[open_], low[open_]], axis=1)

    @functools.cached_property
    def dofs(self) -> Indices:
        """(components, m) degrees of freedom that are loaded."""
        return np.stack([COMPONENTS * self.nodes + c for c in self.components])

    def solved(self, n: int) -> Array:
        """(c, m, c, m) compliance of a solved harmonic, with a cache."""

        def compute() -> Array:
            matrix = self.harmonics.compliance(n, self.dofs.ravel())
            return matrix.reshape(*self.dofs.shape, *self.dofs.shape)

        return self._solved.get(n, compute)

    def up_to(self, highest: int, above: int = -1) -> Array:
        """(highest - above, c, m, c, m) compliance of all harmonics above ``above``; not to be written to."""
        if above < 0:
            return self._interpolated(highest, above)
        if (highest, above) not in self._short:
            self._short.clear()
            self._short[highest, above] = self._interpolated(highest, above)
        return self._short[highest, above]

    def _interpolated(self, highest: int, above: int) -> Array:
        """`up_to` from the solved harmonics."""
        weights = interpolation(highest)[above + 1 :]
        c, m = self.dofs.shape
        total = np.zeros((len(weights), c, m, c, m))
        for column, n in enumerate(solved_harmonics(highest)):
            served = np.flatnonzero(weights[:, column])
            if len(served):
                total[served] += np.multiply.outer(weights[served, column], self.solved(n))
        return total

    def fields(self, loads: Array, above: int = -1) -> Array:
        """(n - above - 1, n_dofs) amplitudes, m, of the harmonics above ``above`` under loads (n, c, m), N per radian,
        at the tread."""
        everywhere = np.zeros((len(loads), self.harmonics.elements.n_dofs))
        everywhere[:, self.dofs.ravel()] = loads.reshape(len(loads), -1)
        return self.responses(everywhere, above)

    def responses(self, loads: Array, above: int = -1) -> Array:
        """(n - above - 1, n_dofs) amplitudes, m, of the harmonics above ``above`` under loads (n, n_dofs), N per
        radian, on any nodes."""
        highest = len(loads) - 1
        weights, displacements = interpolation(highest), np.zeros_like(loads)
        weights[: above + 1] = 0.0
        for column, n in enumerate(solved_harmonics(highest)):
            served = np.flatnonzero(weights[:, column])
            if len(served):
                displacements[served] += weights[served, column, None] * self.harmonics.solve(n, loads[served].T).T
        return displacements[above + 1 :]
