"""Strain-energy density of the NASA report: two arcs, barrel deformation (Clark & Dodge 1980, eqs 2-19).

Once per revolution a material point goes from the inflated section to the section under the footprint's centre. The
whole tyre is taken as pressed in a barrel ("axisymmetric"). The hysteresis loss is a share of the energy of that
change.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.cache import Cache, Content
from tyrefem.errors import InputError
from tyrefem.inputs.loading import LoadCase
from tyrefem.mechanics.arc_geometry import BiasPlies, DeflectedArcs, deflected_sidewall, sidewall_arc
from tyrefem.mechanics.strain_cycle import Zone

if TYPE_CHECKING:
    from tyrefem.geometry import Section

Array = NDArray[np.float64]
#: sqrt(2) exp(-1/2): steepest slope of the Gaussian that the hoop force is assumed to follow (D2, D3).
STEEPEST_SLOPE = math.sqrt(2.0) * math.exp(-0.5)
#: 1.25 p0 mean contact pressure at the footprint's centre, and 1.5 on energy for its shape (appendix E), as in eq 11.
CONTACT_PRESSURE = 1.5


def report_zones(shoulder: float) -> tuple[Zone, ...]:
    """Regions I to V of the report; ``shoulder`` is the shoulder's distance from the crown, m."""
    return (
        Zone("I", "carcass", "carcass under the tread", 0.0, shoulder),
        Zone("II", "tread", "tread rubber"),
        Zone("III", "carcass", "sidewall carcass", shoulder),
        Zone("IV", "sidewall", "sidewall rubber"),
        Zone("V", "bead", "bead"),
    )


@dataclass(frozen=True)
class ArcStiffness:
    """Stiffness values of the materials from which the strain energy is computed. SI."""

    carcass: BiasPlies
    ply_shear_modulus: float
    tread_shear_modulus: float
    sidewall_shear_modulus: float
    bead_modulus: float
    bead_wire_area: float


@dataclass(frozen=True)
class Strains:
    """Strain cycle at points: hoop and meridional strain, meridional stress change (Pa), membrane shear force (N/m).

    ``radius`` is the midline's radius at the points, m, where the plies' stiffness is evaluated.
    """

    radius: Array
    hoop: Array
    meridional: Array
    stress: Array
    shear_force: Array
    carcass_thickness: Array


@dataclass(frozen=True)
class Places:
    """Positions of points (2, n), independent of the load: s, distance y from the carcass midline, carcass thickness
    and radius of the meridian; for the sidewall also the fraction of its arc and the distance from the meridian."""

    points: Array
    s: Array
    y: Array
    thickness: Array
    radius: Array
    fraction: Array
    offset: Array


@dataclass(frozen=True)
class PliesAt:
    """Plies at radii: E_theta and E_phi, Pa, and nu_theta_phi; the same for all load cases."""

    radius: Array
    theta: Array
    phi: Array
    poisson: Array


#: Positions of points are kept by section, part of it and points; plies by material and radii. All load cases and
#: variants on the same section and mesh share them: a two-arc section has four zones with nodes.
_PLACES: Cache[Places] = Cache(size=32)
_PLIES: Cache[PliesAt] = Cache(size=32)


def plies_at(plies: BiasPlies, radius: Array) -> PliesAt:
    """The plies at radii (n,), m. The 32 latest are kept."""

    def compute() -> PliesAt:
        return PliesAt(radius, plies.circumferential(radius), plies.meridional(radius), plies.poisson(radius))

    return _PLIES.get((plies, Content.of(radius)), compute)


def places(section: Section, at_crown: bool, points: Array) -> Places:
    """The positions of points (2, n) of the crown or the sidewall. The 32 latest are kept."""
    return _PLACES.get((section, at_crown, Content.of(points)), lambda: _places(section, at_crown, points))


def _places(section: Section, at_crown: bool, points: Array) -> Places:
    line: Any = section.line
    s, depth = section.locate(points.T)
    s = np.minimum(np.abs(s), line.length)
    y = np.asarray(section.midline_offset(s, depth))
    s = np.minimum(s, line.shoulder_s) if at_crown else np.maximum(s, line.shoulder_s)
    fraction, offset = s, s
    if not at_crown:
        fraction = (s - line.shoulder_s) / (line.length - line.shoulder_s)
        # A point of the mirrored half (z < 0) has the same values as its mirror image.
        offset = np.sum((np.abs(points.T) - line.position(s)) * line.normal(s), axis=1)
    thickness = np.asarray(section.thickness("carcass", s))
    return Places(points, s, y, thickness, line.position(s)[:, 0], fraction, offset)


