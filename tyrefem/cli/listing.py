"""`tyrefem list`: names of cards, boundary laws and effects."""

from __future__ import annotations

from typing import Annotated

import typer

from tyrefem.cli.shell import answer_with, say
from tyrefem.errors import InputError, nearest

KINDS = {"sections": "section", "materials": "material", "studies": "study", "sweeps": "sweep"}


def complete_kinds(incomplete: str) -> list[str]:
    """Kinds, for shell completion."""
    return [kind for kind in [*KINDS, "laws", "effects"] if kind.startswith(incomplete)]


def show_list(
    kind: Annotated[
        str,
        typer.Argument(help="sections, materials, studies, sweeps, laws or effects.", autocompletion=complete_kinds),
    ] = "studies",
) -> None:
    """List sections, materials, studies or sweeps by name, the boundary laws, or the effects."""
    rows = _laws() if kind == "laws" else _effects() if kind == "effects" else _cards(kind)
    answer_with({"kind": kind, "entries": rows})


def _cards(kind: str) -> list[dict[str, str]]:
    if kind not in KINDS:
        raise InputError(f"no kind '{kind}'{nearest(kind, [*KINDS, 'laws', 'effects'])}")
    from tyrefem import library
    from tyrefem.cards import read_toml

    rows = []
    for name, path in sorted(library.names(KINDS[kind]).items()):
        try:
            title = str(read_toml(path).get("title", ""))
        except InputError as error:
            title = f"(cannot be read: {error.message})"
        say(f"{name:28} {title}")
        rows.append({"name": name, "title": title, "file": str(path)})
    return rows


def _laws() -> list[dict[str, str]]:
    from tyrefem.boundaries import laws

    rows = []
    for side in ("road", "outside_air", "contained_air", "rim", "sliding"):
        for name, law in sorted(laws(side).items()):
            first = (law.__doc__ or "").strip().splitlines()[0]
            say(f"{side:14} {name:10} {first}")
            rows.append({"name": name, "title": first, "side": side})
    return rows


def _effects() -> list[dict[str, str]]:
    from tyrefem.effects import catalogue
    from tyrefem.effects.description import by_family

    rows = []
    for family, members in by_family(catalogue()).items():
        for effect in members:
            say(f"{effect.name:28} {family:12} {effect.sentence}")
            rows.append({"name": effect.name, "title": effect.sentence, "family": family})
    return rows


#: Place among the commands.
ORDER = 30


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command(name="list")(show_list)
