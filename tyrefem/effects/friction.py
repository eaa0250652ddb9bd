"""Heat of a tread that slides on the road: what longitudinal slip and yaw share."""

from __future__ import annotations

from tyrefem.effects.tyre import Tyre
from tyrefem.road_contact import effusivity

#: Friction coefficient of rubber on a dry road (estimate).
FRICTION = 0.8
#: Effusivity of dense asphalt or concrete, J/m2/K/s^0.5: sqrt(1.5 W/m/K x 2e6 J/m3/K) (estimate).
ROAD = effusivity(1.5, 2e6)


def sliding_flux(tyre: Tyre, t: float) -> float:
    """mu p v f b_tyre / (b_tyre + b_road): W/m2 into the tread at a slip of 1, mean over the revolution.

    Friction stress times speed, divided as the effusivities (Roberts, eqs 2 and 5), for the fraction f of the
    revolution on the road; the contact pressure is taken as the inflation pressure.
    """
    tread = effusivity(*tyre.tread)
    pressure = tyre.schedule.mean(lambda case: case.pressure if case.deflection > 0 else 0.0, t)
    return FRICTION * pressure * tyre.speed(t) * tyre.road_fraction(t) * tread / (tread + ROAD)
