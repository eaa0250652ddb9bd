"""`tyrefem forces`: forces of a study's tyre over load, slip, slip angle and camber, and a `.tir` file."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tyrefem.brief import counted
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
from tyrefem.cli.progress import stages
from tyrefem.cli.shell import answer_with, say
from tyrefem.errors import InputError
from tyrefem.output.folder import results_folder

if TYPE_CHECKING:
    from tyrefem.api import Study
    from tyrefem.mechanics.rolling.force_table import TyreForces

#: Options with several quantities, and with one: name and unit.
LISTS = {
    "loads": ("--loads", "N"),
    "slip_angles": ("--slip-angles", "rad"),
    "slips": ("--slips", "1"),
    "cambers": ("--cambers", "rad"),
}
SINGLE = {
    "friction": ("--friction", "1"),
    "speed": ("--speed", "m/s"),
    "pressure": ("--pressure", "Pa"),
    "drum_diameter": ("--drum", "m"),
}


def forces(
    study: StudyArgument,
    loads: Annotated[str | None, typer.Option(help="Loads '2 kN, 4 kN'; default 0.5 to 1.25 of the drive's.")] = None,
    slip_angles: Annotated[
        str | None, typer.Option(help="Slip angles '0 deg, 1 deg, 3 deg'; default 0 to 12 deg; the sign is no matter.")
    ] = None,
    slips: Annotated[str | None, typer.Option(help="Slips '-5 %, 5 %'; default -30 to 30 %; positive drives.")] = None,
    cambers: Annotated[str | None, typer.Option(help="Cambers beside 0, '3 deg'; default 3 deg; 'none'.")] = None,
    friction: Annotated[
        str | None, typer.Option(help="Coefficient of friction; default: that of the tread's card, else 1.")
    ] = None,
    speed: Annotated[str | None, typer.Option(help="Speed; default: the drive's.")] = None,
    pressure: Annotated[str | None, typer.Option(help="Gauge pressure, e.g. '2.2 bar'.")] = None,
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
    pictures: Annotated[bool, typer.Option(help="Draw the PNG picture.")] = True,
    out: Annotated[Path | None, typer.Option("--out", help="Folder; default: results/STUDY-forces.")] = None,
    force: ForceOption = False,
    changes: SetOption = None,
    case: CaseOption = None,
) -> None:
    """Forces over load, slip, slip angle and camber; a Magic Formula that fits them, as a .tir file."""
    from tyrefem.api import study as load_study
    from tyrefem.inputs.origin import StudyOrigin
    from tyrefem.mechanics.rolling.force_table import tyre_forces
    from tyrefem.mechanics.rolling.wheel_on_road import NEEDS
    from tyrefem.reports.forces import FILES, summary, warnings, write_files

    lists = {"loads": loads, "slip_angles": slip_angles, "slips": slips, "cambers": cambers}
    given: dict[str, Any] = {"motion": motion}
    given |= {name: _listed(name, text) for name, text in lists.items() if text is not None}
    single = {"friction": friction, "speed": speed, "pressure": pressure, "drum_diameter": drum}
    given |= {
        name: read_quantity(SINGLE[name][0], text, SINGLE[name][1]) for name, text in single.items() if text is not None
    }
    loaded = load_study(study, settings(changes), case)
    NEEDS.check(loaded)
    warn(loaded.warnings)
    place = out or Path("results") / f"{loaded.name}-forces"
    with (
        results_folder(place, "forces", FILES, origin=StudyOrigin(loaded), force=force) as folder,
        stages() as tick,
    ):
        tick(f"{loaded.name}: inflating and pressing", 0.0, 0.0)
        try:
            result = tyre_forces(
                loaded, progress=lambda done, total: tick(f"{loaded.name}: rolling", done, total), **given
            )
            write_files(result, folder, pictures=pictures)
        except InputError as error:
            raise _placed(error, given, loaded) from None
    warn(warnings(result))
    answer_with(summary(result))
    say(_words(result))
    say(f"results in {folder}")


def _listed(name: str, text: str) -> list[float]:
    if text.strip() == "none":
        return []
    option, unit = LISTS[name]
    return [read_quantity(option, part.strip(), unit) for part in text.split(",")]


def _placed(error: InputError, given: Collection[str], study: Study) -> InputError:
    """The error with its option, or the study's drive, as field."""
    options = {name: option for name, (option, _) in {**LISTS, **SINGLE}.items()}
    single = {"slip_angle": "slip_angles", "slip": "slips", "load": "loads", "camber": "cambers"}
    options |= {name: options[several] for name, several in single.items()} | {"motion": "--motion"}
    if error.field == "loads" and "loads" not in given:
        error = InputError(error.message, field="load", file=error.file)
    return placed(error, options, [*given, *(name for name, several in single.items() if several in given)], study)


def _words(result: TyreForces) -> str:
    fit = result.fit
    formula, load = fit.formula, fit.formula.nominal_load
    lines = [
        result.study.title,
        f"  {counted(len(result.rows), 'point')} from {result.points.load.min():.0f} to "
        f"{result.points.load.max():.0f} N, "
        f"{result.wheel.pressed.tyre.pressure / 1e3:.1f} kPa",
    ]
    if "lateral" in fit.errors:
        lines.append(f"  cornering stiffness  {-formula.cornering_stiffness(load) / 1e3:.2f} kN/rad at {load:.0f} N")
    if "aligning" in fit.errors:
        lines.append(f"  pneumatic trail      {1e3 * formula.trail(load, 0.0):.1f} mm")
    if "longitudinal" in fit.errors:
        lines.append(f"  slip stiffness       {formula.slip_stiffness(load) / 1e3:.2f} kN")
    lines += [f"  Magic Formula        {name}: rms {error:.2%} of the largest" for name, error in fit.errors.items()]
    return "\n".join(lines)


#: Place among the commands.
ORDER = 46.7


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(forces)
