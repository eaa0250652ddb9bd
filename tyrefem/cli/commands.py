"""The commands, one module each, and the messages of their errors. Heavy imports happen inside the commands.

A process loads the module of its command alone, and for the list of commands no options: both take a tenth of a second.
"""

from __future__ import annotations

import functools
import importlib
import os
import pkgutil
import sys
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from types import ModuleType
from typing import Annotated, Any

import typer
import typer.main
from typer.core import TyperGroup

import tyrefem
from tyrefem.cli.shell import all_speak, notify
from tyrefem.errors import InputError, PluginWarning, ResultWarning
from tyrefem.estimates.work import LongWorkWarning
from tyrefem.output import reading

#: The command's name.
NAME = "tyrefem"


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


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"tyrefem {tyrefem.__version__}")
        raise typer.Exit


def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and stop.")
    ] = False,
) -> None:
    """Temperatures of a rolling tyre: from its section to a report."""


def _empty() -> typer.Typer:
    made = typer.Typer(
        name=NAME,
        cls=Commands,
        help="Temperatures of a rolling tyre: from its section to a report.",
        no_args_is_help=True,
        add_completion=True,
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"]},
    )
    made.callback()(_options)
    return made


def _module_names() -> list[str]:
    return [entry.name for entry in pkgutil.iter_modules([str(Path(__file__).parent)])]


def _modules() -> list[ModuleType]:
    """Every module of the package that has a ``register``; ``ORDER`` is its place in the help."""
    modules = [importlib.import_module(f"{__package__}.{name}") for name in _module_names() if name != "commands"]
    return sorted((module for module in modules if hasattr(module, "register")), key=lambda module: module.ORDER)


def _application(modules: Iterable[ModuleType]) -> typer.Typer:
    """The commands of some modules, each with the options ``--quiet`` and ``--json``."""
    made = _empty()
    for module in modules:
        module.register(made)
    all_speak(made)
    return made


@functools.cache
def whole() -> typer.Typer:
    """The application with all its commands."""
    return _application(_modules())


def __getattr__(name: str) -> Any:
    if name != "app":
        raise AttributeError(f"module 'tyrefem.cli.commands' has no attribute '{name}'")
    return whole()


@functools.cache
def _all_commands() -> Any:
    return typer.main.get_command(whole())


@functools.cache
def _listed() -> Any:
    """All commands without their options and parts: for the list of commands."""
    registered, bare = _empty(), _empty()
    for module in _modules():
        module.register(registered)
    for command in registered.registered_commands:
        bare.command(command.name)(_described(command.callback))
    for group in registered.registered_groups:
        assert group.typer_instance is not None
        bare.add_typer(typer.Typer(name=group.typer_instance.info.name, help=group.typer_instance.info.help))
    return typer.main.get_command(bare)


def _described(command: Callable[..., Any] | None) -> Callable[[], None]:
    def described() -> None:
        """Do nothing."""

    described.__name__, described.__doc__ = command.__name__, command.__doc__  # type: ignore[union-attr]
    return described


@functools.lru_cache(maxsize=64)
def _single(name: str) -> Any | None:
    """The application with the command of that name alone, from the module of that name; None: no such module."""
    module = name.replace("-", "_")
    # Not by the file of that name: where capital letters do not count, `RUN` would have one, and no module.
    if module not in _module_names():
        return None
    loaded = importlib.import_module(f"{__package__}.{module}")
    if not hasattr(loaded, "register"):
        return None
    made = typer.main.get_command(_application([loaded]))
    return made if name in made.commands else None  # type: ignore[attr-defined]


def _command(arguments: list[str]) -> Any:
    """The commands that a command line needs."""
    if any(name.startswith("_TYREFEM_COMPLETE") for name in os.environ):
        return _all_commands()
    if arguments in ([], ["-h"], ["--help"]):
        return _listed()
    single = _single(arguments[0])
    return _all_commands() if single is None else single


def run_command_line(arguments: list[str] | None) -> tuple[object, int]:
    """Run a command line; return its last line, or None, and its exit code."""
    try:
        given = sys.argv[1:] if arguments is None else arguments
        with reading(given), _warnings_shown():
            _refuse_empty_place(given)
            code = _command(given)(args=given, prog_name=NAME, standalone_mode=False)
    except InputError as error:
        return error, 2
    except OSError as error:
        return ": ".join(str(part) for part in (error.filename, error.strerror or error) if part), 2
    except SystemExit as end:
        return None, end.code if isinstance(end.code, int) else 0
    except Exception as error:
        return _handled_error(error)
    return None, code if isinstance(code, int) else 0


def _refuse_empty_place(arguments: list[str]) -> None:
    """Raise `InputError` for an empty ``--out``, as an unset variable of a shell gives: it would be this folder."""
    values = {f"{option}={value}" for option, value in pairwise(arguments)} | set(arguments)
    if "--out=" in values:
        raise InputError("is empty; give a path, '.' for this folder, or leave the option out", field="--out")


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
    """Handle usage errors of the parser, a solver without a solution, and names of files that are no text; raise any
    other error, which is a defect."""
    name = type(error).__name__
    if isinstance(error, UnicodeEncodeError) and "\ud800" <= error.object[error.start] <= "\udfff":
        return "the name of a file or folder is not UTF-8 text, so that no result can hold it: rename it", 2
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
    command = context.command_path if context is not None else NAME
    return f"{message()} (see '{command} --help')", code
