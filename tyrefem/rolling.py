"""The rolling tyre as a conduction problem: heat sources by zone, films by side, gas and rim as lumped bodies."""

from __future__ import annotations

import functools
import time as clock
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.boundaries import Contact
from tyrefem.boundaries.rim import Lumped
from tyrefem.conduction import Conduction, Film, Material, Reservoir
from tyrefem.drive import Drive
from tyrefem.errors import InputError
from tyrefem.heating import LOSS_FACTOR, CycleSchedule, HeatSource, ramp_knots
from tyrefem.loading import LoadCase, load_case
from tyrefem.materials import MaterialCard
from tyrefem.meshing import TyreMesh
from tyrefem.result import Result
from tyrefem.strain.arcs import Arcs, Stiffness
from tyrefem.strain.cord_rubber import BiasPlies
from tyrefem.studies import Study

Array = NDArray[np.float64]
GAS, RIM = "contained-air", "rim"


@dataclass(frozen=True, eq=False)
class RollingTyre:
    """A study made into a conduction problem. Everything is built once, on demand."""

    study: Study

    @property
    def drive(self) -> Drive:
        """The drive."""
        return self.study.card.drive

    # -- mechanics ---------------------------------------------------------------------------------------------------

    @functools.cached_property
    def stiffness(self) -> Stiffness:
        """What the strain energy needs of the cards."""
        section, cards = self.study.section, self.study.materials
        mechanics, rating = self.study.card.mechanics, section.rating
        if rating is None:
            raise InputError("the strain law 'arcs' needs the section's [rating]", field="section.rating")
        carcass, cord = cards["carcass"], cards["carcass"].cord
        if cord is None or cord.ply_shear_modulus is None:
            raise InputError("the carcass card needs 'cord.ply_shear_modulus'", field="materials.carcass.cord")
        angle = rating.cord_angle or cord.crown_angle
        if not angle:
            raise InputError("neither the section nor the carcass card gives the crown cord angle", field="section")
        plies = BiasPlies(
            _modulus(carcass, "carcass", "shear_modulus"),
            angle,
            float(section.line.position(np.zeros(1))[0, 0]),
            mechanics.poisson_term,
        )
        return Stiffness(
            plies,
            cord.ply_shear_modulus if mechanics.membrane_shear else np.inf,
            _modulus(cards["tread"], "tread", "shear_modulus"),
            _modulus(cards["sidewall"], "sidewall", "shear_modulus"),
            _modulus(cards["bead"], "bead", "youngs_modulus"),
            rating.bead_area,
        )

    @functools.cached_property
    def schedule(self) -> CycleSchedule:
        """Load cases and strain cycles of every phase."""
        knots, cases, cycles = [], [], []
        for number, phase in enumerate(self.drive.phases):
            fractions = tuple(ramp_knots(phase.changes_load))
            try:
                phase_cases = tuple(self._case(number, fraction) for fraction in fractions)
                phase_cycles = tuple(self._cycle(case) for case in phase_cases)
            except InputError as error:
                placed = error.within(field=f"drive.phases.{phase.name}", file=self.study.file)
                raise self.study.as_written(placed) from None
            knots.append(fractions)
            cases.append(phase_cases)
            cycles.append(phase_cycles)
        return CycleSchedule(self.drive, tuple(knots), tuple(cases), tuple(cycles))

    def _cycle(self, case: LoadCase) -> Arcs:
        cycle = Arcs(self.study.section, self.stiffness, case)
        try:
            _ = cycle.deflected if case.deflection > 0 else None
        except InputError as error:
            given = f"{case.load:.4g} N at {case.pressure / 1e3:.4g} kPa: {error.message}"
            raise InputError(given, field=error.field) from None
        return cycle

    def _case(self, number: int, fraction: float) -> LoadCase:
        phase, section = self.drive.phases[number], self.study.section
        assert section.rating is not None
        return load_case(
            self.study.card.mechanics.load_law,
            section.rating,
            outer_radius=section.outer_diameter / 2,
            pressure=phase.pressure.at(fraction),
            load=None if phase.load is None else phase.load.at(fraction),
            deflection=None if phase.deflection is None else phase.deflection.at(fraction),
            drum_diameter=phase.drum_diameter,
        )

    # -- surroundings ------------------------------------------------------------------------------------------------

    def ambient(self, t: float) -> float:
        """Ambient temperature, degC."""
        return float(self.drive.value("ambient", t) or 0.0)

    def road_temperature(self, t: float) -> float:
        """Road temperature, degC: the drive's, else the law's, else the ambient."""
        return self._first(self.drive.value("road_temperature", t), self.study.card.boundaries.road.temperature, t)

    def rim_temperature(self, t: float) -> float:
        """Temperature of a fixed rim, degC: the drive's, else the law's, else the drive's initial one."""
        driven = self.drive.value("rim_temperature", t)
        law = self.study.card.boundaries.rim.temperature
        return driven if driven is not None else self.drive.initial if law is None else law

    def _first(self, driven: float | None, law: float | None, t: float) -> float:
        return driven if driven is not None else self.ambient(t) if law is None else law

    def speed(self, t: float) -> float:
        """Speed, m/s."""
        return float(self.drive.value("speed", t) or 0.0)

    def road_fraction(self, t: float) -> float:
        """Fraction of a revolution that a tread point spends on the road; none at standstill."""
        if self.speed(t) == 0:
            return 0.0
        law = self.study.card.boundaries.road
        if law.fraction is not None:
            return law.fraction
        return self.schedule.mean(lambda case: case.road_fraction, t)

    @functools.cached_property
    def _tread(self) -> tuple[float, float]:
        """Conductivity (through the thickness) and heat capacity of the tread at 25 degC: what meets the road."""
        card = self.study.materials["tread"]
        conductivity, capacity = card.conductivity.law(), card.heat_capacity()
        k = conductivity(25.0) if callable(conductivity) else conductivity
        return float(np.ravel(k)[-1]), float(capacity(25.0) if callable(capacity) else capacity)

    def road_film(self, t: float) -> float:
        """H_c during contact, W/m2/K."""
        length = self.schedule.mean(lambda case: case.footprint_length, t)
        return self.study.card.boundaries.road.film(Contact(self.speed(t), length, *self._tread))

    def air_film(self, t: float) -> float:
        """Outside film, W/m2/K."""
        return self.study.card.boundaries.outside_air.film(self.speed(t))

    # -- the conduction problem --------------------------------------------------------------------------------------

    @functools.cached_property
    def mesh(self) -> TyreMesh:
        """The mesh, with the strain zones added as named subdomains."""
        zones = self.schedule.zones
        return self.study.mesh().with_zones({zone.name: (zone.region, zone.start, zone.end) for zone in zones})

    def _materials(self) -> dict[str, Material]:
        found = {}
        for region, card in self.study.materials.items():
            orthotropic = card.conductivity.orthotropic
            found[region] = Material(
                card.conductivity.law(), card.heat_capacity(), self._along_plies if orthotropic else None
            )
        return found

    def _along_plies(self, x: Array) -> Array:
        """Unit vector along the meridian at points (2, n): the direction of the plies in the section."""
        section = self.study.section
        s, _ = section.locate(np.asarray(x).T)
        n_r, n_z = np.moveaxis(section.line.normal(s), -1, 0)
        return np.array([-n_z, n_r])

    def _boundaries(self) -> dict[str, Any]:
        laws = self.study.card.boundaries
        gas = GAS if self._gas_capacity is not None else laws.contained_air.temperature  # type: ignore[attr-defined]

        rim = RIM if isinstance(laws.rim, Lumped) else _of_time(self.rim_temperature)
        air = _of_time(self.ambient)
        return {
            "road": [
                Film(_of_time(lambda t: self.road_fraction(t) * self.road_film(t)), _of_time(self.road_temperature)),
                Film(_of_time(lambda t: (1 - self.road_fraction(t)) * self.air_film(t)), air),
            ],
            "outside_air": Film(_of_time(self.air_film), air),
            "contained_air": Film(laws.contained_air.film, gas),
            "rim": Film(laws.rim.total_film, rim),
        }

    @functools.cached_property
    def _gas_capacity(self) -> float | None:
        law = self.study.card.boundaries.contained_air
        pressure = self.drive.phases[0].pressure.start
        return law.heat_capacity(self.study.section.gas_volume(), pressure, self._gas_start)

    @property
    def _gas_start(self) -> float:
        initial = self.study.card.boundaries.contained_air.initial
        return self.drive.initial if initial is None else initial

    def _reservoirs(self) -> dict[str, Reservoir]:
        found: dict[str, Reservoir] = {}
        rim, share = self.study.card.boundaries.rim, 0.5 if self.study.section.half else 1.0
        if self._gas_capacity is not None:
            found[GAS] = Reservoir(self._gas_capacity, self._gas_start)
        if isinstance(rim, Lumped):
            exchanges: list[tuple[float, Any]] = [(rim.cooling * share, self.ambient)]
            if self._gas_capacity is not None and rim.air > 0:
                exchanges.append((rim.air * share, GAS))
            found[RIM] = Reservoir(rim.heat_capacity * share, self.rim_temperature(0.0), tuple(exchanges))
        return found

    @functools.cached_property
    def sources(self) -> dict[str, HeatSource]:
        """Zone -> heat source."""
        factor = LOSS_FACTOR[self.study.card.mechanics.loss_convention]
        return {
            zone.name: HeatSource(zone.name, self.schedule, self.study.materials[zone.region].loss_tangent, factor)
            for zone in self.schedule.zones
        }

    @functools.cached_property
    def problem(self) -> Conduction:
        """The conduction problem."""
        return Conduction(
            self.mesh.mesh,
            self._materials(),
            self._boundaries(),
            self.sources,
            axisymmetric=True,
            element=self.study.card.mesh.element,
            reservoirs=self._reservoirs(),
        )


def _of_time(law: Callable[[float], float]) -> Callable[[Any, float], float]:
    """A datum f(x, t) that does not vary in space; the solver asks several times for the same few times."""
    remembered = functools.lru_cache(maxsize=16)(law)
    return lambda _x, t: remembered(t)


def _modulus(card: MaterialCard, region: str, name: str) -> float:
    modulus = getattr(card, name)
    if modulus is None:
        raise InputError(f"the card of region '{region}' needs '{name}'", field=f"materials.{region}.{name}")
    return float(modulus.value)


def run(study: Study, progress: Callable[[float], None] | None = None) -> Result:
    """Simulate a study's drive."""
    began = clock.perf_counter()
    tyre = RollingTyre(study)
    end = tyre.drive.end
    every = study.card.output.every
    fields = np.linspace(0.0, end, study.card.output.fields)
    times = np.unique(np.round(np.concatenate([np.arange(0.0, end, every), tyre.drive.starts, fields, [end]]), 9))
    history = tyre.problem.transient(
        times,
        tyre.drive.initial,
        study.tolerance,
        breakpoints=tyre.drive.starts[1:],
        progress=progress,
    )
    return Result(study, tyre, history, fields, clock.perf_counter() - began)
