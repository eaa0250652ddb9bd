"""A tyre of a size under pressure and on a flat road: what `measured.py` compares with measurements."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

import tyrefem as tf
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.footprint import Footprint
from tyrefem.mechanics.footprint.harmonic_balance import Balance
from tyrefem.mechanics.footprint.loss import RevolutionLoss
from tyrefem.mechanics.footprint.pressed_tyre import mechanical_mesh
from tyrefem.mechanics.footprint.secant_moduli import SecantModuli, under_load
from tyrefem.mechanics.footprint.strain_harmonics import StrainHarmonics
from tyrefem.mechanics.footprint.tyre_on_road import FLAT
from tyrefem.mechanics.solid.inflation import Inflation, inflate

Array = NDArray[np.float64]
#: Highest harmonic in linear motion, in large motion and of its contact, and tolerance of a balance.
LINEAR, LARGE, CONTACT, TOLERANCE = 96, 24, 120, 1e-3
#: Speed, m/s, and rubber temperatures, degC, of the rolling resistance.
SPEED, TEMPERATURES = 60 / 3.6, (20.0, 50.0)


@dataclass(frozen=True, eq=False)
class Tyre:
    """A study's tyre under a pressure, Pa, with changes by dotted names.

    Parameters
    ----------
    amplitudes : region -> shear strain amplitude whose modulus its compound has; without a region: that of the card.
    harmonics, contact, linear_harmonics : highest in large motion, of its contact, and in linear motion.
    """

    study_file: str
    changes: Mapping[str, Any]
    pressure: float
    amplitudes: Mapping[str, float] = field(default_factory=dict)
    harmonics: int = LARGE
    contact: int = CONTACT
    linear_harmonics: int = LINEAR
    _footprints: dict[tuple[str, float], Footprint] = field(default_factory=dict, init=False, repr=False)

    @cached_property
    def cards_study(self) -> Any:
        """The study with its changes and the cards' moduli."""
        return tf.study(self.study_file, dict(self.changes))

    @cached_property
    def study(self) -> Any:
        """The study with its changes and the moduli of the amplitudes."""
        return self.cards_study.at_amplitudes(self.amplitudes) if self.amplitudes else self.cards_study

    def secant_moduli(self, load: float) -> SecantModuli:
        """Amplitudes of the regions under a load, N, and the moduli there over those of the cards."""
        return under_load(self.study, mechanical_mesh(self.study), self.pressure, FLAT, load=load)[1]

    @cached_property
    def inflation(self) -> Inflation:
        """The inflated tyre."""
        return inflate(self.study, self.pressure, mechanical_mesh(self.study))

    @cached_property
    def pressing(self) -> Pressing:
        """The inflated tyre and its road."""
        return Pressing(self.inflation.state)

    @cached_property
    def balance(self) -> Balance:
        """The solver in large motion."""
        return Balance(self.pressing, self.harmonics, self.contact, TOLERANCE)

    def footprint(self, motion: str, load: float) -> Footprint:
        """The footprint under a load, N, in ``large`` or ``linear`` motion; kept."""
        if (motion, load) not in self._footprints:
            at_load = (
                self.balance.solve(load=load)
                if motion == "large"
                else self.pressing.at_load(load, self.linear_harmonics)
            )
            self._footprints[motion, load] = at_load
        return self._footprints[motion, load]

    @cached_property
    def mass(self) -> float:
        """Mass of the tyre as drawn, kg: density times volume of each region's elements."""
        elements = self.inflation.body.rings
        both, total = 2.0 if self.study.section.half else 1.0, 0.0
        for region in self.inflation.body.parts:
            density = self.study.materials[region].density.law()
            volume = 2 * np.pi * float(elements.weights[elements.mesh.subdomains[region]].sum())
            total += both * volume * (density(20.0) if callable(density) else density)
        return total

    def loss(self, footprint: Footprint, temperature: float) -> RevolutionLoss:
        """Energy lost per revolution, every harmonic at its frequency, all rubber at one temperature, degC."""
        cards = {region: self.study.materials[region] for region in self.inflation.body.parts}
        return RevolutionLoss.of_cards(StrainHarmonics(footprint), cards, SPEED, temperature)

    def pressed(self, motion: str, load: float) -> dict[str, float]:
        """What is compared, under a load, N, in the units of the tables."""
        footprint = self.footprint(motion, load)
        losses = {temperature: self.loss(footprint, temperature) for temperature in TEMPERATURES}
        return {
            "deflection [mm]": footprint.deflection * 1e3,
            "stiffness [N/mm]": footprint.stiffness / 1e3,
            "length [mm]": footprint.length * 1e3,
            "width [mm]": 2 * outline(footprint)[:, 0].max() * 1e3,
            "gross area [cm2]": gross_area(footprint) * 1e4,
            "net area [cm2]": footprint.area * 1e4,
            "loaded radius [mm]": footprint.loaded_radius * 1e3,
            "rolling radius [mm]": footprint.rolling_radius * 1e3,
            "growth [mm]": self.inflation.radius_growth * 1e3,
            "mass [kg]": self.mass,
            **{f"rolling resistance at {t:.0f} degC": loss.coefficient for t, loss in losses.items()},
        }


def outline(footprint: Footprint) -> Array:
    """(k, 2) points (z, half length) of the contact's edge on one side, m: pressure is linear between nodes.

    Beyond the outermost node in contact, the contact ends where the greatest pressure of its rib, drawn on, is zero.
    """
    z, half = footprint.grid.tread.places[1], footprint.half_lengths
    order = np.argsort(z)
    z, half, greatest = z[order], half[order], footprint.pressure.max(axis=0)[order]
    inside = np.flatnonzero(half > 0)
    points = [(z[node], half[node]) for node in inside]
    last = inside[-1]
    if last + 1 < len(z) and not np.any(_between(footprint.grid.tread.grooves, z[last], z[last + 1])):
        falls = greatest[last - 1] - greatest[last]
        share = min(greatest[last] / falls, 1.0) if falls > 0 else 0.5
        reach = min(share * (z[last] - z[last - 1]), z[last + 1] - z[last])
        points.append((z[last] + reach, 0.0))
    return np.array(points)


def _between(grooves: Array, low: float, high: float) -> NDArray[np.bool_]:
    return np.asarray((grooves[:, 0] >= low - 1e-6) & (grooves[:, 1] <= high + 1e-6))


def gross_area(footprint: Footprint) -> float:
    """Area of the convex hull of the contact, m2, as of an ink print."""
    from scipy.spatial import ConvexHull

    z, half = outline(footprint).T
    corners = np.concatenate([np.stack([side * z, end * half], axis=1) for side in (1, -1) for end in (1, -1)])
    return float(ConvexHull(corners).volume)


def pressure_quarter(footprint: Footprint) -> list[dict[str, float]]:
    """Contact pressure on one quarter of the footprint: x along the road, z along the axle, mm, and kPa."""
    from tyrefem.reports.figures.footprint import pressure_map

    x, z, pressure = pressure_map(footprint)
    ends = x[np.flatnonzero(pressure.any(axis=0))[-1] + 1] if pressure.any() else 0.0
    return [
        {"x [mm]": float(x[i]) * 1e3, "z [mm]": float(z[j]) * 1e3, "pressure [kPa]": float(pressure[j, i]) / 1e3}
        for i in np.flatnonzero((x >= 0) & (x <= ends))
        for j in np.flatnonzero(z >= 0)
    ]
