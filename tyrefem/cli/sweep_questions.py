"""What `tyrefem sweep` is asked: the questions of a sweep file, or of a study and flags."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.errors import InputError, nearest

if TYPE_CHECKING:
    from tyrefem.sweep.questions import Questions


def questions(
    name: str, said: dict[str, Any], changes: dict[str, Any], case: str | None = None
) -> tuple[str, Questions]:
    """The questions of a sweep file or a study by name or path, what flags say laid over, and a name for their folder.

    ``case``: of a campaign, the case to take.

    Raises
    ------
    InputError : nothing has that name; something asked makes no sense.
    """
    from tyrefem import library
    from tyrefem.api import study as load
    from tyrefem.cards import read_toml
    from tyrefem.sweep import questions as asked
    from tyrefem.sweep.card import SweepCard

    path = Path(name)
    is_file = path.suffix == ".toml" and path.is_file() and "study" in read_toml(path)
    if is_file or (path / "sweep.toml").is_file() or name in library.names("sweep"):
        found = library.find("sweep", name)
        stem = found.parent.resolve().name if found.name == "sweep.toml" else found.stem
        return stem, asked.loaded(name, changes, **said, **({} if case is None else {"case": case}))
    if path.suffix != ".toml" and os.sep not in name and name not in library.names("study") and not path.is_dir():
        known = [*library.names("study"), *library.names("sweep")]
        raise InputError(f"no study or sweep named '{name}'{nearest(name, known)}")
    study = load(name, changes, case)
    return study.name, asked.questions(study, SweepCard.check({"study": name, **said}), Path())
