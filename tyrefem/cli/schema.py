"""`tyrefem schema`: JSON schemas of all files, for editors."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from tyrefem.cli.common import ForceOption


def schema(
    out: Annotated[Path, typer.Option("--out", help="Folder of the schemas.")] = Path("schemas"),
    force: ForceOption = False,
) -> None:
    """Write JSON schemas of studies, sections, materials, sweeps and rigs: editors then complete keys and check them.

    Your own effects and cards are in them. Taplo and VS Code read .taplo.toml, written beside the folder.
    """
    from tyrefem.output import atomic_path
    from tyrefem.output.file import made_by_this_tool, results_file
    from tyrefem.schemas.line import BEGINS, SETTINGS
    from tyrefem.schemas.written import settings, texts

    folder = Path(os.path.abspath(out))
    place = folder.parent / SETTINGS
    kept = os.path.lexists(place) and not force and not made_by_this_tool(place)
    made = texts()
    files = [folder / name for name in made]
    with results_file(files[0], (".json",), also=[*files[1:], *([] if kept else [place])], force=force):
        for file, text in zip(files, made.values(), strict=True):
            with atomic_path(file) as temporary:
                temporary.write_text(text, encoding="utf-8")
        if not kept:
            with atomic_path(place) as temporary:
                temporary.write_text(settings(folder), encoding="utf-8")
    typer.echo(f"{len(made)} schemas in {out}: {', '.join(name.removesuffix('.json') for name in made)}")
    if kept:
        typer.echo(f"{place} is your own and was kept; these lines in it would tell it the schemas:")
        typer.echo(settings(folder), nl=False)
    else:
        typer.echo(
            f"{SETTINGS} beside it: Taplo, and VS Code with the extension 'Even Better TOML', complete and check"
        )
    typer.echo(f"a single file says its schema in its first line: {BEGINS}{out.as_posix()}/study.json")


#: Place among the commands.
ORDER = 65


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(schema)