@functools.lru_cache(maxsize=32)
def sidewall_compliance(section: Section, plies: BiasPlies) -> tuple[float, Array, Array]:
    """Mean of 1/(h_c E_phi) over the sidewall, m/N; positions s and the integral of cot^2 from the crown to s, m.

    It is the same for all load cases. The 32 latest are kept.
    """
    line: Any = section.line
    side = np.linspace(line.shoulder_s, line.length, 101)
    stiffness = section.thickness("carcass", side) * plies.meridional(line.position(side)[:, 0])
    compliance = float(np.trapezoid(1 / stiffness, side) / (line.length - line.shoulder_s))
    s = np.linspace(0.0, line.length, 401)
    cot2 = plies.cot2(line.position(s)[:, 0])
    integral = np.concatenate([[0.0], np.cumsum((cot2[1:] + cot2[:-1]) / 2 * np.diff(s))])
    return compliance, s, integral


@functools.lru_cache(maxsize=32)
def bead_area(section: Section) -> float:
    """Area of the region of one bead, m2. The values of the 32 latest sections are kept."""
    return float(section.area("bead")) / (1 if section.half else 2)


@dataclass(frozen=True, eq=False)
class Arcs:
    """The strain cycle of one load case on one section (SI units).

    The report's arcs do not apply below the deflection that flattens the whole crown. There the strains at that
    deflection are scaled with D (linear elasticity; an estimate). U then falls to zero with the square of the load.
    """

    section: Any
    stiffness: ArcStiffness
    case: LoadCase

    def __post_init__(self) -> None:
        if not hasattr(self.section.line, "sidewall_radius"):
            raise InputError(
                "the strain law 'arcs' needs a section whose reference line is 'two-arcs'",
                field="mechanics.strain",
            )

    @property
    def zones(self) -> tuple[Zone, ...]:
        """Regions I to V of the report."""
        return report_zones(self.section.line.shoulder_s)

    # -- geometry ----------------------------------------------------------------------------------------------

    @functools.cached_property
    def full_flattening(self) -> float:
        """Smallest deflection, m, that flattens the crown and shortens the sidewall's chord."""
        line = self.section.line
        (xc, yc), (xb, yb) = line.shoulder, line.bead
        inflated = math.hypot(xc - xb, yc - yb)
        across = line.shoulder_s - xb
        lowest = yb + math.sqrt(max(inflated**2 - across**2, 0.0))
        return float(max(line.crown_midline_radius - yc, line.crown_midline_radius - lowest) * (1 + 1e-6))

    @property
    def _scale(self) -> float:
        return min(self.case.deflection / self.full_flattening, 1.0)

    @property
    def _deflection(self) -> float:
        return max(self.case.deflection, self.full_flattening)

    @functools.cached_property
    def inflated(self) -> DeflectedArcs:
        """The sidewall arc before deflection."""
        line = self.section.line
        return sidewall_arc(line.shoulder, line.bead, line.sidewall_radius, line.length - line.shoulder_s)

    @functools.cached_property
    def deflected(self) -> DeflectedArcs:
        """The sidewall arc under the footprint's centre."""
        line = self.section.line
        return deflected_sidewall(line, self._deflection, self._sidewall_compliance[0], self.case.pressure)

    # -- membrane forces ---------------------------------------------------------------------------------------

    def _membrane_change(self, inflated_radius: Array, deflected_radius: Array) -> Array:
        """N_phi,B - N_phi,A = p0/2 [R_f (1 + b_f/z_f) - R_1 (1 + b_i/z_i)], N/m (14, F2, F3)."""
        after = self.deflected.radius * (1 + self.deflected.centre_radius / deflected_radius)
        before = self.inflated.radius * (1 + self.inflated.centre_radius / inflated_radius)
        return np.asarray(self.case.pressure / 2 * (after - before))

    @functools.cached_property
    def _shoulder_change(self) -> float:
        line = self.section.line
        return float(
            self._membrane_change(np.array(line.shoulder[1]), np.array(line.crown_midline_radius - self._deflection))
        )

    @property
    def _sidewall_compliance(self) -> tuple[float, Array, Array]:
        return sidewall_compliance(self.section, self.stiffness.carcass)

    def _shear_force(self, s: Array, membrane_change: Array) -> Array:
        """N = (0.858/w) (N_phi,A - N_phi,B) int cot^2(alpha) ds from the crown (D5)."""
        return np.asarray(
            STEEPEST_SLOPE / self.section.rating.width * -membrane_change * np.interp(s, *self._sidewall_compliance[1:])
        )

    # -- strains -----------------------------------------------------------------------------------------------

    def strains(self, zone: str, points: Array) -> Strains:
        """Strain cycle at points (2, n) of zones I to IV."""
        at_crown = zone in ("I", "II")
        return (self._crown if at_crown else self._sidewall)(places(self.section, at_crown, np.asarray(points)))

    def _crown(self, at: Places) -> Strains:
        line, case = self.section.line, self.case
        hoop = -self._deflection / at.radius - at.y * (1 / at.radius + 2 / case.drum_diameter)
        membrane = np.full_like(at.s, self._shoulder_change)
        stress = membrane / at.thickness - self._plies(at.radius).phi * at.y / line.crown_radius
        return self._strains(at, hoop, stress, membrane)

    def _sidewall(self, at: Places) -> Strains:
        line = self.section.line
        before, _ = self.inflated.place(at.fraction, at.offset)
        after, _ = self.deflected.place(at.fraction, at.offset)
        hoop = (after - before) / before
        midline_after, _ = self.deflected.place(at.fraction, np.zeros_like(at.s))
        membrane = self._membrane_change(at.radius, midline_after)
        bending = self._plies(at.radius).phi * at.y * (1 / self.deflected.radius - 1 / line.sidewall_radius)
        return self._strains(at, hoop, membrane / at.thickness + bending, membrane)

    def _strains(self, at: Places, hoop: Array, stress: Array, membrane: Array) -> Strains:
        plies, k = self._plies(at.radius), self._scale
        meridional = self.stiffness.carcass.poisson_term * stress / plies.phi - plies.poisson * hoop
        shear = self._shear_force(at.s, membrane)
        return Strains(at.radius, k * hoop, k * meridional, k * stress, k * shear, at.thickness)

    # -- energies ----------------------------------------------------------------------------------------------

    def energy_density(self, zone: str, points: Array) -> Array:
        """U, J/m3, at points (2, n) of a zone.

        I, III: 1/2 [E_theta e_theta^2 + c_a s_phi^2/E_phi] + 1/2 N^2/(h_c^2 G_pt)   (c_b = 0; 2-9, 13-17)
        II: G (e_phi^2 + e_theta^2 + e_y^2), e_y = -1.5 p0/E_r - 0.5 (e_phi + e_theta)   (10-12)
        IV: G (e_phi^2 + e_theta^2)   (18);  V: 1/2 (T_f - T_i)^2/(A_B E_B), spread over the region   (19)
        """
        points = np.asarray(points, dtype=float)
        if self.case.deflection <= 0:
            return np.zeros(points.shape[1])
        if zone == "V":
            return np.full(points.shape[1], self.bead_energy / bead_area(self.section))
        strains = self.strains(zone, points)
        if zone in ("I", "III"):
            return self._carcass_energy(strains)
        return self._rubber_energy(zone, strains)

    def _plies(self, radius: Array) -> PliesAt:
        return plies_at(self.stiffness.carcass, radius)

    def _carcass_energy(self, strains: Strains) -> Array:
        plies = self._plies(strains.radius)
        stretch = plies.theta * strains.hoop**2
        stress = self.stiffness.carcass.poisson_term * strains.stress**2 / plies.phi
        shear = strains.shear_force**2 / (strains.carcass_thickness**2 * self.stiffness.ply_shear_modulus)
        return np.asarray((stretch + stress + shear) / 2)

    def _rubber_energy(self, zone: str, strains: Strains) -> Array:
        if zone == "IV":
            return np.asarray(self.stiffness.sidewall_shear_modulus * (strains.meridional**2 + strains.hoop**2))
        modulus = self.stiffness.tread_shear_modulus
        contact = CONTACT_PRESSURE * self.case.pressure / (3 * modulus) * self._scale
        through_thickness = -contact - 0.5 * (strains.meridional + strains.hoop)
        return np.asarray(modulus * (strains.meridional**2 + strains.hoop**2 + through_thickness**2))

    @functools.cached_property
    def bead_tension_change(self) -> float:
        """T_f - T_i, N, of the bead bundle: T = N_phi sin(beta) R_R (B1-B5)."""
        line, p0 = self.section.line, self.case.pressure
        rim_radius = line.bead[1]
        before, after = self.inflated, self.deflected
        cos_before = (before.centre_radius - rim_radius) / before.radius
        crown_drop = line.crown_radius * (1 - math.cos(line.shoulder_s / line.crown_radius))
        cos_after = (2 * before.radius * cos_before - (self._deflection - crown_drop)) / (2 * after.radius)

        def tension(arc: DeflectedArcs, cosine: float) -> float:
            force = p0 / 2 * arc.radius * (1 + arc.centre_radius / rim_radius)
            return force * math.sqrt(max(1 - cosine * cosine, 0.0)) * rim_radius

        return self._scale * (tension(after, cos_after) - tension(before, cos_before))

    @property
    def bead_energy(self) -> float:
        """Energy change of one bead bundle, J per metre of its length (19)."""
        return 0.5 * self.bead_tension_change**2 / (self.stiffness.bead_wire_area * self.stiffness.bead_modulus)
