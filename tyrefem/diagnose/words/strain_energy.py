"""Another strain energy along the meridian in words: where the tyre makes more and less heat than the model."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tyrefem.diagnose.numbers import amount
from tyrefem.diagnose.unknowns.energy_shapes import SHAPE, courses
from tyrefem.diagnose.words.heat import station_words

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import DiagnosisData
    from tyrefem.diagnose.fitting.fits import FittedSet

Array = NDArray[np.float64]
#: A share of the heat is stated if it differs from zero by more than this many standard deviations.
CLEAR = 2.0
#: From this ratio on heats are written as "2.5 times the heat".
TIMES = 2.5


def energy_words(d: DiagnosisData, fit: FittedSet) -> str:
    """Where the tyre makes more and less heat than the model, as shares of the model's heat; empty if none is clear.

    ``fit``: beside another strain energy.
    """
    share, sd, s = energy_shares(d, fit)
    ratio = share / np.maximum(sd, 1e-12)
    clauses = []
    for sign, words in ((1.0, "more"), (-1.0, "less")):
        at = int(np.argmax(sign * ratio))
        if sign * ratio[at] > CLEAR:
            if share[at] > TIMES - 1:
                size = f"{amount(1 + float(share[at]), float(sd[at]), '1').lstrip('+')} times the heat"
            else:
                size = f"{amount(100 * abs(float(share[at])), 100 * float(sd[at]), '%').lstrip('+')} {words} heat"
            clauses.append((abs(float(ratio[at])), f"{size} {station_words(d, float(s[at]))}"))
    clauses.sort(key=lambda clause: -clause[0])
    if not clauses:
        return ""
    # "Times the heat" needs no "than".
    compared = "than the model" if "times the heat" not in clauses[-1][1] else "of the model"
    return f"the tyre makes {' and '.join(text for _, text in clauses)} {compared}"


def energy_shares(d: DiagnosisData, fit: FittedSet) -> tuple[Array, Array, Array]:
    """Missing share of the heat along the meridian (n,), its standard deviation, and the stations (m).

    The share is that of the model's own heat: exp(sum of the half waves) - 1.
    """
    length = d.original.section.line.length
    s = np.linspace(0.0, length, 41)
    kept = [unknown for unknown in fit.unknowns if unknown.effect == SHAPE]
    at = [fit.unknowns.index(unknown) for unknown in kept]
    waves = courses(s / length, kept)
    log_factor = waves @ fit.posterior.mean[at]
    sd = np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", waves, fit.posterior.covariance[np.ix_(at, at)], waves), 0.0))
    factor = np.exp(log_factor)
    return np.asarray(factor - 1), np.asarray(sd * factor), s


def beyond_noise(rms_of_all: float, noise: float) -> float:
    """sqrt(rms^2 - noise^2), K, of a deviation; 0 if it is no larger than the noise."""
    return math.sqrt(max(rms_of_all**2 - noise**2, 0.0))
