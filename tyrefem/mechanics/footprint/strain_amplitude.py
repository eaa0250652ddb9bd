"""Shear strain amplitude of every point over a revolution, and what it does to the loss of its compound."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.materials.strain_dependence import StrainDependence
from tyrefem.mechanics.footprint.strain_harmonics import StrainHarmonics

Array = NDArray[np.float64]
#: Angles on each side of the footprint's middle, denser there; elements at a time.
ANGLES, CHUNK = 32, 128
#: Squares of the components rr, zz, tt and of the engineering shears rz, rt, zt in the squared shear strain.
WEIGHTS = np.array([2.0, 2.0, 2.0, 1.0, 1.0, 1.0])


def shear_amplitude(strain: Array, *, mirrored: bool = False) -> Array:
    """(...) half the largest distance between two states of a cycle (6, ..., n), as equivalent shear strain.

    The distance of two states is sqrt(2 d':d'), d' the deviator of their difference: simple shear between -g and g has
    the amplitude g. Order rr, zz, tt, rz, rt, zt; engineering shears. ``mirrored``: the states are one side of a cycle,
    and the other side has the opposite rt and zt.

    >>> swing = np.zeros((6, 1, 3))
    >>> swing[3, 0] = [-0.02, 0.0, 0.02]
    >>> shear_amplitude(swing).tolist()
    [0.02]
    >>> one_side = np.zeros((6, 1, 2))
    >>> one_side[5, 0] = [0.0, 0.02]
    >>> shear_amplitude(one_side).tolist(), shear_amplitude(one_side, mirrored=True).tolist()
    ([0.01], [0.02])
    """
    states = np.array(strain, dtype=float)
    states[:3] -= states[:3].mean(axis=0)
    states = np.moveaxis(states, 0, -1) * np.sqrt(WEIGHTS)
    if not mirrored:
        states -= states[..., :1, :]
        squares = (states**2).sum(axis=-1)
        distances = squares[..., :, None] + squares[..., None, :] - 2 * states @ states.swapaxes(-1, -2)
    else:
        even, odd = states[..., :4] - states[..., :1, :4], states[..., 4:]
        squares = (even**2).sum(axis=-1) + (odd**2).sum(axis=-1)
        products = even @ even.swapaxes(-1, -2) - np.abs(odd @ odd.swapaxes(-1, -2))
        distances = squares[..., :, None] + squares[..., None, :] - 2 * products
    return np.asarray(np.sqrt(np.maximum(distances.max(axis=(-1, -2)), 0.0)) / 2)


@dataclass(frozen=True, eq=False)
class StrainAmplitude(Brief):
    """The amplitude of every Gauss point, and the loss and stiffness of compounds at it.

    Parameters
    ----------
    cycle : strains over a revolution. laws : region -> its compound's moduli over strain; other regions do not change.
    """

    cycle: StrainHarmonics
    laws: Mapping[str, StrainDependence]

    @functools.cached_property
    def amplitudes(self) -> Array:
        """(n_elements, n_points) shear strain amplitude over a revolution."""
        angles = np.pi * np.linspace(0, 1, ANGLES + 1) ** 2
        mirrored = self.cycle.mirrored
        if not mirrored:
            angles = np.concatenate([-angles[:0:-1], angles[:-1]])
        count = len(self.cycle.elements.radii)
        chunks = [np.arange(start, min(start + CHUNK, count)) for start in range(0, count, CHUNK)]
        return np.concatenate(
            [shear_amplitude(self.cycle.strain(angles, chunk), mirrored=mirrored) for chunk in chunks]
        )

    @functools.cached_property
    def lossiness(self) -> Array:
        """(n_elements, n_points) loss modulus of the compound over tan delta times modulus of its card."""
        factors = np.ones(self.cycle.elements.radii.shape)
        for region, law in self.laws.items():
            members = self._members(region)
            factors[members] = law.lossiness(self.amplitudes[members])
        return factors

    def effective(self, products: Array, rubber: Array) -> Array:
        """Products e : C' : e with the compound's part ``rubber`` times `lossiness`; the same array without laws."""
        return products + (self.lossiness - 1) * rubber if self.laws else products

    @functools.cached_property
    def factor(self) -> Array:
        """(n_elements, n_points) loss of a point over that without strain dependence, alike at every frequency."""
        orders = np.arange(len(self.cycle.storage_products))[:, None, None]
        total, rubber = (
            (orders * products).sum(axis=0) for products in (self.cycle.storage_products, self.cycle.rubber_products)
        )
        return np.asarray(self.effective(total, rubber) / np.maximum(total, 1e-300))

    def mean_amplitude(self, region: str) -> float:
        """The amplitude at which the region's compound stores as much as all its points together.

        G'(mean) = sum G'(g) g^2 dV / sum g^2 dV; 0 without strain.
        """
        members, law = self._members(region), self.laws[region].kraus
        amplitudes = self.amplitudes[members]
        weights = amplitudes**2 * self.cycle.elements.weights[members]
        if not weights.any():
            return 0.0
        return law.amplitude(float((law.storage(amplitudes) * weights).sum() / weights.sum()))

    def _members(self, region: str) -> NDArray[np.int64]:
        return np.asarray((self.cycle.elements.mesh.subdomains or {})[region])
