"""Friction work of every ring of a rolling tread, per metre that the wheel travels."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.mechanics.rolling.contact_patch import contact_angles

if TYPE_CHECKING:
    from tyrefem.mechanics.rolling.roll import RolledStudy

Array = NDArray[np.float64]
#: Numbers that change from state to state: of each ring, and of the whole tread.
CHANGING = ("work", "share", "friction", "sliding", "rolling", "travel")


@dataclass(frozen=True, eq=False)
class FrictionRings(Brief):
    """Rings of the whole tread.

    Parameters
    ----------
    places : (2, m) undeformed r, z of the rings, m, from small to large z. widths : (m,) on the outline, m.
    work : (m,) friction work over the distance travelled, J/m = N; its sum times the speed is the friction power.
    share : (m,) of a revolution in which a point of the ring is in contact.
    friction : horizontal force over load. sliding, rolling : nominal speeds of the tread over the road, and through the
        footprint, over that of the wheel's centre. travel : m the wheel travels per radian of its turn.

    >>> rings = FrictionRings(np.array([[0.3, 0.3], [-0.01, 0.01]]), np.full(2, 0.02), np.array([30.0, -10.0]),
    ...     np.full(2, 0.1), 0.5, 0.02, 1.0, 0.3)
    >>> rings.density.round(1).tolist(), float(round(rings.density @ rings.areas, 9)) == rings.total
    ([530.5, 0.0], True)
    """

    places: Array
    widths: Array
    work: Array
    share: Array
    friction: float
    sliding: float
    rolling: float
    travel: float

    def _facts(self) -> Mapping[str, Any]:
        return {"rings": len(self.work), "friction work": f"{self.total:.4g} N"}

    @property
    def total(self) -> float:
        """Friction work of all rings per metre, N; at least 0."""
        return max(float(self.work.sum()), 0.0)

    @property
    def areas(self) -> Array:
        """(m,) of the rings, m2."""
        return np.asarray(2 * np.pi * self.places[0] * self.widths)

    @functools.cached_property
    def density(self) -> Array:
        """(m,) work per metre and area, N/m2. A ring whose work is negative by rounding has none; the sum is kept."""
        positive = np.maximum(self.work, 0.0)
        whole = positive.sum()
        return positive / self.areas * (self.total / whole if whole > 0 else 0.0)

    def interpolated(self, others: list[tuple[FrictionRings, float]]) -> FrictionRings:
        """Numbers x + sum_i w_i (x_i - x) of rings at the same places, with weights w_i."""

        def mean(name: str) -> Any:
            value = getattr(self, name)
            return value + sum(weight * (getattr(rings, name) - value) for rings, weight in others)

        return replace(self, **{name: mean(name) for name in CHANGING})

    @classmethod
    def of(cls, rolled: RolledStudy) -> FrictionRings:
        """The rings of a rolling tyre."""
        state, tyre = rolled.state, rolled.wheel.pressed.tyre
        influence = state.grid.influence
        nodes, _ = influence.source
        r, z = tyre.body.rings.nodes[:, influence.tread.nodes[nodes]]
        if tyre.half:
            z = np.where(influence.places[1] < 0, -z, z)
        f_x, f_y, f_z = state.force
        angle, slip = state.motion.slip_angle, rolled.slip
        return cls(
            np.stack([r, z]),
            influence.lengths,
            state.power_by_ring / state.motion.speed,
            contact_angles(state.pressure) * state.grid.step / (2 * np.pi),
            float(np.hypot(f_x, f_y) / f_z),
            float(np.hypot(slip * np.cos(angle), np.sin(angle))),
            float((1 + slip) * np.cos(angle)),
            state.travel,
        )
