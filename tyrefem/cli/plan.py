"""`tyrefem plan`: the next runs and sensors that are expected to tell the remaining effects apart, at what cost."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from tyrefem.cli.common import (
    CaseOption,
    ForceOption,
    IgnoreOption,
    RenameOption,
    SetOption,
    StudyArgument,
    renamed,
    settings,
    warn,
)
from tyrefem.cli.progress import stages
from tyrefem.cli.shell import answer_with, say
from tyrefem.errors import InputError
from tyrefem.interruption import keeping
from tyrefem.output import SUMMARY, write_json
from tyrefem.output.folder import results_folder
from tyrefem.threads import usable_cores

#: More processes gain little.
MOST_WORKERS = 4


def plan(
    study: StudyArgument,
    after: Annotated[
        Path | None,
        typer.Argument(
            metavar="[TABLE|FOLDER]",
            help="CSV or Excel file of readings, or the folder of an earlier diagnosis; default: before any data.",
        ),
    ] = None,
    changes: SetOption = None,
    case: CaseOption = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder; default: results/STUDY-plan.")] = None,
    ignore: IgnoreOption = None,
    rename: RenameOption = None,
    workers: Annotated[int | None, typer.Option(min=1, help="Processes; default: one per core, at most 4.")] = None,
    force: ForceOption = False,
) -> None:
    """Propose the next runs and sensors that tell the remaining effects apart best, before a test or after a verdict.

    Limits and costs stand in the study's [plan] table. The same command continues an interrupted one.
    """
    from tyrefem.api import study as load
    from tyrefem.diagnose.forward.evaluations import ProgressStore
    from tyrefem.diagnose.words.set_posteriors import POSTERIOR
    from tyrefem.inputs.origin import StudyOrigin
    from tyrefem.plan.information import SEED
    from tyrefem.plan.workflow import NEEDS
    from tyrefem.reports.plan import FILES, save
    from tyrefem.variants.answer_store import PROGRESS

    loaded = load(study, settings(changes), case)
    NEEDS.check(loaded)
    is_folder = after is not None and after.is_dir()
    if (ignore or rename) and (after is None or is_folder):
        raise InputError("is for a table of readings; none is given", field="--ignore" if ignore else "--rename")
    warn(loaded.warnings)
    place = out or Path("results") / f"{loaded.name}-plan"
    read = [] if after is None else [after / POSTERIOR] if is_folder else [after]
    origin = StudyOrigin(loaded, simulated=True, random_seed=SEED)
    keeps = [f"{PROGRESS}*/*/*.npz"]
    with results_folder(place, "plan", FILES, origin=origin, inputs=read, force=force, keeps=keeps) as folder:
        store = ProgressStore(folder / PROGRESS)
        with keeping(lambda: store.kept), stages() as tick:
            table = after is not None and not is_folder
            result = loaded.plan(
                after,
                workers=workers or min(usable_cores(), MOST_WORKERS),
                progress=tick,
                store=store,
                ignore=tuple(ignore or ()) if table else None,
                rename=renamed(rename) if table else None,
            )
            tick("drawing", 0, 0)
            write_json(origin.using(result.to_dict()["plugins"]).summary(), folder / SUMMARY)
            page = save(result, folder)
        store.clear()
    answer_with(result.to_dict())
    for line in result.words:
        say(line)
    say(f"results in {folder}; read {page}")


#: Place among the commands.
ORDER = 26.5


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(plan)
