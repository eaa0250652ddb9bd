"""What every command says, and to whom: ``--json`` and ``--quiet`` of all commands, in this place alone.

stdout has the answer: lines for people, or with ``--json`` exactly one JSON object. stderr has messages: progress,
warnings, errors. With ``--quiet`` errors alone are left of both, and of a JSON object nothing is lost.
"""

from __future__ import annotations

import functools
import inspect
import os
import sys
from collections.abc import Callable, Mapping
from contextvars import ContextVar
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, get_type_hints

import typer

from tyrefem.cli.line import fail

#: End of a cell that does not fit; largest width of a table, letters.
CUT, WIDEST = "…", 1000
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print errors only.")]
Json = Annotated[
    bool, typer.Option("--json", help="Print the answer as one JSON object on stdout; docs/commands.md has its keys.")
]


@dataclass(frozen=True)
class Shell:
    """How the running command speaks."""

    quiet: bool = False
    as_json: bool = False
    #: The command's name and options, but for those that do not change its work.
    work: str = ""


_SHELL: ContextVar[Shell] = ContextVar("shell", default=Shell())  # noqa: B039, frozen


def shell() -> Shell:
    """How the running command speaks."""
    return _SHELL.get()


def say(*lines: object) -> None:
    """Print lines for people on stdout; nothing with ``--json`` or ``--quiet``."""
    if not (shell().quiet or shell().as_json):
        for line in lines:
            _print(f"{line}\n")


def say_table(table: Any) -> None:
    """Print a table of rich on stdout, as `say`."""
    if not (shell().quiet or shell().as_json):
        from rich.console import Console

        # A title or a name may have brackets or colons, which are no marks of rich.
        console = Console(highlight=False, markup=False, emoji=False)
        text = _drawn(console, table)
        if CUT in text:  # a number would be lost: in a narrow terminal the lines go on below
            console.width = WIDEST
            text = _drawn(console, table)
        _print(text)


def _drawn(console: Any, table: Any) -> str:
    with console.capture() as printed:
        console.print(table)
    return str(printed.get())


def _print(text: str) -> None:
    """Print text on stdout. A reader that has gone, such as `head`, gets no more, and the work goes on."""
    try:
        typer.echo(text, nl=False)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def notify(message: object) -> None:
    """Print a message that is no error as one line on stderr; nothing with ``--quiet``."""
    if not shell().quiet:
        fail(message)


def answer_with(data: Mapping[str, Any] | Path) -> None:
    """With ``--json``, print the answer: data, or a file that has it. A command has one answer."""
    if not shell().as_json:
        return
    if isinstance(data, Path):
        _print(data.read_text(encoding="utf-8"))
        return
    import json

    from tyrefem.output import jsonable

    _print(f"{json.dumps(jsonable(data), indent=1)}\n")


def speaking(command: Callable[..., Any]) -> Callable[..., Any]:
    """A command with the options ``--quiet`` and ``--json``; one that has them stays as it is."""
    if hasattr(command, "speaks"):
        return command
    given = inspect.signature(command)
    hints = get_type_hints(command, include_extras=True)
    usual = [part.replace(annotation=hints.get(part.name, part.annotation)) for part in given.parameters.values()]
    options = {"quiet": Quiet, "as_json": Json}

    @functools.wraps(command)
    def spoken(*, quiet: bool = False, as_json: bool = False, **values: Any) -> Any:
        options = {name: value for name, value in values.items() if name not in ("out", "force")}
        token = _SHELL.set(Shell(quiet, as_json, f"{command.__name__} {sorted(options.items())}"))
        try:
            return command(**values)
        finally:
            _SHELL.reset(token)

    added = [
        inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=False, annotation=kind)
        for name, kind in options.items()
    ]
    spoken.__signature__ = given.replace(parameters=[*usual, *added])  # type: ignore[attr-defined]
    spoken.__annotations__ = {**hints, **options}
    spoken.speaks = True  # type: ignore[attr-defined]
    return spoken


def all_speak(app: typer.Typer) -> None:
    """Give the two options to every command of an application and of its groups."""
    for command in app.registered_commands:
        assert command.callback is not None
        command.callback = speaking(command.callback)
    for group in app.registered_groups:
        assert group.typer_instance is not None
        all_speak(group.typer_instance)
