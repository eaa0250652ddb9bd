"""Files of a rig: its card, found by path or name, and the measured tables of its runs."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from tyrefem import library
from tyrefem.cards import read_toml
from tyrefem.cards.file_kinds import expect_kind
from tyrefem.errors import InputError, nearest
from tyrefem.heating_test.card import RigCard
from tyrefem.output import as_path


def find(name: str | Path) -> Path:
    """The file of a rig, by path, by folder with a ``rig.toml``, or by name of a shipped rig.

    >>> find("trtlab").name
    'rig.toml'
    """
    path = as_path(name, "rig")
    for option in (path, path / "rig.toml"):
        if option.is_file():
            return option
    known: dict[str, Path] = {}
    for root in library.roots():
        for file in sorted((root / library.FOLDERS["study"]).glob("*/rig.toml")):
            known.setdefault(file.parent.name.removeprefix("rig-"), file)
    if str(name).removeprefix("rig-") in known:
        return known[str(name).removeprefix("rig-")]
    raise InputError(f"no rig file and no rig named '{name}'{nearest(str(name), known)}")


def load(name: str | Path) -> tuple[RigCard, Path]:
    """Load a rig card; return the card and its file.

    Raises InputError with file and field if the rig is not possible.

    >>> card, file = load("trtlab")
    >>> [layer.name for layer in card.layers]
    ['tread', 'carcass']
    """
    file = find(name)
    data = read_toml(file)
    expect_kind("rig", data, file)
    return RigCard.check(data, file), file


def beside(card: RigCard, file: Path) -> list[Path]:
    """Default files of the runs' tables, beside the card; they need not exist."""
    return [file.parent / f"{run}.csv" for run in card.runs]


def tables(card: RigCard, file: Path, given: Iterable[str | Path] = ()) -> list[Path]:
    """Files of measured tables: ``given`` (in the working folder, else beside the card); default: every ``RUN.csv``.

    Raises InputError if none is given and a run has no table beside the card.

    >>> card, file = load("trtlab")
    >>> [table.name for table in tables(card, file)]
    ['low.csv', 'high.csv']
    """
    folder = file.parent
    named = [Path(table) for table in given]
    if named:
        return [folder / path if not path.exists() and (folder / path).is_file() else path for path in named]
    files = beside(card, file)
    missing = [table.name for table in files if not table.is_file()]
    if len(missing) == len(files):
        raise InputError(f"no table is given and none of {', '.join(missing)} is beside the card", file=file)
    if missing:
        there = " ".join(table.name for table in files if table.is_file())
        words = f"the card has runs without a table beside it: {', '.join(missing)}; to do without them, name {there}"
        raise InputError(words, field="runs", file=file)
    return files
