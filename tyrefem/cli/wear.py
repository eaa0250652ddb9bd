"""`tyrefem wear`: wear of a study's tread by ring, and its worn section."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any

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

#: Options with a quantity: name and unit.
OPTIONS = {
    "slip_angle": ("--slip-angle", "rad"),
    "slip": ("--slip", "1"),
    "camber": ("--camber", "rad"),
    "friction": ("--friction", "1"),
    "distance": ("--distance", "m"),
}

#: What is meant without options, SI.
DEFAULTS = {"slip_angle": math.radians(0.5), "camber": 0.0}


def wear(
    study: StudyArgument,
    slip_angle: Annotated[
        str | None,
        typer.Option(
            help="Slip angle; default: 0.5 deg, a mean of ordinary driving; with sliding = 'rolling' the drive's."
        ),
    ] = None,
    slip: Annotated[str | None, typer.Option(help="Longitudinal slip, '1 %', positive drives; default: free.")] = None,
    camber: Annotated[str | None, typer.Option(help="Camber, '1 deg'.")] = None,
    friction: Annotated[
        str | None, typer.Option(help="Coefficient of friction; default: that of the tread's card, else 1.")
    ] = None,
    distance: Annotated[
        str | None, typer.Option(help="Write the section that is worn by this distance, '20000 km'.")
    ] = None,
    pictures: Annotated[bool, typer.Option(help="Draw the PNG picture.")] = True,
    out: Annotated[Path | None, typer.Option("--out", help="Folder; default: results/STUDY-wear.")] = None,
    force: ForceOption = False,
    changes: SetOption = None,
    case: CaseOption = None,
) -> None:
    """Wear of the tread per 1000 km by ring, from the friction power of the rolling tyre; the worn section.

    Slip is that of the options. Without them, a study with boundaries.sliding = 'rolling' wears by its drive.
    """
    from tyrefem.api import study as load
    from tyrefem.inputs.origin import StudyOrigin
    from tyrefem.mechanics.rolling.roll import roll
    from tyrefem.mechanics.rolling.wheel_on_road import NEEDS
    from tyrefem.reports.wear import FILES, words, write_files
    from tyrefem.wear.drive_wear import drive_wear
    from tyrefem.wear.ring_wear import RingWear, ring_wear, tread_table
    from tyrefem.wear.worn_section import worn_section

    texts = {"slip_angle": slip_angle, "slip": slip, "camber": camber, "friction": friction, "distance": distance}
    given: dict[str, Any] = {
        name: read_quantity(OPTIONS[name][0], text, OPTIONS[name][1], **({"gt": 0} if name == "distance" else {}))
        for name, text in texts.items()
        if text is not None
    }
    kilometres = given.pop("distance", 0.0) / 1e3
    loaded = load(study, settings(changes), case)
    NEEDS.check(loaded)
    tread_table(loaded)
    of_drive = loaded.card.boundaries.sliding.rolls and not given
    given = {**DEFAULTS, **given}
    warn(loaded.warnings)
    place = out or Path("results") / f"{loaded.name}-wear"
    options = {name: option for name, (option, _) in OPTIONS.items()}
    no_section: InputError | None = None
    worn: dict[str, Any] | None = None
    with results_folder(place, "wear", FILES, origin=StudyOrigin(loaded), force=force) as folder:
        try:
            with progress(f"{loaded.name}: rolling"):
                rolled = None if of_drive else roll(loaded, **given)
                worn_off: RingWear = drive_wear(loaded) if rolled is None else ring_wear(rolled)
        except InputError as error:
            raise placed(error, options, given, loaded) from None
        try:
            worn = worn_section(loaded, worn_off, kilometres) if distance is not None else None
        except InputError as error:
            # The wear itself is computed, by minutes of rolling: it is written all the same.
            no_section = placed(error, options, given, loaded)
        write_files(loaded, rolled, worn_off, folder, worn, pictures=pictures)
    answer_with(folder / "summary.json")
    say(words(loaded, rolled, worn_off))
    say(f"results in {folder}{'' if no_section is None else ', without a worn section'}")
    if no_section is not None:
        raise no_section from None


#: Place among the commands.
ORDER = 48


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(wear)
