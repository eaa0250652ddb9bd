"""The strain cycle by finite elements: inflation, footprint by Fourier harmonics, loss of every harmonic."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.heating import LOSS_FACTOR
from tyrefem.strain import StrainCycle, Zone, by_order
from tyrefem.strain.gauss_points import GaussPoints

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
#: Pressures, roads and loads that a provider remembers.
REMEMBERED = 16


@dataclass(frozen=True, eq=False)
class FiniteElements:
    """Strain cycle of one load case: U = (sum_n n e_n : C' : e_n) R_c / (f R), J/m3.

    A harmonic n runs n cycles per revolution, each of which loses pi tan d e_n : C' : e_n, so that the heat
    f U tan d v / (2 R_c) of `heating` is the loss of all harmonics per revolution of 2 pi R: whatever the loss
    convention's factor f and the load case's rolling radius R_c. `spectrum` keeps the harmonics apart, for a tan d
    that depends on frequency. ``one_cycle``: U is the energy of the largest change of strain, as if the revolution
    were one cycle; then f counts.

    Parameters
    ----------
    tyre : the inflated tyre. footprint : the tyre pressed on the road; None: no load, no strain cycle.
    case : the load case. factor : f, `heating.LOSS_FACTOR` of the study's convention.
    """

    tyre: Inflation
    footprint: Any
    case: LoadCase
    factor: float = 1.0
    one_cycle: bool = False

    @property
    def zones(self) -> tuple[Zone, ...]:
        """The regions."""
        return tuple(Zone(region, region, region) for region in self.tyre.body.parts)

    @property
    def found_deflection(self) -> float:
        """The footprint's own deflection, m: the case's is the load law's."""
        return 0.0 if self.footprint is None else float(self.footprint.deflection)

    @functools.cached_property
    def densities(self) -> Array:
        """(orders, n_elements, n_points) U, J/m3, at the Gauss points of the mechanical mesh, by `strain.ORDERS`."""
        if self.footprint is None:
            return np.zeros((1, *self.tyre.body.rings.weights.shape))
        from tyrefem.footprint.cycle import StrainCycle as Harmonics

        cycle = Harmonics(self.footprint)
        radii = self.case.rolling_radius / self.footprint.rolling_radius
        if self.one_cycle:
            return np.asarray(cycle.largest_energy()[None] * radii)
        products = cycle.storage_products
        orders = np.arange(len(products))[:, None, None]
        return np.asarray(by_order(orders * products) * radii / self.factor)

    @property
    def density(self) -> Array:
        """(n_elements, n_points) U, J/m3, at the Gauss points of the mechanical mesh."""
        return np.asarray(self.densities.sum(axis=0))

    @functools.cached_property
    def _points(self) -> GaussPoints:
        return GaussPoints(self.tyre.body.rings)

    def energy_density(self, zone: str, points: Array) -> Array:
        """U, J/m3, at points (2, n) in (r, z) of a region of the undeformed section."""
        return self._points.interpolate(self.density, zone, points)

    def spectrum(self, zone: str, points: Array) -> Array:
        """(orders, n) the same by `strain.ORDERS`."""
        return self._points.interpolate(self.densities, zone, points)


def mechanical_mesh(study: Study) -> TyreMesh:
    """The study's own mesh file; gmsh's quadrilaterals where the study asks for these; otherwise a mapped mesh of
    nine-node elements twice as large as the study asks for, also beside gmsh's triangles (nine-node elements need
    quadrilaterals; energies go over by region and place).

    Raises
    ------
    InputError : a size too coarse or too fine for the section.
    """
    from tyrefem import meshing

    choice = study.card.mesh
    if choice.file is not None:
        return study.mesh()
    own = choice.mesher == "gmsh" and choice.cell == "quad"
    mesher, size = ("gmsh", choice.size) if own else ("mapped", COARSER * choice.size)
    try:
        return meshing.build(study.section, mesher=mesher, size=size, cell="quad", through=1)
    except InputError as error:
        if own:
            raise error.within(field="mesh", file=study.file) from None
        message = f"the mesh of the mechanics, {COARSER:g} times as coarse: {error.message}"
        raise InputError(message, field=f"mesh.{error.field}", file=study.file) from None


def provider(study: Study) -> Callable[[LoadCase], StrainCycle]:
    """From a load case to its strain cycle: what ``mechanics.strain = "fem"`` chooses.

    The tyre is inflated once for every pressure, and every load, pressure and drum is solved once. The load decides;
    a drive given by its deflection carries the load that the study's load law gives it.

    Raises
    ------
    InputError : when called: no equilibrium, or a load that the tyre cannot carry.
    """
    factor = LOSS_FACTOR[study.card.mechanics.loss_convention]
    one_cycle = study.card.mechanics.revolution == "one-cycle"
    large = study.card.mechanics.motion == "large"

    @functools.lru_cache(REMEMBERED)
    def inflated(pressure: float) -> Inflation:
        from tyrefem.solid.inflation import inflate

        if pressure <= 0:
            raise InputError("the strain law 'fem' needs an inflated tyre", field="pressure")
        return inflate(study, pressure, mechanical_mesh(study))

    @functools.lru_cache(REMEMBERED)
    def pressing(pressure: float, drum: float) -> Any:
        from tyrefem.footprint.contact import Pressing
        from tyrefem.footprint.road import Road

        return Pressing(inflated(pressure).state, Road(drum_diameter=drum))

    @functools.lru_cache(REMEMBERED)
    def pressed(load: float, pressure: float, drum: float) -> Any:
        if load <= 0:
            return None
        if large:
            from tyrefem.footprint.balance import Balance

            return Balance(pressing(pressure, drum)).solve(load=load, tolerance=TOLERANCE)
        return pressing(pressure, drum).solve(load=load, tolerance=TOLERANCE)

    def cycle(case: LoadCase) -> StrainCycle:
        footprint = pressed(case.load, case.pressure, case.drum_diameter)
        return FiniteElements(inflated(case.pressure), footprint, case, factor, one_cycle)

    return cycle
