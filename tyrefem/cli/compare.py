"""`tyrefem compare`: deviation of a study from measured tables, K."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

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
from tyrefem.cli.progress import progress
from tyrefem.cli.shell import answer_with, notify, say
from tyrefem.interruption import keeping
from tyrefem.output.folder import results_folder
from tyrefem.threads import usable_cores

if TYPE_CHECKING:
    from concurrent.futures import Executor

    import pandas as pd


def compare(
    study: StudyArgument,
    table: Annotated[
        Path | None,
        typer.Argument(metavar="[TABLE]", help="CSV or Excel file of readings; default: the study's tables."),
    ] = None,
    changes: SetOption = None,
    case: CaseOption = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder; default: results/STUDY-compare.")] = None,
    ignore: IgnoreOption = None,
    rename: RenameOption = None,
    inputs: Annotated[
        bool, typer.Option(help="Propagate the cards' uncertainties into the validation uncertainty.")
    ] = True,
    k: Annotated[float, typer.Option("-k", min=0.1, help="Coverage factor of the validation uncertainty.")] = 2.0,
    workers: Annotated[int | None, typer.Option(min=1, help="Processes; default: one per core.")] = None,
    reduced: ReducedOption = "auto",
    force: ForceOption = False,
) -> None:
    """Compare a study with measured tables: deviation and validation uncertainty of each sensor, run and phase.

    The same command continues an interrupted one.
    """
    from tyrefem.api import study as load
    from tyrefem.compare.validation import NEEDS
    from tyrefem.inputs.origin import StudyOrigin
    from tyrefem.reports.comparison import FILES, save
    from tyrefem.variants.answer_store import PROGRESS, AnswerStore

    loaded = load(study, settings(changes), case)
    NEEDS.check(loaded, table)
    warn(loaded.warnings)
    place = out or Path("results") / f"{loaded.name}-compare"
    read = [table] if table else [entry.table for entry in loaded.measured]
    origin = StudyOrigin(loaded, simulated=True)
    keeps = [f"{PROGRESS}/*/*.npz"]
    with results_folder(place, "compare", FILES, origin=origin, inputs=read, force=force, keeps=keeps) as folder:
        store = AnswerStore(folder / PROGRESS)
        with (
            keeping(lambda: store.kept),
            progress(f"{loaded.name}: simulations", 1.0) as step,
            _side_by_side(workers or (usable_cores() if inputs else 1)) as executor,
        ):
            comparison = loaded.compare(
                table,
                ignore=tuple(ignore or ()),
                rename=renamed(rename),
                inputs=inputs,
                k=k,
                executor=executor,
                progress=lambda done, total: step(done / total),
                reduced=reduced,
                store=store,
                begin=notify,
            )
            save(comparison, folder)
        store.clear()
    answer_with(comparison.to_dict())
    say(_lines(comparison.table))
    say(comparison.summary)
    for note in comparison.notes:
        say(note if note.startswith(("Note: ", "ERROR: ")) else f"Note: {note}")
    say(f"results in {folder}; read {folder / 'comparison.html'}")


def _lines(table: pd.DataFrame) -> str:
    columns = ["run", "sensor", "phase", "n", "bias_K", "rms_K", "largest_K", "at_s", "u_val_K", "beyond"]
    formats = {"at_s": "{:.6g}".format}
    return str(table[columns].to_string(index=False, float_format="%.3g", formatters=formats))


@contextmanager
def _side_by_side(count: int) -> Iterator[Executor | None]:
    """An executor of ``count`` processes, or None if one process is enough."""
    if count < 2:
        yield None
        return
    from tyrefem.processes import processes

    with processes(count) as executor:
        yield executor


#: Place among the commands.
ORDER = 20


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(compare)
