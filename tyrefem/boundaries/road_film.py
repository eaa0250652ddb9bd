"""One contact of the tread with the road: depth, heat, film coefficient and footprint in closed form. SI units."""

from __future__ import annotations

import math

from tyrefem.errors import InputError


def _number(value: float, field: str, *, zero: bool = False) -> float:
    """The value, if it is a finite number above zero (or zero where zero is allowed)."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise InputError(f"must be a number, not {value!r:.40}", field=field) from None
    if not math.isfinite(number) or number < 0 or (number == 0 and not zero):
        raise InputError(f"must be finite and {'at least' if zero else 'more than'} 0, not {number:g}", field=field)
    return number


def propagation_depth(time: float, conductivity: float, heat_capacity: float) -> float:
    """Depth of tread that a contact cools, p = sqrt(4 lambda t / C), m (Cattani et al. 2023, eq 8).

    Knee of a triangular profile; valid while p is small against the tread's thickness. ``time`` since first contact, s;
    ``conductivity`` W/m/K; ``heat_capacity`` J/m3/K. Raises InputError for a number that is not positive.

    >>> round(propagation_depth(0.14 / 2.7, 0.25, 2e6) * 1e3, 3)
    0.161
    """
    t = _number(time, "time", zero=True)
    return math.sqrt(4 * _number(conductivity, "conductivity") * t / _number(heat_capacity, "heat_capacity"))


def exchanged_heat(time: float, area: float, difference: float, conductivity: float, heat_capacity: float) -> float:
    """Heat given to the road, Q = dS (T2 - T1) sqrt(lambda C t), J (Cattani et al. 2023, eq 9).

    ``area`` dS in m2, ``difference`` T2 - T1 of the tread over the road in K, either sign. Raises InputError.

    >>> round(exchanged_heat(0.01, 0.02, 50.0, 0.25, 2e6), 2)
    70.71
    """
    if not math.isfinite(difference):
        raise InputError(f"must be a finite difference in K, not {difference!r}", field="difference")
    t, area = _number(time, "time", zero=True), _number(area, "area", zero=True)
    return area * difference * effusivity(conductivity, heat_capacity) * math.sqrt(t)


def effusivity(conductivity: float, heat_capacity: float) -> float:
    """b = sqrt(lambda C), J/m2/K/s^0.5, from W/m/K and J/m3/K. Raises InputError.

    >>> round(effusivity(0.25, 2e6), 1)
    707.1
    """
    return math.sqrt(_number(conductivity, "conductivity") * _number(heat_capacity, "heat_capacity"))


def triangular_film(speed: float, footprint_length: float, conductivity: float, heat_capacity: float) -> float:
    """H_c = sqrt(lambda C v / FL), W/m2/K: mean over a contact of a triangular profile (Cattani et al. 2023, eq 12).

    ``speed`` m/s, ``footprint_length`` m, the tread's W/m/K and J/m3/K. The road temperature is constant. Raises
    InputError.

    >>> round(triangular_film(150 / 3.6, 0.14, 0.25, 2e6), 2)
    12198.75
    """
    product = _number(conductivity, "conductivity") * _number(heat_capacity, "heat_capacity")
    return math.sqrt(product * _number(speed, "speed", zero=True) / _number(footprint_length, "footprint_length"))


def half_space_film(
    speed: float, footprint_length: float, conductivity: float, heat_capacity: float, road_effusivity: float = math.inf
) -> float:
    """H_c = (2/sqrt(pi)) sqrt(lambda C v / FL) b_road / (b_road + b_tyre), W/m2/K: two half-spaces suddenly in contact.

    The exact mean over the contact (Carslaw & Jaeger, *Conduction of heat in solids*, 1959, 2.15), per kelvin between
    tread and road before contact. ``road_effusivity`` in J/m2/K/s^0.5; infinite for a road of constant
    temperature. Perfect contact over the whole footprint; both bodies deep against `propagation_depth`. Raises
    InputError.

    >>> round(half_space_film(150 / 3.6, 0.14, 0.25, 2e6) / triangular_film(150 / 3.6, 0.14, 0.25, 2e6), 4)
    1.1284
    >>> round(half_space_film(150 / 3.6, 0.14, 0.25, 2e6, road_effusivity=effusivity(0.25, 2e6)), 1)
    6882.4
    """
    tyre = effusivity(conductivity, heat_capacity)
    road = math.inf if road_effusivity == math.inf else _number(road_effusivity, "road_effusivity")
    share = 1.0 if math.isinf(road) else road / (road + tyre)
    return 2 / math.sqrt(math.pi) * share * triangular_film(speed, footprint_length, conductivity, heat_capacity)


def radial_deflection(load: float, radial_stiffness: float) -> float:
    """dz = P / k, m, from N and N/m (Cattani et al. 2023, eq 14). Raises InputError.

    >>> radial_deflection(4000.0, 200e3)
    0.02
    """
    return _number(load, "load", zero=True) / _number(radial_stiffness, "radial_stiffness")


def hedekel_length(deflection: float, radius: float, correction: float = 1.0) -> float:
    """FL = c 2 sqrt(dz (2 R - dz)), m: chord of the free circle on the road (Cattani et al. 2023, eq 13).

    ``deflection`` dz and free ``radius`` R in m, dz at most R; ``correction`` c is a measured factor. Raises
    InputError.

    >>> round(hedekel_length(0.01, 0.3), 4)
    0.1536
    """
    dz, R = _number(deflection, "deflection", zero=True), _number(radius, "radius")
    if dz > R:
        raise InputError(f"must be at most the radius, {R:g} m, not {dz:g} m", field="deflection")
    return _number(correction, "correction") * 2 * math.sqrt(dz * (2 * R - dz))
