"""An inflated body pressed inside a rigid cylinder: all meridians deflect alike ("barrel", Clark & Dodge 1980)."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.mechanics.solid.cylinder import CylinderChoice, equilibrium_inside
from tyrefem.mechanics.solid.elements import Indices
from tyrefem.mechanics.solid.inflation import Inflation
from tyrefem.mechanics.solid.newton import StuckError

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Flattened:
    """An inflated body in equilibrium inside a frictionless cylinder of radius R - D. Made by `flatten`.

    Parameters
    ----------
    tyre : the inflated body; R is the largest radius of its boundary ``touching``.
    deflection : D, m.
    displacement : (2, n_nodes) from the undeformed configuration, m.
    forces : (n_contact_nodes,) inward force of the cylinder on the nodes of ``touching``, N per radian.
    steps : deflections of earlier load steps, m; residuals : unbalanced force at every iteration of every step.
    """

    tyre: Inflation
    deflection: float
    displacement: Array
    forces: Array
    touching: str = "road"
    steps: tuple[float, ...] = ()
    residuals: tuple[tuple[float, ...], ...] = field(default=(), repr=False)

    @functools.cached_property
    def nodes(self) -> Indices:
        """Nodes of the contact boundary."""
        return self.tyre.body.rings.boundary_nodes(self.touching)

    @property
    def radius(self) -> float:
        """Radius of the cylinder, m."""
        return reach(self.tyre, self.touching) - self.deflection

    @property
    def places(self) -> Array:
        """(2, n_nodes) deformed positions, m."""
        return self.tyre.body.rings.nodes + self.displacement

    @property
    def gaps(self) -> Array:
        """(n_contact_nodes,) distance to the cylinder, m."""
        return np.asarray(self.radius - self.places[0, self.nodes])

    @property
    def width(self) -> float:
        """Axial width of the contact, m; 0 without contact."""
        touched = self.places[1, self.nodes[self.forces > 0]]
        if not touched.size:
            return 0.0
        return float(2 * touched.max() if self.tyre.half else np.ptp(touched))

    @property
    def force(self) -> float:
        """Force of the cylinder on the whole circumference of both halves, N: dW/dD of the potential W."""
        return float(self._full_circumference * self.forces.sum())

    @functools.cached_property
    def stiffness(self) -> float:
        """dF/dD, N/m, with the same nodes in contact."""
        from scipy.sparse.linalg import splu

        body = self.tyre.body
        held = 2 * self.nodes[self.forces > 0]
        if not held.size:
            return 0.0
        matrix = body.stiffness(self.displacement, self.tyre.pressure)
        free = np.setdiff1d(body.free, held)
        change = np.zeros(matrix.shape[0])
        change[held] = -1.0
        change[free] = -splu(matrix[free][:, free].tocsc()).solve((matrix @ change)[free])
        return float(-self._full_circumference * (matrix @ change)[held].sum())

    @property
    def _full_circumference(self) -> float:
        return 2 * math.pi * (2 if self.tyre.half else 1)

    @functools.cached_property
    def strain(self) -> Array:
        """(6, n_elements, n_points) Green's strain from the inflated state, (f'f - 1)/2 with engineering shears."""
        before, after = self.tyre.deformation, self.tyre.body.deformation(self.displacement)
        first, last = (np.moveaxis(gradient, (0, 1), (-2, -1)) for gradient in (before, after))
        f = last @ np.linalg.inv(first)
        e = (np.swapaxes(f, -1, -2) @ f - np.eye(3)) / 2
        components = [e[..., 0, 0], e[..., 1, 1], e[..., 2, 2], 2 * e[..., 0, 1], 2 * e[..., 0, 2], 2 * e[..., 1, 2]]
        return np.stack(components)


def reach(tyre: Inflation, touching: str = "road") -> float:
    """Largest radius of a boundary of the inflated body, m."""
    return float(tyre.places[0, tyre.body.rings.boundary_nodes(touching)].max())


def bottoming(tyre: Inflation) -> float:
    """Deflection at which the crown's inner surface would meet the rim: its top, or the highest fixed point, m.

    If the body has neither: R.
    """
    rings, body = tyre.body.rings, tyre.body
    stops = [rings.nodes[0, rings.boundary_nodes(name)].max() for name, axes in body.held.items() if "r" in axes]
    stops += [tyre.state.rim_top] if tyre.state.rim_top else []
    if not stops:
        return reach(tyre)
    return float(tyre.places[0, body.wall.nodes].max() - max(stops))


def flatten(
    tyre: Inflation,
    deflection: float,
    start: Flattened | None = None,
    choice: CylinderChoice | None = None,
    touching: str = "road",
    near: Flattened | None = None,
) -> Flattened:
    """Press an inflated body inside a rigid frictionless cylinder; the gas pressure stays constant.

    u_r <= R - D - r at every node of the boundary, inward force >= 0, never both. This bounds single degrees of
    freedom: Newton with an active set (primal-dual; Hintermuller, Ito & Kunisch 2003) fulfils it exactly, without a
    penalty.

    Parameters
    ----------
    deflection : D, m, from the inflated free tyre. start : the same tyre at a smaller deflection. near : the same body
        at another pressure and a smaller deflection, to start from if it is in equilibrium at this pressure, too.

    Raises
    ------
    InputError : the deflection is negative, brings the crown to the rim, or has no equilibrium.

    >>> from tyrefem import study
    >>> from tyrefem.geometry.meshing import build
    >>> from tyrefem.mechanics.solid.inflation import inflate
    >>> tyre = study("nasa-22x5.5-8pr")
    >>> flat = flatten(inflate(tyre, 5e5, build(tyre.section, size=12e-3, through=1)), 0.01)
    >>> bool((flat.forces * flat.gaps < 1e-9 * flat.force).all()), flat.force > 0
    (True, True)
    """
    choice = choice or CylinderChoice()
    most = bottoming(tyre)
    if not 0 <= deflection < most:
        raise InputError(
            f"a deflection of {deflection * 1e3:.4g} mm is impossible; it must be at least 0 and less than "
            f"{most * 1e3:.4g} mm, where the crown meets the rim",
            field="deflection",
        )
    nodes = tyre.body.rings.boundary_nodes(touching)
    now = start or Flattened(tyre, 0.0, tyre.displacement, np.zeros(len(nodes)), touching)
    free = reach(tyre, touching)

    def inside(starts: Sequence[Array], forces: Array, radius: float) -> tuple[Array, Array, tuple[float, ...]]:
        """The equilibrium from the first displacement that leads to it."""
        for displacement in starts[:-1]:
            with suppress(StuckError):
                return equilibrium_inside(tyre.body, tyre.pressure, nodes, displacement, forces, radius, choice)
        return equilibrium_inside(tyre.body, tyre.pressure, nodes, starts[-1], forces, radius, choice)

    if near is not None and 0 < free - near.radius <= deflection:
        with suppress(StuckError):
            displacement, forces, history = inside([near.displacement], near.forces, near.radius)
            now = Flattened(tyre, free - near.radius, displacement, forces, touching, residuals=(history,))
    before = now
    step = choice.first_step * free
    steps, residuals = list(now.steps), list(now.residuals)
    while now.deflection < deflection:
        aim = min(deflection, now.deflection + step)
        try:
            displacement, forces, history = inside(_starts(before, now, aim), now.forces, free - aim)
        except StuckError as stuck:
            step = (aim - now.deflection) / 2
            if step < choice.smallest_step * free:
                raise InputError(
                    f"a deflection of {deflection * 1e3:.4g} mm is impossible: no equilibrium beyond "
                    f"{now.deflection * 1e3:.4g} mm; {stuck}",
                    field="deflection",
                ) from None
            continue
        steps.append(aim)
        residuals.append(history)
        before, now = now, Flattened(tyre, aim, displacement, forces, touching, tuple(steps), tuple(residuals))
        step *= 1.5 if len(history) <= 8 else 1.0
    return now


def _starts(before: Flattened, now: Flattened, deflection: float) -> list[Array]:
    """Displacements to start from at a larger deflection: the motion continued, if there was one, and the last."""
    past = now.deflection - before.deflection
    if not past > 0:
        return [now.displacement]
    share = (deflection - now.deflection) / past
    return [now.displacement + share * (now.displacement - before.displacement), now.displacement]
