"""Error of averaging the road's film in time, from one tread point over its revolutions.

A tread point is a strip of rubber through the tread's thickness, with its boundary conditions of a revolution.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.boundaries import LawOf
from tyrefem.boundaries.road_film import half_space_film, propagation_depth
from tyrefem.conduction import Conduction, Film, Fixed, Material
from tyrefem.errors import InputError

#: Instantaneous film in contact over the mean film: so close to perfect contact that 0.08 % of the heat is missing.
PERFECT = 1000.0


@dataclass(frozen=True)
class TreadPoint:
    """A tread point and its boundary conditions of one revolution. SI units, degC.

    ``inner_temperature`` is that of the tread's inner side (None: insulated); ``heat_source`` (W/m3) heats the rubber.
    The default of ``air_film`` is the report's 5.44 + 1.674 v. Raises InputError for impossible values.

    >>> round(TreadPoint(speed=10.0, footprint_length=0.14).contact_time, 4)
    0.014
    """

    speed: float
    footprint_length: float
    circumference: float = 1.9
    thickness: float = 0.010
    conductivity: float = 0.25
    heat_capacity: float = 2e6
    inner_temperature: float | None = 80.0
    heat_source: float = 0.0
    air_film: float | None = None
    air_temperature: float = 25.0
    road_temperature: float = 25.0

    def __post_init__(self) -> None:
        for field in ("speed", "footprint_length", "circumference", "thickness", "conductivity", "heat_capacity"):
            if not (math.isfinite(getattr(self, field)) and getattr(self, field) > 0):
                raise InputError(f"must be finite and more than 0, not {getattr(self, field)!r}", field=field)
        if self.footprint_length >= self.circumference:
            raise InputError(f"must be less than the circumference, {self.circumference:g} m", field="footprint_length")
        if self.air_film is not None and not (math.isfinite(self.air_film) and self.air_film >= 0):
            raise InputError(f"must be finite and at least 0, not {self.air_film!r}", field="air_film")

    @property
    def revolution(self) -> float:
        """Time of one revolution, s."""
        return self.circumference / self.speed

    @property
    def contact_time(self) -> float:
        """Time on the road in one revolution, s."""
        return self.footprint_length / self.speed

    @property
    def fraction(self) -> float:
        """Fraction of the revolution on the road."""
        return self.footprint_length / self.circumference

    @property
    def mean_film(self) -> float:
        """H_c, the exact mean over a contact with a road of constant temperature, W/m2/K."""
        return half_space_film(self.speed, self.footprint_length, self.conductivity, self.heat_capacity)

    @property
    def air(self) -> float:
        """Film off the road, W/m2/K."""
        if self.air_film is not None:
            return self.air_film
        return float(LawOf("outside_air", "nasa")({}).film(self.speed))

    @property
    def phases(self) -> tuple[tuple[float, float, float], ...]:
        """Duration s, film W/m2/K and sink degC: on the road, then off it."""
        on = (self.contact_time, PERFECT * self.mean_film, self.road_temperature)
        return on, (self.revolution - self.contact_time, self.air, self.air_temperature)

    @functools.cached_property
    def mesh(self) -> Any:
        """A strip of one element's width, x from the inner side to the surface, fine at the depth of a contact."""
        import skfem

        reach = propagation_depth(self.contact_time, self.conductivity, self.heat_capacity)
        sizes = [min(reach / 40, self.thickness / 60)]
        while sum(sizes) < self.thickness:
            sizes.append(min(1.12 * sizes[-1], self.thickness / 25))
        depths = np.concatenate([[0.0], np.cumsum(sizes)])
        x = self.thickness * (1 - depths[::-1] / depths[-1])
        mesh = skfem.MeshQuad.init_tensor(x, np.array([0.0, 40 * sizes[0]]))
        last = self.thickness * (1 - 1e-9)
        sides = {"inner": lambda p: p[0] < 1e-9 * self.thickness, "surface": lambda p: p[0] > last}
        return mesh.with_subdomains({"tread": lambda p: p[0] >= 0}).with_boundaries(sides)

    def conduction(self, films: Film | Sequence[Film]) -> Conduction:
        """Planar conduction problem of the strip with films on its surface."""
        sides: dict[str, Any] = {"surface": films}
        if self.inner_temperature is not None:
            sides["inner"] = Fixed(self.inner_temperature)
        rubber = {"tread": Material(self.conductivity, self.heat_capacity)}
        return Conduction(self.mesh, rubber, sides, {"tread": self.heat_source}, axisymmetric=False)

    def averaged(self, film: float | None = None) -> Conduction:
        """The strip under f H_c + (1 - f) h_air; ``film`` replaces the exact mean H_c."""
        road = self.mean_film if film is None else film
        return self.conduction(
            [
                Film(self.fraction * road, self.road_temperature),
                Film((1 - self.fraction) * self.air, self.air_temperature),
            ]
        )


Array = NDArray[Any]


@dataclass(frozen=True, eq=False)
class PeriodicState:
    """The periodic state of a revolution: nodes x (m from the inner side), temperatures degC, W/m2 to the road."""

    x: Array
    before_contact: Array
    after_contact: Array
    mean: Array
    heat_to_road: float


