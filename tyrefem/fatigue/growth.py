"""From the cracking energy of a cycle to the number of cycles that a small flaw lasts."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyrefem.materials.fatigue import Fatigue

Array = NDArray[np.float64]
#: Exponents nearer to 1 than this take the limit of the integral, a logarithm.
NEAR_ONE = 1e-9
#: Longest life in cycles: a longer one, also of a point without cycle, counts as this.
LONGEST = 1e15


def lindley_factor(stretch: ArrayLike) -> Array:
    """k of T = 2 k W c: (2.95 - 0.08 (l - 1)) / sqrt(l), l the stretch across the crack, at least 1 (Lindley 1972).

    >>> float(lindley_factor(1.0))
    2.95
    """
    at_least_one: Array = np.maximum(np.asarray(stretch, dtype=float), 1.0)
    return np.asarray((2.95 - 0.08 * (at_least_one - 1)) / np.sqrt(at_least_one))


def temperature_factor(fatigue: Fatigue, temperature: ArrayLike) -> Array:
    """Growth per cycle at temperatures, degC, over that at the card's reference: exp(b (temperature - reference))."""
    return np.asarray(np.exp(fatigue.temperature_rate * (np.asarray(temperature, dtype=float) - fatigue.reference)))


def driving_force(fatigue: Fatigue, ratio: ArrayLike) -> tuple[Array, Array]:
    """Share of T_max that drives the crack, and the exponent, at R = T_min/T_max.

    Rubber that crystallises: 1 and F exp(ratio_rate R), which is Thomas' law at the equivalent
    T_max^(F(R)/F) T_c^(1 - F(R)/F) of a cycle with R = 0 (Mars & Fatemi 2003). Other rubber: 1 - R and F.
    """
    bounded: Array = np.clip(np.asarray(ratio, dtype=float), 0.0, 1.0)
    if fatigue.crystallising:
        return np.ones_like(bounded), np.asarray(fatigue.exponent * np.exp(fatigue.ratio_rate * bounded))
    return np.asarray(1 - bounded), np.full_like(bounded, fatigue.exponent)


def cycles_to_failure(
    fatigue: Fatigue, energy: ArrayLike, ratio: ArrayLike = 0.0, stretch: ArrayLike = 1.0, temperature: ArrayLike = 23.0
) -> Array:
    """N from the flaw c_0 to the crack c_1, in closed form, at most `LONGEST`; shape of the broadcast inputs.

    dc/dN = f r_c (a c)^F, a = 2 k W s / T_c, f the temperature factor, s and F those of `driving_force`:

    N = (c_0^(1-F) - c_1^(1-F)) / ((F - 1) f r_c a^F),  F = 1: ln(c_1/c_0) / (f r_c a).

    Where the crack reaches T_c before c_1 (2 k W c > T_c), the life ends there; a flaw that is there at once has N = 0.
    A flaw whose s 2 k W c_0 is not above the threshold lasts `LONGEST`.

    Parameters
    ----------
    energy : largest cracking energy density of the cycle, J/m3. ratio : least over largest.
    stretch : across the plane at the largest energy. temperature : degC.
    """
    positive: Array = np.maximum(np.asarray(energy, dtype=float), 0.0)
    share, exponent = driving_force(fatigue, ratio)
    peak: Array = np.asarray(2 * lindley_factor(stretch) * positive / fatigue.tearing_energy)
    slope = peak * share
    with np.errstate(divide="ignore", over="ignore", under="ignore", invalid="ignore"):
        last = np.minimum(fatigue.crack, 1 / peak)
        ends = np.log(last / fatigue.flaw)
        power = 1 - exponent
        # (c_1^(1-F) - c_0^(1-F)) / (1 - F) = c_0^(1-F) expm1((1-F) ln(c_1/c_0)) / (1-F), smooth through F = 1.
        # c_0^(1-F) / a^F = c_0 / (a c_0)^F: a c_0 is below 1, so that large exponents stay numbers.
        integral = np.where(
            np.abs(power) < NEAR_ONE,
            ends,
            np.expm1(power * ends) / np.where(np.abs(power) < NEAR_ONE, 1.0, power),
        )
        rate = fatigue.growth_rate * temperature_factor(fatigue, temperature)
        cycles = fatigue.flaw * np.maximum(integral, 0.0) / (rate * (slope * fatigue.flaw) ** exponent)
    grows = slope * fatigue.flaw * fatigue.tearing_energy > fatigue.threshold
    lasting = np.where(grows, cycles, LONGEST)
    return np.asarray(np.minimum(np.where(last <= fatigue.flaw, 0.0, lasting), LONGEST))
