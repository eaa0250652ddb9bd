"""A warm body: thermal expansion, and the stress where expansion is hindered."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError, nearest
from tyrefem.mechanics.solid.body import Body, Prestressed
from tyrefem.mechanics.solid.compounds import Compound, determinant
from tyrefem.mechanics.solid.cords import CordLayer
from tyrefem.mechanics.solid.newton import Equilibrium
from tyrefem.mechanics.solid.parts import RegionMaterial

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Expansion:
    """Linear expansion, 1/K, of a region's compound and of its cords (lengthwise); stress-free at ``reference``, degC.

    >>> round(Expansion(2e-4).stretch(75.0), 4)
    1.01
    """

    compound: float
    cords: float = 0.0
    reference: float = 25.0

    def stretch(self, temperature: Any) -> Any:
        """1 + alpha (T - T_ref) of the compound."""
        return 1 + self.compound * (temperature - self.reference)

    def cord_stretch(self, temperature: Any) -> Any:
        """1 + alpha (T - T_ref) of the cords."""
        return 1 + self.cords * (temperature - self.reference)


@dataclass(frozen=True)
class WarmCompound(Compound):
    """A compound whose stress-free state is larger by ``thermal`` (...) in all directions: t^3 W(F/t)."""

    thermal: Array | float = 1.0

    def energy(self, deformation: Array) -> Array:
        """W_iso per volume of the cold state, J/m3."""
        return np.asarray(self.thermal**3 * super().energy(deformation / self.thermal))

    def stress(self, deformation: Array) -> Array:
        """Kirchhoff stress (over the volume of the cold state), Pa, (6, ...)."""
        return np.asarray(self.thermal**3 * super().stress(deformation / self.thermal))

    def tangent(self, deformation: Array) -> Array:
        """J c, Pa, (6, 6, ...)."""
        return np.asarray(self.thermal**3 * super().tangent(deformation / self.thermal))


@dataclass(frozen=True, eq=False)
class WarmCords(CordLayer):
    """Cords whose stress-free length is ``thermal`` (...) times that of the cold state."""

    thermal: Array | float = 1.0

    def _deformed_directions(self, deformation: Array) -> tuple[Array, Array]:
        return super()._deformed_directions(deformation / self.thermal)


@dataclass(frozen=True, eq=False)
class WarmBody(Body):
    """A body whose elastic deformation is F/t, t = 1 + alpha (T - T_ref) ``thermal`` (n_elements, n_points).

    p = kappa t^3 (Proj (J/t^3) - 1) is work-conjugate to J/t^3; t^3 is averaged over each element. Made by `warm`.
    """

    thermal: Array = field(default_factory=lambda: np.ones((1, 1)))

    @functools.cached_property
    def bulk(self) -> Array:
        """(n_elements,) bulk modulus over the volume of the cold state, Pa."""
        moduli = np.zeros(self.mesh.t.shape[1])
        for name, part in self.parts.items():
            moduli[self.mesh.subdomains[name]] = part.compound.bulk_modulus
        return np.asarray(moduli * (self.thermal**3).mean(axis=1))

    def pressure(self, volume: Array) -> Array:
        """(n_elements, n_points) pressure, Pa; times J it is the mean Kirchhoff stress."""
        return np.asarray(super().pressure(volume / self.thermal**3) / self.thermal**3)

    def energy(self, displacement: Array) -> float:
        """Elastic energy per radian, J."""
        volume = determinant(self.deformation(displacement))
        share = self.pressure(volume) / self.bulk[:, None]
        more = self.bulk[:, None] / 2 * share**2 * (self.thermal**6 - 1)
        return super().energy(displacement) + float((more * self.rings.weights).sum())

    def heated(self, share: float) -> WarmBody:
        """The body at a share of its thermal strain."""

        def at_share(warm: Any) -> Any:
            return replace(warm, thermal=1 + share * (warm.thermal - 1))

        parts = {
            name: replace(part, compound=at_share(part.compound), cords=tuple(map(at_share, part.cords)))
            for name, part in self.parts.items()
        }
        return cast("WarmBody", replace(at_share(self), parts=parts))

    def _dilatation_stiffness(self, strains: Array, volume: Array) -> Array:
        return super()._dilatation_stiffness(strains, volume / self.thermal**3)

    def state(self, displacement: Array, pressure: float) -> Prestressed:
        """The deformed state as the start of a small further motion."""
        state = super().state(displacement, pressure)
        return replace(state, bulk=state.bulk / self.thermal**6, law=None)


def expansions(study: StudyData) -> dict[str, Expansion]:
    """Region -> expansion, for all cards that give one.

    Raises
    ------
    InputError : no card gives one.
    """
    written = {region: card.expansion for region, card in study.materials.items()}
    given = {
        region: Expansion(expansion.coefficient, expansion.cords, expansion.stress_free)
        for region, expansion in written.items()
        if expansion is not None
    }
    if not given:
        raise InputError("no material card gives 'expansion'", field="materials", file=study.file)
    return given


def warm(body: Body, temperature: Any, expansions: Mapping[str, Expansion]) -> WarmBody:
    """A body at given temperatures.

    Parameters
    ----------
    temperature : degC: a number, (n_elements, n_points), or a function of places (2, n) in (r, z), m, giving (n,).
    expansions : region -> its expansion; regions without one keep their size.

    Raises
    ------
    InputError : an unknown region; temperatures that are not finite or have the wrong shape.
    """
    for region in expansions:
        if region not in body.parts:
            raise InputError(f"the body has no region '{region}'{nearest(region, body.parts)}", field="expansion")
    shape = body.rings.weights.shape
    given = temperature(body.rings.points.reshape(2, -1)).reshape(shape) if callable(temperature) else temperature
    try:
        values = np.broadcast_to(np.asarray(given, dtype=float), shape)
    except ValueError:
        raise InputError(f"needs one number per Gauss point, {shape}", field="temperature") from None
    if not np.isfinite(values).all():
        raise InputError("must be finite, degC", field="temperature")
    thermal, parts = np.ones(shape), {}
    for region, part in body.parts.items():
        law, members = expansions.get(region, Expansion(0.0)), body.mesh.subdomains[region]
        here = values[members]
        thermal[members] = law.stretch(here)
        compound = WarmCompound(**_fields(part.compound), thermal=thermal[members])
        cords = tuple(WarmCords(**_fields(layer), thermal=law.cord_stretch(here)) for layer in part.cords)
        parts[region] = RegionMaterial(compound, cords, part.cord_loss, part.blocks)
    if thermal.min() <= 0.5:
        raise InputError("temperatures at which nothing would be left of a region", field="temperature")
    return WarmBody(**{**_fields(body), "parts": parts}, thermal=thermal)


def _fields(of: Any) -> dict[str, Any]:
    return {field.name: getattr(of, field.name) for field in fields(of)}


#: First and smallest share of the heating in one step of `thermal_equilibrium`.
FIRST_STEP, SMALLEST_STEP = 0.125, 1e-3


def thermal_equilibrium(
    body: WarmBody, cold: Equilibrium | None = None, tolerance: float = 1e-8, iterations: int = 15
) -> Equilibrium:
    """A warm body's equilibrium: heated in steps from its ``cold`` equilibrium (default: no pressure), each by Newton.

    ``tolerance`` : unbalanced forces over those of one step's heating, or of the pressure where these are larger.

    Raises
    ------
    InputError : no equilibrium; the message gives the share of the heating.
    """
    cold = cold or Equilibrium(np.zeros((2, body.rings.n_nodes)), 0.0, (), ())
    displacement = cold.displacement
    reached, step = 0.0, FIRST_STEP
    steps, histories = list(cold.steps), list(cold.residuals)
    while reached < 1:
        aim = min(1.0, reached + step)
        guess, history = _newton(body.heated(aim), displacement, cold.pressure, tolerance, iterations)
        if not history[-1] <= tolerance:
            step /= 2
            if step < SMALLEST_STEP:
                raise InputError(
                    f"no balance of the warm body beyond {reached:.1%} of its heating", field="temperature"
                )
            continue
        displacement, reached, step = guess, aim, 2 * step
        steps.append(aim)
        histories.append(history)
    return Equilibrium(displacement, cold.pressure, tuple(steps), tuple(histories))


def _newton(
    body: Body, start: Array, pressure: float, tolerance: float, iterations: int
) -> tuple[Array, tuple[float, ...]]:
    """Displacement, and the unbalanced forces over the first ones, or over those of the pressure where larger.

    A body at its stress-free temperature has no first ones but the rounding that its cold equilibrium left.
    """
    from scipy.sparse.linalg import splu

    displacement, free = start, body.free
    residual = body.residual(displacement, pressure)[free]
    left = float(np.linalg.norm(residual))
    first = max(left, abs(pressure) * float(np.linalg.norm(body.load(displacement)[free])))
    history = [left / first if first else 0.0]
    while history[-1] > tolerance and len(history) <= iterations:
        step = np.zeros(2 * body.rings.n_nodes)
        step[free] = splu(body.stiffness(displacement, pressure)[free][:, free].tocsc()).solve(-residual)
        move, share = step.reshape(-1, 2).T, 1.0
        while True:
            residual = body.residual(displacement + share * move, pressure)[free]
            now = float(np.linalg.norm(residual)) / first
            if now < history[-1] or share < SMALLEST_STEP:
                break
            share /= 2
        displacement = displacement + share * move
        history.append(now)
    return displacement, tuple(history)
