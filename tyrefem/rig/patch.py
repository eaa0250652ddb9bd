"""The heated patch: layers round the beam, axisymmetric, solved with `tyrefem.conduction`."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction import Conduction, Convection, Flux, History, Material, Radiation
from tyrefem.rig.air import natural_film
from tyrefem.rig.grid import USUAL, Fineness, Grid

Array = NDArray[Any]


@dataclass(frozen=True)
class Property:
    """A property that is constant or linear in temperature: value (1 + slope (T - reference)).

    The factor is held between 0.2 and 5, so that a trial of the fit stays possible.

    >>> float(Property(0.3, slope=1e-3, reference=60.0)(160.0))
    0.33
    """

    value: float
    slope: float = 0.0
    reference: float = 60.0

    def __call__(self, temperature: Any) -> Any:
        return self.value * np.clip(1.0 + self.slope * (np.asarray(temperature) - self.reference), 0.2, 5.0)

    def law(self, factor: float = 1.0) -> Any:
        """What the conduction solver takes: a number, or a function of temperature; times a factor."""
        return self.value * factor if self.slope == 0.0 else lambda T: factor * self(T)


@dataclass(frozen=True)
class Layer:
    """One layer: thickness m, density kg/m3, conductivity W/m/K, specific heat J/kg/K."""

    name: str
    thickness: float
    density: float
    conductivity: Property
    specific_heat: Property

    def material(self) -> Material:
        """The layer for the conduction solver."""
        return Material(self.conductivity.law(), self.specific_heat.law(self.density))


@dataclass(frozen=True)
class Patch:
    """A round piece of the tyre about the beam.

    rho c dT/dt = div(k grad T); on either face k dT/dn = film_scale h_nat(T) (Ta - T) + eps sigma (Ta^4 - T^4),
    on the spot plus the absorbed power; no heat through the rim. The layers are bent to spherical shells of the
    crown's mean curvature, which is right to first order in thickness times curvature.

    Parameters
    ----------
    layers : from the outer face (that the laser hits) to the inner one.
    radius : of the patch along the outer face, m.
    curvature : mean curvature of the outer face, 1/m; 0 is flat, positive has its centre inside the tyre.
    spot_radius : m; profile ``uniform``: the disc's radius, ``gaussian``: where the intensity is 1/e2.
    absorbed : power taken up, W; a collimated beam, so its intensity on the face follows the cosine.
    ambient : of air and surroundings, degC.
    length : characteristic length of natural convection, m.
    outer_film, inner_film : factors on the film of natural convection.
    emissivity : of both faces; 0 leaves radiation out.
    """

    layers: tuple[Layer, ...]
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

    def grid(self, fineness: Fineness | None = None) -> Grid:
        """The mesh; patches of one shape share it."""
        shape = tuple((one.name, one.thickness) for one in self.layers)
        return _grid(shape, self.radius, self.curvature, self.spot_radius, fineness or USUAL)

    def _face(self, factor: float) -> list[Any]:
        ambient, length = self.ambient, self.length
        film = Convection(lambda T: factor * natural_film(T, ambient, length), ambient)
        return [film, Radiation(self.emissivity, ambient)] if self.emissivity > 0 else [film]

    def conduction(self, grid: Grid, *, lit: bool) -> Conduction:
        """The conduction problem with the laser on or off."""
        regions = {one.name: one.material() for one in self.layers}
        boundaries: dict[str, list[Any]] = {"outer": self._face(self.outer_film), "inner": self._face(self.inner_film)}
        if lit:
            where, flux = self.beam(grid)
            boundaries = {**boundaries, where: [*boundaries.get(where, []), Flux(lambda _x, _t: flux)]}
        return Conduction(grid.mesh, regions, boundaries, element="P2")

    def beam(self, grid: Grid) -> tuple[str, Array]:
        """The boundary that the laser hits and the absorbed flux at its quadrature points, W/m2; exact in sum."""
        where = "spot" if self.profile == "uniform" else "outer"
        surface = grid.operators.surface(where)
        r = surface.x[0]
        shape = np.sqrt(np.clip(1.0 - (self.curvature * r) ** 2, 0.0, 1.0))
        if self.profile == "gaussian":
            shape = shape * np.exp(-2 * (r / self.spot_radius) ** 2)
        return where, shape * (self.absorbed / float(surface.weight @ shape))

    def heated(self, grid: Grid, times: Array, tolerance: float) -> History:
        """Temperatures from the moment the laser is switched on; times[0] = 0."""
        return self.conduction(grid, lit=True).transient(times, self.ambient, tolerance)

    def cooled(self, grid: Grid, times: Array, start: Array, tolerance: float) -> History:
        """Temperatures after the laser is switched off, from nodal temperatures `start`; times[0] = 0."""
        return self.conduction(grid, lit=False).transient(times, start, tolerance)


@lru_cache(maxsize=16)
def _grid(
    shape: tuple[tuple[str, float], ...], radius: float, curvature: float, spot_radius: float, fineness: Fineness
) -> Grid:
    names, thicknesses = zip(*shape, strict=True)
    return Grid.make(names, thicknesses, radius, curvature, spot_radius, fineness)
