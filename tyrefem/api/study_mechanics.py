"""Mechanics of a study's tyre: pressed, vibrating, rolling with friction, wearing, cracking."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING

from tyrefem.api.numbers import check_numbers, kept
from tyrefem.api.verbs import given, with_verbs
from tyrefem.inputs import study as studies

if TYPE_CHECKING:
    from tyrefem.api.life import Life
    from tyrefem.api.mechanics import ForcesOverSlip, ForceTable, LoadedTyre, NaturalModes, RollingWheel
    from tyrefem.api.wear import WearOverDrive
    from tyrefem.fatigue.duty import WarmRun
    from tyrefem.mechanics.rolling.steady_rolling import FrictionLaw


class StudyMechanics(studies.StudyData):
    """A study's methods for the mechanics of its tyre. Numbers are in SI; None: as in the drive's first phase.

    Text with a unit, ``nan`` and ``inf`` are `InputError` that name the argument.
    """

    def press(
        self,
        *,
        pressure: float | None = None,
        load: float | None = None,
        deflection: float | None = None,
        drum_diameter: float | None = None,
        camber: float = 0.0,
        tolerance: float = 0.02,
        motion: str | None = None,
        speed: float | None = None,
    ) -> LoadedTyre:
        """Inflate the tyre and press it on the road: load, stiffness, footprint, cords, loss of a revolution.

        Parameters
        ----------
        pressure : Pa above the ambient. load, deflection : N or m, at most one of them. drum_diameter : m.
        camber : rad. tolerance : allowed change with the number of harmonics, relative.
        motion : ``"large"`` or ``"linear"``; None: the study's. speed : m/s, for ``[mechanics] rolling = true``.

        Errors: see `tyrefem.mechanics.footprint.press.press`.

        >>> from tyrefem import study
        >>> tyre = study("nasa-22x5.5-8pr", {"mesh.size": "12 mm"}).press(deflection=0.015, motion="linear")
        >>> tyre.footprint.motion, 5e3 < tyre.footprint.load < 9e3
        ('linear', True)
        """
        from tyrefem.api.mechanics import LoadedTyre
        from tyrefem.mechanics.rolling.press import press

        check_numbers(
            pressure=pressure, load=load, deflection=deflection, drum_diameter=drum_diameter, camber=camber,
            tolerance=tolerance, speed=speed,
        )  # fmt: skip
        data = press(
            self, pressure=pressure, load=load, deflection=deflection, drum_diameter=drum_diameter, camber=camber,
            tolerance=tolerance, motion=motion, speed=speed,
        )  # fmt: skip
        return with_verbs(LoadedTyre, data)

    def roll(
        self,
        *,
        slip_angle: float = 0.0,
        slip: float | None = None,
        torque: float | None = None,
        axle_force: float | None = None,
        turn_slip: float = 0.0,
        camber: float = 0.0,
        friction: float | FrictionLaw | None = None,
        speed: float | None = None,
        pressure: float | None = None,
        load: float | None = None,
        deflection: float | None = None,
        drum_diameter: float | None = None,
        motion: str = "linear",
        tolerance: float = 0.05,
    ) -> RollingWheel:
        """Roll the tyre steadily with friction: forces, moments, slip, friction power by ring of the tread.

        Parameters
        ----------
        slip_angle : rad, positive to the left. turn_slip : curvature of the path, 1/m. camber : rad.
        slip, torque, axle_force : at most one of them: longitudinal slip, N m, or N forward; none: rolls freely.
        friction : coefficient, or function of sliding speed (m/s) and pressure (Pa); None: that of the tread's card.
        speed : m/s. pressure, load, deflection, drum_diameter : as in `press`. motion : ``"linear"`` or ``"large"``.
        tolerance : allowed change of the horizontal force with the number of harmonics, relative.

        Errors: see `tyrefem.mechanics.rolling.roll.roll`.

        >>> from tyrefem import study
        >>> rolled = study("nasa-22x5.5-8pr", {"mesh.size": "12 mm"}).roll(slip=0.01)
        >>> rolled.state.force[0] > 0 and rolled.state.torque > 0
        True
        """
        from tyrefem.api.mechanics import RollingWheel
        from tyrefem.mechanics.rolling.roll import roll

        wheel = given(pressure=pressure, drum_diameter=drum_diameter)
        check_numbers(
            slip_angle=slip_angle, slip=slip, torque=torque, axle_force=axle_force, turn_slip=turn_slip,
            tolerance=tolerance, camber=camber, friction=friction, speed=speed, load=load, deflection=deflection,
            **wheel,
        )  # fmt: skip
        data = roll(
            self, slip_angle=slip_angle, slip=slip, torque=torque, axle_force=axle_force, turn_slip=turn_slip,
            tolerance=tolerance, camber=camber, friction=friction, speed=speed, load=load, deflection=deflection,
            motion=motion, **wheel,
        )  # fmt: skip
        return with_verbs(RollingWheel, data)

    def wear(self) -> WearOverDrive:
        """Wear of the tread over the drive, by ring; the drive's phases roll with friction.

        Raises
        ------
        InputError : a law of sliding other than ``rolling``; no ``[wear]`` on the tread's card; a drive that never
            rolls.
        """
        from tyrefem.api.wear import WearOverDrive
        from tyrefem.wear.drive_wear import drive_wear

        return with_verbs(WearOverDrive, drive_wear(self), study=self)

    def slip_curve(
        self,
        *,
        slip_angle: float | Sequence[float] = 0.0,
        slip: float | Sequence[float] | None = None,
        torque: float | None = None,
        axle_force: float | None = None,
        turn_slip: float = 0.0,
        camber: float = 0.0,
        friction: float | FrictionLaw | None = None,
        speed: float | None = None,
        pressure: float | None = None,
        load: float | None = None,
        deflection: float | None = None,
        drum_diameter: float | None = None,
        motion: str = "linear",
        tolerance: float = 0.05,
    ) -> ForcesOverSlip:
        """Forces and moments over several ``slip_angle`` or several ``slip``, with stiffness, trail and peak.

        Options as in `roll`; see `tyrefem.mechanics.rolling.slip_curve.slip_curve`.
        """
        from tyrefem.api.mechanics import ForcesOverSlip
        from tyrefem.mechanics.rolling.slip_curve import slip_curve

        slip_angle, slip = kept(slip_angle), kept(slip)
        wheel = given(pressure=pressure, drum_diameter=drum_diameter)
        check_numbers(
            slip_angle=slip_angle, slip=slip, torque=torque, axle_force=axle_force, turn_slip=turn_slip,
            tolerance=tolerance, camber=camber, friction=friction, speed=speed, load=load, deflection=deflection,
            curve=True, **wheel,
        )  # fmt: skip
        data = slip_curve(
            self, slip_angle=slip_angle, slip=slip, torque=torque, axle_force=axle_force, turn_slip=turn_slip,
            tolerance=tolerance, camber=camber, friction=friction, speed=speed, load=load, deflection=deflection,
            motion=motion, **wheel,
        )  # fmt: skip
        return with_verbs(ForcesOverSlip, data)

    def tyre_forces(
        self,
        *,
        loads: Sequence[float] | None = None,
        slip_angles: Sequence[float] | None = None,
        slips: Sequence[float] | None = None,
        cambers: Sequence[float] | None = None,
        friction: float | FrictionLaw | None = None,
        speed: float | None = None,
        pressure: float | None = None,
        drum_diameter: float | None = None,
        motion: str = "linear",
        harmonics: int = 80,
        progress: Callable[[float, float], None] | None = None,
    ) -> ForceTable:
        """Forces at every one of ``loads``, N, over ``slips``, ``slip_angles``, rad, and ``cambers``, rad; None: usual
        ones.

        ``harmonics``: of all points. ``progress``: called with the number of curves done, and of all.
        ``fit`` of the answer has the coefficients of a Magic Formula; `ForceTable.save` writes them as a ``.tir`` file.
        Other options as in `roll`; see `tyrefem.mechanics.rolling.force_table.tyre_forces`.
        """
        from tyrefem.api.mechanics import ForceTable
        from tyrefem.mechanics.rolling.force_table import tyre_forces

        loads = kept(loads)
        options = given(
            slip_angles=kept(slip_angles), slips=kept(slips), cambers=kept(cambers), pressure=pressure,
            drum_diameter=drum_diameter,
        )  # fmt: skip
        check_numbers(loads=loads, friction=friction, speed=speed, **options)
        data = tyre_forces(
            self, loads=loads, harmonics=harmonics, progress=progress, friction=friction, speed=speed, motion=motion,
            **options,
        )  # fmt: skip
        return with_verbs(ForceTable, data)

    def natural_frequencies(
        self,
        harmonics: Iterable[int] = (0, 1, 2, 3, 4, 5),
        count: int = 2,
        *,
        pressure: float | None = None,
        amplitude: float = 0.001,
    ) -> NaturalModes:
        """Natural frequencies of the inflated tyre without load and rotation, with its rim held.

        ``harmonics``: waves round the wheel; ``count``: modes of each; ``pressure``: Pa; ``amplitude``: shear strain of
        the vibration. See `tyrefem.mechanics.footprint.natural_frequencies.natural_frequencies`.

        >>> from tyrefem import study
        >>> study("nasa-22x5.5-8pr", {"mesh.size": "12 mm"}).natural_frequencies([0], 1).table.name.tolist()
        ['lateral']
        """
        from tyrefem.api.mechanics import NaturalModes
        from tyrefem.mechanics.footprint.natural_frequencies import natural_frequencies

        check_numbers(pressure=pressure, amplitude=amplitude)
        data = natural_frequencies(self, harmonics, count, pressure=pressure, amplitude=amplitude)
        return with_verbs(NaturalModes, data)

    def life(
        self,
        *,
        temperature: float | None = None,
        plateau: bool = False,
        result: WarmRun | None = None,
        progress: Callable[[float], None] | None = None,
    ) -> Life:
        """Distance until small flaws become cracks, at every point, by strain cycle and temperatures of a run.

        ``temperature``: degC everywhere, without a run; ``plateau``: each phase at the temperatures of its end;
        ``result``: a finished run; ``progress``: as of `run`: see `tyrefem.fatigue.life.life`. Not compared with any
        measured life.

        >>> from tyrefem import study
        >>> coarse = {"mesh.size": "14 mm", "mechanics.strain": "fem", "mechanics.motion": "linear"}
        >>> tyre = study("nasa-22x5.5-8pr", coarse).life(temperature=80.0)
        >>> len(tyre.places), tyre.left_out
        (10, ('bead',))
        """
        from tyrefem.api.life import Life
        from tyrefem.fatigue.life import life

        check_numbers(temperature=temperature)
        data = life(self, temperature=temperature, plateau=plateau, result=result, progress=progress)
        return with_verbs(Life, data)
