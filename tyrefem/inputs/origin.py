"""What made a folder of results: the study beside the files, and the part of ``summary.json`` that tells of it."""

from __future__ import annotations

import hashlib
import os
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.errors import InputError
from tyrefem.inputs.study_file import write_study
from tyrefem.inputs.study_plugins import plugin_summary
from tyrefem.output import unguarded, versions

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData

#: The study of a folder of results, with all changes: `tyrefem.load` of the folder reads it.
STUDY = "study.toml"
#: First line of a study that is written beside results, and the start of the second.
WRITTEN = "# Written by tyrefem: the study that made the results beside this file."
CHECKSUM = "# Checksum of the lines below, so that an edited study is kept: "


@dataclass(frozen=True)
class StudyOrigin:
    """The study that makes results: a `ResultsOrigin` of `results_folder` and `results_file`.

    Parameters
    ----------
    simulated : whether temperatures are simulated, with the study's tolerance of the time steps.
    random_seed : None: nothing is random.
    used : plain data that may name more plugins than the study.
    file : name of the study's file beside the results.
    """

    study: StudyData
    simulated: bool = False
    random_seed: int | None = None
    used: tuple[Any, ...] = ()
    file: str = STUDY

    @classmethod
    def beside(cls, study: StudyData, result: Path) -> StudyOrigin:
        """The study of a single result file, in a file of the same name: ``tyre.toml`` of ``tyre.npz``."""
        return cls(study, file=f"{result.stem}.toml")

    def using(self, *data: Any) -> StudyOrigin:
        """The same with the plugins that ``data`` name."""
        return replace(self, used=(*self.used, *data))

    def names(self, folder: Path) -> tuple[str, ...]:
        """Name of the study's file in a folder of results; empty where the study's own file stands in its place."""
        target, read = folder / self.file, self.study.file_read
        return () if read is not None and target.resolve() == read.resolve() else (self.file,)

    def wrote(self, file: Path) -> bool:
        """Whether this file of a study is as a command has written it: by the checksum in its second line."""
        with suppress(OSError, UnicodeDecodeError):
            with file.open(encoding="utf-8", newline="") as stream:
                first, second, text = stream.readline(), stream.readline(), stream.read()
            return first + second == _head(text)
        return False

    def check(self, folder: Path) -> None:
        """Raise an error if `write` would replace a file of the user, where no command guards these.

        Raises
        ------
        InputError : such a file stands in the folder.
        """
        for name in self.names(folder):
            if unguarded() and os.path.lexists(folder / name) and not self.wrote(folder / name):
                message = f"would be overwritten by the study '{self.study.name}'; choose another folder, or move it"
                raise InputError(message, file=folder / name)

    def write(self, folder: Path) -> tuple[str, ...]:
        """Write the study into a folder, unless its own file stands there; return the names. Errors as of `check`."""
        self.check(folder)
        names = self.names(folder)
        for name in names:
            write_study(self.study.data, self.study.folder, folder / name, head=_head)
        return names

    def summary(self) -> dict[str, Any]:
        """What made a result: study, tolerance in K, mesh, versions, plugins, seed, and the study's data with all
        changes."""
        study = self.study
        return {
            "study": study.name,
            "title": study.title,
            **({"tolerance_K": study.tolerance} if self.simulated else {}),
            "mesh": mesh_summary(study),
            "versions": versions(),
            **plugin_summary(study, *self.used),
            "random_seed": self.random_seed,
            "input": dict(study.data),
        }


def _head(text: str) -> str:
    """The first lines of a study's file, for the text below them."""
    return f"{WRITTEN}\n{CHECKSUM}{hashlib.blake2b(text.encode(), digest_size=8).hexdigest()}\n"


def mesh_summary(study: StudyData) -> dict[str, Any]:
    """How the study is meshed: mesher and size, or the user's file."""
    choice = study.card.mesh
    made = {"mesher": choice.mesher, "size_m": choice.size, "cell": choice.cell, "through": choice.through}
    read = {"mesher": "file", "size_m": None, "file": choice.file}
    return (made if choice.file is None else read) | {"element": choice.element, "section": choice.section}
