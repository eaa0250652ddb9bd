"""`tyrefem new`: start a card of one's own from a shipped one."""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from typing import Annotated

import typer

from tyrefem.cli.show import complete_names
from tyrefem.errors import InputError, nearest

DEFAULTS = {"study": "nasa-22x5.5-8pr", "section": "nasa-22x5.5-8pr", "material": "nasa-tread"}


def new(
    kind: Annotated[str, typer.Argument(help="study, section or material.")],
    name: Annotated[str, typer.Argument(help="Name of the new card: letters, digits, . _ -")],
    copy_of: Annotated[
        str | None, typer.Option("--from", help="The card to start from.", autocompletion=complete_names)
    ] = None,
) -> None:
    """Write a new study, section or material card into this folder, ready to be edited and found by name."""
    from tyrefem import library
    from tyrefem.output import atomic_path

    if kind not in DEFAULTS:
        raise InputError(f"no kind '{kind}'{nearest(kind, DEFAULTS)}")
    if not re.fullmatch(r"\w[\w.-]*", name):
        raise InputError(f"'{name}' is no name for a card; allowed: letters, digits, . _ -")
    source = library.find(kind, copy_of or DEFAULTS[kind], Path.cwd())
    folder = Path(library.FOLDERS[kind])
    target = folder / name / "study.toml" if kind == "study" else folder / f"{name}.toml"
    if target.exists() or (kind == "study" and target.parent.exists()):
        raise InputError("exists already; nothing was written", file=target)
    companions = [file for file in source.parent.glob("*.csv") if kind == "study"]
    for file in [source, *companions]:
        place = target if file == source else target.parent / file.name
        with atomic_path(place) as temporary:
            shutil.copyfile(file, temporary)
    typer.echo(f"{target} written, a copy of {source.parent.name if kind == 'study' else source.stem}")
    typer.echo(f"edit it, then: tyrefem check {target.parent if kind == 'study' else target}")


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(new)
