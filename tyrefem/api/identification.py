"""Layers of a laser rig, identified from its tables."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.api.verbs import with_verbs
from tyrefem.errors import InputError
from tyrefem.heating_test import identification

if TYPE_CHECKING:
    from tyrefem.heating_test.card import RigCard
    from tyrefem.heating_test.grid import Fineness
    from tyrefem.heating_test.readings import HeatingTest


class Identification(identification.IdentificationData):
    """Layers identified from a rig's tables, with `words`, `to_dict` and `save`."""

    @cached_property
    def words(self) -> tuple[str, ...]:
        """Sentences on what the data cannot determine, and on other limits of the result."""
        from tyrefem.heating_test.verdict import sentences

        return sentences(self)

    def to_dict(self) -> dict[str, Any]:
        """Contents of `rig.json`."""
        from tyrefem.heating_test.summary import summary

        return summary(self)

    def save(self, folder: str | Path, base: str | None = None, *, force: bool = False) -> Path:
        """Write the files of `tyrefem rig identify`: JSON, tables, pictures, ``report.html`` and, with a base card,
        material cards.

        ``force``: replace the user's files and the results of other commands.

        Raises
        ------
        InputError : the folder cannot be written; files in it are not of this command; no such base card.
        """
        from tyrefem.api.saving import saving
        from tyrefem.reports.rig import FILES, save

        with saving(folder, "rig identify", FILES, None, force=force) as place:
            return save(self, place, base)


def identify(
    rig: str | Path | RigCard,
    tables: Iterable[str | Path] = (),
    *,
    tests: Sequence[HeatingTest] = (),
    without: Sequence[str] = (),
    linear: bool = True,
    fineness: Fineness | None = None,
    progress: Callable[[], None] | None = None,
) -> Identification:
    """Identify conductivity and specific heat of every layer of a rig from measured tables.

    Parameters
    ----------
    rig : name, path or card.
    tables : CSV files or workbooks whose runs have the card's names; default: CSV files beside the card.
    tests, without, linear, fineness, progress : see `tyrefem.heating_test.identification.identify`.

    Raises
    ------
    InputError : the card or a table cannot be used.
    """
    for name, given in {"tables": tables, "tests": tests, "without": without}.items():
        if isinstance(given, str | bytes | Path) or not isinstance(given, Iterable):
            raise InputError(f"must be a list, not {given!r:.60}", field=name)
    data = identification.identify(
        rig, tables, tests=tests, without=without, linear=linear, fineness=fineness, progress=progress
    )
    return with_verbs(Identification, data)
