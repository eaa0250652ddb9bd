"""The command line: `run`, `compare`, `list`, `show`, `check`, `new`. Heavy imports happen inside the commands."""

from __future__ import annotations

import os
import sys
from typing import Annotated, Any

import typer

import tyrefem
from tyrefem.errors import InputError

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
    from tyrefem.cli import check, compare, listing, new, run, show

    for module in (run, compare, listing, show, check, new):
        module.register(app)


_register()


def fail(message: object, code: int = 2) -> int:
    """One line on stderr."""
    print(f"tyrefem: {message}", file=sys.stderr)
    return code


def main(arguments: list[str] | None = None) -> Any:
    """Entry point. Bad input ends with exit code 2 and one line; an interruption with 130."""
    try:
        code = app(args=arguments, standalone_mode=False)
    except InputError as error:
        code = fail(error)
    except KeyboardInterrupt:
        code = fail("interrupted", 130)
    except BrokenPipeError:
        # The reader of our output went away: point stdout elsewhere so that Python's exit stays silent.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        code = 0
    except Exception as error:
        code = _other(error)
    if arguments is not None:
        return code
    sys.exit(code if isinstance(code, int) else 0)


def _other(error: Exception) -> int:
    """Usage errors of the parser, and a solver that cannot go on; anything else is a defect and shows itself."""
    if isinstance(error, typer.Abort):
        return fail("interrupted", 130)
    if type(error).__name__ == "SolverError":
        return fail(f"no solution: {error}", 1)
    # The parser's usage errors: the class lives in click or inside typer, depending on typer's version.
    show, code = getattr(error, "show", None), getattr(error, "exit_code", None)
    if callable(show) and isinstance(code, int):
        show()
        return code
    raise error
