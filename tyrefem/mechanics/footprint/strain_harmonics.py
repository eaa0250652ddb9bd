"""The strain of every point of the section over a revolution."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError, nearest
from tyrefem.mechanics.footprint.elements import SectionElements
from tyrefem.mechanics.footprint.footprint import Footprint

Array = NDArray[np.float64]
COMPONENTS = ("rr", "zz", "tt", "rz", "rt", "zt")


@dataclass(frozen=True)
class LargestEdgeShear:
    """Largest shear strain range over a revolution at the edge of a region; its place (r, z), m, and component."""

    range: float
    place: tuple[float, float]
    component: str


@dataclass(frozen=True)
class LinearisationError:
    """What linear strains leave out of Green's strain, over the linear strain (`StrainHarmonics.coarseness`): root mean
    square by volume, largest value of an element, and the region of that element."""

    mean: float
    greatest: float
    region: str


@dataclass(frozen=True, eq=False)
class StrainHarmonics:
    """Strain e(t) = sum e_n (cos n t for rr, zz, tt, rz; sin n t for rt, zt) at the Gauss points, beyond inflation.

    t is the angle from the middle of the footprint. A point of a steadily rolling tyre runs through it once per
    revolution. Shears are engineering strains.
    """

    footprint: Footprint

    @property
    def elements(self) -> SectionElements:
        """Shape functions of the section."""
        return self.footprint.pressing.harmonics.elements

    @property
    def mirrored(self) -> bool:
        """Whether the side t < 0 has the strains of t > 0 with opposite rt and zt."""
        return True

    @functools.cached_property
    def amplitudes(self) -> Array:
        """(harmonics + 1, 6, n_elements, n_points) e_n; of Green's strain for a balanced footprint."""
        footprint = self.footprint
        linear = np.stack([self.elements.strain(n, u) for n, u in enumerate(footprint.amplitudes)])
        if footprint.balanced is None:
            return linear
        from tyrefem.mechanics.footprint.nonlinear import NonlinearForces

        return linear + NonlinearForces(footprint.pressing.harmonics, footprint.harmonics).second_strains(
            footprint.amplitudes
        )

    def waves(self, angles: Array) -> Array:
        """(6, harmonics + 1, n_angles): cosine or sine of n t for each component."""
        phase = np.multiply.outer(np.arange(self.footprint.harmonics + 1), np.asarray(angles))
        cos, sin = np.cos(phase), np.sin(phase)
        return np.stack([cos] * 4 + [sin] * 2)

    def strain(self, angles: Array, elements: Any = slice(None)) -> Array:
        """(6, n_elements, n_points, n_angles) strain of chosen elements at angles, rad."""
        return np.asarray(
            np.einsum("ncep,cnt->cept", self.amplitudes[:, :, elements], self.waves(angles), optimize=True)
        )

    def nearest(self, r: float, z: float) -> tuple[int, int]:
        """Element and Gauss point nearest to a place, m."""
        distance = np.hypot(self.elements.points[0] - r, self.elements.points[1] - z)
        element, point = np.unravel_index(int(distance.argmin()), distance.shape)
        return int(element), int(point)

    def at(self, r: float, z: float, angles: Array) -> Array:
        """(6, n_angles) strain at the Gauss point nearest to a place (r, z), m."""
        element, point = self.nearest(r, z)
        return self.strain(angles, [element])[:, 0, point]

    def along(self, direction: Array, angles: Array, elements: Any = slice(None)) -> Array:
        """(n_elements, n_points, n_angles) strain along unit vectors (3, n_elements, n_points) in (r, z, t).

        Times modulus and area of a cord this is the change of its tension over a revolution.
        """
        r, z, t = np.asarray(direction)
        weights = np.stack([r * r, z * z, t * t, r * z, r * t, z * t])
        return np.asarray(np.einsum("cep,cept->ept", weights, self.strain(angles, elements)))

    def belt_edge_shear(self, region: str, count: int = 180) -> LargestEdgeShear:
        """The largest range of a shear strain over a revolution in the outermost elements of a region.

        Raises
        ------
        InputError : the mesh has no such region.
        """
        regions = self.elements.mesh.subdomains or {}
        if region not in regions:
            raise InputError(f"the mesh has no region '{region}'{nearest(region, regions)}")
        members = np.asarray(regions[region])
        centre = np.abs(self.elements.points[1][members]).mean(axis=1)
        edge = members[centre >= centre.max() - 1e-3]
        shears = self.strain(np.linspace(-np.pi, np.pi, count), edge)[3:]
        ranges = np.ptp(shears, axis=-1)
        kind, element, point = (int(i) for i in np.unravel_index(int(ranges.argmax()), ranges.shape))
        r, z = self.elements.points[:, edge[element], point]
        return LargestEdgeShear(float(ranges.max()), (float(r), float(z)), COMPONENTS[3 + kind])

    @functools.cached_property
    def storage_products(self) -> Array:
        """(harmonics + 1, n_elements, n_points) e_n : C' : e_n, J/m3."""
        return self._products(self.footprint.pressing.state.storage)

    @functools.cached_property
    def rubber_products(self) -> Array:
        """(harmonics + 1, n_elements, n_points) the compounds' part of `storage_products`, J/m3."""
        rubber = self.footprint.pressing.state.rubber
        return self.storage_products if rubber is None else self._products(rubber)

    def _products(self, moduli: Array) -> Array:
        storage = np.moveaxis(moduli, (0, 1), (-2, -1))
        strains = np.moveaxis(self.amplitudes, (0, 1), (-1, -2))
        return np.asarray(np.moveaxis(((storage @ strains) * strains).sum(axis=-2), -1, 0))

    def largest_energy(self, count: int = 180) -> Array:
        """(n_elements, n_points) U = 1/2 de : C' : de, largest over the angle, J/m3.

        de is the strain minus that opposite the footprint, where the tyre has its inflated shape.
        """
        largest = np.zeros(self.elements.radii.shape)
        storage = np.moveaxis(self.footprint.pressing.state.storage, (0, 1), (-2, -1))
        away = self.strain(np.array([np.pi]))[..., 0]
        for t in self.cycle_angles(count):
            e = np.moveaxis(self.strain(np.array([t]))[..., 0] - away, 0, -1)[..., None]
            largest = np.maximum(largest, 0.5 * ((storage @ e) * e).sum(axis=(-2, -1)))
        return largest

    def cycle_angles(self, count: int) -> Array:
        """(count,) angles of a whole cycle, rad: one side of the footprint, as the other is alike."""
        return np.linspace(0, np.pi, count)

    def coarseness(self, angles: Array | None = None) -> Array:
        """(n_elements,) error of the linearised strain against Green's, by element: root of the ratio of
        int |H' H / 2|^2 to int |e|^2 over section and revolution (tensor norms).

        Where it is near 1, rotations exceed strains, and the linearised strain cycle is an estimate only.
        """
        angles = np.linspace(0, np.pi, 37) if angles is None else angles
        second, first = np.zeros((2, len(self.elements.radii)))
        for t in angles:
            gradient = self.gradient(float(t))
            half = np.einsum("kiep,kjep->ijep", gradient, gradient) / 2
            linear = (gradient + gradient.transpose(1, 0, 2, 3)) / 2
            second += (half**2 * self.elements.weights).sum(axis=(0, 1, 3))
            first += (linear**2 * self.elements.weights).sum(axis=(0, 1, 3))
        return np.asarray(np.sqrt(second / np.maximum(first, 1e-300)))

    @functools.cached_property
    def linearisation_error(self) -> LinearisationError:
        """`coarseness` of the whole section."""
        coarse, volumes = self.coarseness(), self.elements.weights.sum(axis=1)
        worst = int(np.argmax(coarse))
        mean = float(np.sqrt((coarse**2 * volumes).sum() / volumes.sum()))
        names = [name for name, members in (self.elements.mesh.subdomains or {}).items() if worst in members]
        return LinearisationError(mean, float(coarse[worst]), names[0] if names else "")

    def gradient(self, angle: float) -> Array:
        """(3, 3, n_elements, n_points) displacement gradient H_ki at an angle, components (r, z, t)."""
        n = np.arange(self.footprint.harmonics + 1)
        cos, sin = np.cos(n * angle), np.sin(n * angle)
        u = self.footprint.amplitudes.reshape(len(n), -1, 3)
        waves = np.stack([cos, cos, sin], axis=-1)
        slopes = np.stack([-n * sin, -n * sin, n * cos], axis=-1)
        nodes = np.asarray(self.elements.basis.element_dofs).T
        value, turned = (np.einsum("nic,nc->ic", u, wave)[nodes] for wave in (waves, slopes))
        elements = self.elements
        gradient = np.zeros((3, 3, *elements.radii.shape))
        for direction in (0, 1):
            gradient[:, direction] = np.einsum("epa,eac->cep", elements.gradients[direction], value)
        at = np.einsum("pa,eac->cep", elements.values, value)
        gradient[:, 2] = np.einsum("pa,eac->cep", elements.values, turned)
        gradient[0, 2] -= at[2]
        gradient[2, 2] += at[0]
        gradient[:, 2] /= elements.radii
        return gradient
