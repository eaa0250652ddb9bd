"""Critical speed of a study's tyre: the smallest speed at which a wave of its belt stands still in space."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from numbers import Integral
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.brief import Brief
from tyrefem.errors import InputError
from tyrefem.estimates import work as estimate
from tyrefem.geometry.meshing.expected import QUADRATIC
from tyrefem.mechanics.footprint.harmonics import Harmonics
from tyrefem.mechanics.footprint.natural_frequencies import AT_REST, HIGHEST, belt_elements, densities
from tyrefem.mechanics.footprint.pressed_tyre import mechanical_mesh
from tyrefem.mechanics.footprint.vibration import Vibration
from tyrefem.mechanics.rolling.standing_waves import CriticalWave, SteadyWaves
from tyrefem.requirements import Requirements
from tyrefem.threads import one_thread

if TYPE_CHECKING:
    from tyrefem.geometry.meshing.mesh import TyreMesh
    from tyrefem.inputs.study import StudyData
    from tyrefem.mechanics.solid.inflation import Inflation

#: Requirements of a critical speed on the study.
NEEDS = Requirements("a critical speed")
#: A wave is the belt's if the belt's kinetic energy per mass is at least this share of the tyre's, and if at least this
#: share of the belt's energy is radial.
BELT_SHARE, RADIAL_SHARE = AT_REST, 0.5
#: Shortest wave of the belt, over the thickness of the crown: shorter ones are surface waves of the rubber.
SHORTEST = 4.0
#: Slowest waves of a family among which the belt's is looked for.
AMONG = 8
#: Relative accuracy of a critical speed; most shapes of the spinning tyre that are tried.
ACCURACY, MOST = 1e-3, 24
#: Waves up to this factor above the slowest one are given beside it.
NEARLY = 1.5
#: As the shape changes by a step of W, a wave follows by at most this many steps.
FOLLOWS = 1.2
#: Share of the section's width, about its middle, whose crown counts as a ring.
CROWN = 0.25
#: Highest speed that is tried, m/s.
FASTEST = 200.0


@dataclass(frozen=True, eq=False)
class StandingSpeed(Brief):
    """A wave that stands still in space, and the tyre that spins with its speed.

    Parameters
    ----------
    speed : W times the largest radius of the spinning tyre, m/s. radius : this radius, m.
    harmonic : number of crests round the wheel. region : with the greatest kinetic energy.
    by_harmonic : harmonic -> speed, m/s, of its slowest such wave in nearly the same shape; not all are followed.
    """

    speed: float
    radius: float
    harmonic: int
    region: str
    wave: CriticalWave
    tyre: Inflation
    by_harmonic: Mapping[int, float] = field(default_factory=dict)

    @property
    def wavelength(self) -> float:
        """m."""
        return 2 * np.pi * self.radius / self.harmonic


@dataclass(frozen=True, eq=False)
class CriticalSpeed(Brief):
    """Critical speeds of a tyre under one pressure. Made by `critical_speed`.

    Parameters
    ----------
    study : the study. pressure : Pa. temperature : degC of the moduli; None: those of the cards.
    belt : the slowest wave of the belt that stands; None: none below `FASTEST` or below the speed that tears the tyre.
    any_wave : the slowest wave of any kind, also of the sidewall alone or of the tread's surface.
    at_rest : speed, m/s, of the belt's slowest wave about the shape at rest, without centrifugal tension.
    highest : highest harmonic that was looked at.
    """

    study: StudyData
    pressure: float
    temperature: float | None
    belt: StandingSpeed | None
    any_wave: StandingSpeed | None
    at_rest: float | None
    highest: int

    def _title(self) -> str:
        return f"of {self.study.name}"

    def _facts(self) -> Mapping[str, Any]:
        row = self.row()
        return {key: "none" if row[key] is None else f"{row[key]:.4g}" for key in ("speed_m_s", "any_wave_m_s")}

    def row(self) -> dict[str, Any]:
        """A row of the table, SI."""
        belt, least = self.belt, self.any_wave
        return {
            "pressure_Pa": self.pressure,
            "temperature_degC": self.temperature,
            "speed_m_s": belt and belt.speed,
            "waves": belt and belt.harmonic,
            "wavelength_m": belt and belt.wavelength,
            "radius_m": belt and belt.radius,
            "radius_growth_m": belt and belt.tyre.radius_growth,
            "any_wave_m_s": least and least.speed,
            "any_wave_waves": least and least.harmonic,
            "any_wave_region": least and least.region,
            "speed_without_centrifugal_tension_m_s": self.at_rest,
            "highest_harmonic": self.highest,
        }


@one_thread()
def critical_speed(
    study: StudyData,
    *,
    pressure: float | None = None,
    temperature: float | None = None,
    highest: int | None = None,
) -> CriticalSpeed:
    """The smallest speed with det(K_n - W^2 M_n) = 0, n >= 2, about the tyre that spins with W, unloaded, without loss.

    K_n is the stiffness about the shape under pressure and centrifugal load, so it grows with W: W is raised from zero
    until the critical speed of a shape is its own. This gives the first such speed. The belt's wave is the slowest in
    which the belt moves radially and is not at rest (kinetic energy per mass, as in `natural_frequencies`), with crests
    at least four crown thicknesses apart. Slower waves of the sidewall alone or of the rubber's surface run near the
    speed of shear waves in rubber, sqrt(G/rho); rubber's loss damps them within a few crests.

    Parameters
    ----------
    pressure : Pa above the ambient, positive; by default at the start of the drive's first phase.
    temperature : degC of all regions: moduli follow the cards' ``softening``; by default those of the cards.
    highest : highest harmonic, 2 to 60; by default the shortest wave of the belt.

    Raises
    ------
    InputError : a campaign; a number out of range; a temperature where no card softens; no equilibrium.

    >>> from tyrefem import study
    >>> tyre = study("nasa-22x5.5-8pr", {"mesh.size": "16 mm"})
    >>> result = critical_speed(tyre, highest=14)
    >>> 60 < result.belt.speed < 100
    True
    """
    NEEDS.check(study)
    pressure = study.card.drive.phases[0].pressure.start if pressure is None else pressure
    if not pressure > 0:
        raise InputError(f"must be more than 0 Pa, not {pressure:g} Pa", field="pressure")
    if highest is not None and not (isinstance(highest, Integral) and 2 <= highest <= HIGHEST):
        raise InputError(f"must be a whole number from 2 to {HIGHEST}, not {highest}", field="highest")
    if temperature is not None:
        if not any(card.softens for card in study.materials.values()):
            raise InputError("no card gives 'softening': moduli do not depend on temperature", field="temperature")
        study = study.warmed(dict.fromkeys(study.section.regions, temperature))
    mesh = mechanical_mesh(study, large=False)
    nodes = QUADRATIC * mesh.n_nodes
    estimate.warn_if_long(10 * estimate.mechanics(nodes, large=False).time, f"the critical speed of {nodes:,} nodes")
    search = _Search(study, mesh, pressure)
    still = search.shape(0.0)
    radius = float(still.tyre.places[0].max())
    shortest = max(2, min(HIGHEST, int(2 * np.pi * radius / (SHORTEST * search.thickness(still.tyre)))))
    highest = shortest if highest is None else highest
    belt, any_wave = search.least(highest, _Shape.of_belt), search.least(highest, _Shape.of_any)
    speeds = [wave.angular_speed for n in range(2, highest + 1) if (wave := still.of_belt(n)) is not None]
    at_rest = min(speeds) * radius if speeds else None
    return CriticalSpeed(study, pressure, temperature, belt, any_wave, at_rest, highest)


def ring_speed(study: StudyData, pressure: float) -> float:
    """Speed of waves on a ring under the hoop tension of the pressure, sqrt(p r/(rho h)), m/s: the usual cheap rule.

    rho h is the mass of the crown per area, mean over the middle `CROWN` of the section's width, without the voids of
    a ``[pattern]``; r the outer radius.
    Without bending, sidewall and centrifugal tension: 90 m/s for the 22x5.5 at 83 psi, where the belt has 84 m/s.

    >>> from tyrefem import study
    >>> round(ring_speed(study("nasa-22x5.5-8pr"), 572e3), -1)
    90.0
    """
    mesh = study.mesh().mesh
    centres = mesh.p[:, mesh.t].mean(axis=1)
    middle = np.abs(centres[1]) < CROWN * np.abs(mesh.p[1]).max()
    density, area = np.zeros(mesh.nelements), np.zeros(mesh.nelements)
    for region, members in mesh.subdomains.items():
        if region in study.materials:
            density[members] = study.materials[region].density.at(study.card.drive.initial)
    section = study.section
    if section.pattern is not None and section.patterned is not None:
        density[mesh.subdomains[section.patterned]] *= section.pattern.rubber
    corners = mesh.p[:, mesh.t]
    after = np.roll(corners, -1, axis=1)
    area = np.abs((corners[0] * after[1] - corners[1] * after[0]).sum(axis=0)) / 2
    ends = mesh.p[1, mesh.t[:, middle]]
    width = float(ends.max() - ends.min())
    mass = float((density * area)[middle].sum()) / width
    return float(np.sqrt(pressure * mesh.p[0].max() / mass))


@dataclass(frozen=True, eq=False)
class _Shape:
    """The tyre spinning with W, and its waves."""

    tyre: Inflation
    waves: SteadyWaves
    _slowest: dict[int, tuple[CriticalWave, ...]] = field(default_factory=dict)

    def slowest(self, harmonic: int, count: int) -> tuple[CriticalWave, ...]:
        """The ``count`` slowest waves of each family, or more, in order of speed, with a cache."""
        if len(self._slowest.get(harmonic, ())) < count:
            self._slowest[harmonic] = self.waves.waves(harmonic, count)
        return self._slowest[harmonic]

    def of_belt(self, harmonic: int) -> CriticalWave | None:
        """The slowest wave of the belt; None: it is not among the slowest waves."""
        belt = belt_elements(self.tyre)
        for wave in self.slowest(harmonic, AMONG):
            shares = self.waves.vibration.shares(wave.mode, belt)
            if shares["belt"] >= BELT_SHARE and shares["radial"] >= RADIAL_SHARE:
                return wave
        return None

    def of_any(self, harmonic: int) -> CriticalWave | None:
        """The slowest wave."""
        return self.slowest(harmonic, 1)[0]

    def standing(self, wave: CriticalWave, by_harmonic: Mapping[int, float]) -> StandingSpeed:
        """The wave with its place."""
        radius, vibration = float(self.tyre.places[0].max()), self.waves.vibration
        weighted = vibration.density * vibration.harmonics.elements.weights
        nodes = vibration.harmonics.elements.element_nodes
        speed2 = (wave.shape.reshape(-1, 3) ** 2).sum(axis=1)[nodes] @ vibration.harmonics.elements.values.T
        energy = (weighted * speed2).sum(axis=1)
        regions = self.tyre.body.mesh.subdomains
        region = max(self.tyre.body.parts, key=lambda name: float(energy[regions[name]].sum()))
        speeds = {n: speed * radius for n, speed in sorted(by_harmonic.items())}
        return StandingSpeed(wave.angular_speed * radius, radius, wave.harmonic, region, wave, self.tyre, speeds)


@dataclass(frozen=True, eq=False)
class _Search:
    study: StudyData
    mesh: TyreMesh
    pressure: float
    _shapes: dict[float, _Shape] = field(default_factory=dict)

    def shape(self, angular_speed: float) -> _Shape:
        """The tyre that spins with W, rad/s, with a cache."""
        from tyrefem.mechanics.solid.inflation import inflate, spin

        if angular_speed not in self._shapes:
            if angular_speed:
                tyre = spin(self.study, self.shape(0.0).tyre, angular_speed)
            else:
                tyre = inflate(self.study, self.pressure, self.mesh)
            waves = SteadyWaves(Vibration(Harmonics(tyre.state), densities(self.study, tyre)))
            self._shapes[angular_speed] = _Shape(tyre, waves)
        return self._shapes[angular_speed]

    @staticmethod
    def thickness(tyre: Inflation) -> float:
        """Thickness of the crown, m: largest radius of the tread less that of the inner surface."""
        rings = tyre.body.rings
        outer, inner = (rings.nodes[0, rings.boundary_nodes(name)].max() for name in ("road", "contained_air"))
        return float(outer - inner)

    def least(self, highest: int, kind: Callable[[_Shape, int], CriticalWave | None]) -> StandingSpeed | None:
        """The first W that is a critical speed of its own shape; None: there is none up to `FASTEST`.

        W_c(W) of the shape at W rises with W and exceeds it at rest: secant steps until W_c(W) < W, then within the
        bracket. Where the slowest wave's kind changes, W_c jumps; the speed of the jump counts.

        A harmonic's W_c rises with W, by at most `FOLLOWS` times as much; only harmonics that can become the least are
        worked out again.
        """
        known: dict[int, tuple[float, float]] = {}
        near, speed = list(range(2, highest + 1)), 0.0
        below: tuple[float, float] = (0.0, np.inf)
        above: tuple[float, float] | None = None
        for _ in range(MOST):
            try:
                shape = self.shape(speed)
            except InputError as error:
                if error.field == "speed":
                    return None
                raise
            radius = float(shape.tyre.places[0].max())
            if speed * radius > FASTEST:
                return None
            waves = {n: wave for n in near if (wave := kind(shape, n)) is not None}
            if not waves:
                return None
            wave = min(waves.values(), key=lambda wave: wave.angular_speed)
            known = {n: pair for n, pair in known.items() if n not in near}
            known |= {n: (speed, wave.angular_speed) for n, wave in waves.items()}
            excess = wave.angular_speed - speed
            narrow = above is not None and above[0] - below[0] <= ACCURACY * speed
            if abs(excess) <= ACCURACY * speed or (narrow and excess < 0):
                others = [n for n, (_, last) in known.items() if n not in waves and last <= NEARLY * wave.angular_speed]
                waves |= {n: other for n in others if (other := kind(shape, n)) is not None}
                near_speeds = {n: other.angular_speed for n, other in waves.items()}
                most = NEARLY * wave.angular_speed
                return shape.standing(wave, {n: other for n, other in near_speeds.items() if other <= most})
            before, here = below, speed
            below, above = (below, (speed, excess)) if excess < 0 else ((speed, excess), above)
            if above is None:
                slope = (excess - before[1]) / (speed - before[0]) if speed else -1.0
                speed += excess / max(-slope, 0.25)
            else:
                share = below[1] / (below[1] - above[1])
                speed = above[0] if narrow else below[0] + min(max(share, 0.1), 0.9) * (above[0] - below[0])
            least = wave.angular_speed + FOLLOWS * max(speed - here, 0.0)
            near = [n for n, (at, last) in known.items() if last - FOLLOWS * max(at - speed, 0.0) <= least]
        return None
