"""What makes results: files that are written beside them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Protocol


class ResultsOrigin(Protocol):
    """What makes the results of a folder, or of a single file."""

    def names(self, folder: Path) -> Sequence[str]:
        """The files that `write` writes into a folder."""

    def wrote(self, file: Path) -> bool:
        """Whether this file is as `write` has written it."""

    def write(self, folder: Path) -> Sequence[str]:
        """Write these files; return their names."""

    def summary(self) -> dict[str, Any]:
        """Contents of a folder's ``summary.json`` if the command writes none."""
