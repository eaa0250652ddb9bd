"""Energy lost per revolution: the loss of every strain harmonic at its frequency."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.errors import InputError, nearest
from tyrefem.inputs.motion import Motion
from tyrefem.materials.card import MaterialCard, strain_laws
from tyrefem.materials.loss_tangent import Loss
from tyrefem.materials.strain_dependence import StrainDependence
from tyrefem.mechanics.footprint.strain_amplitude import StrainAmplitude
from tyrefem.mechanics.footprint.strain_harmonics import StrainHarmonics

Array = NDArray[np.float64]
#: Energy lost per cycle over U tan d: pi for the report's U (Clark & Dodge 1980, eq 25), 2 pi for U = E' e0^2 / 2.
ONE_CYCLE = {"nasa": np.pi, "sinusoid": 2 * np.pi}


@dataclass(frozen=True, eq=False)
class RevolutionLoss(Brief):
    """Energy dissipated per revolution: w = sum_n n pi tan d(n f, T) e_n : C' : e_n, J/m3, f = v / (2 pi R_r).

    A point runs n cycles of amplitude e_n per revolution, and each loses pi E'' e_n^2. Harmonics are orthogonal over
    the revolution, so their losses add up.

    Parameters
    ----------
    cycle : strains over a revolution.
    tangents : region -> tan delta; regions without one lose nothing.
    speed : m/s.
    temperature : degC, one number or (n_elements, n_points).
    strain_laws : region -> moduli of its compound over strain; its loss modulus is then that of each point's shear
        strain amplitude (`strain_amplitude`), alike at every harmonic. Cords and other regions do not change.

    Raises
    ------
    InputError : a region that the mesh does not have; a speed that is not positive.
    """

    cycle: StrainHarmonics
    tangents: Mapping[str, Loss]
    speed: float
    temperature: float | Array = 25.0
    strain_laws: Mapping[str, StrainDependence] = field(default_factory=dict)

    @classmethod
    def of_cards(
        cls, cycle: StrainHarmonics, cards: Mapping[str, MaterialCard], speed: float, temperature: float | Array
    ) -> RevolutionLoss:
        """With the laws of the cards of regions: tan delta over frequency and temperature, loss modulus over strain."""
        tangents = {region: card.loss_tangent.over_frequency for region, card in cards.items()}
        return cls(cycle, tangents, speed, temperature, strain_laws(cards))

    def __post_init__(self) -> None:
        regions = self.cycle.elements.mesh.subdomains or {}
        for region in (*self.tangents, *self.strain_laws):
            if region not in regions:
                raise InputError(f"the mesh has no region '{region}'{nearest(region, regions)}")
        if not self.speed > 0:
            raise InputError(f"the speed must be positive, not {self.speed:g} m/s", field="speed")

    @functools.cached_property
    def frequency(self) -> float:
        """Revolutions per second."""
        return Motion(self.speed, rolling_radius=self.cycle.footprint.rolling_radius).revolutions_per_second

    def tangent(self, frequency: float) -> Array:
        """(n_elements, n_points) tan delta at a frequency, Hz."""
        elements = self.cycle.elements
        temperature = np.broadcast_to(np.asarray(self.temperature, dtype=float), elements.radii.shape)
        tangent = np.zeros(elements.radii.shape)
        for region, law in self.tangents.items():
            members = np.asarray(elements.mesh.subdomains[region])
            tangent[members] = law(frequency, temperature[members])
        return tangent

    @functools.cached_property
    def strain(self) -> StrainAmplitude:
        """The shear strain amplitude of every point."""
        return StrainAmplitude(self.cycle, self.strain_laws)

    @functools.cached_property
    def effective_products(self) -> Array:
        """(harmonics + 1, n_elements, n_points) e_n : C' : e_n with the loss of each point's strain amplitude, J/m3."""
        products = self.cycle.storage_products
        return self.strain.effective(products, self.cycle.rubber_products) if self.strain_laws else products

    @functools.cached_property
    def densities(self) -> Array:
        """(harmonics + 1, n_elements, n_points) energy lost per revolution by each harmonic, J/m3."""
        products = self.effective_products
        densities = np.zeros_like(products)
        for n in range(1, len(products)):
            densities[n] = n * np.pi * self.tangent(n * self.frequency) * products[n]
        return densities

    @property
    def density(self) -> Array:
        """(n_elements, n_points) energy lost per revolution, J/m3."""
        return np.asarray(self.densities.sum(axis=0))

    def one_cycle_density(self, convention: str = "nasa", count: int = 180) -> Array:
        """(n_elements, n_points) J/m3 if the revolution were one cycle, as in the NASA report: pi U tan d(f).

        U is `StrainHarmonics.largest_energy`; ``sinusoid`` takes 2 pi, exact for one sinusoid of that amplitude. The
        loss modulus follows the strain amplitude as with harmonics.
        """
        if convention not in ONE_CYCLE:
            raise InputError(f"no convention '{convention}'{nearest(convention, ONE_CYCLE)}")
        largest = self.cycle.largest_energy(count)
        if self.strain_laws:
            largest = largest * self.strain.factor
        return np.asarray(ONE_CYCLE[convention] * self.tangent(self.frequency) * largest)

    def total(self, density: Array) -> float:
        """Integral of a density over the whole tyre, e.g. J from J/m3."""
        both = 2.0 if self.cycle.footprint.pressing.tread.half else 1.0
        return float(both * 2 * np.pi * (density * self.cycle.elements.weights).sum())

    @functools.cached_property
    def by_harmonic(self) -> Array:
        """(harmonics + 1,) energy lost per revolution by each harmonic, J."""
        return np.array([self.total(density) for density in self.densities])

    @functools.cached_property
    def stored_by_harmonic(self) -> Array:
        """(harmonics + 1,) elastic energy of each strain harmonic in the dissipating parts, mean over the wheel, J."""
        stored = np.array([self.total(products) / 4 for products in self.cycle.storage_products])
        stored[0] *= 2
        return stored

    @functools.cached_property
    def by_region(self) -> dict[str, float]:
        """Region -> energy lost per revolution, J."""
        density, totals = self.density, {}
        for region in self.tangents:
            inside = np.zeros_like(density)
            members = np.asarray(self.cycle.elements.mesh.subdomains[region])
            inside[members] = density[members]
            totals[region] = self.total(inside)
        return totals

    @property
    def energy(self) -> float:
        """Energy lost per revolution, J."""
        return float(self.by_harmonic.sum())

    @property
    def heat_source(self) -> Array:
        """(n_elements,) mean heat source of each element, W/m3."""
        weights = self.cycle.elements.weights
        return np.asarray(self.frequency * (self.density * weights).sum(axis=1) / weights.sum(axis=1))

    @property
    def rolling_resistance(self) -> float:
        """Force, N: energy lost per metre rolled."""
        return self.energy / (2 * np.pi * self.cycle.footprint.rolling_radius)

    @property
    def coefficient(self) -> float:
        """Rolling resistance over load; zero without load."""
        load = self.cycle.footprint.load
        return self.rolling_resistance / load if load > 0 else 0.0
