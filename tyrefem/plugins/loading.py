"""Executing a user's file, or importing the module of an entry point."""

from __future__ import annotations

import hashlib
import importlib.metadata
import importlib.util
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

from tyrefem.cache import Cache
from tyrefem.errors import InputError
from tyrefem.output import note_input
from tyrefem.plugins.guard import failure_words
from tyrefem.plugins.origin import Origin

#: Group of the entry points of installed packages.
GROUP = "tyrefem"
#: Package in which a user's files become modules, so that other processes find their classes.
PACKAGE = "tyrefem.plugins.files"


@dataclass(frozen=True, eq=False)
class LoadedModule:
    """A loaded file or package, with its classes.

    Parameters
    ----------
    name : of the module; for a file made of its stem and its content's digest. only : the class that an entry point
        names; None: every class of the module. content : of the file.
    """

    name: str
    module: ModuleType
    origin: Origin
    only: type | None = None
    content: bytes = b""

    @property
    def classes(self) -> tuple[type, ...]:
        """The classes in the module's namespace, in order, each once."""
        if self.only is not None:
            return (self.only,)
        return tuple(dict.fromkeys(value for value in vars(self.module).values() if isinstance(value, type)))


_FILES: Cache[LoadedModule] = Cache(size=256)


def python_files(place: Path) -> Iterator[Path]:
    """The file itself, or the Python files of a folder by name; not those that begin with an underscore."""
    if place.is_file():
        yield place.resolve()
        return
    for file in sorted(place.resolve().glob("*.py")):
        if not file.name.startswith(("_", ".")):
            yield file


def module_name(file: Path, content: bytes) -> str:
    """Name of a file's module: equal files have equal names in every process.

    >>> module_name(Path("a/my-lamp.py"), b"")
    'tyrefem.plugins.files.my_lamp_e3b0c44298fc'
    """
    stem = re.sub(r"\W", "_", file.stem)
    return f"{PACKAGE}.{stem}_{hashlib.sha256(content).hexdigest()[:12]}"


def load_file(file: Path) -> LoadedModule:
    """Execute a file as a module; a file that was loaded before is not executed again.

    Raises
    ------
    InputError : the file cannot be read or executed; the message has the line.
    """
    note_input(file)
    try:
        content = file.read_bytes()
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror or error}", file=file) from None
    name = module_name(file, content)
    return _FILES.get((name, str(file)), lambda: _executed(name, file, content))


def _executed(name: str, file: Path, content: bytes) -> LoadedModule:
    if name in sys.modules:  # an equal file of another folder
        module = sys.modules[name]
    else:
        spec = importlib.util.spec_from_file_location(name, file)
        if spec is None:
            raise InputError("is not a Python file", file=file)
        module = sys.modules[name] = importlib.util.module_from_spec(spec)
        try:
            exec(compile(content, str(file), "exec", dont_inherit=True), vars(module))
        except (Exception, SystemExit) as error:
            del sys.modules[name]
            reason = error.message if isinstance(error, InputError) else failure_words(error, str(file))
            raise InputError(f"cannot be loaded: {reason}", file=file) from error
        except BaseException:
            # Interrupted: half of a module must not count as loaded.
            del sys.modules[name]
            raise
    version = str(getattr(module, "__version__", ""))
    origin = Origin(file=file, version=version, sha256=hashlib.sha256(content).hexdigest())
    return LoadedModule(name, module, origin, content=content)


def entry_points() -> tuple[importlib.metadata.EntryPoint, ...]:
    """The entry points of installed packages, by name."""
    return tuple(sorted(importlib.metadata.entry_points(group=GROUP), key=lambda entry: entry.name))


def load_entry_point(entry: importlib.metadata.EntryPoint) -> LoadedModule:
    """Import what an entry point names: a module, or one class of it.

    Raises
    ------
    InputError : it cannot be imported, or is neither a module nor a class.
    """
    try:
        named = entry.load()
    except (Exception, SystemExit) as error:
        raise InputError(f"cannot be loaded: {failure_words(error, '')}") from error
    if not isinstance(named, ModuleType | type):
        raise InputError(f"entry point '{entry.value}' must name a module or a class, not {type(named).__name__}")
    module = named if isinstance(named, ModuleType) else sys.modules[named.__module__]
    version = entry.dist.version if entry.dist else ""
    package = entry.dist.name if entry.dist else entry.module.split(".")[0]
    origin = Origin(package=package, version=version, sha256=_digest(entry.module), entry=entry.value)
    return LoadedModule(entry.value, module, origin, None if isinstance(named, ModuleType) else named)


def _digest(module: str) -> str:
    """Digest of the Python files of a module's package, loaded or not: another process may have loaded others."""
    names = module.split(".")
    prefixes = [sys.modules.get(".".join(names[: end + 1])) for end in range(len(names))]
    # A namespace, which several packages share, has no file.
    top = next((part for part in prefixes if getattr(part, "__file__", None)), None)
    if top is None:
        return ""
    files = {Path(str(top.__file__)).name: Path(str(top.__file__))}
    for folder in getattr(top, "__path__", ()):
        files.update({file.relative_to(folder).as_posix(): file for file in Path(folder).rglob("*.py")})
    digest = hashlib.sha256()
    for _, file in sorted(files.items()):
        try:
            digest.update(file.read_bytes())
        except OSError:
            return ""
    return digest.hexdigest()
