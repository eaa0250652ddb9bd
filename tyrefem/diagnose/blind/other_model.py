"""The model of structural synthetic data: wrong in more than one way for the study that is to read them.

Strain law, section gauges, speed laws of films, mesh, elements and time integration differ from the study's.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.cache import Cache
from tyrefem.effects import Effect, catalogue
from tyrefem.errors import InputError
from tyrefem.geometry import Section
from tyrefem.inputs.loading import LoadCase
from tyrefem.inputs.study import StudyData
from tyrefem.inputs.study_card import PLACE_KEYS
from tyrefem.mechanics.cycle_schedule import CycleSchedule, cycle_schedule
from tyrefem.mechanics.strain_cycle import StrainCycle, Zone
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.variants.answer_store import digest, effects_source, plain

Array = NDArray[np.float64]

#: Other strain laws to try for each law of a study.
OTHER_LAWS = {"arcs": ("barrel",), "barrel": ("arcs",), "fem": ("barrel",), "given": ()}
#: Share of the cases with another strain law, where one can run; the others have the study's law times smooth modes.
OTHER_LAW_SHARE = 1 / 3
#: Relative root mean square of the modes along the meridian, and their number beside the mean.
MODES_RMS, MODES = (0.2, 0.3), 4
#: Tolerance of a region's thickness: smallest and largest relative deviation, of either sign (estimate: 5 to 10 %).
GAUGES = (0.05, 0.10)
#: Exponent of speed added to the film of the outside air (either sign) and of the road (Cattani et al. 2023: 0.5).
OUTSIDE_SPEED, ROAD_SPEED = (0.1, 0.3), (0.1, 0.4)
#: Effects of the catalogue that state these speed laws.
OUTSIDE_FILM, ROAD_FILM = "outside-film-speed", "road-film-speed"
#: Distance of a sensor from the outer face if the thinner section would leave it in the air, m.
COVER = 2e-4
#: Mesh of the mechanics of another strain law.
COARSE = {"mesh.size": "4 mm", "mesh.element": "P1"}
#: Mesh of structural data: quadrilaterals, linear; the study's elements are quadratic.
STRUCTURAL_MESH = {"mesh.mesher": "mapped", "mesh.cell": "quad", "mesh.element": "P1", "mesh.size": "1.6 mm"}
#: Time steps of structural data, s, and implicitness of their integration.
STRUCTURAL_STEP, THETA = 3.0, 0.6
#: Strain cycles of other laws by study and drive: the same for all cases of a layout.
_SCHEDULES: Cache[CycleSchedule] = Cache(size=32)


@dataclass(frozen=True, eq=False)
class ShapedEnergy:
    """A strain cycle times smooth modes: U exp(sum_k a_k cos(k pi s / L)), s from the crown, L half the meridian."""

    cycle: StrainCycle
    section: Section
    amplitudes: tuple[float, ...]

    @property
    def zones(self) -> tuple[Zone, ...]:
        """The zones of the cycle."""
        return self.cycle.zones

    def energy_density(self, zone: str, points: Array) -> Array:
        """U, J/m3, at points (2, n)."""
        return self.cycle.energy_density(zone, points) * self._factor(points)

    def spectrum(self, zone: str, points: Array) -> Array:
        """(orders, n) U, J/m3, at points (2, n)."""
        by_order = getattr(self.cycle, "spectrum", None)
        energies = self.cycle.energy_density(zone, points)[None] if by_order is None else by_order(zone, points)
        return np.asarray(energies * self._factor(points))

    def _factor(self, points: Array) -> Array:
        s, _ = self.section.locate(np.asarray(points, dtype=float).T)
        return np.exp(mode_sum(np.abs(s) / self.section.line.length, self.amplitudes))


@dataclass(frozen=True, eq=False)
class ScaledEnergy:
    """The strain cycle of another law, computed at a deflection D_0 of the section as stated: c U (D / D_0)^2.

    Points of the section with its true gauges are looked up at the same station and relative depth.

    Parameters
    ----------
    cycle, stated : of the other law, and its section. deflection : D_0, m.
    case, section : the load case, and the section with its true gauges. factor : c.
    """

    cycle: StrainCycle
    stated: Section
    deflection: float
    case: LoadCase
    section: Section
    factor: float

    @property
    def zones(self) -> tuple[Zone, ...]:
        """The zones of the other law."""
        return self.cycle.zones

    def energy_density(self, zone: str, points: Array) -> Array:
        """U, J/m3, at points (2, n)."""
        if self.deflection <= 0 or self.case.deflection <= 0:
            return np.zeros(np.shape(points)[1])
        s, depth = self.section.locate(np.asarray(points, dtype=float).T)
        share = np.clip(depth / self.section.total_thickness(s), 0.0, 1.0)
        at = self.stated.place(s, share * self.stated.total_thickness(s)).T
        scale = self.factor * (self.case.deflection / self.deflection) ** 2
        return np.asarray(scale * self.cycle.energy_density(zone, at))


def mode_sum(place: Array, amplitudes: tuple[float, ...]) -> Array:
    """sum_k a_k cos(k pi x) at x (n,) from 0 at the crown to 1 at the bead.

    >>> mode_sum(np.array([0.0, 1.0]), (0.1, 0.2)).round(3).tolist()
    [0.3, -0.1]
    """
    orders = np.arange(len(amplitudes))
    return np.asarray(np.cos(np.pi * np.outer(place, orders)) @ np.array(amplitudes))


@dataclass(frozen=True)
class OtherModel:
    """The structural differences of one case.

    Parameters
    ----------
    law : another strain law; empty: the study's law. factor : on its energy.
    modes : amplitudes a_k of `ShapedEnergy`; empty with another law.
    gauges : region -> factor on its thickness; empty for a mesh from a file.
    speed_laws : effect of the catalogue -> exponent of speed added to the film's law.
    """

    law: str
    factor: float
    modes: tuple[float, ...]
    gauges: Mapping[str, float]
    speed_laws: Mapping[str, float]

    @property
    def effects(self) -> tuple[Effect, ...]:
        """The films' speed laws as effects."""
        return tuple(catalogue()[name].check({"exponent": value}) for name, value in self.speed_laws.items())

    def changed(self, study: StudyData, mesh: Mapping[str, Any]) -> StudyData:
        """A study with the true gauges on a mesh; its sensors keep station and depth, and stay in the rubber."""
        if not self.gauges:
            return study.replace(mesh)
        scale = {f"section.parameters.thickness_scale.{region}": factor for region, factor in self.gauges.items()}
        section = study.replace({"sensors": {}, "effects": []} | scale).section
        places: dict[str, Any] = {}
        for name in study.sensors:
            written = {key: value for key, value in study.data["sensors"][name].items() if key not in PLACE_KEYS}
            s, depth = _place(study, name)
            inside = min(depth, float(section.rubber_thickness([s])[0]) - COVER)
            places[f"sensors.{name}"] = written | {"s": f"{s!r} m", "depth": f"{inside!r} m"}
        return study.replace(scale | places | dict(mesh))

    def schedule(self, stated: StudyData, hidden: StudyData) -> CycleSchedule:
        """Strain cycles of the case at one run.

        ``stated``: the study as written at the run; ``hidden``: the study with the case's values and gauges.
        """
        schedule = cycle_schedule(hidden)
        section, stated_section = hidden.section, stated.section
        cycles: list[tuple[StrainCycle, ...]] = []
        if not self.law:
            cycles += [tuple(ShapedEnergy(cycle, section, self.modes) for cycle in row) for row in schedule.cycles]
            return replace(schedule, cycles=tuple(cycles))
        other = schedule_by(stated, self.law)
        for phase, cases in enumerate(schedule.cases):
            pairs = zip(other.cases[phase], other.cycles[phase], strict=True)
            known, cycle = max(pairs, key=lambda pair: pair[0].deflection)
            cycles.append(
                tuple(
                    ScaledEnergy(cycle, stated_section, known.deflection, case, section, self.factor) for case in cases
                )
            )
        return replace(schedule, cycles=tuple(cycles))

    def to_dict(self, mesh: Mapping[str, Any]) -> dict[str, Any]:
        """The hidden structural parts for a row of ``blind.json``."""
        return {
            "strain_law": self.law or None,
            "strain_factor": self.factor if self.law else None,
            "strain_modes": list(self.modes),
            "strain_modes_rms": None if self.law else rms_of_modes(self.modes),
            "gauges": dict(self.gauges),
            "film_speed_exponents": dict(self.speed_laws),
            "mesh": dict(mesh),
            "time_integration": f"theta {THETA:g}, even steps of {STRUCTURAL_STEP:g} s",
        }


