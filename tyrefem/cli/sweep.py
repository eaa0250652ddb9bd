"""`tyrefem sweep`: compute many variants of a study, and write tables, pictures and one page."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from tyrefem.cli.common import (
    CaseOption,
    ForceOption,
    SetOption,
    complete_studies,
    fail,
    settings,
    warn,
)
from tyrefem.cli.progress import stages
from tyrefem.cli.shell import answer_with, say
from tyrefem.errors import InputError, Interrupted
from tyrefem.interruption import keeping
from tyrefem.output.folder import results_folder

#: Groups of options in the help.
VARIANTS, ANSWERS = "Variants", "Answers"
#: Largest number of failures that are printed.
FAILURES_SHOWN = 10


def complete(incomplete: str) -> list[str]:
    """Names of sweep files and studies for shell completion."""
    from tyrefem import library

    return [name for name in library.names("sweep") if name.startswith(incomplete)] + complete_studies(incomplete)


def sweep(
    study: Annotated[
        str,
        typer.Argument(metavar="STUDY|FILE", help="A study, or a sweep file: name or path.", autocompletion=complete),
    ],
    vary: Annotated[
        list[str] | None,
        typer.Option(
            "--vary",
            metavar="KEY=VALUES",
            help="FROM:TO, FROM:TO:LEVELS, a list A,B, or factors x0.8:x1.2. Repeatable.",
            rich_help_panel=VARIANTS,
        ),
    ] = None,
    link: Annotated[
        list[str] | None,
        typer.Option(
            "--link",
            metavar="NAME=KEY,KEY",
            help="A name for numbers that vary together; -KEY takes the negative value. Repeatable.",
            rich_help_panel=VARIANTS,
        ),
    ] = None,
    uncertain: Annotated[
        float | None,
        typer.Option(
            metavar="K",
            help="Also vary every uncertain number, within K standard deviations.",
            rich_help_panel=VARIANTS,
        ),
    ] = None,
    sample: Annotated[
        str | None,
        typer.Option(help="grid (default), latin-hypercube, sobol, saltelli or list.", rich_help_panel=VARIANTS),
    ] = None,
    count: Annotated[
        int | None, typer.Option(min=1, help="Number of variants; not for a grid or list.", rich_help_panel=VARIANTS)
    ] = None,
    seed: Annotated[
        int | None, typer.Option(min=0, help="Seed of the sample; default 1.", rich_help_panel=VARIANTS)
    ] = None,
    cases: Annotated[
        str | None, typer.Option(help="CSV or Excel file of variants (sample 'list').", rich_help_panel=VARIANTS)
    ] = None,
    limit: Annotated[
        list[str] | None,
        typer.Option(
            "--limit", metavar="ANSWER<VALUE", help="E.g. 'hottest_degC<110'. Repeatable.", rich_help_panel=VARIANTS
        ),
    ] = None,
    time_to: Annotated[
        str | None,
        typer.Option(help="Temperature; the time when it is first reached is an answer.", rich_help_panel=VARIANTS),
    ] = None,
    answer: Annotated[
        list[str] | None,
        typer.Option(
            "--answer",
            help="Answer to draw and evaluate; default: temperature, rolling resistance.",
            rich_help_panel=ANSWERS,
        ),
    ] = None,
    pareto: Annotated[
        list[str] | None,
        typer.Option(
            "--pareto",
            metavar="ANSWER=min|max",
            help="Objective of the Pareto front. Repeatable.",
            rich_help_panel=ANSWERS,
        ),
    ] = None,
    indices: Annotated[
        int | None,
        typer.Option(
            metavar="N", help="Sobol indices: Saltelli's sample of base N, a power of two.", rich_help_panel=ANSWERS
        ),
    ] = None,
    tornado: Annotated[
        bool, typer.Option("--tornado", help="Effect of each tolerance on the answers.", rich_help_panel=ANSWERS)
    ] = False,
    tolerance_of: Annotated[
        list[str] | None,
        typer.Option(
            "--tolerance-of",
            metavar="KEY=5%",
            help="Tolerance of the tornado; default: those of the cards. Repeatable.",
            rich_help_panel=ANSWERS,
        ),
    ] = None,
    minimise: Annotated[
        str | None,
        typer.Option(metavar="ANSWER", help="Minimise this answer within the limits.", rich_help_panel=ANSWERS),
    ] = None,
    maximise: Annotated[
        str | None,
        typer.Option(metavar="ANSWER", help="Maximise this answer within the limits.", rich_help_panel=ANSWERS),
    ] = None,
    runs: Annotated[
        int | None,
        typer.Option(min=20, help="Largest number of variants of the search; default 400.", rich_help_panel=ANSWERS),
    ] = None,
    envelope: Annotated[
        str | None,
        typer.Option(
            metavar="ANSWER<VALUE",
            help="Largest speed within this limit, over load and pressure.",
            rich_help_panel=ANSWERS,
        ),
    ] = None,
    loads: Annotated[
        str | None, typer.Option(help="Loads of the envelope: '1000 lbf,2000 lbf'.", rich_help_panel=ANSWERS)
    ] = None,
    pressures: Annotated[
        str | None, typer.Option(help="Pressures of the envelope: '70 psi,83 psi'.", rich_help_panel=ANSWERS)
    ] = None,
    speeds: Annotated[
        str | None,
        typer.Option(metavar="FROM:TO", help="Speeds of the envelope: '1 m/s:60 m/s'.", rich_help_panel=ANSWERS),
    ] = None,
    changes: SetOption = None,
    case: CaseOption = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder; default: results/STUDY-sweep.")] = None,
    reduced: Annotated[str, typer.Option(help="Use a certified reduced model: auto, never, always.")] = "auto",
    tolerance: Annotated[str, typer.Option(help="Largest error that the certificate allows.")] = "0.01 K",
    workers: Annotated[int | None, typer.Option(min=1, help="Processes; default: one per core.")] = None,
    scheduler: Annotated[
        str | None, typer.Option(metavar="tcp://HOST:PORT", help="Scheduler of a Dask cluster.")
    ] = None,
    restart: Annotated[
        bool, typer.Option("--restart", help="Compute the finished variants of the folder again.")
    ] = False,
    pictures: Annotated[bool, typer.Option(help="Draw the pictures and the page.")] = True,
    vtk: Annotated[
        list[str] | None,
        typer.Option(
            "--vtk", metavar="VARIANT|front", help="Run this variant in full, for ParaView; front: the Pareto front."
        ),
    ] = None,
    force: ForceOption = False,
) -> None:
    """Compute many variants of a study; write tables (CSV, Parquet), pictures and one page.

    Response curves and maps, Pareto front, Sobol indices, tornado, optimum, safe envelope. Finished variants are kept:
    the same command continues an interrupted one.
    """
    from tyrefem.cli.sweep_flags import computed_design, questions, questions_of_flags
    from tyrefem.inputs.origin import StudyOrigin
    from tyrefem.quantity import parse
    from tyrefem.reports.sweep_files import file_names, kept_names, save
    from tyrefem.reports.sweep_variants import chosen_variants, refuse_unknown, write_variants
    from tyrefem.variants.execution import Execution

    if scheduler is not None and workers is not None:
        raise InputError("a cluster has its workers: leave it out with --scheduler", field="--workers")
    given = questions_of_flags(
        vary=vary, link=link, uncertain=uncertain, sample=sample, count=count, seed=seed, cases=cases, limit=limit,
        time_to=time_to, answer=answer, pareto=pareto, indices=indices, tornado=tornado, tolerance_of=tolerance_of,
        minimise=minimise, maximise=maximise, runs=runs, envelope=envelope, loads=loads, pressures=pressures,
        speeds=speeds,
    )  # fmt: skip
    try:
        how = Execution(restart=restart, reduced=reduced, tolerance=parse(tolerance, "delta_degC"))
    except InputError as error:
        raise InputError(error.message, field=f"--{error.field or 'tolerance'}") from None
    name, wanted = questions(study, given, settings(changes), case)
    refuse_unknown(wanted.plan, vtk or ())
    warn(wanted.warnings)
    origin = StudyOrigin(wanted.study, simulated=True, random_seed=wanted.card.seed)
    place = out or Path("results") / f"{name}-sweep"
    with (
        results_folder(place, "sweep", file_names(), origin=origin, force=force, keeps=kept_names()) as folder,
        stages() as tick,
    ):
        kept = f"finished variants are in {folder}; the same command resumes from there"
        begun = [folder / name for name in kept_names()]
        with keeping(lambda: kept if any(file.exists() for file in begun) else "nothing was written"):
            design = computed_design(wanted, how.given({"folder": folder, "progress": tick}), scheduler, workers)
        tick("drawing", 0, 1)
        with keeping(kept):
            summary = save(design, folder, pictures=pictures)
            if vtk and not design.interrupted:
                tick("VTK", 0, 1)
                write_variants(design, folder, chosen_variants(design, vtk))
    answer_with(folder / "summary.json")
    say(*summary["words"])
    say(f"results in {folder}" + (f"; read {folder / 'sweep.html'}" if pictures else ""))
    failures = design.failures
    for run, reason in list(failures.items())[:FAILURES_SHOWN]:
        fail(f"{f'variant {run}' if run in design.failed else run}: {reason}")
    if len(failures) > FAILURES_SHOWN:
        fail(f"... and {len(failures) - FAILURES_SHOWN} more; all are in the tables of {folder}")
    if design.interrupted == "interrupted":
        raise Interrupted(kept)
    if design.interrupted:
        raise typer.Exit(fail(f"{design.interrupted}; {kept}", 1))
    if failures:
        raise typer.Exit(1)


#: Place among the commands.
ORDER = 15


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(sweep)
