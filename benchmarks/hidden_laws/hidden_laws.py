"""Causes that no entry of the catalogue is: what `missing_heat_laws.py` hides in its data. Amplitudes are made up."""

from typing import Annotated, ClassVar

import numpy as np

from tyrefem.effects import Effect, Prior


def deflection_ratio(tyre, t):
    """D over the deflection at rated load and pressure."""
    return tyre.schedule.mean(lambda case: case.deflection, t) / tyre.rated_deflection


class PayneLoss(Effect):
    """q -> q (1 + gain (f/f_rated - 1)), f = 2 x/(1 + x^2), x = D/(0.4 D_rated): loss falls with strain (Kraus)."""

    name: ClassVar[str] = "hidden-payne"
    family: ClassVar[str] = "heat"
    sentence: ClassVar[str] = "tan delta falls with the strain amplitude."
    source: ClassVar[str] = "made up; the form: Kraus 1984"
    gain: Annotated[float, Prior("1", "share of the Payne effect", 1.0, -2.0, 2.0)] = 0.0

    def heat_factor(self, tyre, zone, x, t, T):
        """The loss over that at the rated deflection."""
        strain = deflection_ratio(tyre, t) / 0.4
        return 1 + self.gain * (2 * strain / (1 + strain**2) / (5.0 / 7.25) - 1)


class LateDelamination(Effect):
    """q -> q + heat (v/10 m/s) (D/D_rated)^2 exp(-((s - 97 mm)/9 mm)^2/2) in the carcass, from 300 s on."""

    name: ClassVar[str] = "hidden-delamination"
    family: ClassVar[str] = "heat"
    sentence: ClassVar[str] = "Plies rub on each other after they have come apart."
    source: ClassVar[str] = "made up"
    heat: Annotated[float, Prior("W/m**3", "friction heat", 1e5, 0.0, 1e7)] = 0.0

    def heat_addend(self, tyre, zone, x, t, T):
        """W/m3."""
        if t < 300.0 or tyre.speed(t) == 0 or tyre.region(zone) != "carcass":
            return 0.0
        s, _ = tyre.places(x)
        size = self.heat * tyre.speed(t) / 10.0 * deflection_ratio(tyre, t) ** 2
        return size * np.exp(-(((s - 0.097) / 0.009) ** 2) / 2)


class TreadEvaporation(Effect):
    """q = -film (v/10 m/s)^0.8 x deficit out of the rolling tread, until it is dry; deficit = L (w_s - w)/c_p.

    Air of 25 degC and 30 % humidity lacks w_s - w = 0.0142 of water: 35 K. The excess of the wet tread over the air, a
    few kelvin, is neglected. A film of 60 W/m2/K takes away 2.1 kW/m2, or 0.9 g/m2/s of water.
    """

    name: ClassVar[str] = "hidden-evaporation"
    family: ClassVar[str] = "boundary"
    surfaces: ClassVar[tuple[str, ...]] = ("road",)
    jumps: ClassVar[tuple[float, ...]] = (400.0,)
    sentence: ClassVar[str] = "Water on the tread evaporates while it lasts."
    source: ClassVar[str] = "made up; Lewis relation; w_s = 0.0201 at 25 degC, L = 2.44 MJ/kg (handbook values)"
    DEFICIT: ClassVar[float] = 35.0
    film: Annotated[float, Prior("W/m**2/K", "film of the tread at 10 m/s", 60.0, 0.0, 1e3)] = 0.0

    def flux(self, tyre, surface, x, t):
        """W/m2."""
        if tyre.speed(t) == 0 or t >= self.jumps[0]:
            return 0.0
        return -self.film * (tyre.speed(t) / 10.0) ** 0.8 * self.DEFICIT


class BeltEdgeLaw(Effect):
    """q -> q + heat (v/10 m/s)^1.8 (load/15 kN)^0.7 exp(-((s - 0.95 s_shoulder)/8 mm)^2/2 - (y/2.5 mm)^2/2)."""

    name: ClassVar[str] = "hidden-belt-edge"
    family: ClassVar[str] = "heat"
    sentence: ClassVar[str] = "A belt edge heats by a law that is not in the catalogue."
    source: ClassVar[str] = "made up; the place is that of belt-edge-shear"
    heat: Annotated[float, Prior("W/m**3", "heat at the edge", 1e5, 0.0, 1e7)] = 0.0

    def heat_addend(self, tyre, zone, x, t, T):
        """W/m3."""
        if tyre.speed(t) == 0 or tyre.region(zone) == "bead":
            return 0.0
        section, (s, depth) = tyre.study.section, tyre.places(x)
        along = (s - 0.95 * section.line.shoulder_s) / 8e-3
        across = (section.midline_offset(s, depth) - section.thickness("carcass", s) / 2) / 2.5e-3
        load = tyre.schedule.mean(lambda case: case.load, t) / 15e3
        return self.heat * (tyre.speed(t) / 10.0) ** 1.8 * load**0.7 * np.exp(-(along**2 + across**2) / 2)
