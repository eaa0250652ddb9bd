"""Finished simulations of a diagnosis, kept on disk, so that an interrupted one takes them up again."""

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
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem import library
from tyrefem.effects import catalogue
from tyrefem.output import atomic_path, jsonable
from tyrefem.studies import Study
from tyrefem.summary import versions

if TYPE_CHECKING:
    from tyrefem.diagnose.bench import Bench
    from tyrefem.diagnose.trials import Series


@dataclass(eq=False)
class ProgressStore:
    """Answers of a laboratory by question, in a folder; of one study, its cards, its data and one version only.

    ``taken_up``: how many answers an interrupted diagnosis had left when the store was opened.
    """

    folder: Path
    taken_up: int = 0
    _place: Path | None = field(default=None, repr=False)

    def open(self, bench: Bench) -> int:
        """Find what was left for this bench, and drop what was left for any other; how many answers there are."""
        self._place = self.folder / key_of(bench)[:16]
        for other in self.folder.glob("*"):
            if other != self._place:
                shutil.rmtree(other, ignore_errors=True)
        self.taken_up = self.count
        return self.taken_up

    def look(self, number: int) -> ProgressStore:
        """The store of a further look at the same data; this one for the first."""
        return self if number == 0 else ProgressStore(self.folder.with_name(f"{self.folder.name}-{number + 1}"))

    def known(self, name: str, question: tuple[Any, ...]) -> Any:
        """The answer to a question, arrays as they were; None where there is none that can be read."""
        try:
            with np.load(self._file(name, question), allow_pickle=False) as kept:
                arrays = tuple(kept[f"arr_{number}"] for number in range(len(kept.files)))
        except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
            return None
        return arrays if len(arrays) > 1 else arrays[0] if arrays else None

    def keep(self, name: str, question: tuple[Any, ...], answer: Any) -> None:
        """Keep an answer: an array or a tuple of several."""
        with atomic_path(self._file(name, question)) as temporary:
            np.savez(temporary, *(answer if isinstance(answer, tuple) else (answer,)))

    @property
    def count(self) -> int:
        """How many answers are kept now."""
        return len(list(self._place.glob("[!.]*.npz"))) if self._place else 0

    def clear(self) -> None:
        """Remove everything, of further looks too: the diagnosis is done."""
        for folder in (self.folder, *self.folder.parent.glob(f"{self.folder.name}-*")):
            shutil.rmtree(folder, ignore_errors=True)

    def _file(self, name: str, question: tuple[Any, ...]) -> Path:
        assert self._place is not None, "open the store first"
        return self._place / f"{name}-{_digest(_plain(question))[:24]}.npz"


def key_of(bench: Bench) -> str:
    """Digest of everything that decides a bench's answers: study, cards, effects' source, data, versions.

    >>> from tyrefem.diagnose.bench import Bench
    >>> from tyrefem.studies import study
    >>> one, faster = study("nasa-22x5.5-8pr"), study("nasa-22x5.5-8pr", {"drive.speed": "25 mph"})
    >>> key_of(Bench(one, ())) == key_of(Bench(faster, ()))
    False
    """
    trials = [[one.name, one.drive, one.hold_out, [_series(each) for each in one.series]] for one in bench.trials]
    return _digest([versions(), _effects_source(), _plain(bench.study), jsonable(trials)])


def _series(one: Series) -> list[Any]:
    data = [one.times.tolist(), one.measured.tolist()]
    return [one.sensor, data, one.noise, one.discrepancy, one.correlation_time]


@functools.cache
def _effects_source() -> str:
    """Digest of the effects' own files: a user may change one between two tries."""
    files = {str(sys.modules[one.__module__].__file__) for one in catalogue().values()}
    return _digest([Path(file).read_text(encoding="utf-8") for file in sorted(files)])


def _digest(content: Any) -> str:
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def _plain(value: Any) -> Any:
    """A question as JSON can hold it: numbers exactly, an unknown in full, a study with its cards."""
    if isinstance(value, Study):
        return _study(value)
    if isinstance(value, Mapping):
        return [[_plain(key), _plain(entry)] for key, entry in value.items()]
    if isinstance(value, tuple | list):
        return [_plain(entry) for entry in value]
    return repr(value)


def _study(study: Study) -> list[Any]:
    cards = [library.load("section", study.data["section"], study.folder)[0]]
    cards += [library.load("material", one, study.folder)[0] for one in study.data["materials"].values()]
    mesh = study.card.mesh.file
    own = hashlib.sha256(((study.folder or Path()) / mesh).read_bytes()).hexdigest() if mesh else None
    return [jsonable(study.data), jsonable(cards), own]
