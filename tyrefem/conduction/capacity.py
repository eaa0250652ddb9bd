"""Heat capacity of a region and its stored heat."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.conditions import Material, is_number
from tyrefem.conduction.operators import Operators
from tyrefem.errors import InputError

Array = NDArray[Any]

#: Points and weights of the integral of a heat capacity over a change of temperature.
GAUSS = tuple(zip(*np.polynomial.legendre.leggauss(5), strict=True))


class Capacity:
    """Volumetric heat capacity of one region, constant or a function of temperature."""

    def __init__(self, ops: Operators, name: str, material: Material) -> None:
        self.name, self.dofs = name, ops.dofs(name)
        self.constant = is_number(material.heat_capacity)
        self.c = cast(Any, material.heat_capacity)
        if self.constant:
            self.data = ops.mass(name) * float(self.c)
            self.row = ops.mass_row(name) * float(self.c)
        else:
            self.q = ops.quadrature(name, material.direction)

    def values(self, T: Array) -> Array:
        """c at quadrature temperatures, J/m3/K."""
        c = np.broadcast_to(np.asarray(self.c(T), dtype=float), T.shape)
        if not np.min(c) > 0:
            where = f"between {T.min():.6g} and {T.max():.6g} degC"
            raise InputError(f"is not positive {where}", field=f"regions.{self.name}.heat_capacity")
        return c

    def mass(self, u: Array) -> Array:
        """Operator values of the integral of c v u."""
        return self.data if self.constant else self.q.mass @ self.values(self.q.value @ u)

    def slope(self, u: Array, rate: Array, bump: float) -> Array:
        """Operator values of d(M du/dt)/d(temperature) at a rate (n,), K/s, by differences over +-``bump`` K."""
        T = self.q.value @ u
        rise = (self.values(T + bump) - self.values(T - bump)) / (2 * bump)
        return np.asarray(self.q.mass @ (rise * (self.q.value @ rate)))

    def stored(self, before: Array, after: Array) -> float:
        """Heat stored from one temperature field to another, J."""
        if self.constant:
            return float(self.row @ (after - before))
        T0, T1 = self.q.value @ before, self.q.value @ after
        mean = sum(w / 2 * self.values(T0 + (x + 1) / 2 * (T1 - T0)) for x, w in GAUSS)
        return float(self.q.weight @ (mean * (T1 - T0)))

    def rate(self, u: Array, slope: Array) -> float:
        """Heat stored per second at temperature rate `slope`, W."""
        if self.constant:
            return float(self.row @ slope)
        return float(self.q.weight @ (self.values(self.q.value @ u) * (self.q.value @ slope)))