def _place(study: StudyData, name: str) -> tuple[float, float]:
    """Station and depth of a sensor in the section as stated, m."""
    sensor = study.sensors[name]
    if sensor.s is not None and sensor.depth is not None:
        return sensor.s, sensor.depth
    s, depth = study.section.locate(np.array([study.stated_places[name]]))
    return float(s[0]), float(depth[0])


def rms_of_modes(amplitudes: tuple[float, ...]) -> float:
    """Root mean square of `mode_sum` along the meridian: cosines are orthogonal.

    >>> round(rms_of_modes((0.3, 0.4)), 4)
    0.4123
    """
    return math.sqrt(sum(a * a * (1.0 if k == 0 else 0.5) for k, a in enumerate(amplitudes)))


def drawn_model(study: StudyData, rng: np.random.Generator, hidden: tuple[str, ...] = ()) -> OtherModel:
    """Structural differences drawn at random. A film whose speed law is the ``hidden`` effect has no further one."""
    spread = rng.uniform(*MODES_RMS)
    amplitudes = rng.normal(size=MODES + 1) / np.where(np.arange(MODES + 1) == 0, 1.0, math.sqrt(0.5))
    modes = tuple(float(a) for a in spread * amplitudes / rms_of_modes(tuple(amplitudes)))
    gauges = {region: float(1 + rng.choice([-1.0, 1.0]) * rng.uniform(*GAUGES)) for region in study.section.regions}
    exponents = {
        OUTSIDE_FILM: float(rng.choice([-1.0, 1.0]) * rng.uniform(*OUTSIDE_SPEED)),
        ROAD_FILM: float(rng.uniform(*ROAD_SPEED)),
    }
    wants_law = rng.random() < OTHER_LAW_SHARE
    known = catalogue()
    speed_laws = {
        name: value
        for name, value in exponents.items()
        if name in known and name not in hidden and known[name].refusal(study) is None
    }
    if study.card.mesh.file is not None:
        gauges = {}
    law, factor = other_law(study) if wants_law else ("", 1.0)
    return OtherModel(law, factor, () if law else modes, gauges, speed_laws)


