"""Plugins of a study that travels to another machine: its workers use the sender's files, not their own."""

from __future__ import annotations

import hashlib
import os
import tempfile
import threading
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from tyrefem.errors import InputError
from tyrefem.plugins import environment
from tyrefem.plugins.loading import module_name
from tyrefem.plugins.registry import forget, registry


@dataclass(frozen=True)
class Sent:
    """Plugins as data.

    Parameters
    ----------
    files : name of a file -> its content. packages : entry point -> package, version and digest.
    readers : files and entry points that only read finished answers: no computed number depends on them.
    """

    files: Mapping[str, bytes] = field(default_factory=dict)
    packages: Mapping[str, tuple[str, str, str]] = field(default_factory=dict)
    readers: frozenset[str] = frozenset()

    @property
    def digest(self) -> str:
        """Digest of the files and packages on which computed numbers depend; empty without any."""
        files = sorted(name for name in self.files if name not in self.readers)
        packages = sorted(entry for entry in self.packages.items() if entry[0] not in self.readers)
        if not files and not packages:
            return ""
        digest = hashlib.sha256()
        for name in files:
            digest.update(hashlib.sha256(self.files[name]).digest())
        digest.update(repr(packages).encode())
        return digest.hexdigest()

    @property
    def named(self) -> dict[str, Path]:
        """Module -> its file, relative to a folder."""
        paths = {name: Path(name) for name in self.files}
        return {module_name(path, self.files[name]): path for name, path in paths.items()}


def use(place: str | Path) -> None:
    """Name a further folder, or a file, for the rest of this process and its workers.

    The same as naming it in ``TYREFEM_PLUGINS``. Files that have changed since are read again.

    Raises
    ------
    InputError : there is no such folder or file, or its path has the separator of paths.
    """
    try:
        path = Path(place).expanduser().resolve()
        known = path.exists()
    except (OSError, RuntimeError):  # a name that is too long, no such user's home
        known = False
    if not known:
        raise InputError("no such file or folder of plugins", file=str(place))
    if os.pathsep in str(path):
        wrong = f"has a '{os.pathsep}' in its path, which separates the folders in {environment.FOLDERS}: rename it"
        raise InputError(wrong, file=str(place))
    values = environment.state()
    if path not in [other.resolve() for _, other in environment.places(values)]:
        os.environ[environment.FOLDERS] = os.pathsep.join([*filter(None, [values[0]]), str(path)])
    forget()


def sent() -> Sent:
    """The plugins of this process: files by content, packages by version."""
    loaded = registry()
    used = {plugin.origin for plugin in loaded.plugins}
    computing = {plugin.origin for plugin in loaded.plugins if plugin.kind.computes(plugin.cls)}
    files: dict[str, bytes] = {}
    packages: dict[str, tuple[str, str, str]] = {}
    readers: set[str] = set()
    for module in loaded.modules:
        origin = module.origin
        if origin not in used:
            continue
        if origin.file is None:
            name = origin.entry
            packages[name] = (origin.package, origin.version, origin.sha256)
        else:
            name = f"{origin.sha256[:12]}/{origin.file.name}"
            files[name] = module.content
        if origin not in computing:
            readers.add(name)
    return Sent(files, packages, frozenset(readers))


_receiving = threading.Lock()
_folder: tempfile.TemporaryDirectory[str] | None = None


def receive(plugins: Sent) -> str:
    """Use the plugins that came with a study; what is missing on this machine, in words, or nothing.

    Files that this process has already are not written.
    """
    with _receiving:
        loaded = registry()
        if not set(plugins.named) <= {module.name for module in loaded.modules}:
            environment.receive_files(_written(plugins))
            loaded = registry()
    present = {module.origin.entry: module.origin for module in loaded.modules if module.origin.file is None}
    for entry, (package, version, sha256) in plugins.packages.items():
        origin = present.get(entry)
        if origin is None:
            return f"the plugin package '{package}' {version} is not installed"
        if origin.sha256 != sha256:
            return f"the plugin package '{package}' {origin.version} is not that of the sender ({version})"
    return ""


def _written(plugins: Sent) -> tuple[str, ...]:
    """Write the files to a temporary folder of this process; their paths."""
    global _folder
    if _folder is None:
        _folder = tempfile.TemporaryDirectory(prefix="tyrefem-plugins-")
    paths = []
    for name, content in plugins.files.items():
        path = Path(_folder.name) / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
        paths.append(str(path))
    return tuple(sorted(paths))
