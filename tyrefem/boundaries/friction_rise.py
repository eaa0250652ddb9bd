"""Temperature rise of a track under a sliding rubber pad.

Equation numbers are those of A. D. Roberts, *Temperature rise when rubber slides*, with expressions from
H. S. Carslaw and J. C. Jaeger, *Conduction of heat in solids* (1959).

Assumptions: friction work becomes heat evenly over the pad; properties do not depend on temperature; heat flows
normal to the surface only. So the Peclet number v l/k is much more than 1, and both bodies are thicker than the depth
of the heat, about sqrt(4 k l/v) in the track. Phase change (melting ice) and decomposition are not included.
"""

from __future__ import annotations

import math

from tyrefem.boundaries.friction import Solid, not_negative, positive

#: Mean over the pad's length of a rise proportional to the square root of the distance from its front edge.
MEAN_OF_EXIT = 2.0 / 3.0


def heat_flux(force: float, speed: float, length: float, breadth: float) -> float:
    """Friction work per time and area of contact, F_0 = f v/(l b)   (2).

    Parameters
    ----------
    force : friction force f, N. speed : v, m/s.
    length, breadth : of the pad along and across the sliding direction, m.

    Returns W/m2. Raises InputError for a negative force or speed, or a length or breadth that is not positive.

    >>> round(heat_flux(62.76, 0.35, 0.225, 0.153), 1)
    638.1
    """
    not_negative(force=force, speed=speed)
    positive(length=length, breadth=breadth)
    return force * speed / (length * breadth)


def surface_rise(flux: float, time: float, track: Solid) -> float:
    """Surface rise of a half-space after a constant flux for a time, (2 F_0/K) sqrt(k t/pi)   (1).

    No heat enters the slider: it conducts far less, or is already warm from sliding (see `share_into_slider`).

    Parameters
    ----------
    flux : F_0, W/m2. time : t, s; under a pad l/v.

    Returns K. Raises InputError for a negative flux or time.

    >>> from tyrefem.boundaries.friction_names import TEAK
    >>> round(surface_rise(638.1, 0.225 / 0.35, TEAK), 3)
    1.437
    """
    not_negative(flux=flux, time=time)
    return 2.0 * flux / track.conductivity * math.sqrt(track.diffusivity * time / math.pi)


def exit_rise(force: float, speed: float, length: float, breadth: float, track: Solid) -> float:
    """Rise of the track from the front edge to the exit edge, (2 f/b) sqrt(v/(rho c pi K l))   (3).

    Equation 1 with equation 2 and t = l/v; parameters as in `heat_flux`, no heat enters the slider.

    Returns K. Raises InputError as `heat_flux`.

    >>> from tyrefem.boundaries.friction_names import TEAK
    >>> round(exit_rise(62.76, 0.35, 0.225, 0.153, TEAK), 3)
    1.437
    """
    not_negative(force=force, speed=speed)
    positive(length=length, breadth=breadth)
    return 2.0 * force / breadth * math.sqrt(speed / (track.heat_capacity * math.pi * track.conductivity * length))


def exit_rise_of_stress(stress: float, speed: float, length: float, track: Solid) -> float:
    """Equation 3 with the frictional stress sigma = f/(l b): 2 sigma sqrt(v l/(pi K rho c))   (12).

    Parameters
    ----------
    stress : sigma, Pa: friction coefficient times contact pressure. speed : v, m/s. length : l, m.

    Returns K. Raises InputError for a negative stress or speed, or a length that is not positive.

    >>> from tyrefem.boundaries.friction_names import TEAK
    >>> round(exit_rise_of_stress(62.76 / (0.225 * 0.153), 0.35, 0.225, TEAK), 3)
    1.437
    """
    not_negative(stress=stress, speed=speed)
    positive(length=length)
    return 2.0 * stress * math.sqrt(speed * length / math.pi) / track.effusivity


