"""Options and helpers of all commands: ``--set``, ``--force``, ``--case``, shell completion."""

from __future__ import annotations

import math
import shlex
import tomllib
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tyrefem.cli.line import fail as fail
from tyrefem.cli.shell import notify
from tyrefem.errors import InputError

if TYPE_CHECKING:
    from tyrefem.api import Study


def warn(warnings: Iterable[object], printed: Collection[str] = ()) -> tuple[str, ...]:
    """Print every warning that is not in ``printed`` as a line on stderr; return all warnings as text."""
    lines = tuple(map(str, warnings))
    for line in dict.fromkeys(lines):
        if line not in printed:
            notify(f"warning: {line}")
    return lines


def complete_studies(incomplete: str) -> list[str]:
    """Names of studies, for shell completion."""
    from tyrefem import library

    return [name for name in library.names("study") if name.startswith(incomplete)]


StudyArgument = Annotated[
    str, typer.Argument(metavar="STUDY", help="A study's name or path.", autocompletion=complete_studies)
]
SetOption = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help="Change one value, e.g. drive.speed='25 mph'. Repeatable; the last of a name wins.",
    ),
]
ForceOption = Annotated[
    bool, typer.Option("--force", help="Replace files that this command did not write; an input is never replaced.")
]
CaseOption = Annotated[
    str | None, typer.Option("--case", metavar="NAME", help="Use this case of a campaign; --set changes its values.")
]


def _reduced(choice: str) -> str:
    if choice not in ("auto", "never"):
        raise InputError(f"'{choice}' is not allowed; allowed: auto, never", field="--reduced")
    return choice


ReducedOption = Annotated[
    str, typer.Option(callback=_reduced, help="Use reduced models that full runs confirm: auto, never.")
]


IgnoreOption = Annotated[list[str] | None, typer.Option(help="Leave out this column of the tables. Repeatable.")]
RenameOption = Annotated[
    list[str] | None,
    typer.Option(metavar="COLUMN=SENSOR", help="Name of a column's sensor in the study, or time or run. Repeatable."),
]


def renamed(pairs: list[str] | None) -> dict[str, str]:
    """Convert ``COLUMN=SENSOR`` arguments to column -> sensor.

    >>> renamed(["T1=crown-inner"])
    {'T1': 'crown-inner'}
    """
    sensors: dict[str, str] = {}
    for pair in pairs or []:
        column, equals, sensor = pair.rpartition("=")
        if not equals or not column.strip() or not sensor.strip():
            raise InputError(f"'{pair}' is not COLUMN=SENSOR, e.g. T1=crown-inner", field="--rename")
        given = sensors.setdefault(column.strip(), sensor.strip())
        if given != sensor.strip():
            message = f"column '{column.strip()}' has two names, '{given}' and '{sensor.strip()}'; give one of them"
            raise InputError(message, field="--rename")
    return sensors


def settings(pairs: list[str] | None) -> dict[str, Any]:
    """Convert ``KEY=VALUE`` arguments to changes, the last of a key; a value in TOML (number, list, table) is parsed.

    >>> settings(["drive.speed=25 mph", "materials.tread.loss_tangent.value=0.25"])
    {'drive.speed': '25 mph', 'materials.tread.loss_tangent.value': 0.25}
    """
    changes: dict[str, Any] = {}
    for pair in pairs or []:
        key, equals, text = pair.partition("=")
        if not equals or not key.strip():
            raise InputError(f"'{pair}' is not KEY=VALUE, e.g. drive.speed='25 mph'", field="--set")
        try:
            parsed = tomllib.loads(f"value = {text}")
        except (ValueError, RecursionError):  # beside errors of TOML: an endless number, or endless brackets
            parsed = {}
        changes[key.strip()] = parsed["value"] if len(parsed) == 1 else text
    return changes


def as_argument(file: Path) -> str:
    """A card's file as the next command takes it: a study's folder where the file has the usual name.

    >>> as_argument(Path("studies/mine/study.toml")), as_argument(Path("my cards/wide.toml"))
    ('studies/mine', "'my cards/wide.toml'")
    """
    return shlex.quote((file.parent if file.name == "study.toml" else file).as_posix())


#: Numbers that the first phase of the drive has where no option gives them.
OF_DRIVE = ("load", "deflection", "pressure", "drum_diameter")


def placed(error: InputError, options: Mapping[str, str], given: Collection[str], study: Study) -> InputError:
    """The error of a number with its option as field, or with the study's drive where no option gave the number.

    ``options``: name of a number -> its option. ``given``: names of the numbers that options gave.
    """
    name = error.field
    if error.file is not None or name is None:
        return error
    if name in OF_DRIVE and name not in given:
        return study.as_written(InputError(error.message, field=f"drive.phases.0.{name}", file=study.file))
    return InputError(error.message, field=options[name]) if name in options else error


@contextmanager
def options_named(options: Mapping[str, str]) -> Iterator[None]:
    """Errors in this block name the option of an argument. ``options``: name of an argument -> its option."""
    try:
        yield
    except InputError as error:
        field = options.get(error.field or "", error.field)
        raise InputError(error.message, field=field, file=error.file) from None


def read_quantity(option: str, text: str, unit: str, **bounds: float) -> float:
    """The quantity of an option, in SI; ``bounds`` as of `Unit`. A drum may be ``flat``: its diameter is infinite.

    Raises
    ------
    InputError : no such quantity; its field is the option.
    """
    from tyrefem.quantity import Unit

    if option == "--drum" and text.strip() == "flat":
        return math.inf
    try:
        return Unit(unit, **bounds)(text)
    except InputError as error:
        raise error.within(field=option) from None
