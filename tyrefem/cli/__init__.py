"""The command line, one module per command. Heavy imports happen inside the commands."""

from __future__ import annotations

import gc
import importlib
import pkgutil
import sys
from typing import Annotated

import typer

import tyrefem
from tyrefem.cli.common import fail
from tyrefem.errors import InputError
from tyrefem.output import reading

app = typer.Typer(
    name="tyrefem",
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
    """Every module of this package that has a ``register`` is a command; ``ORDER`` is its place in the help."""
    modules = [importlib.import_module(f"{__name__}.{found.name}") for found in pkgutil.iter_modules(__path__)]
    commands = [module for module in modules if hasattr(module, "register")]
    for module in sorted(commands, key=lambda module: module.ORDER):
        module.register(app)


_register()


def main(arguments: list[str] | None = None) -> int:
    """Run a command line and give its exit code; without ``arguments`` take the process's own and end it.

    0: done. 1: no solution, or a case of a campaign failed. 2: bad input, said in one line. 130: interrupted.
    """
    code = _guarded(arguments)
    if arguments is None:
        sys.exit(code)
    return code


def _guarded(arguments: list[str] | None) -> int:
    # Importing makes many objects and no garbage: looking for it every 700 objects takes a tenth of a short run.
    gc.set_threshold(100_000)
    try:
        with reading():
            code = app(args=arguments, prog_name=app.info.name, standalone_mode=False)
    except InputError as error:
        return fail(error)
    except KeyboardInterrupt:
        return fail("interrupted", 130)
    except OSError as error:
        return fail(": ".join(str(part) for part in (error.filename, error.strerror or error) if part))
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else 0
    except Exception as error:
        return _other(error)
    return code if isinstance(code, int) else 0


def _other(error: Exception) -> int:
    """Usage errors of the parser, and a solver that cannot go on; anything else is a defect and shows itself."""
    if isinstance(error, typer.Abort):
        return fail("interrupted", 130)
    name = type(error).__name__
    if name == "SolverError":
        return fail(f"no solution: {error}", 1)
    # The parser's usage errors: the class lives in click or inside typer, depending on typer's version.
    message, code = getattr(error, "format_message", None), getattr(error, "exit_code", None)
    if not callable(message) or not isinstance(code, int):
        raise error
    if name == "NoArgsIsHelpError":
        typer.echo(message())
        return code
    context = getattr(error, "ctx", None)
    command = context.command_path if context is not None else app.info.name
    return fail(f"{message()} ('{command} --help' tells more)", code)
