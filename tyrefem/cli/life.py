"""`tyrefem life`: how long a study's tyre lasts, and where it fails first."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tyrefem.cli.common import (
    CaseOption,
    ForceOption,
    SetOption,
    StudyArgument,
    settings,
    warn,
)
from tyrefem.cli.progress import progress
from tyrefem.cli.shell import answer_with, say
from tyrefem.errors import InputError
from tyrefem.output.folder import results_folder

if TYPE_CHECKING:
    from tyrefem.fatigue.sensitivity import LifeShift


def life(
    study: StudyArgument,
    temperature: Annotated[
        str | None, typer.Option(help="One temperature everywhere, e.g. '80 degC': a quick look without a run.")
    ] = None,
    plateau: Annotated[
        bool, typer.Option("--plateau", help="Each phase at the temperatures of its end, not over time.")
    ] = False,
    sensitivity: Annotated[
        bool,
        typer.Option(help="Compute the shortest life for other speed, load, pressure, ambient and slip: a run each."),
    ] = True,
    pictures: Annotated[bool, typer.Option(help="Draw the PNG map.")] = True,
    vtk: Annotated[bool, typer.Option(help="Write the map for ParaView, life.vtu.")] = True,
    out: Annotated[Path | None, typer.Option("--out", help="Folder; default: results/STUDY-life.")] = None,
    force: ForceOption = False,
    changes: SetOption = None,
    case: CaseOption = None,
) -> None:
    """Distance until small flaws become cracks, by the strain cycle and the temperatures of a run; the places that
    fail first."""
    from tyrefem.api import study as load
    from tyrefem.fatigue.life import check
    from tyrefem.fatigue.life import life as life_of
    from tyrefem.fatigue.sensitivity import shifts, shifts_of
    from tyrefem.inputs.origin import StudyOrigin
    from tyrefem.reports.life import FILES, words, write_files

    given = None if temperature is None else _temperature(temperature)
    if given is not None and plateau:
        raise InputError("--temperature has no phases that warm up: leave out --plateau", field="--plateau")
    loaded = load(study, settings(changes), case)
    check(loaded)
    warn(loaded.warnings)
    place = out or Path("results") / f"{loaded.name}-life"
    with results_folder(place, "life", FILES, origin=StudyOrigin(loaded), force=force) as folder:
        with progress(f"{loaded.name}: life", loaded.card.drive.end) as step:
            computed = life_of(loaded, temperature=given, plateau=plateau, progress=step)
        write_files(computed, folder, pictures=pictures, vtk=vtk)
        moved: tuple[LifeShift, ...] = ()
        if sensitivity:
            with progress(f"{loaded.name}: {', '.join(shifts_of(loaded))}"):
                moved = shifts(computed)
            write_files(computed, folder, moved, pictures=False, vtk=False)
    answer_with(folder / "summary.json")
    say(words(computed, moved), f"results in {folder}")


def _temperature(text: str) -> float:
    from tyrefem.fatigue.life import HOTTEST
    from tyrefem.quantity import Unit

    try:
        return Unit("degC", le=HOTTEST)(text)
    except InputError as error:
        raise error.within(field="--temperature") from None


#: Place among the commands.
ORDER = 47


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(life)
