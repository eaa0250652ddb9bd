"""`tyrefem blind`: diagnose synthetic data with hidden effects, and count how often the diagnosis is right."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from tyrefem.cli.common import (
    CaseOption,
    ForceOption,
    ReducedOption,
    SetOption,
    StudyArgument,
    settings,
    warn,
)
from tyrefem.cli.progress import progress
from tyrefem.cli.shell import answer_with, say
from tyrefem.output import SUMMARY, write_json
from tyrefem.output.folder import results_folder
from tyrefem.threads import usable_cores


def _data_model(name: str) -> str:
    from tyrefem.diagnose.blind.rates import checked_model

    return checked_model(name, "--truth")


def blind(
    study: StudyArgument,
    cases: Annotated[int, typer.Option(min=1, max=10_000, help="Number of cases.")] = 20,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the hidden effects and of the noise.")] = 1,
    changes: SetOption = None,
    case: CaseOption = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder; default: results/STUDY-blind.")] = None,
    workers: Annotated[int | None, typer.Option(min=1, help="Processes; default: one per core.")] = None,
    reduced: ReducedOption = "auto",
    data_model: Annotated[
        str, typer.Option("--truth", callback=_data_model, help="Model of the data: ordinary, structural.")
    ] = "ordinary",
    force: ForceOption = False,
) -> None:
    """Hide effects in synthetic data for this study's sensors and runs; report how often the diagnosis is right.

    Structural data come from a model with another strain energy, other gauges, films, mesh and time integration.
    Finished cases are kept: the same command continues an interrupted one.
    """
    from tyrefem.api import study as load
    from tyrefem.diagnose.blind.rates import NEEDS, run_blind
    from tyrefem.inputs.origin import StudyOrigin
    from tyrefem.reports.blind import FILES, save
    from tyrefem.variants.answer_store import PROGRESS

    loaded = load(study, settings(changes), case)
    NEEDS.check(loaded)
    warn(loaded.warnings)
    place = out or Path("results") / f"{loaded.name}-blind"
    origin = StudyOrigin(loaded, simulated=True, random_seed=seed)
    keeps = ["cases/*.json", f"{PROGRESS}/*/*.npz"]
    with (
        results_folder(place, "blind", FILES, origin=origin, force=force, keeps=keeps) as folder,
        progress(f"{loaded.name}: {cases} cases", 1.0) as step,
    ):
        cores, tick = workers or usable_cores(), lambda done: step(done / cases)
        result = run_blind(loaded, cases, seed, folder, cores, tick, reduced=reduced, truth=data_model)
        write_json(origin.using(list(result.plugins)).summary(), folder / SUMMARY)
        save(result, folder)
    answer_with(result.to_dict())
    for line in result.words():
        say(line)
    say(f"results in {folder}")


#: Place among the commands.
ORDER = 27


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(blind)
