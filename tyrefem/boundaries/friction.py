"""A half-space of one material for sliding contacts: its thermal properties.

Also the share of friction heat that still enters a slider after some sliding distance.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from tyrefem.errors import InputError, nearest


def positive(**given: float) -> None:
    """Check that all numbers are finite and positive; InputError names the first that is not.

    >>> positive(length=0.04)
    """
    for field, value in given.items():
        if not (math.isfinite(value) and value > 0):
            raise InputError(f"must be finite and more than 0, not {value!r}", field=field)


def not_negative(**given: float) -> None:
    """Check that all numbers are finite and at least zero; InputError names the first that is not.

    >>> not_negative(distance=0.0)
    """
    for field, value in given.items():
        if not (math.isfinite(value) and value >= 0):
            raise InputError(f"must be finite and at least 0, not {value!r}", field=field)


@dataclass(frozen=True)
class Solid:
    """A semi-infinite solid with constant properties.

    Parameters
    ----------
    conductivity : K, W/m/K. density : rho, kg/m3. specific_heat : c, J/kg/K.
    source : of the numbers.

    Raises InputError for a number that is not finite and positive.

    >>> round(TEAK.effusivity, 1), f"{TEAK.diffusivity:.3e}"
    (401.8, '1.586e-07')
    """

    conductivity: float
    density: float
    specific_heat: float
    source: str = ""

    def __post_init__(self) -> None:
        positive(conductivity=self.conductivity, density=self.density, specific_heat=self.specific_heat)

    @property
    def heat_capacity(self) -> float:
        """rho c, J/m3/K."""
        return self.density * self.specific_heat

    @property
    def diffusivity(self) -> float:
        """k = K/(rho c), m2/s."""
        return self.conductivity / self.heat_capacity

    @property
    def effusivity(self) -> float:
        """sqrt(K rho c), W s^(1/2)/m2/K: two bodies share the heat flux in proportion to it."""
        return math.sqrt(self.conductivity * self.heat_capacity)


#: Natural rubber vulcanisate with 14 % carbon (formulation A).
RUBBER = Solid(0.21, 1050.0, 1675.0, "Roberts, Temperature rise when rubber slides; density measured, rest from tables")


#: African teak, the bench top.
TEAK = Solid(0.16, 730.0, 1382.0, "Roberts, Temperature rise when rubber slides; density measured, rest from tables")
ICE = Solid(2.2, 916.0, 2090.0, "Roberts, Temperature rise when rubber slides")


#: Not in the paper: published conductivities of asphalt are 0.7 to 2 W/m/K, depending on stone and voids.
ASPHALT = Solid(0.75, 2115.0, 920.0, "estimate, common handbook values")


SOLIDS = {"rubber": RUBBER, "teak": TEAK, "ice": ICE, "asphalt": ASPHALT}


def solid(name: str) -> Solid:
    """A solid by name: rubber, teak, ice, or asphalt (an estimate).

    >>> solid("ice").conductivity
    2.2
    """
    if name not in SOLIDS:
        raise InputError(f"no solid '{name}'{nearest(name, SOLIDS)}")
    return SOLIDS[name]


def share_into_slider(length: float, slid: float, slider: Solid, track: Solid) -> float:
    """F_r/F_0 = (2 K_r/(pi K_w)) sqrt(k_w t_c/(k_r T))   (9), with t_c/T = l/L at constant speed.

    The slider's surface has equation 1's rise since the start. This is the worst case; the real share is less. For
    rubber on teak the factor before sqrt(l/L) is 0.96 (10). Valid for l much less than L, as far as the share is 1 at
    most: for a slider that conducts far better than the track, L is many lengths.

    Parameters
    ----------
    length : l of the slider, m. slid : L, the total sliding distance, m, at least the length.

    Returns a number of 1 at most. Raises InputError for lengths that are not positive, a distance shorter than the
    slider, or one so short that the share would be more than 1. Source: Roberts, *Temperature rise when rubber slides*.

    >>> from tyrefem.boundaries.friction_names import RUBBER, TEAK
    >>> round(share_into_slider(0.04, 1.0, RUBBER, TEAK), 3)
    0.193
    """
    _check_sliding_distance(length, slid)
    ratio = slider.conductivity / track.conductivity * math.sqrt(track.diffusivity / slider.diffusivity)
    share = 2.0 / math.pi * ratio * math.sqrt(length / slid)
    if share > 1.0:
        times = f"the formula gives the slider {share:.3g} times all heat at {slid:g} m"
        raise InputError(f"must be {share**2 * slid:.3g} m or more: {times}", field="slid")
    return share


def share_of_like_solids(length: float, slid: float) -> float:
    """F_r/F_0 = sqrt(l/L)   (11): equation 10 with its 0.96 taken as 1, for rubber on wood only.

    Parameters and errors as `share_into_slider`.

    >>> share_of_like_solids(0.04, 1.0)
    0.2
    """
    _check_sliding_distance(length, slid)
    return math.sqrt(length / slid)


def _check_sliding_distance(length: float, slid: float) -> None:
    positive(length=length, slid=slid)
    if slid < length:
        raise InputError(f"must be at least the slider's length, {length:g} m, not {slid:g} m", field="slid")
