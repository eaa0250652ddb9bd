"""Harmonic balance: the footprint with Green's strains in place of linearised ones."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.footprint.contact import Pressing
from tyrefem.footprint.nonlinear import NonlinearForces
from tyrefem.footprint.pressed import Footprint

Array = NDArray[np.float64]
#: Earlier steps that the acceleration remembers, steps allowed at one deflection, halvings of the way there.
MEMORY, STEPS, HALVINGS = 10, 40, 5


@dataclass(frozen=True, eq=False)
class Balance:
    """Footprints where contact balances linear and nonlinear forces of every harmonic.

    K_n u_n = f_n - g_n(u), g of `NonlinearForces`: the linear factors serve every step (Anderson's acceleration), and
    contact is solved anew in each. Where steps do not settle, a smaller deflection is balanced first.

    Parameters
    ----------
    pressing : the tyre and its road.
    harmonics : highest harmonic.
    tolerance : last change relative to the displacement.

    >>> from tyrefem.footprint.plain import PlainTyre
    >>> balance = Balance(Pressing(PlainTyre().state(along=6)), 16)
    >>> found = balance.at_deflection(0.004)
    >>> found.correction.shape == found.amplitudes.shape
    True
    """

    pressing: Pressing
    harmonics: int
    tolerance: float = 1e-3

    @functools.cached_property
    def nonlinear(self) -> NonlinearForces:
        """The forces that the linear problem leaves out."""
        return NonlinearForces(self.pressing.harmonics, self.harmonics)

    def at_deflection(self, deflection: float, start: Footprint | None = None) -> Footprint:
        """The balanced footprint at a deflection, m; ``start``: a balanced one near by.

        Raises
        ------
        InputError : no balance; the message says how far it got.
        """
        path = [start] if start is not None else []
        step = deflection - (start.deflection if start is not None else 0.0)
        while not path or abs(path[-1].deflection - deflection) > 1e-12:
            at = path[-1].deflection if path else 0.0
            left = deflection - at
            found = self._settled(at + (step if abs(step) < abs(left) else left), path)
            if found is not None:
                path, step = [*path, found], 1.5 * step
            elif abs(step) > deflection / 2**HALVINGS:
                step /= 2
            else:
                raise InputError(
                    f"the harmonic balance reaches {at * 1e3:.4g} mm, not {deflection * 1e3:.4g} mm of deflection",
                    field="deflection",
                )
        return path[-1]

    def at_load(self, load: float) -> Footprint:
        """The balanced footprint under a load, N, to 0.1 %: secant steps of the deflection.

        Raises
        ------
        InputError : what `at_deflection` and `Pressing.at_load` raise.
        """
        deflection = self.pressing.at_load(load, self.harmonics).deflection
        found = self.at_deflection(deflection)
        slope = found.stiffness
        for _ in range(12):
            if abs(found.load - load) <= 1e-3 * load:
                return found
            before, found = found, self.at_deflection(found.deflection + (load - found.load) / slope, found)
            slope = max((found.load - before.load) / (found.deflection - before.deflection), 0.3 * slope)
        raise InputError(f"the harmonic balance does not find the deflection of {load:.5g} N", field="load")

    def _settled(self, deflection: float, path: list[Footprint]) -> Footprint | None:
        """The balance at one deflection, begun where those before point to, or None."""
        pressing, outside = self.pressing, self.nonlinear
        x, start = np.zeros((self.harmonics + 1, pressing.harmonics.elements.n_dofs)), path[-1] if path else None
        if len(path) > 1:
            one, two = path[-2:]
            share = (deflection - two.deflection) / (two.deflection - one.deflection)
            x = _correction(two) + share * (_correction(two) - _correction(one))
        elif path:
            x = _correction(path[0]) * (deflection / path[0].deflection) ** 2
        steps: list[Array] = []
        changes: list[Array] = []
        found = pressing.at_deflection(deflection, self.harmonics, start, x)
        smallest = np.inf
        for _ in range(STEPS):
            u = found.amplitudes
            if not u.any():  # Nothing touches: the hats are wider than so small a footprint.
                return found
            change = -pressing.tread.responses(outside(u)) - x
            size = float(np.abs(change).max() / np.abs(u).max())
            smallest = min(size, smallest)
            if not size < 30 * smallest:
                return None
            if size <= self.tolerance:
                return found
            steps, changes = [*steps[-MEMORY:], x], [*changes[-MEMORY:], change]
            x = _accelerated(steps, changes)
            found = pressing.at_deflection(deflection, self.harmonics, found, x)
        return None


def _correction(found: Footprint) -> Array:
    assert found.correction is not None
    return found.correction


def _accelerated(steps: list[Array], changes: list[Array]) -> Array:
    """Anderson's next step from earlier ones and their changes."""
    last = steps[-1] + changes[-1]
    if len(steps) == 1:
        return np.asarray(steps[-1] + changes[-1] / 2)
    differences = np.stack([(changes[-1] - c).ravel() for c in changes[:-1]], axis=1)
    shares = np.linalg.lstsq(differences, changes[-1].ravel(), rcond=1e-8)[0]
    for share, step, change in zip(shares, steps, changes, strict=False):
        last = last - share * (steps[-1] + changes[-1] - step - change)
    return np.asarray(last)
