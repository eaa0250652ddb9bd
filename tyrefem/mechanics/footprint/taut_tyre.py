"""The tyre in small motions with all its cords taut: it leads the search for large motions."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.cache import Cache
from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.elements import COMPONENTS
from tyrefem.mechanics.footprint.harmonics import SYMMETRIC, Harmonics
from tyrefem.mechanics.footprint.tyre_on_road import TyreOnRoad
from tyrefem.mechanics.solid.body import Prestressed
from tyrefem.mechanics.solid.body_law import BodyLaw

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
#: Neighbouring harmonics share factors up to this ratio of highest to lowest.
SHARED = 1.3
#: Right-hand sides that are solved at once: more do not stay in the processor's cache.
AT_ONCE = 8


def tautened(state: Prestressed) -> Prestressed:
    """The state with every cord as stiff as under tension.

    The preconditioner must not be much softer than the tyre anywhere: cords that are slack after inflation may be taut
    under load.
    """
    if not isinstance(state.law, BodyLaw):
        return state
    return replace(state, tangent=state.tangent + state.law.slack())


def shared(count: int) -> list[range]:
    """The first ``count`` harmonics in groups that share factors.

    >>> [list(group) for group in shared(9)]
    [[0], [1], [2], [3], [4, 5], [6, 7], [8]]
    """
    groups, first = [range(1)], 1
    while first < count:
        after = int(SHARED * first) + 1
        groups.append(range(first, min(after, count)))
        first = after
    return groups


@dataclass(frozen=True, eq=False)
class TautTyre:
    """The `tautened` tyre by harmonics; neighbours have the stiffness of one between them. tyre : the inflated tyre.

    The search for a balance needs no more, and several right-hand sides cost hardly more than one. Factors are computed
    once.
    """

    tyre: TyreOnRoad
    #: `compliance` of all points of possible contact by their directions and numbers of harmonics: tyres that this one
    #: leads share it.
    compliances: Cache[Array] = field(default_factory=lambda: Cache(size=2), init=False, repr=False)
    _factors: dict[int, Any] = field(default_factory=dict, init=False, repr=False)
    _under_tread: dict[int, tuple[Any, Array]] = field(default_factory=dict, init=False, repr=False)

    @functools.cached_property
    def harmonics(self) -> Harmonics:
        """Stiffness of every harmonic."""
        return Harmonics(tautened(self.tyre.state))

    @functools.cached_property
    def free(self) -> Indices:
        """Degrees of freedom that are not fixed."""
        return self.harmonics.free

    @functools.cached_property
    def tread(self) -> Indices:
        """(3, m) degrees of freedom of the tread's nodes."""
        return np.asarray(COMPONENTS * self.tyre.tread.nodes + np.arange(COMPONENTS)[:, None])

    def factor(self, first: int) -> Any:
        """SuperLU factors of the free degrees of freedom, for the group that begins with a harmonic, with a cache."""
        from scipy.sparse.linalg import splu

        if first not in self._factors:
            between = math.sqrt(first * int(SHARED * first))
            matrix = self.harmonics.stiffness(between)[self.free][:, self.free].tocsc()
            try:
                self._factors[first] = splu(matrix, permc_spec="MMD_AT_PLUS_A", **SYMMETRIC)
            except RuntimeError:
                raise InputError(f"harmonic {between:g} has no stiffness: nothing holds the body") from None
        return self._factors[first]

    def under_tread(self, first: int) -> tuple[Any, Array]:
        """Displacements of a group of harmonics under unit loads on the tread, m per N per radian, with a cache:
        (n_free, 3 m) in single precision, and (3 m, 3 m) of the tread."""
        if first not in self._under_tread:
            dofs = self.tread.ravel()
            places = np.searchsorted(self.free, dofs)
            loaded = np.flatnonzero(np.isin(dofs, self.free))
            moved = np.zeros((len(self.free), len(dofs)), dtype=np.float32)
            at_tread = np.zeros((len(dofs), len(dofs)))
            factor = self.factor(first)
            for columns in np.array_split(loaded, max(1, len(loaded) // AT_ONCE)):
                loads = np.zeros((len(self.free), len(columns)))
                loads[places[columns], np.arange(len(columns))] = 1.0
                solved = factor.solve(loads)
                moved[:, columns] = solved
                at_tread[np.ix_(loaded, columns)] = solved[places[loaded]]
            self._under_tread[first] = moved, at_tread
        return self._under_tread[first]

    def compliance(self, loads: Array, rows: Array) -> Array:
        """(k, k) displacement rows . u under loads on the tread's amplitudes, both (k, n, 3 m)."""
        count, harmonics = loads.shape[:2]
        moved = np.empty((count, harmonics, self.tread.size))
        for group in shared(harmonics):
            part = slice(group.start, group.stop)
            moved[:, part] = loads[:, part].reshape(count, len(group), -1) @ self.under_tread(group.start)[1]
        return np.asarray(rows.reshape(count, -1) @ moved.reshape(count, -1).T)

    def solve(self, forces: Array) -> Array:
        """(n, n_dofs) displacements, m, under forces (n, n_dofs), N per radian, of the first n harmonics."""
        displacements = np.zeros_like(forces)
        for group in shared(len(forces)):
            part = slice(group.start, group.stop)
            displacements[part, self.free] = self.factor(group.start).solve(forces[part, self.free].T).T
        return displacements

    def solve_tread(self, loads: Array) -> Array:
        """(n, n_dofs) displacements, m, under loads (n, 3, m), N per radian, on the tread."""
        displacements = np.zeros((len(loads), self.harmonics.elements.n_dofs))
        for group in shared(len(loads)):
            part = slice(group.start, group.stop)
            pushed = loads[part].reshape(len(group), -1).astype(np.float32)
            displacements[part, self.free] = pushed @ self.under_tread(group.start)[0].T
        return displacements

    @staticmethod
    def work(forces: Array, motion: Array) -> float:
        """Work on the whole wheel over pi, J: n = 0 counts twice."""
        return float(np.vdot(forces, motion) + np.vdot(forces[0], motion[0]))
