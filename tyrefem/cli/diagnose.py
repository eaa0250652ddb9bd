"""`tyrefem diagnose`: find the gap, name the missing effect, add it, show the gap shrink."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tyrefem.brief import counted
from tyrefem.cli.common import (
    CaseOption,
    ForceOption,
    IgnoreOption,
    ReducedOption,
    RenameOption,
    SetOption,
    StudyArgument,
    renamed,
    settings,
    warn,
)
from tyrefem.cli.progress import stages
from tyrefem.cli.shell import answer_with, say
from tyrefem.errors import InputError, nearest
from tyrefem.interruption import keeping
from tyrefem.output import SUMMARY, write_json
from tyrefem.output.folder import results_folder
from tyrefem.threads import usable_cores

if TYPE_CHECKING:
    from tyrefem.api.diagnosis import Diagnosis

#: More processes gain little, because the fits wait for each other.
MOST_WORKERS = 4


def diagnose(
    study: StudyArgument,
    table: Annotated[
        Path | None,
        typer.Argument(metavar="[TABLE]", help="CSV or Excel file of readings; default: the study's tables."),
    ] = None,
    changes: SetOption = None,
    case: CaseOption = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder; default: results/STUDY-diagnosis.")] = None,
    ignore: IgnoreOption = None,
    rename: RenameOption = None,
    workers: Annotated[int | None, typer.Option(min=1, help="Processes; default: one per core, at most 4.")] = None,
    largest: Annotated[int, typer.Option(min=1, max=3, help="Largest number of effects missing together.")] = 3,
    looks: Annotated[
        int,
        typer.Option(
            min=1, max=9, help="Largest number of diagnoses; each diagnoses the study that the last one amended."
        ),
    ] = 3,
    reduced: ReducedOption = "auto",
    strategy: Annotated[
        str, typer.Option(help="forward: sets grow effect by effect; exhaustive: all sets, for few effects.")
    ] = "forward",
    effects: Annotated[
        Path | None, typer.Option("--effects", help="Folder with effects of your own, such as drafts of a diagnosis.")
    ] = None,
    calibration: Annotated[
        Path | None, typer.Option(help="Folder of tyrefem isolability --calibrate, for a set with known coverage.")
    ] = None,
    force: ForceOption = False,
) -> None:
    """Find where measurements and study disagree, name the missing effect, and write the amended study.

    The same command continues an interrupted one.
    """
    from tyrefem.diagnose.forward.worker_queues import start_others, started_workers

    if effects is not None:
        from tyrefem.effects import use_effects

        use_effects(effects)  # workers that start later know them, too
    # Workers import their modules while this process, which needs a core, imports its own and reads the study.
    cores = usable_cores()
    at_once = max(cores - 1, 1)
    with started_workers(workers or min(cores, MOST_WORKERS), at_once) as processes:
        from tyrefem.api import study as load
        from tyrefem.diagnose.forward.evaluations import ProgressStore
        from tyrefem.diagnose.options import STRATEGIES
        from tyrefem.diagnose.workflow import NEEDS
        from tyrefem.inputs.origin import StudyOrigin
        from tyrefem.reports.diagnosis import FILES, save
        from tyrefem.variants.answer_store import PROGRESS

        start_others(processes, at_once)
        loaded = load(study, settings(changes), case)
        NEEDS.check(loaded, table)
        if strategy not in STRATEGIES:
            raise InputError(f"--strategy: there is no '{strategy}'{nearest(strategy, STRATEGIES)}")
        warn(loaded.warnings)
        place = out or Path("results") / f"{loaded.name}-diagnosis"
        read = [table] if table else [entry.table for entry in loaded.measured]
        origin = StudyOrigin(loaded, simulated=True)
        keeps = [f"{PROGRESS}*/*/*.npz"]
        with results_folder(place, "diagnose", FILES, origin=origin, inputs=read, force=force, keeps=keeps) as folder:
            store = ProgressStore(folder / PROGRESS)
            with keeping(lambda: store.kept), stages() as tick:
                tick("reading", 0, 0)
                diagnosis = loaded.diagnose(
                    table,
                    ignore=tuple(ignore or ()),
                    rename=renamed(rename),
                    largest=largest,
                    looks=looks,
                    workers=processes,
                    progress=tick,
                    store=store,
                    reduced=reduced,
                    strategy=STRATEGIES[strategy],
                    calibration=calibration,
                )
                tick("drawing", 0, 0)
                used = [candidate.name for candidate in diagnosis.candidates]
                write_json(origin.using(used).summary(), folder / SUMMARY)
                page = save(diagnosis, folder, processes)
            store.clear()
    answer_with(diagnosis.to_dict())
    _tell(diagnosis, folder, page, store.resumed)


def _tell(diagnosis: Diagnosis, folder: Path, page: Path, resumed: int) -> None:
    """Print the verdict, and where its files are; ``resumed``: simulations of an interrupted diagnosis."""
    from tyrefem.diagnose.words.draft_effect import EFFECTS, draft_effects
    from tyrefem.diagnose.words.headline import QUESTIONS, headline, label
    from tyrefem.diagnose.words.missing_heat import missing_heat_words
    from tyrefem.diagnose.words.sentences import noise_words

    if resumed:
        say(f"{counted(resumed, 'simulation')} of an interrupted diagnosis {'was' if resumed == 1 else 'were'} reused")
    for question, sentence in zip((label(diagnosis).upper(), *QUESTIONS[1:]), headline(diagnosis), strict=True):
        say(f"{question}: {sentence}")
    conformal = () if diagnosis.conformal is None else (diagnosis.conformal.words(diagnosis.judgement.ranking),)
    for sentence in (*missing_heat_words(diagnosis), *conformal, *noise_words(diagnosis)):
        say(sentence)
    for name in draft_effects(diagnosis):
        say(
            f"draft effect: {folder / EFFECTS / name}; judge it by: tyrefem diagnose STUDY --effects "
            f"{shlex.quote(str(folder / EFFECTS))}"
        )
    for note in dict.fromkeys(note for look in diagnosis.looks for note in look.notes):
        say(note if note.startswith("ERROR: ") else f"Note: {note}")
    say(f"results in {folder}; read {page}, run {folder / 'amended.toml'}")


#: Place among the commands.
ORDER = 25


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(diagnose)
