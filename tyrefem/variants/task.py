"""Tasks for workers: a study packed with its files, and a variant's run from the packed study to its answers."""

from __future__ import annotations

import copy
import gc
import hashlib
import json
import tempfile
import threading
import uuid
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import tyrefem
from tyrefem import library
from tyrefem.cache import Cache
from tyrefem.errors import InputError, OutputError
from tyrefem.inputs.study import StudyData
from tyrefem.plugins import Sent, receive, registry, sent
from tyrefem.sizes import completed_materials
from tyrefem.variants.outcomes import Answered, Failed, Outcome

if TYPE_CHECKING:
    from tyrefem.simulation.rolling_tyre import RollingTyre


class VersionError(RuntimeError):
    """The study was packed by another version of tyrefem than the worker's."""


@dataclass(frozen=True)
class Bundle:
    """A study as plain data, with the files that are not shipped with the package.

    Parameters
    ----------
    name : of the study. data : the study; its references point into ``files``. files : name -> bytes.
    version : of the package that packed the study. plugins : the user's own effects and laws.
    cards : digest of the cards as packed, those that are shipped among them: in a clone they may be edited.
    paths : name of a file -> where its owner has it, for errors.
    """

    name: str
    data: Mapping[str, Any]
    files: Mapping[str, bytes]
    version: str = tyrefem.__version__
    plugins: Sent = field(default_factory=Sent)
    cards: str = ""
    paths: Mapping[str, str] = field(default_factory=dict)

    @property
    def digest(self) -> str:
        """Digest of the study, its cards and files."""
        heads = {name: hashlib.sha256(content).hexdigest() for name, content in sorted(self.files.items())}
        plugins = [self.plugins.digest] if self.plugins.digest else []
        parts = [self.version, self.name, self.data, heads, self.cards, *plugins]
        text = json.dumps(parts, sort_keys=True, default=str)
        return hashlib.sha256(text.encode()).hexdigest()[:16]

    def check_versions(self) -> None:
        """Take the user's plugins as they were sent.

        Raises
        ------
        VersionError : the study was packed by another version of the package, or of a plugin's package.
        """
        if self.version != tyrefem.__version__:
            raise VersionError(f"the study is from tyrefem {self.version}, but this worker has {tyrefem.__version__}")
        missing = receive(self.plugins)
        if missing:
            raise VersionError(f"{missing} on this worker")

    def named(self, error: InputError) -> InputError:
        """The error with the owner's path of a packed file, not the worker's."""
        path = self.paths.get(Path(error.file).name) if error.file else None
        return error if path is None else InputError(error.message, field=error.field, file=path)

    def unpacked(self, folder: Path) -> StudyData:
        """The study, with its files written to a folder.

        Raises
        ------
        VersionError : the study was packed by another version of the package.
        """
        self.check_versions()
        for name, content in self.files.items():
            # Another thread may be reading the same file.
            temporary = folder / f"{name}-{uuid.uuid4().hex}"
            temporary.parent.mkdir(exist_ok=True)
            temporary.write_bytes(content)
            temporary.replace(folder / name)
        return StudyData(self.name, self.data, None, folder)


def bundle(study: StudyData) -> Bundle:
    """Pack a study with its files, for other processes or machines.

    >>> import tempfile, tyrefem
    >>> packed = bundle(tyrefem.study("nasa-22x5.5-8pr"))
    >>> packed.unpacked(Path(tempfile.mkdtemp())).section.name
    'nasa-22x5.5-8pr'
    """
    data: dict[str, Any] = copy.deepcopy(dict(study.data))
    # Variants do not need these tables, which refer to more files.
    for key in ("measured", "cases"):
        data.pop(key, None)
    files: dict[str, bytes] = {}
    paths: dict[str, str] = {}
    near = study.folder
    loaded = [library.load("section", data["section"], near)[0]]
    materials = completed_materials(data["section"], data.get("materials", {}))
    loaded += [library.load("material", reference, near)[0] for reference in materials.values()]
    cards = hashlib.sha256(json.dumps(loaded, sort_keys=True, default=str).encode()).hexdigest()
    data["section"] = _packed("section", data["section"], near, files, paths)
    data["materials"] = {
        region: _packed("material", reference, near, files, paths)
        for region, reference in data.get("materials", {}).items()
    }
    for region, reference in materials.items():
        given = data["materials"].get(region)
        if given is None or (isinstance(given, Mapping) and "base" not in given):
            _keep_card_of_size(reference, near, files, paths)
    mesh = data.get("mesh", {})
    if isinstance(mesh.get("file"), str):
        mesh["file"] = _kept((near or Path()) / mesh["file"], files, paths)
    return Bundle(study.name, data, files, plugins=sent(), cards=cards, paths=paths)


def _packed(kind: str, reference: Any, near: Path | None, files: dict[str, bytes], paths: dict[str, str]) -> Any:
    """The reference for a machine that has only the package and ``files``."""
    if library.of_size(kind, reference, near) or (isinstance(reference, Mapping) and "base" not in reference):
        return reference
    name = reference["base"] if isinstance(reference, Mapping) else reference
    path = library.find(kind, name, near).resolve()
    if not library.stays_named(kind, name, path):
        name = _kept(path, files, paths)
    return {**reference, "base": name} if isinstance(reference, Mapping) else name


