"""A study's tyre that turns: spun by its speed, pressed on the road with inertia, and lagging by its loss."""

from __future__ import annotations

import functools
import warnings
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.errors import InputError, ResultWarning
from tyrefem.inputs.motion import Motion
from tyrefem.materials.card import strain_laws
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.footprint import Footprint
from tyrefem.mechanics.footprint.strain_amplitude import StrainAmplitude
from tyrefem.mechanics.footprint.strain_harmonics import StrainHarmonics
from tyrefem.mechanics.rolling.free_rolling import FreeRollingResistance, LossyTyre, rolling_resistance
from tyrefem.mechanics.rolling.lagging_strains import LaggingFootprint
from tyrefem.mechanics.rolling.lossy_harmonics import LossyHarmonics

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData
    from tyrefem.mechanics.footprint.press_order import PressOrder
    from tyrefem.mechanics.solid.inflation import Inflation

Array = NDArray[np.float64]
#: Harmonics of the footprint that gives the first rolling radius.
ROUGH = 24
#: Harmonics at which resistance by offset and by loss agree within 1 %.
RESISTANCE_HARMONICS = 180
#: Relative difference of the two resistances above which they are in doubt: waves too short for the mesh.
DOUBTFUL = 0.03
#: Words of the error of a harmonic without positive stiffness.
UNSTABLE = "not stable"


@dataclass(frozen=True, eq=False)
class Turning(Brief):
    """A tyre that turns at a speed on its road. Made by `turn`.

    Parameters
    ----------
    tyre : inflated and spinning. footprint : with inertia. path, path_harmonics : load steps in large motion.
    still_growth : radius growth of the tyre at rest under the same pressure, m.
    speed : of the tread, m/s.
    lossy : the tyre with its complex stiffness; None in large motion, which has inertia but no lag.
    """

    study: StudyData
    tyre: Inflation
    pressing: Pressing
    footprint: Footprint
    speed: float
    still_growth: float
    lossy: LossyTyre | None = None
    path: tuple[tuple[float, float], ...] = ()
    path_harmonics: tuple[int, ...] = ()

    @functools.cached_property
    def cycle(self) -> StrainHarmonics:
        """Strains over a revolution; with their lag in linear motion."""
        return cycle_of(self.footprint)

    @functools.cached_property
    def resistance(self) -> FreeRollingResistance | None:
        """Rolling resistance by offset and by loss; None in large motion.

        Also None, with a warning, beyond the critical speed of the tread's short waves.
        """
        if self.lossy is None:
            return None
        harmonics = max(RESISTANCE_HARMONICS, self.footprint.harmonics)
        deflection = cast("LaggingFootprint", self.footprint).lagging.deflection
        try:
            return rolling_resistance(self.lossy, harmonics, deflection)
        except InputError as error:
            _warn_of(self.speed, f"{harmonics} harmonics: {error.message}")
            return None

    @property
    def centrifugal_growth(self) -> float:
        """Growth of the largest radius by spin, m."""
        return self.tyre.radius_growth - self.still_growth

    def summary(self) -> dict[str, Any]:
        """Results in SI as the keys state; None where the motion is large."""
        resistance = self.resistance
        return {
            "angular_speed_rad_s": self.tyre.angular_speed,
            "centrifugal_growth_m": self.centrifugal_growth,
            "pressure_offset_m": resistance and resistance.offset,
            "rolling_resistance_by_offset_N": resistance and resistance.by_offset,
            "rolling_resistance_by_loss_N": resistance and resistance.by_loss,
            "rolling_resistance_balance": resistance and resistance.balance,
        }

    @property
    def words(self) -> str:
        """One line: growth, offset, resistance both ways."""
        spin = f"{self.tyre.angular_speed:.4g} rad/s: radius {1e3 * self.centrifugal_growth:+.2f} mm by spin"
        resistance = self.resistance
        if resistance is None and self.lossy is not None:
            return f"{spin}; beyond the critical speed of the tread's short waves: no resistance by offset"
        if resistance is None:
            return f"{spin}; pressure without offset in large motion"
        doubt = f" (in doubt: {resistance.balance:+.0%})" if abs(resistance.balance) > DOUBTFUL else ""
        return (
            f"{spin}; pressure {1e3 * resistance.offset:.2f} mm to the front; resistance {resistance.by_offset:.1f} N "
            f"by offset, {resistance.by_loss:.1f} N by loss{doubt}"
        )


def cycle_of(footprint: Footprint) -> StrainHarmonics:
    """Strains over a revolution of a footprint, with their lag if it has one."""
    return footprint.cycle if isinstance(footprint, LaggingFootprint) else StrainHarmonics(footprint)


