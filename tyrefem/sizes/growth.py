r"""Growth of a bias tyre under its rated pressure: the line before inflation, from the inflated one.

A data book gives the size of the inflated tyre; a section is drawn without pressure. Both lines are in equilibrium
(`tyrefem.sizes.membrane`). On the inflated line plies of thickness h and modulus E (layer, along the cords) stretch by

    e = p A / (2 r h E sin^3 alpha),    as   N_phi = p A / (2 r sin alpha) = h E e sin^2 alpha.

Cords that pantograph keep their number of turns, r d(theta) = cos(alpha) dl. Shorter by 1 + e, they have the lift
k (1 + e): cos(alpha)/r before inflation. The line before inflation has this lift and the shorter cords.
"""

from __future__ import annotations

import numpy as np

from tyrefem.errors import InputError
from tyrefem.sizes.meridian import SizedMeridian, bias_meridian

#: Smallest crown radius before inflation over the inflated one.
LEAST = 0.85
_SAMPLES = 600


def stretched(line: SizedMeridian, pressure: float, stiffness: float) -> tuple[float, float]:
    """Length of the cords from crown to bead seat before they stretch, m, and their mean stretch between crown and
    flange. ``stiffness``: h E of the plies, N/m."""
    s = np.linspace(0.0, line.length, _SAMPLES)
    r = line.at(s)[0]
    sine = np.sqrt(1 - (line.membrane.lift * r) ** 2)
    stretch = pressure * line.membrane.tension(r) / (stiffness * sine**2)
    stretch[s > line.flange_s] = 0.0
    length, free = 1 / (sine * (1 + stretch)), np.where(s <= line.flange_s, 1 / sine, 0.0)
    mean = float(np.trapezoid(stretch / sine, s) / np.trapezoid(free, s))
    return float(np.trapezoid(length, s)), mean


def before_inflation(
    line: SizedMeridian, pressure: float, stiffness: float, bend: float | None = None
) -> SizedMeridian:
    """The line whose cords become those of ``line`` under a pressure, Pa. ``bend``: radius of its bend at the flange,
    m; by default that of ``line``.

    Raises
    ------
    InputError : no line in equilibrium has such cords.
    """
    from scipy.optimize import root_scalar

    length, stretch = stretched(line, pressure, stiffness)
    lift, radius = line.membrane.lift * (1 + stretch), line.bend if bend is None else bend

    def with_crown(crown: float) -> SizedMeridian:
        angle = float(np.arccos(np.clip(lift * crown, 0.0, 0.999)))
        return bias_meridian(crown, line.half_width, line.rim, line.offset, radius, angle)[0]

    def misses(crown: float) -> float:
        return stretched(with_crown(crown), 0.0, stiffness)[0] - length

    start = line.crown * (1 - stretch)
    try:
        crown = root_scalar(misses, x0=start, x1=0.997 * start, xtol=1e-6).root
    except InputError:
        crown = np.nan
    if not LEAST * line.crown < crown <= line.crown:
        raise InputError(
            f"cords that stretch by {stretch:.1%} under the rated pressure leave no line before inflation; more or "
            "thicker plies or a lower pressure stretch them less",
            field="parameters.rated_pressure",
        )
    return with_crown(float(crown))
