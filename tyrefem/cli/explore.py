"""`tyrefem explore`: one page on which every slider computes the drive anew, in the browser."""

from __future__ import annotations

from contextlib import nullcontext
from pathlib import Path
from typing import Annotated

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
from tyrefem.cli.progress import stages
from tyrefem.cli.shell import answer_with, say
from tyrefem.errors import InputError
from tyrefem.output.file import results_file
from tyrefem.threads import usable_cores


def explore(
    study: StudyArgument,
    vary: Annotated[
        list[str] | None,
        typer.Option(
            "--vary", metavar="KEY=FROM:TO", help="A number with a slider: FROM:TO, or factors x0.8:x1.2. Repeatable."
        ),
    ] = None,
    limit: Annotated[
        list[str] | None,
        typer.Option("--limit", metavar="ANSWER<VALUE", help="E.g. 'hottest_degC<110'. Repeatable."),
    ] = None,
    axes: Annotated[
        str | None, typer.Option(metavar="KEY,KEY", help="Numbers of the safe envelope; default: load and speed.")
    ] = None,
    tolerance: Annotated[
        str | None,
        typer.Option(
            help="Largest temperature error that the certificate allows; default: 0.3 K, 1 K with strain = 'fem' or "
            "'barrel'."
        ),
    ] = None,
    changes: SetOption = None,
    case: CaseOption = None,
    out: Annotated[Path | None, typer.Option("--out", help="File; default: results/STUDY-explore.html.")] = None,
    workers: Annotated[int | None, typer.Option(min=1, help="Processes; default: one per core.")] = None,
    force: ForceOption = False,
) -> None:
    """Explore a study: one HTML file with sliders, whose temperatures are computed in the browser.

    Full runs in the ranges of the sliders train a reduced model; fresh full runs certify it. The file needs no network.
    The ranges are those of --vary, else of the study's table explore, else a box about its drive, rubbers and films.
    """
    from tyrefem.api import study as loaded
    from tyrefem.cli.sweep_flags import questions_of_flags
    from tyrefem.inputs.origin import StudyOrigin
    from tyrefem.inputs.study_plugins import plugin_summary
    from tyrefem.realtime.box_checks import NEEDS
    from tyrefem.reports.explore import described, write_page
    from tyrefem.variants.schedulers import Here, Local

    flags = questions_of_flags(vary=vary, limit=limit)
    chosen = loaded(study, settings(changes), case)
    NEEDS.check(chosen)
    warn(chosen.warnings)
    path = out or Path("results") / f"{chosen.name}-explore.html"
    allowed = None if tolerance is None else read_quantity("--tolerance", tolerance, "delta_degC", gt=0)
    keys = None if axes is None else _pair(axes)
    count = workers or usable_cores()
    origin = StudyOrigin.beside(chosen, path)
    with (
        results_file(path, (".html",), origin=origin, force=force),
        Local(count) if count > 1 else nullcontext(Here()) as scheduler,
        stages() as tick,
    ):
        model = chosen.explore(
            flags.get("vary"),
            limits=flags.get("limits"),
            axes=keys,
            tolerance=allowed,
            scheduler=scheduler,
            progress=tick,
        )
        tick("page", 0, 1)
        write_page(model, path)
    warn(model.plan.warnings)
    keyed = [number.key for number in model.plan.varied]
    answer_with(
        {
            "file": path,
            "numbers": keyed,
            "modes": model.reduced.size,
            **vars(model.certificate),
            **plugin_summary(chosen),
        }
    )
    for line in described(model):
        say(line)
    say(f"wrote {path} ({path.stat().st_size / 1e6:.1f} MB): open it in a browser")


def _pair(text: str) -> tuple[str, str]:
    keys = [key.strip() for key in text.split(",")]
    if len(keys) != 2 or not all(keys):
        raise InputError(f"'{text}' is not KEY,KEY, e.g. drive.load,drive.speed", field="--axes")
    return keys[0], keys[1]


#: Place among the commands.
ORDER = 16.5


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(explore)
