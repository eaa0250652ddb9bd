"""Heat of a tread that slides on the road: friction heat and its division between tread and road."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.boundaries.road_film import effusivity
from tyrefem.boundaries.skid import Passage
from tyrefem.conduction import Film, Flux
from tyrefem.conduction.operators import Surface, operators_of

if TYPE_CHECKING:
    from tyrefem.boundaries.sliding import UniformSliding
    from tyrefem.geometry.meshing import TyreMesh
    from tyrefem.inputs.drive import Drive, Phase
    from tyrefem.simulation.surroundings import Surroundings

Array = NDArray[np.float64]
#: Additional readings of a phase with slip; closer at its start, where a skid warms fast.
READINGS = 24


class SlidingTread:
    """The sliding contact of a study's tyre as functions of time (s). SI units, temperatures in degC.

    A rolling tread point receives its share of mu p v_s once per revolution; the section receives the mean over the
    revolution. A locked wheel does not turn: the modelled section is on the road, receives mu p v all the time and
    loses heat to the passing road through `Passage.skid_film`.

    Parameters
    ----------
    surroundings : the drive, the boundary laws and the load cases. mesh : mesh with the tread's surface, ``road``.
    """

    def __init__(self, surroundings: Surroundings, mesh: TyreMesh) -> None:
        self.surroundings, self.mesh = surroundings, mesh

    @property
    def drive(self) -> Drive:
        """The drive."""
        return self.surroundings.drive

    @property
    def law(self) -> UniformSliding:
        """The study's ``[boundaries] sliding``."""
        law: Any = self.surroundings.study.card.boundaries.sliding
        return law

    def rubs(self, phase: Phase) -> bool:
        """True if the tread slides on the road in a phase."""
        return phase.slides

    @property
    def conditions(self) -> list[Flux | Film]:
        """Conditions of slip on the boundary ``road``: friction heat, and the film of a locked wheel; else none."""
        if not any(self.rubs(phase) for phase in self.drive.phases):
            return []
        heat = Flux(self.mean_heat, of_temperature=True)
        if all(self.drive.locked_since(start) is None for start in self.drive.starts):
            return [heat]
        return [heat, Film(lambda _x, t: self.skid_film(t), lambda _x, t: self.surroundings.road_temperature(t))]

    @property
    def readings(self) -> list[float]:
        """Times of the readings in phases with slip, s."""
        share = np.linspace(0.0, 1.0, READINGS + 1)[1:-1] ** 2
        parts = zip(self.drive.starts, self.drive.phases, strict=True)
        return [start + phase.duration * x for start, phase in parts if self.rubs(phase) for x in share.tolist()]

    @functools.cached_property
    def surface(self) -> Surface:
        """Quadrature of the tread's surface."""
        return operators_of(self.mesh.mesh, self.surroundings.study.card.mesh.element, True).surface("road")

    @functools.cached_property
    def effusivities(self) -> tuple[float, float]:
        """b of tread (its card at 25 degC) and road, J/m2/K/s^0.5."""
        return effusivity(*self.surroundings.tread), self.law.road_effusivity(
            self.surroundings.study.card.boundaries.road
        )

    def footprint_share(self, t: float) -> float:
        """Share of the tread's surface in contact while the wheel turns.

        From the footprint area if the strain law presses the tyre on the road; else, or if the road's law gives it,
        the fraction of a revolution on the road.
        """
        area = self.surroundings.footprint_area(t)
        if area is None or self.surroundings.study.card.boundaries.road.fraction is not None:
            return self.surroundings.rolling_fraction(t)
        return area / (self.surface.area * self._sides)

    def contact_area(self, t: float) -> float:
        """Footprint area, m2: the tread's surface times `footprint_share`."""
        return self.footprint_share(t) * self.surface.area * self._sides

    @property
    def _sides(self) -> float:
        return 2.0 if self.surroundings.study.section.half else 1.0

    def pressure(self, t: float) -> float:
        """Contact pressure, Pa: from the law, else load over `contact_area`; zero off the road."""
        area = self.contact_area(t)
        load = float(self.surroundings.schedule.mean(lambda case: case.load, t))
        if area <= 0 or load <= 0:
            return 0.0
        return load / area if self.law.pressure is None else self.law.pressure

    def friction(self, t: float) -> float:
        """Coefficient of friction, not limited by decomposition."""
        motion = self.surroundings.motion(t)
        return self.law.friction(motion.sliding_speed, motion.rolling_speed)

    def passage(self, t: float) -> Passage | None:
        """The passage through the footprint; None if tread and road do not touch or do not move."""
        motion = self.surroundings.motion(t)
        length = self.surroundings.schedule.mean(lambda case: case.footprint_length, t)
        if not (motion.forward_speed > 0 and length > 0):
            return None
        rolling = 0.0 if self.drive.locked_since(t) is not None else motion.rolling_speed
        return Passage(*self.effusivities, length, rolling, motion.forward_speed)

    def sliding_speed(self, t: float) -> float:
        """Speed of the tread over the road, m/s."""
        return self.surroundings.motion(t).sliding_speed

    def contact_share(self, _x: Array, t: float) -> Array | float:
        """Share of a revolution in which points x (2, n) are in contact."""
        return self.footprint_share(t)

    def uncapped_flux(self, _x: Array, t: float) -> Array | float:
        """F_0 = mu p v_s at points x (2, n), not limited by decomposition, W/m2 of contact."""
        return self.friction(t) * self.pressure(t) * self.sliding_speed(t)

    def friction_flux(self, x: Array, t: float, T: Array) -> Array:
        """F_0 at points x (2, n) with temperatures T (n,), W/m2, limited to keep the exit edge below decomposition
        (13)."""
        flux = np.broadcast_to(self.uncapped_flux(x, t), np.shape(T))
        passage = self.passage(t)
        if passage is None or not flux.any():
            return np.zeros(np.shape(T))
        most = passage.largest_flux(self.law.decomposition_temperature, T, self.surroundings.road_temperature(t))
        return np.asarray(np.minimum(flux, np.maximum(most, 0.0)))

    def friction_power(self, flux: Array | float, t: float) -> float:
        """Friction power of the whole tyre, W, from the flux F_0 at the points of `surface`."""
        mean = float((self.surface.weight * flux).sum() / self.surface.area)
        return mean * self.contact_area(t)

    def mean_heat(self, x: Array, t: float, T: Array) -> Array:
        """Heat flux into the section, W/m2: mean of the tread's share over the revolution; F_0 for a locked wheel."""
        flux, passage = self.friction_flux(x, t, T), self.passage(t)
        if passage is None:
            return flux
        if self.drive.locked_since(t) is not None:
            return self.surroundings.road_fraction(t) * flux
        return np.asarray(self.contact_share(x, t) * passage.tread_share * flux)

    def skid_film(self, t: float) -> float:
        """Film between a locked wheel and the passing road, W/m2/K; 0 if the wheel turns or the vehicle stands."""
        since, passage = self.drive.locked_since(t), self.passage(t)
        if since is None or passage is None or self.pressure(t) == 0:
            return 0.0
        return passage.skid_film(max(t - since, 0.0))

    def exit_edge(self, x: Array, t: float, T: Array) -> Array:
        """Temperature at the exit edge of the contact, degC, from the surface's T (n,) at points x (2, n).

        Rolling: `Passage.frictionless_temperature` plus the rise of the passage (1, 3, 5). Locked: the rise of the
        surface over the road, which is the mean over the contact, times the ratio of exit and mean.
        """
        passage, road = self.passage(t), self.surroundings.road_temperature(t)
        if passage is None:
            return np.asarray(T)
        since = self.drive.locked_since(t)
        if since is not None:
            return np.asarray(road + (np.asarray(T) - road) / passage.road_age(max(t - since, 0.0))[1])
        return np.asarray(passage.frictionless_temperature(T, road) + passage.exit_rise(self.friction_flux(x, t, T)))
