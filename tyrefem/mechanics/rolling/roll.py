"""A study's tyre in steady rolling with friction: the results of the command `tyrefem roll`."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.brief import Brief
from tyrefem.errors import InputError
from tyrefem.inputs.study_plugins import plugin_summary
from tyrefem.mechanics.footprint.contact import LADDER
from tyrefem.mechanics.rolling.rolled import RolledTyre
from tyrefem.mechanics.rolling.rolling_motion import RollingMotion
from tyrefem.mechanics.rolling.wheel_on_road import WheelOnRoad, wheel_on_road
from tyrefem.threads import one_thread

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData

#: Allowed change of the horizontal force with the number of harmonics.
TOLERANCE = 0.05
#: Numbers of harmonics, tried in turn; the first is only compared with.
HARMONICS = tuple(count for count in LADDER if 54 <= count <= 120)
#: Horizontal forces below this share of the load count as no larger.
SMALL_FORCE = 0.02
#: Slip angle, rad, and slip at which stiffnesses are taken, on both sides of zero.
SMALL_ANGLE, SMALL_SLIP = math.radians(0.5), 5e-3
#: Side force over load from which camber counts as pushing to the wrong side: more than the error of the contact.
WRONG = 2e-3


@dataclass(frozen=True, eq=False)
class RolledStudy(Brief):
    """A study's tyre in steady rolling. Made by `roll`.

    Parameters
    ----------
    wheel : tyre and road. state : the rolling tyre. error : change of the horizontal force against fewer harmonics.
    """

    wheel: WheelOnRoad
    state: RolledTyre
    error: float

    def _title(self) -> str:
        return f"tyre of {self.study.name}"

    def _facts(self) -> Mapping[str, Any]:
        return self.state._facts()

    @property
    def study(self) -> StudyData:
        """The study."""
        return self.wheel.pressed.study

    @property
    def slip(self) -> float:
        """Longitudinal slip; positive: driven."""
        return self.wheel.slip(self.state)

    @property
    def rolling_radius(self) -> float:
        """Effective rolling radius: travel per radian straight ahead without torque, m."""
        return self.wheel.free(self.state.harmonics).travel

    @property
    def warnings(self) -> tuple[str, ...]:
        """What a reader of the forces must know, one line each."""
        return camber_warnings(self.wheel, self.state.harmonics)

    def summary(self) -> dict[str, Any]:
        """All results in SI as the keys state, with versions."""
        from tyrefem.output import versions

        pressed, rolling = self.wheel.pressed, self.wheel.rolling
        friction = rolling.friction
        return {
            "study": self.study.name,
            "title": self.study.title,
            "pressure_Pa": pressed.tyre.pressure,
            "drum_diameter_m": rolling.road.drum_diameter,
            "camber_rad": rolling.camber,
            "friction": None if callable(friction) else friction,
            **row(self.wheel, self.state),
            "effective_rolling_radius_m": self.rolling_radius,
            "loaded_radius_m": self.state.loaded_radius,
            "rings_friction_power_W": {
                "z_m": self.state.grid.influence.places[1].tolist(),
                "power_W": self.state.power_by_ring.tolist(),
            },
            "power_balance": self.state.balance,
            "rolling_resistance_N": self.state.rolling_resistance,
            "rolling_resistance_coefficient": self.state.rolling_resistance / float(self.state.force[2]),
            "harmonics": self.state.harmonics,
            "error": self.error,
            "motion": pressed.footprint.motion,
            "versions": versions(),
            **plugin_summary(self.study),
        }


def pushes_away(camber: float, side_force: float, load: float) -> bool:
    """Whether a side force, N, of camber, rad, is away from the side to which the wheel leans."""
    return side_force * np.sign(camber) < -WRONG * load


def camber_warnings(wheel: WheelOnRoad, harmonics: int) -> tuple[str, ...]:
    """A line where camber alone, straight ahead without torque, pushes the tyre to the wrong side."""
    if not wheel.rolling.camber:
        return ()
    _, side_force, load = map(float, wheel.free(harmonics).force)
    if not pushes_away(wheel.rolling.camber, side_force, load):
        return ()
    return (against_the_lean_words(f"{load:.0f}", wheel.pressed.footprint.motion),)


def against_the_lean_words(loads: str, motion: str) -> str:
    """The warning of loads, N, at which camber pushes the tyre to the wrong side.

    >>> against_the_lean_words("5000", "large")
    'at 5000 N camber pushes the tyre away from the side to which it leans'
    """
    remedy = "; linear motion is too stiff there: take motion large" if motion == "linear" else ""
    return f"at {loads} N camber pushes the tyre away from the side to which it leans{remedy}"


def row(wheel: WheelOnRoad, state: RolledTyre) -> dict[str, float]:
    """Motion, forces, moments, slip and friction power of a rolling tyre, SI as the keys state."""
    (f_x, f_y, f_z), (m_x, m_y, m_z), patch = state.force, state.moment, state.patch
    return {
        "slip_angle_rad": state.motion.slip_angle,
        "slip": wheel.slip(state),
        "turn_slip_1_m": state.motion.turn_slip,
        "speed_m_s": state.motion.speed,
        "F_x_N": float(f_x),
        "F_y_N": float(f_y),
        "F_z_N": float(f_z),
        "M_x_Nm": float(m_x),
        "M_y_Nm": float(m_y),
        "M_z_Nm": float(m_z),
        "torque_Nm": state.torque,
        "deflection_m": state.deflection,
        "travel_m_rad": state.travel,
        "pneumatic_trail_m": state.pneumatic_trail,
        "footprint_length_m": patch.length,
        "footprint_width_m": patch.width,
        "footprint_area_m2": patch.area,
        "mean_contact_pressure_Pa": patch.mean_pressure,
        "peak_contact_pressure_Pa": patch.peak_pressure,
        "sliding_share": state.sliding_share,
        "friction_power_W": state.friction_power,
        "loss_power_W": state.loss_power,
        "axle_power_W": state.lost_power,
    }


@one_thread()
def roll(
    study: StudyData,
    *,
    slip_angle: float = 0.0,
    slip: float | None = None,
    torque: float | None = None,
    axle_force: float | None = None,
    turn_slip: float = 0.0,
    tolerance: float = TOLERANCE,
    **wheel: Any,
) -> RolledStudy:
    """Roll a study's tyre steadily over the road with Coulomb friction.

    Parameters
    ----------
    slip_angle : rad; positive: the wheel moves to its left. turn_slip : curvature of the path, 1/m, positive: left.
    slip, torque, axle_force : at most one of them: longitudinal slip (positive: driven), torque of the axle, N m, or
        force of the road on the tyre forward, N. Without them the wheel rolls freely: no torque.
    tolerance : allowed change of the horizontal force with the number of harmonics.
    wheel : ``camber``, rad (positive: the wheel leans to its left), ``friction``: coefficient, or function of sliding
        speed (m/s) and pressure (Pa), by default that of the tread's card; ``motion``: ``"linear"`` about the inflated
        tyre, or ``"large"``: friction moves the tyre from its footprint in large motion (`PressedShape`);
        ``speed``, m/s; ``pressure``, ``load`` or ``deflection``, ``drum_diameter`` as
        in `press`.

    Raises
    ------
    InputError : errors of `press`; more than one of slip, torque and axle force; values that cannot be meant; a torque
        or force that friction cannot carry.

    >>> from tyrefem import study
    >>> rolled = roll(study("nasa-22x5.5-8pr", {"mesh.size": "12 mm"}), slip_angle=0.02)
    >>> bool(rolled.state.force[1] < 0 < rolled.state.moment[2])
    True
    """
    along = driven(slip, torque, axle_force)
    motion = RollingMotion(slip_angle, turn_slip)
    return settled(wheel_on_road(study, **wheel), motion, along, tolerance)


def driven(slip: float | None, torque: float | None, axle_force: float | None) -> dict[str, float]:
    """What is given along the road, by name; no torque by default.

    Raises
    ------
    InputError : more than one of them; a slip of a locked wheel, or beyond five times the speed.
    """
    given = {
        name: value for name, value in (("slip", slip), ("torque", torque), ("force", axle_force)) if value is not None
    }
    if len(given) > 1:
        raise InputError("give at most one of slip, torque and axle force", field="slip")
    if slip is not None and not -1 < slip <= 5:
        raise InputError(f"a slip of {slip:g} is impossible: more than -1 (locked wheel), at most 5", field="slip")
    return given or {"torque": 0.0}


def settled(wheel: WheelOnRoad, motion: RollingMotion, along: Mapping[str, float], tolerance: float) -> RolledStudy:
    """The rolling tyre with the number of harmonics that the tolerance needs, at most the last of `HARMONICS`."""
    motion = replace(motion, speed=wheel.speed)
    _check_force(wheel, along)
    before: RolledTyre | None = None
    result: RolledStudy | None = None
    for count in HARMONICS:
        state = wheel.roll(motion, along, count, wheel.free(count))
        if before is not None:
            result = RolledStudy(wheel, state, _change(state, before))
            if result.error <= tolerance:
                break
        before = state
    assert result is not None
    return result


def _change(state: RolledTyre, before: RolledTyre) -> float:
    size = max(float(np.linalg.norm(state.force[:2])), SMALL_FORCE * float(state.force[2]))
    return float(np.linalg.norm(state.force[:2] - before.force[:2])) / size


def _check_force(wheel: WheelOnRoad, along: Mapping[str, float]) -> None:
    """Raise an error for a torque or force beyond the friction of a flat road."""
    friction, load = wheel.rolling.friction, wheel.load or wheel.pressed.footprint.load
    if callable(friction):
        return
    most = friction * load
    arms = {"force": (1.0, "N", "axle_force"), "torque": (wheel.rolling.reach, "N m", "torque")}
    for name, (arm, unit, option) in arms.items():
        value = along.get(name)
        if value is not None and abs(value) > most * arm:
            raise InputError(
                f"friction {friction:g} under {load:.5g} N cannot carry {value:.5g} {unit}: "
                f"at most {most * arm:.5g} {unit}",
                field=option,
            )


def swept(
    wheel: WheelOnRoad, motions: Sequence[tuple[RollingMotion, Mapping[str, float]]], harmonics: int
) -> list[RolledTyre]:
    """Rolling tyres, each found from the one before it."""
    states: list[RolledTyre] = []
    for motion, along in motions:
        near = states[-1] if states else wheel.free(harmonics)
        states.append(wheel.roll(replace(motion, speed=wheel.speed), along, harmonics, near))
    return states
