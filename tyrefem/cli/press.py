"""`tyrefem press`: inflate a study's tyre by finite elements and press it on the road."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tyrefem.cli.common import (
    CaseOption,
    ForceOption,
    SetOption,
    StudyArgument,
    read_quantity,
    settings,
    warn,
)
from tyrefem.cli.progress import progress
from tyrefem.cli.shell import answer_with, notify, say
from tyrefem.errors import InputError
from tyrefem.output.folder import results_folder

if TYPE_CHECKING:
    from tyrefem.api import Study
    from tyrefem.mechanics.footprint.press import Pressed

#: Options with a quantity: name and unit.
OPTIONS = {
    "pressure": ("--pressure", "Pa"),
    "load": ("--load", "N"),
    "deflection": ("--deflection", "m"),
    "drum_diameter": ("--drum", "m"),
    "camber": ("--camber", "rad"),
}


def press(
    study: StudyArgument,
    pressure: Annotated[str | None, typer.Option(help="Gauge pressure, e.g. '83 psi'.")] = None,
    load: Annotated[str | None, typer.Option(help="Load of the tyre, e.g. '12 kN'.")] = None,
    deflection: Annotated[str | None, typer.Option(help="Deflection, instead of a load, e.g. '20 mm'.")] = None,
    drum: Annotated[
        str | None, typer.Option(metavar="DIAMETER", help="Drum's diameter, e.g. '1.7 m', or 'flat'.")
    ] = None,
    camber: Annotated[
        str | None, typer.Option(help="Camber, e.g. '2 deg'; positive: the side z > 0 moves down.")
    ] = None,
    at: Annotated[
        list[str] | None,
        typer.Option(metavar="PLACE", help="Write the strain cycle of this place: 'r, z' or a region. Repeatable."),
    ] = None,
    motion: Annotated[
        str | None,
        typer.Option(
            metavar="large|linear",
            help="Large motion, or linear about the inflated tyre (a quick look, too stiff). Default: the study's.",
        ),
    ] = None,
    balanced: Annotated[
        bool,
        typer.Option("--balanced", hidden=True, help="Older spelling of --motion large."),
    ] = False,
    critical_speed: Annotated[
        bool,
        typer.Option(
            "--critical-speed",
            help="Instead: the speed at which a wave stands still. --pressure, --temperature may list: '2 bar, 3 bar'.",
        ),
    ] = False,
    temperature: Annotated[
        str | None, typer.Option(help="With --critical-speed: temperatures of the moduli, e.g. '25 degC, 80 degC'.")
    ] = None,
    rise: Annotated[
        bool,
        typer.Option("--rise", help="With --critical-speed: how heat and strain rise below it (rise.csv, rise.png)."),
    ] = False,
    pictures: Annotated[bool, typer.Option(help="Draw the PNG pictures.")] = True,
    vtk: Annotated[bool, typer.Option(help="Write the whole deformed tyre, tyre.vtu.")] = True,
    out: Annotated[Path | None, typer.Option("--out", help="Folder; default: results/STUDY-press.")] = None,
    force: ForceOption = False,
    changes: SetOption = None,
    case: CaseOption = None,
) -> None:
    """Inflate the tyre by finite elements and press it on the road; default values are of the drive's first phase."""
    from tyrefem.api import study as load_study
    from tyrefem.cli.critical_speed import print_critical_speeds
    from tyrefem.inputs.origin import StudyOrigin
    from tyrefem.mechanics.footprint.press_order import NEEDS
    from tyrefem.mechanics.rolling.press import press as pressed_by
    from tyrefem.reports.press import FILES, write_files
    from tyrefem.reports.press_places import cycle_places, read_place

    if critical_speed:
        others = {"--load": load, "--deflection": deflection, "--drum": drum, "--camber": camber, "--motion": motion}
        refused = [option for option, text in others.items() if text is not None]
        refused += ["--at"] * bool(at) + ["--balanced"] * balanced
        if refused:
            raise InputError("no road acts on critical speeds; leave it out with --critical-speed", field=refused[0])
        loaded = load_study(study, settings(changes), case)
        print_critical_speeds(
            loaded, pressure, temperature, out, force=force, pictures=pictures,
            rise=rise,
        )  # fmt: skip
        return
    if rise:
        raise InputError("is for --critical-speed", field="--rise")
    if temperature is not None:
        raise InputError("is for --critical-speed; a footprint has its cards' moduli", field="--temperature")
    texts = {"pressure": pressure, "load": load, "deflection": deflection, "drum_diameter": drum, "camber": camber}
    given = {
        name: read_quantity(OPTIONS[name][0], text, OPTIONS[name][1], **({} if name == "camber" else {"gt": 0}))
        for name, text in texts.items()
        if text is not None
    }
    chosen = _motion(motion, balanced=balanced)
    loaded = load_study(study, settings(changes), case)
    NEEDS.check(loaded)
    warn(loaded.warnings)
    place = out or Path("results") / f"{loaded.name}-press"
    with (
        results_folder(place, "press", FILES, origin=StudyOrigin(loaded), force=force) as folder,
        progress(f"{loaded.name}: inflating and pressing"),
    ):
        try:
            for name in at or ():
                read_place(loaded.section, name)
            result = pressed_by(loaded, **given, motion=chosen)
            places = cycle_places(result, at or ())
            curve = result.curve()
        except InputError as error:
            raise _placed(error, given, loaded) from None
        write_files(result, folder, places, curve, pictures=pictures, vtk=vtk)
    if result.footprint.unstable and result.turning is None:
        many = ", ".join(map(str, result.footprint.unstable))
        where = result.footprint.unstable_place
        notify(f"warning: the stiffness is negative in harmonics {many}: the footprint there is in doubt ({where})")
    answer_with(result.summary())
    say(_words(result))
    say(f"results in {folder}")


