"""`tyrefem new`: start a card of one's own from a shipped one."""

from __future__ import annotations

import os
import re
import shutil
from pathlib import Path
from typing import Annotated, Any

import typer

from tyrefem.cli.show import complete_names
from tyrefem.errors import InputError, nearest
from tyrefem.interruption import interruption_delayed

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
    from tyrefem.output import atomic_path, place_of_output

    if kind not in DEFAULTS:
        raise InputError(f"no kind '{kind}'{nearest(kind, DEFAULTS)}")
    if not re.fullmatch(r"\w[\w.-]*", name) or name.endswith(".toml"):
        raise InputError(f"'{name}' is no name for a card; allowed: letters, digits, . _ -, not '.toml' at the end")
    source = library.find(kind, copy_of or DEFAULTS[kind])
    folder = Path(library.FOLDERS[kind])
    target = folder / name / "study.toml" if kind == "study" else folder / f"{name}.toml"
    if os.path.lexists(target) or (kind == "study" and os.path.lexists(target.parent)):
        raise InputError("exists already; nothing was written", file=target)
    place_of_output(target.parent)
    files = {target: source} | {target.parent / name: source.parent / name for name in _companions(kind, source)}
    first_line, note = _of_the_other_tyre(kind, source)
    with interruption_delayed():
        for place, file in files.items():
            with atomic_path(place) as temporary:
                shutil.copyfile(file, temporary)
                if place == target and first_line:
                    temporary.write_text(first_line + file.read_text(encoding="utf-8-sig"), encoding="utf-8")
    typer.echo(f"{target} written, a copy of {source.parent.name if kind == 'study' else source.stem}")
    if note:
        typer.echo(f"note: {note}")
    typer.echo(f"edit it, then: tyrefem check {target.parent if kind == 'study' else target}")


def _of_the_other_tyre(kind: str, source: Path) -> tuple[str, str]:
    """What a copy must say of numbers that are one tyre's and no other's: a line for the file, one for the screen."""
    if kind == "study":
        from tyrefem.api import study

        try:
            copied = study(source)
        except InputError:
            return "", ""  # what is wrong with it is the copy's to be mended
        section, names = copied.card.made_for or copied.new_section.name, ", ".join(copied.card.of_one_tyre)
        if not names:
            return "", ""
        line = (
            f'made_for = "{section}"     # the section that these are of: {names}\n' if not copied.card.made_for else ""
        )
        return line, f"of section '{section}' and of no other (made_for): {names}; with another section the study warns"
    if kind == "section":
        from tyrefem.cards import read_toml

        data: dict[str, Any] = read_toml(source)
        kept = [name for name in ("rating", "parameters.inner_volume") if _has(data, name)]
        if kept:
            words = f"of {source.stem} and of no other tyre: {' and '.join(kept)}"
            return f"# A copy of {source.stem}; {words}.\n", words
    return "", ""


def _has(data: dict[str, Any], name: str) -> bool:
    for part in name.split("."):
        if not isinstance(data, dict) or part not in data:
            return False
        data = data[part]
    return True


def _companions(kind: str, source: Path) -> list[Path]:
    """Files beside a study that it names: its tables and its mesh. A card further away stays where it is."""
    from tyrefem.cards import read_toml

    if kind != "study":
        return []
    data: dict[str, Any] = read_toml(source)
    measured = data.get("measured")
    named = [data.get("cases"), *(entry.get("table") for entry in measured or [] if isinstance(entry, dict))]
    if isinstance(data.get("mesh"), dict):
        named.append(data["mesh"].get("file"))
    names = [Path(name) for name in dict.fromkeys(named) if isinstance(name, str)]
    inside = [name for name in names if not name.is_absolute() and ".." not in name.parts]
    return [name for name in inside if (source.parent / name).is_file()]


#: Place among the commands.
ORDER = 60


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(new)
