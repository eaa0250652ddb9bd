"""The inflated tyre: growth, cord tensions, bead tension, and the initial state of a footprint."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.errors import InputError
from tyrefem.mechanics.solid.body import Body, Prestressed
from tyrefem.mechanics.solid.centrifugal import Centrifugal
from tyrefem.mechanics.solid.compounds import determinant
from tyrefem.mechanics.solid.newton import Equilibrium, NewtonChoice, equilibrium, spun_equilibrium

if TYPE_CHECKING:
    from tyrefem.geometry.meshing.mesh import TyreMesh
    from tyrefem.inputs.study import StudyData

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LayerTension:
    """Cords of a region: smallest, mean and largest of three quantities. ``strain``: stretch - 1. ``stress``:
    v_c E (lambda - 1) along the cords per undeformed section of the layer, Pa. ``tension``: of one cord, N (None: its
    diameter is not known)."""

    region: str
    strain: tuple[float, float, float]
    stress: tuple[float, float, float]
    tension: tuple[float, float, float] | None


@dataclass(frozen=True, eq=False)
class Inflation(Brief):
    """A body in equilibrium under inflation pressure. Made by `inflate`.

    ``half``: the body is the half z >= 0 of a symmetric tyre. Lengths and volumes below are those of the whole tyre.
    """

    body: Body
    equilibrium: Equilibrium
    half: bool = True

    @property
    def pressure(self) -> float:
        """Gauge pressure, Pa."""
        return self.equilibrium.pressure

    @property
    def displacement(self) -> Array:
        """(2, n_nodes) u_r, u_z of all nodes, m."""
        return self.equilibrium.displacement

    @property
    def places(self) -> Array:
        """(2, n_nodes) inflated positions of the nodes, m."""
        return self.body.rings.nodes + self.displacement

    @functools.cached_property
    def deformation(self) -> Array:
        """F (3, 3, n_elements, n_points)."""
        return self.body.deformation(self.displacement)

    @functools.cached_property
    def state(self) -> Prestressed:
        """The inflated state as the start of a small further motion."""
        return self.body.state(self.displacement, self.pressure)

    @property
    def angular_speed(self) -> float:
        """W of the spinning tyre, rad/s; zero at rest."""
        return 0.0 if self.body.centrifugal is None else self.body.centrifugal.angular_speed

    @functools.cached_property
    def rolling_state(self) -> Prestressed:
        """`state` with the inertia of steady motions through which the tyre turns (`solid.spin.rolled`)."""
        spin = self.body.centrifugal
        if spin is None:
            return self.state
        from tyrefem.mechanics.solid.spin import rolled

        return rolled(self.state, spin.density / determinant(self.deformation), spin.angular_speed)

    @property
    def mesh(self) -> Any:
        """The inflated mesh, skfem ``MeshQuad2``."""
        return self.state.mesh

    @property
    def radius_growth(self) -> float:
        """Growth of the largest radius, m."""
        return float(self.places[0].max() - self.body.rings.nodes[0].max())

    @property
    def width_growth(self) -> float:
        """Growth of the overall width, m."""
        if self.half:
            return float(2 * (self.places[1].max() - self.body.rings.nodes[1].max()))
        return float(np.ptp(self.places[1]) - np.ptp(self.body.rings.nodes[1]))

    @functools.cached_property
    def cord_tensions(self) -> dict[str, LayerTension]:
        """Region -> stretch and tension of its cords."""
        tensions = {}
        for region, part in self.body.parts.items():
            members = self.body.mesh.subdomains[region]
            deformation, weights = self.deformation[:, :, members], self.body.rings.weights[members]
            for layer in part.cords:
                tension = None if layer.cord_stiffness is None else _spread(layer.tension(deformation), weights)
                strain, stress = _spread(layer.stretch(deformation) - 1, weights), layer.stress_in_layer(deformation)
                tensions[region] = LayerTension(region, strain, _spread(stress, weights), tension)
        return tensions

    @property
    def bead_tension(self) -> float:
        """Hoop force of the cords of region ``bead`` on one side, N: int sigma_tt dA of the cords.

        Raises
        ------
        InputError : no region ``bead``, or no hoop cords in it.
        """
        part = self.body.parts.get("bead")
        if part is None or not part.cords:
            raise InputError("the body has no region 'bead' with wires")
        members = self.body.mesh.subdomains["bead"]
        deformation = self.deformation[:, :, members]
        weights = self.body.rings.weights[members] / self.body.rings.points[0][members]
        # First Piola stress times undeformed area: tau_tt / F_tt.
        stress = sum(layer.stress(deformation)[2] for layer in part.cords) / deformation[2, 2]
        return float((stress * weights).sum()) / (1 if self.half else 2)

    def summary(self) -> dict[str, float]:
        """Growth, m; bead tension, N; Newton steps."""
        values = {
            "pressure_Pa": self.pressure,
            "radius_growth_m": self.radius_growth,
            "width_growth_m": self.width_growth,
            "load_steps": float(len(self.equilibrium.steps)),
            "newton_iterations": float(sum(len(history) - 1 for history in self.equilibrium.residuals)),
        }
        bead = self.body.parts.get("bead")
        return {**values, "bead_tension_N": self.bead_tension} if bead and bead.cords else values


def _spread(values: Array, weights: Array) -> tuple[float, float, float]:
    return float(values.min()), float((values * weights).sum() / weights.sum()), float(values.max())


def inflate(
    study: StudyData,
    pressure: float | None = None,
    mesh: TyreMesh | None = None,
    choice: NewtonChoice | None = None,
    temperature: Any = None,
    angular_speed: float = 0.0,
    near: Inflation | None = None,
) -> Inflation:
    """Inflate a study's tyre, and let it spin.

    Parameters
    ----------
    study : the study.
    pressure : Pa above the ambient; by default that of the drive's first phase.
    mesh : a mesh of the study's section in quadrilaterals; by default that of the study.
    temperature : degC, as for `tyrefem.mechanics.solid.thermal.warm`; by default without thermal expansion.
    angular_speed : W, rad/s; the centrifugal load is W^2 times mass times radius.
    near : a nearby inflated tyre on the same mesh to start from; the result is the same to the search's tolerance.

    Raises
    ------
    InputError : a card without a modulus, or no equilibrium: the message gives the share of the pressure and the place.

    >>> from tyrefem import study
    >>> from tyrefem.geometry.meshing import build
    >>> tyre = study("nasa-22x5.5-8pr")
    >>> inflated = inflate(tyre, 5e5, build(tyre.section, size=10e-3, through=1))
    >>> 0 < inflated.radius_growth < 0.02
    True
    """
    from tyrefem.mechanics.solid.tyre_body import reference_density, tyre_body

    if pressure is None:
        pressure = float(study.card.drive.phases[0].pressure.start)
    if not (np.isfinite(pressure) and pressure >= 0):
        raise InputError(f"must be a pressure of 0 Pa or more, not {pressure:g}", field="pressure")
    body = tyre_body(study, mesh)
    spin = Centrifugal(body.rings, reference_density(study, body), angular_speed) if angular_speed else None
    try:
        if temperature is None:
            start = None if near is None else near.equilibrium.displacement
            still = equilibrium(body, pressure, choice, start)
            spinning = replace(body, centrifugal=spin)
            return Inflation(spinning, spun_equilibrium(spinning, still, choice), study.section.half)
        from tyrefem.mechanics.solid import thermal

        warmed = thermal.warm(body, temperature, thermal.expansions(study))
        state = thermal.thermal_equilibrium(warmed, equilibrium(body, pressure, choice))
        warmed = replace(warmed, centrifugal=spin)
        state = spun_equilibrium(warmed, state, choice)
    except InputError as error:
        raise error if error.file else InputError(error.message, field=error.field, file=study.file) from None
    return Inflation(warmed, state, study.section.half)


def spin(study: StudyData, still: Inflation, angular_speed: float, choice: NewtonChoice | None = None) -> Inflation:
    """A study's inflated tyre that does not spin, set spinning: as `inflate` with ``angular_speed``, which is not 0.

    Raises
    ------
    InputError : no equilibrium at this speed.
    """
    from tyrefem.mechanics.solid.tyre_body import reference_density

    body = still.body
    spinning = replace(body, centrifugal=Centrifugal(body.rings, reference_density(study, body), angular_speed))
    try:
        return Inflation(spinning, spun_equilibrium(spinning, still.equilibrium, choice), still.half)
    except InputError as error:
        raise error if error.file else InputError(error.message, field=error.field, file=study.file) from None