def fall_off(distance: float, length: float) -> float:
    """Rise of the track at a distance d behind the exit edge, over the rise at the edge   (4).

    sqrt((l+d)/l) [1 - sqrt(1 - l/(l+d))], in the form sqrt(l)/(sqrt(l+d) + sqrt(d)) without cancellation. The free
    surface loses no heat to the air.

    Parameters
    ----------
    distance : d, m, at least 0. length : l of the pad, m.

    Returns a number from 0 to 1. Raises InputError for a negative distance or a length that is not positive.

    >>> round(fall_off(0.015, 0.225), 4), fall_off(0.0, 0.225)
    (0.7746, 1.0)
    """
    not_negative(distance=distance)
    positive(length=length)
    return math.sqrt(length) / (math.sqrt(length + distance) + math.sqrt(distance))


def distance_of_fall_off(ratio: float, length: float) -> float:
    """Distance behind the pad at which the rise is a given share of the exit edge's rise: equation 4 solved for d.

    d = l (1 - q^2)^2/(4 q^2) for the ratio q.

    Parameters
    ----------
    ratio : q, more than 0, at most 1. length : l, m.

    Returns m. Raises InputError for a ratio outside its range or a length that is not positive.

    >>> round(distance_of_fall_off(fall_off(0.015, 0.225), 0.225), 9)
    0.015
    """
    positive(ratio=ratio, length=length)
    not_negative(**{"1 - ratio": 1.0 - ratio})
    return length * (1.0 - ratio**2) ** 2 / (4.0 * ratio**2)


def share_into(body: Solid, other: Solid) -> float:
    """Share of the heat that enters one of two bodies in full contact since the start.

    b/(b + b'), b the effusivities, from the flux of equation 5. Half for equal bodies.

    >>> from tyrefem.boundaries.friction_names import RUBBER, TEAK
    >>> round(share_into(TEAK, RUBBER), 3)
    0.398
    """
    return body.effusivity / (body.effusivity + other.effusivity)


def shared_rise(flux: float, time: float, first: Solid, second: Solid) -> float:
    """Rise of the interface of two conductors, 2 F_0/(K1 sqrt(k2) + K2 sqrt(k1)) sqrt(k1 k2 t/pi)   (5).

    For a slider as cold as the track and in contact for the same time: the start of sliding. Later less heat enters
    the slider, and the rise approaches equation 1.

    Parameters
    ----------
    flux : F_0 of both bodies together, W/m2. time : t, s.

    Returns K. Raises InputError for a negative flux or time.

    >>> from tyrefem.boundaries.friction_names import TEAK
    >>> round(shared_rise(638.1, 0.6, TEAK, TEAK) / surface_rise(638.1, 0.6, TEAK), 12)
    0.5
    """
    not_negative(flux=flux, time=time)
    k1, k2 = first.diffusivity, second.diffusivity
    conductance = first.conductivity * math.sqrt(k2) + second.conductivity * math.sqrt(k1)
    return 2.0 * flux / conductance * math.sqrt(k1 * k2 * time / math.pi)


def largest_friction(rise: float, speed: float, length: float, breadth: float, track: Solid) -> float:
    """Friction force at which the exit edge reaches a rise, T_d b sqrt(rho c pi K l)/(2 sqrt(v))   (13).

    With the rise T_d at which the rubber decomposes (or ice melts) it is the largest possible friction (Ettles,
    Tire Sci. Technol. 14, 1986, 44).

    Parameters
    ----------
    rise : T_d above the temperature before the pad, K. speed : v, m/s, more than 0.

    Returns N. Raises InputError for a negative rise, or a speed, length or breadth that is not positive.

    >>> from tyrefem.boundaries.friction_names import ICE
    >>> round(largest_friction(15.0, 4.47, 0.025, 0.025, ICE), 1)
    51.0
    """
    not_negative(rise=rise)
    positive(speed=speed, length=length, breadth=breadth)
    return rise * breadth * track.effusivity * math.sqrt(math.pi * length) / (2.0 * math.sqrt(speed))
