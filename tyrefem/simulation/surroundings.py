"""Surroundings of the tyre during its drive: temperatures, speed, films, time on the road."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.boundaries import Contact
from tyrefem.boundaries.road_film import propagation_depth
from tyrefem.cache import Cache, Content
from tyrefem.effects.combined import Acting
from tyrefem.effects.state import Value
from tyrefem.errors import InputError
from tyrefem.inputs.drive import Drive
from tyrefem.inputs.motion import WheelMotion
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.cycle_schedule import CycleSchedule, cycle_schedule
from tyrefem.mechanics.solved_cases import rated_case
from tyrefem.quantity import Ramp
from tyrefem.simulation.effect_states import EffectStates

GAS, RIM = "contained-air", "rim"
#: Places of sets of points, by section: tyres of one section have the same points.
_PLACES: Cache[tuple[NDArray[np.float64], NDArray[np.float64]]] = Cache(size=128)

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Surroundings:
    """A study's drive and boundary laws as functions of time (s). SI units, temperatures in degC."""

    study: StudyData

    @property
    def drive(self) -> Drive:
        """The drive."""
        return self.study.card.drive

    @functools.cached_property
    def schedule(self) -> CycleSchedule:
        """Load cases and strain cycles of every phase."""
        return cycle_schedule(self.study)

    @functools.cached_property
    def acting(self) -> Acting:
        """The study's effects, acting on this tyre."""
        return Acting(self, self.study.effects)

    @functools.cached_property
    def states(self) -> EffectStates | None:
        """The states of the effects; None if no effect has states."""
        effects = self.acting.with_states
        return EffectStates(self, effects) if effects else None

    def is_steady(self, number: int) -> bool:
        """Whether films, sinks and powers are constant within a phase of the drive."""
        return self._steady[number]

    @functools.cached_property
    def _steady(self) -> tuple[bool, ...]:
        follows = self.states is None and self.acting.follows_drive
        return tuple(
            follows
            and not phase.slides
            and len(knots) == 1
            and all(value.constant for _, value in phase if isinstance(value, Ramp))
            for phase, knots in zip(self.drive.phases, self.schedule.knots, strict=True)
        )

    def state(self, effect: Any, name: str, t: float) -> Value:
        """A state of an effect at a time."""
        if self.states is None:
            raise InputError(f"has no state '{name}'", field=f"effects.{effect.name}")
        return self.states.value(effect, name, t)

    @functools.cached_property
    def rated_deflection(self) -> float:
        """Deflection at rated load and pressure, m, from the load law or from the strain law by finite elements."""
        return rated_case(self.study).deflection

    def region(self, zone: str) -> str:
        """The region of a strain zone."""
        return self._regions[zone]

    @functools.cached_property
    def _regions(self) -> dict[str, str]:
        return {zone.name: str(zone.region) for zone in self.schedule.zones}

    def places(self, x: Array) -> tuple[Array, Array]:
        """|s| along the meridian and depth of points x (2, n), m; cached for the latest sets of points."""

        def compute() -> tuple[Array, Array]:
            s, depth = self.study.section.locate(np.asarray(x).T)
            return np.abs(s), depth

        return _PLACES.get((self.study.section, Content.of(x)), compute)

    def ambient(self, t: float) -> float:
        """Ambient temperature, degC."""
        return self.acting.sink("outside_air", t, float(self.drive.value("ambient", t) or 0.0))

    def road_temperature(self, t: float) -> float:
        """Road temperature, degC: of the drive, else of the law, else ambient."""
        driven, law = self.drive.value("road_temperature", t), self.study.card.boundaries.road.temperature
        return self.acting.sink("road", t, self._first(driven, law, t))

    def rim_temperature(self, t: float) -> float:
        """Temperature of a fixed rim, degC: of the drive, else of the law, else the drive's initial temperature."""
        driven = self.drive.value("rim_temperature", t)
        law = self.study.card.boundaries.rim.temperature
        base = driven if driven is not None else self.drive.initial if law is None else law
        return self.acting.sink("rim", t, base)

    def _first(self, driven: float | None, law: float | None, t: float) -> float:
        return driven if driven is not None else self.ambient(t) if law is None else law

    @property
    def motion(self) -> WheelMotion:
        """The wheel's motion as a function of time: ``motion(t).rolling_speed``."""
        return self.schedule.motion

    def speed(self, t: float) -> float:
        """Speed over the road, m/s, from `motion`; for effects."""
        return self.motion(t).speed

    def road_fraction(self, t: float) -> float:
        """Fraction of time that the section is on the road: 0 at standstill, 1 under a locked wheel."""
        if self.motion(t).speed == 0:
            return 0.0
        fraction = self.rolling_fraction(t)
        return 1.0 if fraction > 0 and self.drive.locked_since(t) is not None else fraction

    def rolling_fraction(self, t: float) -> float:
        """Fraction of a revolution that a tread point spends on the road while the wheel turns."""
        law = self.study.card.boundaries.road
        if law.fraction is not None:
            return law.fraction if self.schedule.mean(lambda case: case.deflection, t) > 0 else 0.0
        return self.schedule.mean(lambda case: case.road_fraction, t)

    def footprint_area(self, t: float) -> float | None:
        """Area of rubber in contact, m2; None if the strain law does not press the tyre on the road."""
        if any(case.contact is None for cases in self.schedule.cases for case in cases):
            return None
        return self.schedule.mean(lambda case: case.footprint_area or 0.0, t)

    @functools.cached_property
    def tread(self) -> tuple[float, float]:
        """Conductivity through the thickness and heat capacity of the tread at 25 degC, for contact with the road.

        Without a region ``tread`` it is that of the crown's outside.
        """
        cards = self.study.materials
        card = cards["tread"] if "tread" in cards else cards[self.study.section.crown]
        conductivity, capacity = card.conductivity.law(), card.heat_capacity()
        k = conductivity(25.0) if callable(conductivity) else conductivity
        return float(np.ravel(k)[-1]), float(capacity(25.0) if callable(capacity) else capacity)

    def road_film(self, t: float) -> float:
        """H_c during contact, W/m2/K; 0 under a locked wheel, which has a separate film."""
        if self.drive.locked_since(t) is not None:
            return 0.0
        length = self.schedule.mean(lambda case: case.footprint_length, t)
        base = self.study.card.boundaries.road.film(Contact(self.motion(t).rolling_speed, length, *self.tread))
        return self.acting.film("road", t, base)

    def propagation_depth(self, t: float) -> float:
        """Penetration depth of the contact that ends at a time, m (Cattani et al. 2023, eq 8).

        0 if the wheel does not turn.
        """
        if self.motion(t).rolling_speed <= 0 or self.drive.locked_since(t) is not None:
            return 0.0
        return propagation_depth(self._contact_time(t), *self.tread)

    def _contact_time(self, t: float) -> float:
        """T, s, in which the tread has rolled the footprint's length L up to a time: L = v T + a T^2/2.

        v is the rolling speed then, a the mean deceleration since the start of the phase, before which no contact
        began if the speed changes: a wheel that comes to rest or locks has a last contact of finite time.
        """
        length = self.schedule.mean(lambda case: case.footprint_length, t)
        start, speed = self.drive.starts[self.drive.locate(t)[0]], self.motion(t).rolling_speed
        before = self.motion(start).rolling_speed
        if t <= start or before == speed:
            return length / speed
        square = speed**2 + 2 * length * (before - speed) / (t - start)
        return min(2 * length / (speed + math.sqrt(max(square, 0.0))), t - start)

    def air_film(self, t: float) -> float:
        """Outside film, W/m2/K."""
        return self.acting.film("outside_air", t, self.study.card.boundaries.outside_air.film(self.motion(t).speed))

    def tread_air_film(self, t: float) -> float:
        """Outside film of the tread between two contacts, W/m2/K."""
        return self.acting.film("tread_air", t, self.air_film(t))

    def gas_film(self, t: float) -> float:
        """Film between inner surface and contained air, W/m2/K."""
        return self.acting.film("contained_air", t, self.study.card.boundaries.contained_air.film)

    def rim_film(self, t: float) -> float:
        """Film between bead and rim, with all resistances in series, W/m2/K."""
        return self.acting.film("rim", t, self.study.card.boundaries.rim.total_film)
