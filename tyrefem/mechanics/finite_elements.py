"""The strain cycle by finite elements: inflation, footprint by Fourier harmonics, loss of every harmonic."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.operators import operators_of
from tyrefem.inputs.loading import PressedContact
from tyrefem.materials.card import strain_laws
from tyrefem.materials.strain_dependence import StrainDependence
from tyrefem.mechanics.footprint.pressed_tyre import pressed_tyre
from tyrefem.mechanics.point_energies import GaussPoints, PointEnergies
from tyrefem.mechanics.strain_cycle import LOSS_FACTOR, Zone, by_order

if TYPE_CHECKING:
    from tyrefem.inputs.loading import LoadCase
    from tyrefem.inputs.study import StudyData
    from tyrefem.mechanics.footprint.footprint import Footprint
    from tyrefem.mechanics.footprint.strain_harmonics import LinearisationError
    from tyrefem.mechanics.rolling.friction_rings import FrictionRings
    from tyrefem.mechanics.solid.inflation import Inflation

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class FiniteElements:
    """Strain cycle of one load case: U = (sum_n n e_n : C' : e_n) / f, J/m3.

    A harmonic n runs n cycles per revolution. Each cycle loses pi tan d e_n : C' : e_n. The heat f U tan d v / (2 R)
    of `heating` is thus the loss of all harmonics per revolution of 2 pi R, for any factor f of the loss convention.
    R is the footprint's rolling radius, as in `solved_case`. `spectrum` keeps the harmonics apart, for a tan d that
    depends on frequency. Where ``strain_laws`` give a compound's moduli over strain, e_n : C' : e_n is times the loss
    modulus at the point's strain amplitude over the card's tan delta and modulus. With ``one_cycle``, U is the energy
    of the largest change of strain, as if the revolution were one cycle; then the heat depends on f.

    Parameters
    ----------
    tyre : the inflated tyre. footprint : the tyre pressed on the road; None: no load, no strain cycle.
    case : the load case as driven. factor : f, `heating.LOSS_FACTOR` of the study's convention.
    heated : region -> nodes (2, n) of the conduction and their volumes (n,), m3. The integral over them of `energies`
        is then that of the Gauss points, by a factor near 1 for every region and order. None: as interpolated.
    """

    tyre: Inflation
    footprint: Footprint | None
    case: LoadCase
    factor: float = 1.0
    one_cycle: bool = False
    strain_laws: Mapping[str, StrainDependence] = field(default_factory=dict)
    heated: Mapping[str, tuple[Array, Array]] | None = None

    @property
    def zones(self) -> tuple[Zone, ...]:
        """The regions."""
        return tuple(Zone(region, region, region) for region in self.tyre.body.parts)

    @functools.cached_property
    def solved_case(self) -> LoadCase:
        """The load case with the load, deflection, length, area and rolling radius of the computed footprint."""
        footprint, case = self.footprint, self.case
        if footprint is None:
            free = PressedContact(0.0, 0.0, float(self.tyre.places[0].max()))
            return replace(case, load=0.0, deflection=0.0, contact=free)
        # A given load is kept to the last digit.
        load = footprint.load if case.by_deflection else case.load
        contact = PressedContact(footprint.length, footprint.area, footprint.rolling_radius)
        return replace(case, load=load, deflection=footprint.deflection, contact=contact)

    @functools.cached_property
    def linearisation_error(self) -> LinearisationError | None:
        """What linear strains leave out of the strain cycle; None without load."""
        if self.footprint is None:
            return None
        from tyrefem.mechanics.footprint.strain_harmonics import StrainHarmonics

        return StrainHarmonics(self.footprint).linearisation_error

    @functools.cached_property
    def densities(self) -> Array:
        """(orders, n_elements, n_points) U, J/m3, at the Gauss points of the mechanical mesh, by `ORDERS`."""
        if self.footprint is None:
            return np.zeros((1, *self.tyre.body.rings.weights.shape))
        from tyrefem.mechanics.footprint.strain_amplitude import StrainAmplitude
        from tyrefem.mechanics.rolling.turning import cycle_of

        cycle = cycle_of(self.footprint)
        strain = StrainAmplitude(cycle, self.strain_laws)
        if self.one_cycle:
            largest = cycle.largest_energy()[None]
            return np.asarray(largest * strain.factor if self.strain_laws else largest)
        products = cycle.storage_products
        if self.strain_laws:
            products = strain.effective(products, cycle.rubber_products)
        orders = np.arange(len(products))[:, None, None]
        return np.asarray(by_order(orders * products) / self.factor)

    @property
    def density(self) -> Array:
        """(n_elements, n_points) U, J/m3, at the Gauss points of the mechanical mesh."""
        return self.energies.density

    @functools.cached_property
    def energies(self) -> PointEnergies:
        """The energies without the tyre."""
        points, densities = GaussPoints.of(self.tyre.body.rings), self.densities
        for region, heated in (self.heated or {}).items():
            assert self.footprint is not None
            # The strain cycle is that of the inflated tyre, whose volume differs a little.
            weights = self.footprint.pressing.harmonics.elements.weights
            factors = points.kept(self.densities, weights, region, heated)
            densities = densities.copy()
            densities[:, points.members[region]] *= factors[:, None, None]
        return PointEnergies(self.zones, points, densities, self.friction)

    @property
    def friction(self) -> FrictionRings | None:
        """Friction of the tread's rings; None: the tyre does not roll with friction."""
        return getattr(self.footprint, "friction", None)

    def energy_density(self, zone: str, points: Array) -> Array:
        """U, J/m3, at points (2, n) in (r, z) of a region of the undeformed section."""
        return self.energies.energy_density(zone, points)

    def spectrum(self, zone: str, points: Array) -> Array:
        """(orders, n) U, J/m3, at points (2, n) by `ORDERS`."""
        return self.energies.spectrum(zone, points)


def provider(study: StudyData) -> Callable[..., FiniteElements]:
    """A function from load case to strain cycle, for ``mechanics.strain = "fem"``; a nearby cycle in large motion, as
    its second argument, is what the solution starts from.

    The tyre is inflated once for every pressure. Every load, pressure and drum is solved once in a process, also for
    other studies with the same tyre (`pressed_tyre`). The drive prescribes either load or deflection. The study's load
    law and footprint law are not used.

    Raises
    ------
    InputError : when called: no equilibrium, or a load that the tyre cannot carry.
    """
    without_friction = _turning_provider(study) if study.card.mechanics.rolling else _standing_provider(study)
    mechanics = study.card.mechanics
    factor, one_cycle = LOSS_FACTOR[mechanics.loss_convention], mechanics.revolution == "one-cycle"

    def cycle(case: LoadCase, near: FiniteElements | None = None) -> FiniteElements:
        given = case.deflection if case.by_deflection else case.load
        turns = case.speed > 0 or not mechanics.rolling
        if case.wheel is None or given <= 0 or not turns:
            return without_friction(case, near)
        from tyrefem.mechanics.rolling.rolled_footprint import rolled_footprint

        footprint = rolled_footprint(study, case)
        laws = strain_laws(footprint.tyre.study.materials)
        return FiniteElements(footprint.tyre.tyre, footprint, case, factor, one_cycle, laws, _heated(study))

    return cycle


def _heated(study: StudyData) -> dict[str, tuple[Array, Array]]:
    """Region -> nodes of the study's conduction (2, n), and their volumes (n,), m3."""
    operators = operators_of(study.mesh().mesh, study.card.mesh.element, True)
    return {
        region: (operators.nodes(region), operators.mass_row(region)[operators.dofs(region)])
        for region in study.materials
    }


def _standing_provider(study: StudyData) -> Callable[..., FiniteElements]:
    """`provider` of a tyre that stands while it is pressed."""
    mechanics = study.card.mechanics
    factor, one_cycle = LOSS_FACTOR[mechanics.loss_convention], mechanics.revolution == "one-cycle"
    tyre = pressed_tyre(study)

    def cycle(case: LoadCase, near: FiniteElements | None = None) -> FiniteElements:
        loaded, start = tyre.under(case), None if near is None else near.footprint
        if near is not None:
            loaded.inflated(case.pressure, near.tyre)
        footprint = loaded.footprint(case, large=mechanics.motion == "large", near=start)
        laws = strain_laws(loaded.study.materials)
        return FiniteElements(loaded.inflated(case.pressure), footprint, case, factor, one_cycle, laws)

    return cycle


#: Number of load cases that a study's turning tyre keeps.
REMEMBERED = 20


def _turning_provider(study: StudyData) -> Callable[..., FiniteElements]:
    """`provider` with ``mechanics.rolling``: the tyre turns at the load case's speed (`rolling.turning.turn`).

    A tyre at rest, and one without load, is that of `_standing_provider`.
    """
    from tyrefem.mechanics.footprint.press_order import PressOrder
    from tyrefem.mechanics.footprint.pressed_tyre import TOLERANCE, mechanical_mesh
    from tyrefem.mechanics.footprint.road import Road
    from tyrefem.mechanics.rolling.turning import turn

    mechanics = study.card.mechanics
    factor, one_cycle = LOSS_FACTOR[mechanics.loss_convention], mechanics.revolution == "one-cycle"
    standing = _standing_provider(study)

    @functools.lru_cache(REMEMBERED)
    def turned(load: float | None, deflection: float | None, pressure: float, drum: float, speed: float) -> Any:
        case = {"load": load, "deflection": deflection}
        softened = study
        if mechanics.moduli == "secant":
            from tyrefem.mechanics.footprint.secant_moduli import under_load

            softened = under_load(study, mechanical_mesh(study), pressure, Road(drum), **case)[0]
        large = mechanics.motion == "large"
        mesh = mechanical_mesh(study)
        return turn(PressOrder(softened, mesh, pressure, Road(drum), load, deflection, TOLERANCE, large), speed)

    def cycle(case: LoadCase, near: FiniteElements | None = None) -> FiniteElements:
        given = case.deflection if case.by_deflection else case.load
        if given <= 0 or not case.speed:
            return standing(case)
        wanted = (None, given) if case.by_deflection else (given, None)
        turning = turned(*wanted, case.pressure, case.drum_diameter, case.speed)
        laws = strain_laws(turning.study.materials)
        return FiniteElements(turning.tyre, turning.footprint, case, factor, one_cycle, laws)

    return cycle
