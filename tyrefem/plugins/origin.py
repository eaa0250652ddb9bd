"""Where a plugin comes from: a user's file, or an installed package."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Origin:
    """The source of plugins.

    Parameters
    ----------
    file : the user's file; None for a package. package : name of the installed package; empty for a file.
    version : of the package, or ``__version__`` of the file; may be empty.
    sha256 : of the file, or of the package's Python files; empty if it could not be read.
    entry : the entry point as written, ``my_package.laws``.
    """

    file: Path | None = None
    package: str = ""
    version: str = ""
    sha256: str = ""
    entry: str = ""

    @property
    def words(self) -> str:
        """The file's path, or the package with its version.

        >>> Origin(package="hot-laws", version="1.2", entry="hot_laws:Arrhenius").words
        'package hot-laws 1.2 (hot_laws:Arrhenius)'
        """
        if self.file is not None:
            return str(self.file)
        return f"package {' '.join(filter(None, (self.package, self.version)))} ({self.entry})"

    def to_dict(self) -> dict[str, Any]:
        """Content for JSON."""
        place = {"file": str(self.file)} if self.file is not None else {"package": self.package, "entry": self.entry}
        return {**place, "version": self.version, "sha256": self.sha256}
