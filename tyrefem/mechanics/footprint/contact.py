"""The footprint: frictionless contact of the tread with a road, at a given deflection or load."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.estimates import work as estimate
from tyrefem.mechanics.footprint.complementarity import contact_forces
from tyrefem.mechanics.footprint.footprint import Footprint
from tyrefem.mechanics.footprint.grid import ContactGrid
from tyrefem.mechanics.footprint.road import Road
from tyrefem.mechanics.footprint.tyre_on_road import FLAT, TyreOnRoad
from tyrefem.mechanics.solid.body import Prestressed

Array = NDArray[np.float64]
#: Numbers of harmonics, tried in turn until the error is below the tolerance.
LADDER = (24, 36, 54, 80, 120, 180, 270)


@dataclass(frozen=True, eq=False)
class Pressing(TyreOnRoad):
    """A tyre and the road on which it is pressed; compliances are kept for further loads and numbers of harmonics."""

    _grids: dict[int, ContactGrid] = field(default_factory=dict, init=False, repr=False)

    def grid(self, harmonics: int, deflection: float) -> ContactGrid:
        """Grid of the angles that may touch: the part of the free tyre below the road and a third more.

        Raises
        ------
        InputError : an invalid number of harmonics, or too many for the memory.
        """
        share = 1.35 * self.road.half_angle(self.reach, deflection) / np.pi
        self.check_harmonics(harmonics, share)
        needed = min(math.ceil(share * harmonics) + 3, harmonics)
        if harmonics not in self._grids or self._grids[harmonics].n_angles < needed:
            self._grids[harmonics] = ContactGrid(self.tread, harmonics, min(needed + 2, harmonics))
        return self._grids[harmonics]

    def check_harmonics(self, harmonics: int, share: float = 0.0) -> None:
        """Raise `InputError` for an invalid number of harmonics, or one that needs more memory than is free; ``share``
        of the angles may touch."""
        if not (isinstance(harmonics, int | np.integer) and harmonics >= 1):
            raise InputError(f"must be a whole number, 1 or more, not {harmonics!r}", field="harmonics")
        nodes, components = len(self.tread.nodes), len(self.tread.components)

        def needed(count: float) -> float:
            return estimate.contact(nodes, min(count, 10**12), share * min(count, 10**12) + 3, components)

        def fits(free: float) -> str:
            most = min(harmonics, 10**12)
            while most > 1 and needed(most) > free:
                most //= 2
            return f"{most:,} would fit"

        try:
            estimate.check_memory(
                needed(harmonics), f"{min(harmonics, 10**12):,} harmonics of {nodes} tread nodes", fits
            )
        except InputError as error:
            raise error.within(field="harmonics") from None

    def check(self, deflection: float) -> None:
        """Raise `InputError` for a deflection that is negative or not less than `bottoming`."""
        if not 0 <= deflection < self.bottoming:
            raise InputError(
                f"a deflection of {deflection * 1e3:.4g} mm is impossible; it must be at least 0 and less than "
                f"{self.bottoming * 1e3:.4g} mm, where {self.end}",
                field="deflection",
            )

    def at_deflection(self, deflection: float, harmonics: int, start: Footprint | None = None) -> Footprint:
        """The footprint at a deflection, m, with harmonics up to a number.

        On a flat road the gap is linear in the displacement, (r + u_r) cos t - u_t sin t, so one solution is enough. On
        a drum the contact direction is updated until forces change by less than 1e-6. ``start``: a similar footprint
        whose contacts are the first guess.

        Raises
        ------
        InputError : the deflection is negative, would press the crown on the rim, or the tyre on the drum's axis.
        """
        self.check(deflection)
        grid = self.grid(harmonics, deflection)
        distance = self.reach - deflection
        size = len(grid.areas)
        displacement, closed = np.zeros((len(self.tread.components), size)), np.zeros(size, dtype=bool)
        if start is not None and start.grid is grid:
            closed = start.forces > 0
        forces, direction = np.zeros(size), np.zeros_like(displacement)
        for _ in range(30):
            gaps, normals = self.gaps(grid, displacement, distance)
            towards_road = grid.along(normals)
            compliance = np.einsum("ak,akbl,bl->kl", towards_road, grid.blocks, towards_road, optimize=True)
            before, free = forces, gaps + np.einsum("ck,ck->k", towards_road, displacement)
            forces, closed = contact_forces(compliance, free, closed if closed.any() else None)
            direction = towards_road
            displacement = -np.einsum("akbl,bl->ak", grid.blocks, towards_road * forces, optimize=True)
            if math.isinf(self.road.drum_diameter) or np.abs(forces - before).max() <= 1e-6 * forces.max(initial=0.0):
                break
        normal_components = self.road.normal @ normals
        index = np.flatnonzero(closed)
        stiffness = 0.0
        if len(index):
            stiffness = float(
                normal_components[index] @ np.linalg.solve(compliance[np.ix_(index, index)], normal_components[index])
            )
        both = 2.0 if self.tread.half else 1.0
        left = free + compliance @ forces
        load = float(both * normal_components @ forces)
        return Footprint(self, grid, deflection, load, both * stiffness, forces, direction, displacement, left)

    def gaps(self, grid: ContactGrid, displacement: Array, distance: float) -> tuple[Array, Array]:
        """Gaps and normals at the centres of the hats; the free tyre's gap is averaged over the hat by two points."""
        offset, free = grid.step / math.sqrt(6), np.zeros_like(displacement)
        before_centre, centre, after_centre = (
            self.road.gaps(grid.places(free, shift), distance)[0] for shift in (offset, 0.0, -offset)
        )
        gaps, normals = self.road.gaps(grid.places(displacement, 0.0), distance)
        return gaps + (before_centre + after_centre) / 2 - centre, normals

    def at_load(self, load: float, harmonics: int, start: Footprint | None = None) -> Footprint:
        """The footprint under a load, N, on both sides of the tyre: Newton on the deflection.

        Raises
        ------
        InputError : the load is not positive, too little to be resolved, or more than the tyre can carry up to
            `bottoming`.
        """
        if not load > 0:
            raise InputError(f"the load must be positive, not {load:g} N", field="load")
        low, high = 0.0, self.bottoming
        deflection = start.deflection if start is not None else 0.02 * high
        footprint = self.at_deflection(deflection, harmonics)
        for _ in range(40):
            if abs(footprint.load - load) <= 1e-8 * load:
                return footprint
            low, high = (deflection, high) if footprint.load < load else (low, deflection)
            step = (load - footprint.load) / footprint.stiffness if footprint.stiffness else high
            deflection = deflection + step
            if not low < deflection < high:
                deflection = (low + high) / 2
            if high - low < 1e-9 * self.bottoming and high == self.bottoming:
                break
            footprint = self.at_deflection(deflection, harmonics, footprint)
        most = self.at_deflection(self.bottoming * (1 - 1e-9), harmonics).load
        if load < most:
            raise InputError(f"the contact does not settle under {load:.5g} N with {harmonics} harmonics", field="load")
        raise InputError(
            f"the tyre cannot carry {load:.5g} N: {self.end} at {most:.5g} N ({self.bottoming * 1e3:.4g} mm)",
            field="load",
        )

    def solve(
        self, *, deflection: float | None = None, load: float | None = None, tolerance: float = 0.01
    ) -> Footprint:
        """The footprint with the number of harmonics that the tolerance needs.

        The number grows until load, deflection and elastic work change by less than ``tolerance``, and the contact area
        by less than five times that. The last change is the ``error``.

        Raises
        ------
        InputError : both or neither of deflection and load; errors of `at_deflection` and `at_load`; no convergence; a
            deflection at which no harmonics find a contact.
        """
        if (deflection is None) == (load is None):
            raise InputError("give exactly one of 'deflection' and 'load'")
        before: Footprint | None = None
        for count in LADDER:
            if deflection is not None:
                footprint = self.at_deflection(deflection, count)
            else:
                assert load is not None
                footprint = self.at_load(load, count, before)
            if before is not None:
                footprint = footprint.compared(before)
                # Too few harmonics average the whole contact of a slight deflection away: they agree on nothing.
                if footprint.error <= tolerance and (footprint.load > 0 or deflection == 0):
                    return footprint
            before = footprint
        assert before is not None
        if not before.load > 0:
            raise InputError(
                f"{before.deflection * 1e3:.4g} mm is too little: {LADDER[-1]} harmonics find no contact",
                field="deflection",
            )
        given = f"{before.deflection * 1e3:.4g} mm" if load is None else f"{load:.4g} N"
        raise InputError(
            f"{given}: {LADDER[-1]} harmonics leave an error of {before.error:.2g}, more than the tolerance "
            f"{tolerance:g}; a slight contact needs more harmonics: state a larger one, or 0",
            field="deflection" if load is None else "load",
        )


def footprint(state: Prestressed, road: Road = FLAT, **wanted: Any) -> Footprint:
    """The footprint of a tyre: `Pressing.solve` in one call.

    >>> from tyrefem.mechanics.footprint.example_tyre import PlainTyre
    >>> result = footprint(PlainTyre().state(along=10), load=2000.0, tolerance=0.05)
    >>> round(result.load), result.harmonics
    (2000, 54)
    """
    return Pressing(state, road).solve(**wanted)