def periodic_state(point: TreadPoint) -> PeriodicState:
    """Periodic temperatures of one revolution, by finite elements in depth and exactly in time.

    Each phase is linear, C dT/dt = f - A T, so with A v = l C v it maps T to P T + d. The state of period P2 P1
    is one linear solve, without a simulation of revolutions.
    """
    ops = point.conduction(Film(0.0, 0.0)).operators
    x, node = np.unique(np.round(ops.points[0] / point.thickness, 12), return_inverse=True)
    onto = np.zeros((ops.size, x.size))
    onto[np.arange(ops.size), node] = 1.0  # Nodes at equal depth have one temperature.
    width = float(np.ptp(ops.points[1]))
    along, across = ops.conduction("tread", None)
    C = point.heat_capacity * (onto.T @ ops.matrix(ops.mass("tread")) @ onto) / width
    K = point.conductivity * (onto.T @ ops.matrix(along + across) @ onto) / width
    load = C.sum(axis=1) / point.heat_capacity * point.heat_source
    held = point.inner_temperature is not None
    inside = float(point.inner_temperature or 0.0)
    free = slice(1 if held else 0, None)
    load = (load - K[:, 0] * inside * held)[free]
    C, K = C[free, free], K[free, free]
    on, off = (_PhaseMap.of(C, K, load, *phase) for phase in point.phases)
    before = np.linalg.solve(np.eye(len(C)) - off.map @ on.map, off.map @ on.shift + off.shift)
    after = on.map @ before + on.shift
    mean_on = on.mean_map @ before + on.mean_shift
    mean = point.fraction * mean_on + (1 - point.fraction) * (off.mean_map @ after + off.mean_shift)
    held_side = np.full(int(held), inside)
    before, after, mean = (np.concatenate([held_side, T]) for T in (before, after, mean))
    heat = point.fraction * point.phases[0][1] * (float(mean_on[-1]) - point.road_temperature)
    return PeriodicState(x * point.thickness, before, after, mean, heat)


@dataclass(frozen=True, eq=False)
class _PhaseMap:
    """T -> map T + shift at the phase's end, and T -> mean_map T + mean_shift as its time average."""

    map: Array
    shift: Array
    mean_map: Array
    mean_shift: Array

    @classmethod
    def of(cls, C: Array, K: Array, load: Array, duration: float, film: float, sink: float) -> _PhaseMap:
        from scipy.linalg import eigh

        A, f = K.copy(), load.copy()
        A[-1, -1] += film
        f[-1] += film * sink
        rate, V = eigh(A, C)
        z = np.maximum(rate, 0.0) * duration
        some = np.maximum(z, 1e-4)
        # Means of exp(-z s) over 0..1, and of that mean growing from 0; series where they would cancel.
        once = np.where(z < 1e-4, 1 - z / 2 + z * z / 6, -np.expm1(-some) / some)
        twice = np.where(z < 1e-4, 0.5 - z / 6, (some + np.expm1(-some)) / some**2)
        into, g = V.T @ C, duration * (V.T @ f)
        return cls((V * np.exp(-z)) @ into, V @ (once * g), (V * once) @ into, V @ (twice * g))


@dataclass(frozen=True)
class AveragingError:
    """The averaged boundary compared with resolved contacts, in the periodic state; degC, W/m2, m.

    ``mean_temperature`` and ``averaged_temperature`` are at ``depths`` below the surface; ``swing`` is the drop of the
    surface temperature in one contact, K.
    """

    point: TreadPoint
    mean_surface: float
    averaged_surface: float
    swing: float
    heat_to_road: float
    averaged_heat_to_road: float
    depths: tuple[float, ...]
    mean_temperature: tuple[float, ...]
    averaged_temperature: tuple[float, ...]

    @property
    def difference(self) -> tuple[float, ...]:
        """Averaged minus resolved at ``depths``, K."""
        return tuple(a - m for a, m in zip(self.averaged_temperature, self.mean_temperature, strict=True))

    @property
    def surface_difference(self) -> float:
        """Averaged minus resolved at the surface, K."""
        return self.averaged_surface - self.mean_surface


def averaging_error(
    point: TreadPoint, depths: Sequence[float] = (0.0, 0.5e-3, 1e-3, 2e-3, 5e-3), film: float | None = None
) -> AveragingError:
    """Compare the time-averaged road film with resolved contacts.

    ``depths`` in m below the surface; ``film`` is the averaged H_c, by default the exact half-space mean.
    Raises InputError for a depth outside the tread.

    >>> error = averaging_error(TreadPoint(speed=50 / 3.6, footprint_length=0.14))
    >>> 0 < error.surface_difference < 1 < error.swing
    True
    """
    for depth in depths:
        if not 0 <= depth <= point.thickness:
            raise InputError(f"must be from 0 to {point.thickness:g} m, not {depth!r}", field="depths")
    state = periodic_state(point)
    field = point.averaged(film).steady(state.mean.mean())
    averaged = np.asarray(field.at([(max(x, 0.0), 0.0) for x in (point.thickness - np.asarray(depths)).tolist()]))
    surface = float(np.asarray(field.at([(point.thickness, 0.0)]))[0])
    road = point.mean_film if film is None else film
    return AveragingError(
        point=point,
        mean_surface=float(state.mean[-1]),
        averaged_surface=surface,
        swing=float(state.before_contact[-1] - state.after_contact[-1]),
        heat_to_road=state.heat_to_road,
        averaged_heat_to_road=point.fraction * road * (surface - point.road_temperature),
        depths=tuple(depths),
        mean_temperature=tuple(np.interp(point.thickness - np.asarray(depths), state.x, state.mean).tolist()),
        averaged_temperature=tuple(averaged.tolist()),
    )


def averaging_sweep(point: TreadPoint, speeds: Iterable[float], lengths: Iterable[float]) -> list[AveragingError]:
    """`averaging_error` at every speed (m/s) of every footprint length (m), with the lengths in the outer loop."""
    speeds = list(speeds)
    return [
        averaging_error(replace(point, speed=speed, footprint_length=length)) for length in lengths for speed in speeds
    ]