def _keep_card_of_size(reference: Any, near: Path | None, files: dict[str, bytes], paths: dict[str, str]) -> None:
    """A card that the rules of a size name: where it is the user's, it is packed to be found by this name."""
    name = reference["base"] if isinstance(reference, Mapping) else reference
    path = library.find("material", name, near).resolve()
    if not library.stays_named("material", name, path):
        _kept(path, files, paths, f"{library.FOLDERS['material']}/{name}.toml")


def _kept(path: Path, files: dict[str, bytes], paths: dict[str, str], name: str = "") -> str:
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror or error}", file=path) from None
    name = name or f"{path.stem}-{hashlib.sha256(content).hexdigest()[:8]}{path.suffix}"
    files[name], paths[Path(name).name] = content, str(path)
    return name


#: Studies that a process keeps unpacked.
UNPACKED = 16
_studies: Cache[StudyData] = Cache(UNPACKED)


@dataclass(frozen=True)
class Task:
    """A variant to run.

    Parameters
    ----------
    number : of the variant. packed : the study. changes : what the variant changes. time_to : see `answers`.
    """

    number: int
    packed: Bundle
    changes: Mapping[str, Any]
    time_to: float | None = None


def unpacked(packed: Bundle) -> StudyData:
    """The study of a bundle, unpacked once in this process; threads share it.

    Raises
    ------
    VersionError : the study was packed by another version of the package.
    OutputError : its files cannot be written, as on a full disk.
    """
    packed.check_versions()
    return _studies.get(packed.digest, lambda: _written(packed))


def _written(packed: Bundle) -> StudyData:
    try:
        return packed.unpacked(_folder(packed.digest))
    except OSError as error:
        reason = f"temporary files cannot be written: {error.strerror or error}"
        raise OutputError(reason, file=tempfile.gettempdir()) from None


_folder_lock = threading.Lock()
_folders: list[tempfile.TemporaryDirectory[str]] = []


def _folder(digest: str) -> Path:
    """Folder of this process for the files of a bundle; deleted when the process ends."""
    with _folder_lock:
        if not _folders:
            _folders.append(tempfile.TemporaryDirectory(prefix="tyrefem-"))
        folder = Path(_folders[0].name) / digest
        folder.mkdir(exist_ok=True)
        return folder


#: Tyres that a thread keeps.
REMEMBERED = 4


class RecentTyres(threading.local):
    """The tyres that this thread ran last, the latest first.

    The next variant reuses their mesh, operators and strain cycles if these are the same.
    """

    def __init__(self) -> None:
        self.tyres: list[RollingTyre] = []

    def most_similar(self, study: StudyData) -> RollingTyre | None:
        """The tyre of which a study can reuse most."""
        # Tyres with a law that was edited since stay out: their materials and films are of the former law.
        present = registry()
        tyres = [tyre for tyre in self.tyres if present.keeps(tyre.study.parts.plugins)]
        return max(tyres, key=lambda tyre: _similarity(study, tyre.study), default=None)

    def remember(self, tyre: RollingTyre) -> None:
        """Keep a tyre; one that has become too old is forgotten."""
        forgotten = self.tyres[REMEMBERED - 1 :]
        self.tyres[:] = [tyre, *self.tyres[: REMEMBERED - 1]]
        if any(all(old.mesh is not kept.mesh for kept in self.tyres) for old in forgotten):
            # Free a dropped mesh with its operators now: tens of MB in reference cycles.
            del forgotten
            gc.collect()


recent_tyres = RecentTyres()


def _similarity(study: StudyData, other: StudyData) -> tuple[bool, bool, int]:
    """(same section and mesh, same drive and mechanics, number of equal materials), for comparison."""
    same = [study.data.get(table) == other.data.get(table) for table in ("section", "mesh", "drive", "mechanics")]
    mine, theirs = (some.data.get("materials", {}) for some in (study, other))
    return same[0] and same[1], same[2] and same[3], sum(mine[region] == theirs.get(region) for region in mine)


def perform_all(tasks: Sequence[Task]) -> tuple[Outcome, ...]:
    """Outcomes of several variants, one after the other."""
    return tuple(perform(task) for task in tasks)


def perform(task: Task) -> Outcome:
    """Run a variant in full; an error becomes `Failed`, so that the other variants continue.

    Raises
    ------
    VersionError : the study was packed by another version of the package.
    OutputError : a file cannot be written: no fault of the variant.
    """
    from tyrefem.conduction import SolverError
    from tyrefem.simulation.run import run
    from tyrefem.variants.answers import answers

    try:
        study = unpacked(task.packed).replace(task.changes)
        before = recent_tyres.most_similar(study)
        if before is not None:
            study = unpacked(task.packed).replace(task.changes, like=before.study)
        result = run(study, like=before)
        outcome = Answered(answers(result, task.time_to))
        recent_tyres.remember(result.tyre)
        return outcome
    except OutputError:
        raise
    except InputError as error:
        return Failed(str(task.packed.named(error)))
    except SolverError as error:
        return Failed(str(error))
    except VersionError:
        raise
    except Exception as error:  # a defect; it is named as what it is
        return Failed(f"defect, please report: {type(error).__name__}: {error}")
