"""The tyre in small motions with all its cords taut: it leads the search for large motions."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.elements import COMPONENTS
from tyrefem.mechanics.footprint.harmonics import SYMMETRIC, Harmonics
from tyrefem.mechanics.footprint.tyre_on_road import TyreOnRoad
from tyrefem.mechanics.solid.body import Prestressed
from tyrefem.mechanics.solid.finite_law import BodyLaw

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
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


@dataclass(frozen=True, eq=False)
class TautTyre:
    """Factors of K_n of the `tautened` tyre for every harmonic, computed once. tyre : the inflated tyre."""

    tyre: TyreOnRoad
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

    def factor(self, n: int) -> Any:
        """SuperLU factors of a harmonic's free degrees of freedom, with a cache."""
        from scipy.sparse.linalg import splu

        if n not in self._factors:
            matrix = self.harmonics.stiffness(n)[self.free][:, self.free].tocsc()
            try:
                self._factors[n] = splu(matrix, permc_spec="MMD_AT_PLUS_A", **SYMMETRIC)
            except RuntimeError:
                raise InputError(f"harmonic {n:g} has no stiffness: nothing holds the body") from None
        return self._factors[n]

    def under_tread(self, n: int) -> tuple[Any, Array]:
        """Displacements of a harmonic under unit loads on the tread, m per N per radian, with a cache: (n_free, 3 m) in
        single precision, and (3 m, 3 m) of the tread."""
        if n not in self._under_tread:
            dofs = self.tread.ravel()
            places = np.searchsorted(self.free, dofs)
            loaded = np.flatnonzero(np.isin(dofs, self.free))
            moved = np.zeros((len(self.free), len(dofs)), dtype=np.float32)
            at_tread = np.zeros((len(dofs), len(dofs)))
            factor = self.factor(n)
            for columns in np.array_split(loaded, max(1, len(loaded) // AT_ONCE)):
                loads = np.zeros((len(self.free), len(columns)))
                loads[places[columns], np.arange(len(columns))] = 1.0
                solved = factor.solve(loads)
                moved[:, columns] = solved
                at_tread[np.ix_(loaded, columns)] = solved[places[loaded]]
            self._under_tread[n] = moved, at_tread
        return self._under_tread[n]

    def compliance(self, loads: Array, rows: Array) -> Array:
        """(k, k) displacement rows . u under loads on the tread's amplitudes, both (k, n, 3 m)."""
        count, harmonics = loads.shape[:2]
        moved = np.empty((count, harmonics, self.tread.size))
        for n in range(harmonics):
            moved[:, n] = loads[:, n].reshape(count, -1) @ self.under_tread(n)[1]
        return np.asarray(rows.reshape(count, -1) @ moved.reshape(count, -1).T)

    def solve(self, forces: Array) -> Array:
        """(n, n_dofs) displacements, m, under forces (n, n_dofs), N per radian, of the first n harmonics."""
        displacements = np.zeros_like(forces)
        for n, force in enumerate(forces):
            displacements[n, self.free] = self.factor(n).solve(force[self.free])
        return displacements

    def solve_tread(self, loads: Array) -> Array:
        """(n, n_dofs) displacements, m, under loads (n, 3, m), N per radian, on the tread."""
        displacements = np.zeros((len(loads), self.harmonics.elements.n_dofs))
        for n, load in enumerate(loads):
            displacements[n, self.free] = self.under_tread(n)[0] @ load.ravel().astype(np.float32)
        return displacements

    @staticmethod
    def work(forces: Array, motion: Array) -> float:
        """Work on the whole wheel over pi, J: n = 0 counts twice."""
        return float(np.vdot(forces, motion) + np.vdot(forces[0], motion[0]))