def other_law(study: StudyData) -> tuple[str, float]:
    """Another strain law that can run, and the factor that gives its tyre the study's heat; empty without one.

    The heat is that of the first moment of the drive at which the tyre turns: a model with another strain law has been
    compared with a measured rolling resistance.
    """
    for law in OTHER_LAWS.get(study.card.mechanics.strain, ()):
        with contextlib.suppress(InputError):
            heats = [heat_at_start(study, schedule) for schedule in (None, schedule_by(study, law))]
            if min(heats) > 0:
                return law, heats[0] / heats[1]
    return "", 1.0


def heat_at_start(study: StudyData, cycles: CycleSchedule | None = None) -> float:
    """W, heat of hysteresis at 60 degC as the tyre begins to turn; 0 if it never turns. ``cycles``: other ones."""
    tyre = RollingTyre(study.replace(COARSE), cycles=cycles)
    operators = tyre.problem.operators
    turning = (t + 1e-6 for t in tyre.drive.starts if tyre.motion(t + 1e-6).turns)
    begin = next(turning, None)
    if begin is None:
        return 0.0
    watts = 0.0
    for zone, source in tyre.hysteresis.items():
        x = operators.nodes(zone)
        watts += float(operators.mass_row(zone)[operators.dofs(zone)] @ source(x, begin, np.full(x.shape[1], 60.0)))
    return watts


def schedule_by(study: StudyData, law: str) -> CycleSchedule:
    """The strain cycles of a study by another law, on a coarse mesh. The 32 latest are kept."""
    key = digest([effects_source(), plain(study), law])
    return _SCHEDULES.get(key, lambda: cycle_schedule(study.replace({**COARSE, "mechanics.strain": law})))
