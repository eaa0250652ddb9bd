"""Find and read a rig card: a path, a folder, or the name of a shipped one."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from tyrefem import library
from tyrefem.cards import read_toml
from tyrefem.errors import InputError, nearest
from tyrefem.rig.card import RigCard


def find(name: str | Path) -> Path:
    """The file of a rig: a path, a folder with a ``rig.toml``, or the name of a shipped one.

    >>> find("trtlab").name
    'rig.toml'
    """
    path = Path(name)
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
    """A rig card and its file.

    Raises InputError with file and field for anything that is not a possible rig.

    >>> card, file = load("trtlab")
    >>> [layer.name for layer in card.layers]
    ['tread', 'carcass']
    """
    file = find(name)
    return RigCard.check(read_toml(file), file), file


def beside(card: RigCard, file: Path) -> list[Path]:
    """Where the runs' tables lie if none are named: beside the card; they need not be there."""
    return [file.parent / f"{run}.csv" for run in card.runs]


def tables(card: RigCard, file: Path, given: Iterable[str | Path] = ()) -> list[Path]:
    """Files of measured tables: as given (here, else beside the card); without any, each run's ``RUN.csv`` there.

    Raises InputError where nothing is given and a run's table does not lie beside the card.

    >>> card, file = load("trtlab")
    >>> [table.name for table in tables(card, file)]
    ['low.csv', 'high.csv']
    """
    folder = file.parent
    named = [Path(table) for table in given]
    if named:
        return [folder / one if not one.exists() and (folder / one).is_file() else one for one in named]
    files = beside(card, file)
    missing = [table.name for table in files if not table.is_file()]
    if len(missing) == len(files):
        raise InputError(f"no table is given and none of {', '.join(missing)} lies beside the card", file=file)
    if missing:
        there = " ".join(table.name for table in files if table.is_file())
        words = f"the card has runs without a table beside it: {', '.join(missing)}; to do without them, name {there}"
        raise InputError(words, field="runs", file=file)
    return files
