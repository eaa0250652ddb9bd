"""The rolling tyre as a conduction problem: heat sources by zone, films by side, gas and rim as lumped bodies."""

from __future__ import annotations

import functools
import weakref
from collections.abc import Callable
from dataclasses import InitVar, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.boundaries.rim import LumpedRim
from tyrefem.cache import Cache
from tyrefem.conduction import Conduction, Film, Material, Reservoir
from tyrefem.conduction.added_states import AddedStates, BodyTemperatures
from tyrefem.effects.combined import Source
from tyrefem.errors import InputError
from tyrefem.geometry.meshing import TyreMesh
from tyrefem.geometry.meshing.topology import Topology
from tyrefem.mechanics.cycle_schedule import REMEMBERED, CycleSchedule, same_cycles
from tyrefem.mechanics.nearby_cycles import NearbyCycles
from tyrefem.mechanics.strain_cycle import LOSS_FACTOR
from tyrefem.mechanics.strain_laws import strain_law
from tyrefem.mechanics.user_cycle import of_present_law
from tyrefem.simulation.effect_trials import check_effects_on
from tyrefem.simulation.heat_budget import FRICTION
from tyrefem.simulation.heat_source import HeatSource
from tyrefem.simulation.rolling_tread import RollingTread
from tyrefem.simulation.sliding_tread import SlidingTread
from tyrefem.simulation.surroundings import GAS, RIM, Surroundings

Array = NDArray[np.float64]
#: Meshes with strain zones: a changed gauge is simulated at every drive.
_MESHES: Cache[TyreMesh] = Cache(size=12)


