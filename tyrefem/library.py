"""Find a section, material or study: explicit path, the user's folders, the shipped library.

A section may also be a tyre's size.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from tyrefem.cards import merged, read_toml
from tyrefem.cards.file_kinds import FILES as KIND_FILES
from tyrefem.cards.file_kinds import is_another, other_file
from tyrefem.errors import InputError, nearest
from tyrefem.sizes import is_size, looks_like_size, section_of_size

FOLDERS = {"section": "geometry", "material": "materials", "study": "studies", "sweep": "studies"}
#: Kinds of card that are a folder with this file in it; the folder's name is the card's name.
FILES = {kind: name for kind, name in KIND_FILES.items() if kind in FOLDERS}
#: Environment variable with the user's library folders, separated as in PATH.
SEARCH_PATH = "TYREFEM_PATH"


def shipped() -> Path:
    """The folder with the shipped ``geometry``, ``materials`` and ``studies``."""
    package = Path(__file__).resolve().parent
    installed = package / "shipped"
    return installed if installed.is_dir() else package.parent


def roots(near: Path | None = None) -> Iterator[Path]:
    """Library folders in search order: the study's, the current, the user's, the shipped one."""
    if near is not None:
        yield near
        yield near.parent
        yield near.parent.parent
    yield Path()
    for folder in filter(None, os.environ.get(SEARCH_PATH, "").split(os.pathsep)):
        yield Path(folder).expanduser()
    yield shipped()


def names(kind: str, near: Path | None = None) -> dict[str, Path]:
    """All cards of a kind by name, with their files; earlier folders have precedence.

    >>> "nasa-tread" in names("material")
    True
    """
    pattern = f"*/{FILES[kind]}" if kind in FILES else "*.toml"
    by_name: dict[str, Path] = {}
    for root in roots(near):
        for path in sorted((root / FOLDERS[kind]).glob(pattern)):
            by_name.setdefault(path.parent.name if kind in FILES else path.stem, path)
    return by_name


def find(kind: str, name: str, near: Path | None = None) -> Path:
    """The file of a card: ``name`` is a path, or the name of a card in one of the library folders.

    Raises
    ------
    InputError : no such path or name; the message has the nearest name.
    """
    path = _path(name)
    if _looks_like_path(name):
        options = [path] if path.is_absolute() or near is None else [near / path, path]
        for option in options:
            if kind in FILES and os.path.isdir(option):
                option = option / FILES[kind]
            if os.path.isfile(option):
                return option
        _refuse_folder(kind, options)
        study_of_size = f"; a size becomes one by: tyrefem new study '{name}'" if looks_like_size(name) else ""
        raise InputError(f"no {kind} file '{name}'{study_of_size if kind == 'study' else ''}")
    for root in roots(near):
        path_here = root / FOLDERS[kind] / (f"{name}/{FILES[kind]}" if kind in FILES else f"{name}.toml")
        if os.path.isfile(path_here):
            return path_here
    if kind in FILES and os.path.isfile(path / FILES[kind]):
        return path / FILES[kind]
    _refuse_folder(kind, [*(root / FOLDERS[kind] / name for root in roots(near)), path])
    raise InputError(f"no {kind} named '{name}'{nearest(name, names(kind, near))}")


def _looks_like_path(name: str) -> bool:
    return _path(name).suffix.lower() == ".toml" or os.sep in name or "/" in name or name in (".", "..")


def _refuse_folder(kind: str, folders: list[Path]) -> None:
    """Raise `InputError` for a folder with a file of another kind."""
    other = other_file(kind, folders) if kind in FILES else None
    if other is not None:
        raise InputError(is_another(kind, *other), file=other[1])


def _path(name: str) -> Path:
    try:
        return Path(name).expanduser()
    except RuntimeError:  # "~name" of an unknown user is taken literally
        return Path(name)


def load(kind: str, reference: object, near: Path | None = None) -> tuple[dict[str, Any], Path, str]:
    """Plain data, file and name of a referenced card.

    ``reference`` is a name or path, or a table ``{base = NAME, ...}`` whose other keys replace those of that card. A
    section may be a size such as ``"205/60R15"``, or a table ``{size = ..., parameters = ...}``.

    Raises
    ------
    InputError : no such card, a table without ``base``, or a file that cannot be read.
    """
    if of_size(kind, reference, near):
        data, laid = section_of_size(reference)  # type: ignore[arg-type]
        name = str(reference["size"] if isinstance(reference, Mapping) else reference)
        return merged(data, laid), Path(name), name
    card, changes = _split(kind, reference)
    path = find(kind, card, near)
    name = Path(os.path.abspath(path)).parent.name if kind in FILES else path.stem
    return merged(read_toml(path), changes), path, name


def of_size(kind: str, reference: object, near: Path | None = None) -> bool:
    """Is a reference a tyre's size? A file or card of that name goes first.

    >>> of_size("section", "205/60R15"), of_size("material", "205/60R15"), of_size("section", "nasa-22x5.5-8pr")
    (True, False, False)
    """
    if kind != "section" or not is_size(reference):
        return False
    if isinstance(reference, Mapping):
        return True
    try:
        find(kind, str(reference), near)
    except InputError:
        return True
    return False


def _split(kind: str, reference: object) -> tuple[str, Mapping[str, Any]]:
    """The card that a reference names, and the changes to it."""
    changes: Mapping[str, Any] = {}
    if isinstance(reference, Mapping):
        if not isinstance(reference.get("base"), str):
            raise InputError(f"needs 'base', the name of a {kind} card", field="base")
        changes = {key: value for key, value in reference.items() if key != "base"}
        reference = reference["base"]
    if not isinstance(reference, str) or not reference:
        raise InputError(f"{reference!r} is not the name or path of a {kind} card")
    return reference, changes


def over(kind: str, reference: object, present: object, data: Mapping[str, Any]) -> dict[str, Any] | None:
    """`load`'s data of a reference, from the available data of ``present``; None for another card.

    ``present`` is a reference to the same card without changes.

    >>> over("material", {"base": "a", "k": 2}, "a", {"k": 1, "c": 3})
    {'k': 2, 'c': 3}
    """
    (card, changes), (other, laid) = _split(kind, reference), _split(kind, present)
    return merged(data, changes) if card == other and not laid else None


def located(kind: str, reference: Any, near: Path | None = None, folder: Path | None = None) -> Any:
    """The reference for use in another folder: a card that is not found by name there gets its full path.

    ``near``: folder of the reference. ``folder``: the other folder; None: any without cards near it.
    """
    if of_size(kind, reference, near) or (isinstance(reference, Mapping) and "base" not in reference):
        return reference
    name = reference["base"] if isinstance(reference, Mapping) else reference
    path = find(kind, name, near).resolve()
    if not stays_named(kind, name, path, folder):
        name = str(path)
    return {**reference, "base": name} if isinstance(reference, Mapping) else name


def stays_named(kind: str, name: str, path: Path, folder: Path | None = None) -> bool:
    """Whether a reference may keep its name in a folder: the name of a shipped card, which no other card hides there.

    ``path``: the card's file, resolved.
    """
    if _looks_like_path(name) or not path.is_relative_to(shipped().resolve()):
        return False
    try:
        return find(kind, name, folder).resolve() == path
    except InputError:
        return False
