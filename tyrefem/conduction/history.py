"""Temperatures and heat of a transient run at the requested times."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from numpy.typing import ArrayLike, NDArray

from tyrefem.brief import Brief
from tyrefem.conduction.budget import Budget
from tyrefem.conduction.conditions import Material
from tyrefem.conduction.field import Field
from tyrefem.conduction.operators import Operators
from tyrefem.conduction.points import located

Array = NDArray[Any]


@dataclass(frozen=True)
class Steps:
    """What a run cost: accepted and rejected steps, factorisations, linear solves."""

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


@dataclass(frozen=True)
class History(Brief):
    """A transient solution.

    Attributes
    ----------
    times : (n_times,) s; values : (n_times, n) degC at the unknowns.
    reservoirs : name -> (n_times,) degC.
    budget : the heat budget at `times`.
    maximum : hottest point over all accepted steps and requested times; region_maximum : the same by region.
    steps : what it cost; interrupted : True if the run was stopped before its last time.
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
        """Places of the unknowns, (2, n)."""
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
