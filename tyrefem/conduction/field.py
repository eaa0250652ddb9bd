"""One temperature field of a conduction problem, and the history of a transient run.

The history holds temperatures and heat at the requested times.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyrefem.brief import Brief
from tyrefem.cache import read_only
from tyrefem.conduction.budget import Budget
from tyrefem.conduction.conditions import Material
from tyrefem.conduction.operators import Operators
from tyrefem.conduction.points import located
from tyrefem.errors import InputError, nearest

Array = NDArray[Any]


@dataclass(frozen=True, eq=False)
class Field(Brief):
    """Temperatures of the body and its reservoirs at one time; its arrays are read-only.

    Attributes
    ----------
    values : (n,) degC at the unknowns; points : (2, n) their positions; mesh : the scikit-fem mesh.
    reservoirs : name -> degC.
    generated : source subdomain -> W; lost : boundary -> W, positive outwards.
    time : s, or None for a steady field.
    """

    operators: Operators
    materials: Mapping[str, Material]
    values: Array
    reservoirs: Mapping[str, float]
    generated: Mapping[str, float]
    lost: Mapping[str, float]
    time: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", read_only(self.values))

    def _facts(self) -> Mapping[str, Any]:
        return {
            "time": "steady" if self.time is None else f"{self.time:g} s",
            "temperatures": f"{self.values.min():.4g} to {self.values.max():.4g} degC at {len(self.values)} unknowns",
            **{name: f"{T:.4g} degC" for name, T in self.reservoirs.items()},
            **{f"generated in {name}": f"{W:.4g} W" for name, W in self.generated.items()},
            **{f"lost at {name}": f"{W:.4g} W" for name, W in self.lost.items()},
        }

    @property
    def mesh(self) -> Any:
        """The scikit-fem mesh."""
        return self.operators.mesh

    @property
    def points(self) -> Array:
        """Positions of the unknowns, (2, n)."""
        return self.operators.points

    def at(self, points: ArrayLike) -> Array:
        """Temperatures at points (n_points, 2), degC; InputError for a point outside the mesh."""
        return located(self.operators, points).value() @ self.values

    def flux_at(self, points: ArrayLike) -> Array:
        """Heat flux -k grad T at points, (n_points, 2), W/m2, evaluated in the element around each point."""
        place = located(self.operators, points)
        slope = np.stack([g @ self.values for g in place.gradient()])
        T = place.value() @ self.values
        x = np.asarray(self.operators.basis.mapping.F(place.local[:, :, None], tind=place.elements))[:, :, 0]
        flux = np.empty((T.size, 2))
        for name, material in self.materials.items():
            in_region = np.flatnonzero(np.isin(place.elements, self.operators.elements(name)))
            if not in_region.size:
                continue
            k = material.conductivity(T[in_region]) if callable(material.conductivity) else material.conductivity
            k1, k2 = k if isinstance(k, (tuple, list)) else (k, k)
            d = (
                np.array([[1.0], [0.0]])
                if material.direction is None
                else np.asarray(material.direction(x[:, in_region]))
            )
            along = d[0] * slope[0, in_region] + d[1] * slope[1, in_region]
            across = -d[1] * slope[0, in_region] + d[0] * slope[1, in_region]
            flux[in_region, 0] = -(d[0] * k1 * along - d[1] * k2 * across)
            flux[in_region, 1] = -(d[1] * k1 * along + d[0] * k2 * across)
        return flux

    def flux_through(self, boundary: str) -> float:
        """Heat leaving through a boundary, W (full ring, or per metre of depth).

        It is the flux of the discrete balance: the integral of the condition, or the reaction of `Fixed`. Therefore
        generated = stored + lost holds up to rounding. An insulated boundary gives 0.
        """
        known = self.operators.mesh.boundaries or {}
        if boundary not in known:
            raise InputError(f"unknown boundary {boundary!r}{nearest(boundary, known)}", field="boundary")
        return float(self.lost.get(boundary, 0.0))


@dataclass(frozen=True)
class Steps:
    """Effort of a run: accepted and rejected steps, factorisations, linear solves."""

    accepted: int
    rejected: int
    factorisations: int
    solves: int


@dataclass(frozen=True)
class Peak:
    """A highest temperature, degC, with its point (2,) in m and its time in s."""

    temperature: float
    point: tuple[float, float]
    time: float


@dataclass(frozen=True, eq=False)
class History(Brief):
    """A transient solution; its arrays are read-only.

    Attributes
    ----------
    times : (n_times,) s; values : (n_times, n) degC at the unknowns.
    reservoirs : name -> (n_times,) degC.
    budget : the heat budget at `times`.
    maximum : hottest point over all accepted steps and requested times; region_maximum : the same by region.
    steps : the effort; interrupted : True if the run was stopped before its last time.
    states : (n_times, k) the problem's `AddedStates`.
    """

    operators: Operators
    materials: Mapping[str, Material]
    times: Array
    values: Array
    reservoirs: Mapping[str, Array]
    budget: Budget
    maximum: Peak
    region_maximum: Mapping[str, Peak]
    steps: Steps
    interrupted: bool = False
    states: Array = field(default_factory=lambda: np.zeros((0, 0)))

    def __post_init__(self) -> None:
        for name in ("times", "values", "states"):
            object.__setattr__(self, name, read_only(getattr(self, name)))
        object.__setattr__(self, "reservoirs", {name: read_only(T) for name, T in self.reservoirs.items()})

    def _facts(self) -> Mapping[str, Any]:
        peak, end = self.maximum, self.values[-1]
        return {
            "times": f"{len(self.times)} from {self.times[0]:g} to {self.times[-1]:g} s"
            + (", interrupted" if self.interrupted else ""),
            "at the end": f"{end.min():.4g} to {end.max():.4g} degC at {len(end)} unknowns",
            "hottest": f"{peak.temperature:.4g} degC at ({peak.point[0]:.4g}, {peak.point[1]:.4g}) m, {peak.time:g} s",
            "regions": self.region_maximum,
            "reservoirs": self.reservoirs,
            "imbalance": self.budget.imbalance,
            "steps": f"{self.steps.accepted} accepted, {self.steps.rejected} rejected",
        }

    @property
    def mesh(self) -> Any:
        """The scikit-fem mesh."""
        return self.operators.mesh

    @property
    def points(self) -> Array:
        """Positions of the unknowns, (2, n)."""
        return self.operators.points

    def at(self, points: ArrayLike) -> Array:
        """Temperatures at points (n_points, 2): (n_times, n_points), degC."""
        return (located(self.operators, points).value() @ self.values.T).T

    def field(self, i: int) -> Field:
        """The field at `times[i]`."""
        return Field(
            self.operators,
            self.materials,
            self.values[i],
            {name: float(T[i]) for name, T in self.reservoirs.items()},
            {name: float(W[i]) for name, W in self.budget.generated_power.items()},
            {name: float(W[i]) for name, W in self.budget.lost_power.items()},
            float(self.times[i]),
        )
