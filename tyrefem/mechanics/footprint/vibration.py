"""Free vibration of a pre-stressed body of revolution, harmonic by harmonic: mass matrix, frequencies, shapes."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.elements import COMPONENTS, SectionElements
from tyrefem.mechanics.footprint.harmonics import SYMMETRIC, Harmonics

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

#: Shift of the inverse iteration below zero, Hz: free bodies have motions without stiffness.
SHIFT = 3.0
#: Squared frequency, over that of the shift, below which a state counts as unstable.
UNSTABLE = -0.5
#: Relative error of the squared frequencies.
ACCURACY = 1e-10

#: Rigid motions of a ring: name -> harmonic, and True if they mirror themselves in the mid plane.
RIGID = {
    "lateral": (0, False),
    "wind-up": (0, True),
    "fore-aft and vertical": (1, True),
    "yaw and camber": (1, False),
}


def mass_matrix(elements: SectionElements, density: Array) -> Any:
    """Consistent mass M of every harmonic, sparse (n_dofs, n_dofs), kg per radian.

    M_ij = int rho N_i N_j r dA for each component, without coupling. Like the stiffness it is per radian: the kinetic
    energy of a velocity v round the wheel is pi/2 v M v, and pi v M v for n = 0. M is the same for all harmonics.

    Parameters
    ----------
    density : (n_elements, n_points) kg/m3 of the body's present volume.

    >>> import skfem
    >>> elements = SectionElements(skfem.MeshQuad.init_tensor([1.0, 1.1], [0.0, 0.1]))
    >>> axial = np.tile([0.0, 1.0, 0.0], elements.n_nodes)
    >>> mass = mass_matrix(elements, np.full(elements.radii.shape, 1000.0))
    >>> round(float(2 * np.pi * axial @ mass @ axial), 6) == round(np.pi * (1.1**2 - 1.0) * 0.1 * 1000, 6)
    True
    """
    values = elements.values
    local = np.einsum("eq,qa,qb->eab", np.asarray(density) * elements.weights, values, values)
    nodes, n = elements.element_nodes, elements.n_nodes
    place = (np.repeat(nodes, nodes.shape[1], axis=1).ravel(), np.tile(nodes, (1, nodes.shape[1])).ravel())
    scalar = sp.coo_matrix((local.ravel(), place), shape=(n, n))
    return sp.kron(scalar, sp.identity(COMPONENTS), format="csc")


def rigid_motion(elements: SectionElements, name: str) -> Array:
    """(n_dofs,) amplitudes of one of the motions `RIGID`, m per m or per radian."""
    r, z = elements.nodes
    zero, unit = np.zeros_like(r), np.ones_like(r)
    motions = {
        "lateral": (zero, unit, zero),
        "wind-up": (zero, zero, r),
        "fore-aft and vertical": (unit, zero, -unit),
        "yaw and camber": (-z, r, z),
    }
    return np.stack(motions[name], axis=1).ravel()


@dataclass(frozen=True, eq=False)
class Mode(Brief):
    """A free vibration of harmonic ``harmonic``; for n >= 1 it exists twice, a quarter wave apart.

    Parameters
    ----------
    frequency : Hz.
    shape : (n_dofs,) amplitudes (u_r cos n t, u_z cos n t, u_t sin n t) with shape M shape = 1.
    symmetric : True, False: a motion that mirrors itself in the mid plane, or its opposite; None: a full section.
    """

    harmonic: int
    frequency: float
    shape: Array
    symmetric: bool | None = None


@dataclass(frozen=True, eq=False)
class Vibration(Brief):
    """Small free motions about a state: K_n x = w^2 M x on the free degrees of freedom.

    Frequencies come from Lanczos iteration with (K_n + s^2 M)^-1, s = 2 pi `SHIFT`, one factorisation per harmonic
    and family.
    A half section has two families. Symmetric motions have u_z = 0 on the mid plane, the others u_r = u_t = 0.

    Parameters
    ----------
    harmonics : stiffness K_n. density : (n_elements, n_points) kg/m3 of the present volume.
    """

    harmonics: Harmonics
    density: Array

    @functools.cached_property
    def mass(self) -> Any:
        """`mass_matrix`."""
        return mass_matrix(self.harmonics.elements, self.density)

    @functools.cached_property
    def families(self) -> dict[bool | None, Indices]:
        """Symmetric or not -> free degrees of freedom; None: a full section, all in one."""
        harmonics = self.harmonics
        state, elements = harmonics.state, harmonics.elements
        if state.symmetric not in (state.mesh.boundaries or {}):
            return {None: harmonics.free}
        middle = COMPONENTS * elements.boundary_nodes(state.symmetric)
        fixed = [np.zeros(0, dtype=np.int64)]
        for name in state.fixed:
            nodes = elements.boundary_nodes(name)
            fixed.append((COMPONENTS * nodes[:, None] + np.arange(COMPONENTS)).ravel())
        held = np.unique(np.concatenate([*fixed, middle, middle + 2]))
        return {True: harmonics.free, False: np.setdiff1d(np.arange(elements.n_dofs), held)}

    def modes(self, harmonic: int, count: int) -> tuple[Mode, ...]:
        """The ``count`` lowest modes of a harmonic, in order of frequency.

        Raises
        ------
        InputError : the state is not stable in this harmonic.
        """
        modes = [
            mode for symmetric, free in self.families.items() for mode in self._family(harmonic, count, symmetric, free)
        ]
        return tuple(sorted(modes, key=lambda mode: mode.frequency)[:count])

    def _family(self, harmonic: int, count: int, symmetric: bool | None, free: Indices) -> list[Mode]:
        from scipy.sparse.linalg import LinearOperator, eigsh, splu

        shift = (2 * np.pi * SHIFT) ** 2
        stiffness = self.harmonics.stiffness(harmonic)[free][:, free].tocsc()
        mass = self.mass[free][:, free].tocsc()
        factor = splu((stiffness + shift * mass).tocsc(), permc_spec="MMD_AT_PLUS_A", **SYMMETRIC)
        inverse = LinearOperator(stiffness.shape, matvec=factor.solve, dtype=float)
        count = min(count, len(free) - 1)
        start = np.random.default_rng(0).normal(size=len(free))
        squares, vectors = eigsh(
            stiffness, count, mass, sigma=-shift, which="LM", OPinv=inverse, tol=ACCURACY, v0=start,
            ncv=min(len(free), max(2 * count + 1, 20)),
        )  # fmt: skip
        if (squares < UNSTABLE * shift).any() or (factor.U.diagonal() < 0).any():
            raise InputError(f"the state is not stable: harmonic {harmonic} has negative stiffness")
        modes = []
        for square, vector in zip(squares, vectors.T, strict=True):
            shape = np.zeros(self.harmonics.elements.n_dofs)
            shape[free] = vector * np.sign(vector[np.abs(vector).argmax()])
            modes.append(Mode(harmonic, float(np.sqrt(max(square, 0.0)) / (2 * np.pi)), shape, symmetric))
        return modes

    def shares(self, mode: Mode, members: Indices) -> dict[str, float]:
        """What a mode is, by the kinetic energy of some elements ``members`` (the belt's).

        ``radial``, ``lateral``, ``circumferential``: share of each component in these elements' energy; ``belt``: their
        energy over the body's, relative to their share of the mass.
        """
        elements = self.harmonics.elements
        weights = self.density * elements.weights
        at_points = elements.values @ mode.shape.reshape(-1, COMPONENTS)[elements.element_nodes[members]]
        parts = [float(part) for part in np.einsum("eq,eqc->c", weights[members], at_points**2)]
        total = sum(parts)
        motion = total / float(mode.shape @ self.mass @ mode.shape) * float(weights.sum() / weights[members].sum())
        names = ("radial", "lateral", "circumferential")
        return {**{name: part / total for name, part in zip(names, parts, strict=True)}, "belt": motion}

    def opposed(self, mode: Mode, members: Indices) -> bool:
        """Whether the two edges of some elements (the belt's) move radially against each other.

        A motion that mirrors itself in the mid plane of a half section never does, the others always.
        """
        if mode.symmetric is not None:
            return not mode.symmetric
        elements = self.harmonics.elements
        z = elements.points[1][members].mean(axis=1)
        edges = members[[z.argmin(), z.argmax()]]
        first, last = mode.shape[COMPONENTS * elements.element_nodes[edges]].mean(axis=1)
        return bool(first * last < 0)

    def rigidity(self, mode: Mode, members: Indices) -> dict[str, float]:
        """Motion of `RIGID` -> its share in the kinetic energy of the elements ``members``: (x M y)^2/(x M x y M y)."""
        mass, shares = self._mass_of(members), {}
        for name, (harmonic, symmetric) in RIGID.items():
            if harmonic == mode.harmonic and mode.symmetric in (symmetric, None):
                motion = rigid_motion(self.harmonics.elements, name)
                cross, size = motion @ mass @ mode.shape, motion @ mass @ motion
                shares[name] = float(cross**2 / (size * (mode.shape @ mass @ mode.shape)))
        return shares

    def _mass_of(self, members: Indices) -> Any:
        density = np.zeros_like(self.density)
        density[members] = self.density[members]
        return mass_matrix(self.harmonics.elements, density)
