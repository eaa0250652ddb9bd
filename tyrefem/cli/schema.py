"""`tyrefem schema`: JSON schemas of all files, for editors."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from tyrefem.cli.common import ForceOption
from tyrefem.cli.progress import progress
from tyrefem.cli.shell import answer_with, say


def schema(
    out: Annotated[Path, typer.Option("--out", help="Folder of the schemas.")] = Path("schemas"),
    force: ForceOption = False,
) -> None:
    """Write JSON schemas of studies, sections, materials, sweeps, rigs, thermal cards: editors complete and check keys.

    Your own effects and cards are in them. Taplo and VS Code read .taplo.toml, written in this folder.
    """
    from tyrefem import __version__
    from tyrefem.output import atomic_path, write_json
    from tyrefem.output.folder import results_folder
    from tyrefem.schemas.line import BEGINS, SETTINGS
    from tyrefem.schemas.written import settings, texts

    with progress("schemas"):
        made = texts()
    with results_folder(out, "schema", [*made], origin=None, force=force) as folder:
        for name, text in made.items():
            with atomic_path(folder / name) as temporary:
                temporary.write_text(text, encoding="utf-8")
        # Numerical libraries have no part in schemas: a folder kept with a project is the same on every machine.
        write_json({"versions": {"tyrefem": __version__}, "schemas": [*made]}, folder / "summary.json")
    names = ", ".join(name.removesuffix(".json") for name in made)
    say(f"{len(made)} schemas in {out}: {names}")
    place, rules = Path(SETTINGS), settings(_from_here(out))
    kept = os.path.lexists(place) and not force and not _written_here(place)
    if not kept:
        with atomic_path(place) as temporary:
            temporary.write_text(rules, encoding="utf-8")
    answer_with({"folder": out, "schemas": [*made], "settings": None if kept else place})
    if kept:
        say(f"{place} is your own and was kept; these lines in it tell the schemas:")
        say(rules.rstrip())
    else:
        say(f"{place} here: Taplo, and VS Code with the extension 'Even Better TOML', complete and check")
    say(f"a single file says its schema in its first line: {BEGINS}{out.as_posix()}/study.json")


def _from_here(folder: Path) -> str:
    """The path from the current folder, with ``/`` on every system; the whole path to another drive of Windows."""
    try:
        return Path(os.path.relpath(folder)).as_posix()
    except ValueError:
        return Path(os.path.abspath(folder)).as_posix()


def _written_here(place: Path) -> bool:
    """Whether the editor's settings are as this command wrote them; rules that a person added would be lost."""
    from tyrefem.schemas.written import are_settings

    try:
        return are_settings(place.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError):
        return False


#: Place among the commands.
ORDER = 65


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(schema)
