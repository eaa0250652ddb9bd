"""A study's tyre on its road with friction, before it rolls."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.brief import Brief
from tyrefem.errors import InputError
from tyrefem.inputs.drive import FASTEST
from tyrefem.mechanics.footprint.compliance import TreadCompliance
from tyrefem.mechanics.footprint.press import Pressed
from tyrefem.mechanics.rolling.loaded_compliance import LoadedCompliance
from tyrefem.mechanics.rolling.loaded_tyre import TyreOnFootprint
from tyrefem.mechanics.rolling.press import press
from tyrefem.mechanics.rolling.pressed_shape import PressedShape
from tyrefem.mechanics.rolling.rolled import RolledTyre
from tyrefem.mechanics.rolling.rolling_motion import RollingMotion
from tyrefem.mechanics.rolling.steady_rolling import FrictionLaw, RollingLoads, SteadyRolling
from tyrefem.mechanics.rolling.tread_influence import TreadInfluence
from tyrefem.mechanics.rolling.turning import Turning, lossy_harmonics
from tyrefem.requirements import Requirements
from tyrefem.threads import one_thread

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData
    from tyrefem.materials.road_friction import FrictionOnRoad

#: Requirements of rolling on the study.
NEEDS = Requirements("rolling with friction")
#: Coefficient of friction by default: rubber on dry asphalt. An estimate.
FRICTION = 1.0
#: Least coefficient by which a road holds a tyre that rolls.
LEAST_FRICTION = 1e-3


@dataclass(frozen=True, eq=False)
class WheelOnRoad(Brief):
    """A study's tyre on its road with friction, before it rolls. Made by `wheel_on_road`.

    Parameters
    ----------
    pressed : the tyre without friction and camber.
    rolling : tyre and road with camber and friction.
    load, deflection : given; the other is None. speed : m/s.
    """

    pressed: Pressed
    rolling: SteadyRolling
    load: float | None
    deflection: float | None
    speed: float
    _free: dict[int, RolledTyre] = field(default_factory=dict, init=False, repr=False)

    @property
    def of_one_load(self) -> bool:
        """True if another load needs another tyre: pressed in large motion, moduli at the strains of the load, or a
        tyre that turns."""
        pressed = self.pressed
        return pressed.balanced or pressed.moduli is not None or pressed.turning is not None

    def free(self, harmonics: int) -> RolledTyre:
        """Straight ahead without torque: its travel per radian is the effective rolling radius."""
        if harmonics not in self._free:
            footprint = self.pressed.footprint
            guess = (footprint.deflection, footprint.rolling_radius)
            motion = RollingMotion(speed=self.speed)
            self._free[harmonics] = self.rolling.roll(motion, self.given(torque=0.0), harmonics, guess=guess)
        return self._free[harmonics]

    def given(self, **along: float) -> RollingLoads:
        """The load or deflection, with ``travel``, ``torque`` or ``force``."""
        return RollingLoads(load=self.load, deflection=self.deflection, **along)

    def roll(self, motion: RollingMotion, along: Mapping[str, float], harmonics: int, near: RolledTyre) -> RolledTyre:
        """Rolling with ``slip``, ``torque`` or ``force`` along the road, from a similar state."""
        slip = along.get("slip")
        if slip is not None:
            travel = self.free(harmonics).travel / ((1 + slip) * math.cos(motion.slip_angle))
            return self.rolling.roll(motion, self.given(travel=travel), harmonics, near)
        return self.rolling.roll(motion, self.given(**along), harmonics, near)

    def slip(self, rolled: RolledTyre) -> float:
        """Longitudinal slip of a rolling tyre: spin times rolling radius over forward speed, less 1."""
        forward = rolled.travel * math.cos(rolled.motion.slip_angle)
        return float(self.free(rolled.harmonics).travel / forward - 1)


def road_region(mesh: Any, boundary: str = "road") -> str:
    """The region of a section's mesh that meets the road at its tread's boundary."""
    on_road = mesh.f2t[0, np.asarray(mesh.boundaries[boundary])]
    shares = {name: int(np.isin(on_road, members).sum()) for name, members in mesh.subdomains.items()}
    return max(shares, key=lambda name: shares[name])


def friction_card(pressed: Pressed) -> FrictionOnRoad | None:
    """Friction of the card of the region that meets the road."""
    state = pressed.tyre.state
    return pressed.study.materials[road_region(state.mesh, state.tread)].friction


def tread_friction(pressed: Pressed, temperature: float | None = None) -> float | FrictionLaw:
    """Friction of the card of the region that meets the road, at a temperature of the tread, degC, by default the
    drive's initial one; without ``[friction]`` `FRICTION`."""
    law = friction_card(pressed)
    if law is None:
        return FRICTION
    if law.single is not None:
        return law.single
    warm = float(pressed.study.card.drive.initial) if temperature is None else temperature
    return lambda speed, pressure: law(speed, pressure, warm)


@one_thread()
def wheel_on_road(
    study: StudyData,
    *,
    camber: float = 0.0,
    friction: float | FrictionLaw | None = None,
    speed: float | None = None,
    load: float | None = None,
    deflection: float | None = None,
    motion: str = "linear",
    **pressing: Any,
) -> WheelOnRoad:
    """Inflate and press a study's tyre; defaults are values at the start of the drive's first phase.

    With ``[mechanics] rolling = true`` the tyre spins: centrifugal growth, inertia and loss.

    ``pressing``: ``pressure``, Pa, and ``drum_diameter``, m, as in `press`.

    Raises
    ------
    InputError : errors of `press`; a friction below `LEAST_FRICTION`; a speed that is not positive, or above 400 m/s.
    """
    NEEDS.check(study)
    if speed is not None and not speed > 0:
        raise InputError(f"must be more than 0 m/s, not {speed:g} m/s", field="speed")
    if speed is not None and speed > FASTEST:
        raise InputError(f"must be at most {FASTEST:g} m/s, not {speed:g} m/s", field="speed")
    if isinstance(friction, int | float) and not friction >= LEAST_FRICTION:
        raise InputError(
            f"must be at least {LEAST_FRICTION:g}, not {friction:g}: less holds no rolling tyre", field="friction"
        )
    pressed = press(study, speed=speed, load=load, deflection=deflection, motion=motion, **pressing)
    phase = study.card.drive.phases[0]
    if load is None and deflection is None:
        load = None if phase.load is None else phase.load.start
    deflection = pressed.footprint.deflection if load is None else None
    law = tread_friction(pressed) if friction is None else friction
    rolling = SteadyRolling(pressed.pressing, camber, law, _lossy_points(pressed))
    if pressed.balanced:
        elastic = TreadInfluence(pressed.pressing.tread) if rolling.points.lossy else None
        loaded = LoadedCompliance(TyreOnFootprint(pressed.footprint, elastic or rolling.points))
        rolling = replace(rolling, shape=PressedShape(pressed.footprint, elastic, loaded))
    return WheelOnRoad(pressed, rolling, load, deflection, speed or pressed.speed or 1.0)


def _lossy_points(pressed: Pressed) -> TreadInfluence | None:
    """Points of the tread with the loss of a tyre that turns; None: it stands while it is pressed.

    In large motion the loss is that of small motion about the inflated tyre under the forces of the contact.
    """
    turning = pressed.turning
    if not isinstance(turning, Turning):
        return None
    if turning.lossy is not None:
        return TreadInfluence(turning.lossy.tread)
    return TreadInfluence(TreadCompliance(lossy_harmonics(pressed.study, pressed.tyre, pressed.footprint)))