def _motion(motion: str | None, *, balanced: bool) -> str | None:
    if balanced and motion not in (None, "large"):
        raise InputError(f"'{motion}' contradicts --balanced, which is --motion large", field="--motion")
    return "large" if balanced else motion


def _placed(error: InputError, given: dict[str, float], study: Study) -> InputError:
    """The error with its field: the option, or the study's drive that has the value."""
    if error.field in ("at", "motion"):
        return InputError(error.message, field=f"--{error.field}")
    if error.field in given:
        return InputError(error.message, field=OPTIONS[error.field][0])
    if error.field in OPTIONS:
        placed = InputError(error.message, field=f"drive.phases.0.{error.field}", file=study.file)
        return study.as_written(placed)
    return error if error.file else InputError(error.message, field=error.field, file=study.file)


def _words(result: Pressed) -> str:
    from tyrefem.reports.words import motion_words

    tyre, footprint, loss = result.tyre, result.footprint, result.loss
    drum = result.pressing.road.drum_diameter
    road = "flat road" if math.isinf(drum) else f"drum of {drum:.4g} m"
    camber = math.degrees(result.pressing.road.camber)
    leaning = f"; camber {camber:.3g} deg" if camber else ""
    bead = "no bead wires" if result.bead_tension is None else f"{result.bead_tension / 1e3:.2f} kN"
    lines = [
        result.study.title,
        f"  inflated            {tyre.pressure / 1e3:.1f} kPa: radius {tyre.radius_growth * 1e3:+.2f} mm, width "
        f"{tyre.width_growth * 1e3:+.2f} mm; bead tension {bead}",
    ]
    for region, layer in tyre.cord_tensions.items():
        least, mean, greatest = (100 * strain for strain in layer.strain)
        if layer.tension is None:
            force = f"{layer.stress[1] / 1e6:.3g} MPa in the layer on average"
        else:
            force = "{:.3g} / {:.3g} / {:.3g} N a cord".format(*layer.tension)
        lines.append(f"  cords of {region:10} {least:.2f} / {mean:.2f} / {greatest:.2f} % (least, mean, most), {force}")
    lines += [
        f"  {road:19} {footprint.load:.1f} N at {footprint.deflection * 1e3:.2f} mm; stiffness "
        f"{result.secant_stiffness / 1e3:.1f} N/mm secant, {footprint.stiffness / 1e3:.1f} N/mm tangent{leaning}",
        f"  footprint           {footprint.length * 1e3:.1f} mm long, {footprint.width * 1e3:.1f} mm wide, "
        f"{footprint.area * 1e4:.1f} cm2; pressure {footprint.mean_pressure / 1e3:.0f} kPa mean, "
        f"{result.peak_pressure / 1e3:.0f} kPa peak",
        f"  rolling radius      {footprint.rolling_radius * 1e3:.2f} mm "
        f"(loaded {footprint.loaded_radius * 1e3:.2f} mm)",
        "  rolling resistance  none: the wheel does not roll"
        if loss is None
        else f"  rolling resistance  {loss.rolling_resistance:.1f} N, coefficient {loss.coefficient:.5f} at "
        f"{result.speed:.4g} m/s and {loss.temperature:.4g} degC",
        f"  harmonics           {result.accuracy}; {tyre.body.rings.n_nodes} nodes",
        f"  motion              {motion_words(footprint.motion, result.linearisation_error)}",
    ]
    if result.turning is not None:
        lines.append(f"  rolling             {result.turning.words}")
    if result.moduli is not None:
        secant = ", ".join(
            f"{region} {factor:.2f} at {100 * result.moduli.amplitudes[region]:.1f} %"
            for region, factor in result.moduli.factors.items()
        )
        lines.append(f"  moduli              over those of the cards: {secant or 'no card depends on strain'}")
    lines += [f"  {value.words}" for value in result.published]
    return "\n".join(lines)


#: Place among the commands.
ORDER = 45


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(press)
