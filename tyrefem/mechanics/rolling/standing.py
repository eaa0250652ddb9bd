"""Stiffness of a standing tyre along the road: the wheel is pushed sideways or forward while the tread sticks."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.cache import Cache
from tyrefem.errors import InputError
from tyrefem.materials.card import strain_laws
from tyrefem.materials.strain_dependence import StrainDependence
from tyrefem.mechanics.footprint.compliance import TreadCompliance
from tyrefem.mechanics.footprint.harmonics import Harmonics
from tyrefem.mechanics.footprint.natural_frequencies import AMPLITUDE, dynamic_state
from tyrefem.mechanics.footprint.strain_amplitude import WEIGHTS
from tyrefem.mechanics.rolling.contact_body import ContactBody
from tyrefem.mechanics.rolling.friction import States
from tyrefem.mechanics.rolling.pushed_contact import push_forces, pushed_body
from tyrefem.mechanics.rolling.rolled import RolledTyre
from tyrefem.mechanics.rolling.rolling_grid import RollingGrid
from tyrefem.mechanics.rolling.section_fields import SectionFields
from tyrefem.mechanics.rolling.stiffened_footprint import StiffenedOnFootprint
from tyrefem.mechanics.rolling.tread_influence import TreadInfluence

if TYPE_CHECKING:
    from tyrefem.mechanics.footprint.press import Pressed

Array = NDArray[np.float64]
#: Directions of a push: forward, to the left.
DIRECTIONS = (0, 1)
#: Angles at which strains of a push are taken, on each side of the contact's middle; denser there.
ANGLES = 32
#: Passes, and relative change of a region's modulus that ends them.
PASSES, CLOSE = 6, 0.02
#: Compliances that are kept: one of a pass, asked for its stiffness and its strains, and one that pushes begin with.
KEPT = 2
#: Smallest amplitude of a region, against a division by zero.
SMALLEST = 1e-6


@dataclass(frozen=True)
class StandingStiffness:
    """Force of the road per displacement of the wheel, N/m, that does not turn: forward, and to the left."""

    longitudinal: float
    lateral: float


def standing_stiffness(body: ContactBody, states: States) -> StandingStiffness:
    """Stiffness of the points that touch, all of which stick and stay closed: C f = d, sum of f over d.

    So long as the push is small no point slips or opens: this is the slope at zero of the force over displacement.

    Parameters
    ----------
    body : compliance (k, 3, k, 3). states : (k,) of the contact.

    >>> bristles = ContactBody(np.eye(6).reshape(2, 3, 2, 3) / 1e5, np.array([1, -1]))
    >>> stiffness = standing_stiffness(bristles, np.array([1, 1], dtype=np.int8))
    >>> round(stiffness.longitudinal), round(stiffness.lateral)
    (200000, 200000)
    """
    forces = push_forces(body, states).sum(axis=1)
    return StandingStiffness(float(forces[0, 1]), float(forces[1, 2]))


def as_it_rolls(rolled: RolledTyre) -> StandingStiffness:
    """Stiffness of the contact of a rolling tyre with the compliance in which it rolls: moduli of the revolution; in
    large motion that of the loaded tyre."""
    shape = rolled.grid.shape
    tyre = None if shape is None or shape.loaded is None else shape.loaded.tyre
    states = rolled.contact.states
    return standing_stiffness(pushed_body(rolled.grid, rolled.axes, states, tyre), states)


@dataclass(frozen=True, eq=False)
class StandingTyre(Brief):
    """A study's tyre that stands where it rolled, without loss and inertia.

    A push is small beside the strains of a revolution. Compounds whose cards have ``strain_dependence`` meet it with
    the storage modulus G' of its own strain amplitude, about the loaded shape: c = c_cords + G'(g)/G c_compound
    (`solid.stiffened`), as natural frequencies do. A static strain beneath hardly changes G' of a small cycle. In large
    motion the footprint yields to the push as `StiffenedOnFootprint`; amplitudes of a push are then without that.

    Parameters
    ----------
    pressed : inflated tyre and cards. rolled : where it touches the road.
    """

    pressed: Pressed
    rolled: RolledTyre

    @functools.cached_property
    def laws(self) -> Mapping[str, StrainDependence]:
        """Region -> moduli over strain of its compound."""
        return strain_laws(self.pressed.study.materials)

    def stiffness(self, amplitude: float | Mapping[str, float] = AMPLITUDE) -> StandingStiffness:
        """Stiffness at a shear strain amplitude of every compound, or of each region's; small: the slope at zero.

        Raises
        ------
        InputError : an amplitude that is not more than 0 to 1.
        """
        amplitudes = amplitude if isinstance(amplitude, Mapping) else dict.fromkeys(self.laws, amplitude)
        for value in amplitudes.values():
            if not 0 < value <= 1:
                raise InputError(f"must be more than 0 to 100 %, not {100 * value:g} %", field="amplitude")
        return standing_stiffness(*self._contact(amplitudes))

    def pushed(self, push: float, direction: int) -> tuple[float, dict[str, float]]:
        """Force over displacement, N/m, of the wheel that goes to and fro by ``push``, m; amplitudes of the regions.

        Equivalent-linear as `footprint.secant_moduli`: each region's modulus is that at which it stores as much as its
        points at their own amplitudes. All points of the contact stick.

        Parameters
        ----------
        direction : 0: forward, 1: to the left.

        Raises
        ------
        InputError : a push that is not positive.
        """
        if not push > 0:
            raise InputError(f"must be more than 0 mm, not {1e3 * push:g} mm", field="push")
        amplitudes = dict.fromkeys(self.laws, AMPLITUDE)
        for _ in range(PASSES):
            body, states = self._contact(amplitudes)
            forces = push_forces(body, states)[direction]
            strained = self._amplitudes(push * forces, amplitudes)
            changes = [law.stiffening(strained[r]) / law.stiffening(amplitudes[r]) for r, law in self.laws.items()]
            amplitudes = strained
            if all(abs(change - 1) <= CLOSE for change in changes):
                break
        return float(forces[:, 1 + direction].sum()), amplitudes

    def _points(self, amplitudes: Mapping[str, float]) -> TreadInfluence:
        stiffening = {region: float(law.stiffening(amplitudes[region])) for region, law in self.laws.items()}
        return TreadInfluence(TreadCompliance(Harmonics(dynamic_state(self.pressed.tyre, stiffening))))

    def _on_footprint(self, influence: TreadInfluence) -> StiffenedOnFootprint | None:
        """The tyre in its footprint in large motion; None: small motion about the inflated tyre."""
        shape = self.rolled.grid.shape
        if shape is None or shape.loaded is None:
            return None
        return StiffenedOnFootprint(shape.footprint, influence, stiff=influence.tread.harmonics.state)

    @functools.cached_property
    def _grids(self) -> Cache[RollingGrid]:
        """Amplitudes of the regions -> the contact's points with the moduli of these amplitudes."""
        return Cache(KEPT)

    def _grid(self, amplitudes: Mapping[str, float]) -> RollingGrid:
        """The contact's points with the moduli of these amplitudes."""
        key = tuple(sorted(amplitudes.items()))
        return self._grids.get(key, lambda: self.rolled.grid.under(self._points(amplitudes)))

    def _contact(self, amplitudes: Mapping[str, float]) -> tuple[ContactBody, States]:
        grid, states = self._grid(amplitudes), self.rolled.contact.states
        return pushed_body(grid, self.rolled.axes, states, self._on_footprint(grid.influence)), states

    def _amplitudes(self, forces: Array, amplitudes: Mapping[str, float]) -> dict[str, float]:
        """Region -> amplitude at which it stores as much as its points under forces (k, 3), N."""
        grid = self._grid(amplitudes)
        vectors = np.einsum("kax,ka->kx", self.rolled.axes, forces).reshape(len(grid.angles), -1, 3)
        fields = SectionFields.of(grid, np.einsum("jpx,jcx->jpc", vectors, grid.wheel_axes))
        one_side = np.pi * np.linspace(0, 1, ANGLES + 1) ** 2
        angles = np.concatenate([-one_side[:0:-1], one_side])
        elements = grid.influence.tread.harmonics.elements
        regions, totals = elements.mesh.subdomains or {}, {region: np.zeros(2) for region in self.laws}
        for strain in fields.strains(angles):
            strain[:3] -= strain[:3].mean(axis=0)
            amplitude = np.sqrt(np.einsum("c,cept->ept", WEIGHTS, strain**2))
            for region, law in self.laws.items():
                members = np.asarray(regions[region])
                shear = amplitude[members]
                weights = shear**2 * elements.weights[members][..., None] * np.gradient(angles)
                totals[region] += (law.kraus.storage(shear) * weights).sum(), weights.sum()
        means = {}
        for region, (stored, weight) in totals.items():
            mean = self.laws[region].kraus.amplitude(stored / weight) if weight else 0.0
            means[region] = max(mean, SMALLEST)
        return means
