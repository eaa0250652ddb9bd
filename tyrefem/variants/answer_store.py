"""Finished simulations kept on disk, so that an interrupted command takes them up again."""

from __future__ import annotations

import functools
import hashlib
import json
import shutil
import sys
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from tyrefem import library
from tyrefem.effects import catalogue
from tyrefem.inputs.study import StudyData
from tyrefem.interruption import interruption_delayed
from tyrefem.output import atomic_path, jsonable

#: Folder within ``--out`` that holds finished simulations until the command is done.
PROGRESS = ".progress"


@dataclass(eq=False)
class AnswerStore:
    """Answers (arrays) by question, in a folder; all of one key, that says what else they depend on.

    ``taken_up``: how many answers an interrupted command had left when the store was opened.
    """

    folder: Path
    taken_up: int = 0
    _place: Path | None = field(default=None, repr=False)

    def take_up(self, key: str) -> int:
        """Find what was left for this key, and drop what was left for any other; how many answers there are."""
        self._place = self.folder / key[:16]
        for other in self.folder.glob("*"):
            if other != self._place:
                shutil.rmtree(other, ignore_errors=True)
        self.taken_up = self.count
        return self.taken_up

    def known(self, name: str, question: Any) -> Any:
        """The answer to a question, arrays as they were; None where there is none that can be read."""
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
        """Keep an answer: an array or a tuple of several."""
        with interruption_delayed(), atomic_path(self._file(name, question)) as temporary:
            np.savez(temporary, *(answer if isinstance(answer, tuple) else (answer,)))

    @property
    def count(self) -> int:
        """How many answers are kept now."""
        return len(list(self._place.glob("[!.]*.npz"))) if self._place else 0

    @property
    def kept(self) -> str:
        """What an interruption says of it."""
        if not self.count:
            return "no simulation is finished yet"
        return f"{self.count} finished simulations are kept; the same command goes on from there"

    def clear(self) -> None:
        """Remove everything: the command is done."""
        shutil.rmtree(self.folder, ignore_errors=True)

    def _file(self, name: str, question: Any) -> Path:
        assert self._place is not None, "open the store first"
        return self._place / f"{name}-{digest(plain(question))[:24]}.npz"


@functools.cache
def effects_source() -> str:
    """Digest of the effects' own files: a user may change one between two tries."""
    files = {str(sys.modules[effect.__module__].__file__) for effect in catalogue().values()}
    return digest([Path(file).read_text(encoding="utf-8") for file in sorted(files)])


def digest(content: Any) -> str:
    """Of anything that JSON can hold."""
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def plain(value: Any) -> Any:
    """A question as JSON can hold it: numbers exactly, an unknown in full, a study with its cards."""
    if isinstance(value, StudyData):
        return _study(value)
    if isinstance(value, Mapping):
        return [[plain(key), plain(entry)] for key, entry in value.items()]
    if isinstance(value, tuple | list):
        return [plain(entry) for entry in value]
    return repr(value)


def _study(study: StudyData) -> list[Any]:
    cards = [library.load("section", study.data["section"], study.folder)[0]]
    cards += [library.load("material", reference, study.folder)[0] for reference in study.data["materials"].values()]
    mesh = study.card.mesh.file
    mesh_file = hashlib.sha256(((study.folder or Path()) / mesh).read_bytes()).hexdigest() if mesh else None
    return [jsonable(study.data), jsonable(cards), mesh_file]
