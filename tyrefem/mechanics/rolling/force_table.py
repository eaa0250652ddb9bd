"""Forces of a rolling tyre over load, slip, slip angle and camber, and the Magic Formula that fits them."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from numbers import Integral
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.brief import Brief
from tyrefem.errors import InputError
from tyrefem.materials.cord_layers import masses
from tyrefem.mechanics.footprint.contact import LADDER
from tyrefem.mechanics.rolling.roll import HARMONICS, driven, pushes_away, row, swept
from tyrefem.mechanics.rolling.rolled import RolledTyre
from tyrefem.mechanics.rolling.rolling_motion import RollingMotion
from tyrefem.mechanics.rolling.wheel_on_road import WheelOnRoad, wheel_on_road
from tyrefem.threads import one_thread
from tyrefem.tyre_forces.fitting import MagicFormulaFit, fit_magic_formula
from tyrefem.tyre_forces.points import ForcePoints
from tyrefem.tyre_forces.property_file import TyreDimensions

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData

#: Loads by default, over that of the drive's first phase.
LOADS = (0.5, 0.75, 1.0, 1.25)
#: Slip angles, rad, slips and cambers, rad, by default. A tyre that mirrors itself needs one sign without camber.
SLIP_ANGLES = tuple(np.radians([0.0, 0.5, 1.0, 2.0, 3.0, 4.5, 6.0, 8.0, 10.0, 12.0]).tolist())
SLIPS = (-0.3, -0.2, -0.12, -0.08, -0.05, -0.03, -0.015, -0.005, 0.005, 0.015, 0.03, 0.05, 0.08, 0.12, 0.2, 0.3)
CAMBERS = (float(np.radians(3.0)),)
#: With camber, where both signs are needed, one of so many slip angles is taken.
THINNED = 2
#: Harmonics of all points: the middle one of those that `roll` tries.
MIDDLE = HARMONICS[len(HARMONICS) // 2]


@dataclass(frozen=True, eq=False)
class TyreForces(Brief):
    """Forces of a study's tyre at many points of pure slip. Made by `tyre_forces`.

    Parameters
    ----------
    wheel : tyre and road under the drive's load, without camber.
    rows : of the points, as `roll.row`, with ``camber_rad`` and ``free``: 1 without torque, 0 at a given slip.
    """

    wheel: WheelOnRoad
    rows: tuple[dict[str, float], ...]

    @property
    def study(self) -> StudyData:
        """The study."""
        return self.wheel.pressed.study

    @property
    def table(self) -> Any:
        """pandas DataFrame of the points."""
        import pandas as pd

        return pd.DataFrame(self.rows)

    @functools.cached_property
    def points(self) -> ForcePoints:
        """The points in the axes of the Magic Formula."""
        names = {
            "load": "F_z_N", "slip": "slip", "slip_angle": "slip_angle_rad", "camber": "camber_rad",
            "longitudinal": "F_x_N", "lateral": "F_y_N", "aligning": "M_z_Nm",
        }  # fmt: skip
        columns = {name: np.array([row[key] for row in self.rows]) for name, key in names.items()}
        # A wheel that rolls freely counts as without slip. Here it leans to its left, in the formula to the right.
        columns["slip"] = np.where([row["free"] for row in self.rows], 0.0, columns["slip"])
        columns["camber"] = -columns["camber"]
        columns["pressure"] = np.full(len(self.rows), self.wheel.pressed.tyre.pressure)
        return ForcePoints.of(columns)

    @functools.cached_property
    def fit(self) -> MagicFormulaFit:
        """The Magic Formula of the points; its nominal load is that of `tyre_forces`."""
        pressed = self.wheel.pressed
        return fit_magic_formula(
            self.points, self.wheel.rolling.reach, nominal_load=pressed.footprint.load,
            nominal_pressure=pressed.tyre.pressure, symmetric=pressed.study.section.half,
        )  # fmt: skip

    @property
    def against_the_lean(self) -> tuple[float, ...]:
        """Loads, N, at which camber without slip angle pushes the tyre away from the side to which it leans."""
        upright = [row for row in self.rows if row["camber_rad"] and not row["slip_angle_rad"]]
        return tuple(row["F_z_N"] for row in upright if pushes_away(row["camber_rad"], row["F_y_N"], row["F_z_N"]))

    @property
    def dimensions(self) -> TyreDimensions:
        """What a `.tir` file states beside the coefficients: of the tyre as built, rim from the seat that is held."""
        pressed = self.wheel.pressed
        rings, state = pressed.tyre.body.rings, pressed.tyre.state
        r, z = rings.nodes
        seat = np.concatenate([rings.boundary_nodes(name) for name in state.fixed])
        sides = 2.0 if pressed.study.section.half else 1.0
        width, rim_radius = sides * float(np.ptp(z)), float(r[seat].min())
        # The section's, as in a sweep: the straight sides of the mesh's elements leave out some 0.1 %.
        mass = float(sum(masses(pressed.study.section, pressed.study.materials).values()))
        return TyreDimensions(
            width=width,
            rim_radius=rim_radius,
            rim_width=sides * float(np.ptp(z[seat]) if sides == 1.0 else np.abs(z[seat]).max()),
            aspect_ratio=(float(r.max()) - rim_radius) / width,
            mass=mass,
            vertical_stiffness=pressed.footprint.stiffness,
            speed=self.wheel.speed,
            deflection=pressed.footprint.deflection,
        )


@one_thread()
def tyre_forces(
    study: StudyData,
    *,
    loads: Sequence[float] | None = None,
    slip_angles: Sequence[float] = SLIP_ANGLES,
    slips: Sequence[float] = SLIPS,
    cambers: Sequence[float] = CAMBERS,
    harmonics: int = MIDDLE,
    progress: Callable[[float, float], None] | None = None,
    **wheel: Any,
) -> TyreForces:
    """Roll a study's tyre at every load: over the slips straight ahead, over the slip angles at every camber.

    A tyre that its load changes (`WheelOnRoad.of_one_load`) is pressed under each load.

    Without camber a half section needs one sign of the slip angle: the tyre is its own mirror image. With camber the
    angles of both signs are computed.

    Parameters
    ----------
    loads : N; by default `LOADS` times the drive's load. The nominal load is the drive's, or their mean where the
        drive's lies outside of their range.
    slip_angles : rad, either sign. cambers : rad, beside none. slips : 1.
    harmonics : of all points. progress : called with the number of curves done, and of all.
    wheel : as in `roll`, without load, deflection and camber.

    Raises
    ------
    InputError : errors of `roll`; a drive without a load, where no loads are given; fewer than two different loads; a
        load that is not positive.
    """
    for name in ("load", "deflection", "camber"):
        if name in wheel:
            raise InputError("is given by the table of forces", field=name)
    if not isinstance(harmonics, Integral) or harmonics < LADDER[0]:
        raise InputError(f"must be a whole number of at least {LADDER[0]}, not {harmonics!r:.60}", field="harmonics")
    phase = study.card.drive.phases[0]
    if loads is None:
        if phase.load is None:
            raise InputError("the drive gives no load: give the loads", field="loads")
        loads = [share * phase.load.start for share in LOADS]
    for load in loads:
        if not load > 0:
            raise InputError(f"must be more than 0 N, not {load:g} N", field="loads")
    if len(set(loads)) < 2:
        raise InputError("give at least two different loads: the Magic Formula goes over load", field="loads")
    if not len(slip_angles) and not any(slips):
        raise InputError("give at least one slip angle or one slip: the forces are those of slip", field="slip_angles")
    nominal = float(np.mean(loads))
    if phase.load is not None and min(loads) <= phase.load.start <= max(loads):
        nominal = phase.load.start
    on_road = wheel_on_road(study, load=nominal, **wheel)
    angles = sorted({abs(angle) for angle in slip_angles})
    leans = tuple(dict.fromkeys((0.0, *cambers)))
    curves: dict[tuple[float, float], list[dict[str, float]]] = {}
    for load in dict.fromkeys(loads):
        tyre = wheel_on_road(study, load=load, **wheel) if load != nominal and on_road.of_one_load else on_road
        for camber in leans:
            if progress is not None:
                progress(len(curves), len(leans) * len(set(loads)))
            leaning = replace(tyre.rolling, camber=camber, influence=tyre.rolling.points)
            wheel_under = replace(tyre, rolling=leaning, load=load, deflection=None)
            steered_by = angles[::THINNED] if camber else angles
            states = _curves(wheel_under, steered_by, () if camber else slips, wheel_under.free(harmonics))
            curves[camber, load] = [
                row(wheel_under, state) | {"camber_rad": camber, "free": float(steered)}
                for some, steered in states
                for state in some
            ]
    ordered = [curves[camber, load] for camber in leans for load in dict.fromkeys(loads)]
    return TyreForces(on_road, tuple(itertools.chain.from_iterable(ordered)))


def _curves(
    wheel: WheelOnRoad, slip_angles: Sequence[float], slips: Sequence[float], free: RolledTyre
) -> Iterator[tuple[list[RolledTyre], bool]]:
    """Rolling tyres over slip angles >= 0, then over their mirror images, True; then over braking and driving slips,
    False. Each tyre is found from the one before, the first from free rolling."""
    mirrors = wheel.pressed.study.section.half and not wheel.rolling.camber
    for sign in (1.0,) if mirrors else (1.0, -1.0):
        angles = [sign * angle for angle in slip_angles if angle or sign > 0]
        motions = [(RollingMotion(angle), driven(None, None, None)) for angle in angles]
        yield swept(wheel, motions, free.harmonics), True
    for some in ([slip for slip in slips if slip < 0], [slip for slip in slips if slip > 0]):
        ordered = sorted(some, key=abs)
        yield swept(wheel, [(RollingMotion(), driven(slip, None, None)) for slip in ordered], free.harmonics), False
