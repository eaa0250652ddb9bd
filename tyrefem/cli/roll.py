"""`tyrefem roll`: roll a study's tyre steadily over the road with friction."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tyrefem.cli.common import (
    CaseOption,
    ForceOption,
    SetOption,
    StudyArgument,
    placed,
    read_quantity,
    settings,
    warn,
)
from tyrefem.cli.progress import progress
from tyrefem.cli.shell import answer_with, say
from tyrefem.errors import InputError
from tyrefem.output.folder import results_folder

if TYPE_CHECKING:
    from tyrefem.mechanics.rolling.roll import RolledStudy
    from tyrefem.mechanics.rolling.slip_curve import SlipCurve
    from tyrefem.mechanics.rolling.wheel_on_road import WheelOnRoad

#: Options with one quantity: name and unit.
OPTIONS = {
    "camber": ("--camber", "rad"),
    "torque": ("--torque", "N*m"),
    "axle_force": ("--axle-force", "N"),
    "turn_slip": ("--turn-slip", "1/m"),
    "friction": ("--friction", "1"),
    "speed": ("--speed", "m/s"),
    "pressure": ("--pressure", "Pa"),
    "load": ("--load", "N"),
    "deflection": ("--deflection", "m"),
    "drum_diameter": ("--drum", "m"),
}
#: Options that may have several values.
VARIED = {"slip_angle": ("--slip-angle", "rad"), "slip": ("--slip", "1")}
#: Most values of a curve.
MOST = 500


def roll(
    study: StudyArgument,
    slip_angle: Annotated[
        str, typer.Option(help="Slip angle '2 deg', several '1 deg, 2 deg', or '-10 deg:10 deg:21' (from, to, number).")
    ] = "0 deg",
    slip: Annotated[
        str | None, typer.Option(help="Longitudinal slip '3 %', positive drives; several as for --slip-angle.")
    ] = None,
    torque: Annotated[str | None, typer.Option(help="Torque of the axle, '200 N m', instead of a slip.")] = None,
    axle_force: Annotated[
        str | None, typer.Option(help="Force of the road on the tyre, forward, '500 N', instead of a slip.")
    ] = None,
    camber: Annotated[str, typer.Option(help="Camber '1 deg'; positive: the wheel leans to its left.")] = "0 deg",
    turn_slip: Annotated[str, typer.Option(help="Curvature of the path, '0.02 1/m'; positive: left.")] = "0 1/m",
    friction: Annotated[
        str | None, typer.Option(help="Coefficient of friction; default: that of the tread's card, else 1.")
    ] = None,
    speed: Annotated[str | None, typer.Option(help="Speed; default: the drive's.")] = None,
    pressure: Annotated[str | None, typer.Option(help="Gauge pressure, e.g. '2.2 bar'.")] = None,
    load: Annotated[str | None, typer.Option(help="Load of the tyre, e.g. '4 kN'.")] = None,
    deflection: Annotated[str | None, typer.Option(help="Deflection, instead of a load, e.g. '20 mm'.")] = None,
    drum: Annotated[
        str | None, typer.Option(metavar="DIAMETER", help="Drum's diameter, e.g. '1.7 m', or 'flat'.")
    ] = None,
    motion: Annotated[
        str,
        typer.Option(
            metavar="large|linear",
            help="Linear about the inflated tyre, or friction on the footprint in large motion (slower).",
        ),
    ] = "linear",
    pictures: Annotated[bool, typer.Option(help="Draw the PNG pictures.")] = True,
    vtk: Annotated[bool, typer.Option(help="Write the rolling tyre, tyre.vtu, and its footprint, contact.vtu.")] = True,
    out: Annotated[Path | None, typer.Option("--out", help="Folder; default: results/STUDY-roll.")] = None,
    force: ForceOption = False,
    changes: SetOption = None,
    case: CaseOption = None,
) -> None:
    """Roll the tyre with friction: forces, moments, slip and friction power; several slips give a curve."""
    from tyrefem.api import study as load_study
    from tyrefem.inputs.origin import StudyOrigin
    from tyrefem.mechanics.rolling.roll import roll as rolled_by
    from tyrefem.mechanics.rolling.slip_curve import slip_curve
    from tyrefem.mechanics.rolling.wheel_on_road import NEEDS
    from tyrefem.reports.roll import FILES, summary, write_curve, write_files

    texts = {
        "camber": camber, "torque": torque, "axle_force": axle_force, "turn_slip": turn_slip, "friction": friction,
        "speed": speed, "pressure": pressure, "load": load, "deflection": deflection, "drum_diameter": drum,
    }  # fmt: skip
    given: dict[str, Any] = {
        name: read_quantity(OPTIONS[name][0], text, OPTIONS[name][1])
        for name, text in texts.items()
        if text is not None
    }
    given["motion"] = motion
    for name, text in {"slip_angle": slip_angle, "slip": slip}.items():
        if text is not None:
            given[name] = _values(name, text)
    several = [name for name in VARIED if isinstance(given.get(name), list)]
    if len(several) > 1:
        raise InputError("only one of --slip-angle and --slip may have several values", field="--slip")
    loaded = load_study(study, settings(changes), case)
    NEEDS.check(loaded)
    warn(loaded.warnings)
    place = out or Path("results") / f"{loaded.name}-roll"
    with (
        results_folder(place, "roll", FILES, origin=StudyOrigin(loaded), force=force) as folder,
        progress(f"{loaded.name}: rolling"),
    ):
        result: RolledStudy | SlipCurve
        try:
            if several:
                result = curve = slip_curve(loaded, **given)
                words = _curve_words(curve)
            else:
                result = rolled = rolled_by(loaded, **given)
                words = _words(rolled)
        except InputError as error:
            options = {name: option for name, (option, _) in {**OPTIONS, **VARIED}.items()} | {"motion": "--motion"}
            raise placed(error, options, given, loaded) from None
        if several:
            write_curve(curve, folder, pictures=pictures)
        else:
            write_files(rolled, folder, pictures=pictures, vtk=vtk)
    warn(result.warnings)
    answer_with(result.summary() if several else summary(rolled))
    say(words)
    say(f"results in {folder}")


def _values(name: str, text: str) -> float | list[float]:
    """A value; a list of 'a, b, ...'; or evenly spaced values of 'from:to:number'."""
    option, unit = VARIED[name]
    if ":" not in text:
        values = [read_quantity(option, part, unit) for part in text.split(",")]
        return values if len(values) > 1 else values[0]
    parts = text.split(":")
    if len(parts) != 3 or not re.fullmatch("[0-9]{1,9}", parts[2].strip()) or not 2 <= int(parts[2]) <= MOST:
        raise InputError(f"'{text}' is not from:to:number, like '-10 deg:10 deg:21' (number 2 to {MOST})", field=option)
    first, last = (read_quantity(option, part, unit) for part in parts[:2])
    count = int(parts[2])
    return [(first * (count - 1 - k) + last * k) / (count - 1) for k in range(count)]


def _words(rolled: RolledStudy) -> str:
    from tyrefem.mechanics.rolling.rolled_loss import hysteresis

    state = rolled.state
    f_x, f_y, f_z = state.force
    m_x, m_y, m_z = state.moment
    lines = [
        rolled.study.title,
        f"  motion of the wheel  slip angle {math.degrees(state.motion.slip_angle):.3g} deg, slip "
        f"{100 * rolled.slip:.3g} %, camber {math.degrees(rolled.wheel.rolling.camber):.3g} deg, "
        f"{state.motion.speed:.4g} m/s",
        f"  forces               F_x {f_x:z.1f}, F_y {f_y:z.1f}, F_z {f_z:.1f} N (forward, left, up)",
        f"  moments              M_x {m_x:z.2f}, M_y {m_y:z.2f}, M_z {m_z:z.2f} N m; torque {state.torque:z.2f} N m",
    ]
    if f_y and abs(f_y) > 1e-3 * f_z:
        lines.append(f"  pneumatic trail      {state.pneumatic_trail * 1e3:.2f} mm")
    if state.loss_power:
        lines.append(
            f"  rolling resistance   {state.rolling_resistance:.2f} N, coefficient "
            f"{state.rolling_resistance / f_z:.5f}, energy lost per metre; "
            f"{state.loss_power:.5g} W in the rubber"
        )
    patch = state.patch
    lines += [
        f"  footprint            {patch.length * 1e3:.1f} mm long, {patch.width * 1e3:.1f} mm wide, "
        f"{patch.area * 1e4:.1f} cm2; pressure {patch.mean_pressure / 1e3:.0f} kPa mean, "
        f"{patch.peak_pressure / 1e3:.0f} kPa peak",
        f"  hysteresis           {hysteresis(rolled):.5g} W of the strain cycle, as in a drive",
        f"  rolling radius       {rolled.rolling_radius * 1e3:.2f} mm effective, "
        f"{state.loaded_radius * 1e3:.2f} mm loaded",
        f"  friction             {state.friction_power:.5g} W; {100 * state.sliding_share:.3g} % of the load on points "
        "that slip",
        f"  harmonics            {state.harmonics}, error of the force {rolled.error:.2%}",
        f"  {_motion_words(rolled.wheel)}",
    ]
    return "\n".join(lines)


def _motion_words(wheel: WheelOnRoad) -> str:
    """What the rolling of this command is."""
    large, lossy = wheel.pressed.footprint.motion == "large", wheel.rolling.points.lossy
    if large:
        words = "footprint in large motion, friction on it in small motion"
    else:
        words = "linear about the inflated tyre: too stiff under large deflections"
    inertia = "with inertia" if wheel.pressed.tyre.angular_speed else "without inertia"
    return f"motion               {words}; {inertia}, {'with' if lossy else 'without'} loss"


def _curve_words(curve: SlipCurve) -> str:
    stiffness, angle = curve.stiffness, curve.varied == "slip_angle"
    peak = curve.peak
    where = f"{math.degrees(peak['slip_angle_rad']):.3g} deg" if angle else f"{100 * peak['slip']:.3g} %"
    lines = [
        curve.study.title,
        f"  cornering stiffness  {stiffness.cornering / 1e3:.2f} kN/rad; trail {stiffness.trail * 1e3:.1f} mm",
        f"  slip stiffness       {stiffness.slip / 1e3:.2f} kN",
        f"  relaxation length    {curve.relaxation_lengths[1] * 1e3:.0f} mm of the side force, "
        f"{curve.relaxation_lengths[0] * 1e3:.0f} mm of the longitudinal force",
        f"  standing tyre        {curve.standing.longitudinal / 1e3:.1f} N/mm forward, "
        f"{curve.standing.lateral / 1e3:.1f} N/mm sideways, of a small push",
        f"  greatest force       {peak['force_N']:.0f} N at {where}",
        f"  harmonics            {curve.states[0].harmonics}, error of the force {curve.error:.2%}",
        f"  {_motion_words(curve.wheel)}",
        f"  {'angle, deg':>10} {'slip, %':>9} {'F_x, N':>9} {'F_y, N':>9} {'M_z, N m':>9} {'friction, W':>11}",
    ]
    lines += [
        f"  {math.degrees(state.motion.slip_angle):10.3f} {100 * curve.wheel.slip(state):9.3f} "
        f"{state.force[0]:z9.1f} {state.force[1]:z9.1f} {state.moment[2]:z9.2f} {state.friction_power:11.1f}"
        for state in curve.states
    ]
    return "\n".join(lines)


#: Place among the commands.
ORDER = 46.5


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(roll)
