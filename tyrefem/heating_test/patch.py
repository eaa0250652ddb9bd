"""The heated patch: axisymmetric layers around the beam, solved with `tyrefem.conduction`.

Natural convection on a vertical face in air (Allouis et al. 2016, equations 6-9; Churchill & Chu 1975).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyrefem.conduction import Conduction, Convection, Flux, History, Material, Radiation
from tyrefem.errors import InputError
from tyrefem.heating_test.grid import USUAL, Fineness, PatchGrid

Array = NDArray[Any]


GRAVITY, PRESSURE, GAS_CONSTANT, SPECIFIC_HEAT = 9.80665, 101325.0, 287.05, 1007.0
_ABSOLUTE = 273.15


def air(temperature: ArrayLike) -> tuple[Array, Array, Array]:
    """Conductivity (W/m/K), kinematic viscosity (m2/s) and Prandtl number of dry air at 1 atm, temperature in degC.

    Sutherland's laws: mu = 1.458e-6 T^1.5/(T + 110.4), k = 2.495e-3 T^1.5/(T + 194) (White, Viscous fluid flow);
    c_p = 1007 J/kg/K. Within 1 % of tables from 0 to 300 degC.

    >>> k, nu, Pr = air(26.85)
    >>> round(float(k), 4), round(float(nu) * 1e6, 1), round(float(Pr), 2)
    (0.0262, 15.7, 0.71)
    """
    T = np.asarray(temperature, dtype=float) + _ABSOLUTE
    mu = 1.458e-6 * T**1.5 / (T + 110.4)
    k = 2.495e-3 * T**1.5 / (T + 194.0)
    return k, mu * GAS_CONSTANT * T / PRESSURE, mu * SPECIFIC_HEAT / k


def nusselt(rayleigh: ArrayLike, prandtl: ArrayLike) -> Array:
    """Mean Nusselt number of a vertical plate, (9): Nu = (0.825 + 0.387 Ra^(1/6)/(1 + (0.492/Pr)^(9/16))^(8/27))^2.

    Raises InputError for a negative Rayleigh number.

    >>> round(float(nusselt(1e9, 0.71)), 1)
    122.9
    """
    Ra = np.asarray(rayleigh, dtype=float)
    if np.any(Ra < 0):
        raise InputError("must not be negative", field="rayleigh")
    spread = (1.0 + (0.492 / np.asarray(prandtl, dtype=float)) ** (9 / 16)) ** (8 / 27)
    return np.asarray((0.825 + 0.387 * Ra ** (1 / 6) / spread) ** 2)


def natural_film(surface: ArrayLike, ambient: float, length: float) -> Array:
    """Film coefficient of natural convection, W/m2/K, (8): h = Nu k_air/delta, Ra = g beta |Ts - Ta| delta^3 Pr/nu^2.

    Properties of air are at the mean of both temperatures, with beta = 1/T. The paper prints nu^3 in the Grashof
    number (6); only nu^2 makes it dimensionless.

    Parameters
    ----------
    surface : temperature Ts of the face, degC, any shape.
    ambient : temperature of the air, degC.
    length : characteristic length delta, m.

    >>> round(float(natural_film(60.0, 20.0, 0.1)), 1)
    6.1
    """
    if not length > 0:
        raise InputError(f"must be more than 0 m, not {length!r}", field="length")
    # A rejected trial step may be far outside: the laws of air are evaluated only in their range.
    Ts = np.clip(np.asarray(surface, dtype=float), -150.0, 1500.0)
    film = (Ts + ambient) / 2.0
    k, nu, Pr = air(film)
    rayleigh = GRAVITY / (film + _ABSOLUTE) * np.abs(Ts - ambient) * length**3 * Pr / nu**2
    return np.asarray(nusselt(rayleigh, Pr) * k / length)


@dataclass(frozen=True)
class Property:
    """A property, constant or linear in temperature: value (1 + slope (T - reference)).

    The factor is limited to 0.2 to 5, so that every trial of the fit has a solution.

    >>> float(Property(0.3, slope=1e-3, reference=60.0)(160.0))
    0.33
    """

    value: float
    slope: float = 0.0
    reference: float = 60.0

    def __call__(self, temperature: Any) -> Any:
        return self.value * np.clip(1.0 + self.slope * (np.asarray(temperature) - self.reference), 0.2, 5.0)

    def law(self, factor: float = 1.0) -> Any:
        """The property times a factor, for the conduction solver: a number, or a function of temperature."""
        return self.value * factor if self.slope == 0.0 else lambda T: factor * self(T)


@dataclass(frozen=True)
class PatchLayer:
    """A layer: thickness, m, density, kg/m3, conductivity, W/m/K, specific heat, J/kg/K."""

    name: str
    thickness: float
    density: float
    conductivity: Property
    specific_heat: Property

    def material(self) -> Material:
        """The layer as material of the conduction solver."""
        return Material(self.conductivity.law(), self.specific_heat.law(self.density))


@dataclass(frozen=True)
class Patch:
    """A round patch of the tyre about the beam.

    rho c dT/dt = div(k grad T); on either face k dT/dn = film_scale h_nat(T) (Ta - T) + eps sigma (Ta^4 - T^4),
    on the spot plus the absorbed power; no heat flows through the rim. The layers are spherical shells of the crown's
    mean curvature, which is correct to first order in thickness times curvature.

    Parameters
    ----------
    layers : layers from the outer face, which the laser heats, to the inner face.
    radius : radius of the patch along the outer face, m.
    curvature : mean curvature of the outer face, 1/m; 0 is flat, positive has its centre inside the tyre.
    spot_radius : m; profile ``uniform``: radius of the disc; ``gaussian``: radius of 1/e2 of the peak intensity.
    absorbed : absorbed power, W; the beam is collimated, so its intensity on the face follows the cosine.
    ambient : temperature of air and surroundings, degC.
    length : characteristic length of natural convection, m.
    outer_film, inner_film : factors on the film of natural convection.
    emissivity : emissivity of both faces; 0: no radiation.
    """

    layers: tuple[PatchLayer, ...]
    radius: float
    curvature: float
    spot_radius: float
    profile: Literal["uniform", "gaussian"]
    absorbed: float
    ambient: float
    length: float
    outer_film: float = 1.0
    inner_film: float = 1.0
    emissivity: float = 0.95

    def grid(self, fineness: Fineness | None = None) -> PatchGrid:
        """The mesh; patches of equal shape share it."""
        shape = tuple((layer.name, layer.thickness) for layer in self.layers)
        return _grid(shape, self.radius, self.curvature, self.spot_radius, fineness or USUAL)

    def _face(self, factor: float) -> list[Any]:
        ambient, length = self.ambient, self.length
        film = Convection(lambda T: factor * natural_film(T, ambient, length), ambient)
        return [film, Radiation(self.emissivity, ambient)] if self.emissivity > 0 else [film]

    def conduction(self, grid: PatchGrid, *, lit: bool) -> Conduction:
        """The conduction problem with the laser on or off."""
        regions = {layer.name: layer.material() for layer in self.layers}
        boundaries: dict[str, list[Any]] = {"outer": self._face(self.outer_film), "inner": self._face(self.inner_film)}
        if lit:
            where, flux = self.beam(grid)
            boundaries = {**boundaries, where: [*boundaries.get(where, []), Flux(lambda _x, _t: flux)]}
        return Conduction(grid.mesh, regions, boundaries, element="P2")

    def beam(self, grid: PatchGrid) -> tuple[str, Array]:
        """The heated boundary, and the absorbed flux at its quadrature points, W/m2, whose integral is exact."""
        where = "spot" if self.profile == "uniform" else "outer"
        surface = grid.operators.surface(where)
        r = surface.x[0]
        shape = np.sqrt(np.clip(1.0 - (self.curvature * r) ** 2, 0.0, 1.0))
        if self.profile == "gaussian":
            shape = shape * np.exp(-2 * (r / self.spot_radius) ** 2)
        return where, shape * (self.absorbed / float(surface.weight @ shape))

    def heated(self, grid: PatchGrid, times: Array, tolerance: float) -> History:
        """Temperatures after the laser is switched on; times[0] = 0."""
        return self.conduction(grid, lit=True).transient(times, self.ambient, tolerance)

    def cooled(self, grid: PatchGrid, times: Array, start: Array, tolerance: float) -> History:
        """Temperatures after the laser is switched off, from nodal temperatures `start`; times[0] = 0."""
        return self.conduction(grid, lit=False).transient(times, start, tolerance)


@lru_cache(maxsize=16)
def _grid(
    shape: tuple[tuple[str, float], ...], radius: float, curvature: float, spot_radius: float, fineness: Fineness
) -> PatchGrid:
    names, thicknesses = zip(*shape, strict=True)
    return PatchGrid.make(names, thicknesses, radius, curvature, spot_radius, fineness)
