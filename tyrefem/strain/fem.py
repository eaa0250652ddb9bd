"""The strain cycle by finite elements: inflation, footprint by Fourier harmonics, loss of every harmonic."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.heating import LOSS_FACTOR
from tyrefem.strain import StrainCycle, Zone

if TYPE_CHECKING:
    from tyrefem.loading import LoadCase
    from tyrefem.meshing.tyre_mesh import TyreMesh
    from tyrefem.solid.inflation import Inflation
    from tyrefem.studies import Study

Array = NDArray[np.float64]
#: Change with the number of harmonics that the footprint may keep.
TOLERANCE = 0.02
#: Nine-node elements are this much larger than those of the study's mesh.
COARSER = 2.0


@dataclass(frozen=True, eq=False)
class FiniteElements:
    """Strain cycle of one load case: U = (sum_n n e_n : C' : e_n) R_c / (f R), J/m3.

    A harmonic n runs n cycles per revolution, each of which loses pi tan d e_n : C' : e_n, so that the heat
    f U tan d v / (2 R_c) of `heating` is the loss of all harmonics per revolution of 2 pi R: whatever the loss
    convention's factor f and the load case's rolling radius R_c. tan d is the card's, alike at every harmonic.

    Parameters
    ----------
    tyre : the inflated tyre. footprint : the tyre pressed on the road; None: no load, no strain cycle.
    case : the load case. factor : f, `heating.LOSS_FACTOR` of the study's convention.
    """

    tyre: Inflation
    footprint: Any
    case: LoadCase
    factor: float = 1.0

    @property
    def zones(self) -> tuple[Zone, ...]:
        """The regions."""
        return tuple(Zone(region, region, region) for region in self.tyre.body.parts)

    @functools.cached_property
    def density(self) -> Array:
        """(n_elements, n_points) U, J/m3, at the Gauss points of the mechanical mesh."""
        if self.footprint is None:
            return np.zeros(self.tyre.body.rings.weights.shape)
        from tyrefem.footprint.cycle import StrainCycle as Harmonics

        products = Harmonics(self.footprint).storage_products
        orders = np.arange(len(products))[:, None, None]
        radii = self.case.rolling_radius / self.footprint.rolling_radius
        return np.asarray((orders * products).sum(axis=0) * radii / self.factor)

    def energy_density(self, zone: str, points: Array) -> Array:
        """U, J/m3, at points (2, n) in (r, z) of the undeformed section: from the four nearest Gauss points of the
        region, weighted with 1 / distance^2."""
        tree, values = self._places(zone)
        count = min(4, len(values))
        distance, nearest = tree.query(np.asarray(points, dtype=float).T, k=count)
        weights = 1 / (distance.reshape(-1, count) ** 2 + 1e-12)
        return np.asarray((weights * values[nearest.reshape(-1, count)]).sum(axis=1) / weights.sum(axis=1))

    def _places(self, zone: str) -> tuple[Any, Array]:
        if zone not in self._trees:
            from scipy.spatial import cKDTree

            members = self.tyre.body.mesh.subdomains[zone]
            places = self.tyre.body.rings.points[:, members].reshape(2, -1).T
            self._trees[zone] = (cKDTree(places), self.density[members].ravel())
        return self._trees[zone]

    _trees: dict[str, tuple[Any, Array]] = field(default_factory=dict, init=False, repr=False)


def mechanical_mesh(study: Study) -> TyreMesh:
    """The study's own mesh file; otherwise one of nine-node elements twice as large as the study asks for."""
    from tyrefem import meshing

    choice = study.card.mesh
    if choice.file is not None:
        return study.mesh()
    return meshing.build(study.section, mesher="mapped", size=COARSER * choice.size, cell="quad", through=1)


def provider(study: Study) -> Callable[[LoadCase], StrainCycle]:
    """From a load case to its strain cycle: what ``mechanics.strain = "fem"`` chooses.

    The tyre is inflated once for every pressure, and every load, pressure and drum is solved once. The load decides;
    a drive given by its deflection carries the load that the study's load law gives it.

    Raises
    ------
    InputError : when called: no equilibrium, or a load that the tyre cannot carry.
    """
    factor = LOSS_FACTOR[study.card.mechanics.loss_convention]

    @functools.cache
    def inflated(pressure: float) -> Inflation:
        from tyrefem.solid.inflation import inflate

        if pressure <= 0:
            raise InputError("the strain law 'fem' needs an inflated tyre", field="pressure")
        return inflate(study, pressure, mechanical_mesh(study))

    @functools.cache
    def pressing(pressure: float, drum: float) -> Any:
        from tyrefem.footprint.contact import Pressing
        from tyrefem.footprint.road import Road

        return Pressing(inflated(pressure).state, Road(drum_diameter=drum))

    @functools.cache
    def pressed(load: float, pressure: float, drum: float) -> Any:
        return pressing(pressure, drum).solve(load=load, tolerance=TOLERANCE) if load > 0 else None

    def cycle(case: LoadCase) -> StrainCycle:
        footprint = pressed(case.load, case.pressure, case.drum_diameter)
        return FiniteElements(inflated(case.pressure), footprint, case, factor)

    return cycle
