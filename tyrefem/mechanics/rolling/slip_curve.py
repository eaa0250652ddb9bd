"""Forces and moments of a rolling tyre over slip angle or longitudinal slip, with stiffness, trail and peak."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.brief import Brief
from tyrefem.errors import InputError
from tyrefem.inputs.study_plugins import plugin_summary
from tyrefem.mechanics.footprint.natural_frequencies import AMPLITUDE
from tyrefem.mechanics.rolling.roll import (
    SMALL_ANGLE,
    SMALL_SLIP,
    TOLERANCE,
    RolledStudy,
    camber_warnings,
    driven,
    row,
    settled,
    swept,
)
from tyrefem.mechanics.rolling.rolled import RolledTyre
from tyrefem.mechanics.rolling.rolling_motion import RollingMotion
from tyrefem.mechanics.rolling.standing import StandingStiffness, StandingTyre, as_it_rolls
from tyrefem.mechanics.rolling.wheel_on_road import WheelOnRoad, wheel_on_road
from tyrefem.threads import one_thread

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData

#: What may be varied.
VARIED = ("slip_angle", "slip")


@dataclass(frozen=True)
class SlipStiffness:
    """Slopes of the forces at zero slip.

    Parameters
    ----------
    cornering : -dF_y/d(slip angle), N/rad. aligning : dM_z/d(slip angle), N m/rad.
    slip : dF_x/d(slip), N.
    """

    cornering: float
    aligning: float
    slip: float

    @property
    def trail(self) -> float:
        """Pneumatic trail at zero slip, m."""
        return self.aligning / self.cornering


@dataclass(frozen=True, eq=False)
class SlipCurve(Brief):
    """Rolling at several slips. Made by `slip_curve`.

    Parameters
    ----------
    wheel : tyre and road. varied : "slip_angle" or "slip". states : in the given order.
    stiffness : slopes at zero slip. error : of the first state that is not at zero.
    """

    wheel: WheelOnRoad
    varied: str
    states: tuple[RolledTyre, ...]
    stiffness: SlipStiffness
    error: float

    def _title(self) -> str:
        return f"of {self.study.name} over {self.varied.replace('_', ' ')}"

    def _facts(self) -> Mapping[str, Any]:
        peak = self.peak
        where = f"{peak['slip_angle_rad']:.4g} rad" if self.varied == "slip_angle" else f"slip {peak['slip']:.4g}"
        return {
            "cornering stiffness": f"{self.stiffness.cornering / 1e3:.4g} kN/rad",
            "peak": f"{peak['force_N']:.5g} N at {where}",
        }

    @property
    def study(self) -> StudyData:
        """The study."""
        return self.wheel.pressed.study

    @functools.cached_property
    def standing(self) -> StandingStiffness:
        """Longitudinal and lateral stiffness of the standing tyre, where it rolls freely; moduli of small strain."""
        return StandingTyre(self.wheel.pressed, self.wheel.free(self.states[0].harmonics)).stiffness()

    @functools.cached_property
    def relaxation_lengths(self) -> tuple[float, float]:
        """Of the longitudinal and the lateral force, m: the way in which a force that went on rising as at first would
        reach its steady value after a small step of slip.

        Slope over slip / stiffness of the contact that sticks, both with the moduli of the revolution (Pacejka 2012).
        """
        stiffness = as_it_rolls(self.wheel.free(self.states[0].harmonics))
        return self.stiffness.slip / stiffness.longitudinal, self.stiffness.cornering / stiffness.lateral

    @property
    def warnings(self) -> tuple[str, ...]:
        """What a reader of the forces must know, one line each."""
        return camber_warnings(self.wheel, self.states[0].harmonics)

    @property
    def table(self) -> Any:
        """pandas DataFrame of `roll.row`."""
        import pandas as pd

        return pd.DataFrame([row(self.wheel, state) for state in self.states])

    @property
    def peak(self) -> dict[str, float]:
        """Largest force along the varied direction, N, and the slip or slip angle where it is."""
        component, key = (1, "slip_angle_rad") if self.varied == "slip_angle" else (0, "slip")
        forces = np.array([state.force[component] for state in self.states])
        at = int(np.abs(forces).argmax())
        return {"force_N": float(abs(forces[at])), key: row(self.wheel, self.states[at])[key]}

    def summary(self) -> dict[str, Any]:
        """Stiffness, trail, peak and all points, SI as the keys state."""
        from tyrefem.output import versions

        rolling = self.wheel.rolling
        friction = rolling.friction
        return {
            "study": self.study.name,
            "title": self.study.title,
            "pressure_Pa": self.wheel.pressed.tyre.pressure,
            "drum_diameter_m": rolling.road.drum_diameter,
            "camber_rad": rolling.camber,
            "friction": None if callable(friction) else friction,
            "varied": self.varied,
            "cornering_stiffness_N_rad": self.stiffness.cornering,
            "aligning_stiffness_Nm_rad": self.stiffness.aligning,
            "slip_stiffness_N": self.stiffness.slip,
            "pneumatic_trail_m": self.stiffness.trail,
            "longitudinal_relaxation_length_m": self.relaxation_lengths[0],
            "relaxation_length_m": self.relaxation_lengths[1],
            "standing_longitudinal_stiffness_N_m": self.standing.longitudinal,
            "standing_lateral_stiffness_N_m": self.standing.lateral,
            "standing_strain_amplitude": AMPLITUDE,
            "effective_rolling_radius_m": self.wheel.free(self.states[0].harmonics).travel,
            "peak": self.peak,
            "points": [row(self.wheel, state) for state in self.states],
            "harmonics": self.states[0].harmonics,
            "error": self.error,
            "motion": self.wheel.pressed.footprint.motion,
            "versions": versions(),
            **plugin_summary(self.study),
        }


def slip_stiffness(wheel: WheelOnRoad, harmonics: int) -> SlipStiffness:
    """Slopes at zero slip, by differences between small slips on both sides."""
    near = wheel.free(harmonics)
    left, right = (
        wheel.roll(RollingMotion(angle, speed=wheel.speed), {"torque": 0.0}, harmonics, near)
        for angle in (SMALL_ANGLE, -SMALL_ANGLE)
    )
    drive, brake = (
        wheel.roll(RollingMotion(speed=wheel.speed), {"slip": slip}, harmonics, near)
        for slip in (SMALL_SLIP, -SMALL_SLIP)
    )
    force, moment = left.force - right.force, left.moment - right.moment
    return SlipStiffness(
        float(-force[1] / (2 * SMALL_ANGLE)),
        float(moment[2] / (2 * SMALL_ANGLE)),
        float((drive.force - brake.force)[0] / (2 * SMALL_SLIP)),
    )


@one_thread()
def slip_curve(
    study: StudyData,
    *,
    slip_angle: float | Sequence[float] = 0.0,
    slip: float | Sequence[float] | None = None,
    torque: float | None = None,
    axle_force: float | None = None,
    turn_slip: float = 0.0,
    tolerance: float = TOLERANCE,
    **wheel: Any,
) -> SlipCurve:
    """Roll a study's tyre at several slip angles (rad) or several slips; options as in `roll`.

    The number of harmonics is the first point's that is not at zero; each point starts from the one before.

    Raises
    ------
    InputError : errors of `roll`; not exactly one of slip angle and slip is a list.

    >>> from tyrefem import study
    >>> curve = slip_curve(study("nasa-22x5.5-8pr", {"mesh.size": "12 mm"}), slip_angle=[0.0, 0.02, 0.2])
    >>> curve.stiffness.trail > 0 and curve.peak["slip_angle_rad"] == 0.2
    True
    """
    angles, slips = _listed(slip_angle), _listed(slip)
    if (angles is None) == (slips is None):
        raise InputError("vary exactly one of slip angle and slip", field="slip_angle")
    varied = "slip" if angles is None else "slip_angle"
    points = []
    for value in slips or angles or ():
        angle, along = (slip_angle, value) if varied == "slip" else (value, slip)
        points.append((RollingMotion(float(angle), turn_slip), driven(along, torque, axle_force)))  # type: ignore[arg-type]
    if not points:
        raise InputError("give at least one value", field=varied)
    on_road = wheel_on_road(study, **wheel)
    values = np.array(slips or angles, dtype=float)
    first = int(np.flatnonzero(values)[0]) if values.any() else 0
    checked: RolledStudy = settled(on_road, *points[first], tolerance)
    harmonics = checked.state.harmonics
    states = swept(on_road, points, harmonics)
    return SlipCurve(on_road, varied, tuple(states), slip_stiffness(on_road, harmonics), checked.error)


def _listed(values: float | Sequence[float] | None) -> list[float] | None:
    return None if values is None or np.ndim(values) == 0 else [float(value) for value in np.asarray(values)]
