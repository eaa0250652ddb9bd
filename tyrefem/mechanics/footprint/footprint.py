"""A pressed tyre: load, stiffness, shape and pressure of its footprint."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.cache import read_only
from tyrefem.mechanics.footprint.grid import ContactGrid
from tyrefem.mechanics.footprint.tyre_on_road import TyreOnRoad

Array = NDArray[np.float64]
#: The way out where large motion takes too long or has no balance.
QUICK_LOOK = 'mechanics.motion = "linear" is the quick look'
#: End of contact beyond the last point with hardly any pressure, in steps of the angle: the plain tyre with 80 to 180
#: harmonics has 0.1 beside 1000, a roller on an elastic half plane 0.04.
BEYOND = 0.1


@dataclass(frozen=True, eq=False)
class Footprint(Brief):
    """A tyre in contact with a road. Made by `footprint.contact.Pressing`.

    Parameters
    ----------
    pressing : the inflated tyre and its road. grid : angles and tread nodes of possible contact.
    deflection : penetration of the free tyre into the road, m.
    load : force along the road's normal, N, of the whole tyre.
    known_stiffness : `stiffness`, N/m.
    forces : (k,) contact force at each point (angle, node) of the grid, both sides of the wheel together, N.
    direction : (c, k) unit vectors into the road.
    displacement : (c, k) displacement of the tread, m.
    balanced : (n + 1, n_dofs) displacement amplitudes of the harmonics in large motion, m; None: all are linear in the
        forces.
    gaps : (k,) between tread and road, m.
    error : largest relative change of load, deflection, work and a fifth of the area against fewer harmonics; nan if
        they were not compared.
    rate : in large motion, change of ``balanced``, ``forces`` and ``load`` per metre of further deflection, to a few
        per cent; None: not computed.
    """

    pressing: TyreOnRoad
    grid: ContactGrid
    deflection: float
    load: float
    known_stiffness: float
    forces: Array
    direction: Array
    displacement: Array
    gaps: Array
    error: float = float("nan")
    balanced: Array | None = None
    rate: tuple[Array, Array, float] | None = None

    def _facts(self) -> Mapping[str, Any]:
        error = "" if np.isnan(self.error) else f", {100 * self.error:.2g} % from fewer"
        return {
            "load": f"{self.load:.6g} N",
            "deflection": f"{self.deflection * 1e3:.2f} mm",
            "stiffness": f"{self.stiffness / 1e3:.4g} N/mm",
            "length, width": f"{self.length * 1e3:.1f} mm, {self.width * 1e3:.1f} mm",
            "pressure": f"{self.mean_pressure / 1e3:.4g} kPa on average, {self.pressure.max() / 1e3:.4g} kPa at most",
            "harmonics": f"{self.harmonics}{error}",
            "motion": "linear about the inflated tyre" if self.motion == "linear" else "large",
            "unstable": self.unstable,
        }

    @property
    def motion(self) -> str:
        """``"large"``, or ``"linear"`` about the inflated tyre."""
        return "linear" if self.balanced is None else "large"

    @property
    def stiffness(self) -> float:
        """d load / d deflection at this deflection, N/m."""
        return self.known_stiffness

    @property
    def harmonics(self) -> int:
        """Highest harmonic."""
        return self.grid.harmonics

    @property
    def contact_harmonics(self) -> int:
        """Highest harmonic of the contact that has this length, width and area."""
        return self.harmonics

    @property
    def unstable(self) -> tuple[int, ...]:
        """Harmonics in which a motion has negative stiffness: the linearisation may not hold there."""
        return tuple(n for n, count in sorted(self.pressing.harmonics.negative_pivots.items()) if count)

    @property
    def unstable_place(self) -> str | None:
        """Region and place of such a motion in the lowest harmonic of `unstable`; None: all are stable."""
        for n, (r, z) in self.pressing.harmonics.buckling_place.items():
            elements = self.pressing.harmonics.elements
            distance = np.hypot(elements.points[0] - r, elements.points[1] - z).min(axis=1)
            element = int(distance.argmin())
            names = [name for name, members in (elements.mesh.subdomains or {}).items() if element in members]
            region = f"region '{names[0]}' at " if names else ""
            return f"harmonic {n}: {region}(r, z) = ({r * 1e3:.1f}, {z * 1e3:.1f}) mm"
        return None

    @property
    def work(self) -> float:
        """Elastic work of the contact, J: half the sum of force times displacement."""
        both = 2.0 if self.pressing.tread.half else 1.0
        return float(-0.5 * both * np.sum(self.direction * self.displacement * self.forces))

    def compared(self, before: Footprint) -> Footprint:
        """The footprint with its ``error``: the relative change against one with fewer harmonics."""

        def change(now: float, then: float) -> float:
            return abs(now - then) / max(abs(now), 1e-300) if now != then else 0.0

        changes = [change(getattr(self, name), getattr(before, name)) for name in ("load", "deflection", "work")]
        return replace(self, error=max(*changes, change(self.area, before.area) / 5))

    @functools.cached_property
    def pressure(self) -> Array:
        """(n_angles, m) contact pressure at angles >= 0 and tread nodes, Pa; linear in the angle."""
        share = np.repeat(self.grid.sides, len(self.grid.tread.nodes))
        return read_only(self.forces / (share * self.grid.areas)).reshape(self.grid.n_angles, -1)

    @property
    def pressure_integral(self) -> float:
        """Integral of the pressure map over the tread along the road's normal, N; equals the load."""
        both = 2.0 if self.pressing.tread.half else 1.0
        angles, r = self.grid.angles, self.grid.tread.places[0]
        lengths, _ = self.grid.tread.widths
        into = np.repeat(self.grid.sides, len(r)) * self._normal_components
        per_angle = (self.pressure.ravel() * into).reshape(len(angles), -1) @ (lengths * r)
        return float(both * per_angle.sum() * self.grid.step)

    @property
    def normal_forces(self) -> Array:
        """(n_angles, m) force on the road along its normal at one side of the wheel, N: both sides at angles > 0 have
        it."""
        shares = np.repeat(self.grid.sides, len(self.grid.tread.nodes))
        return np.asarray(self._normal_components * self.forces / shares).reshape(self.grid.n_angles, -1)

    @property
    def _normal_components(self) -> Array:
        """(k,) component of each unit force along the road's normal."""
        road, grid = self.pressing.road, self.grid
        normals = np.repeat(road.normal[:, None], grid.n_angles * len(grid.tread.nodes), axis=1)
        return np.asarray((grid.along(normals) * self.direction).sum(axis=0))

    @functools.cached_property
    def half_lengths(self) -> Array:
        """(m,) distance from the footprint's middle to its end at each tread node, m; ends lie between angles."""
        ends = np.array([_end(column) for column in self.pressure.T])
        return ends * self.grid.step * self.grid.tread.places[0]

    @property
    def length(self) -> float:
        """Greatest length, m."""
        return float(2 * self.half_lengths.max(initial=0.0))

    @property
    def width(self) -> float:
        """Axial extent of the contact, m: nodes that touch at any angle and those between them, with their tributary
        widths and the grooves between them."""
        _, axial = self.grid.tread.widths
        both = 2.0 if self.pressing.tread.half else 1.0
        touching = np.flatnonzero(self.pressure.max(axis=0) > 0)
        if not len(touching):
            return 0.0
        # The other half touches alike: the middle lies between them.
        first = 0 if self.pressing.tread.half else int(touching.min())
        reached = axial[first : touching.max() + 1].sum()
        z, grooves = self.grid.tread.places[1], self.grid.tread.grooves
        least = 0.0 if self.pressing.tread.half else z[first]
        within = (grooves[:, 0] > least - 1e-6) & (grooves[:, 1] < z[touching.max()] + 1e-6)
        return float(both * (reached + np.diff(grooves[within], axis=1).sum()))

    @property
    def area(self) -> float:
        """Contact area, m2, without grooves."""
        _, axial = self.grid.tread.widths
        both = 2.0 if self.pressing.tread.half else 1.0
        return float(both * 2 * (self.half_lengths * axial).sum())

    @property
    def mean_pressure(self) -> float:
        """Load over area, Pa; zero without contact."""
        return self.load / self.area if self.area > 0 else 0.0

    @functools.cached_property
    def load_harmonics(self) -> Array:
        """(harmonics + 1, c, m) load amplitudes on the tread, N per radian."""
        return self.grid.load_harmonics(-self.direction * self.forces)

    @functools.cached_property
    def amplitudes(self) -> Array:
        """(harmonics + 1, n_dofs) displacement amplitudes of the whole section, m; harmonics above those in large
        motion are linear in the forces."""
        if self.balanced is None:
            return self.grid.tread.fields(self.load_harmonics)
        linear = self.grid.tread.fields(self.load_harmonics, len(self.balanced) - 1)
        return np.concatenate([self.balanced, linear])

    @property
    def loaded_radius(self) -> float:
        """Distance of the wheel's centre from the road, m."""
        return self.pressing.reach - self.deflection

    @property
    def rolling_radius(self) -> float:
        """Distance rolled per radian, m, if the tread does not slip on average: mean of dx/dt over the contact.

        dx/dt = (r + u_r + du_t/dt) cos t + (du_r/dt - u_t) sin t, weighted with the contact force.
        """
        if not self.load:
            return self.pressing.reach
        dofs = self.grid.tread.dofs
        n = np.arange(self.harmonics + 1)[:, None, None]
        u_r, u_t = self.amplitudes[:, dofs[0]], self.amplitudes[:, dofs[1]]
        angle = self.grid.angles[None, :, None]
        cos, sin = np.cos(n * angle), np.sin(n * angle)
        along = self.grid.tread.places[0] + ((u_r[:, None] + n * u_t[:, None]) * cos).sum(axis=0)
        across = -((n * u_r[:, None] + u_t[:, None]) * sin).sum(axis=0)
        rate = along * np.cos(angle[0]) + across * np.sin(angle[0])
        return float(np.average(rate.ravel(), weights=self.forces))


def _end(pressure: Array) -> float:
    """End of a pressure distribution (n,) from the middle outwards, in steps of the angle.

    The end lies p_k / p_(k-1), at most 1, and `BEYOND` beyond the last point k with pressure: where the pressure falls
    to zero is hidden between two points. It moves without jumps as the next point comes into contact.
    """
    touching = np.flatnonzero(pressure > 0)
    if not len(touching):
        return 0.0
    last = int(touching[-1])
    if last == 0:
        return 0.5
    before = float(max(pressure[last - 1], pressure[last]))
    return last + float(pressure[last]) / before + BEYOND