@dataclass(frozen=True, eq=False)
class RollingTyre(Surroundings):
    """A study made into a conduction problem. Everything is built once, on demand.

    ``like``: another tyre, whose mesh (and so the operators assembled on it) is taken if the section is the same. It is
    not kept alive: parts that are not taken before it is gone are built anew.
    ``cycles``: strain cycles in place of those at the drive's own pressure and the cards' moduli.
    ``parts``: the strain cycles and the mesh of this very tyre, computed before.
    ``near``: takes strain cycles of studies near this one from few solutions, also for tyres that are ``like`` this.
    ``topology``: the mesh has these elements, whatever the section's shape; also for tyres that are ``like`` this.
    """

    like: InitVar[RollingTyre | None] = None
    cycles: CycleSchedule | None = None
    near: NearbyCycles | None = None
    topology: Topology | None = None
    parts: InitVar[tuple[CycleSchedule, TyreMesh] | None] = None
    _similar: weakref.ref[RollingTyre] | None = field(default=None, init=False, repr=False)

    def __post_init__(self, like: RollingTyre | None, parts: tuple[CycleSchedule, TyreMesh] | None) -> None:
        object.__setattr__(self, "_similar", None if like is None else weakref.ref(like))
        if self.topology is None and like is not None:
            object.__setattr__(self, "topology", like.topology)
        if parts is not None:
            self.__dict__["schedule"], self.__dict__["mesh"] = parts

    @property
    def similar(self) -> RollingTyre | None:
        """The tyre given as ``like``; None without one, or once it is gone."""
        return None if self._similar is None else self._similar()

    def __getstate__(self) -> dict[str, Any]:
        """Pickle only the mesh and the strain cycles, which take time; the rest is made again on demand."""
        known: dict[str, Any] = {
            name: self.__dict__[name] for name in ("mesh", "schedule", "states") if name in self.__dict__
        }
        return {"study": self.study, "_similar": None, "cycles": self.cycles, "topology": self.topology, **known}

    def __repr__(self) -> str:
        return f"RollingTyre {self.study.name}"

    def _as_in_like(self, tables: tuple[str, ...], ports: tuple[str, ...]) -> bool:
        """True if these tables of the study, the section, and the effects at these ports equal those of ``like``."""
        # Laws that depend on a state cannot be shared: functions of another tyre read that tyre's states.
        like = self.similar
        if like is None or self.states is not None or like.states is not None:
            return False
        study, other = self.study, like.study
        if "mechanics" in tables and self.cycles is not like.cycles:
            return False
        return (
            study.section == other.section
            and all(study.data.get(table) == other.data.get(table) for table in tables)
            and self.acting.at(*ports) == like.acting.at(*ports)
        )

    @functools.cached_property
    def schedule(self) -> CycleSchedule:
        """Load cases and strain cycles of every phase."""
        if self.cycles is not None:
            return self.cycles
        if self.near is not None:
            return self.near.schedule
        like = self.similar
        if like is not None and like.cycles is None and same_cycles(self.study, like.study):
            schedule = like.schedule
            if of_present_law(schedule.cycles[0][0], type(strain_law(self.study))):
                return schedule
        nearby = None if self._nearby is None else self._nearby.schedule_of(self.study)
        return super().schedule if nearby is None else nearby

    @property
    def _nearby(self) -> NearbyCycles | None:
        """Strain cycles at nearby loads, shared with ``like``."""
        like = self.similar
        return self.near if self.near is not None or like is None else like._nearby

    @functools.cached_property
    def mesh(self) -> TyreMesh:
        """The mesh, with the strain zones added as named subdomains."""
        zones = self.schedule.zones
        like = self.similar
        if like is not None:
            study, other = self.study, like.study
            if study.section == other.section and study.card.mesh == other.card.mesh and zones == like.schedule.zones:
                return like.mesh
        named = {zone.name: (zone.region, zone.start, zone.end) for zone in zones}
        if self.topology is not None:
            return self.topology.mesh_of(self.study.section, named)
        if self.study.card.mesh.file is not None:
            from_file = self.study.mesh()
            try:
                return from_file.with_zones(named)
            except InputError as error:
                law = self.study.card.mechanics.strain
                message = f"{error.message}: strain law '{law}' has other strains on either side"
                raise InputError(message, field="mesh.file", file=self.study.file) from None
        key = self.study.section, repr(self.study.card.mesh), tuple(named.items())
        return _MESHES.get(key, lambda: self.study.mesh().with_zones(named))

    @functools.cached_property
    def bodies(self) -> dict[str, Material]:
        """Region -> its material, with effects."""
        like, bodies = self.similar, {}
        same = like is not None and self._as_in_like((), ("conductivity_factor", "capacity_factor"))
        for region, card in self.study.materials.items():
            if like is not None and same and self.mesh is like.mesh and card is like.study.materials[region]:
                bodies[region] = like.bodies[region]
                continue
            orthotropic = card.conductivity.orthotropic
            bodies[region] = Material(
                self.acting.conductivity(region, card.conductivity.law()),
                self.acting.capacity(region, card.heat_capacity()),
                self.mesh.along_meridian if orthotropic or self.acting.at("conductivity_factor") else None,
            )
        return bodies

    @functools.cached_property
    def boundaries(self) -> dict[str, list[Any]]:
        """Side -> its films, then the fluxes and radiation of effects."""
        ports = ("film_factor", "film_addend", "film_resistance", "sink_addend", "flux", "radiation")
        like = self.similar
        same = like is not None and self._as_in_like(("boundaries", "drive", "mechanics"), ports)
        # Films and friction follow the strain cycle: contact length, area, forces; friction is shared out by the mesh.
        same = same and like is not None and self.tread == like.tread and self.schedule is like.schedule
        if like is not None and same and (self.mesh is like.mesh or not like.sliding.conditions):
            return like.boundaries
        added = {side: [condition for _, condition in self.acting.conditions(side)] for side in self._films}
        return {side: films + added[side] for side, films in self._films.items()}

    @property
    def condition_names(self) -> dict[tuple[str, int], str]:
        """(boundary, number of the condition) -> name in the heat budget, for conditions of slip and effects."""
        plain = len(self._films["road"]) - len(self.sliding.conditions)
        rubbing = {("road", number): FRICTION for number in range(plain, len(self._films["road"]))}
        return rubbing | {
            (side, number): name
            for side, films in self._films.items()
            for number, (name, _) in enumerate(self.acting.conditions(side), len(films))
        }

    @functools.cached_property
    def _films(self) -> dict[str, list[Any]]:
        """Side -> its films, and the conditions of slip."""
        laws = self.study.card.boundaries
        gas = GAS if self._gas_capacity is not None else laws.contained_air.fixed_temperature

        rim = RIM if isinstance(laws.rim, LumpedRim) else self._of_time(self.rim_temperature)
        air = self._of_time(self.ambient)
        driven = self.acting.changes_films
        return {
            "road": [
                Film(
                    self._of_time(lambda t: self.road_fraction(t) * self.road_film(t)),
                    self._of_time(self.road_temperature),
                ),
                Film(self._of_time(lambda t: (1 - self.road_fraction(t)) * self.tread_air_film(t)), air),
                *self.sliding.conditions,
            ],
            "outside_air": [Film(self._of_time(self.air_film), air)],
            "contained_air": [Film(self._of_time(self.gas_film) if driven else laws.contained_air.film, gas)],
            "rim": [Film(self._of_time(self.rim_film) if driven else laws.rim.total_film, rim)],
        }

    @functools.cached_property
    def _gas_capacity(self) -> float | None:
        law = self.study.card.boundaries.contained_air
        pressure = self.drive.phases[0].pressure.start
        capacity = law.heat_capacity(self.study.section.gas_volume(), pressure, law.start(self.drive.initial))
        return None if capacity is None else self.acting.gas_capacity(capacity)

    def _reservoirs(self) -> dict[str, Reservoir]:
        reservoirs: dict[str, Reservoir] = {}
        rim, share = self.study.card.boundaries.rim, 0.5 if self.study.section.half else 1.0
        if self._gas_capacity is not None:
            start = self.study.card.boundaries.contained_air.start(self.drive.initial)
            reservoirs[GAS] = Reservoir(self._gas_capacity, start)
        if isinstance(rim, LumpedRim):
            exchanges: list[tuple[float, Any]] = [(rim.cooling * share, self.ambient)]
            if rim.air > 0:
                contained = self.study.card.boundaries.contained_air
                gas = GAS if self._gas_capacity is not None else contained.fixed_temperature
                exchanges.append((rim.air * share, gas))
            power = (lambda t: share * self.acting.rim_power(t)) if self.acting.at("rim_power") else 0.0
            reservoirs[RIM] = Reservoir(rim.heat_capacity * share, self.rim_temperature(0.0), tuple(exchanges), power)
        return reservoirs

    def _added_states(self) -> AddedStates | None:
        states = self.states
        if states is None:
            return None

        def rate(t: float, z: Array, temperatures: BodyTemperatures) -> Array:
            return states.rate(self, t, z, temperatures)

        return AddedStates(states.initial, states.scale, rate, states.show)

    def _of_time(self, law: Callable[[float], float]) -> Callable[[Any, float], float]:
        """A function f(x, t) that is constant in space.

        Solvers use the same times repeatedly, so values are cached, unless they may depend on a state. A steady phase
        has one value.
        """
        if self.states is not None:
            return lambda _x, t: law(t)
        remembered = functools.lru_cache(maxsize=REMEMBERED)(law)
        constant: dict[int, float] = {}

        def value(_x: Any, t: float) -> float:
            number, _ = self.drive.locate(t)
            if not self.is_steady(number):
                return remembered(t)
            if number not in constant:
                constant[number] = law(t)
            return constant[number]

        return value

    @functools.cached_property
    def hysteresis(self) -> dict[str, HeatSource]:
        """Zone -> heat source of its strain cycle."""
        factor, sources = LOSS_FACTOR[self.study.card.mechanics.loss_convention], {}
        for zone in self.schedule.zones:
            law = self.study.materials[zone.region].loss_tangent
            over_frequency = law.over_frequency if law.depends_on_frequency else None
            sources[zone.name] = HeatSource(zone.name, self.schedule, self.motion, law, factor, over_frequency)
        return sources

    @functools.cached_property
    def sources(self) -> dict[str, Source]:
        """Zone -> heat source of the strain cycle, changed by the study's effects."""
        like, sources = self.similar, {}
        same = like is not None and self._as_in_like(("drive",), ("heat_factor", "heat_addend"))
        for zone in self.schedule.zones:
            if like is not None and same and self.schedule is like.schedule:
                cards = [study.materials[zone.region].loss_tangent for study in (self.study, like.study)]
                if cards[0] == cards[1]:
                    sources[zone.name] = like.sources[zone.name]
                    continue
            sources[zone.name] = self.acting.source(zone.name, self.hysteresis[zone.name])
        return sources

    @functools.cached_property
    def sliding(self) -> SlidingTread:
        """Friction heat of the tread on the road, in phases with slip."""
        rolls = self.study.card.boundaries.sliding.rolls
        return RollingTread(self, self.mesh) if rolls else SlidingTread(self, self.mesh)

    @functools.cached_property
    def problem(self) -> Conduction:
        """The conduction problem.

        Raises
        ------
        InputError : the study has feedback, but no strain cycles at its temperatures are given; a user's own effect
            gives values that are not finite or of another shape.
        """
        if self.cycles is None and self.study.card.mechanics.feedback is not None:
            raise InputError(
                "only a run computes strain cycles that follow the temperature; a diagnosis uses those at the drive's "
                "pressure: remove this table, and use the effect 'pressure-rise' for the warm air",
                field="mechanics.feedback",
                file=self.study.file,
            )
        if self.similar is None:
            check_effects_on(self)
        return Conduction(
            self.mesh.mesh,
            self.bodies,
            self.boundaries,
            self.sources,
            axisymmetric=True,
            element=self.study.card.mesh.element,
            reservoirs=self._reservoirs(),
            states=self._added_states(),
        )
