"""The commands, one module each, and the messages of their errors. Heavy imports happen inside the commands."""

from __future__ import annotations

import importlib
import pkgutil
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

import tyrefem
from tyrefem.cli.shell import all_speak, notify
from tyrefem.errors import InputError, PluginWarning, ResultWarning
from tyrefem.estimates.work import LongWorkWarning
from tyrefem.output import reading


class Stopped(BaseException):
    """Carries Ctrl-C through the parser, which would end the process without a message."""


class Commands(TyperGroup):
    """The group of all commands; passes Ctrl-C on."""

    def make_context(self, *given: Any, **named: Any) -> Any:
        """Read the command line."""
        try:
            return super().make_context(*given, **named)
        except KeyboardInterrupt as interruption:
            raise Stopped from interruption

    def invoke(self, *given: Any, **named: Any) -> Any:
        """Run the command."""
        try:
            return super().invoke(*given, **named)
        except KeyboardInterrupt as interruption:
            raise Stopped from interruption


app = typer.Typer(
    name="tyrefem",
    cls=Commands,
    help="Temperatures of a rolling tyre: from its section to a report.",
    no_args_is_help=True,
    add_completion=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"tyrefem {tyrefem.__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and stop.")
    ] = False,
) -> None:
    """Temperatures of a rolling tyre: from its section to a report."""


def _register() -> None:
    """Register every module of the package that has a ``register``; ``ORDER`` is its place in the help.

    Every command gets the options ``--quiet`` and ``--json``.
    """
    names = [entry.name for entry in pkgutil.iter_modules([str(Path(__file__).parent)]) if entry.name != "commands"]
    modules = [importlib.import_module(f"{__package__}.{name}") for name in names]
    commands = [module for module in modules if hasattr(module, "register")]
    for module in sorted(commands, key=lambda module: module.ORDER):
        module.register(app)
    all_speak(app)


_register()


def run_command_line(arguments: list[str] | None) -> tuple[object, int]:
    """Run a command line; return its last line, or None, and its exit code."""
    try:
        with reading(), _warnings_shown():
            code = app(args=arguments, prog_name=app.info.name, standalone_mode=False)
    except InputError as error:
        return error, 2
    except OSError as error:
        return ": ".join(str(part) for part in (error.filename, error.strerror or error) if part), 2
    except SystemExit as end:
        return None, end.code if isinstance(end.code, int) else 0
    except Exception as error:
        return _handled_error(error)
    return None, code if isinstance(code, int) else 0


@contextmanager
def _warnings_shown() -> Iterator[None]:
    """Print each warning as one line on stderr."""
    with warnings.catch_warnings():
        usual = warnings.showwarning

        def show(message: Warning | str, category: type[Warning], *rest: Any, **options: Any) -> None:
            if issubclass(category, LongWorkWarning | PluginWarning | ResultWarning):
                notify(f"warning: {message}")
            else:
                usual(message, category, *rest, **options)

        warnings.showwarning = show
        warnings.simplefilter("always", LongWorkWarning)
        warnings.simplefilter("always", ResultWarning)
        warnings.simplefilter("always", PluginWarning)
        yield


def _handled_error(error: Exception) -> tuple[object, int]:
    """Handle usage errors of the parser and a solver without a solution; raise any other error, which is a defect."""
    name = type(error).__name__
    if isinstance(error, typer.Abort):
        return "interrupted; nothing was written", 130
    if name == "SolverError":
        return f"no solution: {error}", 1
    # The parser's usage errors: their class is in click or in typer, depending on typer's version.
    message, code = getattr(error, "format_message", None), getattr(error, "exit_code", None)
    if not callable(message) or not isinstance(code, int):
        raise error
    if name == "NoArgsIsHelpError":
        typer.echo(message())
        return None, code
    context = getattr(error, "ctx", None)
    command = context.command_path if context is not None else app.info.name
    return f"{message()} (see '{command} --help')", code
