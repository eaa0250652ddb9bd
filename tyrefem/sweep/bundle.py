"""A study with the files it needs, to be sent to another process or machine."""

from __future__ import annotations

import copy
import hashlib
import json
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tyrefem
from tyrefem import library
from tyrefem.errors import InputError
from tyrefem.studies import Study


class VersionError(RuntimeError):
    """The packer's and the worker's package differ."""


@dataclass(frozen=True)
class Bundle:
    """A study as plain data and the files beside it that are not shipped with the package.

    Parameters
    ----------
    name : of the study. data : the study, its references into ``files``. files : name -> bytes.
    version : of the package that packed it.
    """

    name: str
    data: Mapping[str, Any]
    files: Mapping[str, bytes]
    version: str = tyrefem.__version__

    @property
    def digest(self) -> str:
        """What the study says and all its files hold, shipped cards included by the package's version."""
        heads = {name: hashlib.sha256(content).hexdigest() for name, content in sorted(self.files.items())}
        text = json.dumps([self.version, self.name, self.data, heads], sort_keys=True, default=str)
        return hashlib.sha256(text.encode()).hexdigest()[:16]

    def unpacked(self, folder: Path) -> Study:
        """The study again, its files in a folder.

        Raises
        ------
        VersionError : another version of the package would answer differently.
        """
        if self.version != tyrefem.__version__:
            raise VersionError(f"asked by tyrefem {self.version}, but this worker has {tyrefem.__version__}")
        for name, content in self.files.items():
            (folder / name).write_bytes(content)
        return Study(self.name, self.data, None, folder)


def bundle(study: Study) -> Bundle:
    """Pack a study: whoever unpacks it needs no file of this machine.

    >>> import tempfile, tyrefem
    >>> packed = bundle(tyrefem.study("nasa-22x5.5-8pr"))
    >>> packed.unpacked(Path(tempfile.mkdtemp())).section.name
    'nasa-22x5.5-8pr'
    """
    data: dict[str, Any] = copy.deepcopy(dict(study.data))
    # What a variant does not need, and would have to bring files for.
    for key in ("measured", "cases"):
        data.pop(key, None)
    files: dict[str, bytes] = {}
    near = study.folder
    data["section"] = _packed("section", data["section"], near, files)
    data["materials"] = {
        region: _packed("material", reference, near, files) for region, reference in data["materials"].items()
    }
    mesh = data.get("mesh", {})
    if isinstance(mesh.get("file"), str):
        mesh["file"] = _kept((near or Path()) / mesh["file"], files)
    return Bundle(study.name, data, files)


def _packed(kind: str, reference: Any, near: Path | None, files: dict[str, bytes]) -> Any:
    """The reference as it must be written where only the package and ``files`` are at hand."""
    name = reference["base"] if isinstance(reference, Mapping) else reference
    path = library.find(kind, name, near).resolve()
    if not path.is_relative_to(library.shipped().resolve()):
        name = _kept(path, files)
    return {**reference, "base": name} if isinstance(reference, Mapping) else name


def _kept(path: Path, files: dict[str, bytes]) -> str:
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror or error}", file=path) from None
    name = f"{path.stem}-{hashlib.sha256(content).hexdigest()[:8]}{path.suffix}"
    files[name] = content
    return name


class Unpacked:
    """Bundles that this process has unpacked, by digest: a worker keeps its studies, meshes and operators."""

    def __init__(self) -> None:
        self._studies: dict[str, Study] = {}
        self._folders: list[tempfile.TemporaryDirectory[str]] = []

    def study(self, packed: Bundle) -> Study:
        """The study of a bundle, unpacked once."""
        digest = packed.digest
        if digest not in self._studies:
            folder = tempfile.TemporaryDirectory(prefix="tyrefem-")
            self._folders.append(folder)
            self._studies[digest] = packed.unpacked(Path(folder.name))
        return self._studies[digest]
