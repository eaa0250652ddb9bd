"""`tyrefem modes`: natural frequencies of a study's inflated tyre, rim held, without load."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

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
from tyrefem.cli.shell import answer_with, say
from tyrefem.errors import InputError
from tyrefem.output.folder import results_folder

if TYPE_CHECKING:
    from tyrefem.mechanics.footprint.natural_frequencies import NaturalFrequencies


def modes(
    study: StudyArgument,
    highest: Annotated[int, typer.Option(min=0, max=60, help="Highest number of waves round the wheel.")] = 5,
    count: Annotated[int, typer.Option(min=1, max=40, help="Modes of each number of waves.")] = 2,
    pressure: Annotated[str | None, typer.Option(help="Gauge pressure, e.g. '2.2 bar'.")] = None,
    amplitude: Annotated[
        str, typer.Option(help="Shear strain amplitude of the vibration, for cards with strain_dependence.")
    ] = "0.1 %",
    speed: Annotated[
        str | None, typer.Option(help="Speed at which the tyre rotates, e.g. '80 km/h': forward and backward waves.")
    ] = None,
    pictures: Annotated[bool, typer.Option(help="Draw the PNG picture.")] = True,
    out: Annotated[Path | None, typer.Option("--out", help="Folder; default: results/STUDY-modes.")] = None,
    force: ForceOption = False,
    changes: SetOption = None,
    case: CaseOption = None,
) -> None:
    """Natural frequencies and modes of the inflated, unloaded tyre, with its rim held; with --speed it rotates."""
    from tyrefem.api import study as load
    from tyrefem.inputs.drive import FASTEST
    from tyrefem.inputs.origin import StudyOrigin
    from tyrefem.mechanics.footprint.natural_frequencies import NEEDS, natural_frequencies
    from tyrefem.mechanics.rolling.rotating_modes import rotating_frequencies
    from tyrefem.reports.modes import FILES, write_files

    given = None if pressure is None else read_quantity("--pressure", pressure, "Pa", gt=0)
    turning = None if speed is None else read_quantity("--speed", speed, "m/s", gt=0, le=FASTEST)
    strain = read_quantity("--amplitude", amplitude, "1", gt=0, le=1)
    loaded = load(study, settings(changes), case)
    NEEDS.check(loaded)
    warn(loaded.warnings)
    place = out or Path("results") / f"{loaded.name}-modes"
    with (
        results_folder(place, "modes", FILES, origin=StudyOrigin(loaded), force=force) as folder,
        progress(f"{loaded.name}: natural frequencies"),
    ):
        try:
            options: dict[str, Any] = {"count": count, "pressure": given, "amplitude": strain}
            if turning is None:
                result = natural_frequencies(loaded, range(highest + 1), **options)
            else:
                result = rotating_frequencies(loaded, turning, range(highest + 1), **options)
        except InputError as error:
            options_given = {"pressure": pressure, "speed": speed, "amplitude": amplitude}
            if (
                error.file in (None, loaded.file)
                and error.field is not None
                and options_given.get(error.field) is not None
            ):
                raise InputError(error.message, field=f"--{error.field}") from None
            field = "drive.phases.0.pressure" if error.field == "pressure" and given is None else error.field
            placed = InputError(error.message, field=field, file=error.file or loaded.file)
            raise error if error.file else loaded.as_written(placed) from None
        write_files(result, folder, pictures=pictures)
    answer_with(result.summary())
    say(_words(result))
    say(f"results in {folder}")


def _words(result: NaturalFrequencies) -> str:
    from tyrefem.mechanics.rolling.rotating_modes import RotatingFrequencies, RotatingMode

    turns = isinstance(result, RotatingFrequencies)
    lines = [
        result.study.title,
        f"  inflated to {result.tyre.pressure / 1e3:.1f} kPa, rim held, no load; mass {result.mass:.2f} kg",
        _moduli(result),
        f"  {'waves':>5} {'Hz':>8}  {'motion of the belt':24} radial  lateral  around"
        + ("  in the rubber, Hz from the axle" if turns else ""),
    ]
    if isinstance(result, RotatingFrequencies):
        lines.insert(2, f"  rotates with {result.angular_speed:.4g} rad/s: frequencies in the rubber's frame")
    for natural in result.modes:
        shares = natural.shares
        lines.append(
            f"  {natural.mode.harmonic:5d} {natural.mode.frequency:8.2f}  {natural.name:24} {shares['radial']:6.0%}"
            f" {shares['lateral']:8.0%} {shares['circumferential']:7.0%}"
            + (f"  {natural.direction:8} {natural.axle_frequency:8.2f}" if isinstance(natural, RotatingMode) else "")
        )
    return "\n".join(lines)


def _moduli(result: NaturalFrequencies) -> str:
    if not result.stiffening:
        return "  moduli as in the cards: none gives a strain dependence"
    factors = ", ".join(f"{region} {factor:.2f}" for region, factor in result.stiffening.items())
    return f"  moduli at the strain amplitude {100 * result.amplitude:g} %, over those of the cards: {factors}"


#: Place among the commands.
ORDER = 46


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(modes)
