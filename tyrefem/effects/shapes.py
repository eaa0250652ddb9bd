"""Measures that several effects share: speed over a reference, deflection over the rated one, the shoulder."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tyrefem.effects.tyre import StudyOfTyre, Tyre

Array = NDArray[np.float64]
#: Speed at which a power law of speed changes nothing, m/s: within what tyres are tested at.
REFERENCE_SPEED = 10.0
#: Below walking pace a power law of speed is held: it has no meaning at rest and no bound for negative exponents.
SLOWEST = 1.0
#: Range in which laws linear or exponential in temperature are used; held beyond (a trial step may stray), degC.
COLDEST, HOTTEST = -50.0, 250.0


def no_carcass(study: StudyOfTyre) -> str | None:
    """Why an effect that is placed by the region 'carcass' has no meaning in a study; None where there is one."""
    section = study.section
    return None if "carcass" in section.regions else f"section '{section.name}' has no region 'carcass'"


def speed_ratio(tyre: Tyre, t: float) -> float:
    """v / v_ref, at least 0.1."""
    return max(tyre.speed(t), SLOWEST) / REFERENCE_SPEED


def deflection_ratio(tyre: Tyre, t: float) -> float:
    """D over the deflection at the rated load and pressure."""
    return tyre.schedule.mean(lambda case: case.deflection, t) / tyre.rated_deflection


def beyond_shoulder(tyre: Tyre, x: Array) -> Array:
    """0 at the crown, rising over the shoulder to 1 in the sidewall: half way at 0.85 of the shoulder's station."""
    s, _ = tyre.places(x)
    shoulder = tyre.study.section.line.shoulder_s
    return np.asarray(1 / (1 + np.exp(-(s - 0.85 * shoulder) / (0.1 * shoulder))))


def above_25(T: Array) -> Array:
    """T - 25 degC, within the range in which property laws are used."""
    return np.asarray(np.clip(T, COLDEST, HOTTEST) - 25.0)
