"""Waves that stand still while a spinning body turns through them: critical speeds, harmonic by harmonic."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.harmonics import SYMMETRIC
from tyrefem.mechanics.footprint.vibration import Mode, Vibration

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
#: Relative error of the squared angular speeds.
ACCURACY = 1e-9


def steady_mass(mass: Any, n: float) -> Any:
    """M_n of steady motions, kg per radian, from the `mass_matrix` M of a body (component order r, z, t).

    v M_n u = (n^2 + 1)(v_r M u_r + v_t M u_t) + 2 n (v_r M u_t + v_t M u_r) + n^2 v_z M u_z. Its eigenvalues over M are
    (n - 1)^2, n^2 and (n + 1)^2: it is positive definite for n >= 2.

    >>> steady_mass(sp.identity(3), 2).toarray().tolist()
    [[5.0, 0.0, 4.0], [0.0, 4.0, 0.0], [4.0, 0.0, 5.0]]
    """
    pattern = np.array([[n**2 + 1, 0.0, 2 * n], [0.0, n**2, 0.0], [2 * n, 0.0, n**2 + 1]])
    return sp.kron(sp.csc_matrix(mass)[::3, ::3], pattern, format="csc")


@dataclass(frozen=True, eq=False)
class CriticalWave(Brief):
    """A wave of ``harmonic`` crests that stands still at ``angular_speed``, rad/s: K_n x = W^2 M_n x.

    ``shape`` : (n_dofs,) amplitudes (u_r cos n t, u_z cos n t, u_t sin n t) with shape M_n shape = 1.
    ``symmetric`` : as of `Mode`.
    """

    harmonic: int
    angular_speed: float
    shape: Array
    symmetric: bool | None = None

    @property
    def mode(self) -> Mode:
        """The wave as a mode, for its shares of energy; the frequency is that of a point of the tyre, n W/(2 pi)."""
        frequency = self.harmonic * self.angular_speed / (2 * np.pi)
        return Mode(self.harmonic, frequency, self.shape, self.symmetric)


@dataclass(frozen=True, eq=False)
class SteadyWaves(Brief):
    """Free steady motions of a spinning body: K_n x = W^2 M_n x, n >= 2.

    Below the smallest W the dynamic stiffness K_n - W^2 M_n is positive definite; at it the wave needs no force, and
    above it a footprint leaves a wave behind.

    Parameters
    ----------
    vibration : elastic stiffness K_n (without inertia) about the spinning body's shape, and its mass. The shape depends
        on W, so a critical speed holds where it is that of the shape.
    """

    vibration: Vibration

    def waves(self, harmonic: int, count: int = 1) -> tuple[CriticalWave, ...]:
        """The ``count`` slowest waves of each family (symmetric or not), in order of speed.

        Raises
        ------
        InputError : a harmonic below 2; a state that is not stable.
        """
        if harmonic < 2:
            raise InputError(f"standing waves have two or more crests, not {harmonic}", field="harmonic")
        waves = [
            wave
            for symmetric, free in self.vibration.families.items()
            for wave in self._family(harmonic, count, symmetric, free)
        ]
        return tuple(sorted(waves, key=lambda wave: wave.angular_speed))

    def _family(self, harmonic: int, count: int, symmetric: bool | None, free: Indices) -> list[CriticalWave]:
        from scipy.sparse.linalg import LinearOperator, eigsh, splu

        vibration = self.vibration
        stiffness = vibration.harmonics.stiffness(harmonic)[free][:, free].tocsc()
        mass = steady_mass(vibration.mass, harmonic)[free][:, free].tocsc()
        factor = splu(stiffness, permc_spec="MMD_AT_PLUS_A", **SYMMETRIC)
        if (factor.U.diagonal() <= 0).any():
            raise InputError(f"the state is not stable: harmonic {harmonic} has negative stiffness")
        inverse = LinearOperator(stiffness.shape, matvec=factor.solve, dtype=float)
        count = min(count, len(free) - 1)
        squares, vectors = eigsh(
            stiffness, count, mass, sigma=0.0, which="LM", OPinv=inverse, tol=ACCURACY,
            v0=np.random.default_rng(0).normal(size=len(free)), ncv=min(len(free), max(2 * count + 1, 20)),
        )  # fmt: skip
        waves = []
        for square, vector in zip(squares, vectors.T, strict=True):
            shape = np.zeros(vibration.harmonics.elements.n_dofs)
            shape[free] = vector * np.sign(vector[np.abs(vector).argmax()])
            waves.append(CriticalWave(harmonic, float(np.sqrt(square)), shape, symmetric))
        return waves
