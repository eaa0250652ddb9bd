"""Natural convection on a vertical face in air (Allouis et al. 2016, equations 6-9; Churchill & Chu 1975)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyrefem.errors import InputError

Array = NDArray[Any]

GRAVITY, PRESSURE, GAS_CONSTANT, SPECIFIC_HEAT = 9.80665, 101325.0, 287.05, 1007.0
_ABSOLUTE = 273.15


def air(temperature: ArrayLike) -> tuple[Array, Array, Array]:
    """Conductivity (W/m/K), kinematic viscosity (m2/s) and Prandtl number of dry air at 1 atm, temperature in degC.

    Sutherland's laws: mu = 1.458e-6 T^1.5/(T + 110.4), k = 2.495e-3 T^1.5/(T + 194) (White, Viscous fluid flow);
    c_p = 1007 J/kg/K. Within 1 % of tables from 0 to 300 degC.

    >>> k, nu, Pr = air(26.85)
    >>> round(float(k), 4), round(float(nu) * 1e6, 1), round(float(Pr), 2)
    (0.0262, 15.7, 0.71)
    """
    T = np.asarray(temperature, dtype=float) + _ABSOLUTE
    mu = 1.458e-6 * T**1.5 / (T + 110.4)
    k = 2.495e-3 * T**1.5 / (T + 194.0)
    return k, mu * GAS_CONSTANT * T / PRESSURE, mu * SPECIFIC_HEAT / k


def nusselt(rayleigh: ArrayLike, prandtl: ArrayLike) -> Array:
    """Mean Nusselt number of a vertical plate, (9): Nu = (0.825 + 0.387 Ra^(1/6)/(1 + (0.492/Pr)^(9/16))^(8/27))^2.

    Raises InputError for a negative Rayleigh number.

    >>> round(float(nusselt(1e9, 0.71)), 1)
    122.9
    """
    Ra = np.asarray(rayleigh, dtype=float)
    if np.any(Ra < 0):
        raise InputError("must not be negative", field="rayleigh")
    spread = (1.0 + (0.492 / np.asarray(prandtl, dtype=float)) ** (9 / 16)) ** (8 / 27)
    return np.asarray((0.825 + 0.387 * Ra ** (1 / 6) / spread) ** 2)


def natural_film(surface: ArrayLike, ambient: float, length: float) -> Array:
    """Film coefficient of natural convection, W/m2/K, (8): h = Nu k_air/delta, Ra = g beta |Ts - Ta| delta^3 Pr/nu^2.

    Air is taken at the mean of both temperatures, beta = 1/T there. The paper prints nu^3 in the Grashof number (6);
    nu^2 makes it a number.

    Parameters
    ----------
    surface : temperature Ts of the face, degC, any shape.
    ambient : temperature of the air, degC.
    length : characteristic length delta, m.

    >>> round(float(natural_film(60.0, 20.0, 0.1)), 1)
    6.1
    """
    if not length > 0:
        raise InputError(f"must be more than 0 m, not {length!r}", field="length")
    # A rejected trial step may stray: air's laws are asked only where they mean something.
    Ts = np.clip(np.asarray(surface, dtype=float), -150.0, 1500.0)
    film = (Ts + ambient) / 2.0
    k, nu, Pr = air(film)
    rayleigh = GRAVITY / (film + _ABSOLUTE) * np.abs(Ts - ambient) * length**3 * Pr / nu**2
    return np.asarray(nusselt(rayleigh, Pr) * k / length)
