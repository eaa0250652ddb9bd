"""Finished simulations on disk: an interrupted command resumes with them."""

from __future__ import annotations

import dataclasses
import functools
import hashlib
import json
import re
import sys
import zipfile
from collections.abc import Hashable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from tyrefem import library
from tyrefem.effects import shipped_effects
from tyrefem.inputs.study import StudyData
from tyrefem.interruption import interruption_delayed
from tyrefem.output import atomic_path, jsonable, remove_temporary
from tyrefem.plugins import sent
from tyrefem.sizes import completed_materials

#: Folder within ``--out`` that holds finished simulations until the command ends.
PROGRESS = ".progress"
#: Number of digits of a key in the name of its folder, and of a question in the name of its answer.
KEY, QUESTION = 16, 24


@dataclass(eq=False)
class AnswerStore:
    """Answers (arrays) by question, in a folder; the key identifies everything else that they depend on.

    ``resumed``: number of answers that an interrupted command had left.
    """

    folder: Path
    resumed: int = 0
    _place: Path | None = field(default=None, repr=False)

    def resume(self, key: str) -> int:
        """Open the answers of a key, delete those of other keys, and return the number of answers."""
        self._place = self.folder / key[:KEY]
        for other in self.folder.glob("*"):
            if other != self._place:
                _remove_answers(other)
        self.resumed = self.count
        return self.resumed

    def known(self, name: str, question: Any) -> Any:
        """The answer to a question, an array or a tuple of arrays; None if there is no readable answer."""
        try:
            with np.load(self._file(name, question), allow_pickle=False) as kept:
                arrays = tuple(kept[f"arr_{number}"] for number in range(len(kept.files)))
        except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
            return None
        return arrays if len(arrays) > 1 else arrays[0] if arrays else None

    def has(self, name: str, question: Any) -> bool:
        """Is there an answer to a question?"""
        return self._place is not None and self._file(name, question).is_file()

    def keep(self, name: str, question: Any, answer: Any) -> None:
        """Store an answer: an array or a tuple of arrays."""
        with interruption_delayed(), atomic_path(self._file(name, question)) as temporary:
            np.savez(temporary, *(answer if isinstance(answer, tuple) else (answer,)))

    @property
    def count(self) -> int:
        """Number of stored answers."""
        return len(list(self._place.glob("[!.]*.npz"))) if self._place else 0

    @property
    def kept(self) -> str:
        """Sentence for the message of an interruption."""
        if not self.count:
            return "no simulation is finished yet"
        return f"{self.count} finished simulations are kept; the same command resumes from there"

    def clear(self) -> None:
        """Delete the answers, at the end of the command, and the folder if nothing else is in it."""
        remove_store(self.folder)

    def _file(self, name: str, question: Any) -> Path:
        assert self._place is not None, "open the store first"
        return self._place / f"{name}-{digest(plain(question))[:QUESTION]}.npz"


def remove_store(folder: Path) -> None:
    """Delete the answers in a folder of a store, and the folder if nothing else is in it."""
    for place in folder.glob("*"):
        _remove_answers(place)
    with suppress(OSError):
        folder.rmdir()


def _remove_answers(place: Path) -> None:
    """Delete the answers of one key. Other files, and folders of other names, are the user's."""
    if not re.fullmatch(f"[0-9a-f]{{{KEY}}}", place.name) or not place.is_dir() or place.is_symlink():
        return
    remove_temporary(place)
    for file in place.glob(f"*-{'[0-9a-f]' * QUESTION}.npz"):
        with suppress(OSError):
            file.unlink()
    with suppress(OSError):
        place.rmdir()


def effects_source() -> str:
    """Digest of the effects' files and of the user's plugins: a user may change a law before resuming."""
    plugins = sent().digest
    return digest([_shipped_source(), plugins]) if plugins else _shipped_source()


@functools.cache
def _shipped_source() -> str:
    files = {str(sys.modules[effect.__module__].__file__) for effect in shipped_effects().values()}
    return digest([Path(file).read_text(encoding="utf-8") for file in sorted(files)])


def study_digest(study: StudyData) -> str:
    """Digest of a study with its cards and its run, and of the effects' files."""
    return digest([effects_source(), plain(study), study.card.run])


def digest(content: Any) -> str:
    """SHA-256 of content that JSON can represent."""
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def plain(value: Any) -> Any:
    """A question as JSON content: numbers exactly, unknowns with all fields, studies with their cards."""
    if isinstance(value, StudyData):
        return _study(value)
    if isinstance(value, Mapping):
        return [[plain(key), plain(entry)] for key, entry in value.items()]
    if isinstance(value, tuple | list):
        return [plain(entry) for entry in value]
    if isinstance(value, np.ndarray):
        return [str(value.dtype), list(value.shape), hashlib.sha256(np.ascontiguousarray(value).data).hexdigest()]
    # An unknown's text is long, and every question of a fit repeats dozens of them. Data that are equal only to
    # themselves may be large, and would be kept.
    by_value = dataclasses.is_dataclass(value) and type(value).__eq__ is not object.__eq__
    return _digest_of(value) if by_value and isinstance(value, Hashable) else repr(value)


@functools.lru_cache(maxsize=4096, typed=True)
def _digest_of(value: Hashable) -> str:
    return digest(repr(value))


def _study(study: StudyData) -> list[Any]:
    cards = [library.load("section", study.data["section"], study.folder)[0]]
    materials = completed_materials(study.data["section"], study.data.get("materials", {}))
    cards += [library.load("material", reference, study.folder)[0] for reference in materials.values()]
    mesh = study.card.mesh.file
    mesh_file = hashlib.sha256(((study.folder or Path()) / mesh).read_bytes()).hexdigest() if mesh else None
    return [jsonable(study.data), jsonable(cards), mesh_file]
