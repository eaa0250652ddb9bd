"""`tyrefem diagnose`: find the gap, name the missing effect, add it, show the gap shrink."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from tyrefem.cli.common import (
    IgnoreOption,
    JsonOption,
    ReducedOption,
    RenameOption,
    SetOption,
    StudyArgument,
    fail,
    print_json,
    renamed,
    settings,
    writable_folder,
)

#: Folder within ``--out`` that holds finished simulations until the diagnosis is done.
PROGRESS = ".progress"
#: More processes than this gain little: the fits wait for each other.
MOST_WORKERS = 4


def diagnose(
    study: StudyArgument,
    table: Annotated[
        Path | None, typer.Argument(metavar="[TABLE]", help="CSV of thermocouple histories; default: the study's own.")
    ] = None,
    changes: SetOption = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder; default: results/STUDY-diagnosis.")] = None,
    ignore: IgnoreOption = None,
    rename: RenameOption = None,
    workers: Annotated[int | None, typer.Option(min=1, help="Processes; default: one per core, at most 4.")] = None,
    largest: Annotated[int, typer.Option(min=1, max=3, help="Most effects that may be missing at once.")] = 3,
    looks: Annotated[
        int, typer.Option(min=1, max=9, help="Diagnoses at most, each of what the one before it left unexplained.")
    ] = 3,
    reduced: ReducedOption = "auto",
    as_json: JsonOption = False,
) -> None:
    """Find where measurements and study disagree, name the missing effect, and write the study that has it.

    Interrupted, the same command goes on where it was.
    """
    from tyrefem.diagnose.progress_store import ProgressStore
    from tyrefem.studies import study as load

    found = load(study, settings(changes))
    folder = writable_folder(out or Path("results") / f"{found.name}-diagnosis")
    store = ProgressStore(folder / PROGRESS)
    try:
        with _progress(quiet=as_json) as tick:
            diagnosis = found.diagnose(
                table,
                ignore=tuple(ignore or ()),
                rename=renamed(rename),
                largest=largest,
                looks=looks,
                workers=workers or min(os.cpu_count() or 1, MOST_WORKERS),
                progress=tick,
                store=store,
                reduced=reduced,
            )
            tick("drawing", 0, 0)
            page = diagnosis.save(folder)
    except KeyboardInterrupt:
        kept = "; the same command goes on from there" if store.folder.is_dir() else ""
        raise typer.Exit(fail(f"interrupted; {store.count} finished simulations are kept{kept}", 130)) from None
    store.clear()
    if as_json:
        print_json(diagnosis.to_dict())
        return
    from tyrefem.diagnose.words import verdict_words

    if store.taken_up:
        typer.echo(f"{store.taken_up} simulations were taken up from an interrupted diagnosis")
    typer.echo(f"{diagnosis.verdict.upper()}: {verdict_words(diagnosis)[0]}")
    for sentence in verdict_words(diagnosis)[1:]:
        typer.echo(sentence)
    typer.echo(f"results in {folder}; read {page}, run {folder / 'amended.toml'}")


@contextmanager
def _progress(*, quiet: bool) -> Iterator[Callable[[str, int, int], None]]:
    """A function of what is done, how far, of how much (0: unknown); a bar on a terminal, nothing in a pipe."""
    if quiet or not sys.stderr.isatty():
        yield lambda _what, _done, _total: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    columns = (
        SpinnerColumn(), TextColumn("{task.description}"), BarColumn(bar_width=24), TextColumn("{task.fields[count]}"),
        TimeElapsedColumn(),
    )  # fmt: skip
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("reading", total=None, count="")

        def tick(what: str, done: int, total: int) -> None:
            count = f"{done} of {total}" if total else str(done or "")
            bar.update(task, description=what, completed=done if total else 0, total=total or None, count=count)

        yield tick


#: Place among the commands.
ORDER = 25


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(diagnose)
