"""Measures that several effects share: speed over a reference, deflection over the rated one, the shoulder.

Heat of a tread that slides on the road: what longitudinal slip and yaw share.

What effects on a single thermocouple have in common.

The two sides of a full section: what camber and yaw share.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from tyrefem.boundaries.road_film import effusivity
from tyrefem.cards import Text
from tyrefem.effects.effect import Effect
from tyrefem.effects.tyre import StudyOfTyre, Tyre
from tyrefem.errors import nearest

Array = NDArray[np.float64]


#: Speed at which a power law of speed changes nothing, m/s: within what tyres are tested at.
REFERENCE_SPEED = 10.0


#: Below walking pace a power law of speed is held: it has no meaning at rest and no bound for negative exponents.
SLOWEST = 1.0


#: Range in which laws linear or exponential in temperature are used; held beyond (a trial step may stray), degC.
COLDEST, HOTTEST = -50.0, 250.0


#: Standard deviations from its station at which a Gaussian along the meridian counts as nothing: 4e-6 of it.
WIDTHS = 5.0


def no_region(study: StudyOfTyre, region: str | None) -> str | None:
    """Why an effect placed by a region does nothing in a study that has no such region; None: it has it, or all are
    meant."""
    section = study.section
    if region is None or region in section.regions:
        return None
    return f"section '{section.name}' has no region '{region}'{nearest(region, section.regions)}"


def beyond_meridian(study: StudyOfTyre, station: float | None, width: float | None) -> str | None:
    """Why a Gaussian about a station, m, does nothing in a study: it lies `WIDTHS` beyond the meridian; else None."""
    length = study.section.line.length
    if station is None or width is None or station - WIDTHS * width <= length:
        return None
    return f"station {station * 1e3:,.0f} mm lies beyond the meridian, which ends {length * 1e3:.4g} mm from the crown"


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


class OfSensor(Effect):
    """An effect on the thermocouple that ``sensor`` names."""

    sensor: Annotated[Text, Field(description="name of the sensor", examples=["crown-inner"])]

    @property
    def choice(self) -> dict[str, str]:
        """The sensor's name."""
        return {"sensor": self.sensor}

    @classmethod
    def refusal(cls, study: StudyOfTyre) -> str | None:
        """A study without sensors."""
        return None if study.sensors else "the study has no sensors"

    def problem(self, study: StudyOfTyre) -> str | None:
        """A sensor that the study does not have."""
        if self.refusal(study) is None and self.sensor not in study.sensors:
            return f"the study has no sensor '{self.sensor}'{nearest(self.sensor, study.sensors)}"
        return self.refusal(study)

    @classmethod
    def variants(cls, study: StudyOfTyre) -> tuple[Mapping[str, str], ...]:
        """One for every sensor."""
        return tuple({"sensor": name} for name in study.sensors)


def needs_lumped_rim(study: StudyOfTyre) -> str | None:
    """Why heat into the rim does nothing in a study; None: its rim is lumped."""
    lumped = study.card.boundaries.rim.law == "lumped"
    return None if lumped else "only a lumped rim takes up heat; use 'brake-heat'"


def half_width(tyre: Tyre) -> tuple[float, float]:
    """z of the two shoulders on the meridian, m."""
    line = tyre.study.section.line
    z = float(line.position([line.shoulder_s])[0, 1])
    return -z, z


def needs_full(study: StudyOfTyre) -> str | None:
    """Why an effect that tells the sides apart has no meaning in a study."""
    return None if study.card.mesh.section == "full" else "needs the full section: [mesh] section = 'full'"