def turn(order: PressOrder, speed: float) -> Turning:
    """Spin a study's tyre, press it on the road with inertia and, in linear motion, let it lag by its loss.

    W = speed / rolling radius, first of the free tyre, then of a rough linear footprint. tan delta is that of the cards
    at each harmonic's frequency and the temperature of the regions where the study has these, else the drive's initial
    one; where cards depend on strain, with the loss modulus at each point's amplitude.

    Parameters
    ----------
    order : study, mesh, pressure, road, load or deflection, tolerance; in large motion with inertia but without lag.
    speed : of the tread through the footprint, m/s, positive.

    Raises
    ------
    InputError : no equilibrium; a load that the tyre cannot carry; a speed at which the tread itself is not stable.
    """
    from tyrefem.mechanics.solid.inflation import inflate, spin

    study, mesh, pressure, road, load = order.study, order.mesh, order.pressure, order.road, order.load
    still = inflate(study, pressure, mesh)
    try:
        spinning = spin(study, still, _spin(speed, float(still.places[0].max())))
        rough = Pressing(spinning.state, road)
        first = rough.at_load(load, ROUGH) if load is not None else rough.at_deflection(order.deflection or 0.0, ROUGH)
        tyre = spin(study, still, _spin(speed, first.rolling_radius))
    except InputError as error:
        raise _beyond(speed, error) if error.field == "speed" else error from None
    pressing = Pressing(tyre.rolling_state, road)
    if order.large:
        from tyrefem.mechanics.footprint.harmonic_balance import Balance

        balance = Balance(pressing)
        try:
            footprint = balance.solve(**order.wanted)
        except InputError as error:
            raise _beyond(speed, error) if UNSTABLE in error.message else error from None
        _warn(speed, footprint)
        path = (tuple(balance.path), tuple(balance.path_harmonics))
        return Turning(study, tyre, pressing, footprint, speed, still.radius_growth, None, *path)
    try:
        footprint = pressing.solve(**order.wanted)
        _warn(speed, footprint)
    except InputError as error:
        if UNSTABLE not in error.message:
            raise
        # Loss alone limits such waves: the contact without inertia stands in for that without loss.
        footprint = Pressing(tyre.state, road).solve(**order.wanted)
        _warn_of(speed, error.message)
    lossy = LossyTyre(pressing.state, road, lossy_harmonics(study, tyre, footprint))
    try:
        if load is None:
            lagging = lossy.at_deflection(footprint.deflection, footprint.harmonics)
        else:
            lagging = lossy.at_load(load, footprint.harmonics, footprint.deflection)
    except InputError as error:
        raise _beyond(speed, error) from None
    parts = {part.name: getattr(footprint, part.name) for part in fields(Footprint)}
    lagging_footprint = LaggingFootprint(**parts, rolling=lagging, travel=speed / tyre.angular_speed)
    return Turning(study, tyre, pressing, lagging_footprint, speed, still.radius_growth, lossy)


def _beyond(speed: float, error: InputError) -> InputError:
    return InputError(
        f"{speed:.4g} m/s are beyond a critical speed of the tyre ({error.message}); "
        "`tyrefem press --critical-speed` gives it",
        field="speed",
    )


def _warn(speed: float, footprint: Footprint) -> None:
    if footprint.unstable:
        many = f"{min(footprint.unstable)} to {max(footprint.unstable)}"
        _warn_of(speed, f"harmonics {many}; {footprint.unstable_place}")


def _warn_of(speed: float, where: str) -> None:
    warnings.warn(
        f"{speed:.4g} m/s are beyond the critical speed of waves that only loss limits ({where})",
        ResultWarning,
        stacklevel=3,
    )


def _spin(speed: float, radius: float) -> float:
    return 2 * np.pi * Motion(speed, rolling_radius=radius).revolutions_per_second


def lossy_harmonics(study: StudyData, tyre: Inflation, footprint: Footprint) -> LossyHarmonics:
    """The complex stiffness of a spinning tyre by its cards; ``footprint`` gives the strain amplitudes."""
    state = tyre.rolling_state
    laws = strain_laws(study.materials)
    moduli = state.storage
    if laws:
        lossiness = StrainAmplitude(StrainHarmonics(footprint), laws).lossiness
        rubber = state.storage if state.rubber is None else state.rubber
        moduli = state.storage + (lossiness - 1) * rubber
    tangents = CardTangents(study, tyre)
    return LossyHarmonics(state, angular_speed=tyre.angular_speed, tangents=tangents, dissipating=moduli)


@dataclass(frozen=True, eq=False)
class CardTangents(Brief):
    """tan delta of the cards at the regions' temperatures, or at the drive's initial one."""

    study: StudyData
    tyre: Inflation

    def __call__(self, frequency: float) -> Array:
        """(n_elements,) tan delta at a frequency, Hz."""
        temperatures = self.study.parts.temperatures or {}
        tangent = np.zeros(len(self.tyre.body.rings.weights))
        for region in self.tyre.body.parts:
            warm = np.asarray(temperatures.get(region, self.study.card.drive.initial), dtype=float)
            law = self.study.materials[region].loss_tangent.over_frequency
            tangent[self.tyre.body.mesh.subdomains[region]] = law(frequency, warm)
        return tangent
