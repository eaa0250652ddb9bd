"""The strain cycle of the report's barrel by finite elements: inflation, then the whole tyre in a rigid cylinder."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tyrefem.cache import Cache
from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.pressed_tyre import pressed_tyre
from tyrefem.mechanics.point_energies import GaussPoints, PointEnergies
from tyrefem.mechanics.solid.cylinder import CylinderChoice
from tyrefem.mechanics.strain_cycle import StrainCycle, Zone

if TYPE_CHECKING:
    from tyrefem.inputs.loading import LoadCase
    from tyrefem.inputs.study import StudyData
    from tyrefem.mechanics.solid.flattening import Flattened
    from tyrefem.mechanics.solid.inflation import Inflation

Array = NDArray[np.float64]
#: Pressures and deflections are solved from powers of this factor near by; the accuracy to which those are solved.
NEAR, ROUGH = 1.05, CylinderChoice(tolerance=1e-3)
#: Tyres in the cylinder by inflated tyre, deflection and start; studies with the same inflated tyre share them.
_FLATTENED: Cache[Flattened] = Cache(size=32)
#: The same at rounded values, by tyre, pressure, deflection and start.
_ROUGH: Cache[Flattened] = Cache(size=32)


@dataclass(frozen=True, eq=False)
class Barrel:
    """Strain cycle of one load case: U = J/2 (E : C' : E), J/m3, as the report's arcs count it.

    E is Green's strain from the inflated section to the section in the cylinder of radius R - D. D is the load case's
    deflection, R the inflated radius. C' is the dissipating part of the inflated tangent: the rubber, and cords whose
    card gives a loss. J is the inflated volume per undeformed volume. The loss convention applies to U as for the arcs.
    A drum does not change the cylinder.

    Parameters
    ----------
    tyre : the inflated tyre. flat : the tyre in the cylinder; None: no deflection, no strain cycle.
    case : the load case.
    """

    tyre: Inflation
    flat: Flattened | None
    case: LoadCase

    @property
    def zones(self) -> tuple[Zone, ...]:
        """The regions."""
        return tuple(Zone(region, region, region) for region in self.tyre.body.parts)

    @functools.cached_property
    def density(self) -> Array:
        """(n_elements, n_points) U, J/m3, at the Gauss points of the mechanical mesh."""
        if self.flat is None:
            return np.zeros(self.tyre.body.rings.weights.shape)
        from tyrefem.mechanics.solid.compounds import determinant

        strain = np.moveaxis(self.flat.strain, 0, -1)[..., None]
        storage = np.moveaxis(self.tyre.state.storage, (0, 1), (-2, -1))
        return np.asarray(((storage @ strain) * strain).sum(axis=(-2, -1)) * determinant(self.tyre.deformation) / 2)

    @functools.cached_property
    def energies(self) -> PointEnergies:
        """The energies without the tyre."""
        return PointEnergies(self.zones, GaussPoints.of(self.tyre.body.rings), self.density[None])

    def energy_density(self, zone: str, points: Array) -> Array:
        """U, J/m3, at points (2, n) in (r, z) of a region of the undeformed section."""
        return self.energies.energy_density(zone, points)


def _rounded(value: float) -> float:
    """The next lower power of `NEAR`: pressing further is easier than letting go."""
    return float(NEAR ** math.floor(math.log(value) / math.log(NEAR)))


def provider(study: StudyData) -> Callable[[LoadCase], StrainCycle]:
    """A function from load case to strain cycle, for ``mechanics.strain = "barrel"``.

    Every deflection starts from rounded values of pressure and deflection (`NEAR`), which variants of a study share.
    These are pressed in steps, not to full accuracy, from the next smaller deflection already solved.

    Raises
    ------
    InputError : when called: no equilibrium, or a deflection that is impossible.
    """
    from tyrefem.mechanics.solid.flattening import flatten

    solved: dict[float, list[Flattened]] = {}
    pressed = pressed_tyre(study)
    inflated = pressed.inflated

    def rough(pressure: float, deflection: float) -> Flattened | None:
        """The tyre at rounded values; None if it cannot take them."""
        known = solved.setdefault(pressure, [])
        less = [state for state in known if state.deflection <= deflection]
        start = max(less, key=lambda state: state.deflection, default=None)

        def pressed_so() -> Flattened:
            return flatten(inflated(pressure), deflection, start, ROUGH)

        try:
            # The tyre may have been inflated to many other pressures since.
            known.append(_ROUGH.get((pressed, pressure, deflection, start), pressed_so))
        except InputError:
            return None
        return known[-1]

    def flattened(pressure: float, deflection: float) -> Flattened | None:
        if deflection <= 0:
            return None
        tyre, near = inflated(pressure), rough(_rounded(pressure), _rounded(deflection))
        return _FLATTENED.get((tyre, deflection, near), lambda: flatten(tyre, deflection, near=near))

    def cycle(case: LoadCase) -> StrainCycle:
        try:
            return Barrel(inflated(case.pressure), flattened(case.pressure, case.deflection), case)
        except InputError as error:
            words = f"{case.load:.4g} N at {case.pressure / 1e3:.4g} kPa: {error.message}"
            raise InputError(words, field=error.field, file=error.file) from None

    return cycle
