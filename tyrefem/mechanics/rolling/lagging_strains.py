"""Strains of a rolling tyre with loss over a revolution: they lag, so every harmonic has cosines and sines."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.footprint.elements import SectionElements
from tyrefem.mechanics.footprint.footprint import Footprint
from tyrefem.mechanics.footprint.strain_harmonics import StrainHarmonics

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


def strain_amplitudes(elements: SectionElements, motion: Complex) -> Complex:
    """(harmonics + 1, 6, n_elements, n_points) E_n of a motion (harmonics + 1, n_dofs), m, as `RollingHarmonics`."""
    return np.stack([elements.strain(n, u.real) + 1j * elements.strain(n, u.imag) for n, u in enumerate(motion)])


def strain_waves(highest: int, angles: Array) -> Complex:
    """(6, highest + 1, n_angles): e^(i n t) for rr, zz, tt, rz, and -i e^(i n t) for rt, zt."""
    turn = np.exp(1j * np.multiply.outer(np.arange(highest + 1), np.asarray(angles)))
    return np.stack([turn] * 4 + [-1j * turn] * 2)


class RollingHarmonics(Protocol):
    """A rolling tyre whose harmonics have cosines and sines."""

    @property
    def harmonics(self) -> int:
        """Highest harmonic."""

    @property
    def deflection(self) -> float:
        """m."""

    @property
    def amplitudes(self) -> Complex:
        """(harmonics + 1, n_dofs) complex amplitudes U, m, of u = Re((U_r, U_z, -i U_t) e^(i n t))."""


@dataclass(frozen=True, eq=False)
class LaggingFootprint(Footprint):
    """A footprint without loss, beside the tyre that rolls with loss at the same deflection.

    Pressure, length and stiffness are those without loss; loss changes them by its second power, and shifts them.

    Parameters
    ----------
    rolling : the tyre with loss. travel : m rolled per radian, speed over W.
    """

    rolling: RollingHarmonics | None = None
    travel: float = 0.0

    @property
    def lagging(self) -> RollingHarmonics:
        """The tyre with loss."""
        assert self.rolling is not None
        return self.rolling

    @property
    def cycle(self) -> LaggingStrains:
        """Strains over a revolution."""
        return LaggingStrains(self)

    @property
    def rolling_radius(self) -> float:
        """Speed over W, m; the computed motion's differs by what the last guess of W left."""
        return self.travel


@dataclass(frozen=True, eq=False)
class LaggingStrains(StrainHarmonics):
    """e(t) = Re(E_n e^(i n t)) for rr, zz, tt, rz and Re(-i E_n e^(i n t)) for rt, zt; ``amplitudes`` E_n are complex.

    ``footprint`` : a `LaggingFootprint`.
    """

    @property
    def _lagging(self) -> RollingHarmonics:
        assert isinstance(self.footprint, LaggingFootprint)
        return self.footprint.lagging

    @property
    def mirrored(self) -> bool:
        """False: the strains lag."""
        return False

    @functools.cached_property
    def amplitudes(self) -> Any:
        """(harmonics + 1, 6, n_elements, n_points) complex E_n."""
        return strain_amplitudes(self.elements, self._lagging.amplitudes)

    def waves(self, angles: Array) -> Any:
        """(6, harmonics + 1, n_angles) complex: e^(i n t), and -i e^(i n t) for rt and zt."""
        return strain_waves(len(self.amplitudes) - 1, angles)

    def strain(self, angles: Array, elements: Any = slice(None)) -> Array:
        """(6, n_elements, n_points, n_angles) strain of chosen elements at angles, rad."""
        return np.asarray(
            np.einsum("ncep,cnt->cept", self.amplitudes[:, :, elements], self.waves(angles), optimize=True).real
        )

    def _products(self, moduli: Array) -> Array:
        storage = np.moveaxis(moduli, (0, 1), (-2, -1))
        products = np.zeros((len(self.amplitudes), *self.elements.radii.shape))
        for n, amplitude in enumerate(self.amplitudes):
            for part in (amplitude.real, amplitude.imag):
                e = np.moveaxis(part, 0, -1)[..., None]
                products[n] += ((storage @ e) * e).sum(axis=(-2, -1))
        return products

    def cycle_angles(self, count: int) -> Array:
        """(2 count - 1,) all round: the two sides differ."""
        return np.linspace(-np.pi, np.pi, 2 * count - 1)
