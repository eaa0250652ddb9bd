"""What the commands share: ``--set``, names to complete, progress on a terminal, JSON on stdout."""

from __future__ import annotations

import os
import sys
import tempfile
import tomllib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer

from tyrefem.errors import InputError


def fail(message: object, code: int = 2) -> int:
    """One line on stderr, whatever the message quotes from a file; gives back the exit code."""
    printable = "".join(letter if letter.isprintable() else " " for letter in str(message))
    print(f"tyrefem: {' '.join(printable.split())}", file=sys.stderr)
    return code


def writable_folder(folder: Path) -> Path:
    """The folder, or an error before any work is done: a file in its place, or no right to write.

    Nothing is made yet: a run that fails leaves no empty folder behind.
    """
    place = folder.absolute()
    while not os.path.lexists(place):
        place = place.parent
    if not place.is_dir():
        raise InputError("a file is in the place of this folder", file=place, field="--out")
    try:
        with tempfile.TemporaryFile(dir=place):
            return folder
    except OSError as error:
        raise InputError(f"cannot be written: {error.strerror or error}", file=place, field="--out") from None


def complete_studies(incomplete: str) -> list[str]:
    """Names of studies for shell completion."""
    from tyrefem import library

    return [name for name in library.names("study") if name.startswith(incomplete)]


StudyArgument = Annotated[
    str, typer.Argument(metavar="STUDY", help="A study's name or path.", autocompletion=complete_studies)
]
SetOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Change one value, e.g. drive.speed='25 mph'. Repeatable."),
]
JsonOption = Annotated[bool, typer.Option("--json", help="Print the result as JSON on stdout, nothing else.")]


def _reduced(choice: str) -> str:
    if choice not in ("auto", "never"):
        raise InputError(f"'{choice}' is not allowed; allowed: auto, never", field="--reduced")
    return choice


ReducedOption = Annotated[
    str, typer.Option(callback=_reduced, help="Reduced models where full runs bear them out: auto, never.")
]


IgnoreOption = Annotated[list[str] | None, typer.Option(help="A column of the tables to leave out. Repeatable.")]
RenameOption = Annotated[
    list[str] | None,
    typer.Option(metavar="COLUMN=SENSOR", help="A column that the study calls otherwise. Repeatable."),
]


def renamed(pairs: list[str] | None) -> dict[str, str]:
    """``COLUMN=SENSOR`` arguments as column -> sensor.

    >>> renamed(["T1=crown-inner"])
    {'T1': 'crown-inner'}
    """
    sensors = {}
    for pair in pairs or []:
        column, equals, sensor = pair.rpartition("=")
        if not equals or not column.strip() or not sensor.strip():
            raise InputError(f"'{pair}' is not COLUMN=SENSOR, e.g. T1=crown-inner", field="--rename")
        sensors[column.strip()] = sensor.strip()
    return sensors


def settings(pairs: list[str] | None) -> dict[str, Any]:
    """``KEY=VALUE`` arguments as changes; a value that is TOML (number, list, table) is taken as such.

    >>> settings(["drive.speed=25 mph", "materials.tread.loss_tangent.value=0.25"])
    {'drive.speed': '25 mph', 'materials.tread.loss_tangent.value': 0.25}
    """
    changes: dict[str, Any] = {}
    for pair in pairs or []:
        key, equals, text = pair.partition("=")
        if not equals or not key.strip():
            raise InputError(f"'{pair}' is not KEY=VALUE, e.g. drive.speed='25 mph'", field="--set")
        try:
            value = tomllib.loads(f"value = {text}")["value"]
        except tomllib.TOMLDecodeError:
            value = text
        changes[key.strip()] = value
    return changes


@contextmanager
def progress(description: str, total: float, *, quiet: bool = False) -> Iterator[Callable[[float], None]]:
    """A function that takes how far the work is; draws a bar on a terminal, nothing in a pipe."""
    if quiet or not sys.stderr.isatty():
        yield lambda _done: None
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(description, total=total)
        yield lambda done: bar.update(task, completed=done)


@contextmanager
def several(*, quiet: bool = False) -> Iterator[Callable[[str, int, int], None]]:
    """A function that takes what is done, how many, and of how many; a bar with the time left on a terminal."""
    if quiet or not sys.stderr.isatty():
        yield lambda what, done, total: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        tasks: dict[str, Any] = {}

        def tick(what: str, done: int, total: int) -> None:
            if what not in tasks:
                tasks[what] = bar.add_task(what, total=total)
            bar.update(tasks[what], completed=done, total=total)

        yield tick


def print_json(data: dict[str, Any]) -> None:
    """JSON on stdout."""
    import json

    from tyrefem.output import jsonable

    typer.echo(json.dumps(jsonable(data), indent=1))
